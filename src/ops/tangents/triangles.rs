//! A block of triangles, gathered.

#![expect(clippy::needless_range_loop, reason = "an index for all planes of a lane")]

use super::{Surface, TriangleEdges};

/// Triangles or fans of a block: their numbers, planar, stay in the first cache.
pub(crate) const BLOCK: usize = 64;

/// A number for each triangle or fan of a block.
pub(crate) type Plane = [f32; BLOCK];

/// Positions and texture coordinates of a block of triangles, as the mesh has them; beyond the last triangle those of
/// any other, or zeros.
pub(crate) struct Triangles {
    positions: [[Plane; 3]; 3],
    texcoords: [[Plane; 2]; 3],
}

impl Default for Triangles {
    fn default() -> Self {
        Self { positions: [[[0.0; BLOCK]; 3]; 3], texcoords: [[[0.0; BLOCK]; 2]; 3] }
    }
}

impl Triangles {
    /// Takes the triangles from `first`.
    #[inline(always)]
    pub fn gather(&mut self, surface: &Surface<'_>, first: usize) {
        for (i, &triangle) in surface.triangles[first..].iter().take(BLOCK).enumerate() {
            self.set(i, surface, triangle);
        }
    }

    /// Takes a triangle of these vertices.
    #[inline(always)]
    pub fn set(&mut self, i: usize, surface: &Surface<'_>, triangle: [u32; 3]) {
        for corner in 0..3 {
            let position = surface.positions[triangle[corner] as usize];
            for axis in 0..3 {
                self.positions[corner][axis][i] = position[axis];
            }
            let texcoord = surface.texcoords[triangle[corner] as usize];
            for axis in 0..2 {
                self.texcoords[corner][axis][i] = texcoord[axis];
            }
        }
    }

    /// The edges of a triangle, scaled.
    #[inline(always)]
    pub fn edges(&self, surface: &Surface<'_>, i: usize) -> TriangleEdges {
        let positions = [self.position(0, i), self.position(1, i), self.position(2, i)];
        surface.edges_between(positions, self.texcoords(i))
    }

    /// The texture coordinates of a triangle's corners.
    #[inline(always)]
    pub fn texcoords(&self, i: usize) -> [[f32; 2]; 3] {
        let [a, b, c] = &self.texcoords;
        [[a[0][i], a[1][i]], [b[0][i], b[1][i]], [c[0][i], c[1][i]]]
    }

    /// The position of a triangle's corner.
    #[inline(always)]
    pub fn position(&self, corner: usize, i: usize) -> [f32; 3] {
        let [x, y, z] = &self.positions[corner];
        [x[i], y[i], z[i]]
    }
}
