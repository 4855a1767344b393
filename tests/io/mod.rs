//! Reading height maps and normal maps, writing normal maps and parallax maps; models in and out.

mod damage;
mod exr;
mod gltf;
mod hand_made_png;
mod hand_made_tiff;
mod normal;
mod obj;
mod parallax;
mod png;
mod raster;
mod raw;
mod replace;
mod samples;
mod support;
mod tiff;
