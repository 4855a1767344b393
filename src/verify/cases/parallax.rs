//! Heights and given normals into parallax maps.

use super::inputs::{KINDS, Kind, any_heights, name_of, normal_formats, normals};
use super::{CODES, Case, Extent, HEIGHT_TYPES, PRECISIONS, some};
use crate::map::{Convention, Depth, Encoding, HeightType, NormalFormat, ParallaxFormat};
use crate::ops::Precision;
use crate::verify::chance::Chance;
use crate::verify::job::{Job, ParallaxJob};

pub(super) fn cases(extent: Extent) -> Vec<Case> {
    let mut cases = Vec::new();
    let mut draw = Chance::named(0, "parallax maps of given normals");
    for precision in PRECISIONS {
        let kinds = if precision == Precision::Exact { &KINDS[..3] } else { &KINDS[..2] };
        for height_type in HEIGHT_TYPES {
            for normal_format in normal_formats() {
                for convention in some(extent, &mut draw, &[Convention::Gl, Convention::Dx]) {
                    for codes in some(extent, &mut draw, &CODES) {
                        for &kind in kinds {
                            let normals = NormalFormat { convention, ..normal_format };
                            cases.push(case(precision, height_type, normals, codes, kind));
                        }
                    }
                }
            }
        }
    }
    cases
}

fn case(
    precision: Precision,
    height_type: HeightType,
    given: NormalFormat,
    (encoding, depth): (Encoding, Depth),
    kind: Kind,
) -> Case {
    let stored = format!("{encoding} {depth}");
    let choices = [&height_type as _, &name_of(given) as _, &stored as _, &kind as _];
    Case::new("parallax map of given normals", precision, &choices, move |chance| {
        let size = kind.size(chance)?;
        let heights = any_heights(kind, height_type, size, chance)?;
        let normals = normals(kind, given, size, chance)?;
        Ok(Job::Parallax(ParallaxJob { heights, normals, format: ParallaxFormat { encoding, depth }, precision }))
    })
}
