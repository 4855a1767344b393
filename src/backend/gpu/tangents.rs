//! Tangents on a device: a frame for each triangle, then a tangent for each fan.

use super::device::{Device, Fault};
use super::kernel::{
    FRAMES_HEGDE, FRAMES_HEGDE_FAST, FRAMES_LENGYEL, FRAMES_LENGYEL_FAST, FRAMES_MIKKTSPACE, FRAMES_MIKKTSPACE_FAST,
    Kernel, TANGENTS_SUMMED, TANGENTS_SUMMED_FAST, TANGENTS_WEIGHTED, TANGENTS_WEIGHTED_FAST,
};
use super::mesh_parts::{Parts, Words};
use super::operation::WORKGROUP;
use super::pace::Work;
use super::slot::Slot;
use super::transfer::{Mapping, RING};
use crate::error::{Error, Result};
use crate::ops::Precision;
use crate::ops::tangents::{TangentMethod, TangentPlan, tangent_of_fan};
use bytemuck::{NoUninit, Pod, Zeroable};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::Range;
use wgpu::{CommandEncoderDescriptor, ComputePipeline, WriteOnly};

/// `Params` of kernels/tangents.wgsl; the words mean what they say there.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Params {
    pub first: u32,
    pub end: u32,
    pub nonce: u32,
    pub positions: u32,
    pub edges: u32,
    pub triangles: u32,
    pub normals: u32,
    pub offsets: u32,
    pub corners: u32,
    pub frames: u32,
    pub tangents: u32,
    pub longest_row: u32,
}

/// How much a device takes at once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Words of a buffer.
    pub words: usize,
    /// Triangles or fans of a dispatch at first: a slow GPU computes that many in about 50 ms.
    pub dispatch: usize,
    /// Corners that one invocation sums; the CPU sums longer rows. Mesa's llvmpipe leaves a loop after 65535 turns,
    /// and a driver's patience ends too.
    pub row: usize,
}

impl Limits {
    pub fn of(device: &Device) -> Self {
        Self { words: device.greatest_binding() / 4, dispatch: 1 << 18, row: 1 << 12 }
    }
}

/// The bit that a word of proof has for a sign of -1.
pub(super) const NEGATIVE: u32 = 1 << 31;

/// The kernels of a plan: the one for triangles, and the one for fans.
pub(super) fn kernels(plan: &TangentPlan<'_>) -> [Kernel; 2] {
    kernels_of(plan.method, plan.precision)
}

/// The kernels of a method.
pub(super) fn kernels_of(method: TangentMethod, precision: Precision) -> [Kernel; 2] {
    use TangentMethod::{Hegde, Lengyel, Mikktspace};
    let sources = match (method, precision) {
        (Lengyel, Precision::Exact) => [FRAMES_LENGYEL, TANGENTS_SUMMED],
        (Lengyel, Precision::Fast) => [FRAMES_LENGYEL_FAST, TANGENTS_SUMMED_FAST],
        (Hegde, Precision::Exact) => [FRAMES_HEGDE, TANGENTS_SUMMED],
        (Hegde, Precision::Fast) => [FRAMES_HEGDE_FAST, TANGENTS_SUMMED_FAST],
        (Mikktspace, Precision::Exact) => [FRAMES_MIKKTSPACE, TANGENTS_WEIGHTED],
        (Mikktspace, Precision::Fast) => [FRAMES_MIKKTSPACE_FAST, TANGENTS_WEIGHTED_FAST],
    };
    sources.map(|source| Kernel { source, constants: Vec::new() })
}

/// `FRAME_WORDS` of a plan's kernels.
pub(super) fn frame_words(method: TangentMethod) -> usize {
    match method {
        TangentMethod::Mikktspace => 4,
        TangentMethod::Lengyel | TangentMethod::Hegde => 7,
    }
}

/// Computes the tangent of each fan, untested; meshes beyond the limits or the free memory in parts.
pub(super) fn run(device: &Device, plan: &TangentPlan<'_>, limits: Limits, out: &mut [[f32; 4]]) -> Result<()> {
    let kernels = kernels(plan);
    let pipelines = device.guarded(|| Ok(kernels.each_ref().map(|kernel| device.pipeline(kernel))))?;
    let frame_words = frame_words(plan.method);
    let mut parts = Parts::new(plan, frame_words, limits.words, 0);
    let mut refused = None;
    let mut done = 0;
    while done < out.len() {
        let fans = parts.next().map_err(|fan| refused.take().unwrap_or_else(|| too_large(device, fan)))?;
        let words = words(plan, &parts, &fans);
        let job = Job { device, kernels: &kernels, pipelines: &pipelines, plan, parts: &parts, words, limits };
        match job.run(fans.clone(), &mut out[fans.clone()]) {
            Ok(()) => done = fans.end,
            Err(Fault::OutOfMemory(error)) => {
                device.free_slots();
                refused = Some(error);
                parts = Parts::new(plan, frame_words, words.greatest() / 2, done);
            }
            Err(Fault::Other(error)) => return Err(error),
        }
    }
    for (fan, tangent) in out.iter_mut().enumerate().filter(|(fan, _)| plan.fans.corners.row(*fan).len() > limits.row) {
        *tangent = tangent_of_fan(plan, fan);
    }
    Ok(())
}

fn too_large(device: &Device, fan: usize) -> Error {
    device.error(format_args!("a tangent of too many triangles for it: that of fan {fan}"))
}

/// The tangents of a part of the fans.
struct Job<'a> {
    device: &'a Device,
    kernels: &'a [Kernel; 2],
    pipelines: &'a [ComputePipeline; 2],
    plan: &'a TangentPlan<'a>,
    parts: &'a Parts<'a>,
    words: Words,
    limits: Limits,
}

impl Job<'_> {
    fn run(&self, fans: Range<usize>, out: &mut [[f32; 4]]) -> Result<(), Fault> {
        let Self { device, words, .. } = self;
        let slot = device.slot(4 * words.inputs as u64, 4 * words.outputs as u64)?;
        let nonce = device.fresh_nonce() & !NEGATIVE;
        let mapping = device.attempt(|| self.launch(&slot, fans.clone(), nonce))?;
        device.attempt(|| {
            mapping.wait(device)?;
            let view = device.returned(&slot)?;
            let computed = bytemuck::cast_slice::<u8, [u32; 4]>(&view[..16 * fans.len()]);
            for (fan, (&[x, y, z, proof], tangent)) in fans.zip(computed.iter().zip(out)) {
                if proof & !NEGATIVE != nonce {
                    return Err(device.give_up(format_args!("tangent {fan} came back without having been computed")));
                }
                let w = if proof & NEGATIVE == 0 { 1.0 } else { -1.0 };
                *tangent = [f32::from_bits(x), f32::from_bits(y), f32::from_bits(z), w];
            }
            drop(view);
            slot.download.unmap();
            Ok(())
        })?;
        device.keep(slot);
        Ok(())
    }

    /// Sends the part to the device.
    fn launch(&self, slot: &Slot, fans: Range<usize>, nonce: u32) -> Result<Mapping> {
        let Self { device, plan, parts, words, limits, .. } = self;
        let tangents = first_tangent(plan, parts);
        let mut view = slot.upload.get_mapped_range_mut(..).map_err(|error| device.error(error))?;
        let longest_row = limits.row as u32;
        let params = Params { nonce, longest_row, ..write(view.slice(..), plan, parts, &fans) };
        drop(view);
        slot.upload.unmap();
        let encoder = |label| device.device.create_command_encoder(&CommandEncoderDescriptor { label: Some(label) });

        let mut upload = encoder("upload");
        upload.copy_buffer_to_buffer(&slot.upload, 0, &slot.inputs, 0, 4 * words.inputs as u64);
        device.submit(None, upload.finish());
        self.dispatch(slot, params, fans.len())?;
        let mut download = encoder("download");
        download.copy_buffer_to_buffer(&slot.outputs, 4 * tangents as u64, &slot.download, 0, 16 * fans.len() as u64);
        let submission = device.submit(None, download.finish());
        Ok(Mapping::of(slot, submission))
    }

    /// Runs both kernels, in dispatches that the device computes in time.
    fn dispatch(&self, slot: &Slot, params: Params, fans: usize) -> Result<()> {
        let Self { device, .. } = self;
        let bindings = device.bind(
            slot.params.as_entire_binding(),
            slot.inputs.as_entire_binding(),
            slot.outputs.as_entire_binding(),
        );
        let mut flying = VecDeque::new();
        let counts = [self.parts.triangles.of.len(), fans];
        for ((kernel, pipeline), count) in self.kernels.iter().zip(self.pipelines).zip(counts) {
            let mut first = 0;
            while first < count {
                if flying.len() == RING {
                    flying.pop_front().map_or(Ok(()), |oldest| device.wait(&oldest))?;
                }
                let in_time = device.pace.most_items(kernel).max(WORKGROUP);
                let items = in_time.min(self.limits.dispatch).min(count - first);
                let end = first + items;
                let params = Params { first: first as u32, end: end as u32, ..params };
                // Written before what is submitted next, and after what was before. A submission each, since a
                // driver's patience is with a submission.
                device.queue.write_buffer(&slot.params, 0, bytemuck::bytes_of(&params));
                let label = Some("tangents");
                let mut dispatch = device.device.create_command_encoder(&CommandEncoderDescriptor { label });
                let mut pass = dispatch.begin_compute_pass(&Default::default());
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &bindings, &[]);
                pass.dispatch_workgroups(items.div_ceil(WORKGROUP) as u32, 1, 1);
                drop(pass);
                let work = Work { kernel: kernel.clone(), items };
                flying.push_back(device.submit(Some(work), dispatch.finish()));
                first = end;
            }
        }
        Ok(())
    }
}

/// The corners of some fans, one after the other.
fn corners_of<'a>(plan: &TangentPlan<'a>, fans: &Range<usize>) -> &'a [u32] {
    let adjacency = &plan.fans.corners;
    &adjacency.corners()[adjacency.offsets()[fans.start] as usize..adjacency.offsets()[fans.end] as usize]
}

/// Words that a part of the fans takes.
pub(super) fn words(plan: &TangentPlan<'_>, parts: &Parts<'_>, fans: &Range<usize>) -> Words {
    let counts = [parts.vertices.of.len(), parts.triangles.of.len(), fans.len(), corners_of(plan, fans).len()];
    Words::new(counts, frame_words(plan.method))
}

/// The word of `outputs` where a part's tangents begin: behind its frames.
fn first_tangent(plan: &TangentPlan<'_>, parts: &Parts<'_>) -> usize {
    frame_words(plan.method) * parts.triangles.of.len()
}

/// Writes a part's inputs, and tells where they lie.
pub(super) fn write(
    inputs: WriteOnly<'_, [u8]>,
    plan: &TangentPlan<'_>,
    parts: &Parts<'_>,
    fans: &Range<usize>,
) -> Params {
    let TangentPlan { surface, fans: all, .. } = *plan;
    let Parts { triangles, vertices, .. } = parts;
    let offsets = &all.corners.offsets()[fans.start..=fans.end];
    let mut inputs = Inputs { buffer: inputs, words: 0 };
    Params {
        positions: inputs.add(vertices.of.par_iter().map(|&vertex| surface.position(vertex))),
        edges: inputs.add(triangles.of.par_iter().map(|&triangle| surface.texture_edges(triangle as usize))),
        triangles: inputs.add(triangles.of.par_iter().map(|&triangle| {
            let [a, b, c] = surface.triangles[triangle as usize];
            [vertices.get(a), vertices.get(b), vertices.get(c)]
        })),
        normals: inputs.add(fans.clone().into_par_iter().map(|fan| surface.normals[all.vertex(fan)])),
        offsets: inputs.add(offsets.par_iter().map(|offset| offset - offsets[0])),
        corners: inputs
            .add(corners_of(plan, fans).par_iter().map(|&corner| 4 * triangles.get(corner / 3) + corner % 3)),
        tangents: first_tangent(plan, parts) as u32,
        ..Params::default()
    }
}

/// Inputs on their way to a device, one kind after the other.
struct Inputs<'a> {
    buffer: WriteOnly<'a, [u8]>,
    words: usize,
}

impl Inputs<'_> {
    /// Writes some more, and tells the word where they begin.
    fn add<T: NoUninit + Send>(&mut self, values: impl IndexedParallelIterator<Item = T>) -> u32 {
        let values: Vec<T> = values.collect();
        let bytes: &[u8] = bytemuck::cast_slice(&values);
        let place = self.words;
        self.words += bytes.len() / 4;
        self.buffer.slice(4 * place..4 * self.words).copy_from_slice(bytes);
        place as u32
    }
}
