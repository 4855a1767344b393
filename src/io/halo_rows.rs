//! A tile of a larger map with the texels around it: one more row above and below, one more column on either side.

use super::ReadOptions;
use super::halo::{Halo, TileRow};
use super::samples::{Samples, copy, len, part, part_mut};
use super::seam::{RowSeam, warnings};
use super::tile_files::TileFiles;
use super::wide_rows::WideRows;
use crate::error::{Error, Result};
use crate::map::{HeightType, Heights, HeightsMut, Size};
use crate::stream::{HeightRows, RowSource, Stop};
use std::num::NonZeroU32;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// What looks wrong where tiles meet, once all rows were read.
pub(crate) type SeamWarnings = Arc<Mutex<Vec<String>>>;

/// The rows of a tile with its halo, from the one above to the one below; each begins and ends a texel further out.
///
/// The tiles to the left and right are read beside it, and a row each of those above and below. None of them may change
/// before the last row is given.
pub(crate) struct HaloRows {
    files: TileFiles,
    halo: Halo,
    /// By what all tiles are reduced.
    shrink: NonZeroU32,
    /// Ends the way to a row of a tile above.
    stop: Stop,
    size: Size,
    body: WideRows,
    /// The tile's own row that stands below its last one, if no other tile is there.
    below: Option<(usize, Samples)>,
    /// Where it meets the tiles above and below.
    seams: [Option<RowSeam>; 2],
    told: SeamWarnings,
    next_row: usize,
}

impl HaloRows {
    /// `rows` are those of the tile at `path`; the tiles around it are read by the same options, until `stop`. What
    /// looks wrong is `told` with the last row.
    ///
    /// # Errors
    /// As [`open_heights`](super::open_heights); [`Error::File`] if another tile has another size or type;
    /// [`Error::Parameter`] if tiles share too much, or no whole texels once they are reduced.
    pub fn new(
        path: &Path,
        rows: HeightRows,
        halo: Halo,
        read: &ReadOptions,
        stop: Stop,
        told: SeamWarnings,
    ) -> Result<Self> {
        let (inner, height_type, shrink) = (rows.size(), rows.height_type(), read.shrink);
        let halo = halo.reduced(shrink)?;
        let files = TileFiles::new(path, &rows, &halo.tiles(), read)?;
        check_overlap(halo.overlap().unwrap_or(0), inner, shrink)?;
        let size = Size::new(inner.width() + 2, inner.height() + 2)?;
        let [over, own, under] = &halo.rows;
        let body = WideRows::new(rows, &own.ends, halo.edges, &files)?;
        let stands_below = || {
            let row = halo.edges.y.resolve(inner.height() as isize, inner.height());
            (row, Samples::zeroed(height_type, size.width()))
        };
        let below = under.tile.tile().is_none().then(stands_below);
        let seams = [over, under].map(|row| row.tile.seam().map(RowSeam::new));
        Ok(Self { files, halo, shrink, stop, size, body, below, seams, told, next_row: 0 })
    }

    /// A row of the tile above or below, or of the tile itself in its place.
    fn read_rim(&mut self, above: bool, mut row: HeightsMut<'_>) -> Result<()> {
        let (width, height) = (self.size.width(), self.size.height() - 2);
        let TileRow { tile, ends } = &self.halo.rows[if above { 0 } else { 2 }];
        let place = tile.place(above, height, self.halo.edges.y);
        let shared_place = tile.shared(above, height).unwrap_or(place);
        let path = tile.tile().unwrap_or(self.files.own());
        let mut rows = WideRows::new(self.files.open(path)?, ends, self.halo.edges, &self.files)?;
        let mut shared = Samples::zeroed(self.height_type(), width);
        let mut read = || {
            rows.skip(place.min(shared_place), &self.stop)?;
            if shared_place < place {
                rows.read(shared.as_mut())?;
            }
            rows.read(part_mut(&mut row, 0..width))?;
            match shared_place > place {
                true => rows.read(shared.as_mut()),
                false => Ok(()),
            }
        };
        read().map_err(named(path))?;
        if shared_place == place {
            copy(row.as_ref(), &mut shared.as_mut());
        }
        self.see(above, shared.as_ref());
        Ok(())
    }

    /// A row of the tile itself.
    fn read_own(&mut self, mut row: HeightsMut<'_>) -> Result<()> {
        self.body.read(part_mut(&mut row, 0..self.size.width()))?;
        if let Some((_, below)) = self.below.as_mut().filter(|(stands_below, _)| self.next_row == stands_below + 1) {
            copy(row.as_ref(), &mut below.as_mut());
        }
        if self.next_row == 1 {
            self.see(true, row.as_ref());
        }
        if self.next_row + 2 == self.size.height() {
            self.see(false, row.as_ref());
        }
        Ok(())
    }

    /// The row below the tile.
    fn read_last(&mut self, mut row: HeightsMut<'_>) -> Result<()> {
        if let Some((_, below)) = &self.below {
            copy(below.as_ref(), &mut row);
            return Ok(());
        }
        self.read_rim(false, row)
    }

    /// Takes a row, of either tile, that may be in the tile above or below too.
    fn see(&mut self, above: bool, row: Heights<'_>) {
        let inner = 1..self.size.width() - 1;
        self.seams[if above { 0 } else { 1 }].iter_mut().for_each(|seam| seam.take(part(row, inner.clone())));
    }

    fn read_row(&mut self, row: HeightsMut<'_>) -> Result<()> {
        let last = self.size.height() - 1;
        match self.next_row {
            0 => self.read_rim(true, row)?,
            next if next < last => self.read_own(row)?,
            _ => self.read_last(row)?,
        }
        self.next_row += 1;
        if self.next_row > last { self.end() } else { Ok(()) }
    }

    /// Says what was seen where tiles meet; fails if one changed.
    fn end(&self) -> Result<()> {
        let seams = self.seams.iter().flatten().map(|rows| &rows.seam).chain(self.body.seams());
        *self.told.lock().unwrap_or_else(PoisonError::into_inner) = warnings(seams, self.shrink);
        self.files.check()
    }
}

impl RowSource for HaloRows {
    fn size(&self) -> Size {
        self.size
    }

    fn height_type(&self) -> HeightType {
        self.body.rows.height_type()
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        let width = self.size.width();
        for index in 0..len(&rows) / width {
            let read = self.read_row(part_mut(&mut rows, index * width..(index + 1) * width));
            self.files.explain(read)?;
        }
        Ok(())
    }

    /// Its first and last rows are there already: what lies beyond them is never asked for.
    fn rewind(&mut self) -> Result<()> {
        Err(Error::parameter("edge", "wrap", "clamp around a tile with its halo"))
    }

    /// At most the tile above or below is open beside the tile's own row of tiles, and holds as much.
    fn held_bytes(&self) -> u64 {
        let below = self.below.as_ref().map_or(0, |(_, below)| below.bytes());
        let border = (self.size.width() * self.height_type().bytes()) as u64;
        2 * (self.body.held_bytes() + border) + below
    }
}

/// Fails if tiles of this size, reduced by `shrink`, share all but a texel of a side.
fn check_overlap(overlap: usize, tile: Size, shrink: NonZeroU32) -> Result<()> {
    // Tiles that share nothing may be as narrow as a texel.
    if overlap == 0 || overlap.saturating_add(2) <= tile.width().min(tile.height()) {
        return Ok(());
    }
    let by = shrink.get() as usize;
    let file = Size::new(tile.width() * by, tile.height() * by)?;
    let range = format!("at least {} less than the sides of the tiles, which have {file} texels", 2 * by);
    Err(Error::parameter("overlap", overlap * by, range))
}

/// An error that does not say in which file it is, with the file.
pub(super) fn named(path: &Path) -> impl FnOnce(Error) -> Error + '_ {
    move |error| match error {
        Error::NotFinite { x, y, value } => {
            let reason = format!("the height at column {x}, row {y} is {value}");
            Error::file(path, reason, "replace it in the map, or export the map without no-data texels")
        }
        error => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::halo::Reach;
    use crate::io::open_heights;
    use crate::map::{Edge, Edges};
    use crate::stream::Monitor;
    use std::fs::{self, File};
    use std::time::SystemTime;

    const SIDE: usize = 4;

    /// A square picture in grey.
    fn tga(side: usize) -> Vec<u8> {
        let header = [0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, side as u8, 0, side as u8, 0, 8, 0x20];
        [&header[..], &vec![7; side * side]].concat()
    }

    /// The rows of a tile between two others.
    fn rows(folder: &Path, stop: Stop) -> HaloRows {
        let tiles = ["above.tga", "own.tga", "below.tga"].map(|name| folder.join(name));
        tiles.iter().for_each(|tile| fs::write(tile, tga(SIDE)).unwrap());
        let read = ReadOptions::default();
        let [above, own, below] = tiles;
        let row = |tile| TileRow { tile, ends: Default::default() };
        let beside = |tile| row(Reach::Beside { tile, overlap: 0 });
        let halo = Halo { rows: [beside(above), row(Reach::Own), beside(below)], edges: Edges::both(Edge::Clamp) };
        let rows = open_heights(&own, &read).unwrap().rows;
        HaloRows::new(&own, rows, halo, &read, stop, SeamWarnings::default()).unwrap()
    }

    #[test]
    fn a_tile_that_changes_spoils_its_neighbours() {
        let folder = tempfile::tempdir().unwrap();
        let touch = |tile: &Path| {
            File::options().write(true).open(tile).unwrap().set_modified(SystemTime::UNIX_EPOCH).unwrap();
        };
        let enlarge = |tile: &Path| fs::write(tile, tga(SIDE + 3)).unwrap();
        let spoil = |tile: &Path| fs::write(tile, "no picture").unwrap();
        let remove = |tile: &Path| fs::remove_file(tile).unwrap();
        let changes: [&dyn Fn(&Path); 4] = [&touch, &enlarge, &spoil, &remove];
        // The tile above is opened for the first row, the one below for the last.
        for (name, before, change) in changes.iter().flat_map(|change| {
            [("above.tga", 0, change), ("above.tga", SIDE + 1, change), ("below.tga", SIDE + 1, change)]
        }) {
            let mut rows = rows(folder.path(), Stop::default());
            let mut read = |count: usize| rows.read(HeightsMut::U8(&mut vec![0; count * (SIDE + 2)]));
            read(before).unwrap();
            change(&folder.path().join(name));
            let error = read(SIDE + 2 - before).unwrap_err().to_string();
            assert!(error.contains(&format!("{name}: it changed or went while it was read")), "{error}");
        }
    }

    #[test]
    fn the_way_to_a_row_of_the_tile_above_can_be_stopped() {
        let (folder, monitor) = (tempfile::tempdir().unwrap(), Monitor::default());
        let mut rows = rows(folder.path(), monitor.stop());
        monitor.cancel();
        assert!(matches!(rows.read(HeightsMut::U8(&mut [0; SIDE + 2])), Err(Error::Cancelled)));
    }
}
