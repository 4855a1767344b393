//! Exit codes, in one place.

use std::fmt;
use std::process::ExitCode;
use texbake::Error;

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// All went well.
    Success,
    /// Something failed.
    Failed,
    /// Wrong arguments or settings; the argument parser itself ends with the same code.
    Usage,
    /// Stopped by the user: 128 and the number of SIGINT, as shells count.
    Interrupted,
}

/// Why an action could not be done at all.
#[derive(Debug)]
pub enum Failure {
    /// Wrong arguments or settings.
    Usage(String),
    /// Something failed.
    Failed(String),
}

impl Exit {
    pub fn code(self) -> u8 {
        match self {
            Self::Success => 0,
            Self::Failed => 1,
            Self::Usage => 2,
            Self::Interrupted => 130,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        exit.code().into()
    }
}

impl Failure {
    pub fn exit(&self) -> Exit {
        match self {
            Self::Usage(_) => Exit::Usage,
            Self::Failed(_) => Exit::Failed,
        }
    }

    /// An error in a settings file.
    pub fn settings(error: Error) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Parameter { parameter, value, range } => {
                Self::Usage(format!("--{parameter} is {value}: it must be {range}"))
            }
            error => Self::Failed(error.to_string()),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(reason) | Self::Failed(reason) => f.write_str(reason),
        }
    }
}
