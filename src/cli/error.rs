//! What can go wrong, and the exit code that tells it.

use std::fmt;

/// One sentence for the user: what is wrong and what would be right.
#[derive(Debug)]
pub enum CliError {
    /// Wrong input or usage.
    Usage(String),
    /// Failed while running.
    Failed(String),
}

impl CliError {
    /// Wrong input or usage.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::Usage(message.into())
    }

    /// Failed while running.
    pub fn failed(message: impl Into<String>) -> Self {
        Self::Failed(message.into())
    }

    /// 2 for wrong input, 1 for a failure.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Failed(_) => 1,
        }
    }
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Usage(message) | Self::Failed(message)) = self;
        f.write_str(message)
    }
}
