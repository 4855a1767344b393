//! GPU textures: KTX2 and DDS, each a header, an index of mip levels and their texels, or blocks of texels.
//!
//! Both know beforehand where every level stands, so one writer fills both: `levels` cuts the file, `ktx2` and `dds`
//! describe it, and `write` brings rows to their places as they come, through `texels` or `block_writer`.
//!
//! Every format is linear: normals and heights are no colours, and a reader that takes them for sRGB bends them.

mod block_writer;
mod blocks;
mod dds;
mod file;
mod format;
mod ktx2;
mod levels;
mod texels;
mod write;

pub use format::BlockCompression;
pub(super) use write::{Container, check, create};
