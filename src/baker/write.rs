//! Where codes go: a map in memory, or rows that are written while the next ones are computed.

use crate::error::Result;
use crate::map::{CodesMut, Size, TexelFormat};
use crate::stream::{CodeSink, CodeWriter, MapSink, Monitor, RowOrder, RowSink, RowsOut};

/// All rows of a map in memory, to fill.
pub(super) fn whole_sink<'a>(codes: &'a mut CodesMut<'_>, format: TexelFormat, size: Size) -> MapSink<'a> {
    let all = 0..codes.len();
    MapSink::new(codes.slice(all), format.row_codes(size.width()))
}

pub(super) fn as_dyn<S: CodeSink>(sinks: &mut [S]) -> Vec<&mut dyn CodeSink> {
    sinks.iter_mut().map(|sink| sink as &mut dyn CodeSink).collect()
}

/// Lets `produce` fill the rows of several maps, each written on a thread of its own, and completes
/// them all before any file gets its name.
pub(super) fn write_watched(
    sinks: Vec<RowsOut>,
    formats: &[TexelFormat],
    size: Size,
    order: RowOrder,
    monitor: &Monitor,
    produce: impl FnOnce(&mut [&mut dyn CodeSink]) -> Result<()>,
) -> Result<()> {
    let writer = |(sink, format): (_, &TexelFormat)| CodeWriter::new(sink, size, *format, order);
    let writers: Vec<CodeWriter> = sinks.into_iter().zip(formats).map(writer).collect::<Result<_>>()?;
    let monitored = |(index, sink)| {
        let row_texels = if index == 0 { size.width() } else { 0 };
        Monitored { sink, row_texels, room_texels: 0, texels: 0, monitor }
    };
    let mut sinks: Vec<Monitored<'_>> = writers.into_iter().enumerate().map(monitored).collect();
    let produced = produce(&mut as_dyn(&mut sinks));
    let texels = sinks[0].texels;
    let finish = || {
        let complete: Vec<RowsOut> = sinks.into_iter().map(|sink| sink.sink.complete()).collect::<Result<_>>()?;
        complete.into_iter().try_for_each(RowSink::finish)
    };
    // What a failed try has counted is baked again.
    produced.and_then(|()| finish()).inspect_err(|_| monitor.take_back(texels))
}

/// Counts what passes to a sink.
struct Monitored<'a> {
    sink: CodeWriter,
    /// Texels of a row; zero for all but the first map of a bake, since its texels are the others' too.
    row_texels: usize,
    room_texels: usize,
    /// Counted so far.
    texels: u64,
    monitor: &'a Monitor,
}

impl CodeSink for Monitored<'_> {
    fn room(&mut self, rows: usize) -> Result<CodesMut<'_>> {
        self.monitor.check()?;
        self.room_texels = rows * self.row_texels;
        self.sink.room(rows)
    }

    fn filled(&mut self) -> Result<()> {
        self.sink.filled()?;
        let texels = std::mem::take(&mut self.room_texels) as u64;
        self.texels += texels;
        self.monitor.add(texels)
    }
}
