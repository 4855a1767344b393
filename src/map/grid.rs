//! Texels in rows.

use crate::error::{Error, Result};
use std::fmt;

/// Width and height of a map in texels, at least 1 x 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Size {
    width: usize,
    height: usize,
}

impl Size {
    /// `width` texels in each of `height` rows.
    ///
    /// # Errors
    /// [`Error::Parameter`] if either is zero, above 2^31 - 1, or their product does not fit `usize`.
    pub fn new(width: usize, height: usize) -> Result<Self> {
        const LIMIT: usize = i32::MAX as usize;
        let fits = (1..=LIMIT).contains(&width)
            && (1..=LIMIT).contains(&height)
            && width.checked_mul(height).is_some_and(|texels| texels <= isize::MAX as usize / 16);
        if !fits {
            let range = "at least 1x1 and at most 2147483647 texels on each side";
            return Err(Error::parameter("size", format_args!("{width}x{height}"), range));
        }
        Ok(Self { width, height })
    }

    /// Texels in a row.
    pub fn width(self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(self) -> usize {
        self.height
    }

    /// Texels in all.
    pub fn texels(self) -> usize {
        self.width * self.height
    }

    /// The sizes of its mip levels, from its own down to 1 x 1: max(1, floor(w / 2^k)) x max(1, floor(h / 2^k)).
    ///
    /// ```
    /// use texbake::Size;
    ///
    /// let levels: Vec<String> = Size::new(100, 6)?.levels().map(|size| size.to_string()).collect();
    /// assert_eq!(levels, ["100 x 6", "50 x 3", "25 x 1", "12 x 1", "6 x 1", "3 x 1", "1 x 1"]);
    /// # Ok::<(), texbake::Error>(())
    /// ```
    pub fn levels(self) -> impl ExactSizeIterator<Item = Self> + DoubleEndedIterator {
        let count = self.width.max(self.height).ilog2() as usize + 1;
        (0..count).map(move |level| Self { width: (self.width >> level).max(1), height: (self.height >> level).max(1) })
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} x {}", self.width, self.height)
    }
}

/// A value for each texel, in rows from the top, each from the left.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid<T> {
    size: Size,
    texels: Vec<T>,
}

impl<T> Grid<T> {
    /// A grid of `width` x `height` values, given row by row.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the size is empty or `texels` holds another number of values.
    pub fn new(width: usize, height: usize, texels: Vec<T>) -> Result<Self> {
        let size = Size::new(width, height)?;
        if texels.len() != size.texels() {
            let range = format!("{} for a map of {size}", size.texels());
            return Err(Error::parameter("number of texels", texels.len(), range));
        }
        Ok(Self { size, texels })
    }

    /// A grid whose value at column x, row y is `value(x, y)`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the size is empty.
    pub fn from_fn(width: usize, height: usize, mut value: impl FnMut(usize, usize) -> T) -> Result<Self> {
        let size = Size::new(width, height)?;
        let texels = (0..size.texels()).map(|i| value(i % width, i / width)).collect();
        Ok(Self { size, texels })
    }

    /// Width and height.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The values, row by row.
    pub fn texels(&self) -> &[T] {
        &self.texels
    }

    /// The values, row by row, without the grid.
    pub fn into_texels(self) -> Vec<T> {
        self.texels
    }
}
