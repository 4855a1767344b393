//! Whether a map that is repeated shows where it ends.

use super::census::Texel;
use super::read::Components;
use crate::map::Size;

/// The steps at the edges of a map that is repeated, against the steps inside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seams {
    /// Between columns; `None` if there are too few to tell.
    pub columns: Option<Seam>,
    /// Between rows; `None` if there are too few to tell.
    pub rows: Option<Seam>,
}

/// The steps between two neighbouring columns, or rows, at the edge of a map that is repeated.
///
/// A step is |dx| + |dy| + |dz| of two neighbouring normals, its mean that over the length of the edge. Of the last
/// column to the first, the first to the second and the last but one to the last, those with the greatest step are
/// given: heights that were baked with the wrong edge leave their step beside the seam. A crease that no place but the
/// edge has, such as a joint around a single tile, looks like a seam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seam {
    /// The columns, or rows.
    pub between: [usize; 2],
    /// The mean step between them.
    pub step: f64,
    /// The median of the mean steps between neighbours inside.
    pub typical: f64,
    /// The greatest of them.
    pub greatest: f64,
    /// Where the step is greatest: the texel in the first of the two columns, or rows.
    pub worst: Texel,
    /// The step there.
    pub worst_step: f64,
}

/// A seam's step is this many times the greatest inside. A map that tiles has its greatest step anywhere, and of the
/// three at an edge one is the greatest by chance: chance stays below 1.5 from [`LEAST_LENGTH`] texels on.
const SEAM_RATIO: f64 = 1.5;

/// Smaller steps are not seen: one code of 8 bits.
const LEAST_STEP: f64 = 2.0 / 255.0;

/// An edge with fewer texels, and an axis with fewer, is not judged.
const LEAST_LENGTH: usize = 16;

impl Seam {
    /// Whether the map shows its end here.
    pub fn shows(&self) -> bool {
        self.step > SEAM_RATIO * self.greatest && self.step > LEAST_STEP
    }
}

/// Sums over the rows.
pub(super) struct SeamTest {
    size: Size,
    /// Of each column to the next, and of the last to the first.
    columns: Vec<f64>,
    /// Of each row to the next, and of the last to the first.
    rows: Vec<f64>,
    /// The greatest step at the three boundaries of either axis' edge, and where along it.
    worst_columns: [(f32, usize); 3],
    worst_rows: [(f32, usize); 3],
    first: Row,
    previous: Row,
    steps: Vec<f32>,
    next_row: usize,
}

/// The components of a row.
#[derive(Default, Clone)]
struct Row([Vec<f32>; 3]);

impl Row {
    fn of(row: &Components) -> Self {
        Self([row.x.clone(), row.y.clone(), row.z.clone()])
    }

    fn set(&mut self, row: &Components) {
        for (to, from) in self.0.iter_mut().zip([&row.x, &row.y, &row.z]) {
            to.copy_from_slice(from);
        }
    }
}

impl SeamTest {
    pub fn new(size: Size) -> Self {
        let none = [(0.0, 0); 3];
        Self {
            size,
            columns: vec![0.0; size.width()],
            rows: vec![0.0; size.height()],
            worst_columns: none,
            worst_rows: none,
            first: Row::default(),
            previous: Row::default(),
            steps: vec![0.0; size.width()],
            next_row: 0,
        }
    }

    pub fn add_row(&mut self, row: &Components) {
        let y = self.next_row;
        self.next_row += 1;
        self.add_columns(y, row);
        if y == 0 {
            (self.first, self.previous) = (Row::of(row), Row::of(row));
            return;
        }
        steps(&mut self.steps, &self.previous.0, [&row.x, &row.y, &row.z]);
        self.add_rows(y - 1);
        self.previous.set(row);
        if self.next_row == self.size.height() {
            let [x, y, z] = &self.first.0;
            steps(&mut self.steps, &self.previous.0, [x, y, z]);
            self.add_rows(self.size.height() - 1);
        }
    }

    /// The steps along row `y`.
    fn add_columns(&mut self, y: usize, row: &Components) {
        let last = self.size.width() - 1;
        self.steps.fill(0.0);
        for component in [&row.x, &row.y, &row.z] {
            for (step, pair) in self.steps.iter_mut().zip(component.windows(2)) {
                *step += (pair[1] - pair[0]).abs();
            }
            self.steps[last] += (component[0] - component[last]).abs();
        }
        self.columns.iter_mut().zip(&self.steps).for_each(|(sum, step)| *sum += f64::from(*step));
        for (worst, boundary) in self.worst_columns.iter_mut().zip(boundaries(self.size.width())) {
            if self.steps[boundary] > worst.0 {
                *worst = (self.steps[boundary], y);
            }
        }
    }

    /// The steps from row `boundary` to the next.
    fn add_rows(&mut self, boundary: usize) {
        self.rows[boundary] = self.steps.iter().map(|step| f64::from(*step)).sum();
        for (worst, edge) in self.worst_rows.iter_mut().zip(boundaries(self.size.height())) {
            if edge == boundary {
                let greatest =
                    self.steps.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
                *worst = greatest.map_or((0.0, 0), |(x, step)| (step, x));
            }
        }
    }

    pub fn result(&self) -> Seams {
        let (width, height) = (self.size.width(), self.size.height());
        let columns = seam(&self.columns, height, &self.worst_columns, |column, y| Texel { x: column, y });
        let rows = seam(&self.rows, width, &self.worst_rows, |row, x| Texel { x, y: row });
        Seams { columns, rows }
    }
}

/// The boundaries at an edge of `n` columns or rows, each named by the one before it: the last to the first, the first
/// to the second, the last but one to the last.
fn boundaries(n: usize) -> [usize; 3] {
    [n - 1, 0, n.saturating_sub(2)]
}

/// |dx| + |dy| + |dz| of each texel of two rows.
fn steps(steps: &mut [f32], from: &[Vec<f32>; 3], to: [&Vec<f32>; 3]) {
    steps.fill(0.0);
    for (from, to) in from.iter().zip(to) {
        steps.iter_mut().zip(from).zip(to).for_each(|((step, a), b)| *step += (b - a).abs());
    }
}

/// The edge's greatest step among the sums of the steps over edges of `length` texels.
fn seam(sums: &[f64], length: usize, worst: &[(f32, usize); 3], texel: impl Fn(usize, usize) -> Texel) -> Option<Seam> {
    let n = sums.len();
    if n < LEAST_LENGTH || length < LEAST_LENGTH {
        return None;
    }
    let mean = |sum: f64| sum / length as f64;
    let edge = boundaries(n);
    let greatest = (0..3).max_by(|a, b| sums[edge[*a]].total_cmp(&sums[edge[*b]]).then(b.cmp(a)))?;
    let mut inside = sums[1..n - 2].to_vec();
    inside.sort_by(f64::total_cmp);
    let (boundary, (worst_step, along)) = (edge[greatest], worst[greatest]);
    Some(Seam {
        between: [boundary, (boundary + 1) % n],
        step: mean(sums[boundary]),
        typical: mean(inside[inside.len() / 2]),
        greatest: mean(inside[inside.len() - 1]),
        worst: texel(boundary, along),
        worst_step: worst_step.into(),
    })
}
