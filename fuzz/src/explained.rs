//! What every error must say.

use std::path::Path;
use texbake::Error;

/// Fails unless an error about a file names it, and says what to do, in one line.
pub fn assert_explained(path: &Path, error: &Error) {
    let message = error.to_string();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // These two are reported beside the name of their file.
    let is_of_texel = matches!(error, Error::NotFinite { .. } | Error::NoDirection { .. });
    assert!(is_of_texel || message.contains(&*name), "{message:?} does not name {name}");
    let has_remedy = match error {
        Error::File { reason, remedy, .. } => !reason.is_empty() && !remedy.is_empty(),
        Error::Unclear { reason, values, .. } => !reason.is_empty() && !values.is_empty(),
        Error::Parameter { range, .. } => !range.is_empty(),
        // What a decoder calls an error of the system is damage, of which the system knows nothing.
        Error::Io { source, .. } => source.raw_os_error().is_some(),
        Error::TooLarge { .. } | Error::NotFinite { .. } | Error::NoDirection { .. } | Error::Vertex { .. } => true,
        _ => false,
    };
    assert!(has_remedy, "{error:?} says nothing of what to do");
    assert!(!message.contains(char::is_control), "{message:?} is not one line of plain text");
}
