//! Normal maps, masks and heights as layers.

use super::layers::LayerSource;
use super::monitor::Monitor;
use super::reader::RowSource;
use crate::error::{Error, Result};
use crate::map::{Codes, CodesMut, CodesRef, Depth, HeightMap, HeightType, Heights, HeightsMut, NormalFormat};
use crate::map::{NormalMap, Size};
use std::borrow::Borrow;

/// A normal map that is read from the top.
pub trait NormalSource: Send {
    /// Width and height.
    fn size(&self) -> Size;

    /// What its codes mean.
    fn format(&self) -> NormalFormat;

    /// Reads the next rows: as many as `rows` has room for, never more than are left.
    ///
    /// # Errors
    /// The reason that the file gives.
    fn read(&mut self, rows: CodesMut<'_>) -> Result<()>;

    /// Bytes that the source holds at most while it is read, without the rows that it gives.
    fn held_bytes(&self) -> u64;
}

impl NormalSource for Box<dyn NormalSource> {
    fn held_bytes(&self) -> u64 {
        self.as_ref().held_bytes()
    }

    fn size(&self) -> Size {
        self.as_ref().size()
    }

    fn format(&self) -> NormalFormat {
        self.as_ref().format()
    }

    fn read(&mut self, rows: CodesMut<'_>) -> Result<()> {
        self.as_mut().read(rows)
    }
}

/// Reads a whole normal map.
///
/// # Errors
/// As [`NormalSource::read`].
pub fn read_normals(source: &mut dyn NormalSource) -> Result<NormalMap> {
    read_normals_watched(source, &Monitor::default())
}

/// Rows of a map that are read between two looks at the monitor.
const PIECE_ROWS: usize = 64;

/// Reads a whole normal map, unless the monitor ends it.
///
/// # Errors
/// As [`NormalSource::read`], and [`Error::Cancelled`].
pub(crate) fn read_normals_watched(source: &mut dyn NormalSource, monitor: &Monitor) -> Result<NormalMap> {
    let mut map = NormalMap::zeroed(source.size(), source.format());
    let row_codes = source.format().texel().row_codes(source.size().width());
    for piece in map.codes_mut().chunks(PIECE_ROWS * row_codes) {
        monitor.check()?;
        source.read(piece)?;
    }
    Ok(map)
}

impl NormalMap {
    /// The rows of this map, from the top, for what reads a map row by row.
    pub fn into_rows(self) -> Box<dyn NormalSource> {
        let size = self.size();
        Box::new(Tiled::new(self, size))
    }
}

/// A normal map in memory, repeated from its first texel on, or cut, to fill another size.
pub(crate) struct Tiled<M> {
    map: M,
    size: Size,
    next_row: usize,
}

impl<M: Borrow<NormalMap>> Tiled<M> {
    pub fn new(map: M, size: Size) -> Self {
        Self { map, size, next_row: 0 }
    }
}

impl<M: Borrow<NormalMap> + Send> NormalSource for Tiled<M> {
    fn size(&self) -> Size {
        self.size
    }

    fn format(&self) -> NormalFormat {
        self.map.borrow().format()
    }

    fn read(&mut self, mut rows: CodesMut<'_>) -> Result<()> {
        let map = self.map.borrow();
        let bytes_of = |size: Size| size.width() * map.format().texel().bytes();
        for row in rows.bytes_mut().chunks_exact_mut(bytes_of(self.size)) {
            let first = self.next_row % map.size().height() * bytes_of(map.size());
            let from = &map.codes().bytes()[first..][..bytes_of(map.size())];
            row.chunks_mut(from.len()).for_each(|to| to.copy_from_slice(&from[..to.len()]));
            self.next_row += 1;
        }
        Ok(())
    }

    /// The map, whoever made it.
    fn held_bytes(&self) -> u64 {
        self.map.borrow().codes().bytes().len() as u64
    }
}

/// A normal map as a layer; its floats are checked as they pass.
pub(crate) struct NormalLayer<S> {
    source: S,
    next_row: usize,
}

impl<S: NormalSource> NormalLayer<S> {
    pub fn new(source: S) -> Self {
        Self { source, next_row: 0 }
    }
}

impl<S: NormalSource> LayerSource for NormalLayer<S> {
    fn depth(&self) -> Depth {
        self.source.format().depth
    }

    fn row_codes(&self) -> usize {
        self.source.format().texel().row_codes(self.source.size().width())
    }

    fn read(&mut self, mut rows: CodesMut<'_>) -> Result<()> {
        let all = 0..rows.len();
        self.source.read(rows.slice(all))?;
        let (width, format) = (self.source.size().width(), self.source.format());
        check_components(rows.as_ref(), format, width, self.next_row)?;
        self.next_row += rows.len() / self.row_codes();
        Ok(())
    }
}

/// Fails on the first float component that is no direction's: NaN, infinite or beyond 65536. The rows are `width`
/// texels wide and begin with row `first_row`.
pub(crate) fn check_components(
    codes: CodesRef<'_>,
    format: NormalFormat,
    width: usize,
    first_row: usize,
) -> Result<()> {
    // NaN compares as not within.
    let is_within = |value: f32| value.abs() <= NormalFormat::GREATEST_COMPONENT;
    let found = match codes {
        CodesRef::U8(_) | CodesRef::U16(_) => None,
        CodesRef::F16(codes) => codes.iter().position(|code| !is_within(code.to_f32())).map(|i| (i, codes[i].to_f32())),
        CodesRef::F32(codes) => codes.iter().position(|code| !is_within(*code)).map(|i| (i, codes[i])),
    };
    let Some((i, value)) = found else { return Ok(()) };
    let texel = i / format.channels.count();
    Err(Error::NoDirection { x: texel % width, y: first_row + texel / width, value })
}

/// The heights of a source as a layer.
pub(crate) struct HeightLayer {
    source: Box<dyn RowSource>,
    next_row: usize,
}

impl HeightLayer {
    pub fn new(source: Box<dyn RowSource>) -> Self {
        Self { source, next_row: 0 }
    }
}

impl LayerSource for HeightLayer {
    fn depth(&self) -> Depth {
        match self.source.height_type() {
            HeightType::U8 => Depth::Bits8,
            HeightType::U16 => Depth::Bits16,
            HeightType::F32 => Depth::Float32,
        }
    }

    fn row_codes(&self) -> usize {
        self.source.size().width()
    }

    fn read(&mut self, rows: CodesMut<'_>) -> Result<()> {
        match rows {
            CodesMut::U8(rows) => self.source.read(HeightsMut::U8(rows)),
            CodesMut::U16(rows) => self.source.read(HeightsMut::U16(rows)),
            CodesMut::F32(rows) => {
                self.source.read(HeightsMut::F32(rows))?;
                let width = self.source.size().width();
                Heights::F32(rows).check_finite(width, self.next_row)?;
                self.next_row += rows.len() / width;
                Ok(())
            }
            CodesMut::F16(_) => unreachable!("no height is a half"),
        }
    }
}

/// A mask as a layer: integer codes; floats are rounded to 16 bits.
pub(crate) struct MaskLayer {
    source: Box<dyn RowSource>,
    /// A row of floats.
    floats: Vec<f32>,
    next_row: usize,
}

impl MaskLayer {
    pub fn new(source: Box<dyn RowSource>) -> Self {
        let floats = if source.height_type() == HeightType::F32 { source.size().width() } else { 0 };
        Self { floats: vec![0.0; floats], source, next_row: 0 }
    }
}

impl LayerSource for MaskLayer {
    fn depth(&self) -> Depth {
        if self.source.height_type() == HeightType::U8 { Depth::Bits8 } else { Depth::Bits16 }
    }

    fn row_codes(&self) -> usize {
        self.source.size().width()
    }

    fn read(&mut self, rows: CodesMut<'_>) -> Result<()> {
        match rows {
            CodesMut::U8(rows) => self.source.read(HeightsMut::U8(rows)),
            CodesMut::U16(rows) if self.floats.is_empty() => self.source.read(HeightsMut::U16(rows)),
            CodesMut::U16(rows) => {
                for row in rows.chunks_exact_mut(self.floats.len()) {
                    self.source.read(HeightsMut::F32(&mut self.floats))?;
                    Heights::F32(&self.floats).check_finite(self.floats.len(), self.next_row)?;
                    self.next_row += 1;
                    row.iter_mut().zip(&self.floats).for_each(|(code, t)| *code = transition_code(*t));
                }
                Ok(())
            }
            CodesMut::F16(_) | CodesMut::F32(_) => unreachable!("a mask holds integers"),
        }
    }
}

/// The 16-bit code nearest to a transition; below 0 and above 1 count as 0 and 1.
fn transition_code(t: f32) -> u16 {
    (f64::from(t.clamp(0.0, 1.0)) * 65_535.0 + 0.5) as u16
}

/// The codes of a mask in memory that holds floats; other masks hold codes as they are.
pub(crate) fn rounded_mask(mask: &HeightMap) -> Option<Codes> {
    let Heights::F32(heights) = mask.heights() else { return None };
    Some(Codes::U16(heights.iter().map(|t| transition_code(*t)).collect()))
}

/// Heights in memory as codes.
pub(crate) fn height_codes(heights: Heights<'_>) -> CodesRef<'_> {
    match heights {
        Heights::U8(heights) => CodesRef::U8(heights),
        Heights::U16(heights) => CodesRef::U16(heights),
        Heights::F32(heights) => CodesRef::F32(heights),
    }
}
