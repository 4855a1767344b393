//! Tangents of Lengyel and of Hegde in f64, from the sources, with a bound of what f32 may be off by.
//!
//! The bound, to the first order in u = 2^-24, the relative error of one f32 operation. Positions and texture
//! coordinates are f32 and their scaling is exact, so differences have a relative error of u in each component.
//!
//! - Lengyel, a triangle's t = r (y2 e1 - y1 e2), r = 1 / d, d = x1 y2 - x2 y1. Each product of d is off by 3u, their
//!   difference by u more: d by (3 k + 1) u, k = (|x1 y2| + |x2 y1|) / |d|. r is off by u more. A component of
//!   y2 e1 - y1 e2 is off by 3u of each product and u of the difference: at most 4u (|y2 e1| + |y1 e2|). The last
//!   product adds u: t is off by at most u (4 |r| |(|y2 e1| + |y1 e2|)| + (3k + 3) |t|).
//! - Hegde, a triangle's t = unit(edge): u of the edge, u of the last product: 2u. The common factor turns nothing.
//! - A sum of m triangles adds (m - 1) u of the sum of the |t|.
//! - From there (t is made unit, projected, and made unit again): u, then for t - (n.t) n at most 3u of the dot
//!   product, u of the product and u of the difference, all at most |n|^2 = 1.02, over the length p of what is left;
//!   then u. The angle is at most (error of the sum / |sum| + 7u) / p + u.
//!
//! A tenth more covers the second order.

use texbake::Mesh;

const U: f64 = 1.0 / (1 << 24) as f64;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TangentFormula {
    Lengyel,
    Hegde,
}

/// The tangent of a corner.
#[derive(Debug, Clone, Copy)]
pub struct RealTangent {
    /// A unit vector; `None` if none is left, or f32 may take the handedness of a triangle around for the other one.
    pub t: Option<[f64; 3]>,
    /// det(t, b, n) of unit vectors t and b: w has its sign.
    pub determinant: f64,
    /// Radians that f32 may be off by.
    pub bound: f64,
}

/// No direction, or none that f64 is sure of.
const NOTHING: RealTangent = RealTangent { t: None, determinant: 0.0, bound: 0.0 };

/// A triangle's t and b, and what f32 may be off by in t.
struct Face {
    t: [f64; 3],
    b: [f64; 3],
    error: f64,
    handedness: f64,
    /// Whether f32 finds the same handedness, or that there is none.
    has_sign: bool,
}

/// The tangent of each corner of a mesh whose corners have these normals. A vertex has one tangent for the triangles
/// of each handedness of the mapping; those without one follow the right-handed ones, and give nothing.
pub fn real_tangents(mesh: &Mesh, normals: &[[f32; 3]], formula: TangentFormula, unwrap: bool) -> Vec<RealTangent> {
    let little = little(mesh);
    let faces = mesh.triangles().iter().map(|&triangle| face(mesh, triangle, formula, unwrap, little));
    let faces: Vec<Face> = faces.collect();
    let indices = mesh.triangles().as_flattened();
    assert_eq!(indices.len(), normals.len(), "a normal for each corner");
    let mut around = vec![Vec::new(); mesh.positions().len()];
    for (corner, &vertex) in indices.iter().enumerate() {
        around[vertex as usize].push(corner / 3);
    }
    let of_corner = |corner: usize| {
        let is_mirrored = |triangle: usize| faces[triangle].handedness < 0.0;
        let own = is_mirrored(corner / 3);
        let all = &around[indices[corner] as usize];
        if all.iter().any(|&triangle| !faces[triangle].has_sign) {
            return NOTHING;
        }
        let has_both = all.iter().any(|&triangle| faces[triangle].handedness > 0.0);
        let shares = |triangle: &usize| !has_both || is_mirrored(*triangle) == own;
        // A corner without handedness at a vertex of mirrored triangles alone goes with these.
        let members: Vec<&Face> = all.iter().filter(|&triangle| shares(triangle)).map(|&t| &faces[t]).collect();
        tangent(&members, normals[corner].map(f64::from))
    };
    (0..indices.len()).map(of_corner).collect()
}

/// Differences of texture coordinates below this count as zero: 2^-40 of the power of two below the greatest.
fn little(mesh: &Mesh) -> f64 {
    let greatest = mesh.texcoords().as_flattened().iter().fold(0.0, |greatest: f32, part| greatest.max(part.abs()));
    if greatest == 0.0 { 0.0 } else { 2f64.powi(f64::from(greatest).log2().floor() as i32 - 40) }
}

fn face(mesh: &Mesh, triangle: [u32; 3], formula: TangentFormula, unwrap: bool, little: f64) -> Face {
    let p = triangle.map(|vertex| mesh.positions()[vertex as usize].map(f64::from));
    let uv = triangle.map(|vertex| mesh.texcoords()[vertex as usize].map(f64::from));
    let [e1, e2] = [1, 2].map(|i| sub(p[i], p[0]));
    let short_way = |difference: f64| match difference {
        d if unwrap && d > 0.5 => d - 1.0,
        d if unwrap && d < -0.5 => d + 1.0,
        d => d,
    };
    let snapped = |difference: f64| if difference.abs() < little { 0.0 } else { difference };
    let difference = |i: usize, axis: usize| snapped(short_way(uv[i][axis] - uv[0][axis]));
    let [[x1, y1], [x2, y2]] = [1, 2].map(|i| [0, 1].map(|axis| difference(i, axis)));
    let d = x1 * y2 - x2 * y1;
    let is_f32 = |value: f64| f64::from(value as f32) == value;
    let is_exact = [x1, y1, x2, y2, x1 * y2, x2 * y1].into_iter().all(is_f32);
    let has_sign = is_exact || d.abs() > 3.3 * U * ((x1 * y2).abs() + (x2 * y1).abs());
    let nothing = Face { t: [0.0; 3], b: [0.0; 3], error: 0.0, handedness: 0.0, has_sign };
    if d == 0.0 {
        return nothing;
    }
    match formula {
        TangentFormula::Lengyel => {
            let r = 1.0 / d;
            let t = times(r, sub(times(y2, e1), times(y1, e2)));
            let b = times(r, sub(times(x1, e2), times(x2, e1)));
            let parts = [0, 1, 2].map(|axis: usize| (y2 * e1[axis]).abs() + (y1 * e2[axis]).abs());
            let k = ((x1 * y2).abs() + (x2 * y1).abs()) * r.abs();
            let error = U * (4.0 * r.abs() * length(parts) + (3.0 * k + 3.0) * length(t));
            Face { t, b, error, handedness: d.signum(), has_sign }
        }
        TangentFormula::Hegde => {
            let n = cross(e1, e2);
            if length(n) == 0.0 {
                return Face { handedness: d.signum(), ..nothing };
            }
            // In f32 such a sliver may have no area, and give nothing.
            let is_sliver = length(n) < 1e-6 * length(e1) * length(e2);
            let t = if x1 != 0.0 { times(1.0 / x1, e1) } else { times(1.0 / x2, e2) };
            let t = times(1.0 / length(t), t);
            let gradient = times(1.0 / d, sub(times(x1, e2), times(x2, e1)));
            let b = cross(times(1.0 / length(n), n), t);
            let b = if dot(b, gradient) > 0.0 { b } else { times(-1.0, b) };
            Face { t, b, error: if is_sliver { 1.0 } else { 2.0 * U }, handedness: d.signum(), has_sign }
        }
    }
}

fn tangent(members: &[&Face], n: [f64; 3]) -> RealTangent {
    let (mut t, mut b, mut error, mut magnitude) = ([0.0; 3], [0.0; 3], 0.0, 0.0);
    for face in members {
        (t, b) = (add(t, face.t), add(b, face.b));
        (error, magnitude) = (error + face.error, magnitude + length(face.t));
    }
    let error = error + (members.len() as f64 - 1.0) * U * magnitude;
    // More than rounding leaves (1e-7); what is not much more has a bound that proves nothing.
    let is_none = |rest: f64| rest < 1e-5;
    if magnitude == 0.0 || is_none(length(t) / magnitude) {
        return NOTHING;
    }
    let direction = times(1.0 / length(t), t);
    let projected = sub(direction, times(dot(n, direction), n));
    let p = length(projected);
    if is_none(p) {
        return NOTHING;
    }
    let bound = 1.1 * ((error / length(t) + 7.0 * U) / p + U);
    let b = if length(b) == 0.0 { b } else { times(1.0 / length(b), b) };
    RealTangent { t: Some(times(1.0 / p, projected)), determinant: dot(cross(direction, b), n), bound }
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn times(factor: f64, v: [f64; 3]) -> [f64; 3] {
    v.map(|part| factor * part)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}
