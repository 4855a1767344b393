//! Two normal maps into one.

use super::memory::job_bytes;
use super::write::{WatchedRows, finish, whole_sink};
use super::{Baker, Ran, check_same_size};
use crate::backend::RowBytes;
use crate::error::{Error, Result};
use crate::exact::Weights;
use crate::map::{Codes, CodesMut, HeightMap, NormalMap, Size};
use crate::ops::blend::{BlendInputs, BlendOptions, BlendPlan};
use crate::stream::{
    CodeWriter, HeightRows, LayerReader, LayerSource, MapLayers, MaskLayer, Monitor, NormalLayer, NormalRows, RowOrder,
    RowsOut, Tiled, check_components, height_codes, read_normals, read_normals_watched, rounded_mask,
};

/// How a blend ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Blended {
    /// Where it ran.
    pub ran: Ran,
    /// Size of the maps.
    pub size: Size,
    /// The weights that were used, and whether they are those that were asked for; `None` for methods without weights.
    pub weights: Option<Weights>,
}

impl Baker {
    /// Blends two normal maps.
    ///
    /// A z at or below zero counts as the least above zero that the encoding has, so that every texel has a slope; a
    /// sum of vectors that is zero becomes (0, 0, 1).
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if an option is out of range, the sizes differ without [`BlendOptions::tile`], or
    /// a mask is missing or not wanted; [`crate::Error::NoDirection`] for a float normal that is none;
    /// [`crate::Error::Device`] if a GPU without a fallback fails.
    pub fn blend(&self, inputs: &BlendInputs<&NormalMap, &HeightMap>, options: &BlendOptions) -> Result<NormalMap> {
        let mut map = NormalMap::zeroed(inputs.base.size(), options.format);
        self.blend_into(inputs, options, map.codes_mut())?;
        Ok(map)
    }

    /// Blends two normal maps into the caller's memory: codes texel by texel, in rows from the top. Tells how it ran.
    ///
    /// # Errors
    /// As [`Baker::blend`], and [`crate::Error::Parameter`] if `codes` is not of the format's depth and the base's
    /// size.
    pub fn blend_into(
        &self,
        inputs: &BlendInputs<&NormalMap, &HeightMap>,
        options: &BlendOptions,
        mut codes: CodesMut<'_>,
    ) -> Result<Blended> {
        let BlendInputs { base, detail, mask } = *inputs;
        let size = base.size();
        let plan = BlendPlan::new(options, size, [base.format(), detail.format()], mask.map(HeightMap::height_type))?;
        plan.format.texel().check_codes(size, codes.len(), codes.depth())?;
        check_layer_sizes(size, detail.size(), mask.map(HeightMap::size), options)?;
        let tiled = if detail.size() == size { None } else { Some(tiled(detail, size)?) };
        let detail = tiled.as_ref().unwrap_or(detail);
        for map in [base, detail] {
            check_components(map.codes(), map.format(), size.width(), 0)?;
        }
        let rounded = mask.and_then(rounded_mask);
        let mut layers = vec![base.codes(), detail.codes()];
        layers.extend(mask.map(|mask| rounded.as_ref().map_or_else(|| height_codes(mask.heights()), Codes::as_ref)));
        let (ran, ()) = self.run(|backend| {
            let band_rows = backend.map_band_rows(RowBytes::of_blend(&plan));
            let mut bands = MapLayers::new(layers.clone(), size.height(), band_rows);
            backend.blend(&plan, &mut bands, &mut whole_sink(&mut codes, plan.format.texel(), size))?;
            Ok(())
        })?;
        Ok(Blended { ran, size, weights: plan.used_weights() })
    }

    /// Blends rows from `open` into rows for `create` while they are read and written; a map that tiles is held.
    ///
    /// # Errors
    /// As [`Baker::blend`]; what opening, reading, creating and writing report; [`crate::Error::Cancelled`].
    pub fn blend_rows(
        &self,
        open: &dyn Fn() -> Result<BlendInputs<NormalRows, HeightRows>>,
        create: &dyn Fn(Size) -> Result<RowsOut>,
        options: &BlendOptions,
        monitor: &Monitor,
    ) -> Result<Blended> {
        let (ran, (size, weights)) = self.run(|backend| {
            let turn = monitor.turn();
            let BlendInputs { base, mut detail, mask } = open()?;
            let size = base.size();
            let mask_type = mask.as_ref().map(|mask| mask.height_type());
            let plan = BlendPlan::new(options, size, [base.format(), detail.format()], mask_type)?;
            check_layer_sizes(size, detail.size(), mask.as_ref().map(|mask| mask.size()), options)?;
            let sink = create(size)?;
            let tiles = detail.size() != size;
            let held_tile = if tiles { detail.size().texels() * detail.format().texel().bytes() } else { 0 };
            let held_by_sources =
                base.held_bytes() + detail.held_bytes() + mask.as_ref().map_or(0, |mask| mask.held_bytes());
            let passing = job_bytes(backend, RowBytes::of_blend(&plan), size.height(), [&sink]);
            let _memory = turn.take(held_by_sources + held_tile as u64 + passing, monitor)?;
            if tiles {
                detail = Box::new(Tiled::new(read_normals_watched(detail.as_mut(), monitor)?, size));
            }
            let mut layers: Vec<Box<dyn LayerSource>> =
                vec![Box::new(NormalLayer::new(base)), Box::new(NormalLayer::new(detail))];
            if let Some(mask) = mask {
                layers.push(Box::new(MaskLayer::new(mask)));
            }
            let band_rows = backend.band_rows(RowBytes::of_blend(&plan));
            let writer = CodeWriter::new(sink, size, plan.format.texel(), RowOrder::FromTop)?;
            let mut rows = WatchedRows::new(writer, size.width(), monitor);
            backend.blend(&plan, &mut LayerReader::new(layers, size.height(), band_rows)?, &mut rows)?;
            finish([rows])?;
            Ok((size, plan.used_weights()))
        })?;
        Ok(Blended { ran, size, weights })
    }
}

/// A normal map repeated, or cut, to `size`.
fn tiled(map: &NormalMap, size: Size) -> Result<NormalMap> {
    read_normals(&mut Tiled::new(map, size))
}

fn check_layer_sizes(base: Size, detail: Size, mask: Option<Size>, options: &BlendOptions) -> Result<()> {
    if detail != base && !options.tile {
        let range = format!("{base}, as the first map's; to repeat a smaller one over the first, tile it (--tile)");
        return Err(Error::parameter("size of the second map", detail, range));
    }
    mask.map_or(Ok(()), |mask| check_same_size("size of the mask", mask, base))
}
