//! OpenEXR, by blocks of scan lines or rows of tiles.

mod choose;
mod read;
mod write;

pub(super) use choose::Wanted;
pub(super) use read::open;
pub(super) use write::{check, create};
