//! What lies around a tile of a larger map.

use crate::cli::values::value;
use clap::Args;
use std::path::Path;
use texbake::batch::{Neighbours, TileFolders, TileTemplate};
use texbake::{BakeOptions, Error, Result};

/// What was set of the tiles beside a height map.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct Tiles {
    /// The height map is a tile of a larger map, and has such a name: tiles_{x}_{y}.png, where {x} counts the tiles to
    /// the right and {y} down the rows. Its borders continue in the tiles beside it in its folder, so that no seams are
    /// seen; --edge is for the borders of the whole map
    #[arg(long, value_name = "TEMPLATE", value_parser = value::<TileTemplate>, help_heading = HEADING)]
    pub neighbours: Option<TileTemplate>,

    /// Texels that tiles beside each other share: 1 for tiles of 1025 that cover 1024 [default: 0]
    #[arg(long, value_name = "TEXELS", help_heading = HEADING)]
    pub overlap: Option<usize>,
}

const HEADING: &str = "Tiles";

impl Tiles {
    /// These settings, and those of `weaker` where these say nothing.
    pub fn or(self, weaker: &Self) -> Self {
        Self {
            neighbours: self.neighbours.or_else(|| weaker.neighbours.clone()),
            overlap: self.overlap.or(weaker.overlap),
        }
    }

    /// What lies around the height map `input`, if it is a tile.
    ///
    /// # Errors
    /// As [`TileFolders::around`]; [`Error::Parameter`] for an overlap of no tiles.
    pub fn around(&self, input: &Path, options: &BakeOptions) -> Result<Option<Neighbours>> {
        self.around_in(&mut TileFolders::default(), input, options)
    }

    /// The same, with what is known of folders already.
    pub fn around_in(
        &self,
        folders: &mut TileFolders,
        input: &Path,
        options: &BakeOptions,
    ) -> Result<Option<Neighbours>> {
        let overlap = self.overlap.unwrap_or(0);
        match (&self.neighbours, overlap) {
            (Some(template), overlap) => folders.around(input, template, overlap, options).map(Some),
            (None, 0) => Ok(None),
            (None, overlap) => {
                let range = "left out, or used with --neighbours".into();
                Err(Error::Parameter { parameter: "overlap", value: overlap.to_string(), range })
            }
        }
    }
}
