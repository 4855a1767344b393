//! Bands up, codes down: a ring of slots keeps the next band uploading while one computes and one reads back.

use super::device::{Device, Fault};
use super::kernel::Kernel;
use super::operation::{Doubt, Layer, Operation, Places, Rows, greatest_row_bytes, output_row_bytes, row_groups};
use super::pace::{Submission, Work};
use super::slot::Slot;
use crate::backend::fill_rows;
use crate::error::{Error, Result};
use crate::map::{CodesMut, CodesRef};
use crate::stream::CodeSink;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::mpsc::{Receiver, channel};
use wgpu::{CommandEncoderDescriptor, ComputePipeline, MapMode, WriteOnly};

/// Dispatches in flight.
pub(super) const RING: usize = 3;

/// A band whose codes are not back yet.
struct InFlight {
    slot: Slot,
    places: Places,
    mapping: Mapping,
}

/// A slot whose upload and download are about to be mapped again.
pub(super) struct Mapping {
    submission: Submission,
    mapped: Receiver<Result<(), wgpu::BufferAsyncError>>,
    buffers: usize,
}

/// One job on a device.
pub(super) struct Transfer<'a, O> {
    device: &'a Device,
    operation: &'a O,
    doubt: Doubt,
    kernel: Kernel,
    pipeline: ComputePipeline,
    input_row_bytes: Vec<usize>,
    output_row_bytes: Vec<usize>,
    /// Rows for which there is room at once.
    most_rows: usize,
    flying: VecDeque<InFlight>,
}

impl<'a, O: Operation> Transfer<'a, O> {
    /// Prepares the kernel.
    pub fn new(device: &'a Device, operation: &'a O, doubt: Doubt) -> Result<Self> {
        let kernel = operation.kernel();
        let pipeline = device.guarded(|| Ok(device.pipeline(&kernel)))?;
        let most_rows = device.greatest_binding() / greatest_row_bytes(operation);
        Ok(Self {
            device,
            operation,
            doubt,
            kernel,
            pipeline,
            input_row_bytes: operation.inputs(),
            output_row_bytes: output_row_bytes(operation),
            most_rows: most_rows.clamp(1, device.greatest_dispatch()),
            flying: VecDeque::new(),
        })
    }

    /// Sends the next band of `rows` rows to the device, and hands on the codes of earlier ones if it must.
    ///
    /// `layers` cuts rows out of the band: it is sent in parts where it is too much for the device at once.
    pub fn send<'l>(
        &mut self,
        rows: usize,
        layers: impl Fn(Range<usize>) -> Vec<Layer<'l>>,
        sinks: &mut [&mut dyn CodeSink],
    ) -> Result<()> {
        let mut sent = 0;
        while sent < rows {
            if self.flying.len() == RING {
                self.land(sinks)?;
            }
            let count = self.rows_at_once().min(rows - sent);
            match self.launch(count, &layers(sent..sent + count)) {
                Ok(flight) => {
                    self.flying.push_back(flight);
                    sent += count;
                }
                Err(Fault::OutOfMemory(error)) => self.make_room(count, error, sinks)?,
                Err(Fault::Other(error)) => return Err(error),
            }
        }
        Ok(())
    }

    /// Rows for which the device has room and that it computes in time.
    fn rows_at_once(&self) -> usize {
        let in_time = self.device.pace.most_items(&self.kernel) / self.operation.width();
        in_time.clamp(1, self.most_rows)
    }

    /// After `rows` rows were refused for want of memory: waits until what this job and others before it have taken
    /// is free, and takes half as much from then on.
    fn make_room(&mut self, rows: usize, error: Error, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        while !self.flying.is_empty() {
            self.land(sinks)?;
        }
        let has_freed = self.device.free_slots();
        if rows == 1 && !has_freed {
            return Err(error);
        }
        self.most_rows = (rows / 2).max(1);
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
    fn launch(&self, rows: usize, layers: &[Layer<'_>]) -> Result<InFlight, Fault> {
        let device = self.device;
        let row_bytes = [self.input_row_bytes.as_slice(), &self.output_row_bytes];
        let (places, input_words) = placed(row_bytes, rows, layers, device.fresh_nonce());
        let places = Places { doubt: self.doubt, ..places };
        let input_bytes = 4 * u64::from(input_words);
        let output_bytes = 4 * (u64::from(places.marks) + rows as u64);
        let slot = device.slot(input_bytes, output_bytes)?;
        device.attempt(|| {
            let mut view = slot.upload.get_mapped_range_mut(..).map_err(|error| device.error(error))?;
            write_layers(view.slice(..), layers, &places);
            drop(view);
            slot.upload.unmap();
            device.queue.write_buffer(&slot.params, 0, &self.operation.params(&places));

            let label = Some(self.kernel.source.entry_point);
            let mut encoder = device.device.create_command_encoder(&CommandEncoderDescriptor { label });
            encoder.copy_buffer_to_buffer(&slot.upload, 0, &slot.inputs, 0, input_bytes);
            let bindings = device.bind(
                slot.params.as_entire_binding(),
                slot.inputs.as_entire_binding(),
                slot.outputs.as_entire_binding(),
            );
            let width = self.operation.width();
            dispatch(&mut encoder, &self.pipeline, &bindings, width, rows);
            encoder.copy_buffer_to_buffer(&slot.outputs, 0, &slot.download, 0, output_bytes);
            let work = Work { kernel: self.kernel.clone(), items: rows * width };
            let submission = device.submit(Some(work), encoder.finish());

            let mapping = Mapping::of(&slot, submission);
            Ok(InFlight { slot, places, mapping })
        })
    }

    /// Waits for the oldest band and hands its codes on.
    fn land(&mut self, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        let Some(flight) = self.flying.pop_front() else { return Ok(()) };
        let device = self.device;
        let InFlight { slot, places, .. } = &flight;
        let view = device.guarded(|| {
            flight.mapping.wait(device)?;
            device.returned(slot)
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
    pub fn of(slot: &Slot, submission: Submission) -> Self {
        Self::of_buffers([(&slot.upload, MapMode::Write), (&slot.download, MapMode::Read)], submission)
    }

    /// Asks for some buffers as soon as a submission is done.
    pub fn of_buffers<'a>(
        wanted: impl IntoIterator<Item = (&'a wgpu::Buffer, MapMode)>,
        submission: Submission,
    ) -> Self {
        let (report, mapped) = channel();
        let mut buffers = 0;
        for (buffer, mode) in wanted {
            let report = report.clone();
            buffer.map_async(mode, .., move |result| drop(report.send(result)));
            buffers += 1;
        }
        Self { submission, mapped, buffers }
    }

    /// Waits until the submission is done and the buffers are mapped.
    pub fn wait(&self, device: &Device) -> Result<()> {
        device.wait(&self.submission)?;
        for _ in 0..self.buffers {
            let answer = self.mapped.recv_timeout(device.patience);
            let result = answer.map_err(|_| device.give_up("its buffers were not mapped"))?;
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
    pass.dispatch_workgroups(row_groups(width) as u32, rows as u32, 1);
}

/// Where everything of a dispatch lies, with rows of so many bytes in and out, and the words of its inputs.
pub(super) fn placed(
    [input_row_bytes, output_row_bytes]: [&[usize]; 2],
    rows: usize,
    layers: &[Layer<'_>],
    nonce: u32,
) -> (Places, u32) {
    let (inputs, input_words) = stacked(layers.iter().map(|layer| layer.rows).zip(input_row_bytes));
    let (outputs, marks) = stacked(output_row_bytes.iter().map(|row_bytes| (rows, row_bytes)));
    (Places { rows: rows as u32, inputs, outputs, marks, nonce, ..Places::default() }, input_words)
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

/// Writes the layers of a dispatch to their places.
pub(super) fn write_layers(mut inputs: WriteOnly<'_, [u8]>, layers: &[Layer<'_>], places: &Places) {
    for (layer, at) in layers.iter().zip(&places.inputs) {
        write_rows(&mut inputs, layer, *at);
    }
}

/// Writes the rows of a layer, each padded with zeros.
fn write_rows(inputs: &mut WriteOnly<'_, [u8]>, layer: &Layer<'_>, at: Rows) {
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
        inputs.slice(start..padding).copy_from_slice(bytes);
        inputs.slice(padding..end).fill(0);
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
