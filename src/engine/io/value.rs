//! TOML and JSON as one tree whose nodes know their line.

/// A value and where it stands.
#[derive(Clone, Debug)]
pub struct Node {
    /// Line from 1.
    pub line: usize,
    /// What it is.
    pub value: Value,
}

/// A value of either format.
#[derive(Clone, Debug)]
pub enum Value {
    /// JSON's `null`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// Any number.
    Number(f64),
    /// Text.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// Names and values, in the order of the file.
    Table(Vec<(Key, Node)>),
}

/// A name in a table.
#[derive(Clone, Debug)]
pub struct Key {
    /// Line from 1.
    pub line: usize,
    /// The name.
    pub name: String,
}

/// A text that is not of its format.
#[derive(Clone, Debug)]
pub struct SyntaxError {
    /// Line from 1.
    pub line: usize,
    /// What the parser says.
    pub message: String,
}

impl Value {
    /// What kind of value it is, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "true or false",
            Self::Number(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
        }
    }
}

/// Turns byte offsets into lines.
pub struct Lines(Vec<usize>);

impl Lines {
    /// Of `text`.
    pub fn new(text: &str) -> Self {
        Self(
            text.bytes()
                .enumerate()
                .filter(|(_, b)| *b == b'\n')
                .map(|(i, _)| i)
                .collect(),
        )
    }

    /// The line, from 1, of byte `offset`.
    pub fn at(&self, offset: usize) -> usize {
        self.0.partition_point(|&end| end < offset) + 1
    }
}
