//! Bands up, codes down: a ring of slots keeps the next band uploading while one computes and one reads back.

use super::device::Device;
use super::operation::{Doubt, Layer, Operation, Places, Rows, TEXELS_PER_INVOCATION, WORKGROUP, output_row_bytes};
use super::slot::Slot;
use crate::backend::fill_rows;
use crate::error::Result;
use crate::map::{CodesMut, CodesRef};
use crate::stream::CodeSink;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use wgpu::{BufferViewMut, CommandEncoderDescriptor, ComputePipeline, MapMode, PollError, PollType};

/// Bands in flight.
const RING: usize = 3;

/// A device that has not answered for this long will not: drivers reset after two seconds.
const PATIENCE: Duration = Duration::from_secs(60);

/// A band whose codes are not back yet.
struct InFlight {
    slot: Slot,
    places: Places,
    mapping: Mapping,
}

/// A slot whose upload and download are about to be mapped again.
pub(super) struct Mapping {
    submission: wgpu::SubmissionIndex,
    mapped: Receiver<Result<(), wgpu::BufferAsyncError>>,
}

/// One job on a device.
pub(super) struct Transfer<'a, O> {
    device: &'a Device,
    operation: &'a O,
    doubt: Doubt,
    entry_point: &'static str,
    pipeline: ComputePipeline,
    input_row_bytes: Vec<usize>,
    output_row_bytes: Vec<usize>,
    flying: VecDeque<InFlight>,
}

impl<'a, O: Operation> Transfer<'a, O> {
    /// Prepares the kernel.
    pub fn new(device: &'a Device, operation: &'a O, doubt: Doubt) -> Result<Self> {
        let kernel = operation.kernel();
        let pipeline = device.guarded(|| Ok(device.pipeline(&kernel)))?;
        Ok(Self {
            device,
            operation,
            doubt,
            entry_point: kernel.source.entry_point,
            pipeline,
            input_row_bytes: operation.inputs(),
            output_row_bytes: output_row_bytes(operation),
            flying: VecDeque::new(),
        })
    }

    /// Sends the next band of `rows` rows to the device, and hands on the codes of an earlier one if it must.
    pub fn send(&mut self, rows: usize, layers: &[Layer<'_>], sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        if self.flying.len() == RING {
            self.land(sinks)?;
        }
        let flight = self.device.guarded(|| self.launch(rows, layers))?;
        self.flying.push_back(flight);
        Ok(())
    }

    /// Hands on the codes that are still on their way.
    pub fn finish(mut self, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        while !self.flying.is_empty() {
            self.land(sinks)?;
        }
        Ok(())
    }

    /// Sends a band to the device.
    fn launch(&self, rows: usize, layers: &[Layer<'_>]) -> Result<InFlight> {
        let device = self.device;
        let (inputs, input_words) = stacked(layers.iter().map(|layer| layer.rows).zip(&self.input_row_bytes));
        let (outputs, marks) = stacked(self.output_row_bytes.iter().map(|row_bytes| (rows, row_bytes)));
        let places =
            Places { rows: rows as u32, inputs, outputs, marks, nonce: device.fresh_nonce(), doubt: self.doubt };
        let input_bytes = 4 * u64::from(input_words);
        let output_bytes = 4 * (u64::from(marks) + rows as u64);
        let slot = device.slot(input_bytes, output_bytes);

        let mut view = slot.upload.get_mapped_range_mut(..).map_err(|error| device.error(error))?;
        for (layer, at) in layers.iter().zip(&places.inputs) {
            write_rows(&mut view, layer, *at);
        }
        drop(view);
        slot.upload.unmap();
        device.queue.write_buffer(&slot.params, 0, &self.operation.params(&places));

        let mut encoder =
            device.device.create_command_encoder(&CommandEncoderDescriptor { label: Some(self.entry_point) });
        encoder.copy_buffer_to_buffer(&slot.upload, 0, &slot.inputs, 0, input_bytes);
        let bindings = device.bind(
            slot.params.as_entire_binding(),
            slot.inputs.as_entire_binding(),
            slot.outputs.as_entire_binding(),
        );
        dispatch(&mut encoder, &self.pipeline, &bindings, self.operation.width(), rows);
        encoder.copy_buffer_to_buffer(&slot.outputs, 0, &slot.download, 0, output_bytes);
        let submission = device.queue.submit([encoder.finish()]);

        let mapping = Mapping::of(&slot, submission);
        Ok(InFlight { slot, places, mapping })
    }

    /// Waits for the oldest band and hands its codes on.
    fn land(&mut self, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        let Some(flight) = self.flying.pop_front() else { return Ok(()) };
        let device = self.device;
        let InFlight { slot, places, .. } = &flight;
        let view = device.guarded(|| {
            flight.mapping.wait(device)?;
            slot.download.get_mapped_range(..).map_err(|error| device.error(error))
        })?;
        let rows = places.rows as usize;
        let marks = &view[4 * places.marks as usize..];
        for (row, mark) in marks.chunks_exact(4).take(rows).enumerate() {
            if mark != places.nonce.to_ne_bytes() {
                let reason = format!("row {row} of a band came back without having been computed");
                return Err(device.give_up(reason));
            }
        }
        // What the sinks have to say is not the device's fault: it stands outside the guard.
        fill_rows(sinks, rows, |maps| {
            for (map, at) in maps.iter_mut().zip(&places.outputs) {
                read_rows(&view, *at, rows, map);
            }
        })?;
        drop(view);
        device.guarded(|| {
            slot.download.unmap();
            Ok(())
        })?;
        device.keep(flight.slot);
        Ok(())
    }
}

impl Mapping {
    /// Asks for a slot's buffers as soon as a submission is done.
    pub fn of(slot: &Slot, submission: wgpu::SubmissionIndex) -> Self {
        let (report, mapped) = channel();
        let also = report.clone();
        slot.upload.map_async(MapMode::Write, .., move |result| drop(report.send(result)));
        slot.download.map_async(MapMode::Read, .., move |result| drop(also.send(result)));
        Self { submission, mapped }
    }

    /// Waits until the submission is done and the buffers are mapped.
    pub fn wait(&self, device: &Device) -> Result<()> {
        let wait = PollType::Wait { submission_index: Some(self.submission.clone()), timeout: Some(PATIENCE) };
        let polled = device.device.poll(wait);
        device.check()?;
        polled.map_err(|error| match error {
            PollError::Timeout => device.give_up(error),
            // Of a device that is lost without having told it yet.
            PollError::WrongSubmissionIndex(..) => device.error(error),
        })?;
        for _ in 0..2 {
            let result = self.mapped.recv_timeout(PATIENCE).map_err(|_| device.give_up("it did not answer"))?;
            result.map_err(|error| device.check().err().unwrap_or_else(|| device.error(error)))?;
        }
        Ok(())
    }
}

/// Runs a kernel over `rows` rows of `width` texels.
pub(super) fn dispatch(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &ComputePipeline,
    bindings: &wgpu::BindGroup,
    width: usize,
    rows: usize,
) {
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, bindings, &[]);
    pass.dispatch_workgroups(width.div_ceil(TEXELS_PER_INVOCATION * WORKGROUP) as u32, rows as u32, 1);
}

/// Maps of so many rows of so many bytes one after the other, and the word after the last.
fn stacked<'a>(maps: impl Iterator<Item = (usize, &'a usize)>) -> (Vec<Rows>, u32) {
    let mut place = 0;
    let stack = |(rows, row_bytes): (usize, &usize)| {
        let words = (row_bytes / 4) as u32;
        let at = Rows { place, words };
        place += rows as u32 * words;
        at
    };
    let all = maps.map(stack).collect();
    (all, place)
}

/// Bytes of row `row` of a map.
fn bytes_of_row(at: Rows, row: usize) -> Range<usize> {
    let start = 4 * (at.place as usize + row * at.words as usize);
    start..start + 4 * at.words as usize
}

/// Writes the rows of a layer, each padded with zeros.
fn write_rows(view: &mut BufferViewMut, layer: &Layer<'_>, at: Rows) {
    let row_codes = layer.codes.len() / layer.rows;
    let mut widened = Vec::new();
    for row in 0..layer.rows {
        let codes = layer.codes.slice(row * row_codes..(row + 1) * row_codes);
        let bytes: &[u8] = match codes {
            CodesRef::F16(codes) => {
                widened.clear();
                widened.extend(codes.iter().map(|code| code.to_f32()));
                bytemuck::cast_slice(&widened)
            }
            _ => codes.bytes(),
        };
        let Range { start, end } = bytes_of_row(at, row);
        let padding = start + bytes.len();
        view.slice(start..padding).copy_from_slice(bytes);
        view.slice(padding..end).fill(0);
    }
}

/// Copies rows of codes without their padding.
fn read_rows(outputs: &[u8], at: Rows, rows: usize, target: &mut CodesMut<'_>) {
    let target = target.bytes_mut();
    let unpadded = target.len() / rows;
    for (row, to) in target.chunks_exact_mut(unpadded).enumerate() {
        to.copy_from_slice(&outputs[bytes_of_row(at, row)][..unpadded]);
    }
}
