//! The specification as a backend: one thread, one texel after the other.

use crate::backend::{Backend, RowBytes, fill_rows};
use crate::error::Result;
use crate::ops::bake::{self, BakePlan};
use crate::ops::blend::{self, BlendPlan};
use crate::ops::parallax::{self, ParallaxPlan};
use crate::ops::tangents::{self, TangentPlan};
use crate::stream::{CodeSink, HeightBands, LayerBands};

/// Plain scalar code. Slow, and right by reading.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Reference;

impl Backend for Reference {
    fn kind(&self) -> &'static str {
        "cpu"
    }

    fn device(&self) -> String {
        "reference, 1 thread".into()
    }

    fn band_rows(&self, _: RowBytes) -> usize {
        64
    }

    fn bake(&self, plan: &BakePlan, bands: &mut dyn HeightBands, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        while let Some(band) = bands.next()? {
            fill_rows(sinks, band.rows(), |maps| bake::codes_of_band(plan, &band, maps))?;
        }
        Ok(())
    }

    fn blend(&self, plan: &BlendPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        while let Some(band) = bands.next()? {
            fill_rows(&mut [&mut *sink], band.rows, |maps| blend::codes_of_layers(plan, &band.layers, &mut maps[0]))?;
        }
        Ok(())
    }

    fn parallax(&self, plan: &ParallaxPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        while let Some(band) = bands.next()? {
            fill_rows(&mut [&mut *sink], band.rows, |maps| {
                parallax::codes_of_layers(plan, &band.layers, &mut maps[0])
            })?;
        }
        Ok(())
    }

    fn tangents(&self, plan: &TangentPlan<'_>, out: &mut [[f32; 4]]) -> Result<()> {
        tangents::tangents_of_fans(plan, out);
        Ok(())
    }
}
