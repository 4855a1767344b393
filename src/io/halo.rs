//! What lies around a tile of a larger map.

use super::seam::Seam;
use crate::error::{Error, Result};
use crate::map::{Edge, Edges};
use std::fmt;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

/// Where the texels beyond one side of a tile are.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub(crate) enum Reach {
    /// In the tile itself, where its edge mode says.
    #[default]
    Own,
    /// In the tile beside it, which shares so many texels of this side.
    Beside { tile: PathBuf, overlap: usize },
    /// In the tile at the far side of a map that wraps.
    Far(PathBuf),
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
    /// What lies beyond each side and corner, by its name.
    pub fn sides(&self) -> [(&'static str, &Reach); 8] {
        let [over, own, under] = &self.rows;
        [
            ("above-left", &over.ends[0]),
            ("above", &over.tile),
            ("above-right", &over.ends[1]),
            ("left", &own.ends[0]),
            ("right", &own.ends[1]),
            ("below-left", &under.ends[0]),
            ("below", &under.tile),
            ("below-right", &under.ends[1]),
        ]
    }

    /// The tiles that are read beside the tile itself, each once.
    pub fn tiles(&self) -> Vec<&Path> {
        let mut tiles: Vec<&Path> = self.sides().into_iter().filter_map(|(_, reach)| reach.tile()).collect();
        tiles.sort();
        tiles.dedup();
        tiles
    }

    /// The same around a tile that is reduced by a factor.
    ///
    /// # Errors
    /// [`Error::Parameter`] if tiles share a part of a reduced texel.
    pub fn reduced(mut self, by: NonZeroU32) -> Result<Self> {
        let reaches = self.rows.iter_mut().flat_map(|TileRow { tile, ends: [left, right] }| [left, tile, right]);
        for overlap in reaches.filter_map(Reach::overlap_mut) {
            let whole = *overlap / by.get() as usize;
            if whole * by.get() as usize != *overlap {
                let range = format!("a multiple of shrink, which is {by}: reduced tiles share whole texels");
                return Err(Error::parameter("overlap", *overlap, range));
            }
            *overlap = whole;
        }
        Ok(self)
    }

    /// How many texels it shares with the tiles beside it, if there are any.
    pub(super) fn overlap(&self) -> Option<usize> {
        self.sides().into_iter().find_map(|(_, reach)| reach.overlap())
    }
}

impl Reach {
    /// The tile that has them, if it is another one.
    pub fn tile(&self) -> Option<&Path> {
        match self {
            Self::Own => None,
            Self::Beside { tile, .. } | Self::Far(tile) => Some(tile),
        }
    }

    /// How many texels of this side are in both tiles, if they lie beside each other.
    pub fn overlap(&self) -> Option<usize> {
        match self {
            Self::Beside { overlap, .. } => Some(*overlap),
            Self::Own | Self::Far(_) => None,
        }
    }

    fn overlap_mut(&mut self) -> Option<&mut usize> {
        match self {
            Self::Beside { overlap, .. } => Some(overlap),
            Self::Own | Self::Far(_) => None,
        }
    }

    /// The row or column of `count` in which the texels are; those before a tile or behind it.
    pub(super) fn place(&self, is_before: bool, count: usize, edge: Edge) -> usize {
        let overlap = self.overlap().unwrap_or(0);
        match (self.tile(), is_before) {
            (Some(_), true) => count - 1 - overlap,
            (Some(_), false) => overlap,
            (None, true) => edge.resolve(-1, count),
            (None, false) => edge.resolve(count as isize, count),
        }
    }

    /// The row or column of the tile beside it that should be the same as the tile's own first or last one. Of tiles that
    /// share none it is the one that would be the same if they shared one.
    pub(super) fn shared(&self, is_before: bool, count: usize) -> Option<usize> {
        let overlap = self.overlap()?.max(1);
        Some(if is_before { count - overlap } else { overlap - 1 })
    }

    /// Where it meets a tile beside it, of which nothing was seen yet.
    pub(super) fn seam(&self) -> Option<Seam> {
        Some(Seam::new(self.tile()?, self.overlap()?))
    }
}

impl fmt::Display for Reach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // All tiles are in one folder, and are the same wherever it is.
        let name = |tile: &Path| tile.file_name().unwrap_or(tile.as_os_str()).display().to_string();
        match self {
            Self::Own => f.write_str("edge"),
            Self::Beside { tile, overlap } if *overlap > 0 => write!(f, "{} overlapping by {overlap}", name(tile)),
            Self::Beside { tile, .. } | Self::Far(tile) => f.write_str(&name(tile)),
        }
    }
}
