//! The specification as a backend: one thread, one texel after the other.

use crate::backend::Backend;
use crate::error::Result;
use crate::ops::normal::{NormalPlan, codes_of_band};
use crate::stream::{CodeSink, HeightBands};

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

    fn band_rows(&self, _: &NormalPlan) -> usize {
        64
    }

    fn normal(&self, plan: &NormalPlan, bands: &mut dyn HeightBands, sink: &mut dyn CodeSink) -> Result<()> {
        while let Some(band) = bands.next()? {
            sink.write(band.rows(), &mut |codes| {
                codes_of_band(plan, &band, codes);
                Ok(())
            })?;
        }
        Ok(())
    }
}
