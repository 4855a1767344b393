//! Vertices with equal attributes become one.

use super::Surface;
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::atomic::{AtomicU32, Ordering};

/// Classes of vertices whose position, normal and texture coordinates are equal (-0 = 0), in the order of their
/// lowest vertices.
pub(super) struct Welds<'a> {
    /// The welds of each triangle.
    pub triangles: Cow<'a, [[u32; 3]]>,
    /// The lowest vertex of each weld; `None` if each vertex is one of its own.
    vertices: Option<Vec<u32>>,
    count: usize,
}

/// Parts of the range of hashes, each for one task with a table that fits a core's cache.
const PARTS: u32 = 16;

impl<'a> Welds<'a> {
    pub fn new(surface: &'a Surface<'a>) -> Self {
        let lowest = lowest_equals(surface);
        let is_lowest = |&vertex: &u32| lowest[vertex as usize] == vertex;
        let vertices: Vec<u32> = (0..lowest.len() as u32).into_par_iter().filter(is_lowest).collect();
        if vertices.len() == lowest.len() {
            return Self { triangles: Cow::Borrowed(surface.triangles), vertices: None, count: lowest.len() };
        }
        let mut welds = vec![0; lowest.len()];
        for (&vertex, weld) in vertices.iter().zip(0..) {
            welds[vertex as usize] = weld;
        }
        let weld = |vertex: u32| welds[lowest[vertex as usize] as usize];
        let triangles = surface.triangles.par_iter().map(|&[a, b, c]| [weld(a), weld(b), weld(c)]).collect();
        Self { triangles: Cow::Owned(triangles), count: vertices.len(), vertices: Some(vertices) }
    }

    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether nothing was welded.
    pub fn are_vertices(&self) -> bool {
        self.vertices.is_none()
    }

    /// The lowest vertex of a weld.
    #[inline(always)]
    pub fn vertex(&self, weld: u32) -> u32 {
        self.vertices.as_ref().map_or(weld, |vertices| vertices[weld as usize])
    }

    /// The lowest vertex of each weld.
    pub fn vertices(&self) -> Vec<u32> {
        self.vertices.clone().unwrap_or_else(|| (0..self.count as u32).collect())
    }

    /// The weld of a corner.
    #[inline(always)]
    pub fn of(&self, corner: u32) -> u32 {
        self.triangles[corner as usize / 3][corner as usize % 3]
    }

    /// The welds that a corner's edges lead to: of the next corner of its triangle, and of the one before.
    #[inline(always)]
    pub fn beside(&self, corner: u32) -> [u32; 2] {
        let [a, b, c] = self.triangles[corner as usize / 3];
        match corner % 3 {
            0 => [b, c],
            1 => [c, a],
            _ => [a, b],
        }
    }
}

/// The lowest vertex with the same attributes, for each vertex.
///
/// Each task takes the vertices whose hashes lie in its part, in ascending order. They lie anywhere, so the results
/// are stored atomically; each has one writer.
fn lowest_equals(surface: &Surface<'_>) -> Vec<u32> {
    let vertices = surface.positions.len();
    let attributes = |vertex: u32| {
        let vertex = vertex as usize;
        let ([x, y, z], [a, b, c]) = (surface.positions[vertex], surface.normals[vertex]);
        let [u, v] = surface.texcoords[vertex];
        [x, y, z, a, b, c, u, v]
    };
    let hashes: Vec<u32> = (0..vertices as u32).into_par_iter().map(|vertex| hash(attributes(vertex))).collect();
    let lowest: Vec<AtomicU32> = (0..vertices as u32).into_par_iter().map(AtomicU32::new).collect();
    (0..PARTS).into_par_iter().for_each(|part| {
        let is_own = |hash: u32| hash % PARTS == part;
        let own = hashes.iter().filter(|&&hash| is_own(hash)).count();
        let slots = (2 * own).next_power_of_two();
        // A hash and its vertex; u64::MAX where there is none, for no mesh has that many vertices.
        let mut table = vec![u64::MAX; slots];
        for (vertex, &hash) in (0..).zip(&hashes).filter(|&(_, &hash)| is_own(hash)) {
            let mut slot = (hash / PARTS) as usize & (slots - 1);
            loop {
                let entry = table[slot];
                if entry == u64::MAX {
                    table[slot] = u64::from(hash) << 32 | u64::from(vertex);
                    break;
                }
                if (entry >> 32) as u32 == hash && attributes(entry as u32) == attributes(vertex) {
                    lowest[vertex as usize].store(entry as u32, Ordering::Relaxed);
                    break;
                }
                slot = (slot + 1) & (slots - 1);
            }
        }
    });
    lowest.into_iter().map(AtomicU32::into_inner).collect()
}

/// Of equal attributes, equal; of others, most likely not.
#[inline(always)]
fn hash(attributes: [f32; 8]) -> u32 {
    let mut hash = 0u64;
    for attribute in attributes {
        // Minus zero is zero.
        hash = (hash.rotate_left(23) ^ u64::from((attribute + 0.0).to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    ((hash ^ (hash >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 32) as u32
}
