//! Heights into normal maps, parallax maps, and both in one pass.

use super::inputs::{Boundary, KINDS, Kind, heights, name_of, normal_formats};
use super::{CODES, Case, Extent, HEIGHT_TYPES, PRECISIONS, every_edges, some};
use crate::error::Result;
use crate::exact::{Rational, Scale};
use crate::map::{Convention, Depth, Edges, Encoding, HeightType, NormalFormat, ParallaxFormat};
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, Filter};
use crate::verify::chance::Chance;
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
    let mut draw = Chance::named(0, "bakes");
    for precision in PRECISIONS {
        let mut decks = ["normal map", "parallax map", "both in one pass"].map(|name| (name, Deck::new(name)));
        for (height, height_type) in HEIGHT_TYPES.into_iter().enumerate() {
            for (at, outputs) in every_outputs(extent, &mut draw).into_iter().enumerate() {
                let deck = decks.iter_mut().find(|(name, _)| *name == outputs.operation).map(|(_, deck)| deck);
                let deck = deck.expect("a deck for each operation");
                for (number, &kind) in kinds(precision).iter().enumerate() {
                    let options = options(extent, precision, height_type, kind, deck);
                    for (turn, (filter, edges, convention)) in options.into_iter().enumerate() {
                        // Parallax maps have no green.
                        if outputs.normal.is_none() && convention == Convention::Dx && extent == Extent::Full {
                            continue;
                        }
                        // Every format has every scale in turn.
                        let scales = scales(precision, height_type);
                        let scale = scales[(at + number + 3 * height + turn) % scales.len()];
                        let options = (edges, filter, convention, scale);
                        cases.push(case(precision, height_type, outputs, kind, options));
                    }
                }
            }
        }
    }
    cases
}

/// `fast` promises nothing for heights without measure.
fn kinds(precision: Precision) -> &'static [Kind] {
    match precision {
        Precision::Exact => &KINDS,
        Precision::Fast => &[Kind::Random, Kind::Small, Kind::Boundaries],
    }
}

/// Scales for which the bounds of `fast` hold are all for integers; float heights that differ little lose the digits
/// that they share.
fn scales(precision: Precision, height_type: HeightType) -> &'static [&'static str] {
    match (precision, height_type) {
        (Precision::Fast, HeightType::F32) => &SCALES[..1],
        _ => &SCALES,
    }
}

/// Filters, edges and conventions. The search for boundaries is one among central differences, and so is what `fast`
/// promises of float heights: sums of differences may cancel.
fn options(
    extent: Extent,
    precision: Precision,
    height_type: HeightType,
    kind: Kind,
    deck: &mut Deck,
) -> Vec<(Filter, Edges, Convention)> {
    let may_cancel = precision == Precision::Fast && height_type == HeightType::F32;
    let is_central = kind == Kind::Boundaries || may_cancel;
    match extent {
        Extent::Quick => {
            let (filter, edges, convention) = deck.next();
            vec![(if is_central { Filter::Central } else { filter }, edges, convention)]
        }
        Extent::Full => {
            let mut all = every_option();
            all.retain(|(filter, ..)| !is_central || *filter == Filter::Central);
            all
        }
    }
}

fn every_option() -> Vec<(Filter, Edges, Convention)> {
    let mut options = Vec::new();
    for filter in FILTERS {
        for edges in every_edges() {
            options.extend([Convention::Gl, Convention::Dx].map(|convention| (filter, edges, convention)));
        }
    }
    options
}

/// All options in an order of chance, and then again: each comes as often as any other.
struct Deck {
    draw: Chance,
    left: Vec<(Filter, Edges, Convention)>,
}

impl Deck {
    fn new(name: &str) -> Self {
        Self { draw: Chance::named(0, name), left: Vec::new() }
    }

    fn next(&mut self) -> (Filter, Edges, Convention) {
        if self.left.is_empty() {
            self.left = every_option();
        }
        let card = self.draw.below(self.left.len() as u64) as usize;
        self.left.swap_remove(card)
    }
}

/// A normal map of every format, a parallax map of every format, and pairs of them.
fn every_outputs(extent: Extent, draw: &mut Chance) -> Vec<Outputs> {
    let parallax = |(encoding, depth)| ParallaxFormat { encoding, depth };
    let mut outputs = Vec::new();
    for format in normal_formats() {
        outputs.push(Outputs { operation: "normal map", normal: Some(format), parallax: None });
    }
    for codes in CODES {
        outputs.push(Outputs { operation: "parallax map", normal: None, parallax: Some(parallax(codes)) });
    }
    for normal in normal_formats() {
        for codes in some(extent, draw, &CODES) {
            let (normal, parallax) = (Some(normal), Some(parallax(codes)));
            outputs.push(Outputs { operation: "both in one pass", normal, parallax });
        }
    }
    outputs
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
        let options =
            BakeOptions { scale: Scale::Texels(scale), filter, edges, normal, parallax, roughness: None, precision };
        let near = Boundary {
            per_height,
            codes: normal.map_or((Encoding::Unorm, Depth::Bits8), |it| (it.encoding, it.depth)),
        };
        Ok(Job::Bake(BakeJob { heights: heights(kind, height_type, near, chance)?, options }))
    };
    Case::new(operation, precision, &[&height_type, &formats, &filter, &edge_names, &scale_name, &kind], make)
}
