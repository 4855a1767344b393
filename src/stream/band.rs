//! A band: some rows of heights, with the row above and the row below.

use crate::error::Result;
use crate::map::{Edge, Heights};

/// Rows of one height type with a halo of one row on either side.
///
/// At the top and bottom of a map the halo rows are what the edge mode says, so a backend knows no vertical edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Band<'a, T> {
    /// Heights in a row.
    pub width: usize,
    /// The row above the first.
    pub above: &'a [T],
    /// The rows of the band, one after the other.
    pub body: &'a [T],
    /// The row below the last.
    pub below: &'a [T],
}

/// A band of any height type.
#[derive(Debug, Clone, Copy)]
pub(crate) enum HeightBand<'a> {
    /// 8-bit codes.
    U8(Band<'a, u8>),
    /// 16-bit codes.
    U16(Band<'a, u16>),
    /// Floats, all finite.
    F32(Band<'a, f32>),
}

/// A map's bands, from the top, without gap or overlap.
pub(crate) trait HeightBands {
    /// The next band; `None` after the last.
    ///
    /// # Errors
    /// What the rows' source reports.
    fn next(&mut self) -> Result<Option<HeightBand<'_>>>;
}

impl<'a, T: Copy> Band<'a, T> {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.body.len() / self.width
    }

    /// Row `row` of the band; -1 is the row above, [`Band::rows`] the row below.
    pub fn row(&self, row: isize) -> &'a [T] {
        match usize::try_from(row) {
            Err(_) => self.above,
            Ok(row) if row == self.rows() => self.below,
            Ok(row) => &self.body[row * self.width..][..self.width],
        }
    }

    /// The rows `first..first + count` as a band of their own.
    pub fn part(&self, first: usize, count: usize) -> Self {
        Self {
            width: self.width,
            above: self.row(first as isize - 1),
            body: &self.body[first * self.width..][..count * self.width],
            below: self.row((first + count) as isize),
        }
    }

    /// The 3 x 3 heights around column `x` of row `row`, rows from the top, each from the left.
    pub fn neighbours(&self, edge: Edge, x: usize, row: usize) -> [[T; 3]; 3] {
        let columns = [-1, 0, 1].map(|step| edge.resolve(x as isize + step, self.width));
        [-1, 0, 1].map(|step| {
            let row = self.row(row as isize + step);
            columns.map(|column| row[column])
        })
    }
}

impl HeightBand<'_> {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        match self {
            Self::U8(band) => band.rows(),
            Self::U16(band) => band.rows(),
            Self::F32(band) => band.rows(),
        }
    }

    /// The rows `first..first + count` as a band of their own.
    pub fn part(&self, first: usize, count: usize) -> Self {
        match self {
            Self::U8(band) => Self::U8(band.part(first, count)),
            Self::U16(band) => Self::U16(band.part(first, count)),
            Self::F32(band) => Self::F32(band.part(first, count)),
        }
    }
}

/// The band of rows `rows` of a map of `height` rows that lies in memory.
pub(super) fn band_of_map(
    heights: Heights<'_>,
    width: usize,
    edge: Edge,
    rows: std::ops::Range<usize>,
) -> HeightBand<'_> {
    fn cut<T>(heights: &[T], width: usize, edge: Edge, rows: std::ops::Range<usize>) -> Band<'_, T> {
        let height = heights.len() / width;
        let row = |row: isize| &heights[edge.resolve(row, height) * width..][..width];
        Band {
            width,
            above: row(rows.start as isize - 1),
            body: &heights[rows.start * width..rows.end * width],
            below: row(rows.end as isize),
        }
    }
    match heights {
        Heights::U8(heights) => HeightBand::U8(cut(heights, width, edge, rows)),
        Heights::U16(heights) => HeightBand::U16(cut(heights, width, edge, rows)),
        Heights::F32(heights) => HeightBand::F32(cut(heights, width, edge, rows)),
    }
}
