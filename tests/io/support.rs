//! What the tests of all formats share.

use std::path::{Path, PathBuf};
use tempfile::TempDir;
use texbake::io::{HeightFile, NormalFile, NormalReadOptions, ReadOptions, create_normals, open_heights, open_normals};
use texbake::stream::{RowSink, RowSource};
use texbake::{
    Channels, Codes, CodesRef, Convention, Depth, Encoding, Error, HeightMap, HeightType, Heights, HeightsMut,
    NormalFormat, NormalMap, Size,
};

/// Heights of any type, to compare.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    U8(Vec<u8>),
    U16(Vec<u16>),
    F32(Vec<f32>),
}

/// A folder for one test.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A file with these bytes.
    pub fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// The names in the folder, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

impl Values {
    pub fn zeroed(depth: HeightType, count: usize) -> Self {
        match depth {
            HeightType::U8 => Self::U8(vec![0; count]),
            HeightType::U16 => Self::U16(vec![0; count]),
            HeightType::F32 => Self::F32(vec![0.0; count]),
        }
    }

    pub fn part_mut(&mut self, range: std::ops::Range<usize>) -> HeightsMut<'_> {
        match self {
            Self::U8(values) => HeightsMut::U8(&mut values[range]),
            Self::U16(values) => HeightsMut::U16(&mut values[range]),
            Self::F32(values) => HeightsMut::F32(&mut values[range]),
        }
    }

    pub fn part(&self, range: std::ops::Range<usize>) -> Self {
        match self {
            Self::U8(values) => Self::U8(values[range].to_vec()),
            Self::U16(values) => Self::U16(values[range].to_vec()),
            Self::F32(values) => Self::F32(values[range].to_vec()),
        }
    }
}

pub fn values(map: &HeightMap) -> Values {
    match map.heights() {
        Heights::U8(heights) => Values::U8(heights.to_vec()),
        Heights::U16(heights) => Values::U16(heights.to_vec()),
        Heights::F32(heights) => Values::F32(heights.to_vec()),
    }
}

/// Reads the last row, wherever the rows stand, and goes back to the first.
pub fn read_last_row(rows: &mut dyn RowSource, row: HeightsMut<'_>) -> Result<(), Error> {
    rows.rewind()?;
    rows.skip(rows.size().height() - 1)?;
    rows.read(row)?;
    rows.rewind()
}

/// Reads a file at once and in every other way, which must all agree: row by row, in uneven pieces, its last row
/// before everything else, and its last row in the middle.
pub fn read_all_ways(path: &Path, options: &ReadOptions) -> Result<Values, Error> {
    let (map, _) = HeightMap::read_with(path, options)?;
    let at_once = values(&map);
    let (width, height) = (map.size().width(), map.size().height());
    let last_row = at_once.part((height - 1) * width..height * width);
    for pieces in [&[1][..], &[3, 1, 2], &[height]] {
        let HeightFile { mut rows, .. } = open_heights(path, options)?;
        assert_eq!((rows.size(), rows.height_type()), (map.size(), map.height_type()));
        let mut last = Values::zeroed(map.height_type(), width);
        read_last_row(rows.as_mut(), last.part_mut(0..width))?;
        assert_eq!(last, last_row, "last row first");

        let mut read = Values::zeroed(map.height_type(), width * height);
        let mut row = 0;
        for piece in pieces.iter().cycle() {
            let end = (row + piece).min(height);
            rows.read(read.part_mut(row * width..end * width))?;
            row = end;
            if row == height {
                break;
            }
        }
        assert_eq!(read, at_once, "in pieces of {pieces:?}");

        read_last_row(rows.as_mut(), last.part_mut(0..width))?;
        assert_eq!(last, last_row, "last row after everything");
        rows.read(read.part_mut(0..width))?;
        assert_eq!(read.part(0..width), at_once.part(0..width), "first row again");
    }
    Ok(at_once)
}

/// The message of a read that must fail.
pub fn read_error(path: &Path, options: &ReadOptions) -> String {
    let error = HeightMap::read_with(path, options).map(|_| ()).expect_err("this file must be refused");
    let message = error.to_string();
    // The user reads a folder's report: the file is named, except by errors that the report puts beside its name.
    if !matches!(error, Error::NotFinite { .. }) {
        assert!(message.contains(&*path.file_name().unwrap().to_string_lossy()), "{message}");
    }
    message
}

/// Reads a normal map at once, row by row and in uneven pieces into poisoned room, which must all agree.
pub fn read_normals_all_ways(path: &Path, options: &NormalReadOptions) -> Result<NormalMap, Error> {
    let (map, _) = NormalMap::read_with(path, options)?;
    let (format, height) = (map.format(), map.size().height());
    let row = map.codes().len() / height;
    for pieces in [&[1][..], &[3, 1, 2], &[height]] {
        let NormalFile { mut rows, .. } = open_normals(path, options)?;
        assert_eq!((rows.size(), rows.format()), (map.size(), format));
        let mut read = Codes::zeroed(format.depth, height * row);
        read.as_mut().bytes_mut().fill(0xa5);
        let mut first = 0;
        for piece in pieces.iter().cycle() {
            let end = (first + piece).min(height);
            rows.read(read.as_mut().slice(first * row..end * row))?;
            first = end;
            if first == height {
                break;
            }
        }
        assert_eq!(read.as_ref().bytes(), map.codes().bytes(), "in pieces of {pieces:?}");
    }
    Ok(map)
}

/// The message of a normal map that must be refused.
pub fn normals_error(path: &Path, options: &NormalReadOptions) -> String {
    let error = NormalMap::read_with(path, options).map(|_| ()).expect_err("this file must be refused");
    let message = error.to_string();
    assert!(message.contains(&*path.file_name().unwrap().to_string_lossy()), "{message}");
    message
}

pub fn format(encoding: Encoding, depth: Depth, channels: Channels) -> NormalFormat {
    NormalFormat { encoding, depth, channels, convention: Convention::Gl }
}

/// Writes rows one by one.
pub fn write(path: &Path, width: usize, height: usize, format: NormalFormat, codes: CodesRef) -> Result<(), Error> {
    let sink = create_normals(path, Size::new(width, height)?, format)?;
    write_rows(sink, 0..height, codes, width * format.channels.count())
}

/// Writes rows of `row` codes one by one, in this order.
pub fn write_rows(
    mut sink: Box<dyn RowSink>,
    order: impl IntoIterator<Item = usize>,
    codes: CodesRef,
    row: usize,
) -> Result<(), Error> {
    order.into_iter().try_for_each(|y| sink.write(y, codes.slice(y * row..(y + 1) * row)))?;
    sink.finish()
}

/// Deterministic noise.
pub struct Noise(pub u64);

impl Noise {
    /// The next 32 bits of a linear congruential generator (Knuth's MMIX constants).
    pub fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 32) as u32
    }
}
