//! A normal for every vertex, where a mesh has none or none of use.

use super::pieces::of_pieces;
use super::surface::scale;
use super::{MissingNormals, bits_of_value, is_zero, unit};
use crate::mesh::{CornerAdjacency, Mesh};
use crate::vector::{add, cross, dot, sub, times};
use std::borrow::Cow;
use std::collections::HashMap;

/// Normals whose length is off by more than this are normalised; others stay as they are, for MikkTSpace takes them so,
/// and 8-bit normals are off by 0.007. Lengyel's and Hegde's methods normalise what they use.
const LENGTH_TOLERANCE: f32 = 0.01;

/// A mesh with a usable normal for every vertex.
#[derive(Debug)]
pub(crate) struct Shading<'a> {
    /// The mesh, or, for flat normals, its triangles with three vertices of their own each.
    pub mesh: Cow<'a, Mesh>,
    /// Whether the vertices are not the given mesh's, but a corner's each.
    pub has_own_vertices: bool,
    /// The normal of each vertex.
    pub normals: Cow<'a, [[f32; 3]]>,
    /// Vertices whose normal was missing or zero.
    pub made: usize,
    /// Vertices whose normal was not of unit length.
    pub normalised: usize,
}

impl<'a> Shading<'a> {
    /// Repairs the normals that a mesh has, or makes those that it has not.
    pub fn new(mesh: &'a Mesh, missing: MissingNormals) -> Self {
        let given = |normals, made, normalised| Self {
            mesh: Cow::Borrowed(mesh),
            has_own_vertices: false,
            normals,
            made,
            normalised,
        };
        match (mesh.normals(), missing) {
            (Some(normals), _) if are_unit(normals) => given(normals.into(), 0, 0),
            (Some(normals), _) => {
                let (repaired, made, normalised) = repaired(mesh, normals);
                given(repaired.into(), made, normalised)
            }
            (None, MissingNormals::Smooth) => given(smooth_normals(mesh).into(), mesh.positions().len(), 0),
            (None, MissingNormals::Flat) => Self::flat(mesh),
        }
    }

    fn flat(mesh: &Mesh) -> Self {
        let scale = scale(mesh.positions());
        let of_triangle = |triangle| [unit_or_up(area_normal(mesh, scale, triangle)); 3];
        Self {
            normals: (0..mesh.triangles().len()).flat_map(of_triangle).collect(),
            mesh: Cow::Owned(mesh.unshared()),
            has_own_vertices: true,
            made: mesh.positions().len(),
            normalised: 0,
        }
    }
}

/// Normals of unit length; those that are zero become smooth ones. Tells how many were made, and how many normalised.
fn repaired(mesh: &Mesh, normals: &[[f32; 3]]) -> (Vec<[f32; 3]>, usize, usize) {
    let is_missing = |n: [f32; 3]| is_zero(n);
    let made = normals.iter().filter(|&&n| is_missing(n)).count();
    let normalised = normals.iter().filter(|&&n| !is_missing(n) && !is_unit(n)).count();
    let smooth = if made > 0 { smooth_normals(mesh) } else { Vec::new() };
    let repair = |(vertex, &n): (usize, &[f32; 3])| match n {
        n if is_missing(n) => smooth[vertex],
        n if is_unit(n) => n,
        n => unit(n),
    };
    (normals.iter().enumerate().map(repair).collect(), made, normalised)
}

/// For each vertex the sum of the normals of all triangles at its position, each as long as twice the area.
fn smooth_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut first_at = HashMap::new();
    let places: Vec<u32> =
        (0..).zip(mesh.positions()).map(|(vertex, &p)| *first_at.entry(bits_of_value(p)).or_insert(vertex)).collect();
    let triangles: Vec<[u32; 3]> =
        mesh.triangles().iter().map(|triangle| triangle.map(|vertex| places[vertex as usize])).collect();
    let adjacency = CornerAdjacency::of_vertices(&triangles, places.len());
    let scale = scale(mesh.positions());
    let sum = |place: usize| {
        let corners = adjacency.row(place).iter();
        corners.fold([0.0; 3], |sum, &corner| add(sum, area_normal(mesh, scale, corner as usize / 3)))
    };
    places.iter().map(|&place| unit_or_up(sum(place as usize))).collect()
}

/// The cross product of two edges, whose positions are multiplied by `scale`.
fn area_normal(mesh: &Mesh, scale: f32, triangle: usize) -> [f32; 3] {
    let [a, b, c] = mesh.triangles()[triangle].map(|vertex| times(scale, mesh.positions()[vertex as usize]));
    cross(sub(b, a), sub(c, a))
}

fn are_unit(normals: &[[f32; 3]]) -> bool {
    // Counting is faster than stopping at the first.
    let others = |_, normals: &[[f32; 3]]| normals.iter().fold(0, |others, &n| others + u32::from(!is_unit(n)));
    of_pieces(normals, others).into_iter().all(|others| others == 0)
}

fn is_unit(n: [f32; 3]) -> bool {
    let range =
        (1.0 - LENGTH_TOLERANCE) * (1.0 - LENGTH_TOLERANCE)..=(1.0 + LENGTH_TOLERANCE) * (1.0 + LENGTH_TOLERANCE);
    range.contains(&dot(n, n))
}

/// A unit vector; (0, 0, 1) for zero, which a vertex without area around it has. Minus zero is zero, so that triangles
/// in one plane have one normal.
fn unit_or_up(v: [f32; 3]) -> [f32; 3] {
    if is_zero(v) { [0.0, 0.0, 1.0] } else { unit(v).map(|part| part + 0.0) }
}
