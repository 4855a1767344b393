//! One plain loop, compiled for several instruction sets; the widest that the machine has is chosen at run time.

/// Compiles a function for AVX-512 (as in Ice Lake or Zen 4), AVX2 and the target's baseline.
///
/// What it calls must be `#[inline(always)]`, or it is compiled for the baseline alone: `array::map` is not for it.
macro_rules! vectorised {
    ($($function:tt)*) => {
        #[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2"))]
        $($function)*
    };
}

vectorised! {
    /// The instruction set that the loops run with.
    pub(crate) fn instruction_set() -> &'static str {
        multiversion::target::match_target! {
            "x86_64+avx512f" => "avx512",
            "x86_64+avx2" => "avx2",
            "x86_64" => "sse2",
            "aarch64" => "neon",
            _ => "scalar",
        }
    }
}
