//! OpenEXR, by blocks of scan lines or rows of tiles.

mod read;
mod write;

pub(super) use read::open;
pub(super) use write::create;
