//! One constant changed in each kernel: a proof that cannot fail proves nothing.

use crate::backend::cpu::Cpu;
use crate::backend::{Backend, RowBytes};
use crate::error::Result;
use crate::ops::bake::{BakePlan, FloatSlope, IntegerSlope, Slope};
use crate::ops::blend::BlendPlan;
use crate::ops::parallax::ParallaxPlan;
use crate::ops::tangents::TangentPlan;
use crate::stream::{CodeSink, HeightBands, LayerBands};

/// Constants of the kernels' text, and what stands there instead.
#[cfg(feature = "gpu")]
const CHANGES: [(&str, &str); 7] = [
    // Estimated codes of 8 bits are one higher.
    ("* 0.5 + 128.0)", "* 0.5 + 129.0)"),
    // Estimated floats are a place higher.
    ("floor(missing + 0.5)", "floor(missing + 1.5)"),
    // The middle between two codes lies one code higher.
    ("2 * below + 1 -", "2 * below + 3 -"),
    // The search for a float's bits begins too late.
    ("var step = 64u", "var step = 16u"),
    // Components below 2^-4 count as zero, instead of those below 2^-100.
    ("SMALLEST_COMPONENT: u32 = 0x0d800000u", "SMALLEST_COMPONENT: u32 = 0x3d800000u"),
    // Native codes are two higher.
    (
        "(f32(output.code_c) + 1.0) * 0.5;\n    return vec4<u32>(vec4<i32>(floor(",
        "(f32(output.code_c) + 5.0) * 0.5;\n    return vec4<u32>(vec4<i32>(floor(",
    ),
    // Products of vectors are one greater.
    ("MINUS_ZERO: u32 = SIGN", "MINUS_ZERO: u32 = 0x3f800000u"),
];

/// A kernel's text with its constant changed.
#[cfg(feature = "gpu")]
pub(crate) fn changed(text: &str) -> String {
    CHANGES.iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// The vectorised CPU with a constant of each plan changed.
pub(super) struct Changed(pub Cpu);

impl Backend for Changed {
    fn kind(&self) -> &'static str {
        self.0.kind()
    }

    fn device(&self) -> String {
        self.0.device()
    }

    fn band_rows(&self, row: RowBytes) -> usize {
        self.0.band_rows(row)
    }

    fn bake(&self, plan: &BakePlan, bands: &mut dyn HeightBands, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        let slope = match plan.slope {
            Slope::Integer(slope) => Slope::Integer(IntegerSlope { px: -slope.px - 1, ..slope }),
            Slope::Float(slope) => Slope::Float(FloatSlope { kx: -0.5 * slope.kx, ..slope }),
        };
        self.0.bake(&BakePlan { slope, ..*plan }, bands, sinks)
    }

    fn blend(&self, plan: &BlendPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        let mut layers = plan.layers;
        layers[1].green = -layers[1].green;
        self.0.blend(&BlendPlan { layers, ..*plan }, bands, sink)
    }

    fn parallax(&self, plan: &ParallaxPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        let mut normals = plan.normals;
        if let Some(codes) = &mut normals.codes {
            codes.centre += codes.greatest / 2;
        }
        self.0.parallax(&ParallaxPlan { normals, ..*plan }, bands, sink)
    }

    fn tangents(&self, plan: &TangentPlan<'_>, tangents: &mut [[f32; 4]]) -> Result<()> {
        self.0.tangents(plan, tangents)?;
        // The kernels' one constant is the handedness of w.
        tangents.iter_mut().for_each(|tangent| tangent[3] = -tangent[3]);
        Ok(())
    }
}

#[cfg(all(test, feature = "gpu"))]
mod tests {
    use super::changed;
    use crate::backend::gpu::sources;

    #[test]
    fn every_kernel_is_changed() {
        for source in sources() {
            assert_ne!(changed(&source.text()), source.text(), "{}", source.name);
        }
    }
}
