//! A tile of a larger map with the texels around it: one more row above and below, one more column on either side.

use super::input::Watch;
use super::samples::{Samples, copy, len, part, part_mut};
use super::{ReadOptions, open_heights};
use crate::error::{Error, Result};
use crate::map::{Edges, HeightType, HeightsMut, Size};
use crate::stream::{HeightRows, RowSource, Stop, piece_rows};
use std::fmt;
use std::path::{Path, PathBuf};

/// Where the texels beyond one side of a tile are.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub(crate) struct Reach {
    /// The tile that has them; `None`: the tile itself, where its edge mode says.
    pub tile: Option<PathBuf>,
    /// Texels at this side that are in both tiles.
    pub overlap: usize,
}

/// A row of tiles: one, and what lies to its left and right.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct TileRow {
    pub tile: Reach,
    pub ends: [Reach; 2],
}

/// What lies around a tile: the row of tiles above it, its own, and the one below.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Halo {
    pub rows: [TileRow; 3],
    /// What holds where there is no tile beside another.
    pub edges: Edges,
}

impl Halo {
    /// The tiles that are read beside the tile itself, each once.
    pub fn tiles(&self) -> Vec<&Path> {
        let reaches = self.rows.iter().flat_map(|row| [&row.tile].into_iter().chain(&row.ends));
        let mut tiles: Vec<&Path> = reaches.filter_map(|reach| reach.tile.as_deref()).collect();
        tiles.sort();
        tiles.dedup();
        tiles
    }
}

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
    next_row: usize,
}

/// The rows of a tile, a texel longer on either side.
struct WideRows {
    rows: HeightRows,
    ends: [End; 2],
}

/// A column beyond a tile.
struct End {
    /// The tile that has it, and room for a row of it; `None`: the column of the tile itself.
    beside: Option<(PathBuf, HeightRows, Samples)>,
    column: usize,
}

impl fmt::Display for Reach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(tile) = &self.tile else { return f.write_str("edge") };
        // All tiles are in one folder, and are the same wherever it is.
        let name = tile.file_name().unwrap_or(tile.as_os_str()).display();
        match self.overlap {
            0 => write!(f, "{name}"),
            overlap => write!(f, "{name} overlapping by {overlap}"),
        }
    }
}

impl fmt::Display for Halo {
    /// Three rows of tiles, each from the left; `here` is the tile itself.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [over, own, under] = &self.rows;
        let row = |TileRow { tile, ends: [left, right] }: &TileRow| format!("{left}, {tile}, {right}");
        write!(f, "{}; {}, here, {}; {}", row(over), own.ends[0], own.ends[1], row(under))
    }
}

impl HaloRows {
    /// `rows` are those of the tile at `path`; the tiles around it are read by the same options, until `stop`.
    ///
    /// # Errors
    /// As [`open_heights`]; [`Error::File`] if another tile has another size or type, or shares too much with this one.
    pub fn new(path: &Path, rows: HeightRows, halo: Halo, read: &ReadOptions, stop: Stop) -> Result<Self> {
        let (inner, height_type) = (rows.size(), rows.height_type());
        let around = halo.tiles().into_iter().map(Watch::at).collect::<Result<_>>()?;
        for tile in halo.tiles() {
            check_alike(path, (inner, height_type), tile, &open_heights(tile, read)?.rows)?;
        }
        let widest = halo.rows.iter().flat_map(|row| [&row.tile].into_iter().chain(&row.ends));
        let overlap = widest.map(|reach| reach.overlap).max().unwrap_or(0);
        if overlap.saturating_add(2) > inner.width().min(inner.height()) {
            let range = format!("at least 2 less than the sides of the tiles, which have {inner} texels");
            return Err(Error::parameter("overlap", overlap, range));
        }
        let size = Size::new(inner.width() + 2, inner.height() + 2)?;
        let [_, own, under] = &halo.rows;
        let body = WideRows::new(rows, &own.ends, halo.edges, read)?;
        let stands_below = || {
            let row = halo.edges.y.resolve(inner.height() as isize, inner.height());
            (row, Samples::zeroed(height_type, size.width()))
        };
        let below = under.tile.tile.is_none().then(stands_below);
        Ok(Self { path: path.into(), read: read.clone(), size, body, below, next_row: 0, halo, around, stop })
    }

    /// A row of the tile above or below, or of the tile itself in its place.
    fn read_rim(&self, above: bool, row: HeightsMut<'_>) -> Result<()> {
        let (height, edge) = (self.size.height() - 2, self.halo.edges.y);
        let [over, _, under] = &self.halo.rows;
        let TileRow { tile, ends } = if above { over } else { under };
        let place = match (&tile.tile, above) {
            (Some(_), true) => height - 1 - tile.overlap,
            (Some(_), false) => tile.overlap,
            (None, _) => edge.resolve(-1, height),
        };
        let path = tile.tile.as_deref().unwrap_or(&self.path);
        let mut rows = WideRows::new(open_heights(path, &self.read)?.rows, ends, self.halo.edges, &self.read)?;
        rows.skip(place, &self.stop).and_then(|()| rows.read(row)).map_err(named(path))
    }
}

impl WideRows {
    fn new(rows: HeightRows, ends: &[Reach; 2], edges: Edges, read: &ReadOptions) -> Result<Self> {
        let (width, height_type) = (rows.size().width(), rows.height_type());
        let end = |Reach { tile, overlap }: &Reach, left: bool| {
            let column = match (tile, left) {
                (Some(_), true) => width - 1 - overlap,
                (Some(_), false) => *overlap,
                (None, true) => edges.x.resolve(-1, width),
                (None, false) => edges.x.resolve(width as isize, width),
            };
            let open = |path: &PathBuf| {
                Ok((path.clone(), open_heights(path, read)?.rows, Samples::zeroed(height_type, width)))
            };
            Ok(End { beside: tile.as_ref().map(open).transpose()?, column })
        };
        Ok(Self { ends: [end(&ends[0], true)?, end(&ends[1], false)?], rows })
    }

    /// Goes past the next rows, piece by piece: those of a file without entry points are decoded.
    fn skip(&mut self, count: usize, stop: &Stop) -> Result<()> {
        let piece_rows = piece_rows(self.rows.size(), self.rows.height_type());
        for first in (0..count).step_by(piece_rows) {
            let rows = piece_rows.min(count - first);
            stop.check()?;
            self.rows.skip(rows)?;
            for (path, beside, _) in self.ends.iter_mut().filter_map(|end| end.beside.as_mut()) {
                beside.skip(rows).map_err(named(path))?;
            }
        }
        Ok(())
    }

    /// Reads the next row and the texels at its ends.
    fn read(&mut self, mut row: HeightsMut<'_>) -> Result<()> {
        let width = self.rows.size().width();
        self.rows.read(part_mut(&mut row, 1..width + 1))?;
        for (End { beside, column }, place) in self.ends.iter_mut().zip([0, width + 1]) {
            match beside {
                Some((path, rows, beside)) => {
                    rows.read(beside.as_mut()).map_err(named(path))?;
                    copy(part(beside.as_ref(), *column..*column + 1), &mut part_mut(&mut row, place..place + 1));
                }
                None => repeat(&mut row, 1 + *column, place),
            }
        }
        Ok(())
    }

    fn held_bytes(&self) -> u64 {
        let beside = self.ends.iter().filter_map(|end| end.beside.as_ref());
        self.rows.held_bytes() + beside.map(|(_, rows, row)| rows.held_bytes() + row.bytes()).sum::<u64>()
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
            let mut row = part_mut(&mut rows, index * width..(index + 1) * width);
            match (self.next_row, &mut self.below) {
                (0, _) => self.read_rim(true, row)?,
                (next, Some((_, below))) if next == last => copy(below.as_ref(), &mut row),
                (next, None) if next == last => self.read_rim(false, row)?,
                (next, below) => {
                    self.body.read(part_mut(&mut row, 0..width))?;
                    if let Some((_, below)) = below.as_mut().filter(|(stands_below, _)| next == stands_below + 1) {
                        copy(row.as_ref(), &mut below.as_mut());
                    }
                }
            }
            self.next_row += 1;
        }
        if self.next_row > last { self.around.iter().try_for_each(Watch::check) } else { Ok(()) }
    }

    /// Its first and last rows are there already: what lies beyond them is never asked for.
    fn rewind(&mut self) -> Result<()> {
        Err(Error::parameter("edge", "wrap", "clamp around a tile with its halo"))
    }

    /// At most the tile above or below is open beside the tile's own row of tiles, and holds as much.
    fn held_bytes(&self) -> u64 {
        let below = self.below.as_ref().map_or(0, |(_, below)| below.bytes());
        2 * self.body.held_bytes() + below
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
fn named(path: &Path) -> impl FnOnce(Error) -> Error + '_ {
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
    use crate::map::Edge;
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
        let row = |tile| TileRow { tile: Reach { tile, overlap: 0 }, ends: Default::default() };
        let halo = Halo { rows: [row(Some(above)), row(None), row(Some(below))], edges: Edges::both(Edge::Clamp) };
        HaloRows::new(&own, open_heights(&own, &read).unwrap().rows, halo, &read, stop).unwrap()
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
