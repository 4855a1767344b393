//! The zlib stream of a PNG, from parts: a stored first row, then stripes that were deflated by themselves.
//!
//! Stored blocks end on a byte's border (RFC 1951, section 3.2.4), and so do stripes: they join, and so do their
//! checksums.

use super::deflate::{STORED_HEADER, STORED_MOST, stored_header};
use png::chunk::IDAT;

/// A zlib stream's first bytes: deflate with a window of 32 KiB (RFC 1950).
const HEADER: [u8; 2] = [0x78, 0x01];

/// An empty block, the last.
const LAST_BLOCK: [u8; 5] = [1, 0, 0, 0xff, 0xff];

const ADLER_MODULUS: u64 = 65_521;

/// Bytes of the first chunk's content, with a first row of `row` bytes in it.
pub(super) fn first_bytes(row: usize) -> usize {
    HEADER.len() + row + STORED_HEADER * row.div_ceil(STORED_MOST)
}

/// The first IDAT chunk, whole: zlib's header and the stored first row.
pub(super) fn first_idat(row: &[u8]) -> Vec<u8> {
    let mut data = HEADER.to_vec();
    for block in row.chunks(STORED_MOST) {
        data.extend(stored_header(block.len()));
        data.extend_from_slice(block);
    }
    let mut checked = IDAT.0.to_vec();
    checked.extend(&data);
    let checksum = crc32fast::hash(&checked);
    [&(data.len() as u32).to_be_bytes()[..], &checked, &checksum.to_be_bytes()].concat()
}

/// The stream's end, after parts with this checksum.
pub(super) fn end(checksum: u32) -> Vec<u8> {
    [&LAST_BLOCK[..], &checksum.to_be_bytes()].concat()
}

/// The Adler-32 of two parts, the second of `length` bytes, from those of each (RFC 1950, section 8.2).
///
/// The low half is 1 plus the sum of all bytes. The high half sums the low half over all bytes: over the second part
/// it is larger by the first part's byte sum each time.
pub(super) fn adler_of_both(first: u32, second: u32, length: u64) -> u32 {
    let halves = |sum: u32| (u64::from(sum & 0xffff), u64::from(sum >> 16));
    let ((a1, b1), (a2, b2)) = (halves(first), halves(second));
    let before = (a1 + ADLER_MODULUS - 1) % ADLER_MODULUS;
    let a = (before + a2) % ADLER_MODULUS;
    let b = (b1 + b2 + length % ADLER_MODULUS * before) % ADLER_MODULUS;
    (b << 16 | a) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In the words of RFC 1950, section 8.2.
    fn adler(bytes: &[u8]) -> u32 {
        let (a, b) = bytes.iter().fold((1, 0), |(a, b), byte| {
            let a = (a + u64::from(*byte)) % ADLER_MODULUS;
            (a, (b + a) % ADLER_MODULUS)
        });
        (b << 16 | a) as u32
    }

    #[test]
    fn adler_is_as_published_and_joins() {
        assert_eq!(adler(b"Wikipedia"), 0x11e6_0398); // the example of its article
        let bytes: Vec<u8> = (0..70_000u64).map(|i| ((i * i) >> 5) as u8).collect();
        for cut in [0, 1, 5552, 69_999, 70_000] {
            let (first, second) = bytes.split_at(cut);
            assert_eq!(adler_of_both(adler(first), adler(second), second.len() as u64), adler(&bytes), "{cut}");
        }
    }

    #[test]
    fn a_long_row_is_stored_in_several_blocks() {
        for (length, blocks) in [(1, 1), (0xffff, 1), (0x1_0000, 2), (200_000, 4)] {
            assert_eq!(first_bytes(length), 2 + length + 5 * blocks);
            let chunk = first_idat(&vec![7; length]);
            // Length, type and checksum of the chunk.
            assert_eq!(chunk.len(), 12 + first_bytes(length), "{length}");
        }
    }
}
