//! PNG, row by row.

mod deflate;
mod filter;
mod inflate;
mod read;
mod rows;
mod stripe;
mod unfilter;
mod write;
mod zlib;

pub(super) use read::open;
pub(super) use write::{check, create};
