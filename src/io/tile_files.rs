//! The files of a tile and of the tiles around it.

use super::input::Watch;
use super::{ReadOptions, open_heights};
use crate::error::{Error, Result};
use crate::map::{HeightType, Size};
use crate::stream::HeightRows;
use std::path::{Path, PathBuf};

/// The file of a tile, and those of the tiles around it, which have its size and type.
pub(super) struct TileFiles {
    own: PathBuf,
    size: Size,
    height_type: HeightType,
    read: ReadOptions,
    /// All of them, as they were found.
    found: Vec<Watch>,
}

impl TileFiles {
    /// Those of the tile `own`, which has these rows, and of those around it, which are read by the same options.
    ///
    /// # Errors
    /// As [`TileFiles::open`] for each of them.
    pub fn new(own: &Path, rows: &HeightRows, around: &[&Path], read: &ReadOptions) -> Result<Self> {
        let found = around.iter().copied().chain([own]).map(Watch::at).collect::<Result<_>>()?;
        let (size, height_type) = (rows.size(), rows.height_type());
        let files = Self { own: own.into(), size, height_type, read: read.clone(), found };
        around.iter().try_for_each(|tile| files.open(tile).map(drop))?;
        Ok(files)
    }

    /// The tile in the middle.
    pub fn own(&self) -> &Path {
        &self.own
    }

    /// The rows of one of them, from the first.
    ///
    /// # Errors
    /// As [`open_heights`]; [`Error::File`] if it has another size or type.
    pub fn open(&self, tile: &Path) -> Result<HeightRows> {
        let rows = open_heights(tile, &self.read)?.rows;
        let (size, height_type) = (rows.size(), rows.height_type());
        if (size, height_type) == (self.size, self.height_type) {
            return Ok(rows);
        }
        let Self { own, size: own_size, height_type: own_type, .. } = self;
        let name = own.display();
        let reason = format!("it is {size} of {height_type}, and its neighbour {name} is {own_size} of {own_type}");
        Err(Error::file(
            tile,
            reason,
            "tiles of one map have the same size and type: export them again, or pad smaller ones",
        ))
    }

    /// Fails if one of them changed or went.
    pub fn check(&self) -> Result<()> {
        self.found.iter().try_for_each(Watch::check)
    }

    /// A result of reading them: if one changed or went, that is the reason of any error but an interrupt.
    pub fn explain<T>(&self, result: Result<T>) -> Result<T> {
        match result {
            Ok(_) | Err(Error::Cancelled) => result,
            Err(error) => self.check().and(Err(error)),
        }
    }
}
