//! Generated surfaces whose tangent space is known exactly, in double precision.

use super::real::{cross, dot, normalized, sum};
use crate::error::Result;
use crate::mesh::Mesh;
use std::f64::consts::{PI, TAU};

/// A point of a surface over the parameters a and b, with how it changes along them.
pub(super) struct Point {
    pub position: [f64; 3],
    /// Of any length.
    pub normal: [f64; 3],
    pub texcoord: [f64; 2],
    /// The derivatives of the position along a and b.
    pub along: [[f64; 3]; 2],
    /// The derivatives of the texture coordinates along a and b.
    pub texcoords_along: [[f64; 2]; 2],
}

/// A surface over a and b from 0 to 1.
pub(super) struct Surface {
    pub name: &'static str,
    pub at: fn(f64, f64) -> Point,
}

/// Curved, and stretched towards its poles; curved both ways; flat and skewed; flat and mirrored in the middle.
pub(super) const SURFACES: [Surface; 4] = [
    Surface { name: "sphere", at: sphere },
    Surface { name: "torus", at: torus },
    Surface { name: "sheared plane", at: sheared },
    Surface { name: "mirrored plane", at: mirrored },
];

/// Squares of the grid along each parameter; even, so that the mirrored plane has vertices where it is mirrored.
const SQUARES: u32 = 48;

impl Surface {
    /// Its triangles, and the parameters of each vertex.
    pub fn mesh(&self) -> Result<(Mesh, Vec<[f64; 2]>)> {
        let side = SQUARES + 1;
        let share = |i: u32| f64::from(i) / f64::from(SQUARES);
        let parameters: Vec<[f64; 2]> = (0..side * side).map(|i| [share(i % side), share(i / side)]).collect();
        let points: Vec<Point> = parameters.iter().map(|&[a, b]| (self.at)(a, b)).collect();
        let squares = (0..SQUARES * SQUARES).map(|i| i / SQUARES * side + i % SQUARES);
        let triangles = squares.flat_map(|i| [[i, i + 1, i + side + 1], [i, i + side + 1, i + side]]).collect();
        let positions = points.iter().map(|point| point.position.map(|part| part as f32)).collect();
        let texcoords = points.iter().map(|point| point.texcoord.map(|part| part as f32)).collect();
        let normals = points.iter().map(|point| normalized(point.normal).map(|part| part as f32)).collect();
        Ok((Mesh::new(positions, texcoords, triangles)?.with_normals(normals)?, parameters))
    }
}

impl Point {
    /// The gradients of u and v on the surface, the longer one of length one, and its normal.
    pub fn frame(&self) -> [[f64; 3]; 3] {
        let [a, b] = self.along;
        let face = cross(a, b);
        let area = dot(face, face);
        let across = [cross(b, face), cross(face, a)].map(|axis| axis.map(|part| part / area));
        let [t, b] = [0, 1].map(|axis| {
            let [along_a, along_b] = self.texcoords_along;
            sum([(along_a[axis], across[0]), (along_b[axis], across[1])])
        });
        let longest = dot(t, t).max(dot(b, b)).sqrt();
        [t.map(|part| part / longest), b.map(|part| part / longest), normalized(self.normal)]
    }
}

/// Of radius 1 without its poles, its texture twice around.
fn sphere(a: f64, b: f64) -> Point {
    let height = 0.9 * PI;
    let ((sin, cos), (sin_b, cos_b)) = ((TAU * a).sin_cos(), (0.05 * PI + height * b).sin_cos());
    let position = [sin_b * cos, sin_b * sin, -cos_b];
    Point {
        position,
        normal: position,
        texcoord: [2.0 * a, 1.0 - b],
        along: [
            [-TAU * sin_b * sin, TAU * sin_b * cos, 0.0],
            [height * cos_b * cos, height * cos_b * sin, height * sin_b],
        ],
        texcoords_along: [[2.0, 0.0], [0.0, -1.0]],
    }
}

/// Of outer radius 1 and inner radius 0.4, its texture three times around and once across.
fn torus(a: f64, b: f64) -> Point {
    let ((sin, cos), (sin_b, cos_b)) = ((TAU * a).sin_cos(), (TAU * b).sin_cos());
    let radius = 0.7 + 0.3 * cos_b;
    Point {
        position: [radius * cos, radius * sin, 0.3 * sin_b],
        normal: [cos_b * cos, cos_b * sin, sin_b],
        texcoord: [3.0 * a, 1.0 - b],
        along: [
            [-TAU * radius * sin, TAU * radius * cos, 0.0],
            [-0.3 * TAU * sin_b * cos, -0.3 * TAU * sin_b * sin, 0.3 * TAU * cos_b],
        ],
        texcoords_along: [[3.0, 0.0], [0.0, -1.0]],
    }
}

/// A square of which u grows along both sides: 45 degrees between lines of equal u and of equal v.
fn sheared(a: f64, b: f64) -> Point {
    Point { texcoord: [a + b, 1.0 - b], texcoords_along: [[1.0, 0.0], [1.0, -1.0]], ..plane(a, b) }
}

/// A square whose right half has the texture of its left one, mirrored.
fn mirrored(a: f64, b: f64) -> Point {
    let (u, along) = if a < 0.5 { (2.0 * a, 2.0) } else { (2.0 - 2.0 * a, -2.0) };
    Point { texcoord: [u, 2.0 - 2.0 * b], texcoords_along: [[along, 0.0], [0.0, -2.0]], ..plane(a, b) }
}

fn plane(a: f64, b: f64) -> Point {
    Point {
        position: [2.0 * a - 1.0, 2.0 * b - 1.0, 0.0],
        normal: [0.0, 0.0, 1.0],
        texcoord: [a, 1.0 - b],
        along: [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
        texcoords_along: [[1.0, 0.0], [0.0, -1.0]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_points() {
        for Surface { name, at } in SURFACES {
            for (a, b) in [(0.1, 0.2), (0.4, 0.9), (0.7, 0.6)] {
                let step = 1e-5;
                let differences = [[at(a - step, b), at(a + step, b)], [at(a, b - step), at(a, b + step)]];
                let point = at(a, b);
                for (axis, [before, after]) in differences.iter().enumerate() {
                    let slope = |before: f64, after: f64| (after - before) / (2.0 * step);
                    for i in 0..3 {
                        let found = slope(before.position[i], after.position[i]);
                        // The third derivatives are below (2 pi)^3, and rounding is 1e-16 over the step.
                        assert!((found - point.along[axis][i]).abs() < 1e-7, "{name} {a} {b}");
                    }
                    for i in 0..2 {
                        let found = slope(before.texcoord[i], after.texcoord[i]);
                        assert!((found - point.texcoords_along[axis][i]).abs() < 1e-9, "{name} {a} {b}");
                    }
                }
                assert!(point.along.iter().all(|&along| dot(along, point.normal).abs() < 1e-12), "{name}");
                assert!(dot(cross(point.along[0], point.along[1]), point.normal) > 0.0, "{name} is inside out");
            }
        }
    }
}
