//! What is decided, and counted, for each triangle alone.

use super::pieces::of_pieces_mut;
use super::{BLOCK, Surface, Triangles, cross, is_zero, scaled_to_one};

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
    pub unwrapped: usize,
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
        let wrapped = Surface { unwrap: false, ..*surface };
        let mut signs = [0; BLOCK];
        let mut is_flat = [false; BLOCK];
        let mut is_unwrapped = [false; BLOCK];
        for i in 0..BLOCK {
            let edges = triangles.edges(surface, i);
            signs[i] = super::handedness([edges.d1, edges.d2]);
            is_flat[i] = is_zero(cross(scaled_to_one(edges.e1), scaled_to_one(edges.e2)));
            is_unwrapped[i] = edges != triangles.edges(&wrapped, i);
        }
        for (i, handedness) in handedness.iter_mut().enumerate().take(BLOCK) {
            *handedness = signs[i];
            counts.without_area += usize::from(is_flat[i]);
            counts.without_texture_area += usize::from(signs[i] == 0);
            counts.mirrored += usize::from(signs[i] < 0);
            counts.unwrapped += usize::from(is_unwrapped[i]);
        }
    }
}

impl FaceCounts {
    fn plus(self, other: Self) -> Self {
        Self {
            without_area: self.without_area + other.without_area,
            without_texture_area: self.without_texture_area + other.without_texture_area,
            unwrapped: self.unwrapped + other.unwrapped,
            mirrored: self.mirrored + other.mirrored,
        }
    }
}
