//! Reading height maps and normal maps, writing normal maps and parallax maps; models in and out.

#[cfg(all(feature = "cli", target_os = "linux"))]
mod bombs;
mod damage;
mod exr;
mod found;
mod gltf;
pub mod hand_made_png;
pub mod hand_made_tiff;
mod normal;
mod obj;
mod parallax;
mod png;
mod png_rows;
mod png_written;
#[cfg(feature = "cli")]
mod program;
mod raster;
mod raw;
mod replace;
mod samples;
mod shared_threads;
mod shrink;
pub mod support;
mod tiff;
