//! Which bytes texbake bakes.

/// Raised with any change of a byte that a bake writes, in a map's codes or in its file: outputs of another version are
/// baked again.
pub const KERNEL_VERSION: u32 = 1;
