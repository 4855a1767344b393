//! Why a file is baked.

use super::key::{Key, NONE};
use std::collections::BTreeSet;
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

/// Why a job's outputs are not what it would bake. Paths are those of the [`Job`](crate::batch::Job).
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// All are to be baked.
    Forced,
    /// It was not baked before.
    New,
    /// This output is there, and nothing says how it was baked.
    Unknown(PathBuf),
    /// This output was baked, but not with that one: maps of one height map are baked in one pass.
    Apart(PathBuf, PathBuf),
    /// This output was baked, and is not there any more.
    Missing(PathBuf),
    /// This output is not what was baked.
    Edited(PathBuf),
    /// This input has another content: the height map, a given normal map, or a tile beside it.
    Input(PathBuf),
    /// It was baked from more or fewer files.
    OtherInputs,
    /// This input or output cannot be read, and why.
    Unreadable(PathBuf, String),
    /// Its files were not read to the end: the plan was cancelled.
    Interrupted,
    /// It was baked by other options: these, at least one.
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

/// An option that changed. Its values are in the words of the command line; `none` stands for no value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// The option's name on the command line.
    pub option: String,
    /// Its value before.
    pub from: String,
    /// Its value now.
    pub to: String,
}

impl Change {
    /// What differs between two keys. What only one of them has belongs to another option that changed, as the bits of a
    /// map to the maps that are asked for; it is told if it is all that there is.
    pub(super) fn all(Key(from): &Key, Key(to): &Key) -> Vec<Self> {
        let names: BTreeSet<&String> = from.keys().chain(to.keys()).collect();
        let differing = names.into_iter().map(|name| (name, from.get(name), to.get(name)));
        let differing: Vec<_> = differing.filter(|(_, from, to)| from != to).collect();
        let is_in_both = |(_, from, to): &(_, Option<_>, Option<_>)| from.is_some() && to.is_some();
        let is_any_in_both = differing.iter().any(is_in_both);
        let text = |value: Option<&String>| value.map_or(NONE, String::as_str).to_owned();
        let change = |(name, from, to): (&String, _, _)| Self { option: name.clone(), from: text(from), to: text(to) };
        differing.into_iter().filter(|it| !is_any_in_both || is_in_both(it)).map(change).collect()
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
            Self::Apart(output, other) => write!(f, "{} was baked apart from {}", output.display(), other.display()),
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
        write!(f, "{} {} -> {}", self.option, self.from, self.to)
    }
}
