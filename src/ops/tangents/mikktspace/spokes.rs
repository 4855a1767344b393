//! Whether a weld is of the common kind: one manifold fan or ring of triangles that go together.

use super::Fabric;
use super::faces::{Face, Role};

/// A corner at a weld.
#[derive(Clone, Copy)]
pub(super) struct Spoke {
    /// The weld that the edge from the corner leads to.
    to: u32,
    /// The weld that the edge to the corner comes from.
    from: u32,
    face: Face,
}

impl Spoke {
    #[inline(always)]
    pub fn of(fabric: &Fabric<'_>, corner: u32) -> Self {
        let [to, from] = fabric.welds.beside(corner);
        Self { to, from, face: fabric.faces[corner as usize / 3] }
    }
}

vectorised! {
    /// Which of the welds from `first` are plainly one fan; their spokes lie between the offsets, less the first one.
    pub(super) fn find_plain_fans(
        fabric: &Fabric<'_>,
        first: u32,
        offsets: &[u32],
        spokes: &[Spoke],
        is_plain: &mut [bool],
    ) {
        for ((weld, ends), is_plain) in (first..).zip(offsets.windows(2)).zip(is_plain) {
            let spokes = &spokes[(ends[0] - offsets[0]) as usize..(ends[1] - offsets[0]) as usize];
            *is_plain = is_plainly_one_fan(spokes, fabric.normal(weld));
        }
    }
}

/// Whether all corners at a weld are directed, far from opposite and linked to one group, each edge to one other.
///
/// `false` may also mean that it takes more to tell.
#[inline(always)]
fn is_plainly_one_fan(spokes: &[Spoke], n: [f32; 3]) -> bool {
    match spokes.len() {
        0 => true,
        1..=8 => is_one_fan::<8>(spokes, n),
        9..=16 => is_one_fan::<16>(spokes, n),
        _ => false,
    }
}

#[inline(always)]
fn is_one_fan<const LANES: usize>(spokes: &[Spoke], n: [f32; 3]) -> bool {
    let first = spokes[0].face;
    let projected = first.projected(n);
    // No weld has these numbers.
    let (mut to, mut from) = ([u32::MAX; LANES], [u32::MAX - 1; LANES]);
    let mut agrees = first.role == Role::Directed;
    for ((spoke, to), from) in spokes.iter().zip(&mut to).zip(&mut from) {
        (*to, *from) = (spoke.to, spoke.from);
        let Face { role, is_positive, .. } = spoke.face;
        agrees &= (role == Role::Directed) & (is_positive == first.is_positive) & spoke.face.agrees(&projected);
    }
    agrees && is_one_chain(&to, &from, spokes.len())
}

/// Whether corners are one chain or ring of which each has one neighbour at most across each of its edges.
///
/// If two corners could take a third one for a neighbour, the walk finds two at once or comes back to the third.
#[inline(always)]
fn is_one_chain<const LANES: usize>(to: &[u32; LANES], from: &[u32; LANES], count: usize) -> bool {
    let all = u32::MAX >> (32 - count);
    let mut reached = 1;
    for (own, others) in [(to, from), (from, to)] {
        let mut at = 0;
        loop {
            let across = places(others, own[at]);
            if across == 0 {
                break;
            }
            if across & reached != 0 {
                return across == 1 && reached == all;
            }
            if !across.is_power_of_two() {
                return false;
            }
            reached |= across;
            at = across.trailing_zeros() as usize;
        }
    }
    reached == all
}

/// A bit for each place of a value.
#[inline(always)]
fn places<const LANES: usize>(values: &[u32; LANES], value: u32) -> u32 {
    let mut places = 0;
    for (place, &other) in values.iter().enumerate() {
        places |= u32::from(other == value) << place;
    }
    places
}
