//! Bands up, codes down: a ring of slots keeps the next band uploading while one computes and one reads back.

use super::device::Device;
use super::normal::{self, NormalKernel, Params, TEXELS_PER_INVOCATION, WORKGROUP, heights_row_bytes};
use super::slot::Slot;
use crate::error::Result;
use crate::map::CodesMut;
use crate::ops::bake::BakePlan;
use crate::stream::{Band, CodeSink, HeightBand, HeightBands};
use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use wgpu::{Buffer, CommandEncoderDescriptor, ComputePipeline, MapMode, PollType};

/// Bands in flight.
const RING: usize = 3;

/// A device that has not answered for this long will not: drivers reset after two seconds.
const PATIENCE: Duration = Duration::from_secs(60);

/// A band whose codes are not back yet.
struct InFlight {
    slot: Slot,
    rows: usize,
    nonce: u32,
    submission: wgpu::SubmissionIndex,
    mapped: Receiver<Result<(), wgpu::BufferAsyncError>>,
}

/// One bake on a device.
pub(super) struct Transfer<'a> {
    device: &'a Device,
    plan: &'a BakePlan,
    kernel: NormalKernel,
    pipeline: ComputePipeline,
    flying: VecDeque<InFlight>,
}

impl<'a> Transfer<'a> {
    /// Prepares the kernel.
    pub fn new(device: &'a Device, plan: &'a BakePlan) -> Result<Self> {
        let kernel = Self::kernel(plan);
        let pipeline = device.guarded(|| Ok(device.pipeline(&kernel)))?;
        Ok(Self { device, plan, kernel, pipeline, flying: VecDeque::new() })
    }

    /// The kernel that a plan runs.
    pub fn kernel(plan: &BakePlan) -> NormalKernel {
        NormalKernel::new(plan, normal::format(plan).channels.count(), true)
    }

    /// Bakes all bands.
    pub fn run(mut self, bands: &mut dyn HeightBands, sink: &mut dyn CodeSink) -> Result<()> {
        while let Some(band) = bands.next()? {
            if self.flying.len() == RING {
                self.land(sink)?;
            }
            let flight = self.device.guarded(|| self.launch(&band))?;
            self.flying.push_back(flight);
        }
        while !self.flying.is_empty() {
            self.land(sink)?;
        }
        Ok(())
    }

    /// Sends a band to the device.
    fn launch(&self, band: &HeightBand<'_>) -> Result<InFlight> {
        let Self { device, plan, .. } = self;
        let (width, rows) = (plan.size.width(), band.rows());
        let row_bytes = heights_row_bytes(width, plan.height_type);
        let codes_row_bytes = self.kernel.codes_row_bytes(width);
        let heights_bytes = (row_bytes * (rows + 2)) as u64;
        let codes_bytes = (codes_row_bytes * rows) as u64;
        let marks_bytes = 4 * rows as u64;
        let slot = device.slot(heights_bytes, codes_bytes + marks_bytes);

        let words = |bytes: usize| (bytes / 4) as u32;
        let params = Params {
            rows: rows as u32,
            above: 0,
            body: words(row_bytes),
            below: words(row_bytes * (rows + 1)),
            row_words: words(row_bytes),
            codes: 0,
            codes_row_words: words(codes_row_bytes),
            marks: words(codes_row_bytes * rows),
            nonce: device.fresh_nonce(),
            ..normal::params(plan)
        };
        write_rows(&slot.upload, band, row_bytes).map_err(|reason| device.error(reason))?;
        device.queue.write_buffer(&slot.params, 0, bytemuck::bytes_of(&params));

        let mut encoder = device.device.create_command_encoder(&CommandEncoderDescriptor { label: Some("normal") });
        encoder.copy_buffer_to_buffer(&slot.upload, 0, &slot.heights, 0, heights_bytes);
        let bindings = device.bind(
            slot.params.as_entire_binding(),
            slot.heights.as_entire_binding(),
            slot.codes.as_entire_binding(),
        );
        dispatch(&mut encoder, &self.pipeline, &bindings, width, rows);
        encoder.copy_buffer_to_buffer(&slot.codes, 0, &slot.download, 0, codes_bytes + marks_bytes);
        let submission = device.queue.submit([encoder.finish()]);

        let (report, mapped) = channel();
        let also = report.clone();
        slot.upload.map_async(MapMode::Write, .., move |result| drop(report.send(result)));
        slot.download.map_async(MapMode::Read, .., move |result| drop(also.send(result)));
        Ok(InFlight { slot, rows, nonce: params.nonce, submission, mapped })
    }

    /// Waits for the oldest band and hands its codes on.
    fn land(&mut self, sink: &mut dyn CodeSink) -> Result<()> {
        let Some(flight) = self.flying.pop_front() else { return Ok(()) };
        let Self { device, plan, .. } = *self;
        let row_bytes = self.kernel.codes_row_bytes(plan.size.width());
        let (slot, rows) = (&flight.slot, flight.rows);
        let view = device.guarded(|| {
            flight.wait(device)?;
            slot.download.get_mapped_range(..).map_err(|error| device.error(error))
        })?;
        let (codes, marks) = view.split_at(row_bytes * rows);
        for (row, mark) in marks.chunks_exact(4).take(rows).enumerate() {
            if mark != flight.nonce.to_ne_bytes() {
                let reason = format!("row {row} of a band came back without having been computed");
                return Err(device.give_up(reason));
            }
        }
        // What the sink has to say is not the device's fault: it stands outside the guard.
        read_rows(codes, row_bytes, rows, &mut sink.room(rows)?);
        sink.filled()?;
        drop(view);
        device.guarded(|| {
            slot.download.unmap();
            Ok(())
        })?;
        device.keep(flight.slot);
        Ok(())
    }
}

impl InFlight {
    /// Waits until the band was computed and its buffers can be mapped.
    fn wait(&self, device: &Device) -> Result<()> {
        let wait = PollType::Wait { submission_index: Some(self.submission.clone()), timeout: Some(PATIENCE) };
        let polled = device.device.poll(wait);
        device.check()?;
        polled.map_err(|error| device.give_up(error))?;
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

/// Copies rows of codes without their padding.
fn read_rows(codes: &[u8], row_bytes: usize, rows: usize, target: &mut CodesMut<'_>) {
    let target = target.bytes_mut();
    let unpadded = target.len() / rows;
    for (from, to) in codes.chunks_exact(row_bytes).zip(target.chunks_exact_mut(unpadded)) {
        to.copy_from_slice(&from[..unpadded]);
    }
}

/// Writes the rows of a band with its halo, each padded to `row_bytes`, and unmaps the buffer.
fn write_rows(upload: &Buffer, band: &HeightBand<'_>, row_bytes: usize) -> Result<(), wgpu::MapRangeError> {
    fn write<T: bytemuck::Pod>(
        upload: &Buffer,
        band: &Band<'_, T>,
        row_bytes: usize,
    ) -> Result<(), wgpu::MapRangeError> {
        let rows = band.rows() as isize;
        let mut view = upload.get_mapped_range_mut(..)?;
        let padding = vec![0; row_bytes - size_of_val(band.above)];
        for (slot, row) in (-1..=rows).enumerate() {
            let bytes: &[u8] = bytemuck::cast_slice(band.row(row));
            let start = slot * row_bytes;
            view.slice(start..start + bytes.len()).copy_from_slice(bytes);
            view.slice(start + bytes.len()..start + row_bytes).copy_from_slice(&padding);
        }
        drop(view);
        upload.unmap();
        Ok(())
    }
    match band {
        HeightBand::U8(band) => write(upload, band, row_bytes),
        HeightBand::U16(band) => write(upload, band, row_bytes),
        HeightBand::F32(band) => write(upload, band, row_bytes),
    }
}
