//! Reading height maps and writing normal maps.

mod damage;
mod exr;
mod png;
mod raster;
mod raw;
mod replace;
mod support;
mod tiff;
