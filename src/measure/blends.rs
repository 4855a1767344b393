//! Blends of two normal maps against the normals of the heights' sum.

use super::maps::{per_texel, poisoned, timed};
use super::normals::{errors_of, normal_of};
use super::steps::Steps;
use super::{Errors, TrueNormals};
use crate::baker::Baker;
use crate::error::Result;
use crate::exact::Rational;
use crate::map::{Convention, Depth, Encoding, HeightMap, NormalFormat};
use crate::material::Texture;
use crate::ops::bake::{BakeOptions, NormalOptions};
use crate::ops::blend::{BlendInputs, BlendMethod, BlendOptions};
use serde::Serialize;

/// A blend of two normal maps into one of the same format, exact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlendFigure {
    /// What blended.
    pub device: String,
    /// The formula, by its name on the command line; `add` is `partial-derivative` too, and `weighted` has the weights
    /// 1/2 and 1/2 of the middle of a transition.
    pub method: &'static str,
    /// How components become codes, of both maps and of the result.
    pub encoding: String,
    /// How codes are stored.
    pub bits: String,
    /// Angles to the normals of the sum of the height maps, in double precision.
    pub error_degrees: Errors,
    /// Time from memory to memory, for each texel: the median.
    pub nanoseconds_per_texel: f64,
    /// Size of a texel of each map.
    pub bytes_per_texel: usize,
}

/// The heights of a blend, each with its scale and edges.
pub(super) struct Layers<'a> {
    pub base: (&'a HeightMap, BakeOptions),
    pub detail: (&'a HeightMap, BakeOptions),
}

/// The formulas, with the weights of the heights that they stand for.
pub(super) fn methods() -> [(&'static str, BlendMethod, [f64; 2]); 7] {
    let half = Rational::new(1, 2).unwrap_or(Rational::from(1));
    let sum = [1.0, 1.0];
    [
        ("add", BlendMethod::add(), sum),
        ("weighted", BlendMethod::Weighted { base: half, detail: half }, [0.5, 0.5]),
        ("linear", BlendMethod::Linear, sum),
        ("overlay", BlendMethod::Overlay, sum),
        ("udn", BlendMethod::Udn, sum),
        ("whiteout", BlendMethod::Whiteout, sum),
        ("rnm", BlendMethod::Rnm, sum),
    ]
}

/// The formats of blended maps: what is usual, and one whose quantisation is not seen beside a formula's error.
pub(super) const FORMATS: [(Encoding, Depth); 2] = [(Encoding::Unorm, Depth::Bits8), (Encoding::Float, Depth::Float32)];

/// Every formula in every format on a device. A detail map of another size is repeated over the base, or cut.
pub(super) fn blend_figures(
    device: &Baker,
    layers: &Layers<'_>,
    convention: Convention,
    runs: usize,
    steps: &mut Steps<'_>,
) -> Result<Vec<BlendFigure>> {
    let [base, detail] = [&layers.base, &layers.detail];
    let truths = [TrueNormals::new(base.0, &base.1)?, TrueNormals::new(detail.0, &detail.1)?];
    let repeated = detail.0.size();
    let mut figures = Vec::new();
    for (encoding, depth) in FORMATS {
        let format = NormalFormat { encoding, depth, convention, ..NormalFormat::default() };
        let bake = |(heights, options): &(&HeightMap, BakeOptions)| {
            let BakeOptions { scale, filter, edges, precision, .. } = *options;
            device.normal(heights, &NormalOptions { scale, filter, edges, format, precision })
        };
        let maps = [bake(base)?, bake(detail)?];
        let inputs = BlendInputs { base: &maps[0], detail: &maps[1], mask: None };
        for (name, method, weights) in methods() {
            steps.next(&format!("blend, {name}, {encoding} {depth}"))?;
            let options = BlendOptions { method, tile: true, format, ..BlendOptions::default() };
            let mut map = poisoned(base.0.size(), format);
            let time = timed(runs, || device.blend_into(&inputs, &options, map.codes_mut()))?;
            let truth = |x: usize, y: usize| {
                let [a, b] = [truths[0].slope(x, y), truths[1].slope(x % repeated.width(), y % repeated.height())];
                normal_of([0, 1].map(|axis| weights[0] * a[axis] + weights[1] * b[axis]))
            };
            figures.push(BlendFigure {
                device: device.name(),
                method: name,
                encoding: encoding.to_string(),
                bits: depth.to_string(),
                error_degrees: errors_of(&Texture::of_normals(&map, base.1.edges), truth),
                nanoseconds_per_texel: per_texel(time, base.0.size()),
                bytes_per_texel: format.texel().channels * depth.bytes(),
            });
        }
    }
    Ok(figures)
}
