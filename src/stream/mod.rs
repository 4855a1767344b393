//! A bake is a stream of row bands.
//!
//! Rows come from a [`RowSource`], are cut into bands with a halo of one row ([`HeightBands`]), go through a backend,
//! and leave as rows of codes to a [`CodeSink`], in a [`RowOrder`]. Reading, baking and writing overlap, and no stage holds more than a
//! few bands.

mod band;
mod channel;
mod memory;
mod monitor;
mod order;
mod reader;
mod writer;

pub use band::{Band, HeightBand, HeightBands};
pub use memory::{MapBands, MapSink};
pub use monitor::Monitor;
pub use order::RowOrder;
pub use reader::{BandReader, RowSource, read_map};
pub use writer::{CodeSink, CodeWriter, RowSink};
