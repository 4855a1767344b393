//! The part of a map that is measured.

use crate::error::{Error, Result};
use crate::exact::{AxisScale, Rational, Scale};
use crate::map::{Grid, HeightMap, Heights, Size};
use serde::Serialize;

/// A part of a map, in texels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Region {
    /// Its first column.
    pub x: usize,
    /// Its first row.
    pub y: usize,
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Region {
    /// The middle of a map, no more than `limit` texels long on either side.
    pub(super) fn middle(size: Size, limit: usize) -> Self {
        let [(x, width), (y, height)] = [size.width(), size.height()].map(|length| {
            let part = length.min(limit);
            ((length - part) / 2, part)
        });
        Self { x, y, width, height }
    }

    /// This part of a map that it lies within, as a map of its own: its edges are its own too.
    pub(super) fn of(self, map: &HeightMap) -> Result<HeightMap> {
        let (columns, Self { x, y, width, height }) = (map.size().width(), self);
        let at = |column: usize, row: usize| (y + row) * columns + x + column;
        Ok(match map.heights() {
            Heights::U8(codes) => Grid::from_fn(width, height, |i, j| codes[at(i, j)])?.into(),
            Heights::U16(codes) => Grid::from_fn(width, height, |i, j| codes[at(i, j)])?.into(),
            Heights::F32(heights) => Grid::from_fn(width, height, |i, j| heights[at(i, j)])?.try_into()?,
        })
    }
}

/// A map turned by a quarter, to the right.
pub(super) fn quarter_turned(map: &HeightMap) -> Result<HeightMap> {
    let (columns, rows) = (map.size().width(), map.size().height());
    let at = |column: usize, row: usize| (rows - 1 - column) * columns + row;
    Ok(match map.heights() {
        Heights::U8(codes) => Grid::from_fn(rows, columns, |i, j| codes[at(i, j)])?.into(),
        Heights::U16(codes) => Grid::from_fn(rows, columns, |i, j| codes[at(i, j)])?.into(),
        Heights::F32(heights) => Grid::from_fn(rows, columns, |i, j| heights[at(i, j)])?.try_into()?,
    })
}

/// What is `axes` for a map of `size`.
///
/// # Errors
/// [`Error::Parameter`] for heights that along one axis alone are too low to be told from none.
pub(super) fn scale_for(axes: AxisScale, size: Size) -> Result<Scale> {
    if axes.x == axes.y {
        return Ok(Scale::texels(Rational::new(axes.x.into(), axes.q.into())?));
    }
    if axes.x == 0 || axes.y == 0 {
        let [x, y] = [axes.x, axes.y].map(|part| f64::from(part) / f64::from(axes.q));
        let range = "above 0 along both axes, or along neither: texels of that size are too long and narrow";
        return Err(Error::parameter("depth", format!("{x} and {y} texels"), range));
    }
    // A scale of x/q texels along `width` of them is one of 1 along width q/x.
    let extent = |texels: usize, part: i32| Rational::new(texels as i64 * i64::from(axes.q), i64::from(part).abs());
    let depth = if axes.x < 0 { -1 } else { 1 };
    Ok(Scale::physical(extent(size.width(), axes.x)?, extent(size.height(), axes.y)?, depth.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_map_is_cut_out() {
        let map = HeightMap::from(Grid::from_fn(5, 3, |x, y| (10 * y + x) as u8).unwrap());
        let region = Region::middle(map.size(), 2);
        assert_eq!(region, Region { x: 1, y: 0, width: 2, height: 2 });
        assert_eq!(region.of(&map).unwrap(), Grid::new(2, 2, vec![1u8, 2, 11, 12]).unwrap().into());
        assert_eq!(Region::middle(map.size(), 9).of(&map).unwrap(), map);
    }

    #[test]
    fn a_quarter_turn_takes_the_top_row_to_the_right() {
        let map = HeightMap::from(Grid::new(3, 2, vec![1u16, 2, 3, 4, 5, 6]).unwrap());
        assert_eq!(quarter_turned(&map).unwrap(), Grid::new(2, 3, vec![4u16, 1, 5, 2, 6, 3]).unwrap().into());
    }

    #[test]
    fn a_height_that_vanishes_along_one_axis_is_refused() {
        let size = Size::new(8, 8).unwrap();
        let axes = Scale::physical(1.into(), 100_000_000.into(), 1.into()).resolve(size).unwrap();
        assert_eq!((axes.x > 0, axes.y), (true, 0));
        assert!(
            scale_for(axes, size).unwrap_err().to_string().starts_with("depth is 8 and 0 texels: it must be above 0")
        );
        let none = AxisScale { x: 0, y: 0, ..axes };
        assert_eq!(scale_for(none, size).unwrap(), Scale::texels(0));
    }

    #[test]
    fn a_part_keeps_the_scale_of_the_whole() {
        let whole = Size::new(1000, 600).unwrap();
        let part = Size::new(512, 256).unwrap();
        for scale in [
            Scale::texels("7/3".parse::<Rational>().unwrap()),
            Scale::texels(-5),
            Scale::physical(2.into(), 3.into(), "0.1".parse().unwrap()),
            Scale::physical(2.into(), 3.into(), "-0.1".parse().unwrap()),
        ] {
            let axes = scale.resolve(whole).unwrap();
            let of_part = scale_for(axes, part).unwrap().resolve(part).unwrap();
            let ratio = |axes: AxisScale| [axes.x, axes.y].map(|part| f64::from(part) / f64::from(axes.q));
            assert_eq!(ratio(of_part), ratio(axes), "{scale}");
        }
    }
}
