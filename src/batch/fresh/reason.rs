//! Why a file is baked.

use super::key::Key;
use std::fmt;
use std::path::PathBuf;

/// Whether the outputs of a job are what it would bake.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Freshness {
    /// All of them are.
    Fresh,
    /// At least one is not.
    Stale(Reason),
}

/// Why a job's outputs are not what it would bake.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// All are to be baked.
    Forced,
    /// It was not baked before.
    New,
    /// An output is there, and nothing says how it was baked.
    Unknown(PathBuf),
    /// An output was baked, and is not there any more.
    Missing(PathBuf),
    /// An output is not what was baked.
    Edited(PathBuf),
    /// An input has another content.
    Input(PathBuf),
    /// It was baked from more or fewer files.
    OtherInputs,
    /// An input or an output cannot be read, and why.
    Unreadable(PathBuf, String),
    /// Its files were not read to the end: the plan was cancelled.
    Interrupted,
    /// It was baked by other options.
    Options(Vec<Change>),
    /// Another version of texbake, which baked other bytes.
    Kernel {
        /// The version that baked it.
        from: u32,
        /// This one.
        to: u32,
    },
    /// It cannot be baked: it clashes with another file.
    Refused(String),
}

/// An option that changed, by its name in the report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// The option.
    pub option: String,
    /// Its value before, if it had one.
    pub from: Option<String>,
    /// Its value now, if it has one.
    pub to: Option<String>,
}

impl Change {
    /// What differs between two keys.
    pub(super) fn all(from: &Key, to: &Key) -> Vec<Self> {
        let gone = from.keys().filter(|option| !to.contains_key(*option));
        let differing = to.keys().filter(|option| from.get(*option) != to.get(*option));
        let change = |option: &String| Self {
            option: option.clone(),
            from: from.get(option).cloned(),
            to: to.get(option).cloned(),
        };
        differing.chain(gone).map(change).collect()
    }
}

impl fmt::Display for Freshness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fresh => f.write_str("fresh"),
            Self::Stale(reason) => reason.fmt(f),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Forced => f.write_str("forced"),
            Self::New => f.write_str("new"),
            Self::Unknown(output) => write!(f, "{} is there, and not in the record", output.display()),
            Self::Missing(output) => write!(f, "{} is missing", output.display()),
            Self::Edited(output) => write!(f, "{} was edited", output.display()),
            Self::Input(input) => write!(f, "{} changed", input.display()),
            Self::OtherInputs => f.write_str("other inputs"),
            Self::Unreadable(file, reason) => write!(f, "{} cannot be read: {reason}", file.display()),
            Self::Interrupted => f.write_str("interrupted before it was known"),
            Self::Options(changes) => {
                let changes: Vec<String> = changes.iter().map(Change::to_string).collect();
                f.write_str(&changes.join(", "))
            }
            Self::Kernel { from, to } => {
                write!(f, "texbake bakes other bytes since (kernel version {from} -> {to})")
            }
            Self::Refused(reason) => f.write_str(reason),
        }
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.option.replace('_', "-");
        let [from, to] = [&self.from, &self.to].map(|value| value.as_deref().unwrap_or("none"));
        write!(f, "{name} {from} -> {to}")
    }
}
