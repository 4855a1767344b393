//! The rows of normal maps, bands of them at a time, while a thread reads ahead.

use crate::error::Result;
use crate::exact::CodeReading;
use crate::map::{Channels, CodesMut, CodesRef, Depth, NormalFormat, Size};
use crate::stream::{LayerBands, LayerReader, LayerSource, Monitor, NormalSource};

/// Bytes of a band: enough for a thread to be worth waking, little enough for a cache.
const BAND_BYTES: usize = 1 << 20;

/// A normal map as a layer, its codes as they are.
struct RawLayer(Box<dyn NormalSource>);

impl LayerSource for RawLayer {
    fn depth(&self) -> Depth {
        self.0.format().depth
    }

    fn row_codes(&self) -> usize {
        self.0.format().texel().row_codes(self.0.size().width())
    }

    fn read(&mut self, rows: CodesMut<'_>) -> Result<()> {
        self.0.read(rows)
    }
}

/// Gives `look` the rows of maps of one size: the number of the first row, how many, and the codes of each map.
///
/// # Errors
/// What the sources and `look` report; [`crate::Error::Cancelled`] if `monitor` says so between two bands;
/// [`crate::Error::Threads`].
pub(super) fn for_each_band(
    sources: Vec<Box<dyn NormalSource>>,
    monitor: &Monitor,
    mut look: impl FnMut(usize, usize, &[CodesRef<'_>]) -> Result<()>,
) -> Result<()> {
    let size = sources[0].size();
    let row_bytes: usize = sources.iter().map(|source| size.width() * source.format().texel().bytes()).sum();
    let layers = sources.into_iter().map(|source| Box::new(RawLayer(source)) as Box<dyn LayerSource>).collect();
    let mut bands = LayerReader::new(layers, size.height(), (BAND_BYTES / row_bytes).max(1))?;
    let mut first_row = 0;
    monitor.check()?;
    while let Some(band) = bands.next()? {
        look(first_row, band.rows, &band.layers)?;
        first_row += band.rows;
        monitor.add((band.rows * size.width()) as u64)?;
    }
    Ok(())
}

/// The components of a row of normals as they are stored, 1 for the greatest code.
pub(super) struct Components {
    format: NormalFormat,
    codes: Option<CodeReading>,
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    /// sqrt(1 - x^2 - y^2) in maps of two channels, at least zero.
    pub z: Vec<f32>,
}

impl Components {
    /// Room for a row.
    pub fn new(size: Size, format: NormalFormat) -> Self {
        let room = || vec![0.0; size.width()];
        Self { format, codes: CodeReading::new(format.texel()), x: room(), y: room(), z: room() }
    }

    /// Reads a row; a texel without direction becomes (0, 0, 1).
    pub fn read(&mut self, row: CodesRef<'_>) {
        match (row, self.codes) {
            (CodesRef::U8(codes), Some(reading)) => self.read_integers(codes, reading),
            (CodesRef::U16(codes), Some(reading)) => self.read_integers(codes, reading),
            (CodesRef::F16(codes), _) => self.read_floats(codes, |code| code.to_f32()),
            (CodesRef::F32(codes), _) => self.read_floats(codes, |code| code),
            _ => {}
        }
    }

    fn read_integers<T: Copy + Into<u32>>(&mut self, codes: &[T], reading: CodeReading) {
        let unit = 1.0 / reading.greatest as f32;
        self.read_with(codes, |code| reading.component(code.into()) as f32 * unit);
    }

    fn read_floats<T: Copy>(&mut self, codes: &[T], float: impl Fn(T) -> f32) {
        self.read_with(codes, float);
        for ((x, y), z) in self.x.iter_mut().zip(&mut self.y).zip(&mut self.z) {
            let has_direction =
                x.abs().max(y.abs()).max(z.abs()) <= NormalFormat::GREATEST_COMPONENT && !(*x + *y + *z).is_nan();
            [*x, *y, *z] = if has_direction { [*x, *y, *z] } else { [0.0, 0.0, 1.0] };
        }
    }

    #[inline(always)]
    fn read_with<T: Copy>(&mut self, codes: &[T], component: impl Fn(T) -> f32) {
        let row = self.x.iter_mut().zip(&mut self.y).zip(&mut self.z);
        match self.format.channels {
            Channels::Xyz => row.zip(codes.chunks_exact(3)).for_each(|(((x, y), z), texel)| {
                (*x, *y, *z) = (component(texel[0]), component(texel[1]), component(texel[2]));
            }),
            Channels::Xy => row.zip(codes.chunks_exact(2)).for_each(|(((x, y), z), texel)| {
                (*x, *y) = (component(texel[0]), component(texel[1]));
                *z = (1.0 - *x * *x - *y * *y).max(0.0).sqrt();
            }),
        }
    }
}

/// Sums in a fixed order that vectorises: as many partial sums as a vector has lanes.
pub(super) const LANES: usize = 16;
