//! What a TIFF's first directory claims, before the decoder makes room for it.

use crate::error::{Error, Result};
use crate::io::damage::{damaged, io_reason};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Bytes that the decoder takes for each value of an entry.
const VALUE_BYTES: u64 = 32;

/// Bytes that the decoder keeps for each strip or tile: its offset and its length.
pub(super) const CHUNK_ENTRY_BYTES: u64 = 16;

/// Bytes of a value of each type (TIFF 6.0, section 2, and BigTIFF); of one that is none of them, the least.
const TYPE_BYTES: [u64; 19] = [1, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 1, 1, 8, 8, 8];

/// Fails if an entry of the first directory claims more values than the `file_bytes` of the file hold, or than
/// `max_bytes` of memory do. What is no TIFF is left to the decoder.
pub(super) fn check(path: &Path, file: &mut (impl Read + Seek), file_bytes: u64, max_bytes: u64) -> Result<()> {
    let mut words = Words { file, is_big: false, is_little: true };
    let entries = words.entries(file_bytes).map_err(|error| io_reason(path, error))?;
    let Some(entries) = entries else {
        return Err(damaged(path, "its directory has more entries than the file holds"));
    };
    for [tag, type_, count] in entries {
        let bytes = TYPE_BYTES.get(type_ as usize).unwrap_or(&1);
        if count.checked_mul(*bytes).is_none_or(|claimed| claimed > file_bytes) {
            return Err(damaged(path, format_args!("its tag {tag} claims {count} values, more than the file holds")));
        }
        let needed = count.saturating_mul(VALUE_BYTES);
        if needed > max_bytes {
            let reason =
                format!("the {count} values of its tag {tag} take {needed} bytes, above the limit of {max_bytes}");
            return Err(Error::file(path, reason, "raise it with --max-bytes"));
        }
    }
    Ok(())
}

/// Numbers in the file's byte order; offsets and counts are longer in a BigTIFF.
struct Words<'a, F> {
    file: &'a mut F,
    is_big: bool,
    is_little: bool,
}

impl<F: Read + Seek> Words<'_, F> {
    fn number(&mut self, bytes: usize) -> std::io::Result<u64> {
        let mut word = [0; 8];
        self.file.read_exact(&mut word[..bytes])?;
        if !self.is_little {
            word[..bytes].reverse();
        }
        Ok(u64::from_le_bytes(word))
    }

    /// Tag, type and number of values of each entry; none of a file that is no TIFF; `None` if they cannot all be there.
    fn entries(&mut self, file_bytes: u64) -> std::io::Result<Option<Vec<[u64; 3]>>> {
        self.file.seek(SeekFrom::Start(0))?;
        self.is_little = self.number(2)? == u64::from(u16::from_le_bytes(*b"II"));
        self.is_big = match self.number(2)? {
            42 => false,
            43 => true,
            _ => return Ok(Some(Vec::new())),
        };
        let (count_bytes, field_bytes) = if self.is_big { (8, 8) } else { (2, 4) };
        if self.is_big {
            self.number(4)?;
        }
        let directory = self.number(field_bytes)?;
        self.file.seek(SeekFrom::Start(directory))?;
        let count = self.number(count_bytes)?;
        if count.checked_mul(12).is_none_or(|bytes| bytes > file_bytes) {
            return Ok(None);
        }
        let entry = |words: &mut Self| {
            let entry = [words.number(2)?, words.number(2)?, words.number(field_bytes)?];
            // The values, or where they stand.
            words.number(field_bytes)?;
            Ok(entry)
        };
        (0..count).map(|_| entry(self)).collect::<std::io::Result<Vec<_>>>().map(Some)
    }
}
