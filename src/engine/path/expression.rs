//! Expressions `L(S|D|G)*E`: what they are and how they are read.

use std::fmt;
use std::str::FromStr;

use super::parser;

/// Most events that an expression may name once its counts are written out: `(DS){3}` names six.
/// It bounds the work of all that is built from an expression.
pub(super) const MAX_EVENTS: usize = 512;

/// A set of path words as the user typed it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expression {
    text: String,
    pub(super) node: Node,
}

/// Syntax tree over the events between `L` and `E`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Node {
    /// The empty word.
    Empty,
    /// One event out of a set of letters; bit i is letter number i.
    Letters(u8),
    /// One after the other.
    Sequence(Vec<Node>),
    /// One of them.
    Union(Vec<Node>),
    /// At least `min` and at most `max` times; without end if `max` is absent.
    Repeat {
        node: Box<Node>,
        min: u32,
        max: Option<u32>,
    },
}

impl Node {
    /// How many events the node names once its counts are written out. A repetition counts at least
    /// one copy: nested counts of nothing cost something too.
    pub(super) fn written_out(&self) -> usize {
        let total = |nodes: &[Self]| {
            nodes
                .iter()
                .fold(0usize, |sum, node| sum.saturating_add(node.written_out()))
        };
        match self {
            Self::Empty | Self::Letters(_) => 1,
            Self::Sequence(nodes) | Self::Union(nodes) => total(nodes),
            Self::Repeat { node, min, max } => {
                let copies = max.unwrap_or(*min).max(1);
                node.written_out().saturating_mul(copies as usize)
            }
        }
    }
}

impl Expression {
    /// The text as it was typed.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Self, ExpressionError> {
        Ok(Self {
            text: text.to_owned(),
            node: parser::parse(text)?,
        })
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Why a text is no expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpressionError {
    /// The text.
    pub text: String,
    /// Index of the character it happened at, from 0; absent where the whole is too large.
    pub position: Option<usize>,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl fmt::Display for ExpressionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown: String = self.text.chars().take(60).collect();
        let dots = if self.text.chars().nth(60).is_some() {
            "…"
        } else {
            ""
        };
        match self.position {
            Some(p) => {
                write!(
                    f,
                    "expression `{shown}{dots}`, character {}: {}",
                    p + 1,
                    self.message
                )
            }
            None => write!(f, "expression `{shown}{dots}`: {}", self.message),
        }
    }
}

impl std::error::Error for ExpressionError {}
