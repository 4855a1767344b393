//! Where the ray to the eye meets the relief, cell by cell.

use super::Texture;

/// The first point of the relief that the ray from the eye meets, as the offset from `at`, where it meets the plane that
/// is textured; both in texels.
///
/// Between the centres of four texels the heights are bilinear, and along a ray quadratic: the least root in the first
/// cell that has one. No step can miss a bump, and nothing is shared with [`crate::shading::relief_offset`], which is
/// measured against this.
///
/// `slant` is by how many texels the ray moves across while it rises by the whole scale; `side` is -1 where heights are
/// depths, else 1. The ray enters at z = 1/2, in units of the scale, and is below all heights at z = -1/2.
pub(super) fn intersection(heights: &Texture<1>, at: [f64; 2], slant: [f64; 2], side: f64) -> [f64; 2] {
    // Cells lie between centres, which are at halves.
    let top = [0, 1].map(|axis| at[axis] - 0.5 + 0.5 * slant[axis]);
    let cell_after = |depth: f64| [0, 1].map(|axis| cell(top[axis] - depth * slant[axis], -slant[axis]));
    let (mut depth, mut now) = (0.0, cell_after(0.0));
    while depth < 1.0 {
        let leaves = [0, 1].map(|axis| exit(top[axis], slant[axis], now[axis]));
        let end = leaves[0].min(leaves[1]).clamp(depth, 1.0);
        if let Some(met) = met_in_cell(heights, now, top, slant, side, [depth, end]) {
            return slant.map(|part| part * (0.5 - met));
        }
        for axis in [0, 1] {
            if leaves[axis] <= end {
                now[axis] += if slant[axis] > 0.0 { -1 } else { 1 };
            }
        }
        depth = end;
    }
    slant.map(|part| -0.5 * part)
}

/// The cell of a coordinate on the way of a ray that goes in the direction `way`: on a border the one ahead.
fn cell(coordinate: f64, way: f64) -> i64 {
    if way < 0.0 { coordinate.ceil() as i64 - 1 } else { coordinate.floor() as i64 }
}

/// The depth at which the ray leaves a cell along one axis.
fn exit(top: f64, slant: f64, cell: i64) -> f64 {
    let border = if slant > 0.0 { cell } else { cell + 1 };
    if slant == 0.0 { f64::INFINITY } else { (top - border as f64) / slant }
}

/// The least depth within `range` at which the ray is not above the heights of a cell.
fn met_in_cell(
    heights: &Texture<1>,
    [x, y]: [i64; 2],
    top: [f64; 2],
    slant: [f64; 2],
    side: f64,
    range: [f64; 2],
) -> Option<f64> {
    let height = |dx: i64, dy: i64| side * (f64::from(heights.texel(x + dx, y + dy)[0]) - 0.5);
    let (nw, ne, sw, se) = (height(0, 0), height(1, 0), height(0, 1), height(1, 1));
    // How far the heights are above the ray, a + b t + c t^2 of the depth t from the range's beginning.
    let [u, v] = [top[0] - range[0] * slant[0] - x as f64, top[1] - range[0] * slant[1] - y as f64];
    let (east, south, twist) = (ne - nw, sw - nw, nw - ne - sw + se);
    let a = nw + east * u + south * v + twist * u * v - (0.5 - range[0]);
    let b = 1.0 - east * slant[0] - south * slant[1] - twist * (u * slant[1] + v * slant[0]);
    let c = twist * slant[0] * slant[1];
    let root = if a >= 0.0 { Some(0.0) } else { least_root(a, b, c) };
    root.filter(|t| *t <= range[1] - range[0]).map(|t| range[0] + t)
}

/// The least root above zero of a + b t + c t^2 with a below zero, without the cancellation of the usual formula.
fn least_root(a: f64, b: f64, c: f64) -> Option<f64> {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    [a / q, q / c].into_iter().filter(|root| *root > 0.0).min_by(f64::total_cmp)
}
