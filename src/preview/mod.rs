//! Pictures of a material and of models that wear it, rendered with what [`crate::shading`] has.
//!
//! A [`Sheet`] puts the ways in which a scene may use the maps side by side: flat, normal mapped, each parallax method, and
//! relief intersection as the truth, from several elevations, with the errors of the offsets beneath. Its panels are
//! [`Shot`]s of a plane, which a [`Renderer`] takes on the CPU or on a GPU.
//!
//! Colours are linear light until a [`Picture`] makes sRGB of them.

mod camera;
#[cfg(feature = "gpu")]
pub(crate) mod gpu;
mod labels;
mod look;
mod picture;
mod renderer;
mod sheet;
mod shot;

pub use camera::{Camera, Rays};
pub use look::{Light, Look};
pub use picture::Picture;
pub use renderer::Renderer;
pub use sheet::{Sheet, SheetOptions, Told};
pub use shot::{Samples, Shot, Surface};
