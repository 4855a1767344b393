//! Which of a texel's samples is its height.

use super::samples::{Layout, NoData, Opened, SampleRows, Samples, copy, len, part_mut};
use super::srgb::{self, SrgbTable};
use super::{ColorSpace, ReadOptions};
use crate::error::{Error, Result};
use crate::map::{HeightType, Heights, HeightsMut, Size};
use crate::stream::RowSource;
use std::convert::Infallible;
use std::fmt::{self, Display};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A channel of a colour file.
///
/// As text: `r`, `g`, `b`, `a`, `luma` in any case; anything else is the name of an EXR channel.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Red, or the first band; the height of a grey file.
    R,
    /// Green, or the second band; the height of a grey file.
    G,
    /// Blue, or the third band; the height of a grey file.
    B,
    /// Alpha.
    A,
    /// Rec. 709 luma of the codes: (13933 R + 46871 G + 4732 B + 32768) >> 16 for integers,
    /// 0.2126 R + 0.7152 G + 0.0722 B for floats; the height of a grey file.
    Luma,
    /// An EXR channel by its name.
    Named(String),
}

impl FromStr for Channel {
    type Err = Infallible;

    fn from_str(name: &str) -> Result<Self, Infallible> {
        Ok(match name.to_ascii_lowercase().as_str() {
            "r" => Self::R,
            "g" => Self::G,
            "b" => Self::B,
            "a" => Self::A,
            "luma" => Self::Luma,
            _ => Self::Named(name.into()),
        })
    }
}

impl Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::R => "r",
            Self::G => "g",
            Self::B => "b",
            Self::A => "a",
            Self::Luma => "luma",
            Self::Named(name) => name,
        })
    }
}

/// How a texel's samples become its height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pick {
    /// The sample with this index.
    One(usize),
    /// The first sample; the other colours must be equal to it.
    Equal,
    /// Rec. 709 luma of the first three.
    Luma,
}

/// The heights of a file: one picked from the samples of each texel.
pub(super) struct HeightRows {
    path: PathBuf,
    samples: Box<dyn SampleRows>,
    layout: Layout,
    pick: Pick,
    srgb: Option<SrgbTable>,
    no_data: Option<NoData>,
    /// Whether the file's samples are the heights; else a row of samples, and the heights picked from it, are held.
    in_place: bool,
    next_row: usize,
    interleaved: Samples,
    picked: Samples,
}

impl Pick {
    /// The rule for a file of `layout`.
    fn new(path: &Path, layout: Layout, channel: Option<&Channel>) -> Result<Self> {
        let lacks =
            |what: String, remedy: &'static str, values| Err(Error::unclear(path, what, (remedy, "channel", values)));
        let index = match channel {
            None if layout.colours == 1 => 0,
            None => return Ok(Self::Equal),
            Some(Channel::A) if layout.alpha => layout.colours,
            Some(Channel::A) => {
                return lacks("it has no alpha channel".into(), "choose another with", "r, g, b or luma");
            }
            Some(Channel::Named(name)) => {
                let what = format!("channels have names in EXR files only, and {name} was asked for");
                return lacks(what, "choose one with", "r, g, b, a or luma");
            }
            Some(Channel::R | Channel::G | Channel::B | Channel::Luma) if layout.colours == 1 => 0,
            Some(Channel::Luma) if layout.colours == 3 => return Ok(Self::Luma),
            Some(Channel::Luma) => {
                let what = format!("it has {} channels, and luma needs red, green and blue", layout.colours);
                return lacks(what, "choose one with", "r or g");
            }
            Some(Channel::R) => 0,
            Some(Channel::G) => 1,
            Some(Channel::B) if layout.colours > 2 => 2,
            Some(Channel::B) => {
                return lacks("it has two channels, and no third".into(), "choose another with", "r or g");
            }
        };
        Ok(Self::One(index))
    }
}

/// A sample whose luma can be taken.
trait Texel: Copy + PartialEq + Display {
    /// Rec. 709 luma.
    fn luma(red: Self, green: Self, blue: Self) -> Self;

    /// The sample, if it is NaN or infinite.
    fn not_finite(self) -> Option<f32> {
        None
    }
}

/// Rec. 709 weights in units of 2^-16, which sum to 1 exactly, and half a unit: the nearest code, ties up.
fn luma_code(red: u32, green: u32, blue: u32) -> u32 {
    (13933 * red + 46871 * green + 4732 * blue + 32768) >> 16
}

impl Texel for u8 {
    fn luma(red: u8, green: u8, blue: u8) -> u8 {
        luma_code(red.into(), green.into(), blue.into()) as u8
    }
}

impl Texel for u16 {
    fn luma(red: u16, green: u16, blue: u16) -> u16 {
        luma_code(red.into(), green.into(), blue.into()) as u16
    }
}

impl Texel for f32 {
    fn luma(red: f32, green: f32, blue: f32) -> f32 {
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    fn not_finite(self) -> Option<f32> {
        (!self.is_finite()).then_some(self)
    }
}

impl HeightRows {
    /// The rows of an opened file, and what the user should know about it.
    pub fn new(path: &Path, opened: Opened, options: &ReadOptions) -> Result<(Self, Vec<String>)> {
        let layout = opened.samples.layout();
        // A decoder that found a named channel gives that one alone; luma is still to be taken.
        let channel = options.channel.as_ref().filter(|channel| !opened.channel_found || **channel == Channel::Luma);
        let pick = Pick::new(path, layout, channel)?;
        let srgb = match options.color_space {
            ColorSpace::Linear => None,
            ColorSpace::Srgb => Some(SrgbTable::new(layout.depth).ok_or_else(|| {
                let reason = "it holds floats, and only integer codes can have been saved as sRGB by mistake";
                Error::file(path, reason, "leave out --color-space srgb")
            })?),
        };
        let mut warnings = opened.warnings;
        if opened.says_srgb && srgb.is_none() {
            warnings.push(srgb::WARNING.into());
        }
        let in_place = layout.per_texel() == 1 && srgb.is_none();
        let buffered_rows = usize::from(!in_place);
        let rows = Self {
            path: path.into(),
            samples: opened.samples,
            layout,
            pick,
            srgb,
            no_data: opened.no_data,
            in_place,
            next_row: 0,
            interleaved: Samples::zeroed(layout.depth, buffered_rows * layout.per_row()),
            picked: Samples::zeroed(layout.depth, buffered_rows * layout.size.width()),
        };
        Ok((rows, warnings))
    }

    /// Goes to the row that shall be read next.
    fn seek(&mut self, row: usize) -> Result<()> {
        self.samples.seek(row)?;
        self.next_row = row;
        Ok(())
    }

    /// Reads the row `row` and picks its heights.
    fn read_row(&mut self, row: usize, mut heights: HeightsMut<'_>) -> Result<()> {
        self.samples.read(self.interleaved.as_mut())?;
        let (path, pick, layout) = (&self.path, self.pick, self.layout);
        match (&self.interleaved, &mut self.picked) {
            (Samples::U8(from), Samples::U8(to)) => pick_row(path, pick, layout, row, from, to)?,
            (Samples::U16(from), Samples::U16(to)) => pick_row(path, pick, layout, row, from, to)?,
            (Samples::F32(from), Samples::F32(to)) => pick_row(path, pick, layout, row, from, to)?,
            _ => unreachable!("both are made of the file's own type"),
        }
        match (&self.srgb, &mut heights) {
            (Some(table), HeightsMut::U16(heights)) => table.decode(self.picked.as_ref(), heights),
            _ => copy(self.picked.as_ref(), &mut heights),
        }
        Ok(())
    }

    /// Fails on the first height that means "no data".
    fn check_data(&self, heights: Heights<'_>) -> Result<()> {
        let Some(NoData { height: no_data, text }) = &self.no_data else { return Ok(()) };
        let no_data = *no_data;
        let found = match heights {
            Heights::U8(heights) => heights.iter().position(|&height| f32::from(height) == no_data),
            Heights::U16(heights) => heights.iter().position(|&height| f32::from(height) == no_data),
            Heights::F32(heights) => heights.iter().position(|&height| height == no_data),
        };
        let Some(i) = found else { return Ok(()) };
        let (x, y) = (i % self.layout.size.width(), self.next_row + i / self.layout.size.width());
        let reason = format!("the texel at column {x}, row {y} holds {text}, the file's no-data value");
        let remedy = format!(
            "fill the holes with gdal_fillnodata, crop the map, or, if {text} is a height, remove the mark with \
             gdal_edit -unsetnodata"
        );
        Err(Error::file(&self.path, reason, remedy))
    }
}

impl RowSource for HeightRows {
    fn size(&self) -> Size {
        self.layout.size
    }

    fn height_type(&self) -> HeightType {
        if self.srgb.is_some() { HeightType::U16 } else { self.layout.depth }
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        let (width, left) = (self.layout.size.width(), self.layout.size.height() - self.next_row);
        let (count, given) = (len(&rows), rows.as_ref().height_type());
        if given != self.height_type() || count % width != 0 || count / width > left {
            let range = format!("whole rows of {width} {} heights, at most {left}", self.height_type());
            return Err(Error::parameter("room for rows", format_args!("{count} {given} heights"), range));
        }
        if self.in_place {
            self.samples.read(part_mut(&mut rows, 0..count))?;
        } else {
            for row in 0..count / width {
                self.read_row(self.next_row + row, part_mut(&mut rows, row * width..(row + 1) * width))?;
            }
        }
        rows.as_ref().check_finite(width, self.next_row)?;
        self.check_data(rows.as_ref())?;
        self.next_row += count / width;
        Ok(())
    }

    fn skip(&mut self, rows: usize) -> Result<()> {
        self.seek(self.next_row + rows)
    }

    fn rewind(&mut self) -> Result<()> {
        self.seek(0)
    }

    fn last_row_is_near(&self) -> bool {
        self.samples.last_row_is_near()
    }

    fn held_bytes(&self) -> u64 {
        self.samples.held_bytes() + self.interleaved.bytes() + self.picked.bytes()
    }
}

/// Picks the heights of one row.
fn pick_row<T: Texel>(
    path: &Path,
    pick: Pick,
    layout: Layout,
    row: usize,
    samples: &[T],
    heights: &mut [T],
) -> Result<()> {
    let texels = samples.chunks_exact(layout.per_texel());
    match pick {
        Pick::One(index) => heights.iter_mut().zip(texels).for_each(|(height, texel)| *height = texel[index]),
        Pick::Luma => {
            for (height, texel) in heights.iter_mut().zip(texels) {
                *height = T::luma(texel[0], texel[1], texel[2]);
            }
        }
        Pick::Equal => {
            for (column, (height, texel)) in heights.iter_mut().zip(texels).enumerate() {
                let colours = &texel[..layout.colours];
                if colours.iter().any(|colour| *colour != colours[0]) {
                    return Err(channels_differ(path, column, row, colours));
                }
                *height = colours[0];
            }
        }
    }
    Ok(())
}

/// A colour file was given where a grey one was expected, or one of the colours is no number: NaN differs from itself.
fn channels_differ<T: Texel>(path: &Path, column: usize, row: usize, colours: &[T]) -> Error {
    if let Some(value) = colours.iter().find_map(|colour| colour.not_finite()) {
        return Error::NotFinite { x: column, y: row, value };
    }
    let values: Vec<String> = colours.iter().map(T::to_string).collect();
    let values = values.join(", ");
    let reason = format!("its channels differ, first at column {column}, row {row}: {values}");
    Error::unclear(path, reason, ("choose one with", "channel", "r, g, b, a or luma"))
}
