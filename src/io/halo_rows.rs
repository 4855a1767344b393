//! A tile of a larger map with the texels around it: one more row above and below, one more column on either side.

use super::halo::{Halo, TileRow};
use super::input::Watch;
use super::samples::{Samples, copy, len, part, part_mut};
use super::seam::{Seam, warnings};
use super::wide_rows::WideRows;
use super::{ReadOptions, open_heights};
use crate::error::{Error, Result};
use crate::map::{HeightType, HeightsMut, Size};
use crate::stream::{HeightRows, RowSource, Stop};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// What looks wrong where tiles meet, once all rows were read.
pub(crate) type SeamWarnings = Arc<Mutex<Vec<String>>>;

/// The rows of a tile with its halo, from the one above to the one below; each begins and ends a texel further out.
///
/// The tiles to the left and right are read beside it, and a row each of those above and below. None of them may change
/// before the last row is given.
pub(crate) struct HaloRows {
    path: PathBuf,
    read: ReadOptions,
    halo: Halo,
    /// The tiles around it, as they were found.
    around: Vec<Watch>,
    /// Ends the way to a row of a tile above.
    stop: Stop,
    size: Size,
    body: WideRows,
    /// The tile's own row that stands below its last one, if no other tile is there.
    below: Option<(usize, Samples)>,
    /// The row of the tile above that may be the first one of the tile itself; near the end, its own last one.
    border: Option<Samples>,
    /// Where it meets the tiles above and below.
    seams: [Option<Seam>; 2],
    told: SeamWarnings,
    next_row: usize,
}

impl HaloRows {
    /// `rows` are those of the tile at `path`; the tiles around it are read by the same options, until `stop`. What
    /// looks wrong is `told` with the last row.
    ///
    /// # Errors
    /// As [`open_heights`]; [`Error::File`] if another tile has another size or type, or shares too much with this one.
    pub fn new(
        path: &Path,
        rows: HeightRows,
        halo: Halo,
        read: &ReadOptions,
        stop: Stop,
        told: SeamWarnings,
    ) -> Result<Self> {
        let (inner, height_type) = (rows.size(), rows.height_type());
        let around = halo.tiles().into_iter().map(Watch::at).collect::<Result<_>>()?;
        for tile in halo.tiles() {
            check_alike(path, (inner, height_type), tile, &open_heights(tile, read)?.rows)?;
        }
        let overlap = halo.overlap().unwrap_or(0);
        if overlap.saturating_add(2) > inner.width().min(inner.height()) {
            let range = format!("at least 2 less than the sides of the tiles, which have {inner} texels");
            return Err(Error::parameter("overlap", overlap, range));
        }
        let size = Size::new(inner.width() + 2, inner.height() + 2)?;
        let [over, own, under] = &halo.rows;
        let body = WideRows::new(rows, &own.ends, halo.edges, read)?;
        let stands_below = || {
            let row = halo.edges.y.resolve(inner.height() as isize, inner.height());
            (row, Samples::zeroed(height_type, size.width()))
        };
        let below = under.tile.tile().is_none().then(stands_below);
        let seams = [over, under].map(|row| row.tile.seam());
        let (path, read) = (path.into(), read.clone());
        Ok(Self { path, read, halo, around, stop, size, body, below, border: None, seams, told, next_row: 0 })
    }

    /// A row of the tile above or below, or of the tile itself in its place. Of another tile the row comes back that may
    /// be the first or last one of the tile itself too.
    fn read_rim(&self, above: bool, mut row: HeightsMut<'_>) -> Result<Option<Samples>> {
        let (width, height) = (self.size.width(), self.size.height() - 2);
        let [over, _, under] = &self.halo.rows;
        let TileRow { tile, ends } = if above { over } else { under };
        let place = tile.place(above, height, self.halo.edges.y);
        let shared_place = tile.shared(above, height).unwrap_or(place);
        let path = tile.tile().unwrap_or(&self.path);
        let mut rows = WideRows::new(open_heights(path, &self.read)?.rows, ends, self.halo.edges, &self.read)?;
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
        Ok(tile.overlap().map(|_| shared))
    }

    /// A row of the tile itself.
    fn read_own(&mut self, mut row: HeightsMut<'_>) -> Result<()> {
        let width = self.size.width();
        self.body.read(part_mut(&mut row, 0..width))?;
        if let Some((_, below)) = self.below.as_mut().filter(|(stands_below, _)| self.next_row == stands_below + 1) {
            copy(row.as_ref(), &mut below.as_mut());
        }
        if let (1, [Some(seam), _], Some(above)) = (self.next_row, &mut self.seams, &self.border) {
            seam.see(part(row.as_ref(), 1..width - 1), part(above.as_ref(), 1..width - 1));
        }
        if self.next_row + 2 == self.size.height() && self.seams[1].is_some() {
            let mut own = Samples::zeroed(self.height_type(), width);
            copy(row.as_ref(), &mut own.as_mut());
            self.border = Some(own);
        }
        Ok(())
    }

    /// The row below the tile.
    fn read_last(&mut self, mut row: HeightsMut<'_>) -> Result<()> {
        if let Some((_, below)) = &self.below {
            copy(below.as_ref(), &mut row);
            return Ok(());
        }
        let inner = 1..self.size.width() - 1;
        let below = self.read_rim(false, row)?;
        if let ([_, Some(seam)], Some(own), Some(below)) = (&mut self.seams, &self.border, &below) {
            seam.see(part(own.as_ref(), inner.clone()), part(below.as_ref(), inner));
        }
        Ok(())
    }

    /// Says what was seen where tiles meet; fails if one changed.
    fn end(&self) -> Result<()> {
        let seams = self.seams.iter().flatten();
        *self.told.lock().unwrap_or_else(PoisonError::into_inner) = warnings(seams.chain(self.body.seams()));
        self.around.iter().try_for_each(Watch::check)
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
        let (width, last) = (self.size.width(), self.size.height() - 1);
        let count = len(&rows) / width;
        for index in 0..count {
            let row = part_mut(&mut rows, index * width..(index + 1) * width);
            match self.next_row {
                0 => self.border = self.read_rim(true, row)?,
                next if next < last => self.read_own(row)?,
                _ => self.read_last(row)?,
            }
            self.next_row += 1;
        }
        if self.next_row > last { self.end() } else { Ok(()) }
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

/// Fails unless a tile has the size and type of the one at `path`.
fn check_alike(path: &Path, own: (Size, HeightType), tile: &Path, rows: &HeightRows) -> Result<()> {
    let found = (rows.size(), rows.height_type());
    if found == own {
        return Ok(());
    }
    let (name, ((size, height_type), (own_size, own_type))) = (path.display(), (found, own));
    let reason = format!("it is {size} of {height_type}, and its neighbour {name} is {own_size} of {own_type}");
    Err(Error::file(tile, reason, "tiles of one map have the same size and type: export them again"))
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
    use crate::map::{Edge, Edges};
    use crate::stream::Monitor;
    use std::fs::{self, File};
    use std::time::SystemTime;

    const SIDE: usize = 4;

    /// The rows of a tile between two others.
    fn rows(folder: &Path, stop: Stop) -> HaloRows {
        let tiles = ["above.raw", "own.raw", "below.raw"].map(|name| folder.join(name));
        tiles.iter().for_each(|tile| fs::write(tile, [7; SIDE * SIDE]).unwrap());
        let read = ReadOptions { raw: Some(format!("{SIDE}x{SIDE}:u8").parse().unwrap()), ..ReadOptions::default() };
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
        for name in ["above.raw", "below.raw"] {
            let mut rows = rows(folder.path(), Stop::default());
            let mut read = |count: usize| rows.read(HeightsMut::U8(&mut vec![0; count * (SIDE + 2)]));
            read(SIDE + 1).unwrap();
            let changed = File::options().write(true).open(folder.path().join(name)).unwrap();
            changed.set_modified(SystemTime::UNIX_EPOCH).unwrap();
            let error = read(1).unwrap_err().to_string();
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
