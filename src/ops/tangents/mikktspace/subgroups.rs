//! Subgroups: within a group, faces of exactly opposite directions do not contribute to each other's tangents.

use super::Surface;
use crate::ops::tangents::{TangentMethod, frame, project, unit};
use crate::vector::dot;
use std::collections::HashMap;

/// A corner of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Member {
    pub group: u32,
    pub corner: u32,
    pub is_directed: bool,
}

/// Groups of more directed corners than this stay whole: their subgroups could take a square of that in memory.
const LARGEST: usize = 4096;

/// Makes the fans of a group's subgroups; tells the fan of each member.
///
/// Each face takes those whose directions, projected along n and normalised, have cosines above -1 with its own, the
/// reference's default threshold of 180 degrees.
pub(super) fn subgroups(
    surface: &Surface<'_>,
    n: [f32; 3],
    members: &[Member],
    mut add: impl FnMut(Vec<u32>) -> u32,
) -> Vec<(u32, u32)> {
    let directed: Vec<u32> = members.iter().filter(|member| member.is_directed).map(|member| member.corner).collect();
    let is_divided = directed.len() <= LARGEST;
    let projected = |&corner: &u32| {
        let frame = frame(TangentMethod::Mikktspace, &surface.edges(corner as usize / 3));
        (unit(project(n, frame.t)), unit(project(n, frame.b)))
    };
    let directions: Vec<_> = directed.iter().map(projected).collect();
    let mut next = directions.iter();
    let mut fans = HashMap::new();
    let mut fan_of = |member: &Member| {
        let own = if member.is_directed { next.next() } else { None };
        let row = match own.filter(|_| is_divided) {
            None => directed.clone(),
            Some(&(s, t)) => directed
                .iter()
                .zip(&directions)
                .filter(|&(&corner, &(s_b, t_b))| corner == member.corner || (dot(s, s_b) > -1.0 && dot(t, t_b) > -1.0))
                .map(|(&corner, _)| corner)
                .collect(),
        };
        let fan = *fans.entry(row).or_insert_with_key(|row| add(row.clone()));
        (member.corner, fan)
    };
    members.iter().map(&mut fan_of).collect()
}
