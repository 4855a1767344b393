//! Where codes go: a map in memory, or rows that are written while the next ones are computed.

use crate::error::Result;
use crate::map::{CodesMut, Size, TexelFormat};
use crate::stream::{CodeSink, CodeWriter, MapSink, Monitor, RowsOut};

/// All rows of a map in memory, to fill.
pub(super) fn whole_sink<'a>(codes: &'a mut CodesMut<'_>, format: TexelFormat, size: Size) -> MapSink<'a> {
    let all = 0..codes.len();
    MapSink::new(codes.slice(all), format.row_codes(size.width()))
}

/// The rows of a map that are written, on a thread of their own, while the next ones are computed.
pub(super) struct WatchedRows<'a> {
    writer: CodeWriter,
    /// Texels of a row that are counted.
    row_texels: usize,
    room_texels: usize,
    counted: Counted<'a>,
}

impl<'a> WatchedRows<'a> {
    /// `monitor` is told of `row_texels` texels with each row.
    pub fn new(writer: CodeWriter, row_texels: usize, monitor: &'a Monitor) -> Self {
        Self { writer, row_texels, room_texels: 0, counted: Counted { monitor, texels: 0 } }
    }
}

/// Completes all files before any gets its name.
pub(super) fn finish<'a>(maps: impl IntoIterator<Item = WatchedRows<'a>>) -> Result<()> {
    let complete = |map: WatchedRows<'a>| Ok((map.writer.complete()?, map.counted));
    let maps: Vec<(RowsOut, Counted<'a>)> = maps.into_iter().map(complete).collect::<Result<_>>()?;
    let finish = |(sink, counted): (RowsOut, _)| sink.finish().map(|()| counted);
    let counted: Vec<Counted<'a>> = maps.into_iter().map(finish).collect::<Result<_>>()?;
    counted.into_iter().for_each(Counted::keep);
    Ok(())
}

impl CodeSink for WatchedRows<'_> {
    fn room(&mut self, rows: usize) -> Result<CodesMut<'_>> {
        self.counted.monitor.check()?;
        self.room_texels = rows * self.row_texels;
        self.writer.room(rows)
    }

    fn filled(&mut self) -> Result<()> {
        self.writer.filled()?;
        self.counted.add(std::mem::take(&mut self.room_texels) as u64)
    }
}

/// Texels that a monitor was told of, and told back unless they are kept: what a failed try has counted is baked again.
struct Counted<'a> {
    monitor: &'a Monitor,
    texels: u64,
}

impl Counted<'_> {
    fn add(&mut self, texels: u64) -> Result<()> {
        self.texels += texels;
        self.monitor.add(texels)
    }

    fn keep(mut self) {
        self.texels = 0;
    }
}

impl Drop for Counted<'_> {
    fn drop(&mut self) {
        self.monitor.take_back(self.texels);
    }
}
