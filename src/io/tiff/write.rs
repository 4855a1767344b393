//! TIFF normal and parallax maps, written uncompressed and by strips.
//!
//! The container is written here: the `tiff` crate's encoder borrows itself while an image is open, so that it cannot
//! be fed row by row from outside. Everything follows TIFF 6.0, and the BigTIFF extension beyond 4 GiB.

use crate::error::{Error, Result};
use crate::io::replace::{Output, Replacement};
use crate::io::sink::{FileSink, RowEncoder, cannot_hold};
use crate::map::{CodesRef, Depth, Encoding, Size, TexelFormat};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Bytes of a strip, about: small enough to be read in pieces, large enough to be few.
const STRIP_BYTES: usize = 1 << 20;

/// Writes the rows, then the directory that describes them.
struct TiffEncoder {
    path: PathBuf,
    output: Output,
    size: Size,
    format: TexelFormat,
    /// BigTIFF, whose offsets have 64 bits.
    big: bool,
}

/// Creates a TIFF: 8 and 16-bit integers, signed for snorm, and 32-bit floats; one sample for each code of a texel.
pub(crate) fn create(path: &Path, size: Size, format: TexelFormat) -> Result<Box<FileSink>> {
    check(path, format)?;
    let replacement = Replacement::create(path)?;
    let mut encoder = TiffEncoder { path: path.into(), output: replacement.output()?, size, format, big: false };
    // The directory and its strip table take less than a hundredth of the rows, or less than a MiB.
    let whole = encoder.row_bytes() as u128 * size.height() as u128;
    encoder.big = whole + whole / 100 + (1 << 20) > u32::MAX.into();
    encoder.header(0).map_err(Error::io(path))?;
    Ok(FileSink::boxed(encoder, replacement, size, format))
}

/// Fails if a TIFF cannot hold `format`.
pub(crate) fn check(path: &Path, format: TexelFormat) -> Result<()> {
    match format.depth {
        Depth::Float16 => Err(cannot_hold(path, format, "float with 32f bits in TIFF; EXR holds 16f")),
        Depth::Bits8 | Depth::Bits16 | Depth::Float32 => Ok(()),
    }
}

/// A directory entry: a tag and its values.
struct Entry {
    tag: u16,
    values: Values,
}

enum Values {
    Short(Vec<u16>),
    /// Offsets and counts: 32 bits, or 64 in a BigTIFF.
    Long(Vec<u64>),
    Rational(u32, u32),
}

impl RowEncoder for TiffEncoder {
    fn takes_first_row_last(&self) -> bool {
        true
    }

    fn held_bytes(&self, _: usize) -> u64 {
        0
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let place = SeekFrom::Start(self.row_place(first));
        let written = self.output.seek(place).and_then(|_| self.output.write_all(rows.bytes()));
        written.map_err(Error::io(&self.path))
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        let path = self.path.clone();
        self.directory().map_err(Error::io(path))
    }
}

impl TiffEncoder {
    fn row_bytes(&self) -> usize {
        self.size.width() * self.format.bytes()
    }

    /// Where a row begins; all rows stand one after the other behind the header.
    fn row_place(&self, row: usize) -> u64 {
        self.header_bytes() + row as u64 * self.row_bytes() as u64
    }

    fn rows_per_strip(&self) -> usize {
        (STRIP_BYTES / self.row_bytes()).clamp(1, self.size.height())
    }

    fn header_bytes(&self) -> u64 {
        if self.big { 16 } else { 8 }
    }

    /// An offset or a count.
    fn long(&self, value: u64) -> Vec<u8> {
        if self.big { value.to_ne_bytes().into() } else { (value as u32).to_ne_bytes().into() }
    }

    /// The file's first bytes; codes and directory stand in this machine's byte order.
    fn header(&mut self, directory: u64) -> std::io::Result<()> {
        let order = if cfg!(target_endian = "big") { *b"MM" } else { *b"II" };
        let mut bytes = order.to_vec();
        if self.big {
            [43u16, 8, 0].iter().for_each(|word| bytes.extend(word.to_ne_bytes()));
        } else {
            bytes.extend(42u16.to_ne_bytes());
        }
        bytes.extend(self.long(directory));
        self.output.write_all(&bytes)
    }

    fn entries(&self) -> Vec<Entry> {
        let samples = self.format.channels;
        let (width, height) = (self.size.width() as u64, self.size.height() as u64);
        let (row_bytes, rows_per_strip) = (self.row_bytes() as u64, self.rows_per_strip() as u64);
        let strips = height.div_ceil(rows_per_strip);
        let offsets = (0..strips).map(|strip| self.row_place(strip as usize * self.rows_per_strip()));
        let counts = (0..strips).map(|strip| rows_per_strip.min(height - strip * rows_per_strip) * row_bytes);
        let sample_format = match self.format.encoding {
            Encoding::Unorm | Encoding::Biased => 1,
            Encoding::Snorm => 2,
            Encoding::Float => 3,
        };
        let bits = 8 * self.format.depth.bytes() as u16;
        // Two samples are no colour: one is "grey" and the other an extra sample without a meaning.
        let (photometric, extra) = match self.format.channels {
            1 => (1, None),
            3 => (2, None),
            _ => (1, Some((338, Values::Short(vec![0])))),
        };
        let mut entries = vec![
            (256, Values::Long(vec![width])),
            (257, Values::Long(vec![height])),
            (258, Values::Short(vec![bits; samples])),
            (259, Values::Short(vec![1])), // no compression
            (262, Values::Short(vec![photometric])),
            (273, Values::Long(offsets.collect())),
            (277, Values::Short(vec![samples as u16])),
            (278, Values::Long(vec![rows_per_strip])),
            (279, Values::Long(counts.collect())),
            (282, Values::Rational(1, 1)),
            (283, Values::Rational(1, 1)),
            (284, Values::Short(vec![1])), // samples of a texel stand together
            (296, Values::Short(vec![1])), // no unit of length
        ];
        entries.extend(extra);
        entries.push((339, Values::Short(vec![sample_format; samples])));
        entries.into_iter().map(|(tag, values)| Entry { tag, values }).collect()
    }

    /// Writes the directory behind the rows, and its offset into the header.
    fn directory(&mut self) -> std::io::Result<()> {
        let end = self.output.seek(SeekFrom::Start(self.row_place(self.size.height())))?;
        // A directory begins on a word boundary.
        let start = end.next_multiple_of(8);
        self.output.write_all(&vec![0; (start - end) as usize])?;

        let entries = self.entries();
        let (count_bytes, entry_bytes, value_bytes) = if self.big { (8, 20, 8) } else { (2, 12, 4) };
        // Values that are longer than their entry's field stand behind the directory.
        let mut behind = Vec::new();
        let behind_start = start + count_bytes + entry_bytes * entries.len() as u64 + value_bytes;
        let mut bytes = if self.big {
            (entries.len() as u64).to_ne_bytes().to_vec()
        } else {
            (entries.len() as u16).to_ne_bytes().to_vec()
        };
        for Entry { tag, values } in entries {
            let (kind, count, mut field) = self.field(&values);
            bytes.extend(tag.to_ne_bytes());
            bytes.extend(kind.to_ne_bytes());
            bytes.extend(self.long(count));
            if field.len() as u64 > value_bytes {
                let offset = behind_start + behind.len() as u64;
                behind.append(&mut field);
                behind.resize(behind.len().next_multiple_of(8), 0);
                field = self.long(offset);
            }
            field.resize(value_bytes as usize, 0);
            bytes.extend(field);
        }
        bytes.extend(self.long(0)); // no further directory
        bytes.extend(behind);
        self.output.write_all(&bytes)?;

        self.output.seek(SeekFrom::Start(0))?;
        self.header(start)
    }

    /// Type, number and bytes of an entry's values.
    fn field(&self, values: &Values) -> (u16, u64, Vec<u8>) {
        match values {
            Values::Short(values) => (3, values.len() as u64, values.iter().flat_map(|v| v.to_ne_bytes()).collect()),
            Values::Long(values) => {
                let kind = if self.big { 16 } else { 4 };
                (kind, values.len() as u64, values.iter().flat_map(|v| self.long(*v)).collect())
            }
            Values::Rational(over, under) => (5, 1, [over.to_ne_bytes(), under.to_ne_bytes()].concat()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::RowSink;
    use tiff::decoder::{Decoder, DecodingResult};

    #[test]
    fn a_big_tiff_differs_only_in_its_offsets() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("big.tif");
        let (size, format) =
            (Size::new(2, 3).unwrap(), TexelFormat { encoding: Encoding::Unorm, depth: Depth::Bits16, channels: 3 });
        let replacement = Replacement::create(&path).unwrap();
        let output = replacement.output().unwrap();
        let mut encoder = TiffEncoder { path: path.clone(), output, size, format, big: true };
        encoder.header(0).unwrap();
        let mut sink = FileSink::boxed(encoder, replacement, size, format);
        let codes: Vec<u16> = (0..18).map(|i| i * 3000).collect();
        sink.write(0, CodesRef::U16(&codes)).unwrap();
        sink.finish().unwrap();

        assert_eq!(std::fs::read(&path).unwrap()[2..4], 43u16.to_ne_bytes());
        let mut decoder = Decoder::new(std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!(decoder.dimensions().unwrap(), (2, 3));
        assert!(matches!(decoder.read_image().unwrap(), DecodingResult::U16(found) if found == codes));
    }
}
