//! Heights into normal maps, parallax maps, and both in one pass.

use super::inputs::{KINDS, Kind, heights, name_of, normal_formats};
use super::{CODES, Case, Extent, HEIGHT_TYPES, PRECISIONS, every_edges, turns};
use crate::error::Result;
use crate::exact::{Rational, Scale};
use crate::map::{Convention, Edges, HeightType, NormalFormat, ParallaxFormat};
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, Filter};
use crate::verify::job::{BakeJob, Job};

/// Scales in texels: gentle, steep, zero, negative, parts as long as they may be, and those of the documentation.
/// 510 makes small sums of 8-bit heights Pythagorean.
const SCALES: [&str; 7] = ["24", "510", "0.000001", "-7/3", "0", "16777213/9699691", "1000000"];

const FILTERS: [Filter; 4] = [Filter::Central, Filter::Sobel, Filter::Scharr, Filter::Prewitt];

/// What is baked.
#[derive(Clone, Copy)]
struct Outputs {
    operation: &'static str,
    normal: Option<NormalFormat>,
    parallax: Option<ParallaxFormat>,
}

pub(super) fn cases(extent: Extent) -> Vec<Case> {
    let mut cases = Vec::new();
    for precision in PRECISIONS {
        for height_type in HEIGHT_TYPES {
            for outputs in every_outputs(extent) {
                for kind in kinds(extent, precision, cases.len()) {
                    add(&mut cases, extent, precision, height_type, outputs, kind);
                }
            }
        }
    }
    cases
}

/// `fast` promises nothing for slopes without measure.
fn kinds(extent: Extent, precision: Precision, turn: usize) -> Vec<Kind> {
    match precision {
        Precision::Exact => turns(extent, turn, &KINDS),
        Precision::Fast => turns(extent, turn, &[Kind::Random, Kind::Small, Kind::Boundaries]),
    }
}

fn every_outputs(extent: Extent) -> Vec<Outputs> {
    let parallax = |(encoding, depth)| ParallaxFormat { encoding, depth };
    let normals = normal_formats().into_iter().map(|format| Outputs {
        operation: "normal map",
        normal: Some(format),
        parallax: None,
    });
    let parallaxes = CODES.into_iter().map(|codes| Outputs {
        operation: "parallax map",
        normal: None,
        parallax: Some(parallax(codes)),
    });
    let both = normal_formats().into_iter().enumerate().flat_map(|(turn, normal)| {
        turns(extent, 3 * turn, &CODES).into_iter().map(move |codes| Outputs {
            operation: "both in one pass",
            normal: Some(normal),
            parallax: Some(parallax(codes)),
        })
    });
    normals.chain(parallaxes).chain(both).collect()
}

fn add(
    cases: &mut Vec<Case>,
    extent: Extent,
    precision: Precision,
    height_type: HeightType,
    outputs: Outputs,
    kind: Kind,
) {
    // Numbers without a common divisor, so that the choices go round at different times.
    let turn = cases.len();
    for edges in turns(extent, turn, &every_edges()) {
        for filter in turns(extent, turn / 2, &FILTERS) {
            for convention in turns(extent, turn / 3, &[Convention::Gl, Convention::Dx]) {
                let scale = SCALES[(cases.len() / 4) % SCALES.len()];
                cases.push(case(precision, height_type, outputs, kind, (edges, filter, convention, scale)));
            }
        }
    }
}

fn case(
    precision: Precision,
    height_type: HeightType,
    Outputs { operation, normal, parallax }: Outputs,
    kind: Kind,
    (edges, filter, convention, scale): (Edges, Filter, Convention, &'static str),
) -> Case {
    let normal = normal.map(|format| NormalFormat { convention, ..format });
    let formats = [normal.map(name_of), parallax.map(|format| format!("{} {}", format.encoding, format.depth))];
    let formats = formats.into_iter().flatten().collect::<Vec<_>>().join(" and ");
    let edge_names = edges.to_string().replace(',', "/");
    let scale_name = format!("scale {scale}");
    let make = move |chance: &mut _| -> Result<Job> {
        let scale: Rational = scale.parse()?;
        let per_height = scale.numerator() as f64
            / scale.denominator() as f64
            / (2.0 * height_type.greatest_code().map_or(65_535.0, f64::from));
        let options = BakeOptions { scale: Scale::Texels(scale), filter, edges, normal, parallax, precision };
        Ok(Job::Bake(BakeJob { heights: heights(kind, height_type, per_height, chance)?, options }))
    };
    Case::new(operation, precision, &[&height_type, &formats, &filter, &edge_names, &scale_name, &kind], make)
}
