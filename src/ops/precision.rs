//! Exact bytes, or speed.

use crate::names::named;

/// Exact bytes, or speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Precision {
    /// The same bytes on every backend; where all inputs hold integer codes the correctly rounded ones.
    #[default]
    Exact,
    /// Native floats. Measured by `cargo bench --bench accuracy`, with directions off by 1e-5 degrees at most:
    ///
    /// - 8 bits: 2.5e-6 of the codes differ, each by one.
    /// - 16 bits: 1e-1 of the codes differ, each by one.
    /// - 16f: a code next to the exact one, where that lies close to the middle between two.
    /// - 32f: most codes differ, in their last four bits; two devices need not agree.
    Fast,
}

named! {
    Precision "precision" { Exact = "exact", Fast = "fast" }
}
