//! Two normal maps into one, by every method.

use super::inputs::{KINDS, Kind, any_heights, name_of, normal_formats, normals};
use super::{Case, Extent, PRECISIONS, some};
use crate::error::Result;
use crate::exact::Rational;
use crate::map::{Convention, HeightType, NormalFormat};
use crate::ops::Precision;
use crate::ops::blend::{BlendMethod, BlendOptions};
use crate::verify::chance::Chance;
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
    let mut draw = Chance::named(0, "blends");
    for precision in PRECISIONS {
        let kinds = if precision == Precision::Exact { &KINDS[..3] } else { &KINDS[..2] };
        for (number, method) in METHODS.into_iter().enumerate() {
            // `fast` promises nothing where large weights cancel.
            if precision == Precision::Fast && matches!(method, Method::Weighted("65535", _)) {
                continue;
            }
            // Of quick runs every third format for each method, and each for some.
            let (first, step) = if extent == Extent::Quick { (number % 3, 3) } else { (0, 1) };
            for &base in formats.iter().skip(first).step_by(step) {
                for detail in some(extent, &mut draw, &formats) {
                    let formats = [base, detail, draw.of(&formats)].map(|format| {
                        let convention = draw.of(&[Convention::Gl, Convention::Dx]);
                        NormalFormat { convention, ..format }
                    });
                    cases.extend(kinds.iter().map(|&kind| case(precision, method, formats, kind)));
                }
            }
        }
    }
    cases
}

fn case(precision: Precision, method: Method, [base, detail, format]: [NormalFormat; 3], kind: Kind) -> Case {
    let of = format!("{} and {} to {}", name_of(base), name_of(detail), name_of(format));
    Case::new("blend", precision, &[&method.name(), &of, &kind], move |chance| {
        let options = BlendOptions { method: method.method()?, format, precision, ..Default::default() };
        let size = kind.size(chance)?;
        let mask = match method {
            Method::Masked(mask) => Some(any_heights(kind, mask, size, chance)?),
            _ => None,
        };
        let (base, detail) = (normals(kind, base, size, chance)?, normals(kind, detail, size, chance)?);
        Ok(Job::Blend(BlendJob { base, detail, mask, options }))
    })
}
