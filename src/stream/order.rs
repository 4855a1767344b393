//! In which order rows travel.

/// The order of the rows of a map from a source to a sink.
///
/// The first row of a map that wraps from bottom to top needs the last one above it. A sink that can place row 0 last
/// spares a second reading, and lets the map be baked while it is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowOrder {
    /// Rows 0, 1, 2 and so on.
    FromTop,
    /// Rows 1, 2 and so on, and row 0 after the last: for maps of at least two rows that wrap.
    FirstRowLast {
        /// Rows of the map.
        height: usize,
    },
}

impl RowOrder {
    /// The row that travels first.
    pub(super) fn first_row(self) -> usize {
        match self {
            Self::FromTop => 0,
            Self::FirstRowLast { .. } => 1,
        }
    }

    /// The row that travels after row `row`.
    pub(super) fn row_after(self, row: usize) -> usize {
        match self {
            Self::FirstRowLast { height } if row + 1 == height => 0,
            _ => row + 1,
        }
    }
}
