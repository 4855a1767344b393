//! Tiles of one large map: which files lie beside a tile.

use super::tile_template::{TilePlace, TileTemplate};
use crate::error::{Error, Result};
use crate::io::{Halo, HaloRows, Reach, ReadOptions, SeamWarnings, TileRow, WriteOptions};
use crate::map::{Edge, Edges};
use crate::ops::bake::{BakeOptions, Filter};
use crate::stream::{HeightRows, Monitor};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// The tiles of folders, each of which is listed once.
#[derive(Debug, Default)]
pub struct TileFolders(HashMap<(PathBuf, TileTemplate), Tiles>);

/// The tiles of a folder.
#[derive(Debug)]
struct Tiles {
    files: BTreeMap<TilePlace, PathBuf>,
    /// Other files that are the same tile.
    doubled: BTreeMap<TilePlace, PathBuf>,
    /// The digits of numbers with zeros in front, in the order in which names have them.
    digits: [usize; 2],
    /// The first and the last tile of each column of tiles.
    columns: HashMap<i64, [TilePlace; 2]>,
}

/// What lies around a tile, for one filter and one pair of edge modes.
///
/// Each texel beyond a side is one of the tile beside it. Where there is none, the edge mode holds: clamp and mirror
/// give the tile's own texels, and wrap those at the far side of the last tile in this row or column of tiles. The
/// maps of a rectangle of tiles are those of the whole map, cut.
///
/// At a corner the tile above or below decides, or what stands for it: the texel is the one beyond that tile's side.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Neighbours {
    halo: Halo,
    missing: Vec<PathBuf>,
}

impl TileFolders {
    /// What lies around the tile `input`, in its own folder. Tiles beside each other share `overlap` texels of their files,
    /// which are those of the map only once.
    ///
    /// # Errors
    /// [`Error::File`] if `input` has not such a name, or two files are this tile, or one that would be read beside it;
    /// [`Error::Io`] if the folder cannot be listed.
    pub fn around(
        &mut self,
        input: &Path,
        template: &TileTemplate,
        overlap: usize,
        options: &BakeOptions,
    ) -> Result<Neighbours> {
        let place = template.place_of(input).ok_or_else(|| {
            let reason = format!("its name is not {template} with numbers for {{x}} and {{y}}");
            Error::file(input, reason, "change --neighbours, or leave it out for this file")
        })?;
        let folder = input.parent().unwrap_or(Path::new("")).to_owned();
        let key = (folder, template.clone());
        if !self.0.contains_key(&key) {
            let tiles = Tiles::in_folder(&key.0, template)?;
            self.0.insert(key.clone(), tiles);
        }
        let sides = Sides { tiles: &self.0[&key], overlap, edges: options.edges };
        // The central stencil looks at no corner.
        let looks_at_corners = options.filter != Filter::Central;
        let halo = sides.around(place, looks_at_corners);
        let read = halo.tiles().into_iter().filter_map(|tile| template.place_of(tile));
        [place].into_iter().chain(read).try_for_each(|place| sides.tiles.check_single(place))?;
        let path = |place| key.0.join(template.name(place, sides.tiles.digits));
        let missing = sides.tiles.holes_beside(place).map(path).collect();
        Ok(Neighbours { halo, missing })
    }
}

impl Tiles {
    fn in_folder(folder: &Path, template: &TileTemplate) -> Result<Self> {
        let listed = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let (mut files, mut doubled, mut digits) = (BTreeMap::new(), BTreeMap::new(), [0; 2]);
        for entry in std::fs::read_dir(listed).map_err(Error::io(listed))? {
            let entry = entry.map_err(Error::io(listed))?;
            let path = folder.join(entry.file_name());
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            let Some(place) = template.place_of(&path).filter(|_| !is_folder) else { continue };
            let padded = template.padded_digits(&path);
            digits = [digits[0].max(padded[0]), digits[1].max(padded[1])];
            if let Some(other) = files.insert(place, path) {
                doubled.insert(place, other);
            }
        }
        let mut columns = HashMap::new();
        for place in files.keys() {
            columns.entry(place.x).or_insert([*place; 2])[1] = *place;
        }
        Ok(Self { files, doubled, digits, columns })
    }

    /// Fails if two files are the tile at a place.
    fn check_single(&self, place: TilePlace) -> Result<()> {
        let Some((one, other)) = self.files.get(&place).zip(self.doubled.get(&place)) else { return Ok(()) };
        // Folders are listed in no order.
        let (first, second) = (one.min(other), one.max(other));
        let reason = format!("it is the same tile as {}: column {}, row {}", first.display(), place.x, place.y);
        Err(Error::file(second, reason, "move one of them away"))
    }

    /// The first and the last tile of a row of tiles.
    fn row(&self, y: i64) -> Option<[TilePlace; 2]> {
        first_and_last(
            self.files.range(TilePlace { y, x: i64::MIN }..=TilePlace { y, x: i64::MAX }).map(|(place, _)| *place),
        )
    }

    /// The first and the last tile of a column of tiles.
    fn column(&self, x: i64) -> Option<[TilePlace; 2]> {
        self.columns.get(&x).copied()
    }

    /// Where there is no tile beside one, although its row or its column of tiles goes on further out.
    fn holes_beside(&self, TilePlace { y, x }: TilePlace) -> impl Iterator<Item = TilePlace> {
        let steps = [(-1, 0), (1, 0), (0, -1), (0, 1)];
        let beside = steps
            .into_iter()
            .filter_map(move |(down, right)| Some(TilePlace { y: y.checked_add(down)?, x: x.checked_add(right)? }));
        let is_between = |place: TilePlace, ends: Option<[TilePlace; 2]>| {
            ends.is_some_and(|[first, last]| (first..=last).contains(&place))
        };
        beside.filter(move |place| {
            let is_within = is_between(*place, self.row(place.y)) || is_between(*place, self.column(place.x));
            is_within && !self.files.contains_key(place)
        })
    }
}

fn first_and_last(mut places: impl DoubleEndedIterator<Item = TilePlace>) -> Option<[TilePlace; 2]> {
    let first = places.next()?;
    Some([first, places.next_back().unwrap_or(first)])
}

/// Looks for what lies beyond the sides of tiles.
struct Sides<'a> {
    tiles: &'a Tiles,
    overlap: usize,
    edges: Edges,
}

impl Sides<'_> {
    fn around(&self, place: TilePlace, looks_at_corners: bool) -> Halo {
        let (above, up) = self.vertical(place, -1);
        let (below, down) = self.vertical(place, 1);
        let corners = |of| if looks_at_corners { self.ends(of) } else { Default::default() };
        let rows = [
            TileRow { tile: up, ends: corners(above) },
            TileRow { tile: Reach::Own, ends: self.ends(place) },
            TileRow { tile: down, ends: corners(below) },
        ];
        Halo { rows, edges: self.edges }
    }

    /// What lies one step up or down.
    fn vertical(&self, place: TilePlace, step: i64) -> (TilePlace, Reach) {
        let beside = place.y.checked_add(step).map(|y| TilePlace { y, ..place });
        self.beyond(place, beside, far_side(self.tiles.column(place.x), step), self.edges.y)
    }

    /// What lies to the left and to the right.
    fn ends(&self, place: TilePlace) -> [Reach; 2] {
        [-1, 1].map(|step| {
            let beside = place.x.checked_add(step).map(|x| TilePlace { x, ..place });
            self.beyond(place, beside, far_side(self.tiles.row(place.y), step), self.edges.x).1
        })
    }

    /// The tile beside another one; where there is none, the one at the far side of a map that wraps, or itself.
    fn beyond(
        &self,
        place: TilePlace,
        beside: Option<TilePlace>,
        far: Option<TilePlace>,
        edge: Edge,
    ) -> (TilePlace, Reach) {
        let find = |wanted: Option<TilePlace>| self.tiles.files.get_key_value(&wanted?);
        let far = far.filter(|far| edge == Edge::Wrap && *far != place);
        match (find(beside), find(far)) {
            (Some((place, path)), _) => (*place, Reach::Beside { tile: path.clone(), overlap: self.overlap }),
            (None, Some((place, path))) => (*place, Reach::Far(path.clone())),
            (None, None) => (place, Reach::Own),
        }
    }
}

/// Going backwards, the last tile is at the far side.
fn far_side(ends: Option<[TilePlace; 2]>, step: i64) -> Option<TilePlace> {
    ends.map(|[first, last]| if step < 0 { last } else { first })
}

impl Neighbours {
    /// Which they are.
    pub(super) fn halo(&self) -> &Halo {
        &self.halo
    }

    /// Fails if the tile cannot be baked so beside those around it.
    ///
    /// # Errors
    /// [`Error::Parameter`] for mip levels and a roughness map; for other edge modes than those for which the tiles were
    /// found; and if `read` reduces tiles that share a part of a reduced texel.
    pub fn check(&self, read: &ReadOptions, options: &BakeOptions, write: &WriteOptions) -> Result<()> {
        let left_out = "left out where a map has neighbours: their texels are for the largest level";
        if write.mips {
            return Err(Error::parameter("mips", "on", left_out));
        }
        if options.roughness.is_some() {
            return Err(Error::parameter("roughness", "on", left_out));
        }
        if options.edges != self.halo.edges {
            let range = format!("{}, as for its neighbours", self.halo.edges);
            return Err(Error::parameter("edge", options.edges, range));
        }
        self.halo.clone().reduced(read.shrink).map(drop)
    }

    /// What lies beyond each side and corner where it is another tile, by the names of sides.
    pub(super) fn sides(&self) -> BTreeMap<&'static str, String> {
        let other = self.halo.sides().into_iter().filter(|(_, reach)| reach.tile().is_some());
        other.map(|(side, reach)| (side, reach.to_string())).collect()
    }

    /// The rows of the tile `input` with their halo, as long as the monitor lets; what looks wrong is `told` at the end.
    pub(super) fn around(
        &self,
        input: &Path,
        rows: HeightRows,
        read: &ReadOptions,
        monitor: &Monitor,
        told: &SeamWarnings,
    ) -> Result<HaloRows> {
        HaloRows::new(input, rows, self.halo.clone(), read, monitor.stop(), told.clone())
    }

    /// The tiles that are read beside the tile itself, each once.
    pub fn files(&self) -> Vec<&Path> {
        self.halo.tiles()
    }

    /// Tiles that should be beside it and are not there, although the map goes on behind them. Its maps have the
    /// borders of the whole map at them.
    pub fn missing(&self) -> &[PathBuf] {
        &self.missing
    }
}
