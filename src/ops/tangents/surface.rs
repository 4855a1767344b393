//! A mesh as the formulas see it: at one scale, with a normal for every vertex.

use super::mikktspace_area;
use super::pieces::of_pieces;
use crate::mesh::Mesh;
use crate::vector::{sub, times};

/// A mesh at a scale of which no formula overflows.
///
/// Positions and texture coordinates are multiplied by powers of two that bring the greatest of each between 2^20 and
/// 2^21 in magnitude: a mesh of 1e20 and one of 1e-20 have the same bits here. Below 2^-106 (1e-32) the power ends
/// at 2^126.
#[derive(Debug)]
pub(crate) struct Surface<'a> {
    pub positions: &'a [[f32; 3]],
    pub position_scale: f32,
    pub normals: &'a [[f32; 3]],
    pub texcoords: &'a [[f32; 2]],
    pub texcoord_scale: f32,
    /// Whether a corner whose u is more than half a texture behind the greatest of its triangle counts as one
    /// texture further, as long as the triangle keeps an area: Hegde's temporary duplicates with u + 1.
    pub unwrap: bool,
    pub triangles: &'a [[u32; 3]],
}

/// Two edges of a triangle from its corner 0, in space and in texture (FGED2 eq. 7.34).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TriangleEdges {
    pub e1: [f32; 3],
    pub e2: [f32; 3],
    /// (x1, y1).
    pub d1: [f32; 2],
    /// (x2, y2).
    pub d2: [f32; 2],
}

impl<'a> Surface<'a> {
    /// A mesh with these normals; the mesh's own are not looked at.
    pub fn new(mesh: &'a Mesh, normals: &'a [[f32; 3]], unwrap: bool) -> Self {
        Self {
            positions: mesh.positions(),
            position_scale: scale(mesh.positions()),
            normals,
            texcoords: mesh.texcoords(),
            texcoord_scale: scale(mesh.texcoords()),
            unwrap,
            triangles: mesh.triangles(),
        }
    }

    /// A vertex's position, scaled.
    #[inline(always)]
    pub fn position(&self, vertex: u32) -> [f32; 3] {
        times(self.position_scale, self.positions[vertex as usize])
    }

    /// Scaled positions of a corner, of the next one of its triangle and of the one before.
    #[inline(always)]
    pub fn corner_positions(&self, corner: u32) -> [[f32; 3]; 3] {
        let [a, b, c] = self.triangles[corner as usize / 3].map(|vertex| self.position(vertex));
        match corner % 3 {
            0 => [a, b, c],
            1 => [b, c, a],
            _ => [c, a, b],
        }
    }

    /// The edges of a triangle, scaled.
    #[inline(always)]
    pub fn edges(&self, triangle: usize) -> TriangleEdges {
        let vertices = self.triangles[triangle];
        let positions = vertices.map(|vertex| self.positions[vertex as usize]);
        let texcoords = vertices.map(|vertex| self.texcoords[vertex as usize]);
        self.edges_between(positions, texcoords)
    }

    /// The edges of a triangle with these positions and texture coordinates, which are the mesh's.
    #[inline(always)]
    pub fn edges_between(&self, [p0, p1, p2]: [[f32; 3]; 3], texcoords: [[f32; 2]; 3]) -> TriangleEdges {
        let scale = self.position_scale;
        let (p0, p1, p2) = (times(scale, p0), times(scale, p1), times(scale, p2));
        let [d1, d2] = self.texture_edges_between(texcoords);
        TriangleEdges { e1: sub(p1, p0), e2: sub(p2, p0), d1, d2 }
    }

    /// (x1, y1) and (x2, y2) of a triangle, scaled and, if asked for, unwrapped.
    #[inline(always)]
    pub fn texture_edges(&self, triangle: usize) -> [[f32; 2]; 2] {
        let [a, b, c] = self.triangles[triangle];
        let texcoord = |vertex: u32| self.texcoords[vertex as usize];
        self.texture_edges_between([texcoord(a), texcoord(b), texcoord(c)])
    }

    #[inline(always)]
    fn texture_edges_between(&self, [a, b, c]: [[f32; 2]; 3]) -> [[f32; 2]; 2] {
        let scale = self.texcoord_scale;
        let u = [a[0] * scale, b[0] * scale, c[0] * scale];
        let v = [a[1] * scale, b[1] * scale, c[1] * scale];
        let [x1, x2] = [u[1] - u[0], u[2] - u[0]];
        let [y1, y2] = [v[1] - v[0], v[2] - v[0]];
        let given = [[x1, y1], [x2, y2]];
        if !self.unwrap {
            return given;
        }
        let [a, b, c] = self.turns(u);
        let unwrapped = [[x1 + (b - a), y1], [x2 + (c - a), y2]];
        if mikktspace_area(unwrapped) == 0.0 { given } else { unwrapped }
    }

    /// What unwrapping adds to the scaled u of three corners: a whole texture to those that are more than half of one
    /// behind the greatest.
    #[inline(always)]
    fn turns(&self, [a, b, c]: [f32; 3]) -> [f32; 3] {
        let turn = if self.spans([a, b, c]) { self.texcoord_scale } else { 0.0 };
        let behind = a.max(b).max(c) - 0.5 * self.texcoord_scale;
        let turn_of = |coordinate: f32| if coordinate < behind { turn } else { 0.0 };
        [turn_of(a), turn_of(b), turn_of(c)]
    }

    /// Whether the scaled u of three corners spans more than half the texture, and not more than all.
    #[inline(always)]
    fn spans(&self, [a, b, c]: [f32; 3]) -> bool {
        let span = a.max(b).max(c) - a.min(b).min(c);
        (span > 0.5 * self.texcoord_scale) & (span <= self.texcoord_scale)
    }

    /// Whether u of a triangle with these texture coordinates, which are the mesh's, spans more than half the texture,
    /// and not more than all: it may have jumped from 1 to 0.
    #[inline(always)]
    pub fn jumps(&self, [[a, _], [b, _], [c, _]]: [[f32; 2]; 3]) -> bool {
        let scale = self.texcoord_scale;
        self.spans([a * scale, b * scale, c * scale])
    }
}

/// The power of two that brings the greatest magnitude between 2^20 and 2^21.
pub(super) fn scale<const N: usize>(vectors: &[[f32; N]]) -> f32 {
    // Magnitudes are in the order of their bits.
    let greatest = |values: &[f32]| values.iter().fold(0, |greatest, value| value.abs().to_bits().max(greatest));
    let greatest = of_pieces(vectors, |_, vectors| greatest(vectors.as_flattened())).into_iter().max().unwrap_or(0);
    let exponent = (greatest >> 23) as i32 - 127;
    2f32.powi((20 - exponent).min(126))
}

#[cfg(test)]
mod tests {
    use super::scale;

    #[test]
    fn the_scale_is_a_power_of_two_at_any_size() {
        assert_eq!(scale(&[[0.0, -1.5, 1.0]]), 2f32.powi(20));
        assert_eq!(scale(&[[3.0e20]]), 2f32.powi(20 - 68));
        assert_eq!(scale(&[[f32::MAX]]), 2f32.powi(20 - 127));
        assert_eq!(scale(&[[1e-35]]), 2f32.powi(126));
        assert_eq!([scale::<2>(&[]), scale(&[[0.0]])], [2f32.powi(126); 2]);
    }
}
