//! Two normal maps into one, by every method.

use super::inputs::{KINDS, Kind, heights, name_of, normal_formats, normals};
use super::{Case, Extent, PRECISIONS, turns};
use crate::error::Result;
use crate::exact::Rational;
use crate::map::{Convention, HeightType, NormalFormat};
use crate::ops::Precision;
use crate::ops::blend::{BlendMethod, BlendOptions};
use crate::verify::job::{BlendJob, Job};

/// A method by its name, with its weights or the type of its mask.
#[derive(Clone, Copy)]
enum Method {
    Weighted(&'static str, &'static str),
    Masked(HeightType),
    Unweighted(&'static str, BlendMethod),
}

const METHODS: [Method; 13] = [
    Method::Weighted("1", "1"),
    Method::Weighted("1", "-0.5"),
    Method::Weighted("0.25", "0.75"),
    Method::Weighted("0", "0"),
    Method::Weighted("65535", "-65535"),
    Method::Masked(HeightType::U8),
    Method::Masked(HeightType::U16),
    Method::Masked(HeightType::F32),
    Method::Unweighted("linear", BlendMethod::Linear),
    Method::Unweighted("overlay", BlendMethod::Overlay),
    Method::Unweighted("udn", BlendMethod::Udn),
    Method::Unweighted("whiteout", BlendMethod::Whiteout),
    Method::Unweighted("rnm", BlendMethod::Rnm),
];

impl Method {
    fn name(self) -> String {
        match self {
            Self::Weighted(a, b) => format!("weighted {a} and {b}"),
            Self::Masked(mask) => format!("masked by {mask}"),
            Self::Unweighted(name, _) => name.into(),
        }
    }

    fn method(self) -> Result<BlendMethod> {
        Ok(match self {
            Self::Weighted(a, b) => BlendMethod::Weighted { base: a.parse::<Rational>()?, detail: b.parse()? },
            Self::Masked(_) => BlendMethod::Masked,
            Self::Unweighted(_, method) => method,
        })
    }
}

pub(super) fn cases(extent: Extent) -> Vec<Case> {
    let formats = normal_formats();
    let mut cases = Vec::new();
    for precision in PRECISIONS {
        for (number, method) in METHODS.into_iter().enumerate() {
            // `fast` promises nothing where large weights cancel.
            if precision == Precision::Fast && matches!(method, Method::Weighted("65535", _)) {
                continue;
            }
            // Of quick runs every third for each method, and each for some.
            let (first, step) = if extent == Extent::Quick { (number % 3, 3) } else { (0, 1) };
            for (at, &base) in formats.iter().enumerate().skip(first).step_by(step) {
                // Other partners for each method.
                for detail in turns(extent, 3 * at + cases.len() / formats.len(), &formats) {
                    for format in turns(extent, 5 * at + cases.len() / 5, &formats) {
                        cases.push(case(extent, precision, method, [base, detail, format], cases.len()));
                    }
                }
            }
        }
    }
    cases
}

fn case(
    extent: Extent,
    precision: Precision,
    method: Method,
    [base, detail, format]: [NormalFormat; 3],
    turn: usize,
) -> Case {
    let green = |format, turn: usize| NormalFormat { convention: [Convention::Gl, Convention::Dx][turn % 2], ..format };
    let [base, detail, format] = [green(base, turn), green(detail, turn / 2), green(format, turn / 3)];
    let kinds = if precision == Precision::Exact { &KINDS[..3] } else { &[Kind::Random, Kind::Small] };
    let kind = turns(Extent::Quick, turn + usize::from(extent == Extent::Full), kinds)[0];
    let names = [name_of(base), name_of(detail), name_of(format)];
    let of = format!("{} and {} to {}", names[0], names[1], names[2]);
    Case::new("blend", precision, &[&method.name(), &of, &kind], move |chance| {
        let options = BlendOptions { method: method.method()?, format, precision, ..Default::default() };
        let mask = match method {
            Method::Masked(mask) => Some(heights(kind, mask, 1.0, chance)?),
            _ => None,
        };
        let (base, detail) = (normals(kind, base, chance)?, normals(kind, detail, chance)?);
        Ok(Job::Blend(BlendJob { base, detail, mask, options }))
    })
}
