//! PNG, row by row.

mod read;
mod write;

pub(super) use read::open;
pub(super) use write::create;
