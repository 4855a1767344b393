//! What is decided, and counted, for each triangle alone.

use super::pieces::of_pieces_mut;
use super::{BLOCK, Surface, Triangles, is_zero, scaled_to_one};
use crate::vector::cross;

/// The handedness of every triangle, and how many have none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Faces {
    /// See [`super::handedness`].
    pub handedness: Vec<i8>,
    pub counts: FaceCounts,
}

/// Triangles of a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct FaceCounts {
    /// Their edges have one direction, or none.
    pub without_area: usize,
    pub without_texture_area: usize,
    pub jumps: usize,
    pub mirrored: usize,
}

impl Faces {
    /// Looks at every triangle.
    pub fn of(surface: &Surface<'_>) -> Self {
        let mut handedness = vec![0; surface.triangles.len()];
        let counts = of_pieces_mut(&mut handedness, |first, handedness| {
            let mut counts = FaceCounts::default();
            let mut triangles = Triangles::default();
            for (block, handedness) in handedness.chunks_mut(BLOCK).enumerate() {
                triangles.gather(surface, first + block * BLOCK);
                look(surface, &triangles, handedness, &mut counts);
            }
            counts
        });
        let counts = counts.into_iter().fold(FaceCounts::default(), FaceCounts::plus);
        Self { handedness, counts }
    }

    /// Whether there are triangles of both handednesses.
    pub fn are_mixed(&self) -> bool {
        let FaceCounts { mirrored, without_texture_area, .. } = self.counts;
        mirrored > 0 && mirrored + without_texture_area < self.handedness.len()
    }
}

vectorised! {
    /// Finds the handedness of a block, and counts.
    fn look(surface: &Surface<'_>, triangles: &Triangles, handedness: &mut [i8], counts: &mut FaceCounts) {
        let mut signs = [0; BLOCK];
        let mut is_flat = [0; BLOCK];
        let mut jumps = [0; BLOCK];
        for i in 0..BLOCK {
            let edges = triangles.edges(surface, i);
            signs[i] = i32::from(super::handedness([edges.d1, edges.d2]));
            is_flat[i] = i32::from(is_zero(cross(scaled_to_one(edges.e1), scaled_to_one(edges.e2))));
            jumps[i] = i32::from(surface.jumps(triangles.texcoords(i)));
        }
        let count = handedness.len().min(BLOCK);
        for i in 0..count {
            handedness[i] = signs[i] as i8;
            counts.without_area += is_flat[i] as usize;
            counts.without_texture_area += usize::from(signs[i] == 0);
            counts.mirrored += usize::from(signs[i] < 0);
            counts.jumps += jumps[i] as usize;
        }
    }
}

impl FaceCounts {
    fn plus(self, other: Self) -> Self {
        Self {
            without_area: self.without_area + other.without_area,
            without_texture_area: self.without_texture_area + other.without_texture_area,
            jumps: self.jumps + other.jumps,
            mirrored: self.mirrored + other.mirrored,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{FaceCounts, Faces};
    use crate::mesh::Mesh;
    use crate::ops::tangents::Surface;

    /// 3000 times the same five triangles: plain, mirrored, without area in space or in the texture, and across the
    /// texture's edge.
    #[test]
    fn triangles_of_each_kind_are_counted() {
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [3.0, 0.0, 0.0], [1.0, 1.0, 1.0]];
        let texcoords = vec![[0.0, 0.25], [0.25, 0.25], [0.0, 0.5], [0.5, 0.25], [0.875, 0.25]];
        let triangles = [[0, 1, 2], [0, 2, 1], [0, 1, 3], [4, 0, 2], [0, 2, 2]].repeat(3000);
        let mesh = Mesh::new(positions, texcoords, triangles).unwrap();
        let normals = [[0.0, 0.0, 1.0]; 5];

        let faces = Faces::of(&Surface::new(&mesh, &normals, true));
        assert!(faces.handedness.chunks(5).all(|five| five == [1, -1, 0, 1, 0]));
        let expected = FaceCounts { without_area: 6000, without_texture_area: 6000, jumps: 3000, mirrored: 3000 };
        assert_eq!(faces.counts, expected);
        assert!(faces.are_mixed());

        let faces = Faces::of(&Surface::new(&mesh, &normals, false));
        assert!(faces.handedness.chunks(5).all(|five| five == [1, -1, 0, -1, 0]));
        assert_eq!(faces.counts, FaceCounts { mirrored: 6000, ..expected });
    }
}
