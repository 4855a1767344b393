//! What a shader does with the maps: twins of the pure functions under `kernels/shading/`.
//!
//! They are to be read, tested and measured; a scene runs the WGSL. Their arithmetic is that of plain `f32` here and of
//! the device there, so results agree within a rounding or two of each operation and not to the bit.
//!
//! | | |
//! | --- | --- |
//! | [`decode_unorm`], [`decode_snorm`], [`decode_biased_8_bit`], [`decode_biased_16_bit`] | from samples to a normal |
//! | [`rebuild_z`], [`green_turned`] | two channels, green up and down |
//! | [`vertex_frame`], [`pixel_frame`], [`to_tangent`], [`to_object`] | tangent space with precomputed tangents |
//! | [`cotangent_frame`], [`without_perspective`], [`gradients`], [`perturbed_normal`] | and without |
//! | [`welsh_offset`], [`limited_offset`], [`plane_offset`], [`stepped_offset`], [`relief_offset`] | parallax |
//! | [`diffuse`], [`two_lights`], [`blinn_phong`] | light |
//!
//! [`LIBRARY`] has the texts, and `texbake shaders` writes them for engines that do not read WGSL.

mod cotangent_frame;
mod decode_normal;
#[cfg(feature = "cli")]
mod export;
mod library;
mod lighting;
mod plane_offset;
mod relief_offset;
mod stepped_offset;
mod tangent_frame;
mod welsh_offset;

pub use cotangent_frame::{cotangent_frame, gradients, perturbed_normal, without_perspective};
pub use decode_normal::{
    decode_biased_8_bit, decode_biased_16_bit, decode_snorm, decode_unorm, green_turned, rebuild_z,
};
#[cfg(feature = "cli")]
pub use export::{ShaderLanguage, export};
pub use library::{LIBRARY, ShaderFile};
pub use lighting::{blinn_phong, diffuse, two_lights};
pub use plane_offset::plane_offset;
pub use relief_offset::relief_offset;
pub use stepped_offset::{step_scale, stepped_offset};
pub use tangent_frame::{Frame, pixel_frame, to_object, to_tangent, vertex_frame};
pub use welsh_offset::{limited_offset, welsh_offset};
