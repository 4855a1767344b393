//! Which outputs are what a bake would make of their inputs, and need none.
//!
//! What was baked is remembered in one small file in the folder of the outputs, `.texbake-baked`: for each texture the
//! options, [`KERNEL_VERSION`], and BLAKE3 hashes of all that was read and written. An output is fresh if all of that is
//! as it was. Contents decide, not times; but a file that has the length, the times and the number that it had, and that
//! was left alone for two seconds before it was read, is not read again.
//!
//! The file is a help, and no part of the result: without it, or where it cannot be read or written, textures are baked
//! again.

mod check;
mod content;
mod kernel_version;
mod key;
mod line;
mod plan;
mod reader;
mod reason;
mod record;
mod run;
mod written;

pub use kernel_version::KERNEL_VERSION;
pub use plan::FreshPlan;
pub use reason::{Change, Freshness, Reason};
pub(super) use written::Written;
