//! What is wrong with an input, in one sentence.

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
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file, self.message),
            None => write!(f, "{}: {}", self.file, self.message),
        }
    }
}

impl std::error::Error for InputError {}

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
