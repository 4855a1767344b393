//! Sums of what texels hold over the texels of every level, while the rows of level 0 come.

use super::level::{Level, levels};
use super::sample::{Sample, Sum, add_along};
use crate::map::Size;
use rayon::prelude::*;
use std::ops::Range;

/// Texels of a row whose sums one thread makes at a time: they stay in the first cache.
const COLUMNS: usize = 1 << 10;

/// Sums over the texels of each level, of several planes of samples.
///
/// The order of sums, which matters to floats: along each row of the level that a level is made of (see [`levels`]) the
/// first texel under one, the sum of those between from the left, and the last texel, each times its weight; then rows,
/// times theirs, from the top down, but row 0 last. Row 0 is last because the first row of a map that wraps may travel
/// last; so the order is the same for every order of rows and every height of bands.
///
/// A row is `planes` rows of one value for each texel, one after the other. Besides the rows that come in, and those of
/// levels that they complete, two rows of each level are held.
pub(super) struct Pyramid<T: Sample> {
    size: Size,
    planes: usize,
    levels: Vec<LevelSums<T::Sum>>,
    /// Row 0 of level 0, once it has come.
    first_row: Vec<T>,
}

/// A level whose rows come into being.
struct LevelSums<S> {
    level: Level,
    /// Its row 0, to which row 0 of the source is still to be added.
    first: Vec<S>,
    /// Its row that is not complete, or nothing.
    open: Vec<S>,
}

/// Rows of sums of one level.
pub(super) struct Rows<S> {
    /// The level, at least 1.
    pub level: usize,
    /// What the weights under one of its texels add up to.
    pub weight: u64,
    /// Texels of a row.
    pub width: usize,
    /// Which rows they are.
    pub rows: Range<usize>,
    /// Row after row, each plane after plane.
    pub sums: Vec<S>,
}

impl<T: Sample> Pyramid<T> {
    /// For maps of `size` with `planes` samples at each texel.
    pub fn new(size: Size, planes: usize) -> Self {
        let level = |level| LevelSums { level, first: Vec::new(), open: Vec::new() };
        Self { size, planes, levels: levels(size).into_iter().map(level).collect(), first_row: Vec::new() }
    }

    /// Bytes that are held at most while `rows` rows are added at once: samples, sums, and the codes, `texel_bytes` to a
    /// texel, that the complete rows of one level become.
    pub fn held_bytes(size: Size, planes: usize, texel_bytes: usize, rows: usize) -> u64 {
        let levels = levels(size);
        let complete_texels = |level: &Level| {
            let complete = (rows * level.size.height()).div_ceil(size.height()) + 1;
            complete.min(level.size.height()) * level.size.width()
        };
        let texels_of_sums = |level: &Level| 2 * level.size.width() + complete_texels(level);
        let samples = (rows + 1) * size.width() * planes * size_of::<T>();
        let sums = levels.iter().map(texels_of_sums).sum::<usize>() * planes * size_of::<T::Sum>();
        let codes = levels.iter().map(complete_texels).max().unwrap_or(0) * texel_bytes;
        (samples + sums + codes) as u64
    }

    /// Adds rows of level 0 from row `first` on; they come from the top, but row 0 at any time. What comes back are the
    /// rows of all levels that are now complete.
    pub fn add(&mut self, first: usize, samples: &[T]) -> Vec<Rows<T::Sum>> {
        let row = self.planes * self.size.width();
        let (first, samples) = match first {
            0 => {
                self.first_row = samples[..row].to_vec();
                (1, &samples[row..])
            }
            first => (first, samples),
        };
        self.sum_up(first..first + samples.len() / row, samples)
    }

    /// Adds row 0 of level 0, which completes all levels: what comes back are their rows 0.
    pub fn finish(&mut self) -> Vec<Rows<T::Sum>> {
        let first_row = std::mem::take(&mut self.first_row);
        self.sum_up(0..1, &first_row)
    }

    fn sum_up(&mut self, rows: Range<usize>, samples: &[T]) -> Vec<Rows<T::Sum>> {
        let Self { planes, levels, .. } = self;
        let from_largest = |sums: &mut LevelSums<T::Sum>| match sums.level.source {
            0 => sums.add(*planes, rows.clone(), samples),
            _ => (0..0, Vec::new()),
        };
        let added: Vec<_> = levels.par_iter_mut().map(from_largest).collect();
        let mut complete: Vec<Rows<T::Sum>> = Vec::new();
        for (index, (sums, added)) in levels.iter_mut().zip(added).enumerate() {
            let Level { size, source, weight, .. } = sums.level;
            let (rows, added) = match source.checked_sub(1) {
                None => added,
                Some(source) => sums.add(*planes, complete[source].rows.clone(), &complete[source].sums),
            };
            complete.push(Rows { level: index + 1, weight, width: size.width(), rows, sums: added });
        }
        complete
    }
}

impl<S: Sum> LevelSums<S> {
    /// Adds rows of the source, and gives the rows that are now complete.
    fn add<T: Sample<Sum = S>>(&mut self, planes: usize, rows: Range<usize>, samples: &[T]) -> (Range<usize>, Vec<S>) {
        if rows.is_empty() {
            return (0..0, Vec::new());
        }
        let Level { size, x, y, .. } = self.level;
        let (width, source_width) = (size.width(), samples.len() / rows.len() / planes);
        let touched = y.covering(&rows);
        let is_complete = |row: usize| if row == 0 { rows.start == 0 } else { y.covered(row).end <= rows.end };
        let complete_end = touched.clone().rev().find(|row| is_complete(*row)).map_or(touched.start, |row| row + 1);
        let complete = touched.start.max(usize::from(rows.start > 0)).min(complete_end)..complete_end;

        // Threads share the rows that become complete or, where those are few, the texels of each.
        let block = if complete.len() < rayon::current_num_threads() { COLUMNS } else { width };
        let add_rows = |row: usize, sums: &mut [S]| {
            let covered = y.covered(row);
            let add_block = |plane: usize, first: usize, sums: &mut [S]| {
                for source in covered.start.max(rows.start)..covered.end.min(rows.end) {
                    let samples = &samples[((source - rows.start) * planes + plane) * source_width..][..source_width];
                    add_along(x, first, samples, y.weight(row, source), sums);
                }
            };
            sums.par_chunks_mut(width).enumerate().for_each(|(plane, sums)| {
                let blocks = sums.par_chunks_mut(block).enumerate();
                blocks.for_each(|(index, sums)| add_block(plane, index * block, sums));
            });
        };
        let row_sums = planes * width;
        // What was begun belongs to the first row that is touched; row 0 waits for row 0 of the source.
        let mut begun = std::mem::take(if rows.start == 0 { &mut self.first } else { &mut self.open });
        if touched.start == 0 && rows.start > 0 {
            self.first.resize(row_sums, S::default());
            add_rows(0, &mut self.first);
        }
        let mut sums = vec![S::default(); complete.len() * row_sums];
        sums.par_chunks_mut(row_sums).zip(complete.clone()).for_each(|(sums, row)| {
            if row == touched.start && !begun.is_empty() {
                sums.copy_from_slice(&begun);
            }
            add_rows(row, sums);
        });
        let last = touched.end - 1;
        if last > 0 && !complete.contains(&last) {
            if last > touched.start {
                begun.clear();
            }
            begun.resize(row_sums, S::default());
            add_rows(last, &mut begun);
            self.open = begun;
        }
        (complete, sums)
    }
}
