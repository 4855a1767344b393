//! Where codes go: what a backend fills, and what a file is written through.

use super::RowsOut;
use crate::error::Result;
use crate::map::{CodesMut, CodesRef};

/// Takes the codes of a map from a backend, from the top: room first, then the word that it is filled.
pub(crate) trait CodeSink: Send {
    /// Room for the codes of the next `rows` rows.
    ///
    /// # Errors
    /// What an earlier row met on its way out.
    fn room(&mut self, rows: usize) -> Result<CodesMut<'_>>;

    /// Hands on the rows for which there was room.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    fn filled(&mut self) -> Result<()>;
}

/// Where a map goes.
pub struct MapOut {
    /// The rows of its largest level.
    pub rows: RowsOut,
    /// Those of the smaller ones, while the largest is written; `None` if the file is to have the largest alone. It is
    /// complete only with all of them.
    pub levels: Option<Box<dyn LevelSink>>,
}

impl From<RowsOut> for MapOut {
    /// A map of one level.
    fn from(rows: RowsOut) -> Self {
        Self { rows, levels: None }
    }
}

/// A map that is written row by row.
///
/// Rows come from the top, each once; row 0 may come last if the sink lets it.
pub trait RowSink: Send {
    /// Whether row 0 may come after all others: then a map that wraps from bottom to top is read once.
    fn takes_first_row_last(&self) -> bool {
        false
    }

    /// Writes rows from row `first` on.
    ///
    /// # Errors
    /// The system's or the format's reason.
    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()>;

    /// Bytes that the sink holds at most while it writes, besides the rows that it is given, `rows` of them at once.
    fn held_bytes(&self, rows: usize) -> u64;

    /// Writes what follows the last row. Of files that belong together, all are complete before any gets its name.
    ///
    /// # Errors
    /// The system's or the format's reason.
    fn complete(&mut self) -> Result<()> {
        Ok(())
    }

    /// Completes the file, if that was not done, and gives it its final name. Without this call there is no file.
    ///
    /// # Errors
    /// The system's or the format's reason.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// The mip levels of a map below its largest.
///
/// Level k has max(1, floor(w / 2^k)) x max(1, floor(h / 2^k)) texels, and the last one has a single texel.
pub trait LevelSink: Send {
    /// Writes rows of `level`, which is at least 1, from row `first` on. Each row of each level comes once; of one level
    /// they come from the top, but that row 0 may come last.
    ///
    /// # Errors
    /// The system's or the format's reason.
    fn write(&mut self, level: usize, first: usize, rows: CodesRef<'_>) -> Result<()>;
}
