//! Tiles of a larger map, each baked with the texels around it.

use super::Job;
use super::job::Run;
use super::neighbours::Neighbours;
use crate::baker::Baked;
use crate::error::Result;
use crate::io::{Cropped, SeamWarnings};
use crate::map::{Edge, Edges, Maps, Size};
use crate::ops::bake::BakeOptions;
use crate::stream::{HeightRows, MapOut, RowsOut};
use std::sync::PoisonError;

impl Job {
    /// Bakes a tile with its halo, and writes the tile.
    pub(super) fn bake_tile(
        &self,
        neighbours: &Neighbours,
        open: &dyn Fn() -> Result<HeightRows>,
        options: &BakeOptions,
        run: &mut Run<'_>,
    ) -> Result<Baked> {
        let Run { create, monitor, warnings, .. } = run;
        neighbours.check(&self.read, options, &self.write)?;
        let size = {
            // As every file is opened: what its header takes is held by one that waits for memory.
            let _turn = monitor.turn();
            open()?.size()
        };
        let whole = Size::new(size.width() + 2, size.height() + 2)?;
        let options =
            BakeOptions { scale: options.scale.over(size, whole)?, edges: Edges::both(Edge::Clamp), ..*options };
        let told = SeamWarnings::default();
        let open = || Ok(Box::new(neighbours.around(&self.input, open()?, &self.read, monitor, &told)?) as HeightRows);
        let cropped = |(map, format): (MapOut, _)| (Box::new(Cropped::new(map.rows, size, format)) as RowsOut).into();
        let create_cropped = |_| {
            let Maps { normal, parallax, .. } = create(size)?;
            let normal = normal.zip(options.normal.map(|format| format.texel())).map(cropped);
            let parallax = parallax.zip(options.parallax.map(|format| format.texel())).map(cropped);
            Ok(Maps { normal, parallax, roughness: None })
        };
        let baked = self.baker.bake_rows(&open, &create_cropped, &options, monitor)?;
        warnings.append(&mut told.lock().unwrap_or_else(PoisonError::into_inner));
        Ok(Baked { size, ..baked })
    }
}
