//! Which corners of triangles meet at a vertex.

use super::Mesh;
use rayon::prelude::*;

/// Rows of corners in compressed form: row r holds `corners[offsets[r]..offsets[r + 1]]`, ascending.
///
/// Corner 3t + i is corner i of triangle t. With a row for each vertex, a reduction over a vertex's triangles needs
/// no atomics: its order is the row's, whatever runs it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CornerAdjacency {
    offsets: Vec<u32>,
    corners: Vec<u32>,
}

impl CornerAdjacency {
    /// The corners of each vertex of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        Self::of_vertices(mesh.triangles(), mesh.positions().len())
    }

    /// The corners of each of `vertices` vertices, by a parallel counting sort: each thread has a range of the
    /// vertices, reads all triangles and writes rows of its own.
    ///
    /// # Panics
    /// If a triangle has a vertex that is not below `vertices`; [`crate::Mesh`] has checked that.
    pub(crate) fn of_vertices(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let indices = triangles.as_flattened();
        let mut offsets = vec![0; vertices + 1];
        let per_thread = vertices.div_ceil(rayon::current_num_threads()).max(1);

        let counts = offsets[1..].par_chunks_mut(per_thread).enumerate();
        counts.for_each(|(thread, counts)| {
            for &vertex in indices {
                if let Some(count) = counts.get_mut((vertex as usize).wrapping_sub(thread * per_thread)) {
                    *count += 1;
                }
            }
        });
        for row in 0..vertices {
            offsets[row + 1] += offsets[row];
        }

        let mut corners = vec![0; indices.len()];
        let mut rest = corners.as_mut_slice();
        let mut rows = Vec::new();
        for first in (0..vertices).step_by(per_thread) {
            let ends = &offsets[first..vertices.min(first + per_thread) + 1];
            let (own, others) = rest.split_at_mut((ends[ends.len() - 1] - ends[0]) as usize);
            rows.push((first, ends, own));
            rest = others;
        }
        rows.into_par_iter().for_each(|(first, ends, own)| {
            let mut next: Vec<u32> = ends[..ends.len() - 1].iter().map(|end| end - ends[0]).collect();
            for (corner, &vertex) in (0..).zip(indices) {
                if let Some(next) = next.get_mut((vertex as usize).wrapping_sub(first)) {
                    own[*next as usize] = corner;
                    *next += 1;
                }
            }
        });
        Self { offsets, corners }
    }

    /// Rows that are already in order.
    ///
    /// `offsets` begins with 0, never falls and ends with the number of corners.
    pub(crate) fn from_rows(offsets: Vec<u32>, corners: Vec<u32>) -> Self {
        debug_assert_eq!((offsets.first(), offsets.last()), (Some(&0), Some(&(corners.len() as u32))));
        debug_assert!(offsets.is_sorted());
        Self { offsets, corners }
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The corners of a row, ascending.
    pub fn row(&self, row: usize) -> &[u32] {
        &self.corners[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }

    /// Where each row begins, and where the last one ends.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// The corners of all rows.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }
}

#[cfg(test)]
mod tests {
    use super::CornerAdjacency;

    #[test]
    fn rows_are_ascending_and_complete() {
        let adjacency = CornerAdjacency::of_vertices(&[[0, 1, 2], [2, 1, 4], [4, 1, 0]], 6);
        let rows: Vec<&[u32]> = (0..adjacency.rows()).map(|row| adjacency.row(row)).collect();
        assert_eq!(rows, [&[0, 8][..], &[1, 4, 7], &[2, 3], &[], &[5, 6], &[]]);
        assert_eq!(CornerAdjacency::of_vertices(&[], 0).rows(), 0);
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let scrambled = |n: u32| n.wrapping_mul(0x9e37_79b1) >> 16;
        let triangles: Vec<[u32; 3]> =
            (0..4000).map(|t| [3 * t, 3 * t + 1, 3 * t + 2].map(|n| scrambled(n) % 701)).collect();
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| CornerAdjacency::of_vertices(&triangles, 701))
        };
        let one = with(1);
        assert_eq!(one.corners().len(), 12000);
        assert!((0..701).all(|row| one.row(row).is_sorted()));
        assert_eq!([with(2), with(7), with(64)], [one.clone(), one.clone(), one]);
    }
}
