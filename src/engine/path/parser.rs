//! Recursive descent over the characters of an expression.
//!
//! ```text
//! expression  = path ('|' path)*            path    = 'L' union 'E'
//! union       = sequence ('|' sequence)*    sequence = repeat*
//! repeat      = atom ('*' | '+' | '?' | '{m}' | '{m,}' | '{m,n}')*
//! atom        = 'D' | 'G' | 'S' | 'V' | '.' | '(' union ')'
//! ```
//!
//! A `|` outside brackets parts whole paths if an `L` follows it, events otherwise.

use super::expression::{ExpressionError, MAX_EVENTS, Node};

/// Longest text that is read.
const MAX_CHARACTERS: usize = 4096;
/// Deepest nesting of brackets.
const MAX_DEPTH: usize = 64;
/// Largest count in braces.
const MAX_COUNT: u32 = 255;
/// Every letter.
const ANY: u8 = 0b1111;

/// Reads an expression.
pub(super) fn parse(text: &str) -> Result<Node, ExpressionError> {
    let characters = text.char_indices().enumerate();
    let symbols: Vec<(usize, char)> = characters
        .map(|(i, (_, c))| (i, c))
        .filter(|(_, c)| !c.is_whitespace())
        .collect();
    let length = text.chars().count();
    let mut parser = Parser {
        text,
        symbols,
        length,
        at: 0,
        depth: 0,
    };
    if length > MAX_CHARACTERS {
        return Err(parser.error(
            MAX_CHARACTERS,
            &format!("an expression has at most {MAX_CHARACTERS} characters"),
        ));
    }
    parser.expression()
}

struct Parser<'a> {
    text: &'a str,
    /// Characters that are no blanks, with their positions.
    symbols: Vec<(usize, char)>,
    length: usize,
    at: usize,
    depth: usize,
}

type Parsed = Result<Node, ExpressionError>;

impl Parser<'_> {
    fn peek(&self) -> Option<char> {
        self.symbols.get(self.at).map(|s| s.1)
    }

    fn peek_second(&self) -> Option<char> {
        self.symbols.get(self.at + 1).map(|s| s.1)
    }

    fn position(&self) -> usize {
        self.symbols.get(self.at).map_or(self.length, |s| s.0)
    }

    fn error(&self, position: usize, message: &str) -> ExpressionError {
        let message = message.to_owned();
        ExpressionError {
            text: self.text.to_owned(),
            position: Some(position),
            message,
        }
    }

    fn error_here(&self, message: &str) -> ExpressionError {
        let found = match self.peek() {
            Some(c) => format!("{message}, not `{c}`"),
            None => format!("{message}, but it ends here"),
        };
        self.error(self.position(), &found)
    }

    fn expression(&mut self) -> Parsed {
        let mut paths = Vec::new();
        loop {
            if self.peek() != Some('L') {
                return Err(self.error_here("a path begins with the light, `L`"));
            }
            self.at += 1;
            paths.push(self.union()?);
            if self.peek() != Some('E') {
                let expected = "here D, G, S, V, `.`, a bracket, `* + ?`, braces, or the eye `E`";
                return Err(self.error_here(expected));
            }
            self.at += 1;
            match self.peek() {
                None => {
                    let end = self.symbols.last().map_or(0, |symbol| symbol.0);
                    return self.bounded(one_or(paths, Node::Union), end);
                }
                Some('|') => self.at += 1,
                Some(_) => {
                    let message = "after the eye `E` comes nothing, or `|` and another path";
                    return Err(self.error_here(message));
                }
            }
        }
    }

    fn union(&mut self) -> Parsed {
        let mut branches = vec![self.sequence()?];
        while self.peek() == Some('|') && self.peek_second() != Some('L') {
            self.at += 1;
            branches.push(self.sequence()?);
        }
        Ok(one_or(branches, Node::Union))
    }

    fn sequence(&mut self) -> Parsed {
        let mut parts = Vec::new();
        while let Some(atom) = self.atom()? {
            parts.push(self.repeats(atom)?);
        }
        Ok(if parts.is_empty() {
            Node::Empty
        } else {
            one_or(parts, Node::Sequence)
        })
    }

    fn atom(&mut self) -> Result<Option<Node>, ExpressionError> {
        let node = match self.peek() {
            Some('D') => Node::Letters(1),
            Some('G') => Node::Letters(1 << 1),
            Some('S') => Node::Letters(1 << 2),
            Some('V') => Node::Letters(1 << 3),
            Some('.') => Node::Letters(ANY),
            Some('(') => return self.bracket().map(Some),
            Some('*' | '+' | '?' | '{') => {
                return Err(self.error_here("there is nothing to repeat; an event comes first"));
            }
            _ => return Ok(None),
        };
        self.at += 1;
        Ok(Some(node))
    }

    fn bracket(&mut self) -> Parsed {
        let opened = self.position();
        self.at += 1;
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.error(opened, &format!("brackets nest at most {MAX_DEPTH} deep")));
        }
        let inner = self.union()?;
        if self.peek() != Some(')') {
            return Err(match self.peek() {
                None | Some('E') => self.error(opened, "this bracket is not closed by `)`"),
                Some('L') => self.error_here("the light `L` stands only at the start of a path"),
                _ => self.error_here("within brackets D, G, S, V, `.`, `|` or `)`"),
            });
        }
        self.at += 1;
        self.depth -= 1;
        Ok(inner)
    }

    fn repeats(&mut self, mut node: Node) -> Parsed {
        let mut stacked = 0;
        loop {
            let (min, max) = match self.peek() {
                Some('*') => (0, None),
                Some('+') => (1, None),
                Some('?') => (0, Some(1)),
                Some('{') => self.braces()?,
                _ => return Ok(node),
            };
            let position = self.position();
            stacked += 1;
            if stacked > MAX_DEPTH {
                return Err(self.error_here(&format!("at most {MAX_DEPTH} repetitions in a row")));
            }
            self.at += 1;
            node = self.bounded(
                Node::Repeat {
                    node: Box::new(node),
                    min,
                    max,
                },
                position,
            )?;
        }
    }

    /// The node, which ends at `position`, if it is not too large.
    fn bounded(&self, node: Node, position: usize) -> Parsed {
        if node.written_out() <= MAX_EVENTS {
            return Ok(node);
        }
        let message = format!("with its counts written out it names more than {MAX_EVENTS} events");
        Err(self.error(position, &message))
    }

    /// `{m}`, `{m,}` or `{m,n}`; stops at the closing brace.
    fn braces(&mut self) -> Result<(u32, Option<u32>), ExpressionError> {
        let opened = self.position();
        self.at += 1;
        let min = self.count()?;
        let max = if self.peek() == Some(',') {
            self.at += 1;
            if self.peek() == Some('}') {
                None
            } else {
                Some(self.count()?)
            }
        } else {
            Some(min)
        };
        if self.peek() != Some('}') {
            return Err(self.error_here("braces hold `{m}`, `{m,}` or `{m,n}`"));
        }
        if max.is_some_and(|max| max < min) {
            return Err(self.error(opened, "in `{m,n}` m is at most n"));
        }
        Ok((min, max))
    }

    fn count(&mut self) -> Result<u32, ExpressionError> {
        let start = self.position();
        let mut value: Option<u32> = None;
        while let Some(digit) = self.peek().and_then(|c| c.to_digit(10)) {
            let next = value.unwrap_or(0) * 10 + digit;
            if next > MAX_COUNT {
                return Err(self.error(start, &format!("counts are at most {MAX_COUNT}")));
            }
            value = Some(next);
            self.at += 1;
        }
        value.ok_or_else(|| self.error_here("braces hold `{m}`, `{m,}` or `{m,n}`"))
    }
}

fn one_or(mut nodes: Vec<Node>, many: fn(Vec<Node>) -> Node) -> Node {
    if nodes.len() == 1 {
        nodes.remove(0)
    } else {
        many(nodes)
    }
}

#[cfg(test)]
mod tests {
    use super::super::expression::Expression;

    fn error(text: &str) -> (Option<usize>, String) {
        let e = text.parse::<Expression>().expect_err(text);
        (e.position, e.message)
    }

    #[test]
    fn errors_point_at_the_character() {
        let cases: [(&str, usize, &str); 22] = [
            ("", 0, "begins with the light"),
            ("D*E", 0, "begins with the light"),
            ("  DE", 2, "begins with the light"),
            ("L", 1, "the eye `E`"),
            ("LD", 2, "the eye `E`"),
            ("LxE", 1, "the eye `E`, not `x`"),
            ("LdE", 1, "the eye `E`, not `d`"),
            ("L*E", 1, "nothing to repeat"),
            ("LD|*E", 3, "nothing to repeat"),
            ("L(DE", 1, "not closed"),
            ("L((D)SE", 1, "not closed"),
            ("LD)E", 2, "the eye `E`, not `)`"),
            ("L(LDE)E", 2, "only at the start"),
            ("LDED", 3, "after the eye"),
            ("LDE|DE", 4, "begins with the light"),
            ("LD{}E", 3, "braces hold"),
            ("LD{3,1}E", 2, "m is at most n"),
            ("LD{999999999999}E", 3, "at most 255"),
            ("LD{1,2E", 6, "braces hold"),
            ("L(.{255}){255}E", 13, "more than 512 events"),
            (
                "L((((D{0}){255}){255}){255}){255}E",
                20,
                "more than 512 events",
            ),
            ("LD{255}S{255}G{3}E", 17, "more than 512 events"),
        ];
        for (text, position, part) in cases {
            let (at, message) = error(text);
            assert_eq!(at, Some(position), "{text}: {message}");
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn huge_texts_are_refused_without_a_deep_stack() {
        for text in [
            format!("L{}E", "(".repeat(100_000)),
            format!("L{}D{}E", "(".repeat(1000), ")".repeat(1000)),
            format!("LD{}E", "*".repeat(3000)),
            format!("L{}E", "D".repeat(100_000)),
        ] {
            assert!(text.parse::<Expression>().is_err());
        }
    }

    proptest::proptest! {
        #[test]
        fn no_text_panics(text in "[LEDGSV().|*+?{},0-9 x]{0,40}", any in ".{0,20}") {
            let _ = text.parse::<Expression>();
            let _ = format!("L{text}E").parse::<Expression>();
            let _ = any.parse::<Expression>();
        }
    }
}
