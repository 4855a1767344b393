//! Bands of a map in memory, and a map in memory as the sink: nothing is copied.

use super::CodeSink;
use super::band::{HeightBand, HeightBands, band_of_map};
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
    filled_codes: usize,
    /// Codes for which there is room now.
    room_codes: usize,
}

impl<'a> MapSink<'a> {
    /// Fills `codes`, of which each row has `row_codes`.
    pub fn new(codes: CodesMut<'a>, row_codes: usize) -> Self {
        Self { codes, row_codes, filled_codes: 0, room_codes: 0 }
    }
}

impl CodeSink for MapSink<'_> {
    fn room(&mut self, rows: usize) -> Result<CodesMut<'_>> {
        let first = self.filled_codes;
        self.room_codes = rows * self.row_codes;
        Ok(self.codes.slice(first..first + self.room_codes))
    }

    fn filled(&mut self) -> Result<()> {
        self.filled_codes += std::mem::take(&mut self.room_codes);
        Ok(())
    }
}
