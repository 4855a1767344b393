//! TIFF, GeoTIFF and BigTIFF, by strips and tiles.

mod directory;
mod read;
mod strips;
mod write;

pub(super) use read::open;
pub(super) use write::{check, create};
