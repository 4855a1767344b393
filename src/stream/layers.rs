//! Bands of several maps that lie over each other, for operations that look at one texel of each.

use super::channel::{Recycling, recycling};
use super::thread;
use crate::error::Result;
use crate::map::{Codes, CodesMut, CodesRef, Depth};
use std::thread::{Builder, JoinHandle};

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

/// Bands in flight besides the one in use: one being read, one waiting.
const BUFFERS: usize = 3;

/// The rows of a band, as they are read.
struct LayerBuffer {
    rows: usize,
    layers: Vec<Codes>,
}

/// The bands of several sources; a thread reads ahead.
pub(crate) struct LayerReader {
    /// `None` once nothing more is wanted.
    bands: Option<Recycling<LayerBuffer>>,
    current: Option<LayerBuffer>,
    thread: Option<JoinHandle<Result<()>>>,
}

impl LayerReader {
    /// Reads `sources` of `height` rows in bands of `band_rows`.
    ///
    /// # Errors
    /// [`crate::Error::Threads`].
    pub fn new(mut sources: Vec<Box<dyn LayerSource>>, height: usize, band_rows: usize) -> Result<Self> {
        assert!(band_rows > 0, "a band has rows");
        let (bands, mut filled) = recycling::<LayerBuffer>(BUFFERS);
        let read_all = move || {
            for first in (0..height).step_by(band_rows) {
                let Some(buffer) = filled.take() else { break };
                let rows = band_rows.min(height - first);
                let room = || LayerBuffer {
                    rows,
                    layers: sources.iter().map(|it| Codes::zeroed(it.depth(), rows * it.row_codes())).collect(),
                };
                let mut buffer = buffer.filter(|buffer| buffer.rows == rows).unwrap_or_else(room);
                for (source, layer) in sources.iter_mut().zip(&mut buffer.layers) {
                    source.read(layer.as_mut())?;
                }
                filled.send(buffer);
            }
            Ok(())
        };
        let thread = thread::start(Builder::new().name("texbake read".into()), read_all)?;
        Ok(Self { bands: Some(bands), current: None, thread: Some(thread) })
    }
}

impl LayerBands for LayerReader {
    fn next(&mut self) -> Result<Option<LayerBand<'_>>> {
        let Some(bands) = &self.bands else { return Ok(None) };
        if let Some(used) = self.current.take() {
            bands.give_back(used);
        }
        self.current = bands.receive();
        if self.current.is_none()
            && let Some(thread) = self.thread.take()
        {
            thread::join(thread)?;
        }
        Ok(self.current.as_ref().map(LayerBuffer::band))
    }
}

impl LayerBuffer {
    fn band(&self) -> LayerBand<'_> {
        LayerBand { rows: self.rows, layers: self.layers.iter().map(Codes::as_ref).collect() }
    }
}

impl Drop for LayerReader {
    /// Once it is gone the sources are closed: a thread that still reads is waited for.
    fn drop(&mut self) {
        self.bands = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
