//! The handedness of triangles that have no direction: the first group that reaches one decides.
//!
//! Groups begin at corners in ascending order, so this is the one step that has to look at the mesh as a whole; but
//! only around the welds where such triangles are.

use super::Fabric;
use super::faces::Role;
use super::rings::{NONE, Ring};
use rayon::prelude::*;

/// Gives a handedness to each triangle of [`Role::Anything`] that a group reaches.
pub(super) fn orient_anything(fabric: &mut Fabric<'_>) {
    let welds = welds_of_anything(fabric);
    if welds.is_empty() {
        return;
    }
    let around: Vec<Around> = {
        let fabric = &*fabric;
        let blocks = welds.par_chunks(BLOCK);
        blocks.map_init(Ring::default, |ring, welds| Around::new(fabric, ring, welds)).collect()
    };
    // Of corners: the one across each edge, plus one; zero where there is none.
    let (mut next, mut previous) = (vec![0; 3 * fabric.faces.len()], vec![0; 3 * fabric.faces.len()]);
    for &(from, to) in around.iter().flat_map(|around| &around.links) {
        next[from as usize] = to + 1;
        previous[to as usize] = from + 1;
    }
    let mut starts: Vec<u32> = around.iter().flat_map(|around| &around.starts).copied().collect();
    starts.par_sort_unstable();

    let mut is_assigned = vec![false; 3 * fabric.faces.len()];
    for start in starts {
        if is_assigned[start as usize] {
            continue;
        }
        is_assigned[start as usize] = true;
        let is_positive = fabric.faces[start as usize / 3].is_positive;
        for links in [&next, &previous] {
            let mut corner = start;
            while let Some(across) = links[corner as usize].checked_sub(1) {
                let face = &mut fabric.faces[across as usize / 3];
                let joins = face.is_positive.is_none() || face.is_positive == is_positive;
                if is_assigned[across as usize] || !joins {
                    break;
                }
                face.is_positive = is_positive;
                is_assigned[across as usize] = true;
                corner = across;
            }
        }
    }
}

/// Welds of one task.
const BLOCK: usize = 1024;

/// What lies around some welds.
struct Around {
    /// Corners, and those across the edges from them.
    links: Vec<(u32, u32)>,
    /// Corners at which groups may begin.
    starts: Vec<u32>,
}

impl Around {
    fn new(fabric: &Fabric<'_>, ring: &mut Ring, welds: &[u32]) -> Self {
        let mut this = Self { links: Vec::new(), starts: Vec::new() };
        for &weld in welds {
            ring.set(fabric, weld);
            for (&corner, &at) in ring.corners.iter().zip(&ring.next) {
                if at != NONE {
                    this.links.push((corner, ring.corners[at as usize]));
                }
                if fabric.faces[corner as usize / 3].role == Role::Directed {
                    this.starts.push(corner);
                }
            }
        }
        this
    }
}

/// The welds of all such triangles.
fn welds_of_anything(fabric: &Fabric<'_>) -> Vec<u32> {
    let faces = fabric.faces.par_iter().zip(fabric.welds.triangles.par_iter());
    let mut welds: Vec<u32> =
        faces.filter(|(face, _)| face.role == Role::Anything).flat_map_iter(|(_, &welds)| welds).collect();
    welds.par_sort_unstable();
    welds.dedup();
    welds
}
