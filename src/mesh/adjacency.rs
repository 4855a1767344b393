//! Which corners of triangles meet at a vertex.

use super::Mesh;
use rayon::prelude::*;
use std::ops::Range;

/// Rows of corners in compressed form: row r holds `corners[offsets[r]..offsets[r + 1]]`, ascending.
///
/// Corner 3t + i is corner i of triangle t. With a row for each vertex, a reduction over a vertex's triangles needs
/// no atomics: its order is the row's, whatever runs it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CornerAdjacency {
    offsets: Vec<u32>,
    corners: Vec<u32>,
}

/// Corners that one thread sorts in less time than it takes to wake others.
const FEW: usize = 1 << 16;

/// At most as many buckets are filled at a time: as many pages and cache lines are at hand.
const BUCKETS: usize = 256;

/// Buckets have 2^this vertices or more.
const LEAST_SHIFT: u32 = 8;

impl CornerAdjacency {
    /// The corners of each vertex of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        Self::of_vertices(mesh.triangles(), mesh.positions().len())
    }

    /// The corners of each of `vertices` vertices, by a parallel counting sort.
    ///
    /// Threads first deal the corners of a part of the triangles each to buckets of neighbouring vertices, then put the
    /// buckets' corners into rows. A bucket stays in a cache, so the order of the triangles matters little.
    ///
    /// # Panics
    /// If a triangle has a vertex that is not below `vertices`; [`crate::Mesh`] has checked that.
    pub(crate) fn of_vertices(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let indices = triangles.as_flattened();
        let mut offsets = vec![0; vertices + 1];
        let mut corners = vec![0; indices.len()];
        if indices.len() <= FEW {
            let entries = (0..).zip(indices).map(|(corner, &vertex)| (vertex, corner));
            sort_into_rows(0, entries, 0, &mut offsets[1..], &mut corners);
            return Self { offsets, corners };
        }

        let shift = (LEAST_SHIFT..).find(|shift| vertices >> shift < BUCKETS).unwrap_or(u32::BITS);
        let part_length = indices.len().div_ceil(4 * rayon::current_num_threads());
        let parts = indices.par_chunks(part_length).enumerate();
        let parts: Vec<Part> = parts.map(|(part, indices)| Part::of(part * part_length, indices, shift)).collect();

        let mut buckets = Vec::new();
        let (mut base, mut rest) = (0, corners.as_mut_slice());
        for (bucket, ends) in offsets[1..].chunks_mut(1 << shift).enumerate() {
            let (own, others) = rest.split_at_mut(parts.iter().map(|part| part.bucket(bucket).len()).sum());
            let count = own.len() as u32;
            buckets.push((bucket, base, ends, own));
            (base, rest) = (base + count, others);
        }
        buckets.into_par_iter().for_each(|(bucket, base, ends, own)| {
            let entries = parts.iter().flat_map(|part| part.bucket(bucket)).copied();
            sort_into_rows((bucket as u32) << shift, entries, base, ends, own);
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

    /// The same with other corners, ascending, in some rows, which are named in ascending order; and with more rows at
    /// the end.
    pub(crate) fn with_rows<R: IntoIterator<Item = u32>, A: IntoIterator<Item = u32>>(
        &self,
        replaced: impl IntoIterator<Item = (usize, R)>,
        added: impl IntoIterator<Item = A>,
    ) -> Self {
        let mut offsets = Vec::with_capacity(self.offsets.len());
        let mut corners = Vec::with_capacity(self.corners.len());
        offsets.push(0);
        // The rows up to a replaced one are copied in one piece.
        let copy = |rows: Range<usize>, offsets: &mut Vec<u32>, corners: &mut Vec<u32>| {
            let [begin, end] = [self.offsets[rows.start], self.offsets[rows.end]];
            let base = corners.len() as u32;
            offsets.extend(self.offsets[rows.start + 1..=rows.end].iter().map(|row_end| row_end - begin + base));
            corners.extend_from_slice(&self.corners[begin as usize..end as usize]);
        };
        let mut next = 0;
        for (row, row_corners) in replaced {
            copy(next..row, &mut offsets, &mut corners);
            corners.extend(row_corners);
            offsets.push(corners.len() as u32);
            next = row + 1;
        }
        copy(next..self.rows(), &mut offsets, &mut corners);
        for row_corners in added {
            corners.extend(row_corners);
            offsets.push(corners.len() as u32);
        }
        Self::from_rows(offsets, corners)
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

/// Vertices and corners of a part of the triangles, by buckets of 2^shift vertices; ascending corners in each.
struct Part {
    offsets: Vec<usize>,
    entries: Vec<(u32, u32)>,
}

impl Part {
    /// Of the corners from `first`, whose vertices are `indices`.
    fn of(first: usize, indices: &[u32], shift: u32) -> Self {
        // The last one is for the end.
        let mut offsets = vec![0; BUCKETS + 1];
        indices.iter().for_each(|vertex| offsets[1 + (vertex >> shift) as usize] += 1);
        for bucket in 0..BUCKETS {
            offsets[bucket + 1] += offsets[bucket];
        }
        let mut next = offsets.clone();
        let mut entries = vec![(0, 0); indices.len()];
        for (corner, &vertex) in (first as u32..).zip(indices) {
            let next = &mut next[(vertex >> shift) as usize];
            entries[*next] = (vertex, corner);
            *next += 1;
        }
        Self { offsets, entries }
    }

    fn bucket(&self, bucket: usize) -> &[(u32, u32)] {
        &self.entries[self.offsets[bucket]..self.offsets[bucket + 1]]
    }
}

/// Puts corners of the vertices from `first` into rows: where each ends, counted from `base`, and its corners.
fn sort_into_rows(
    first: u32,
    entries: impl Iterator<Item = (u32, u32)> + Clone,
    base: u32,
    ends: &mut [u32],
    corners: &mut [u32],
) {
    entries.clone().for_each(|(vertex, _)| ends[(vertex - first) as usize] += 1);
    let mut end = 0;
    let mut next = Vec::with_capacity(ends.len());
    for row_end in ends {
        next.push(end);
        end += *row_end;
        *row_end = base + end;
    }
    entries.for_each(|(vertex, corner)| {
        let next = &mut next[(vertex - first) as usize];
        corners[*next as usize] = corner;
        *next += 1;
    });
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
    fn rows_are_replaced_and_added() {
        let adjacency = CornerAdjacency::of_vertices(&[[0, 1, 2], [2, 1, 4], [4, 1, 0]], 6);
        let changed = adjacency.with_rows([(0, vec![8]), (1, vec![4, 7, 9])], [vec![0], vec![]]);
        let rows: Vec<&[u32]> = (0..changed.rows()).map(|row| changed.row(row)).collect();
        assert_eq!(rows, [&[8][..], &[4, 7, 9], &[2, 3], &[], &[5, 6], &[], &[0], &[]]);
        let unchanged = adjacency.with_rows(None::<(usize, Vec<u32>)>, None::<Vec<u32>>);
        assert_eq!(unchanged, adjacency);
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let scrambled = |n: u32| n.wrapping_mul(0x9e37_79b1) >> 8;
        for vertices in [1, 255, 701, 70_001] {
            let triangles: Vec<[u32; 3]> =
                (0..40_000).map(|t| [3 * t, 3 * t + 1, 3 * t + 2].map(|n| scrambled(n) % vertices)).collect();
            let mut expected = vec![Vec::new(); vertices as usize];
            (0..).zip(triangles.as_flattened()).for_each(|(corner, &vertex)| expected[vertex as usize].push(corner));
            for threads in [1, 2, 7, 64] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let adjacency = pool.install(|| CornerAdjacency::of_vertices(&triangles, vertices as usize));
                let rows: Vec<&[u32]> = (0..adjacency.rows()).map(|row| adjacency.row(row)).collect();
                assert!(rows == expected, "{vertices} vertices, {threads} threads");
            }
        }
    }
}
