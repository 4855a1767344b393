//! What lies around a tile of a larger map.

use crate::cli::values::{texels, value};
use clap::Args;
use std::path::Path;
use texbake::batch::{Found, Neighbours, TileFolders, TileTemplate};
use texbake::{BakeOptions, Error, Result};

/// What was set of the tiles beside a height map.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct Tiles {
    /// The height map is a tile of a larger map, and has such a name: tiles_{x}_{y}.png, where {x} counts the tiles to
    /// the right and {y} down the rows. Its borders continue in the tiles beside it in its folder, so that no seams are
    /// seen; --edge holds at the border of the whole map, and beside a tile that is missing (a warning names it)
    #[arg(long, value_name = "TEMPLATE", value_parser = value::<TileTemplate>, help_heading = HEADING)]
    pub neighbours: Option<TileTemplate>,

    /// Texels of the files that tiles beside each other share: 1 for tiles of 1025 that cover 1024. Warns if shared
    /// texels differ between two tiles, or if their borders are the same although --overlap is 0 [default: 0]
    #[arg(long, value_name = "TEXELS", value_parser = texels, allow_hyphen_values = true, help_heading = HEADING)]
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
        self.check_effect(self.neighbours.is_some())?;
        self.around_in(&mut TileFolders::default(), input, options)
    }

    /// What lies around a height map that was found, with what is known of folders already. One of a folder with
    /// another name is no tile.
    pub fn around_found(
        &self,
        folders: &mut TileFolders,
        map: &Found,
        options: &BakeOptions,
    ) -> Result<Option<Neighbours>> {
        let is_no_tile = !map.is_named && self.neighbours.as_ref().is_some_and(|template| !template.fits(&map.path));
        if is_no_tile { Ok(None) } else { self.around_in(folders, &map.path, options) }
    }

    fn around_in(&self, folders: &mut TileFolders, input: &Path, options: &BakeOptions) -> Result<Option<Neighbours>> {
        let overlap = self.overlap.unwrap_or(0);
        let template = self.neighbours.as_ref();
        template.map(|template| folders.around(input, template, overlap, options)).transpose()
    }

    /// Fails if something is set and no height map is a tile.
    ///
    /// # Errors
    /// [`Error::Parameter`]
    pub fn check_effect(&self, has_tiles: bool) -> Result<()> {
        let wrong =
            |parameter, value: String, range: &str| Err(Error::Parameter { parameter, value, range: range.into() });
        match (&self.neighbours, self.overlap) {
            _ if has_tiles => Ok(()),
            (Some(template), _) => wrong(
                "neighbours",
                template.to_string(),
                "the name of one height map at least, with numbers for {x} and {y}",
            ),
            (None, Some(overlap)) => wrong("overlap", overlap.to_string(), "left out, or used with --neighbours"),
            (None, None) => Ok(()),
        }
    }
}
