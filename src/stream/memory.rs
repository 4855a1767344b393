//! Bands of a map in memory, and a map in memory as the sink: nothing is copied.

use super::band::{HeightBand, HeightBands, band_of_map};
use super::writer::CodeSink;
use crate::error::Result;
use crate::map::{CodesMut, Edge, HeightMap};

/// The bands of a height map in memory.
#[derive(Debug)]
pub(crate) struct MapBands<'a> {
    map: &'a HeightMap,
    edge: Edge,
    band_rows: usize,
    next_row: usize,
}

impl<'a> MapBands<'a> {
    /// All rows of `map`, `band_rows` at a time; `edge` says what lies above the first and below the last.
    pub fn new(map: &'a HeightMap, edge: Edge, band_rows: usize) -> Self {
        assert!(band_rows > 0, "a band has rows");
        Self { map, edge, band_rows, next_row: 0 }
    }
}

impl HeightBands for MapBands<'_> {
    fn next(&mut self) -> Result<Option<HeightBand<'_>>> {
        let size = self.map.size();
        let first = self.next_row;
        let end = first.saturating_add(self.band_rows).min(size.height());
        self.next_row = end;
        Ok((first < end).then(|| band_of_map(self.map.heights(), size.width(), self.edge, first..end)))
    }
}

/// A map's codes in memory, filled from the top.
#[derive(Debug)]
pub(crate) struct MapSink<'a> {
    codes: CodesMut<'a>,
    row_codes: usize,
    next_row: usize,
}

impl<'a> MapSink<'a> {
    /// Fills `codes`, of which each row has `row_codes`.
    pub fn new(codes: CodesMut<'a>, row_codes: usize) -> Self {
        Self { codes, row_codes, next_row: 0 }
    }
}

impl CodeSink for MapSink<'_> {
    fn write(&mut self, rows: usize, fill: &mut dyn FnMut(&mut CodesMut<'_>) -> Result<()>) -> Result<()> {
        let first = self.next_row * self.row_codes;
        fill(&mut self.codes.slice(first..first + rows * self.row_codes))?;
        self.next_row += rows;
        Ok(())
    }
}
