//! Normal maps on their way into another map.

use super::role::Role;
use crate::error::{Error, Result};
use crate::inspect::{Census, Counted};
use crate::io::{NormalReadOptions, open_normals};
use crate::map::{Channels, CodesMut, NormalFormat, Size};
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

/// Texels of a normal map that are no unit normals of a height map: see [`Census`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Degenerate {
    /// Texels of the map.
    pub texels: u64,
    /// Those with a stored z below zero; it counts as the least above zero, like one of zero.
    pub below_zero: u64,
    /// Those with a stored z of zero, and something in x or y.
    pub at_zero: u64,
    /// Those with nothing at all.
    pub zero_vectors: u64,
    /// Those whose length rounding cannot explain.
    pub non_unit: u64,
}

/// What is known of a normal map that is read.
pub(super) struct NormalWatch<'a> {
    input: &'a NormalInput,
    role: Role,
    warnings: RefCell<Vec<String>>,
    format: Cell<Option<NormalFormat>>,
    census: RefCell<Option<Arc<Mutex<Census>>>>,
}

impl NormalInput {
    pub(super) fn watch(&self, role: Role) -> NormalWatch<'_> {
        let (warnings, format, census) = Default::default();
        NormalWatch { input: self, role, warnings, format, census }
    }
}

impl NormalWatch<'_> {
    /// Opens the map; what was counted before belongs to another try.
    pub fn open(&self) -> Result<NormalRows> {
        let file = open_normals(&self.input.path, &self.input.read).map_err(|error| self.role.named(error))?;
        *self.warnings.borrow_mut() = file.all_warnings();
        self.format.set(Some(file.rows.format()));
        let (rows, census) = Counted::new(file.rows);
        *self.census.borrow_mut() = Some(census);
        Ok(Box::new(Named { rows, path: self.input.path.clone(), next_row: 0 }))
    }

    /// What its codes mean; `None` if it was never opened.
    pub fn format(&self) -> Option<NormalFormat> {
        self.format.get()
    }

    /// What was counted so far.
    pub fn degenerate(&self) -> Degenerate {
        let census = self.census.borrow();
        census.as_ref().map_or(Degenerate::default(), |census| {
            let census = census.lock().unwrap_or_else(PoisonError::into_inner);
            Degenerate {
                texels: census.texels,
                below_zero: census.below_zero.count,
                at_zero: census.at_zero.count,
                zero_vectors: census.zero_vectors.count,
                non_unit: census.non_unit.count,
            }
        })
    }

    /// What looks wrong, each with the name of the file; counts mean something only if all rows were read.
    pub fn warnings(&self, all_read: bool) -> Vec<String> {
        let degenerate = self.degenerate();
        let hint = self.hint(&degenerate).unwrap_or_else(|| "texbake check says more".into());
        let found = degenerate.warning(&hint).filter(|_| all_read);
        let warnings = self.warnings.borrow();
        let texts = warnings.iter().chain(&found);
        texts.map(|text| format!("{}: {text}", self.input.path.display())).collect()
    }

    /// What to do where z is at or below zero nearly everywhere: an xy map in a file of three channels has no z.
    fn hint(&self, degenerate: &Degenerate) -> Option<String> {
        let is_xyz = self.format.get().is_some_and(|format| format.channels == Channels::Xyz);
        let option = self.role.option("channels");
        let hint = || format!("if the map holds x and y alone, as xy maps in PNG do, read it with --{option} xy");
        (is_xyz && degenerate.raised() >= degenerate.texels.div_ceil(10) * 9).then(hint)
    }
}

impl Degenerate {
    /// Texels of which z counts as the least above zero.
    fn raised(&self) -> u64 {
        self.below_zero + self.at_zero + self.zero_vectors
    }

    /// One line about what was found, what it means for the result, and what to do.
    fn warning(&self, hint: &str) -> Option<String> {
        let counts = [
            (self.below_zero, "z below zero"),
            (self.at_zero, "z of zero"),
            (self.zero_vectors, "no component but zero"),
            (self.non_unit, "a length other than 1"),
        ];
        let found = counts.iter().filter(|(count, _)| *count > 0);
        let found: Vec<String> = found.map(|(count, what)| format!("{count} with {what}")).collect();
        let raised =
            if self.raised() > 0 { " (z counts as the least above zero where it is not above it)" } else { "" };
        let (texels, found) = (self.texels, Some(found.join(", ")).filter(|found| !found.is_empty())?);
        Some(format!("{texels} normals, of them {found}{raised}; {hint}"))
    }
}

/// Rows whose errors name their file: a job reads two maps.
struct Named {
    rows: Counted,
    path: PathBuf,
    next_row: usize,
}

impl NormalSource for Named {
    fn held_bytes(&self) -> u64 {
        self.rows.held_bytes()
    }

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
        Ok(())
    }
}

impl Named {
    /// An error about a texel as one about a texel of this file: there are two maps.
    fn named(&self, error: Error) -> Error {
        let text = error.to_string();
        let (reason, remedy) = text.split_once("; ").unwrap_or((&text, ""));
        Error::file(&self.path, reason, remedy)
    }
}
