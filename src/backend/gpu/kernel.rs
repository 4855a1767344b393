//! The kernels' text and what is constant in a compiled one.
//!
//! A kernel is composed by concatenation, the kernel first and what it shares after it: WGSL's module scope has no
//! order, so the lines of an error are the kernel's own.

/// One way to compute an operation, as a list of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct KernelSource {
    /// Name for messages: the entry point, then the arithmetic.
    pub name: &'static str,
    /// The compute entry point.
    pub entry_point: &'static str,
    files: &'static [&'static str],
}

impl KernelSource {
    /// The WGSL text.
    pub fn text(&self) -> String {
        self.files.join("\n")
    }
}

/// A kernel as it is compiled: its text, and the values of its overrides.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Kernel {
    pub source: KernelSource,
    /// Every override of the text; a bool is 0 or 1.
    pub constants: Vec<(&'static str, u32)>,
}

const BAKE: &str = include_str!("../../../kernels/bake.wgsl");
const INTEGER_HEIGHTS: &str = include_str!("../../../kernels/bake/integer_heights.wgsl");
const INTEGERS: &str = include_str!("../../../kernels/bake/integers.wgsl");
const FLOATS: &str = include_str!("../../../kernels/bake/floats.wgsl");
const FLOAT_HEIGHTS: &str = include_str!("../../../kernels/bake/float_heights.wgsl");
const NATIVE_NORMALS: &str = include_str!("../../../kernels/bake/native_normals.wgsl");
const FAST: &str = include_str!("../../../kernels/bake/fast.wgsl");
const BLEND: &str = include_str!("../../../kernels/blend.wgsl");
const BLENDED_INTEGERS: &str = include_str!("../../../kernels/blend/integers.wgsl");
const BLENDED_FLOATS: &str = include_str!("../../../kernels/blend/floats.wgsl");
const BLENDED_FAST: &str = include_str!("../../../kernels/blend/fast.wgsl");
const PARALLAX: &str = include_str!("../../../kernels/parallax.wgsl");
const INTEGER_MAPS: &str = include_str!("../../../kernels/parallax/integers.wgsl");
const FLOAT_MAPS: &str = include_str!("../../../kernels/parallax/floats.wgsl");
const FAST_MAPS: &str = include_str!("../../../kernels/parallax/fast.wgsl");
const TANGENTS: &str = include_str!("../../../kernels/tangents.wgsl");
const VECTORS: &str = include_str!("../../../kernels/tangents/vectors.wgsl");
const TRIANGLES: &str = include_str!("../../../kernels/tangents/triangles.wgsl");
const TWO_VECTORS: &str = include_str!("../../../kernels/tangents/two_vectors.wgsl");
const LENGYEL: &str = include_str!("../../../kernels/tangents/lengyel.wgsl");
const HEGDE: &str = include_str!("../../../kernels/tangents/hegde.wgsl");
const MIKKTSPACE: &str = include_str!("../../../kernels/tangents/mikktspace.wgsl");
const FANS: &str = include_str!("../../../kernels/tangents/fans.wgsl");
const SUMMED: &str = include_str!("../../../kernels/tangents/summed.wgsl");
const WEIGHTED: &str = include_str!("../../../kernels/tangents/weighted.wgsl");
const READ_CODES: &str = include_str!("../../../kernels/shared/read_codes.wgsl");
const FLOAT_NORMALS: &str = include_str!("../../../kernels/shared/float_normals.wgsl");
const FAST_NORMALS: &str = include_str!("../../../kernels/shared/fast_normals.wgsl");
const HEIGHTS: &str = include_str!("../../../kernels/shared/heights.wgsl");
const CODES: &str = include_str!("../../../kernels/shared/codes.wgsl");
const NEAREST_CODE: &str = include_str!("../../../kernels/shared/nearest_code.wgsl");
const NEAREST_FLOAT: &str = include_str!("../../../kernels/shared/nearest_float.wgsl");
const WIDE: &str = include_str!("../../../kernels/shared/wide.wgsl");
const SIGNED: &str = include_str!("../../../kernels/shared/signed.wgsl");
const SOFT_FLOAT: &str = include_str!("../../../kernels/shared/soft_float.wgsl");
const FLUSHING: &str = include_str!("../../../kernels/shared/flushing.wgsl");
const GRADUAL: &str = include_str!("../../../kernels/shared/gradual.wgsl");
const NATIVE_FLOAT: &str = include_str!("../../../kernels/shared/native_float.wgsl");
const ACOS: &str = include_str!("../../../kernels/shared/acos.wgsl");
const UNIT: &str = include_str!("../../../kernels/shared/unit.wgsl");
const FLOAT_PARALLAX: &str = include_str!("../../../kernels/shared/float_parallax.wgsl");
const ESTIMATE_FLOATS: &str = include_str!("../../../kernels/shared/estimate_floats.wgsl");
const ESTIMATE: &str = include_str!("../../../kernels/shared/estimate.wgsl");
const FAST_CODE: &str = include_str!("../../../kernels/shared/fast_code.wgsl");

pub(crate) const BAKE_INTEGERS: KernelSource = KernelSource {
    name: "bake, integer heights to integer codes",
    entry_point: "bake",
    files: &[BAKE, INTEGER_HEIGHTS, INTEGERS, HEIGHTS, CODES, ESTIMATE, NEAREST_CODE, WIDE],
};
pub(crate) const BAKE_FLOATS: KernelSource = KernelSource {
    name: "bake, integer heights to floats",
    entry_point: "bake",
    files: &[
        BAKE,
        INTEGER_HEIGHTS,
        FLOATS,
        HEIGHTS,
        CODES,
        ESTIMATE,
        ESTIMATE_FLOATS,
        NEAREST_CODE,
        NEAREST_FLOAT,
        WIDE,
        SOFT_FLOAT,
        FLUSHING,
    ],
};
pub(crate) const BAKE_FLOAT_HEIGHTS: KernelSource = KernelSource {
    name: "bake, float heights",
    entry_point: "bake",
    files: &[
        BAKE,
        FLOAT_HEIGHTS,
        NATIVE_NORMALS,
        HEIGHTS,
        CODES,
        ESTIMATE,
        UNIT,
        FLOAT_PARALLAX,
        WIDE,
        SOFT_FLOAT,
        FLUSHING,
    ],
};
pub(crate) const BAKE_FAST: KernelSource = KernelSource {
    name: "bake, fast",
    entry_point: "bake",
    files: &[BAKE, FAST, NATIVE_NORMALS, HEIGHTS, CODES, FAST_CODE, WIDE, SOFT_FLOAT, FLUSHING],
};
pub(crate) const BLEND_INTEGERS: KernelSource = KernelSource {
    name: "blend, integer maps",
    entry_point: "blend",
    files: &[
        BLEND,
        BLENDED_INTEGERS,
        READ_CODES,
        CODES,
        ESTIMATE,
        ESTIMATE_FLOATS,
        NEAREST_CODE,
        NEAREST_FLOAT,
        SIGNED,
        WIDE,
        SOFT_FLOAT,
        FLUSHING,
    ],
};
pub(crate) const BLEND_FLOATS: KernelSource = KernelSource {
    name: "blend, float maps",
    entry_point: "blend",
    files: &[BLEND, BLENDED_FLOATS, READ_CODES, FLOAT_NORMALS, CODES, UNIT, WIDE, SOFT_FLOAT, FLUSHING],
};
pub(crate) const BLEND_FAST: KernelSource = KernelSource {
    name: "blend, fast",
    entry_point: "blend",
    files: &[BLEND, BLENDED_FAST, READ_CODES, FAST_NORMALS, CODES, FAST_CODE, WIDE, SOFT_FLOAT, FLUSHING],
};
pub(crate) const PARALLAX_INTEGERS: KernelSource = KernelSource {
    name: "parallax, integer maps",
    entry_point: "parallax",
    files: &[
        PARALLAX,
        INTEGER_MAPS,
        READ_CODES,
        CODES,
        ESTIMATE,
        ESTIMATE_FLOATS,
        NEAREST_CODE,
        NEAREST_FLOAT,
        WIDE,
        SOFT_FLOAT,
        FLUSHING,
    ],
};
pub(crate) const PARALLAX_FLOATS: KernelSource = KernelSource {
    name: "parallax, float maps",
    entry_point: "parallax",
    files: &[PARALLAX, FLOAT_MAPS, READ_CODES, FLOAT_NORMALS, CODES, UNIT, FLOAT_PARALLAX, WIDE, SOFT_FLOAT, FLUSHING],
};
pub(crate) const PARALLAX_FAST: KernelSource = KernelSource {
    name: "parallax, fast",
    entry_point: "parallax",
    files: &[PARALLAX, FAST_MAPS, READ_CODES, FAST_NORMALS, CODES, FAST_CODE, WIDE, SOFT_FLOAT, FLUSHING],
};
pub(crate) const FRAMES_LENGYEL: KernelSource = KernelSource {
    name: "frames, lengyel",
    entry_point: "frames",
    files: &[TANGENTS, TRIANGLES, TWO_VECTORS, LENGYEL, VECTORS, WIDE, SOFT_FLOAT, GRADUAL],
};
pub(crate) const FRAMES_LENGYEL_FAST: KernelSource = KernelSource {
    name: "frames, lengyel, fast",
    entry_point: "frames",
    files: &[TANGENTS, TRIANGLES, TWO_VECTORS, LENGYEL, VECTORS, NATIVE_FLOAT],
};
pub(crate) const FRAMES_HEGDE: KernelSource = KernelSource {
    name: "frames, hegde",
    entry_point: "frames",
    files: &[TANGENTS, TRIANGLES, TWO_VECTORS, HEGDE, VECTORS, WIDE, SOFT_FLOAT, GRADUAL],
};
pub(crate) const FRAMES_HEGDE_FAST: KernelSource = KernelSource {
    name: "frames, hegde, fast",
    entry_point: "frames",
    files: &[TANGENTS, TRIANGLES, TWO_VECTORS, HEGDE, VECTORS, NATIVE_FLOAT],
};
pub(crate) const FRAMES_MIKKTSPACE: KernelSource = KernelSource {
    name: "frames, mikktspace",
    entry_point: "frames",
    files: &[TANGENTS, TRIANGLES, MIKKTSPACE, VECTORS, WIDE, SOFT_FLOAT, GRADUAL],
};
pub(crate) const FRAMES_MIKKTSPACE_FAST: KernelSource = KernelSource {
    name: "frames, mikktspace, fast",
    entry_point: "frames",
    files: &[TANGENTS, TRIANGLES, MIKKTSPACE, VECTORS, NATIVE_FLOAT],
};
pub(crate) const TANGENTS_SUMMED: KernelSource = KernelSource {
    name: "tangents, summed",
    entry_point: "tangents",
    files: &[TANGENTS, FANS, SUMMED, VECTORS, WIDE, SOFT_FLOAT, GRADUAL],
};
pub(crate) const TANGENTS_SUMMED_FAST: KernelSource = KernelSource {
    name: "tangents, summed, fast",
    entry_point: "tangents",
    files: &[TANGENTS, FANS, SUMMED, VECTORS, NATIVE_FLOAT],
};
pub(crate) const TANGENTS_WEIGHTED: KernelSource = KernelSource {
    name: "tangents, weighted",
    entry_point: "tangents",
    files: &[TANGENTS, FANS, WEIGHTED, VECTORS, ACOS, WIDE, SOFT_FLOAT, GRADUAL],
};
pub(crate) const TANGENTS_WEIGHTED_FAST: KernelSource = KernelSource {
    name: "tangents, weighted, fast",
    entry_point: "tangents",
    files: &[TANGENTS, FANS, WEIGHTED, VECTORS, NATIVE_FLOAT],
};

/// The whole of IEEE's arithmetic and the angle, for a test of each operation.
#[cfg(test)]
pub(crate) const ARITHMETIC: [&str; 4] = [ACOS, WIDE, SOFT_FLOAT, GRADUAL];

/// Every kernel that a backend may run.
pub(crate) const ALL: [KernelSource; 20] = [
    BAKE_INTEGERS,
    BAKE_FLOATS,
    BAKE_FLOAT_HEIGHTS,
    BAKE_FAST,
    BLEND_INTEGERS,
    BLEND_FLOATS,
    BLEND_FAST,
    PARALLAX_INTEGERS,
    PARALLAX_FLOATS,
    PARALLAX_FAST,
    FRAMES_LENGYEL,
    FRAMES_LENGYEL_FAST,
    FRAMES_HEGDE,
    FRAMES_HEGDE_FAST,
    FRAMES_MIKKTSPACE,
    FRAMES_MIKKTSPACE_FAST,
    TANGENTS_SUMMED,
    TANGENTS_SUMMED_FAST,
    TANGENTS_WEIGHTED,
    TANGENTS_WEIGHTED_FAST,
];
