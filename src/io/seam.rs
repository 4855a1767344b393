//! Where a tile meets one beside it: whether both have the texels there that they should share.

use super::samples::Samples;
use crate::map::Heights;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

/// Texels of a side of a tile, beside those of another tile that are the same if the tiles share as many as they
/// should, or one where they should share none.
#[derive(Debug)]
pub(super) struct Seam {
    tile: PathBuf,
    overlap: usize,
    texels: u64,
    differing: u64,
    first: Option<f32>,
    is_constant: bool,
}

impl Seam {
    /// Beside `tile`, which shares so many texels of this side; nothing was seen yet.
    pub fn new(tile: &Path, overlap: usize) -> Self {
        Self { tile: tile.into(), overlap, texels: 0, differing: 0, first: None, is_constant: true }
    }

    /// Takes a look at the next texels, as many of each tile.
    pub fn see(&mut self, own: Heights<'_>, beside: Heights<'_>) {
        match (own, beside) {
            (Heights::U8(own), Heights::U8(beside)) => self.compare(own, beside),
            (Heights::U16(own), Heights::U16(beside)) => self.compare(own, beside),
            (Heights::F32(own), Heights::F32(beside)) => self.compare(own, beside),
            _ => unreachable!("tiles of one map have one type"),
        }
    }

    fn compare<T: Copy + Into<f32>>(&mut self, own: &[T], beside: &[T]) {
        for (own, beside) in own.iter().zip(beside).map(|(own, beside)| ((*own).into(), (*beside).into())) {
            self.texels += 1;
            self.differing += u64::from(own != beside);
            self.is_constant &= own == *self.first.get_or_insert(own);
        }
    }

    /// How the name of the other tile stands in words.
    fn name(&self) -> String {
        self.tile.file_name().unwrap_or(self.tile.as_os_str()).display().to_string()
    }
}

/// Where a tile meets the one above or below it, of which a row each is seen one after the other.
#[derive(Debug)]
pub(super) struct RowSeam {
    pub seam: Seam,
    /// The row that was seen first.
    first: Option<Samples>,
}

impl RowSeam {
    pub fn new(seam: Seam) -> Self {
        Self { seam, first: None }
    }

    /// Takes the row of either tile; with the second one both are looked at.
    pub fn take(&mut self, row: Heights<'_>) {
        match self.first.take() {
            Some(first) => self.seam.see(first.as_ref(), row),
            None => {
                self.first = Some(match row {
                    Heights::U8(row) => Samples::U8(row.to_vec()),
                    Heights::U16(row) => Samples::U16(row.to_vec()),
                    Heights::F32(row) => Samples::F32(row.to_vec()),
                });
            }
        }
    }
}

/// What looks wrong where a tile meets others; all are reduced by a factor.
pub(super) fn warnings<'a>(seams: impl Iterator<Item = &'a Seam> + Clone, by: NonZeroU32) -> Vec<String> {
    let list = |parts: Vec<String>| (!parts.is_empty()).then(|| parts.join(", "));
    let differing = seams.clone().filter(|seam| seam.overlap > 0 && seam.differing > 0);
    let counts = differing.clone().map(|seam| format!("{} of {} with {}", seam.differing, seam.texels, seam.name()));
    let wrong = list(counts.collect()).zip(differing.map(|seam| seam.overlap).max()).map(|(counts, overlap)| {
        format!(
            "of the texels that it should share with the tiles beside it, these differ: {counts}: \
             is --overlap {} right?",
            overlap * by.get() as usize
        )
    });
    // The sea on both sides of a border says nothing.
    let same = seams.filter(|seam| seam.overlap == 0 && seam.differing == 0 && !seam.is_constant).map(Seam::name);
    let shared = list(same.collect()).map(|tiles| {
        format!(
            "its border is the same, texel by texel, as that of {tiles}: \
             tiles that share their borders take --overlap {by}"
        )
    });
    wrong.into_iter().chain(shared).collect()
}
