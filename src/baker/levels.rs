//! Height maps into all mip levels of their maps, in memory.

use super::Baker;
use super::write::{as_dyn, whole_sink};
use crate::backend::RowBytes;
use crate::error::Result;
use crate::map::{CodeMap, CodesRef, HeightMap, MapFormat, Maps, NormalMap, ParallaxMap, Size};
use crate::mips::bake_with_levels;
use crate::ops::bake::{BakeOptions, BakePlan, NormalOptions};
use crate::stream::{LevelSink, MapBands, MapSink, RowOrder};

impl Baker {
    /// Bakes a height map into all mip levels of its normal map, from the largest to that of one texel.
    ///
    /// Level k has max(1, floor(w / 2^k)) x max(1, floor(h / 2^k)) texels. A texel of it is a rectangle of level 0, which
    /// may cut texels; its normal is that of the mean slope over this area. Slopes are averaged and not normals, since the
    /// mean slope is what a surface without the details has. For integer heights every code is the nearest to what this
    /// gives in real arithmetic, for floats the mean slope in f64 is rounded to f32 and the rest is as in level 0. The
    /// levels below the largest are exact in [`Precision::Fast`](crate::Precision::Fast) too.
    ///
    /// ```
    /// use texbake::{Baker, CodesRef, Edge, Edges, Grid, HeightMap, NormalOptions, Scale};
    ///
    /// // One side of a ridge is twice as steep as the other, and half as long.
    /// let ridge = HeightMap::from(Grid::from_fn(6, 1, |x, _| [0, 51, 102, 153, 204, 102][x])?);
    /// let options = NormalOptions { scale: Scale::texels(5), ..Default::default() };
    /// let levels = Baker::cpu().normal_levels(&ridge, &options)?;
    /// let sizes: Vec<String> = levels.iter().map(|level| level.size().to_string()).collect();
    /// assert_eq!(sizes, ["6 x 1", "3 x 1", "1 x 1"]);
    /// // It tiles, so it rises as much as it falls, and the mean slope is none.
    /// assert_eq!(levels[2].codes(), CodesRef::U8(&[128, 128, 255]));
    /// # Ok::<(), texbake::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Baker::normal`], and [`crate::Error::Parameter`] for a map of more than 2^42 texels.
    pub fn normal_levels(&self, heights: &HeightMap, options: &NormalOptions) -> Result<Vec<NormalMap>> {
        Ok(self.bake_levels(heights, &(*options).into())?.normal.unwrap_or_default())
    }

    /// Bakes a height map into all mip levels of the maps that the options ask for, from the largest to that of one texel:
    /// as [`Baker::normal_levels`].
    ///
    /// A parallax map of a level is n_z (2h - 1) with the level's own n_z and the mean height of the area.
    ///
    /// # Errors
    /// As [`Baker::bake`], and [`crate::Error::Parameter`] for a map of more than 2^42 texels.
    pub fn bake_levels(
        &self,
        heights: &HeightMap,
        options: &BakeOptions,
    ) -> Result<Maps<Vec<NormalMap>, Vec<ParallaxMap>>> {
        let plan = BakePlan::new(options, heights.size(), heights.height_type())?;
        let mut normal = options.normal.map(|format| zeroed(plan.size, format));
        let mut parallax = options.parallax.map(|format| zeroed(plan.size, format));
        self.run(|backend| {
            let (largest_normal, normal_levels) = largest(&mut normal);
            let (largest_parallax, parallax_levels) = largest(&mut parallax);
            let mut largest = [largest_normal.map(CodeMap::codes_mut), largest_parallax.map(CodeMap::codes_mut)];
            let whole = largest.iter_mut().flatten().zip(plan.outputs());
            let mut sinks: Vec<MapSink<'_>> =
                whole.map(|(codes, format)| whole_sink(codes, format, plan.size)).collect();
            let levels = [normal_levels.map(MemoryLevels::boxed), parallax_levels.map(MemoryLevels::boxed)];
            let levels = levels.into_iter().filter(Option::is_some).collect();
            let band_rows = backend.map_band_rows(RowBytes::of_bake(&plan));
            let mut bands = MapBands::new(heights, plan.edges.y, band_rows);
            bake_with_levels(backend, &plan, RowOrder::FromTop, &mut bands, &mut as_dyn(&mut sinks), levels)
        })?;
        Ok(Maps { normal, parallax })
    }
}

fn zeroed<F: MapFormat>(size: Size, format: F) -> Vec<CodeMap<F>> {
    size.levels().map(|size| CodeMap::zeroed(size, format)).collect()
}

/// The largest level of a map and the others, if there is the map.
fn largest<F>(levels: &mut Option<Vec<CodeMap<F>>>) -> (Option<&mut CodeMap<F>>, Option<&mut [CodeMap<F>]>) {
    levels.as_mut().and_then(|levels| levels.split_first_mut()).unzip()
}

/// The levels of a map in memory, from level 1 on.
struct MemoryLevels<'a, F>(&'a mut [CodeMap<F>]);

impl<'a, F: MapFormat + Send> MemoryLevels<'a, F> {
    fn boxed(levels: &'a mut [CodeMap<F>]) -> Box<dyn LevelSink + 'a> {
        Box::new(Self(levels))
    }
}

impl<F: MapFormat + Send> LevelSink for MemoryLevels<'_, F> {
    fn write(&mut self, level: usize, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let level = &mut self.0[level - 1];
        let row_codes = level.codes().len() / level.size().height();
        let first = first * row_codes;
        level.codes_mut().slice(first..first + rows.len()).bytes_mut().copy_from_slice(rows.bytes());
        Ok(())
    }
}
