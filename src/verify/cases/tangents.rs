//! Meshes into tangents, by every method.

use super::{Case, Extent, PRECISIONS};
use crate::error::Result;
use crate::map::Convention;
use crate::mesh::Mesh;
use crate::ops::Precision;
use crate::ops::tangents::{TangentMethod, TangentOptions};
use crate::verify::chance::Chance;
use crate::verify::job::{Job, TangentJob};
use std::fmt;

/// What a mesh is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A hilly grid whose texture is a little distorted.
    Hills,
    /// The same, mirrored half way.
    Mirrored,
    /// Triangles without order between vertices of whole and half coordinates: many have no area.
    Soup,
    /// The same between floats of every exponent.
    Extreme,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Hills => "hills",
            Self::Mirrored => "mirrored",
            Self::Soup => "soup",
            Self::Extreme => "extreme",
        })
    }
}

const METHODS: [TangentMethod; 3] = [TangentMethod::Mikktspace, TangentMethod::Lengyel, TangentMethod::Hegde];

pub(super) fn cases(extent: Extent) -> Vec<Case> {
    let mut cases = Vec::new();
    for precision in PRECISIONS {
        // `fast` promises nothing for triangles that nearly have no area.
        let kinds = match precision {
            Precision::Exact => &[Kind::Hills, Kind::Mirrored, Kind::Soup, Kind::Extreme][..],
            Precision::Fast => &[Kind::Hills, Kind::Mirrored],
        };
        for method in METHODS {
            for &kind in kinds {
                for copy in 0..if extent == Extent::Full { 50 } else { 4 } {
                    let convention = [Convention::Gl, Convention::Dx][copy % 2];
                    cases.push(case(precision, method, convention, kind, copy));
                }
            }
        }
    }
    cases
}

fn case(precision: Precision, method: TangentMethod, convention: Convention, kind: Kind, copy: usize) -> Case {
    let name = match method {
        TangentMethod::Mikktspace => "tangents of mikktspace",
        TangentMethod::Lengyel => "tangents of lengyel",
        TangentMethod::Hegde => "tangents of hegde",
    };
    Case::new(name, precision, &[&convention, &kind, &copy], move |chance| {
        let options = TangentOptions { method, convention, precision, unwrap: copy % 4 > 1, ..Default::default() };
        let mesh = match kind {
            Kind::Hills | Kind::Mirrored => hills(kind == Kind::Mirrored, chance)?,
            Kind::Soup | Kind::Extreme => soup(kind == Kind::Extreme, chance)?,
        };
        Ok(Job::Tangents(TangentJob { mesh, options }))
    })
}

/// Squares of a grid along each axis.
const SQUARES: u32 = 12;

fn hills(is_mirrored: bool, chance: &mut Chance) -> Result<Mesh> {
    let vertices: Vec<[u32; 2]> = (0..=SQUARES).flat_map(|j| (0..=SQUARES).map(move |i| [i, j])).collect();
    let mut near = |i: u32, reach: f32| i as f32 + reach * chance.unit();
    let positions = vertices.iter().map(|&[i, j]| [near(i, 0.2), near(j, 0.2), near(0, 0.5)]).collect();
    let texcoords = vertices.iter().map(|&[i, j]| {
        let u = if is_mirrored { i.abs_diff(SQUARES / 2) } else { i };
        [near(u, 0.1) / SQUARES as f32, near(j, 0.1) / SQUARES as f32]
    });
    let texcoords = texcoords.collect();
    let normals = vertices.iter().map(|_| {
        let [x, y] = [near(0, 0.5), near(0, 0.5)];
        let length = (x * x + y * y + 1.0).sqrt();
        [x / length, y / length, 1.0 / length]
    });
    let normals = normals.collect();
    let at = |i: u32, j: u32| j * (SQUARES + 1) + i;
    let squares = (0..SQUARES).flat_map(|j| (0..SQUARES).map(move |i| (i, j)));
    let triangles = squares
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]);
    Mesh::new(positions, texcoords, triangles.collect())?.with_normals(normals)
}

fn soup(is_extreme: bool, chance: &mut Chance) -> Result<Mesh> {
    let count = 60;
    let mut coordinate = || match is_extreme {
        true => chance.finite(),
        false => chance.below(9) as f32 / 2.0 - 2.0,
    };
    let positions = (0..count).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
    let texcoords = (0..count).map(|_| [coordinate(), coordinate()]).collect();
    let normals = (0..count).map(|_| [coordinate(), coordinate(), coordinate()]).collect();
    let triangles = (0..4 * count).map(|_| [0; 3].map(|_: i32| chance.below(count) as u32)).collect();
    Mesh::new(positions, texcoords, triangles)?.with_normals(normals)
}
