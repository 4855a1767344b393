//! Which normal map.

use super::decision::{Decision, Rejected, bytes_per_texel, degrees};
use super::subject::{Reduced, Subject};
use super::unmet::Unmet;
use crate::baker::Baker;
use crate::error::Result;
use crate::io::check_normal_format;
use crate::map::{Channels, Convention, Depth, Encoding, NormalFormat, NormalMap};
use crate::material::Texture;
use crate::measure::{Errors, digits};
use crate::ops::Precision;
use crate::ops::bake::BakeOptions;
use std::path::Path;

/// A normal map that keeps within its tolerance, or none.
#[derive(Debug, Clone)]
pub(super) struct NormalChoice {
    pub format: Option<NormalFormat>,
    /// The largest error in degrees.
    pub error: f64,
    /// Bytes of the map over texels of the whole height map.
    pub bytes: f64,
    pub decision: Decision,
}

/// The formats that files of this extension hold, cheapest first; of those that cost the same, what engines expect.
pub(super) fn formats(extension: &str, convention: Convention) -> Vec<NormalFormat> {
    let file = Path::new("map").with_extension(extension);
    let encodings = [Encoding::Unorm, Encoding::Biased, Encoding::Snorm, Encoding::Float];
    let depths = [Depth::Bits8, Depth::Bits16, Depth::Float16, Depth::Float32];
    let mut formats: Vec<NormalFormat> = encodings
        .into_iter()
        .flat_map(|encoding| depths.map(|depth| (encoding, depth)))
        .flat_map(|codes| [Channels::Xy, Channels::Xyz].map(|channels| (codes, channels)))
        .map(|((encoding, depth), channels)| NormalFormat { encoding, depth, channels, convention })
        .filter(|format| check_normal_format(&file, *format).is_ok())
        .collect();
    formats.sort_by_key(|format| format.texel().bytes());
    formats
}

/// The cheapest normal map of a resolution that keeps within the tolerance.
pub(super) fn choose(subject: &Subject<'_>, reduced: &Reduced<'_>) -> Result<Result<NormalChoice, Unmet>> {
    let tolerance = subject.tolerance().normal;
    let flat = reduced.visible.leanings().largest;
    if flat <= tolerance {
        let reason = format!("no normal leans by more than {}, of {} allowed", degrees(flat), digits(tolerance));
        let decision = Decision::new("normal map", "none", reason);
        return Ok(Ok(NormalChoice { format: None, error: flat, bytes: 0.0, decision }));
    }
    let mut rejected = vec![Rejected::new("none", format!("normals lean by up to {}", degrees(flat)))];
    let mut best: Option<(f64, NormalFormat)> = None;
    for format in formats(&subject.material.format, subject.facts().convention) {
        subject.monitor.check()?;
        let Errors { largest, percentile_99, mean } = measure(subject.baker, reduced, format, Precision::Exact)?;
        if largest <= tolerance {
            let in_file = match (subject.material.format.as_str(), format.channels) {
                ("png", Channels::Xy) => "; the PNG has a third channel of zeros, which a texture need not have",
                _ => "",
            };
            let reason = format!(
                "off by {} at most, of {} allowed; by {} in 99 of 100 texels, {} in the mean{in_file}",
                degrees(largest),
                digits(tolerance),
                digits(percentile_99),
                digits(mean),
            );
            let decision = Decision::new("normal map", describe(format), reason).without(rejected);
            let bytes = format.texel().bytes() as f64 * reduced.share();
            return Ok(Ok(NormalChoice { format: Some(format), error: largest, bytes, decision }));
        }
        rejected.push(Rejected::new(describe(format), format!("off by up to {}", degrees(largest))));
        if best.is_none_or(|(least, _)| largest < least) {
            best = Some((largest, format));
        }
    }
    let (least, format) = best.unwrap_or((flat, NormalFormat::default()));
    let file = &subject.material.format;
    let finer = (file != "exr").then(|| "write floats, as format = \"exr\"".to_owned());
    Ok(Err(Unmet::normal(tolerance, least, format!("{} in {file}", describe(format)), finer)))
}

/// The errors of a normal map in degrees.
pub(super) fn measure(
    baker: &Baker,
    reduced: &Reduced<'_>,
    format: NormalFormat,
    precision: Precision,
) -> Result<Errors> {
    Ok(reduced.visible.errors(&texture(&bake(baker, reduced, format, precision)?, reduced)))
}

/// A normal map of the reduced heights.
pub(super) fn bake(
    baker: &Baker,
    reduced: &Reduced<'_>,
    format: NormalFormat,
    precision: Precision,
) -> Result<NormalMap> {
    let options = BakeOptions { normal: Some(format), precision, ..reduced.options };
    let maps = baker.bake(&reduced.heights, &options)?;
    Ok(maps.normal.unwrap_or_else(|| unreachable!("it was asked for")))
}

fn texture(map: &NormalMap, reduced: &Reduced<'_>) -> Texture<3> {
    Texture::of_normals(map, reduced.options.edges)
}

/// `unorm 8 xy, 2 bytes per texel`.
pub(super) fn describe(format: NormalFormat) -> String {
    let NormalFormat { encoding, depth, channels, .. } = format;
    format!("{encoding} {depth} {channels}, {}", bytes_per_texel(format.texel().bytes() as f64))
}
