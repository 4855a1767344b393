//! What a shader does with the maps: twins of the pure functions under `kernels/shading/`.
//!
//! They are to be read, tested and measured; a scene runs the WGSL. Their arithmetic is that of plain `f32` here and of
//! the device there, so results agree within a rounding or two of each operation and not to the bit.

mod plane_offset;

pub use plane_offset::plane_offset;
