//! Meshes beyond a device's buffers: parts of their fans, each with triangles and vertices numbered anew.

use crate::ops::tangents::TangentPlan;
use std::ops::Range;

/// Words that the kernels read and write for a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Words {
    pub inputs: usize,
    pub outputs: usize,
}

impl Words {
    /// Of a mesh with so many of each. Three words for a position; seven for a triangle's texture differences and
    /// vertices; three for a fan's normal and one for where its corners begin, and one more for where the last ends.
    pub fn new([vertices, triangles, fans, corners]: [usize; 4], frame_words: usize) -> Self {
        Self {
            inputs: 3 * vertices + 7 * triangles + 4 * fans + 1 + corners,
            outputs: frame_words * triangles + 4 * fans,
        }
    }

    pub fn greatest(self) -> usize {
        self.inputs.max(self.outputs)
    }
}

/// New numbers for some of many things.
#[derive(Debug)]
pub(super) struct Numbers {
    /// What has been numbered, in order.
    pub of: Vec<u32>,
    /// The number of each thing, or [`NONE`].
    numbers: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Numbers {
    fn none(count: usize) -> Self {
        Self { of: Vec::new(), numbers: vec![NONE; count] }
    }

    fn all(count: usize) -> Self {
        let of: Vec<u32> = (0..count as u32).collect();
        Self { numbers: of.clone(), of }
    }

    /// The number of a thing.
    pub fn get(&self, thing: u32) -> u32 {
        self.numbers[thing as usize]
    }

    fn add(&mut self, thing: u32) {
        let number = &mut self.numbers[thing as usize];
        if *number == NONE {
            *number = self.of.len() as u32;
            self.of.push(thing);
        }
    }

    /// Forgets all but the first `count`.
    fn truncate(&mut self, count: usize) {
        for thing in self.of.drain(count..) {
            self.numbers[thing as usize] = NONE;
        }
    }
}

/// A mesh's fans, cut where a part would be too large.
#[derive(Debug)]
pub(super) struct Parts<'a> {
    plan: &'a TangentPlan<'a>,
    frame_words: usize,
    greatest_words: usize,
    next_fan: usize,
    is_whole: bool,
    pub triangles: Numbers,
    pub vertices: Numbers,
}

impl<'a> Parts<'a> {
    /// Parts of which neither inputs nor outputs have more than `greatest_words`, from fan `next_fan` on.
    pub fn new(plan: &'a TangentPlan<'a>, frame_words: usize, greatest_words: usize, next_fan: usize) -> Self {
        let [vertices, triangles] = [plan.surface.positions.len(), plan.surface.triangles.len()];
        let corners = plan.fans.corners.corners().len();
        let words = Words::new([vertices, triangles, plan.fans.count(), corners], frame_words);
        let is_whole = next_fan == 0 && words.greatest() <= greatest_words;
        let numbers = if is_whole { Numbers::all } else { Numbers::none };
        let (triangles, vertices) = (numbers(triangles), numbers(vertices));
        Self { plan, frame_words, greatest_words, next_fan, is_whole, triangles, vertices }
    }

    /// The fans of the next part, with its triangles and vertices numbered; none are left if it is empty.
    ///
    /// # Errors
    /// The fan that is too large for a part of its own.
    pub fn next(&mut self) -> Result<Range<usize>, usize> {
        let (fans, first) = (self.plan.fans, self.next_fan);
        if self.is_whole {
            self.next_fan = fans.count();
            return Ok(first..fans.count());
        }
        self.triangles.truncate(0);
        self.vertices.truncate(0);
        let mut corners = 0;
        while self.next_fan < fans.count() {
            let fan = self.next_fan;
            let before = [self.triangles.of.len(), self.vertices.of.len()];
            corners += self.add(fan);
            let counts = [self.vertices.of.len(), self.triangles.of.len(), fan + 1 - first, corners];
            if Words::new(counts, self.frame_words).greatest() > self.greatest_words {
                self.triangles.truncate(before[0]);
                self.vertices.truncate(before[1]);
                if fan == first {
                    return Err(fan);
                }
                break;
            }
            self.next_fan += 1;
        }
        Ok(first..self.next_fan)
    }

    /// Numbers what a fan is made of, and counts its corners.
    fn add(&mut self, fan: usize) -> usize {
        let row = self.plan.fans.corners.row(fan);
        for &corner in row {
            self.triangles.add(corner / 3);
            for vertex in self.plan.surface.triangles[corner as usize / 3] {
                self.vertices.add(vertex);
            }
        }
        row.len()
    }
}
