//! Rows that a format stores in groups: strips, rows of tiles, blocks of scan lines.

use super::samples::{Layout, SampleRows, Samples, copy, len, part, part_mut};
use crate::error::Result;
use crate::map::HeightsMut;

/// Decodes any group of a file by itself.
pub(super) trait GroupDecoder: Send {
    /// What a row holds.
    fn layout(&self) -> Layout;

    /// Rows of a group; the last one may have fewer.
    fn group_rows(&self) -> usize;

    /// Bytes that decoding holds at most beside the group.
    fn held_bytes(&self) -> u64;

    /// Decodes the group `index`, from the top, into the first rows of `group`.
    fn decode(&mut self, index: usize, group: &mut Samples) -> Result<()>;
}

/// The rows of a file in groups, of which the last one decoded is held.
pub(super) struct GroupedRows<D> {
    decoder: D,
    group: Samples,
    decoded: Option<usize>,
    next_row: usize,
}

impl<D: GroupDecoder> GroupedRows<D> {
    pub fn new(decoder: D) -> Self {
        let layout = decoder.layout();
        let rows = decoder.group_rows().min(layout.size.height());
        let group = Samples::zeroed(layout.depth, rows * layout.per_row());
        Self { decoder, group, decoded: None, next_row: 0 }
    }

    fn hold(&mut self, index: usize) -> Result<()> {
        if self.decoded != Some(index) {
            self.decoded = None;
            self.decoder.decode(index, &mut self.group)?;
            self.decoded = Some(index);
        }
        Ok(())
    }
}

impl<D: GroupDecoder> SampleRows for GroupedRows<D> {
    fn layout(&self) -> Layout {
        self.decoder.layout()
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        let (per_row, group_rows) = (self.layout().per_row(), self.decoder.group_rows());
        let (mut done, wanted) = (0, len(&rows) / per_row);
        while done < wanted {
            let index = self.next_row / group_rows;
            self.hold(index)?;
            let from = self.next_row - index * group_rows;
            let count = (group_rows - from).min(wanted - done);
            let decoded = part(self.group.as_ref(), from * per_row..(from + count) * per_row);
            copy(decoded, &mut part_mut(&mut rows, done * per_row..(done + count) * per_row));
            self.next_row += count;
            done += count;
        }
        Ok(())
    }

    fn seek(&mut self, row: usize) -> Result<()> {
        self.next_row = row;
        Ok(())
    }

    fn last_row_is_near(&self) -> bool {
        true
    }

    fn held_bytes(&self) -> u64 {
        self.decoder.held_bytes() + self.group.bytes()
    }
}
