//! PNG, row by row.

mod read;
mod write;
mod zlib;

pub(super) use read::open;
pub(super) use write::{check, create};
