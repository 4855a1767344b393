//! Models: glTF in and out, as `read`, `write`, `refused` and `damage` say, before the Khronos validator too.

pub mod builder;
mod damage;
mod placements;
mod read;
mod refused;
pub mod samples;
mod validator;
mod write;

pub use builder::Builder;
