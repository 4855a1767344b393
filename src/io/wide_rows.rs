//! The rows of a tile, a texel longer on either side.

use super::halo::Reach;
use super::halo_rows::named;
use super::samples::{Samples, copy, part, part_mut};
use super::seam::Seam;
use super::tile_files::TileFiles;
use crate::error::Result;
use crate::map::{Edges, HeightsMut};
use crate::stream::{HeightRows, Stop, piece_rows};
use std::path::{Path, PathBuf};

/// The rows of a tile, with the columns beyond it.
pub(super) struct WideRows {
    pub rows: HeightRows,
    ends: [End; 2],
}

/// A column beyond a tile.
struct End {
    /// The tile that has it; `None`: the column of the tile itself.
    beside: Option<Beside>,
    column: usize,
}

/// A tile to the left or right.
struct Beside {
    path: PathBuf,
    rows: HeightRows,
    row: Samples,
    /// Its column that may be the first or last one of the tile itself.
    seam: Option<(usize, Seam)>,
}

impl WideRows {
    /// `rows` are those of one of `files`; others are opened.
    pub fn new(rows: HeightRows, ends: &[Reach; 2], edges: Edges, files: &TileFiles) -> Result<Self> {
        let width = rows.size().width();
        let [left, right] = ends;
        let ends = [
            End { beside: Beside::open(left, &rows, true, files)?, column: left.place(true, width, edges.x) },
            End { beside: Beside::open(right, &rows, false, files)?, column: right.place(false, width, edges.x) },
        ];
        Ok(Self { rows, ends })
    }

    /// Goes past the next rows, piece by piece: those of a file without entry points are decoded.
    pub fn skip(&mut self, count: usize, stop: &Stop) -> Result<()> {
        let piece_rows = piece_rows(self.rows.size(), self.rows.height_type());
        for first in (0..count).step_by(piece_rows) {
            let rows = piece_rows.min(count - first);
            stop.check()?;
            self.rows.skip(rows)?;
            for Beside { path, rows: beside, .. } in self.ends.iter_mut().filter_map(|end| end.beside.as_mut()) {
                beside.skip(rows).map_err(named(path))?;
            }
        }
        Ok(())
    }

    /// Reads the next row and the texels at its ends.
    pub fn read(&mut self, mut row: HeightsMut<'_>) -> Result<()> {
        let width = self.rows.size().width();
        self.rows.read(part_mut(&mut row, 1..width + 1))?;
        for (End { beside, column }, [place, border]) in self.ends.iter_mut().zip([[0, 1], [width + 1, width]]) {
            let Some(Beside { path, rows, row: beside, seam }) = beside else {
                repeat(&mut row, 1 + *column, place);
                continue;
            };
            rows.read(beside.as_mut()).map_err(named(path))?;
            copy(part(beside.as_ref(), *column..*column + 1), &mut part_mut(&mut row, place..place + 1));
            if let Some((shared, seam)) = seam {
                seam.see(part(row.as_ref(), border..border + 1), part(beside.as_ref(), *shared..*shared + 1));
            }
        }
        Ok(())
    }

    /// Where it meets the tiles beside it.
    pub fn seams(&self) -> impl Iterator<Item = &Seam> + Clone {
        self.ends.iter().filter_map(|end| end.beside.as_ref()?.seam.as_ref()).map(|(_, seam)| seam)
    }

    pub fn held_bytes(&self) -> u64 {
        let beside = self.ends.iter().filter_map(|end| end.beside.as_ref());
        self.rows.held_bytes() + beside.map(|beside| beside.rows.held_bytes() + beside.row.bytes()).sum::<u64>()
    }
}

impl Beside {
    /// The tile beyond an end of `rows`, if another one is there.
    fn open(reach: &Reach, rows: &HeightRows, is_first: bool, files: &TileFiles) -> Result<Option<Self>> {
        let Some(path) = reach.tile() else { return Ok(None) };
        let width = rows.size().width();
        let seam = reach.shared(is_first, width).zip(reach.seam());
        let row = Samples::zeroed(rows.height_type(), width);
        Ok(Some(Self { path: Path::to_owned(path), rows: files.open(path)?, row, seam }))
    }
}

/// Copies one sample to another place.
fn repeat(row: &mut HeightsMut<'_>, from: usize, to: usize) {
    match row {
        HeightsMut::U8(row) => row[to] = row[from],
        HeightsMut::U16(row) => row[to] = row[from],
        HeightsMut::F32(row) => row[to] = row[from],
    }
}
