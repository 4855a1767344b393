//! Heights and the normals of another map into parallax maps.

use super::memory::job_bytes;
use super::write::{WatchedRows, finish, whole_sink};
use super::{Baker, Ran, check_same_size};
use crate::backend::RowBytes;
use crate::error::Result;
use crate::map::{HeightMap, NormalMap, ParallaxFormat, ParallaxMap, Size};
use crate::ops::Precision;
use crate::ops::parallax::ParallaxPlan;
use crate::stream::{
    CodeWriter, HeightLayer, HeightRows, LayerReader, LayerSource, MapLayers, Monitor, NormalLayer, NormalRows,
    RowOrder, RowsOut, check_components, height_codes,
};

impl Baker {
    /// Bakes a parallax map from heights and the normals of a map that is there already.
    ///
    /// # Errors
    /// As [`Baker::normal`]; [`crate::Error::Parameter`] if the maps differ in size; [`crate::Error::NoDirection`] for
    /// a float normal that is none.
    pub fn parallax_with_normals(
        &self,
        heights: &HeightMap,
        normals: &NormalMap,
        format: ParallaxFormat,
        precision: Precision,
    ) -> Result<ParallaxMap> {
        let plan = ParallaxPlan::new(heights.size(), heights.height_type(), normals.format(), format, precision)?;
        check_same_size("size of the normal map", normals.size(), plan.size)?;
        check_components(normals.codes(), normals.format(), plan.size.width(), 0)?;
        let mut map = ParallaxMap::zeroed(plan.size, format);
        self.run(|backend| {
            let band_rows = backend.map_band_rows(RowBytes::of_parallax(&plan));
            let layers = vec![height_codes(heights.heights()), normals.codes()];
            let mut bands = MapLayers::new(layers, plan.size.height(), band_rows);
            backend.parallax(&plan, &mut bands, &mut whole_sink(&mut map.codes_mut(), format.texel(), plan.size))?;
            Ok(())
        })?;
        Ok(map)
    }

    /// The same from rows to rows, in memory that does not grow with the maps.
    ///
    /// # Errors
    /// As [`Baker::bake_rows`] and [`Baker::parallax_with_normals`].
    pub fn parallax_with_normals_rows(
        &self,
        open: &dyn Fn() -> Result<(HeightRows, NormalRows)>,
        create: &dyn Fn(Size) -> Result<RowsOut>,
        format: ParallaxFormat,
        precision: Precision,
        monitor: &Monitor,
    ) -> Result<(Ran, Size)> {
        self.run(|backend| {
            let turn = monitor.turn();
            let (heights, normals) = open()?;
            let plan = ParallaxPlan::new(heights.size(), heights.height_type(), normals.format(), format, precision)?;
            check_same_size("size of the normal map", normals.size(), plan.size)?;
            let sink = create(plan.size)?;
            let row = RowBytes::of_parallax(&plan);
            let passing = job_bytes(backend, row, plan.size.height(), [&sink]);
            let _memory = turn.take(heights.held_bytes() + normals.held_bytes() + passing, monitor)?;
            let band_rows = backend.band_rows(row);
            let layers: Vec<Box<dyn LayerSource>> =
                vec![Box::new(HeightLayer::new(heights)), Box::new(NormalLayer::new(normals))];
            let writer = CodeWriter::new(sink, plan.size, format.texel(), RowOrder::FromTop)?;
            let mut rows = WatchedRows::new(writer, plan.size.width(), monitor);
            backend.parallax(&plan, &mut LayerReader::new(layers, plan.size.height(), band_rows)?, &mut rows)?;
            finish([rows])?;
            Ok(plan.size)
        })
    }
}
