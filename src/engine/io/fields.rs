//! Taking a table apart field by field: every field is asked for by name and type, and what
//! nobody asked for is an error.

use glam::Vec3;

use super::error::{InputError, did_you_mean};
use super::value::{Key, Node, Value};
use crate::engine::math::Rgb;

/// The fields of one table.
pub struct Fields<'a> {
    file: &'a str,
    /// What the table is, for messages: `material "red"`.
    pub what: String,
    /// Line of the table.
    pub line: usize,
    entries: Vec<(&'a Key, &'a Node)>,
    known: Vec<&'static str>,
}

type Read<T> = Result<T, InputError>;

impl<'a> Fields<'a> {
    /// The fields of `node`, which is to be a table.
    pub fn new(file: &'a str, node: &'a Node, what: impl Into<String>) -> Read<Self> {
        let what = what.into();
        let Value::Table(entries) = &node.value else {
            let found = node.value.kind();
            let message = format!("{what} is to be a table of fields, not {found}");
            return Err(InputError::at(file, node.line, message));
        };
        let entries = entries.iter().map(|(k, v)| (k, v)).collect();
        Ok(Self {
            file,
            what,
            line: node.line,
            entries,
            known: Vec::new(),
        })
    }

    /// The file all this stands in.
    pub fn file(&self) -> &'a str {
        self.file
    }

    /// An error at `line` about this table.
    pub fn error_at(&self, line: usize, message: &str) -> InputError {
        InputError::at(self.file, line, format!("{}: {message}", self.what))
    }

    /// An error about the table as a whole.
    pub fn error(&self, message: &str) -> InputError {
        self.error_at(self.line, message)
    }

    /// Takes the value of `name`; absent and `null` are the same.
    pub fn take(&mut self, name: &'static str) -> Option<&'a Node> {
        self.known.push(name);
        let index = self.entries.iter().position(|(k, _)| k.name == name)?;
        let node = self.entries.remove(index).1;
        (!matches!(node.value, Value::Null)).then_some(node)
    }

    /// Takes the value of `name`, which must be there; `right` says what it would be.
    pub fn required(&mut self, name: &'static str, right: &str) -> Read<&'a Node> {
        match self.take(name) {
            Some(node) => Ok(node),
            None => Err(self.error(&format!("the field \"{name}\" is missing; it is {right}"))),
        }
    }

    /// Ends: a field that nobody asked for is an error.
    pub fn finish(self) -> Read<()> {
        let Some((key, _)) = self.entries.first() else {
            return Ok(());
        };
        let hint = did_you_mean(&key.name, self.known.iter().copied());
        let hint = if hint.is_empty() {
            format!("; there are {}", self.known.join(", "))
        } else {
            hint
        };
        let message = format!("there is no field \"{}\"{hint}", key.name);
        Err(self.error_at(key.line, &message))
    }

    /// What is left, for tables whose names are the user's.
    pub fn rest(self) -> Vec<(&'a Key, &'a Node)> {
        self.entries
    }

    fn wrong(&self, node: &Node, name: &str, right: &str) -> InputError {
        let found = match &node.value {
            Value::Number(x) => x.to_string(),
            Value::Text(t) => format!("\"{t}\""),
            other => other.kind().to_owned(),
        };
        self.error_at(node.line, &format!("{name} is to be {right}, not {found}"))
    }

    /// A finite number that passes `valid`.
    pub fn number_in(
        &self,
        node: &Node,
        name: &str,
        right: &str,
        valid: impl Fn(f32) -> bool,
    ) -> Read<f32> {
        match node.value {
            Value::Number(x) if (x as f32).is_finite() && valid(x as f32) => Ok(x as f32),
            _ => Err(self.wrong(node, name, right)),
        }
    }

    /// The number `name`, or `default`.
    pub fn number_or(
        &mut self,
        name: &'static str,
        default: f32,
        right: &str,
        valid: impl Fn(f32) -> bool,
    ) -> Read<f32> {
        match self.take(name) {
            Some(node) => self.number_in(node, name, right, valid),
            None => Ok(default),
        }
    }

    /// The number `name`, which must be there.
    pub fn number(
        &mut self,
        name: &'static str,
        right: &str,
        valid: impl Fn(f32) -> bool,
    ) -> Read<f32> {
        let node = self.required(name, right)?;
        self.number_in(node, name, right, valid)
    }

    /// The switch `name`, or `default`.
    pub fn switch_or(&mut self, name: &'static str, default: bool) -> Read<bool> {
        match self.take(name) {
            Some(Node {
                value: Value::Bool(b),
                ..
            }) => Ok(*b),
            Some(node) => Err(self.wrong(node, name, "true or false")),
            None => Ok(default),
        }
    }

    /// The text `name`, if it is there.
    pub fn text(&mut self, name: &'static str) -> Read<Option<(&'a str, usize)>> {
        match self.take(name) {
            Some(Node {
                value: Value::Text(t),
                line,
            }) => Ok(Some((t, *line))),
            Some(node) => Err(self.wrong(node, name, "a text")),
            None => Ok(None),
        }
    }

    /// The text `name`, which must be there.
    pub fn required_text(&mut self, name: &'static str, right: &str) -> Read<(&'a str, usize)> {
        let node = self.required(name, right)?;
        match &node.value {
            Value::Text(t) => Ok((t, node.line)),
            _ => Err(self.wrong(node, name, right)),
        }
    }

    /// The elements of the list `name`; an absent list is empty.
    pub fn list(&mut self, name: &'static str) -> Read<&'a [Node]> {
        match self.take(name) {
            Some(Node {
                value: Value::List(items),
                ..
            }) => Ok(items),
            Some(node) => Err(self.wrong(node, name, "a list")),
            None => Ok(&[]),
        }
    }

    /// Three finite numbers.
    pub fn triple(&self, node: &Node, name: &str) -> Read<[f32; 3]> {
        const RIGHT: &str = "a list of three finite numbers";
        let Value::List(items) = &node.value else {
            return Err(self.wrong(node, name, RIGHT));
        };
        if items.len() != 3 {
            let found = format!("{name} is to be {RIGHT}, not of {}", items.len());
            return Err(self.error_at(node.line, &found));
        }
        let mut triple = [0.0; 3];
        for (x, item) in triple.iter_mut().zip(items) {
            let right = "finite";
            *x = self.number_in(item, &format!("each number of {name}"), right, |_| true)?;
        }
        Ok(triple)
    }

    /// The vector `name`, which must be there.
    pub fn vector(&mut self, name: &'static str) -> Read<Vec3> {
        let node = self.required(name, "a list of three numbers")?;
        Ok(Vec3::from(self.triple(node, name)?))
    }

    /// A direction: a vector of some length.
    pub fn direction(&mut self, name: &'static str) -> Read<Vec3> {
        let node = self.required(name, "a list of three numbers, not all 0")?;
        let v = Vec3::from(self.triple(node, name)?);
        if v.try_normalize().is_none() {
            return Err(self.error_at(
                node.line,
                &format!("{name} has no length, so it points nowhere"),
            ));
        }
        Ok(v)
    }

    /// Three numbers of at least 0, or one number for all three.
    pub fn amounts(&self, node: &Node, name: &str) -> Read<Rgb> {
        let triple = match node.value {
            Value::Number(_) => {
                [self.number_in(node, name, "at least 0, or a list of three such", |x| {
                    x >= 0.0
                })?; 3]
            }
            _ => self.triple(node, name)?,
        };
        if let Some(x) = triple.iter().find(|x| **x < 0.0) {
            return Err(self.error_at(node.line, &format!("{name} is to be at least 0, not {x}")));
        }
        Ok(Rgb::from(triple))
    }
}
