//! Normal maps on their way into another map.

use crate::error::{Error, Result};
use crate::exact::CodeReading;
use crate::io::{NormalReadOptions, open_normals};
use crate::map::{Channels, CodesMut, CodesRef, NormalFormat, Size};
use crate::stream::{NormalRows, NormalSource, check_components};
use serde::Serialize;
use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// A normal map file, and how it is read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NormalInput {
    /// The file.
    pub path: PathBuf,
    /// What its codes mean.
    pub read: NormalReadOptions,
}

/// Texels of a normal map that are no normals of a height map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Degenerate {
    /// Texels of the map.
    pub texels: u64,
    /// Those whose z is not above zero: it counts as the least above zero. Two-channel maps have none.
    pub z_not_positive: u64,
    /// Those of them whose components are all zero.
    pub zero_vectors: u64,
}

/// What is known of a normal map that is read.
pub(super) struct Watch<'a> {
    input: &'a NormalInput,
    warnings: RefCell<Vec<String>>,
    format: Cell<Option<NormalFormat>>,
    degenerate: Arc<Mutex<Degenerate>>,
}

impl NormalInput {
    pub(super) fn watch(&self) -> Watch<'_> {
        Watch { input: self, warnings: RefCell::default(), format: Cell::default(), degenerate: Arc::default() }
    }
}

impl Watch<'_> {
    /// Opens the map; what was counted before belongs to another try.
    pub fn open(&self) -> Result<NormalRows> {
        let file = open_normals(&self.input.path, &self.input.read)?;
        *self.warnings.borrow_mut() = file.warnings;
        self.format.set(Some(file.rows.format()));
        *self.degenerate.lock().unwrap_or_else(PoisonError::into_inner) = Degenerate::default();
        let (path, degenerate) = (self.input.path.clone(), self.degenerate.clone());
        Ok(Box::new(Watched { rows: file.rows, path, next_row: 0, degenerate }))
    }

    /// What its codes mean; `None` if it was never opened.
    pub fn format(&self) -> Option<NormalFormat> {
        self.format.get()
    }

    /// What was counted so far.
    pub fn degenerate(&self) -> Degenerate {
        *self.degenerate.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What looks wrong, each with the name of the file.
    pub fn warnings(&self) -> Vec<String> {
        let Degenerate { texels, z_not_positive, zero_vectors } = self.degenerate();
        let counted = (z_not_positive > 0).then(|| {
            let zero = if zero_vectors > 0 { format!(", {zero_vectors} of them zero vectors") } else { String::new() };
            format!(
                "{z_not_positive} of {texels} normals do not point out of the surface (z is not above zero){zero}; \
                 their z counts as the least above zero. Is it a normal map, with the right encoding?"
            )
        });
        let warnings = self.warnings.borrow();
        let texts = warnings.iter().cloned().chain(counted);
        texts.map(|text| format!("{}: {text}", self.input.path.display())).collect()
    }
}

/// Rows that are counted as they pass.
struct Watched {
    rows: NormalRows,
    path: PathBuf,
    next_row: usize,
    degenerate: Arc<Mutex<Degenerate>>,
}

impl NormalSource for Watched {
    fn size(&self) -> Size {
        self.rows.size()
    }

    fn format(&self) -> NormalFormat {
        self.rows.format()
    }

    fn read(&mut self, mut rows: CodesMut<'_>) -> Result<()> {
        let all = 0..rows.len();
        self.rows.read(rows.slice(all))?;
        let (format, width) = (self.format(), self.size().width());
        check_components(rows.as_ref(), format, width, self.next_row).map_err(|error| self.named(error))?;
        self.next_row += rows.len() / format.texel().row_codes(width);
        self.degenerate.lock().unwrap_or_else(PoisonError::into_inner).count(rows.as_ref(), format);
        Ok(())
    }
}

impl Watched {
    /// An error about a texel as one about a texel of this file: there are two maps.
    fn named(&self, error: Error) -> Error {
        let text = error.to_string();
        let (reason, remedy) = text.split_once("; ").unwrap_or((&text, ""));
        Error::file(&self.path, reason, remedy)
    }
}

impl Degenerate {
    /// Counts these texels.
    fn count(&mut self, codes: CodesRef<'_>, format: NormalFormat) {
        self.texels += (codes.len() / format.channels.count()) as u64;
        if format.channels == Channels::Xy {
            return;
        }
        let reading = CodeReading::new(format.texel());
        let component = |code: u32| reading.map_or(0, |reading| reading.component(code));
        match codes {
            CodesRef::U8(codes) => self.count_texels(codes, |code| component(code.into())),
            CodesRef::U16(codes) => self.count_texels(codes, |code| component(code.into())),
            CodesRef::F16(codes) => self.count_texels(codes, |code| code.to_f32()),
            CodesRef::F32(codes) => self.count_texels(codes, |code| code),
        }
    }

    #[inline(always)]
    fn count_texels<T: Copy, C: PartialOrd + Default>(&mut self, codes: &[T], component: impl Fn(T) -> C) {
        let zero = C::default();
        for &[x, y, z] in codes.as_chunks::<3>().0 {
            let z = component(z);
            if z > zero {
                continue;
            }
            self.z_not_positive += 1;
            self.zero_vectors += u64::from(z == zero && component(x) == zero && component(y) == zero);
        }
    }
}
