//! Bands of several maps that lie over each other, for operations that look at one texel of each.

use super::ahead::ReadAhead;
use super::channel::Filling;
use crate::error::Result;
use crate::map::{Codes, CodesMut, CodesRef, Depth};

/// The same rows of several maps.
#[derive(Debug, Clone)]
pub(crate) struct LayerBand<'a> {
    /// Number of rows.
    pub rows: usize,
    /// The rows of each map, one after the other.
    pub layers: Vec<CodesRef<'a>>,
}

/// Bands of layers, from the top, without gap or overlap.
pub(crate) trait LayerBands {
    /// The next band; `None` after the last.
    ///
    /// # Errors
    /// What a map's source reports.
    fn next(&mut self) -> Result<Option<LayerBand<'_>>>;
}

/// One map that is read from the top.
pub(crate) trait LayerSource: Send {
    /// How a code is stored.
    fn depth(&self) -> Depth;

    /// Codes of a row.
    fn row_codes(&self) -> usize;

    /// Reads the next rows: as many as `rows` has room for, never more than are left.
    ///
    /// # Errors
    /// The reason that the file gives.
    fn read(&mut self, rows: CodesMut<'_>) -> Result<()>;
}

/// Bands of maps in memory.
pub(crate) struct MapLayers<'a> {
    /// All codes of each map.
    layers: Vec<CodesRef<'a>>,
    /// Rows of each map.
    height: usize,
    band_rows: usize,
    next_row: usize,
}

impl<'a> MapLayers<'a> {
    /// All rows of maps of `height` rows, `band_rows` at a time.
    pub fn new(layers: Vec<CodesRef<'a>>, height: usize, band_rows: usize) -> Self {
        assert!(band_rows > 0, "a band has rows");
        Self { layers, height, band_rows, next_row: 0 }
    }
}

impl LayerBands for MapLayers<'_> {
    fn next(&mut self) -> Result<Option<LayerBand<'_>>> {
        let (first, end) = (self.next_row, self.next_row.saturating_add(self.band_rows).min(self.height));
        self.next_row = end;
        let rows = |layer: &CodesRef<'_>| {
            let row_codes = layer.len() / self.height;
            first * row_codes..end * row_codes
        };
        let layers = || self.layers.iter().map(|layer| layer.slice(rows(layer))).collect();
        Ok((first < end).then(|| LayerBand { rows: end - first, layers: layers() }))
    }
}

/// The rows of a band, as they are read.
struct LayerBuffer {
    rows: usize,
    layers: Vec<Codes>,
}

/// The bands of several sources; a thread reads ahead.
pub(crate) struct LayerReader(ReadAhead<LayerBuffer>);

impl LayerReader {
    /// Reads `sources` of `height` rows in bands of `band_rows`.
    ///
    /// # Errors
    /// [`crate::Error::Threads`].
    pub fn new(mut sources: Vec<Box<dyn LayerSource>>, height: usize, band_rows: usize) -> Result<Self> {
        assert!(band_rows > 0, "a band has rows");
        let read_all = move |mut filling: Filling<LayerBuffer>| {
            for first in (0..height).step_by(band_rows) {
                let Some(buffer) = filling.take() else { break };
                let rows = band_rows.min(height - first);
                let room = || LayerBuffer {
                    rows,
                    layers: sources.iter().map(|it| Codes::zeroed(it.depth(), rows * it.row_codes())).collect(),
                };
                let mut buffer = buffer.filter(|buffer| buffer.rows == rows).unwrap_or_else(room);
                for (source, layer) in sources.iter_mut().zip(&mut buffer.layers) {
                    source.read(layer.as_mut())?;
                }
                filling.send(buffer);
            }
            Ok(())
        };
        ReadAhead::new(read_all).map(Self)
    }
}

impl LayerBands for LayerReader {
    fn next(&mut self) -> Result<Option<LayerBand<'_>>> {
        Ok(self.0.next()?.map(LayerBuffer::band))
    }
}

impl LayerBuffer {
    fn band(&self) -> LayerBand<'_> {
        LayerBand { rows: self.rows, layers: self.layers.iter().map(Codes::as_ref).collect() }
    }
}
