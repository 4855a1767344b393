//! Height maps reduced by a whole factor while they are read.

use super::channel::HeightRows;
use super::samples::Samples;
use crate::error::{Error, Result};
use crate::map::{HeightType, Heights, HeightsMut, Size};
use crate::stream::RowSource;
use std::num::NonZeroU32;

/// The greatest factor: the sum of 64 x 64 codes of 16 bits, doubled, fits 32 bits.
const GREATEST: u32 = 64;

/// Rows of which each height is the mean of a square of a file's heights.
///
/// Codes: the sum is a whole number, and its mean becomes the nearest 16-bit code, ties up; 8-bit codes count 257 times,
/// so that the height stays what it is. Floats: the sum in f64 of rows from the top, each from the left, divided in f64
/// and rounded to f32 once. One row of the file and one of sums are held.
pub(super) struct Shrunk {
    rows: HeightRows,
    by: usize,
    size: Size,
    row: Samples,
    sums: Sums,
}

enum Sums {
    Codes(Vec<u32>),
    Floats(Vec<f64>),
}

impl Shrunk {
    /// `rows` with `by` x `by` of their heights in one.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the factor is above 64 or leaves a part of a square at the border: such a texel would be
    /// narrower than the others.
    pub fn new(rows: HeightRows, by: NonZeroU32) -> Result<Self> {
        let (whole, by) = (rows.size(), by.get());
        if by > GREATEST {
            return Err(Error::parameter("shrink", by, format!("from 1 to {GREATEST}")));
        }
        let by = by as usize;
        if whole.width() % by != 0 || whole.height() % by != 0 {
            let range = format!("a divisor of both sides of the map, which has {whole} texels");
            return Err(Error::parameter("shrink", by, range));
        }
        let size = Size::new(whole.width() / by, whole.height() / by)?;
        let row = Samples::zeroed(rows.height_type(), whole.width());
        let sums = match rows.height_type() {
            HeightType::U8 | HeightType::U16 => Sums::Codes(vec![0; size.width()]),
            HeightType::F32 => Sums::Floats(vec![0.0; size.width()]),
        };
        Ok(Self { rows, by, size, row, sums })
    }

    /// Sums up the next row of squares.
    fn sum_up(&mut self) -> Result<()> {
        match &mut self.sums {
            Sums::Codes(sums) => sums.fill(0),
            Sums::Floats(sums) => sums.fill(0.0),
        }
        for _ in 0..self.by {
            self.rows.read(self.row.as_mut())?;
            match (self.row.as_ref(), &mut self.sums) {
                (Heights::U8(codes), Sums::Codes(sums)) => add(codes, self.by, sums, |code| 257 * u32::from(code)),
                (Heights::U16(codes), Sums::Codes(sums)) => add(codes, self.by, sums, u32::from),
                (Heights::F32(heights), Sums::Floats(sums)) => add(heights, self.by, sums, f64::from),
                _ => unreachable!("the sums are of the row's own type"),
            }
        }
        Ok(())
    }
}

/// Adds each of a row's heights to the sum of its square.
fn add<T: Copy, S: std::ops::AddAssign>(row: &[T], by: usize, sums: &mut [S], height: impl Fn(T) -> S) {
    for (sum, heights) in sums.iter_mut().zip(row.chunks_exact(by)) {
        heights.iter().for_each(|&it| *sum += height(it));
    }
}

impl RowSource for Shrunk {
    fn size(&self) -> Size {
        self.size
    }

    fn height_type(&self) -> HeightType {
        match self.sums {
            Sums::Codes(_) => HeightType::U16,
            Sums::Floats(_) => HeightType::F32,
        }
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        let (width, count) = (self.size.width(), self.by * self.by);
        match &mut rows {
            HeightsMut::U16(rows) => {
                for row in rows.chunks_mut(width) {
                    self.sum_up()?;
                    let Sums::Codes(sums) = &self.sums else { return Err(self.wrong_room()) };
                    let count = count as u32;
                    row.iter_mut().zip(sums).for_each(|(mean, sum)| *mean = ((2 * sum + count) / (2 * count)) as u16);
                }
            }
            HeightsMut::F32(rows) => {
                for row in rows.chunks_mut(width) {
                    self.sum_up()?;
                    let Sums::Floats(sums) = &self.sums else { return Err(self.wrong_room()) };
                    row.iter_mut().zip(sums).for_each(|(mean, sum)| *mean = (sum / count as f64) as f32);
                }
            }
            HeightsMut::U8(_) => return Err(self.wrong_room()),
        }
        Ok(())
    }

    fn skip(&mut self, rows: usize) -> Result<()> {
        self.rows.skip(self.by * rows)
    }

    fn rewind(&mut self) -> Result<()> {
        self.rows.rewind()
    }

    fn last_row_is_near(&self) -> bool {
        self.rows.last_row_is_near()
    }

    fn held_bytes(&self) -> u64 {
        let sums = match &self.sums {
            Sums::Codes(sums) => size_of_val(sums.as_slice()),
            Sums::Floats(sums) => size_of_val(sums.as_slice()),
        };
        self.rows.held_bytes() + self.row.bytes() + sums as u64
    }
}

impl Shrunk {
    fn wrong_room(&self) -> Error {
        Error::parameter("room for rows", "of another type", format!("for {} heights", self.height_type()))
    }
}
