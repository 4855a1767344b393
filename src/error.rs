//! One error type, by cause.

use std::borrow::Cow;
use std::io::ErrorKind;
use std::path::PathBuf;

/// What a fallible call of this crate returns.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a bake did not happen.
///
/// Every message names what was wrong, with its value, and what would have been right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An option or a size is outside its range.
    #[error("{parameter} is {value}: it must be {range}")]
    Parameter {
        /// The parameter, as the command line and the documentation name it.
        parameter: &'static str,
        /// The value that was given.
        value: String,
        /// The values that it may take.
        range: String,
    },

    /// A height is NaN or infinite: it has no slope.
    #[error(
        "the height at column {x}, row {y} is {value}: heights must be finite numbers; \
         replace it in the map, or export the map without no-data texels"
    )]
    NotFinite {
        /// Column of the texel, from 0 on the left.
        x: usize,
        /// Row of the texel, from 0 at the top.
        y: usize,
        /// The height that was found.
        value: f32,
    },

    /// A component of a float normal map is NaN, infinite or beyond 65536: it belongs to no direction.
    #[error(
        "the normal at column {x}, row {y} has a component of {value}: components must be between -65536 and 65536; \
         texbake check --repair -o FILE makes such texels flat"
    )]
    NoDirection {
        /// Column of the texel, from 0 on the left.
        x: usize,
        /// Row of the texel, from 0 at the top.
        y: usize,
        /// The component that was found.
        value: f32,
    },

    /// A number of a mesh's vertex is NaN or infinite.
    #[error(
        "the {attribute} of vertex {vertex} is {value}: it must be finite numbers; repair the mesh where it was made"
    )]
    Vertex {
        /// What of the vertex.
        attribute: &'static str,
        /// The vertex, counted from 0.
        vertex: usize,
        /// The value that was found.
        value: String,
    },

    /// The operating system refused to read or write.
    #[error("{}: {source}{}", path.display(), remedy(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's own reason.
        source: std::io::Error,
    },

    /// A file was read, but it holds no map that can be used as it was asked.
    #[error("{}: {}; {remedy}", path.display(), plain(reason))]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
        /// The way out.
        remedy: String,
    },

    /// A file can be read in several ways, or not in the one that was asked for: an option decides.
    #[error("{}: {}; {remedy} --{option} {values}", path.display(), plain(reason))]
    Unclear {
        /// The file.
        path: PathBuf,
        /// What is not clear, or not so.
        reason: String,
        /// What to do, with the option.
        remedy: &'static str,
        /// The option, as the command line names it where there is one such file.
        option: &'static str,
        /// Values for it.
        values: &'static str,
    },

    /// A file claims a size above the limit; nothing was allocated for it.
    #[error(
        "{}: the header claims {width} x {height} texels, {bytes} bytes decoded, above the limit of {limit}; \
         raise it with --max-bytes if the file is what it claims", path.display()
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Texels in a row, as the header claims.
        width: u64,
        /// Rows, as the header claims.
        height: u64,
        /// Bytes that decoding needs in memory at once.
        bytes: u64,
        /// The limit in bytes.
        limit: u64,
    },

    /// A GPU could not be used, or failed during a job.
    #[error("{adapter}: {reason}")]
    Device {
        /// The adapter, or what was asked for.
        adapter: String,
        /// What happened.
        reason: String,
    },

    /// The system refused to start a thread.
    #[error("the system starts no more threads: {reason}; run fewer bakes at a time, or raise the limit (ulimit -u)")]
    Threads {
        /// The system's own reason.
        reason: String,
    },

    /// The job was stopped from outside.
    #[error("stopped before it was complete; no file was left under its final name")]
    Cancelled,
}

/// What a user can do about the system's reason, where that is clear.
fn remedy(error: &std::io::Error) -> &'static str {
    match error.kind() {
        ErrorKind::NotFound => "; check how its path is written",
        ErrorKind::PermissionDenied => "; change its permissions, or choose another file",
        ErrorKind::ReadOnlyFilesystem => "; choose another folder",
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists => "; a part of its path is a file, choose another folder",
        ErrorKind::IsADirectory => "; it is a folder: name a file, or bake the folder with texbake bake",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; make room, or choose another disk",
        ErrorKind::FileTooLarge => "; choose another disk, or raise the limit on the size of files (ulimit -f)",
        ErrorKind::InvalidFilename => "; choose a shorter or plainer name",
        _ => "",
    }
}

/// Text on one line: names in a file may hold what moves a terminal's cursor.
pub(crate) fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(char::is_control) {
        return text.into();
    }
    let escaped = |letter: char| if letter.is_control() { letter.escape_default().to_string() } else { letter.into() };
    text.chars().map(escaped).collect::<String>().into()
}

impl Error {
    /// A parameter outside its range.
    pub(crate) fn parameter(parameter: &'static str, value: impl ToString, range: impl Into<String>) -> Self {
        Self::Parameter { parameter, value: value.to_string(), range: range.into() }
    }

    /// The system's reason, with the file it concerns.
    pub(crate) fn io(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, source }
    }

    /// A file that cannot be used, why, and what to do about it.
    pub(crate) fn file(path: impl Into<PathBuf>, reason: impl ToString, remedy: impl Into<String>) -> Self {
        Self::File { path: path.into(), reason: reason.to_string(), remedy: remedy.into() }
    }

    /// A file that an option with one of these values makes clear.
    pub(crate) fn unclear(
        path: impl Into<PathBuf>,
        reason: impl ToString,
        (remedy, option, values): (&'static str, &'static str, &'static str),
    ) -> Self {
        Self::Unclear { path: path.into(), reason: reason.to_string(), remedy, option, values }
    }

    /// Threads that the system refused.
    pub(crate) fn threads(reason: impl ToString) -> Self {
        Self::Threads { reason: reason.to_string() }
    }

    /// A GPU that cannot do the job.
    pub(crate) fn device(adapter: impl Into<String>, reason: impl ToString) -> Self {
        Self::Device { adapter: adapter.into(), reason: reason.to_string() }
    }
}
