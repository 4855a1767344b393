//! Height maps into all mip levels of their maps, in memory.

use super::Baker;
use crate::backend::RowBytes;
use crate::error::Result;
use crate::map::{CodeMap, CodesRef, HeightMap, MapFormat, Maps, NormalMap, ParallaxMap, RoughnessMap, Size};
use crate::mips::{Bake, LevelsOut, MapSinks};
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
    /// let ridge = HeightMap::from(Grid::from_fn(6, 1, |x, _| [0_u8, 51, 102, 153, 204, 102][x])?);
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
    /// A parallax map of a level is n_z (2h - 1) with the level's own n_z and the mean height of the area. A roughness map
    /// holds the roughness that stands for the slopes that a level has lost ([`RoughnessMethod`](crate::RoughnessMethod)).
    ///
    /// # Errors
    /// As [`Baker::bake`], and [`crate::Error::Parameter`] for a map of more than 2^42 texels.
    pub fn bake_levels(&self, heights: &HeightMap, options: &BakeOptions) -> Result<LevelMaps> {
        let plan = BakePlan::new(options, heights.size(), heights.height_type())?;
        let mut normal = options.normal.map(|format| zeroed(plan.size, format));
        let mut parallax = options.parallax.map(|format| zeroed(plan.size, format));
        let mut roughness = options.roughness.map(|options| zeroed(plan.size, options.format));
        self.run(|backend| {
            let mut maps = Maps {
                normal: normal.as_deref_mut().and_then(sinks),
                parallax: parallax.as_deref_mut().and_then(sinks),
                roughness: roughness.as_deref_mut().and_then(sinks),
            };
            let maps = maps.as_mut().map(|(largest, levels)| MapSinks { largest, levels: levels.take() });
            let mut bands = MapBands::new(heights, plan.edges.y, backend.map_band_rows(RowBytes::of_bake(&plan)));
            Bake { backend, plan: &plan, order: RowOrder::FromTop }.run(&mut bands, maps)
        })?;
        Ok(Maps { normal, parallax, roughness })
    }
}

/// All mip levels of the maps of a bake, the largest first.
pub type LevelMaps = Maps<Vec<NormalMap>, Vec<ParallaxMap>, Vec<RoughnessMap>>;

fn zeroed<F: MapFormat>(size: Size, format: F) -> Vec<CodeMap<F>> {
    size.levels().map(|size| CodeMap::zeroed(size, format)).collect()
}

/// Room for the largest level of a map, and for the others.
fn sinks<F: MapFormat + Send>(levels: &mut [CodeMap<F>]) -> Option<(MapSink<'_>, LevelsOut<'_>)> {
    let (largest, smaller) = levels.split_first_mut()?;
    let row_codes = largest.texel_format().row_codes(largest.size().width());
    Some((MapSink::new(largest.codes_mut(), row_codes), Some(Box::new(MemoryLevels(smaller)))))
}

/// The levels of a map in memory, from level 1 on.
struct MemoryLevels<'a, F>(&'a mut [CodeMap<F>]);

impl<F: MapFormat + Send> LevelSink for MemoryLevels<'_, F> {
    fn write(&mut self, level: usize, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let level = &mut self.0[level - 1];
        let row_codes = level.codes().len() / level.size().height();
        let first = first * row_codes;
        level.codes_mut().slice(first..first + rows.len()).bytes_mut().copy_from_slice(rows.bytes());
        Ok(())
    }
}
