//! MikkTSpace's method: a share for each corner, in the order of the fans, and their sums.
//!
//! A triangle's frame is computed at each of its corners: that takes less time than to store and to fetch it.

#![expect(clippy::needless_range_loop, reason = "an index for all planes of a lane")]

use super::fill_blocks;
use crate::exact::{acos, acos_estimate, is_in_doubt};
use crate::ops::tangents::{
    BLOCK, Fans, Plane, Surface, TangentMethod, TangentPlan, Triangles, frame, mikktspace_area, mikktspace_cosine,
    project, sign, unit,
};
use crate::vector::times;

/// Where the shares of a block of corners are computed.
struct Room {
    /// Those of each corner's triangle.
    vertices: [[u32; 3]; BLOCK],
    triangles: Triangles,
    /// Which corner of its triangle each is.
    places: [u32; BLOCK],
    /// The normals of the corners' fans.
    normals: [Plane; 3],
    angles: Plane,
    /// What each corner adds to its fan's tangent.
    shares: [Plane; 3],
    /// The handedness of each corner's triangle.
    signs: Plane,
}

impl Default for Room {
    fn default() -> Self {
        Self {
            vertices: [[0; 3]; BLOCK],
            triangles: Triangles::default(),
            places: [0; BLOCK],
            normals: [[0.0; BLOCK]; 3],
            angles: [0.0; BLOCK],
            shares: [[0.0; BLOCK]; 3],
            signs: [0.0; BLOCK],
        }
    }
}

/// The tangent of each fan.
pub(super) fn tangents(plan: &TangentPlan<'_>, tangents: &mut [[f32; 4]]) {
    fill_blocks(tangents, |first, tangents| tangents_of_block(plan.surface, plan.fans, first, tangents));
}

vectorised! {
    /// The tangents of the fans from `first`.
    fn tangents_of_block(surface: &Surface<'_>, fans: &Fans<'_>, first: usize, tangents: &mut [[f32; 4]]) {
        let mut room = Room::default();
        let mut sums: [Plane; 3] = [[0.0; BLOCK]; 3];
        // Without a corner: as reference.rs has it.
        let mut signs = [-1.0; BLOCK];
        let offsets = &fans.corners.offsets()[first..=first + tangents.len()];
        let (mut fan, end) = (0, offsets[tangents.len()] as usize);
        let mut begin = offsets[0] as usize;
        while begin < end {
            let corners = &fans.corners.corners()[begin..end.min(begin + BLOCK)];
            let mut fan_of = [0; BLOCK];
            // A loop of its own, so short that the processor runs many turns at once: it waits for memory.
            for (i, &corner) in corners.iter().enumerate() {
                room.vertices[i] = surface.triangles[corner as usize / 3];
            }
            for (i, &corner) in corners.iter().enumerate() {
                while offsets[fan + 1] as usize <= begin + i {
                    fan += 1;
                }
                fan_of[i] = fan;
                room.set(i, surface, corner, surface.normals[fans.vertex(first + fan)]);
            }
            room.find_shares(surface);
            for i in 0..corners.len() {
                let fan = fan_of[i];
                for axis in 0..3 {
                    sums[axis][fan] += room.shares[axis][i];
                }
                if offsets[fan] as usize == begin + i {
                    signs[fan] = room.signs[i];
                }
            }
            begin += BLOCK;
        }
        for i in 0..BLOCK {
            [sums[0][i], sums[1][i], sums[2][i]] = unit([sums[0][i], sums[1][i], sums[2][i]]);
        }
        for i in 0..tangents.len().min(BLOCK) {
            tangents[i] = [sums[0][i], sums[1][i], sums[2][i], signs[i]];
        }
    }
}

impl Room {
    /// Takes a corner, whose vertices are known, of a fan with this normal.
    #[inline(always)]
    fn set(&mut self, i: usize, surface: &Surface<'_>, corner: u32, normal: [f32; 3]) {
        self.triangles.set(i, surface, self.vertices[i]);
        self.places[i] = corner % 3;
        for axis in 0..3 {
            self.normals[axis][i] = normal[axis];
        }
    }

    #[inline(always)]
    fn find_shares(&mut self, surface: &Surface<'_>) {
        self.find_cosines(surface.position_scale);
        cosines_to_angles(&mut self.angles);
        for i in 0..BLOCK {
            let edges = self.triangles.edges(surface, i);
            let s = frame(TangentMethod::Mikktspace, &edges).t;
            let share = times(self.angles[i], unit(project(self.normal(i), s)));
            [self.shares[0][i], self.shares[1][i], self.shares[2][i]] = share;
            self.signs[i] = sign(mikktspace_area([edges.d1, edges.d2]));
        }
    }

    /// The cosine of the angle at each corner.
    #[inline(always)]
    fn find_cosines(&mut self, scale: f32) {
        for i in 0..BLOCK {
            let position = |corner| times(scale, self.triangles.position(corner, i));
            let (a, b, c) = (position(0), position(1), position(2));
            let place = self.places[i];
            let own = if place == 0 {
                a
            } else if place == 1 {
                b
            } else {
                c
            };
            let next = if place == 0 {
                b
            } else if place == 1 {
                c
            } else {
                a
            };
            let previous = if place == 0 {
                c
            } else if place == 1 {
                a
            } else {
                b
            };
            self.angles[i] = mikktspace_cosine(self.normal(i), [own, next, previous]);
        }
    }

    #[inline(always)]
    fn normal(&self, i: usize) -> [f32; 3] {
        [self.normals[0][i], self.normals[1][i], self.normals[2][i]]
    }
}

/// Estimates the angles, and where that leaves doubt, computes them in integers.
#[inline(always)]
fn cosines_to_angles(angles: &mut Plane) {
    let cosines = *angles;
    let mut doubts = 0;
    for i in 0..BLOCK {
        let estimate = acos_estimate(cosines[i]);
        angles[i] = estimate as f32;
        doubts += u32::from(is_in_doubt(estimate));
    }
    if doubts > 0 {
        for i in 0..BLOCK {
            angles[i] = acos(cosines[i]);
        }
    }
}
