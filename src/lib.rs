//! texbake bakes height maps into normal maps, on a GPU or a CPU: the same bytes on both.

mod backend;
mod baker;
#[cfg(feature = "cli")]
pub mod batch;
mod devices;
mod error;
mod exact;
pub mod io;
mod map;
mod names;
mod ops;
pub mod stream;

pub use baker::{Baker, Ran};
pub use devices::{Device, devices};
pub use error::{Error, Result};
pub use exact::{AxisScale, Rational, Scale};
pub use map::{
    Channels, Codes, CodesMut, CodesRef, Convention, Depth, Edge, Edges, Encoding, Grid, HeightDepth, HeightMap,
    Heights, HeightsMut, NormalFormat, NormalMap, Size,
};
#[cfg(feature = "gpu")]
pub mod gpu {
    //! Bakes on a wgpu device of the caller's.

    pub use crate::backend::gpu::{Codes, Heights, Hosted, NormalBake};
    pub use wgpu;
}
pub use ops::normal::{Filter, NormalOptions, Precision};
