//! The two ends of a bake from rows to rows: [`RowSource`] or [`NormalSource`] and [`RowSink`], and the [`Monitor`]
//! that watches it.
//!
//! Between them rows are cut into bands with a halo of one row and go through a backend. Reading, baking and writing
//! overlap, and no stage holds more than a few bands.

mod ahead;
mod band;
mod budget;
mod channel;
mod layers;
mod memory;
mod monitor;
mod normals;
mod order;
mod reader;
mod sink;
#[cfg(test)]
mod tests;
mod thread;
mod writer;

pub(crate) use ahead::ReadAhead;
pub(crate) use band::{Band, HeightBand, HeightBands};
pub(crate) use channel::{BUFFERS, Filling};
pub(crate) use layers::{LayerBand, LayerBands, LayerReader, LayerSource, MapLayers};
pub(crate) use memory::{MapBands, MapSink};
pub use monitor::Monitor;
#[cfg(feature = "cli")]
pub(crate) use monitor::Stop;
pub(crate) use normals::read_normals_watched;
pub(crate) use normals::{HeightLayer, MaskLayer, NormalLayer, Tiled, check_components, height_codes, rounded_mask};
pub use normals::{NormalSource, read_normals};
pub(crate) use order::RowOrder;
#[cfg(feature = "cli")]
pub(crate) use reader::piece_rows;
pub(crate) use reader::{BandReader, read_map_watched};
pub use reader::{RowSource, read_map};
pub(crate) use sink::CodeSink;
pub use sink::{LevelSink, MapOut, RowSink};
pub(crate) use writer::CodeWriter;

/// Rows of heights from anywhere.
pub type HeightRows = Box<dyn RowSource>;

/// Rows of normals from anywhere.
pub type NormalRows = Box<dyn NormalSource>;

/// Rows of codes to anywhere.
pub type RowsOut = Box<dyn RowSink>;
