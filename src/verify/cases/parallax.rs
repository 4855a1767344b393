//! Heights and given normals into parallax maps.

use super::inputs::{KINDS, Kind, heights, name_of, normal_formats, normals};
use super::{CODES, Case, Extent, HEIGHT_TYPES, PRECISIONS, turns};
use crate::map::{Convention, NormalFormat, ParallaxFormat};
use crate::ops::Precision;
use crate::verify::job::{Job, ParallaxJob};

pub(super) fn cases(extent: Extent) -> Vec<Case> {
    let mut cases = Vec::new();
    for precision in PRECISIONS {
        for height_type in HEIGHT_TYPES {
            for normal_format in normal_formats() {
                // Another place in the row for each height type: every format meets every other in the end.
                for codes in turns(extent, cases.len() + cases.len() / CODES.len(), &CODES) {
                    let (encoding, depth) = codes;
                    let format = ParallaxFormat { encoding, depth };
                    let convention = [Convention::Gl, Convention::Dx][cases.len() % 2];
                    let normal_format = NormalFormat { convention, ..normal_format };
                    let kinds = if precision == Precision::Exact { &KINDS[..] } else { &[Kind::Random, Kind::Small] };
                    for kind in turns(extent, cases.len() / 3, kinds) {
                        let of = format!("{encoding} {depth}");
                        let choices = [&height_type as _, &name_of(normal_format) as _, &of as _, &kind as _];
                        let make = move |chance: &mut _| {
                            let heights = heights(kind, height_type, 1.0, chance)?;
                            let normals = normals(kind, normal_format, chance)?;
                            Ok(Job::Parallax(ParallaxJob { heights, normals, format, precision }))
                        };
                        cases.push(Case::new("parallax map of given normals", precision, &choices, make));
                    }
                }
            }
        }
    }
    cases
}
