//! Parallax maps in: one signed component for each texel.

use super::channel::HeightRows;
use super::input::Watch;
use super::normal::one_of;
use super::samples::Opened;
use super::{MAX_BYTES, ReadOptions, exr, limits, open_samples};
use crate::error::{Error, Result};
use crate::map::{CodeMap, Codes, Encoding, HeightType, ParallaxFormat, ParallaxMap};
use crate::stream::{RowSource, read_map};
use std::path::Path;

/// How a file becomes a parallax map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParallaxReadOptions {
    /// What the codes mean; `None`: biased for unsigned integers, snorm for signed ones, float for floats.
    pub encoding: Option<Encoding>,
    /// The most bytes that decoding one file may hold in memory at once, checked from its header and its length.
    pub max_bytes: u64,
}

impl Default for ParallaxReadOptions {
    fn default() -> Self {
        Self { encoding: None, max_bytes: MAX_BYTES }
    }
}

impl ParallaxMap {
    /// Reads a parallax map file with the default [`ParallaxReadOptions`]; warnings are dropped.
    ///
    /// # Errors
    /// As [`ParallaxMap::read_with`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::read_with(path, &ParallaxReadOptions::default()).map(|(map, _)| map)
    }

    /// Reads a parallax map file, and says in words what looks wrong in it: any file that [`super::open_heights`] reads,
    /// with one channel or several that are equal.
    ///
    /// Codes keep the file's depth: 8 or 16 bits, or 32-bit floats, which half floats become exactly and double floats
    /// rounded. What they mean is in few files:
    ///
    /// | the file holds | encoding | may be read as |
    /// | --- | --- | --- |
    /// | unsigned integers: PNG, most TIFF | biased | biased, unorm |
    /// | signed integers: TIFF | snorm | snorm |
    /// | floats: TIFF, EXR | float | float |
    ///
    /// # Errors
    /// [`Error::Parameter`] if the file's samples cannot have the encoding; [`Error::File`] if its channels differ, or a
    /// float is NaN or infinite; else as [`crate::HeightMap::read_with`].
    pub fn read_with(path: impl AsRef<Path>, options: &ParallaxReadOptions) -> Result<(Self, Vec<String>)> {
        read(path.as_ref(), options).map_err(|error| of_a_parallax_map(path.as_ref(), error))
    }
}

fn read(path: &Path, options: &ParallaxReadOptions) -> Result<(ParallaxMap, Vec<String>)> {
    let watch = Watch::at(path)?;
    let opened = watch.over(open_samples(path, exr::Wanted::Heights(None), options.max_bytes))?;
    let encoding = encoding(path, &opened, options.encoding)?;
    let is_signed = opened.signed;
    let (mut rows, warnings) = HeightRows::new(path, opened, &ReadOptions::default())?;
    limits::check_map(path, rows.size(), rows.height_type().bytes(), options.max_bytes)?;
    let map = read_map(&mut rows)?;
    let size = map.size();
    let codes = match map.into_codes() {
        // A signed sample v stands as v + 2^(b-1): the first bit is the sign.
        Codes::U8(codes) if is_signed => Codes::U8(codes.into_iter().map(|code| code ^ 0x80).collect()),
        Codes::U16(codes) if is_signed => Codes::U16(codes.into_iter().map(|code| code ^ 0x8000).collect()),
        codes => codes,
    };
    let format = ParallaxFormat { encoding, depth: codes.as_ref().depth() };
    Ok((CodeMap::new(size, format, codes)?, warnings))
}

/// What the codes of a file mean; `asked` must be possible for its samples.
fn encoding(path: &Path, opened: &Opened, asked: Option<Encoding>) -> Result<Encoding> {
    let (possible, what): (&[Encoding], _) = match (opened.samples.layout().depth, opened.signed) {
        (HeightType::F32, _) => (&[Encoding::Float], "float: the file holds floats"),
        (_, true) => (&[Encoding::Snorm], "snorm: the file holds signed integers"),
        (_, false) => (&[Encoding::Biased, Encoding::Unorm], "biased or unorm: the file holds unsigned integers"),
    };
    one_of(path, possible, what, asked)
}

/// What reading heights reports, in words for a parallax map.
fn of_a_parallax_map(path: &Path, error: Error) -> Error {
    let remedy = "give a parallax map, or bake one from the heights with texbake parallax";
    match error {
        Error::NotFinite { x, y, value } => {
            Error::file(path, format!("the texel at column {x}, row {y} is {value}"), remedy)
        }
        Error::Unclear { reason, .. } => Error::file(path, reason, remedy),
        error => error,
    }
}
