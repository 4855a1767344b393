//! PNG, row by row.

mod deflate;
mod filter;
mod in_order;
mod read;
mod stripe;
mod write;
mod zlib;

pub(super) use read::open;
pub(super) use write::{check, create};
