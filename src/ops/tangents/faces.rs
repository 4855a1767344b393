//! What is decided, and counted, for each triangle alone.

use super::pieces::of_pieces_mut;
use super::{Surface, cross, handedness, is_zero, scaled_to_one};

/// The handedness of every triangle, and how many have none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Faces {
    /// See [`handedness`].
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
            for (triangle, handedness) in (first..).zip(handedness) {
                *handedness = counts.count(surface, triangle);
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

impl FaceCounts {
    /// Counts a triangle, and tells its handedness.
    #[inline(always)]
    fn count(&mut self, surface: &Surface<'_>, triangle: usize) -> i8 {
        let edges = surface.edges(triangle);
        let handedness = handedness([edges.d1, edges.d2]);
        self.without_area += usize::from(is_zero(cross(scaled_to_one(edges.e1), scaled_to_one(edges.e2))));
        self.without_texture_area += usize::from(handedness == 0);
        self.mirrored += usize::from(handedness < 0);
        self.unwrapped += usize::from(surface.is_unwrapped(triangle));
        handedness
    }

    fn plus(self, other: Self) -> Self {
        Self {
            without_area: self.without_area + other.without_area,
            without_texture_area: self.without_texture_area + other.without_texture_area,
            unwrapped: self.unwrapped + other.unwrapped,
            mirrored: self.mirrored + other.mirrored,
        }
    }
}
