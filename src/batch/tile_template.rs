//! What tiles of one large map are called.

use crate::error::{Error, Result};
use std::fmt;
use std::path::Path;
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct TilePlace {
    pub y: i64,
    pub x: i64,
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
    /// Whether the file `path` is called like a tile.
    pub fn fits(&self, path: &Path) -> bool {
        self.place_of(path).is_some()
    }

    /// Where the tile `path` lies, if it is called like one.
    pub(super) fn place_of(&self, path: &Path) -> Option<TilePlace> {
        self.place(path.file_name()?.to_str()?)
    }

    /// Where the tile of this name lies, if it is the name of one.
    fn place(&self, name: &str) -> Option<TilePlace> {
        let [first, second] = self.numbers(name)?.map(str::parse);
        let [x, y] = if self.y_first { [second, first] } else { [first, second] };
        Some(TilePlace { y: y.ok()?, x: x.ok()? })
    }

    /// The numbers of a tile's name as it has them.
    fn numbers<'a>(&self, name: &'a str) -> Option<[&'a str; 2]> {
        let [before, between, behind] = &self.texts;
        let (first, rest) = number(name.strip_prefix(before.as_str())?);
        let (second, rest) = number(rest.strip_prefix(between.as_str())?);
        (rest == behind).then_some([first, second])
    }

    /// The digits of those numbers in the name of the tile `path` that have zeros in front, in the order of the name; 0
    /// for others.
    pub(super) fn padded_digits(&self, path: &Path) -> [usize; 2] {
        let numbers = path.file_name().and_then(|name| self.numbers(name.to_str()?)).unwrap_or_default();
        numbers.map(|number| number.trim_start_matches('-')).map(|digits| match digits.starts_with('0') {
            true => digits.len(),
            false => 0,
        })
    }

    /// What the tile at a place is called, if its numbers have at least so many digits.
    pub(super) fn name(&self, TilePlace { y, x }: TilePlace, digits: [usize; 2]) -> String {
        let written = |number: i64, digits: usize| {
            let sign = if number < 0 { "-" } else { "" };
            format!("{sign}{:0digits$}", number.unsigned_abs())
        };
        let [first, second] = if self.y_first { [y, x] } else { [x, y] };
        let [before, between, behind] = &self.texts;
        format!("{before}{}{between}{}{behind}", written(first, digits[0]), written(second, digits[1]))
    }
}

/// The integer at the beginning of a text, and the rest.
fn number(text: &str) -> (&str, &str) {
    let digits = text.strip_prefix('-').unwrap_or(text);
    text.split_at(text.len() - digits.trim_start_matches(|next: char| next.is_ascii_digit()).len())
}
