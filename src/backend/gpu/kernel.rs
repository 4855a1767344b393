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

const NORMAL: &str = include_str!("../../../kernels/normal.wgsl");
const INTEGER_CODES: &str = include_str!("../../../kernels/normal/integer_codes.wgsl");
const INTEGER_FLOATS: &str = include_str!("../../../kernels/normal/integer_floats.wgsl");
const WIDE_NORMAL: &str = include_str!("../../../kernels/normal/wide_normal.wgsl");
const FLOAT_HEIGHTS: &str = include_str!("../../../kernels/normal/float_heights.wgsl");
const FAST: &str = include_str!("../../../kernels/normal/fast.wgsl");
const HEIGHTS: &str = include_str!("../../../kernels/shared/heights.wgsl");
const CODES: &str = include_str!("../../../kernels/shared/codes.wgsl");
const WIDE: &str = include_str!("../../../kernels/shared/wide.wgsl");
const SOFT_FLOAT: &str = include_str!("../../../kernels/shared/soft_float.wgsl");

pub(crate) const NORMAL_INTEGER_CODES: KernelSource = KernelSource {
    name: "normal, integer heights to integer codes",
    entry_point: "normal",
    files: &[NORMAL, INTEGER_CODES, WIDE_NORMAL, HEIGHTS, CODES, WIDE],
};
pub(crate) const NORMAL_INTEGER_FLOATS: KernelSource = KernelSource {
    name: "normal, integer heights to floats",
    entry_point: "normal",
    files: &[NORMAL, INTEGER_FLOATS, WIDE_NORMAL, HEIGHTS, CODES, WIDE, SOFT_FLOAT],
};
pub(crate) const NORMAL_FLOAT_HEIGHTS: KernelSource = KernelSource {
    name: "normal, float heights",
    entry_point: "normal",
    files: &[NORMAL, FLOAT_HEIGHTS, HEIGHTS, CODES, WIDE, SOFT_FLOAT],
};
pub(crate) const NORMAL_FAST: KernelSource = KernelSource {
    name: "normal, fast",
    entry_point: "normal",
    files: &[NORMAL, FAST, HEIGHTS, CODES, WIDE, SOFT_FLOAT],
};

/// Every kernel that a backend may run.
#[cfg(test)]
pub(crate) const ALL: [KernelSource; 4] =
    [NORMAL_INTEGER_CODES, NORMAL_INTEGER_FLOATS, NORMAL_FLOAT_HEIGHTS, NORMAL_FAST];
