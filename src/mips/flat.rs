//! The largest level of a roughness map: nothing has been filtered, and all of it is the base.

use super::tee::Tap;
use crate::error::Result;
use crate::map::CodesMut;
use crate::stream::{CodeSink, HeightBand};

/// Rows of one code.
pub(super) struct Flat<'a> {
    sink: &'a mut dyn CodeSink,
    code: u32,
}

impl<'a> Flat<'a> {
    pub fn new(sink: &'a mut dyn CodeSink, code: u32) -> Self {
        Self { sink, code }
    }
}

impl Tap for Flat<'_> {
    fn add(&mut self, _: usize, strip: &HeightBand<'_>) -> Result<()> {
        match self.sink.room(strip.rows())? {
            CodesMut::U8(codes) => codes.fill(self.code as u8),
            CodesMut::U16(codes) => codes.fill(self.code as u16),
            CodesMut::F16(_) | CodesMut::F32(_) => unreachable!("checked with the plan"),
        }
        self.sink.filled()
    }

    fn finish(self: Box<Self>) -> Result<()> {
        Ok(())
    }
}
