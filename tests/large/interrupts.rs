//! An interrupt ends a map whose last row is needed first, and far: the way there is gone piece by piece.

use crate::io::hand_made_tiff::Tiff;
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use texbake::io::{ReadOptions, create_normals, default_format, open_heights};
use texbake::stream::{HeightRows, Monitor, RowSource};
use texbake::{Baker, Error, HeightType, HeightsMut, NormalFormat, NormalOptions, Result, Size};

const WIDTH: usize = 65_536;
/// More than the 64 MiB up to which such a map is held.
const HEIGHT: usize = 1100;
/// Rows in a piece of 1 MiB.
const PIECE: usize = 16;

/// Rows that tell their monitor to stop once `row` was skipped.
struct Stopping {
    rows: HeightRows,
    monitor: Arc<Monitor>,
    row: usize,
    skipped: Arc<AtomicUsize>,
}

impl RowSource for Stopping {
    fn size(&self) -> Size {
        self.rows.size()
    }

    fn height_type(&self) -> HeightType {
        self.rows.height_type()
    }

    fn read(&mut self, _: HeightsMut<'_>) -> Result<()> {
        panic!("it was stopped before it was read")
    }

    fn skip(&mut self, rows: usize) -> Result<()> {
        self.rows.skip(rows)?;
        if self.skipped.fetch_add(rows, Relaxed) + rows > self.row {
            self.monitor.cancel();
        }
        Ok(())
    }

    fn rewind(&mut self) -> Result<()> {
        self.rows.rewind()
    }

    fn last_row_is_near(&self) -> bool {
        self.rows.last_row_is_near()
    }

    fn held_bytes(&self) -> u64 {
        self.rows.held_bytes()
    }
}

#[test]
fn a_strip_that_wraps_into_an_exr_is_unpacked_no_further_after_a_stop() {
    let folder = tempfile::tempdir().unwrap();
    let [input, output] = ["h.tif", "n.exr"].map(|name| folder.path().join(name));
    let mut deflate = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    (0..HEIGHT).for_each(|_| deflate.write_all(&[0; WIDTH]).unwrap());
    let strip = Tiff::grey(WIDTH as u32, HEIGHT as u32, 8, 1, vec![deflate.finish().unwrap()]);
    std::fs::write(&input, Tiff { compression: 8, ..strip }.bytes()).unwrap();

    let (encoding, depth) = default_format(&output).unwrap();
    let format = NormalFormat { encoding, depth, ..NormalFormat::default() };
    for row in [0, 300, HEIGHT - 40] {
        let (monitor, skipped) = (Arc::new(Monitor::default()), Arc::new(AtomicUsize::new(0)));
        let open = || {
            let rows = open_heights(&input, &ReadOptions::default())?.rows;
            Ok(Box::new(Stopping { rows, monitor: monitor.clone(), row, skipped: skipped.clone() }) as HeightRows)
        };
        let create = |size| Ok(create_normals(&output, size, format)?.into());
        let options = NormalOptions { format, ..NormalOptions::default() };
        let ran = Baker::cpu().normal_rows(&open, &create, &options, &monitor);
        assert!(matches!(ran, Err(Error::Cancelled)), "{ran:?}");
        assert_eq!(skipped.load(Relaxed), (row / PIECE + 1) * PIECE, "rows skipped, told to stop at row {row}");
        assert!(!output.exists());
    }
}
