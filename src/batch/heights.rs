//! Heights on their way into a parallax map.

use crate::error::Result;
use crate::map::{HeightType, HeightsMut, Size};
use crate::stream::{HeightRows, RowSource};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Counts the float heights beyond 0 and 1, of which a parallax map keeps no more than the 0 and the 1.
pub(super) struct Counted {
    rows: HeightRows,
    beyond: Arc<AtomicU64>,
}

impl Counted {
    /// The rows of a map that is read from its beginning: what `beyond` counted before belongs to another try.
    pub fn new(rows: HeightRows, beyond: &Arc<AtomicU64>) -> Self {
        beyond.store(0, Relaxed);
        Self { rows, beyond: beyond.clone() }
    }
}

impl RowSource for Counted {
    fn size(&self) -> Size {
        self.rows.size()
    }

    fn height_type(&self) -> HeightType {
        self.rows.height_type()
    }

    fn read(&mut self, rows: HeightsMut<'_>) -> Result<()> {
        let HeightsMut::F32(heights) = rows else { return self.rows.read(rows) };
        self.rows.read(HeightsMut::F32(heights))?;
        let beyond = heights.iter().filter(|height| !(0.0..=1.0).contains(*height)).count();
        self.beyond.fetch_add(beyond as u64, Relaxed);
        Ok(())
    }

    /// The row comes again in its place, and is counted there.
    fn read_last_row(&mut self, row: HeightsMut<'_>) -> Result<()> {
        self.rows.read_last_row(row)
    }

    fn last_row_is_near(&self) -> bool {
        self.rows.last_row_is_near()
    }
}
