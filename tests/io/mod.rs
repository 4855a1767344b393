//! Reading height maps and normal maps, writing normal maps and parallax maps.

mod damage;
mod exr;
mod hand_made_tiff;
mod normal;
mod parallax;
mod png;
mod raster;
mod raw;
mod replace;
mod support;
mod tiff;
