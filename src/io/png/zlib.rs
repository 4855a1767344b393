//! The zlib stream of a PNG whose first row is stored and whose other rows are deflated by `fdeflate`.
//!
//! Stored blocks end on a byte boundary (RFC 1951, section 3.2.4), so `fdeflate`'s blocks can follow them; only the
//! header and the checksum at the ends of its own stream are replaced.

use crate::io::replace::Output;
use fdeflate::Compressor;
use png::chunk::IDAT;
use png::{EncodingError, Writer};
use std::io;

/// Deflated bytes that go to the file as one chunk.
pub(super) const CHUNK_BYTES: usize = 256 << 10;

/// A zlib stream's first bytes: deflate with a window of 32 KiB, fastest (RFC 1950).
const ZLIB_HEADER: [u8; 2] = [0x78, 0x01];
/// Bytes of its checksum, Adler-32 of what was deflated.
const CHECKSUM_BYTES: usize = 4;
const ADLER_MODULUS: u64 = 65_521;

/// The most bytes of a stored block, and the bytes before them.
const STORED_MOST: usize = 0xffff;
const STORED_HEADER: usize = 5;

/// Bytes that `bytes` take when they are stored.
pub(super) fn stored_bytes(bytes: usize) -> usize {
    bytes + STORED_HEADER * bytes.div_ceil(STORED_MOST)
}

/// The first IDAT chunk, whole: zlib's header and the stored first row.
pub(super) fn first_idat(row: &[u8]) -> Vec<u8> {
    let mut data = ZLIB_HEADER.to_vec();
    for block in row.chunks(STORED_MOST) {
        let length = block.len() as u16;
        data.push(0); // stored, and not the last block
        data.extend(length.to_le_bytes());
        data.extend((!length).to_le_bytes());
        data.extend_from_slice(block);
    }
    let mut checked = IDAT.0.to_vec();
    checked.extend(&data);
    let checksum = crc32fast::hash(&checked);
    [&(data.len() as u32).to_be_bytes()[..], &checked, &checksum.to_be_bytes()].concat()
}

/// Deflates rows into IDAT chunks.
pub(super) struct IdatStream {
    deflate: Compressor<Chunks>,
    /// Bytes that were deflated.
    bytes: u64,
}

/// What comes out of deflate, cut into chunks.
///
/// Nothing here fails before the end: `fdeflate` would panic. The file remembers what it met, and so does this.
struct Chunks {
    writer: Writer<Output>,
    /// Bytes of the header that are still to be dropped.
    drop: usize,
    pending: Vec<u8>,
    failure: Option<EncodingError>,
}

impl IdatStream {
    pub fn new(writer: Writer<Output>) -> Self {
        let chunks = Chunks { writer, drop: ZLIB_HEADER.len(), pending: Vec::new(), failure: None };
        let deflate = Compressor::new(chunks).expect("chunks take every byte");
        Self { deflate, bytes: 0 }
    }

    /// Deflates a filtered row.
    pub fn write(&mut self, row: &[u8]) {
        self.bytes += row.len() as u64;
        self.deflate.write_data(row).expect("chunks take every byte");
    }

    /// Writes what is left of the stream, whose checksum begins with the stored first row, and the file's last chunk.
    pub fn finish(self, first_row: &[u8]) -> Result<(), EncodingError> {
        let mut chunks = self.deflate.finish().expect("chunks take every byte");
        let body = chunks.pending.len() - CHECKSUM_BYTES;
        let own = chunks.pending.split_off(body);
        let deflated = u32::from_be_bytes([own[0], own[1], own[2], own[3]]);
        chunks.pending.extend(adler_of_both(adler(first_row), deflated, self.bytes).to_be_bytes());
        chunks.send(chunks.pending.len());
        match chunks.failure {
            Some(failure) => Err(failure),
            None => chunks.writer.finish(),
        }
    }
}

impl Chunks {
    /// Writes the first `count` pending bytes as a chunk.
    fn send(&mut self, count: usize) {
        if self.failure.is_none() {
            self.failure = self.writer.write_chunk(IDAT, &self.pending[..count]).err();
        }
        self.pending.drain(..count);
    }
}

impl io::Write for Chunks {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let dropped = self.drop.min(bytes.len());
        self.drop -= dropped;
        self.pending.extend_from_slice(&bytes[dropped..]);
        // The last bytes may be the checksum, which is replaced.
        if self.pending.len() >= CHUNK_BYTES + CHECKSUM_BYTES {
            self.send(CHUNK_BYTES);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Adler-32 (RFC 1950, section 8.2).
fn adler(bytes: &[u8]) -> u32 {
    let (a, b) = bytes.iter().fold((1, 0), |(a, b), byte| {
        let a = (a + u64::from(*byte)) % ADLER_MODULUS;
        (a, (b + a) % ADLER_MODULUS)
    });
    (b << 16 | a) as u32
}

/// The Adler-32 of two parts, the second of `length` bytes, from those of each.
///
/// The low half is 1 plus the sum of all bytes. The high half sums the low half over all bytes: over the second part
/// it is larger by the first part's byte sum each time.
fn adler_of_both(first: u32, second: u32, length: u64) -> u32 {
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
        assert_eq!(stored_bytes(1), 6);
        assert_eq!(stored_bytes(0xffff), 0xffff + 5);
        assert_eq!(stored_bytes(0x1_0000), 0x1_0000 + 10);
        for length in [1, 0xffff, 0x1_0000, 200_000] {
            let chunk = first_idat(&vec![7; length]);
            // Length, type and checksum of the chunk, and zlib's header.
            assert_eq!(chunk.len(), 12 + 2 + stored_bytes(length), "{length}");
        }
    }
}
