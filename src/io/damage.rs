//! What is said about damaged files, in every format.

use crate::error::Error;
use std::io::{self, ErrorKind};
use std::path::Path;

/// The file ends too early.
pub(super) fn truncated(path: &Path) -> Error {
    Error::file(path, "the file ends before its last row: it is truncated", "copy or export it again")
}

/// The file is not what its format demands, for `reason`.
pub(super) fn damaged(path: &Path, reason: impl ToString) -> Error {
    // Some decoders end a line or a sentence, where the rest follows here.
    let reason = reason.to_string();
    let reason = reason.trim_end_matches(|end: char| end == '.' || end.is_whitespace());
    Error::file(path, reason, "it is damaged; copy or export it again")
}

/// What a decoder calls an error of the system: only one with the system's number is; others are damage.
pub(super) fn io_reason(path: &Path, error: io::Error) -> Error {
    match error.kind() {
        ErrorKind::UnexpectedEof => truncated(path),
        _ if error.raw_os_error().is_none() => damaged(path, error),
        _ => Error::io(path)(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_of_a_decoder_goes_on() {
        for reason in ["Unknown filter method 7", "Unknown filter method 7.", "Unknown filter method 7.\n"] {
            let message = damaged(Path::new("a.png"), reason).to_string();
            assert_eq!(message, "a.png: Unknown filter method 7; it is damaged; copy or export it again");
        }
    }
}
