//! Which of a texel's samples are its normal, and what they mean.

use super::NormalReadOptions;
use super::samples::{Layout, Opened, SampleRows, Samples, len, part_mut};
use crate::error::{Error, Result};
use crate::map::{Channels, CodesMut, Depth, Encoding, HeightType, HeightsMut, NormalFormat, Size};
use crate::stream::NormalSource;
use std::path::Path;

/// What the user should know about a file that says it is sRGB.
pub(super) const SRGB_WARNING: &str = "the file says that its codes are sRGB colours; a normal map is data, and they are read \
     unconverted. If they really were converted to sRGB, export the map again as linear data";

/// What the user should know about a JPEG or a lossy WebP.
const LOSSY_WARNING: &str = "its compression is lossy, which bends normals and shows as blocks in highlights; \
     export the map as PNG or TIFF";

/// The normals of a file: the first two or three samples of each texel.
pub(super) struct NormalRows {
    samples: Box<dyn SampleRows>,
    layout: Layout,
    format: NormalFormat,
    /// Whether the decoder has turned signed samples v into v + 2^(b-1).
    signed: bool,
    /// Whether floats v are stored from 0 to 1 and mean 2v - 1.
    unorm_floats: bool,
    next_row: usize,
    /// A row of samples, if they are more than the normals.
    interleaved: Samples,
}

impl NormalRows {
    /// The rows of an opened file, and what the user should know about it.
    pub fn new(path: &Path, opened: Opened, options: &NormalReadOptions) -> Result<(Self, Vec<String>)> {
        let Opened { samples, signed, lossy, mut warnings, .. } = opened;
        let layout = samples.layout();
        let stored = encoding(path, layout.depth, signed, options.encoding)?;
        let is_float = layout.depth == HeightType::F32;
        let format = NormalFormat {
            // Floats become components while they are read.
            encoding: if is_float { Encoding::Float } else { stored },
            depth: match layout.depth {
                HeightType::U8 => Depth::Bits8,
                HeightType::U16 => Depth::Bits16,
                HeightType::F32 => Depth::Float32,
            },
            channels: channels(path, layout, options.channels)?,
            convention: options.convention,
        };
        warnings.extend(lossy.then(|| LOSSY_WARNING.into()));
        let in_place = layout.per_texel() == format.channels.count();
        let interleaved = Samples::zeroed(layout.depth, if in_place { 0 } else { layout.per_row() });
        let unorm_floats = is_float && stored == Encoding::Unorm;
        Ok((Self { samples, layout, format, signed, unorm_floats, next_row: 0, interleaved }, warnings))
    }

    /// Reads rows and keeps the first samples of each texel.
    fn read_first_samples(&mut self, rows: &mut HeightsMut<'_>) -> Result<()> {
        let (count, per_texel) = (self.format.channels.count(), self.layout.per_texel());
        let per_row = self.layout.size.width() * count;
        for row in 0..len(rows) / per_row {
            self.samples.read(self.interleaved.as_mut())?;
            let place = row * per_row..(row + 1) * per_row;
            match (&self.interleaved, &mut *rows) {
                (Samples::U8(from), HeightsMut::U8(to)) => take(from, per_texel, &mut to[place], count),
                (Samples::U16(from), HeightsMut::U16(to)) => take(from, per_texel, &mut to[place], count),
                (Samples::F32(from), HeightsMut::F32(to)) => take(from, per_texel, &mut to[place], count),
                _ => unreachable!("rows are asked for in the file's own type"),
            }
        }
        Ok(())
    }
}

impl NormalSource for NormalRows {
    fn size(&self) -> Size {
        self.layout.size
    }

    fn format(&self) -> NormalFormat {
        self.format
    }

    fn read(&mut self, rows: CodesMut<'_>) -> Result<()> {
        let texel = self.format.texel();
        let (row_codes, left) = (texel.row_codes(self.layout.size.width()), self.layout.size.height() - self.next_row);
        let (count, depth) = (rows.len(), rows.depth());
        if depth != texel.depth || count % row_codes != 0 || count / row_codes > left {
            let range = format!("whole rows of {row_codes} codes of {} bits, at most {left}", texel.depth);
            return Err(Error::parameter("room for rows", format_args!("{count} codes of {depth} bits"), range));
        }
        let mut rows = match rows {
            CodesMut::U8(rows) => HeightsMut::U8(rows),
            CodesMut::U16(rows) => HeightsMut::U16(rows),
            CodesMut::F32(rows) => HeightsMut::F32(rows),
            CodesMut::F16(_) => unreachable!("half floats are read as floats"),
        };
        if self.layout.per_texel() == texel.channels {
            self.samples.read(part_mut(&mut rows, 0..count))?;
        } else {
            self.read_first_samples(&mut rows)?;
        }
        if self.signed {
            to_twos_complement(&mut rows);
        }
        if let (true, HeightsMut::F32(rows)) = (self.unorm_floats, &mut rows) {
            rows.iter_mut().for_each(|v| *v = 2.0 * *v - 1.0);
        }
        self.next_row += count / row_codes;
        Ok(())
    }

    fn held_bytes(&self) -> u64 {
        self.samples.held_bytes() + self.interleaved.bytes()
    }
}

/// What the codes of a file mean; `asked` must be possible for its samples.
fn encoding(path: &Path, depth: HeightType, signed: bool, asked: Option<Encoding>) -> Result<Encoding> {
    let (possible, what): (&[Encoding], _) = match (depth, signed) {
        (HeightType::F32, _) => {
            (&[Encoding::Float, Encoding::Unorm], "float, or unorm if they lie between 0 and 1: the file holds floats")
        }
        (_, true) => (&[Encoding::Snorm], "snorm: the file holds signed integers"),
        (_, false) => (&[Encoding::Unorm, Encoding::Biased], "unorm or biased: the file holds unsigned integers"),
    };
    one_of(path, possible, what, asked)
}

/// What was `asked` for, or else the first of what is `possible` for a file.
pub(super) fn one_of(path: &Path, possible: &[Encoding], what: &str, asked: Option<Encoding>) -> Result<Encoding> {
    let encoding = asked.unwrap_or(possible[0]);
    if possible.contains(&encoding) {
        return Ok(encoding);
    }
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    Err(Error::parameter("encoding", format_args!("{encoding}, for {name}"), what))
}

/// Which components a file stores: three or more samples are x, y and z, two are x and y.
fn channels(path: &Path, layout: Layout, asked: Option<Channels>) -> Result<Channels> {
    match (layout.colours, asked) {
        (3.., None) => Ok(Channels::Xyz),
        (3.., Some(asked)) => Ok(asked),
        (2, None | Some(Channels::Xy)) => Ok(Channels::Xy),
        (2, Some(Channels::Xyz)) => {
            Err(Error::unclear(path, "it has two channels, and no z", ("read it with", "channels", "xy")))
        }
        // The only two-channel type of some formats is grey with alpha.
        (_, Some(Channels::Xy)) if layout.alpha => Ok(Channels::Xy),
        (_, _) if layout.alpha => {
            let remedy = ("if they hold x and y, read it with", "channels", "xy");
            Err(Error::unclear(path, "it has one channel and alpha: a height map?", remedy))
        }
        _ => {
            let remedy = "give a normal map, or bake one from the heights with texbake normal";
            Err(Error::file(path, "it has one channel: a height map?", remedy))
        }
    }
}

/// Keeps the first `count` samples, two or three, of each texel of `per_texel`.
fn take<T: Copy>(samples: &[T], per_texel: usize, codes: &mut [T], count: usize) {
    match count {
        2 => take_first::<T, 2>(samples, per_texel, codes),
        _ => take_first::<T, 3>(samples, per_texel, codes),
    }
}

fn take_first<T: Copy, const N: usize>(samples: &[T], per_texel: usize, codes: &mut [T]) {
    let texels = samples.chunks_exact(per_texel);
    codes.as_chunks_mut::<N>().0.iter_mut().zip(texels).for_each(|(code, texel)| code.copy_from_slice(&texel[..N]));
}

/// Turns samples v + 2^(b-1) into v: the first bit is the sign.
fn to_twos_complement(rows: &mut HeightsMut<'_>) {
    match rows {
        HeightsMut::U8(rows) => rows.iter_mut().for_each(|code| *code ^= 0x80),
        HeightsMut::U16(rows) => rows.iter_mut().for_each(|code| *code ^= 0x8000),
        HeightsMut::F32(_) => (),
    }
}
