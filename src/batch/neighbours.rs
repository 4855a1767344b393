//! Tiles of one large map: which files lie beside a tile.

use crate::error::{Error, Result};
use crate::io::{Halo, HaloRows, Reach, ReadOptions, TileRow};
use crate::map::{Edge, Edges};
use crate::ops::bake::{BakeOptions, Filter};
use crate::stream::{HeightRows, Monitor};
use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The names of the tiles of a map: text with `{x}`, which counts the tiles to the right, and `{y}`, which counts them
/// down the rows. Both are integers, which may be negative or have zeros in front.
///
/// ```
/// use texbake::batch::TileTemplate;
///
/// let template: TileTemplate = "tiles_{x}_{y}.png".parse()?;
/// assert_eq!(template.to_string(), "tiles_{x}_{y}.png");
/// assert!("tiles_{x}.png".parse::<TileTemplate>().is_err());
/// assert!("tiles_{x}{y}.png".parse::<TileTemplate>().is_err());
/// # Ok::<(), texbake::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct TileTemplate {
    /// What stands before, between and behind the numbers.
    texts: [String; 3],
    y_first: bool,
}

/// Where a tile lies: its row of tiles from the top, its column from the left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    y: i64,
    x: i64,
}

impl FromStr for TileTemplate {
    type Err = Error;

    /// # Errors
    /// [`Error::Parameter`] unless both numbers are there once, with a text between them, and no digit follows one.
    fn from_str(text: &str) -> Result<Self> {
        let split = || {
            let y_first = text.find("{y}")? < text.find("{x}")?;
            let [first, second] = if y_first { ["{y}", "{x}"] } else { ["{x}", "{y}"] };
            let (before, rest) = text.split_once(first)?;
            let (between, behind) = rest.split_once(second)?;
            let texts = [before, between, behind].map(str::to_owned);
            let are_plain = texts.iter().all(|text| !text.contains(['{', '}', '/', '\\']));
            let ends = |text: &str| !text.starts_with(|next: char| next.is_ascii_digit());
            (are_plain && !between.is_empty() && ends(between) && ends(behind)).then_some(Self { texts, y_first })
        };
        let range = "a file name in which {x} and {y} stand for the column and the row of a tile, each once and with \
                     something else than a digit behind it, such as tiles_{x}_{y}.png";
        split().ok_or_else(|| Error::parameter("neighbours", text, range))
    }
}

impl fmt::Display for TileTemplate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [before, between, behind] = &self.texts;
        let [first, second] = if self.y_first { ["{y}", "{x}"] } else { ["{x}", "{y}"] };
        write!(f, "{before}{first}{between}{second}{behind}")
    }
}

impl TileTemplate {
    /// Where the tile of this name lies, if it is the name of one.
    fn place(&self, name: &str) -> Option<Place> {
        let [before, between, behind] = &self.texts;
        let (first, rest) = number(name.strip_prefix(before.as_str())?)?;
        let (second, rest) = number(rest.strip_prefix(between.as_str())?)?;
        let [x, y] = if self.y_first { [second, first] } else { [first, second] };
        (rest == behind).then_some(Place { y, x })
    }
}

/// The integer at the beginning of a text, and the rest.
fn number(text: &str) -> Option<(i64, &str)> {
    let digits = text.strip_prefix('-').unwrap_or(text);
    let end = text.len() - digits.trim_start_matches(|next: char| next.is_ascii_digit()).len();
    Some((text[..end].parse().ok()?, &text[end..]))
}

/// The tiles of folders, each of which is listed once.
#[derive(Debug, Default)]
pub struct TileFolders(HashMap<(PathBuf, TileTemplate), Tiles>);

/// The tiles of a folder.
#[derive(Debug)]
struct Tiles {
    files: BTreeMap<Place, PathBuf>,
    /// The first and the last tile of each column of tiles.
    columns: HashMap<i64, [Place; 2]>,
}

/// What lies around a tile, for one filter and one pair of edge modes.
///
/// Each texel beyond a side is one of the tile beside it. Where there is none, the edge mode holds: clamp and mirror
/// give the tile's own texels, and wrap those at the far side of the last tile in this row or column of tiles. The
/// maps of a rectangle of tiles are those of the whole map, cut.
///
/// At a corner the tile above or below decides, or what stands for it: the texel is the one beyond that tile's side.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Neighbours(Halo);

impl TileFolders {
    /// What lies around the tile `input`, in its own folder. Tiles beside each other share `overlap` texels, which are
    /// those of the map only once.
    ///
    /// # Errors
    /// [`Error::File`] if `input` has not such a name, or two files are one tile; [`Error::Io`] if the folder cannot be
    /// listed.
    pub fn around(
        &mut self,
        input: &Path,
        template: &TileTemplate,
        overlap: usize,
        options: &BakeOptions,
    ) -> Result<Neighbours> {
        let name = input.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let place = template.place(name).ok_or_else(|| {
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
        Ok(Neighbours(sides.around(place, looks_at_corners)))
    }
}

impl Tiles {
    fn in_folder(folder: &Path, template: &TileTemplate) -> Result<Self> {
        let listed = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let mut files = BTreeMap::new();
        for entry in std::fs::read_dir(listed).map_err(Error::io(listed))? {
            let name = entry.map_err(Error::io(listed))?.file_name();
            let Some(place) = name.to_str().and_then(|name| template.place(name)) else { continue };
            let path = folder.join(&name);
            if let Some(other) = files.insert(place, path.clone()) {
                let reason = format!("it is the same tile as {}: column {}, row {}", other.display(), place.x, place.y);
                return Err(Error::file(path, reason, "move one of them away"));
            }
        }
        let mut columns = HashMap::new();
        for place in files.keys() {
            columns.entry(place.x).or_insert([*place; 2])[1] = *place;
        }
        Ok(Self { files, columns })
    }

    /// The first and the last tile of a row of tiles.
    fn row(&self, y: i64) -> Option<[Place; 2]> {
        first_and_last(self.files.range(Place { y, x: i64::MIN }..=Place { y, x: i64::MAX }).map(|(place, _)| *place))
    }

    /// The first and the last tile of a column of tiles.
    fn column(&self, x: i64) -> Option<[Place; 2]> {
        self.columns.get(&x).copied()
    }
}

fn first_and_last(mut places: impl DoubleEndedIterator<Item = Place>) -> Option<[Place; 2]> {
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
    fn around(&self, place: Place, looks_at_corners: bool) -> Halo {
        let (above, up) = self.vertical(place, -1);
        let (below, down) = self.vertical(place, 1);
        let corners = |of| if looks_at_corners { self.ends(of) } else { Default::default() };
        let rows = [
            TileRow { tile: up, ends: corners(above) },
            TileRow { tile: Reach::default(), ends: self.ends(place) },
            TileRow { tile: down, ends: corners(below) },
        ];
        Halo { rows, edges: self.edges }
    }

    /// What lies one step up or down.
    fn vertical(&self, place: Place, step: i64) -> (Place, Reach) {
        let beside = place.y.checked_add(step).map(|y| Place { y, ..place });
        self.beyond(place, beside, far_side(self.tiles.column(place.x), step), self.edges.y)
    }

    /// What lies to the left and to the right.
    fn ends(&self, place: Place) -> [Reach; 2] {
        [-1, 1].map(|step| {
            let beside = place.x.checked_add(step).map(|x| Place { x, ..place });
            self.beyond(place, beside, far_side(self.tiles.row(place.y), step), self.edges.x).1
        })
    }

    /// The tile beside another one; where there is none, the one at the far side of a map that wraps, or itself.
    fn beyond(&self, place: Place, beside: Option<Place>, far: Option<Place>, edge: Edge) -> (Place, Reach) {
        let find = |wanted: Option<Place>| self.tiles.files.get_key_value(&wanted?);
        let far = far.filter(|far| edge == Edge::Wrap && *far != place);
        match (find(beside), find(far)) {
            (Some((place, path)), _) => (*place, Reach { tile: Some(path.clone()), overlap: self.overlap }),
            (None, Some((place, path))) => (*place, Reach { tile: Some(path.clone()), overlap: 0 }),
            (None, None) => (place, Reach::default()),
        }
    }
}

/// Going backwards, the last tile is at the far side.
fn far_side(ends: Option<[Place; 2]>, step: i64) -> Option<Place> {
    ends.map(|[first, last]| if step < 0 { last } else { first })
}

impl fmt::Display for Neighbours {
    /// The tiles around it in three rows, each from the left.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Neighbours {
    /// Which they are.
    pub(super) fn halo(&self) -> &Halo {
        &self.0
    }

    /// The edge modes for which they were found.
    pub(super) fn edges(&self) -> Edges {
        self.0.edges
    }

    /// The rows of the tile `input` with their halo, until the monitor ends them.
    pub(super) fn around(
        &self,
        input: &Path,
        rows: HeightRows,
        read: &ReadOptions,
        monitor: &Monitor,
    ) -> Result<HaloRows> {
        HaloRows::new(input, rows, self.0.clone(), read, monitor.stop())
    }

    /// The tiles that are read beside the tile itself, each once.
    pub fn files(&self) -> Vec<&Path> {
        self.0.tiles()
    }
}
