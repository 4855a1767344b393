//! Heights on their way into their maps.

use crate::error::Result;
use crate::io::{ReadOptions, open_heights};
use crate::map::{HeightType, HeightsMut, Size};
use crate::stream::{HeightRows, RowSource};
use std::cell::{Cell, RefCell};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// What is known of a height map that is read.
pub(super) struct HeightWatch<'a> {
    path: &'a Path,
    read: &'a ReadOptions,
    warnings: RefCell<Vec<String>>,
    height_type: Cell<HeightType>,
    beyond: Arc<AtomicU64>,
}

impl<'a> HeightWatch<'a> {
    /// For the file at `path`, which is read by these options.
    pub fn new(path: &'a Path, read: &'a ReadOptions) -> Self {
        let height_type = Cell::new(HeightType::U8);
        Self { path, read, warnings: RefCell::default(), height_type, beyond: Arc::default() }
    }

    /// Opens the map; heights beyond 0 and 1 are counted if they go into a parallax map, and those that were counted
    /// before belong to another try.
    pub fn open(&self, counts: bool) -> Result<HeightRows> {
        let file = open_heights(self.path, self.read)?;
        *self.warnings.borrow_mut() = file.warnings;
        self.height_type.set(file.rows.height_type());
        self.beyond.store(0, Relaxed);
        Ok(if counts { Box::new(Counted { rows: file.rows, beyond: self.beyond.clone() }) } else { file.rows })
    }

    /// How a height is stored, once the map was opened.
    pub fn height_type(&self) -> HeightType {
        self.height_type.get()
    }

    /// What looks wrong; counts mean something only if all rows were read.
    pub fn warnings(&self, all_read: bool) -> Vec<String> {
        let mut warnings = self.warnings.take();
        let beyond = self.beyond.load(Relaxed);
        if all_read && beyond > 0 {
            let words = if beyond == 1 { ["height", "lies", "counts"] } else { ["heights", "lie", "count"] };
            let [heights, lie, count] = words;
            warnings.push(format!(
                "{beyond} {heights} {lie} outside 0 to 1 and {count} as 0 or 1 in the parallax map: export the map \
                 with heights from 0 to 1, or bring those from MIN to MAX there with gdal_translate -ot Float32 \
                 -scale MIN MAX 0 1, and multiply --scale by MAX - MIN"
            ));
        }
        warnings
    }
}

/// Counts the float heights beyond 0 and 1, of which a parallax map keeps no more than the 0 and the 1.
struct Counted {
    rows: HeightRows,
    beyond: Arc<AtomicU64>,
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

    fn skip(&mut self, rows: usize) -> Result<()> {
        self.rows.skip(rows)
    }

    /// All rows come again, and are counted once.
    fn rewind(&mut self) -> Result<()> {
        self.beyond.store(0, Relaxed);
        self.rows.rewind()
    }

    fn last_row_is_near(&self) -> bool {
        self.rows.last_row_is_near()
    }

    fn held_bytes(&self) -> u64 {
        self.rows.held_bytes()
    }
}
