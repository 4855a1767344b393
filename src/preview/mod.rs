//! Pictures of a material and of models that wear it, rendered with what [`crate::shading`] has.
//!
//! A [`Sheet`] puts the ways in which a scene may use the maps side by side: flat, normal mapped, each parallax method, and
//! relief intersection as the truth, from several elevations, with the errors of the offsets beneath. Its panels are
//! [`Shot`]s of a plane, which a [`Renderer`] takes on the CPU or on a GPU.
//!
//! [`model_sheet`] draws meshes that wear a material, and their tangents, on the CPU.
//!
//! Colours are linear light until a [`Picture`] makes sRGB of them.

mod camera;
#[cfg(feature = "gpu")]
pub(crate) mod gpu;
mod labels;
mod limits;
mod look;
mod model_sheet;
mod palette;
mod picture;
mod raster;
mod renderer;
mod sheet;
mod shot;
mod worn;

pub use camera::{Camera, Rays};
pub use look::{Light, Look};
pub use model_sheet::{ModelSheetOptions, model_sheet};
pub use picture::Picture;
pub use raster::{Canvas, Corner, Viewpoint};
pub use renderer::Renderer;
pub use sheet::{Sheet, SheetOptions, Told};
pub use shot::{Samples, Shot, Surface};
pub use worn::{Paint, Worn};
