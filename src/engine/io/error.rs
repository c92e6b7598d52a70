//! What is wrong with an input, in one sentence.

use std::borrow::Cow;
use std::fmt;

/// Something a user gave cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputError {
    /// The file.
    pub file: String,
    /// Line from 1, where it is known.
    pub line: Option<usize>,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl InputError {
    /// An error in a whole file.
    pub fn in_file(file: &str, message: impl Into<String>) -> Self {
        Self {
            file: file.to_owned(),
            line: None,
            message: message.into(),
        }
    }

    /// An error at a line.
    pub fn at(file: &str, line: usize, message: impl Into<String>) -> Self {
        Self {
            file: file.to_owned(),
            line: Some(line),
            message: message.into(),
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (file, message) = (one_line(&self.file), one_line(&self.message));
        match self.line {
            Some(line) => write!(f, "{file}:{line}: {message}"),
            None => write!(f, "{file}: {message}"),
        }
    }
}

impl std::error::Error for InputError {}

/// Longest part of a sentence: what stands in a file is quoted, and may be of any length.
const LONGEST: usize = 1000;

/// The text in one line, its middle left out if it is very long.
fn one_line(text: &str) -> Cow<'_, str> {
    if text.len() <= LONGEST && !text.contains(char::is_control) {
        return Cow::Borrowed(text);
    }
    let count = text.chars().count();
    let shown = |(i, c): (usize, char)| match c {
        _ if i >= LONGEST / 2 && i + LONGEST / 2 < count => None,
        c if c.is_control() => Some(c.escape_default().to_string()),
        c => Some(c.to_string()),
    };
    let mut parts: Vec<Option<String>> = text.chars().enumerate().map(shown).collect();
    parts.dedup_by(|a, b| a.is_none() && b.is_none());
    let parts = parts
        .into_iter()
        .map(|part| part.unwrap_or(" … ".to_owned()));
    Cow::Owned(parts.collect())
}

/// `; did you mean "name"?` for the nearest of `names`, empty if none is near.
pub fn did_you_mean<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    // A word of more than half of its letters wrong is no slip; a beginning is one.
    let begins = |name: &str| word.len() > 2 && name.starts_with(word);
    let slips = |name: &str| strsim::damerau_levenshtein(word, name) <= (word.len() / 2).max(1);
    let near = |name: &&str| begins(name) || slips(name);
    let distance = |name: &&str| strsim::damerau_levenshtein(word, name);
    let nearest = names.into_iter().filter(|n| near(n)).min_by_key(distance);
    nearest.map_or_else(String::new, |n| format!("; did you mean \"{n}\"?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_one_line_of_bounded_length() {
        let said = |message: &str| InputError::in_file("a", message).to_string();
        assert_eq!(said("short"), "a: short");
        assert_eq!(said("two\nlines"), "a: two\\nlines");
        let long = said(&"é".repeat(1_000_000));
        assert!(long.chars().count() < 1100 && long.contains(" … "));
    }
}
