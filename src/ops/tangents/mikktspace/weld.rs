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

/// Parts of the range of hashes, each with a table that fits a core's cache.
const PARTS: usize = 256;
/// Vertices whose attributes and table fit a core's cache.
const BLOCK: usize = 1 << 14;

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
/// Equal vertices are most often near each other: blocks of vertices are searched first, then parts of what is left
/// by hashes. Those of a part lie anywhere, so they are stored atomically; each has one writer.
fn lowest_equals(surface: &Surface<'_>) -> Vec<u32> {
    let attributes = |vertex: u32| {
        let vertex = vertex as usize;
        let ([x, y, z], [a, b, c]) = (surface.positions[vertex], surface.normals[vertex]);
        let [u, v] = surface.texcoords[vertex];
        [x, y, z, a, b, c, u, v]
    };
    let equals = |a: u32, b: u32| attributes(a) == attributes(b);
    let vertices = surface.positions.len() as u32;
    let mut of_blocks: Vec<u32> = (0..vertices).into_par_iter().collect();
    let blocks: Vec<Parted> = of_blocks
        .par_chunks_mut(BLOCK)
        .map_init(Table::default, |table, block| {
            table.clear(block.len());
            let mut rest = Vec::with_capacity(block.len());
            for lowest in block {
                let vertex = *lowest;
                let hash = hash(attributes(vertex));
                *lowest = table.first(hash as usize, (hash, vertex), equals);
                if *lowest == vertex {
                    rest.push((hash, vertex));
                }
            }
            Parted::new(&rest)
        })
        .collect();

    let of_parts: Vec<AtomicU32> = (0..vertices).into_par_iter().map(AtomicU32::new).collect();
    (0..PARTS).into_par_iter().for_each_init(Table::default, |table, part| {
        table.clear(blocks.iter().map(|block| block.part(part).len()).sum());
        for &(hash, vertex) in blocks.iter().flat_map(|block| block.part(part)) {
            let first = table.first(hash as usize / PARTS, (hash, vertex), equals);
            of_parts[vertex as usize].store(first, Ordering::Relaxed);
        }
    });
    of_blocks.par_iter_mut().for_each(|lowest| *lowest = of_parts[*lowest as usize].load(Ordering::Relaxed));
    of_blocks
}

/// Vertices by hashes, with open addressing.
#[derive(Default)]
struct Table {
    /// A hash and its vertex, or [`FREE`].
    slots: Vec<(u32, u32)>,
}

/// No vertex: a mesh has fewer.
const FREE: u32 = u32::MAX;

impl Table {
    /// Empties it, with room for some vertices.
    fn clear(&mut self, vertices: usize) {
        self.slots.clear();
        self.slots.resize((2 * vertices).next_power_of_two(), (0, FREE));
    }

    /// The vertex that equals one with its hash, or that one itself, which is then in the table. The search begins at
    /// a slot given by some bits of the hash.
    #[inline(always)]
    fn first(&mut self, mut slot: usize, (hash, vertex): (u32, u32), equals: impl Fn(u32, u32) -> bool) -> u32 {
        loop {
            slot &= self.slots.len() - 1;
            let (its_hash, first) = self.slots[slot];
            if first == FREE {
                self.slots[slot] = (hash, vertex);
                return vertex;
            }
            if its_hash == hash && equals(first, vertex) {
                return first;
            }
            slot += 1;
        }
    }
}

/// Hashes and their vertices, those of each part together, else in ascending order.
struct Parted {
    sorted: Vec<(u32, u32)>,
    ends: [u32; PARTS],
}

impl Parted {
    fn new(entries: &[(u32, u32)]) -> Self {
        let mut ends = [0; PARTS];
        for (hash, _) in entries {
            ends[*hash as usize % PARTS] += 1;
        }
        let mut begin = 0;
        for end in &mut ends {
            (begin, *end) = (begin + *end, begin);
        }
        let mut sorted = vec![(0, 0); entries.len()];
        for &entry in entries {
            let next = &mut ends[entry.0 as usize % PARTS];
            sorted[*next as usize] = entry;
            *next += 1;
        }
        Self { sorted, ends }
    }

    fn part(&self, part: usize) -> &[(u32, u32)] {
        let begin = part.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.sorted[begin as usize..self.ends[part] as usize]
    }
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
