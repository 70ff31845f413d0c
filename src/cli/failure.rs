//! The reasons why a command fails, and their exit codes.

use std::fmt;

/// A failure of the command line.
#[derive(Debug)]
pub enum Failure {
    /// The work failed: exit code 1.
    Work(anyhow::Error),
    /// The words on the command line are wrong: exit code 2.
    Usage(anyhow::Error),
}

impl Failure {
    /// The exit code for wrong usage.
    pub const USAGE: u8 = 2;

    /// Makes a failure of wrong usage.
    pub fn usage(error: impl Into<anyhow::Error>) -> Self {
        Self::Usage(error.into())
    }

    /// The exit code.
    pub fn code(&self) -> u8 {
        match self {
            Self::Work(_) => 1,
            Self::Usage(_) => Self::USAGE,
        }
    }
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Work(error.into())
    }
}

impl fmt::Display for Failure {
    /// The whole chain of causes in one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Work(error) | Self::Usage(error)) = self;
        write!(f, "{error:#}")
    }
}
