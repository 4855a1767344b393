//! A mask on its way into a blend.

use super::role::Role;
use crate::error::{Error, Result};
use crate::io::{ReadOptions, open_heights};
use crate::map::{HeightType, Heights, HeightsMut, Size};
use crate::stream::{HeightRows, RowSource};
use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// A mask file, and how it is read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MaskInput {
    /// The file.
    pub path: PathBuf,
    /// Its channel, and the like.
    pub read: ReadOptions,
}

/// What is known of a mask that is read.
pub(super) struct MaskWatch<'a> {
    input: &'a MaskInput,
    warnings: RefCell<Vec<String>>,
    texels: Cell<usize>,
    varies: Arc<AtomicBool>,
}

impl MaskInput {
    pub(super) fn watch(&self) -> MaskWatch<'_> {
        MaskWatch { input: self, warnings: RefCell::default(), texels: Cell::default(), varies: Arc::default() }
    }
}

impl MaskWatch<'_> {
    /// Opens the mask; what was seen before belongs to another try.
    pub fn open(&self) -> Result<HeightRows> {
        let file = open_heights(&self.input.path, &self.input.read).map_err(|error| Role::Mask.named(error))?;
        *self.warnings.borrow_mut() = file.warnings;
        self.texels.set(file.rows.size().texels());
        self.varies.store(false, Relaxed);
        Ok(Box::new(Watched { rows: file.rows, first: None, varies: self.varies.clone() }))
    }

    /// What looks wrong, each with the name of the file; whether the mask varies is known only if all rows were read.
    pub fn warnings(&self, all_read: bool) -> Vec<String> {
        let mut warnings = self.warnings.take();
        if all_read && self.texels.get() > 1 && !self.varies.load(Relaxed) {
            let elsewhere = match self.input.read.channel {
                None => ": is it in the alpha channel? Then read it with --mask-channel a",
                Some(_) => ": is it in another channel? See --mask-channel",
            };
            warnings.push(format!("the mask is the same everywhere{elsewhere}"));
        }
        warnings.into_iter().map(|text| format!("{}: {text}", self.input.path.display())).collect()
    }
}

/// Looks whether a mask varies, and gives its errors the name of its option.
struct Watched {
    rows: HeightRows,
    first: Option<f32>,
    varies: Arc<AtomicBool>,
}

impl RowSource for Watched {
    fn size(&self) -> Size {
        self.rows.size()
    }

    fn height_type(&self) -> HeightType {
        self.rows.height_type()
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        let named = |error: Error| Role::Mask.named(error);
        match &mut rows {
            HeightsMut::U8(rows) => self.rows.read(HeightsMut::U8(rows)).map_err(named)?,
            HeightsMut::U16(rows) => self.rows.read(HeightsMut::U16(rows)).map_err(named)?,
            HeightsMut::F32(rows) => self.rows.read(HeightsMut::F32(rows)).map_err(named)?,
        }
        if !self.varies.load(Relaxed) {
            let varies = match rows.as_ref() {
                Heights::U8(codes) => varies(codes, &mut self.first),
                Heights::U16(codes) => varies(codes, &mut self.first),
                Heights::F32(heights) => varies(heights, &mut self.first),
            };
            self.varies.store(varies, Relaxed);
        }
        Ok(())
    }

    fn skip(&mut self, rows: usize) -> Result<()> {
        self.rows.skip(rows)
    }

    fn rewind(&mut self) -> Result<()> {
        self.rows.rewind()
    }

    fn last_row_is_near(&self) -> bool {
        self.rows.last_row_is_near()
    }

    fn held_bytes(&self) -> u64 {
        self.rows.held_bytes()
    }
}

/// Whether one of `values` is not `first`, which is the first of them if there was none.
fn varies<T: Copy + Into<f32>>(values: &[T], first: &mut Option<f32>) -> bool {
    let Some(&value) = values.first() else { return false };
    let first = *first.get_or_insert(value.into());
    values.iter().any(|&value| value.into() != first)
}
