//! In which order rows travel.

/// The order of the rows of a map from a source to a sink.
///
/// The first row of a map that wraps from bottom to top needs the last one above it. A sink that can place row 0 last
/// spares a second reading, and lets the map be baked while it is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RowOrder {
    /// Rows 0, 1, 2 and so on.
    FromTop,
    /// Rows 1, 2 and so on, and row 0 after the last: for maps of at least two rows that wrap.
    FirstRowLast,
}

impl RowOrder {
    /// The row, of a map of `height` rows, that travels after `travelled` others.
    pub fn row(self, travelled: usize, height: usize) -> usize {
        match self {
            Self::FromTop => travelled,
            Self::FirstRowLast => (travelled + 1) % height,
        }
    }
}
