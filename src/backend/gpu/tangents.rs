//! Tangents on a device: a frame for each triangle, then a tangent for each fan.

use super::device::Device;
use super::kernel::{
    FRAMES_HEGDE, FRAMES_HEGDE_FAST, FRAMES_LENGYEL, FRAMES_LENGYEL_FAST, FRAMES_MIKKTSPACE, FRAMES_MIKKTSPACE_FAST,
    Kernel, TANGENTS_SUMMED, TANGENTS_SUMMED_FAST, TANGENTS_WEIGHTED, TANGENTS_WEIGHTED_FAST,
};
use super::mesh_parts::{Parts, Words};
use super::operation::WORKGROUP;
use super::transfer::Mapping;
use crate::error::Result;
use crate::ops::Precision;
use crate::ops::tangents::{TangentMethod, TangentPlan, tangent_of_fan};
use bytemuck::{NoUninit, Pod, Zeroable};
use rayon::prelude::*;
use std::ops::Range;
use wgpu::{BufferViewMut, CommandEncoderDescriptor, ComputePipeline};

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
    /// Triangles or fans of a dispatch: a slow GPU computes that many in about 50 ms.
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
const NEGATIVE: u32 = 1 << 31;

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

/// Computes the tangent of each fan, untested; meshes beyond the limits in parts.
pub(super) fn run(device: &Device, plan: &TangentPlan<'_>, limits: Limits, out: &mut [[f32; 4]]) -> Result<()> {
    let pipelines = device.guarded(|| Ok(kernels(plan).map(|kernel| device.pipeline(&kernel))))?;
    let mut parts = Parts::new(plan, frame_words(plan.method), limits.words);
    let mut done = 0;
    while done < out.len() {
        let too_large = |fan| device.error(format_args!("a tangent of too many triangles for it: that of fan {fan}"));
        let fans = parts.next().map_err(too_large)?;
        done = fans.end;
        run_part(device, &pipelines, plan, &parts, fans.clone(), limits, &mut out[fans])?;
    }
    for (fan, tangent) in out.iter_mut().enumerate().filter(|(fan, _)| plan.fans.corners.row(*fan).len() > limits.row) {
        *tangent = tangent_of_fan(plan, fan);
    }
    Ok(())
}

/// Computes the tangents of a part of the fans.
fn run_part(
    device: &Device,
    pipelines: &[ComputePipeline; 2],
    plan: &TangentPlan<'_>,
    parts: &Parts<'_>,
    fans: Range<usize>,
    limits: Limits,
    out: &mut [[f32; 4]],
) -> Result<()> {
    let triangles = parts.triangles.of.len();
    let corners = corners_of(plan, &fans).len();
    let frame_words = frame_words(plan.method);
    let words = Words::new([parts.vertices.of.len(), triangles, fans.len(), corners], frame_words);
    let tangents = frame_words * triangles;
    let (input_bytes, output_bytes) = (4 * words.inputs as u64, 4 * words.outputs as u64);
    let nonce = device.fresh_nonce() & !NEGATIVE;

    let (slot, mapping) = device.guarded(|| {
        let slot = device.slot(input_bytes, output_bytes);
        let view = slot.upload.get_mapped_range_mut(..).map_err(|error| device.error(error))?;
        let longest_row = limits.row as u32;
        let params = Params { nonce, longest_row, tangents: tangents as u32, ..write(view, plan, parts, &fans) };
        slot.upload.unmap();
        let encoder = |label| device.device.create_command_encoder(&CommandEncoderDescriptor { label: Some(label) });

        let mut upload = encoder("upload");
        upload.copy_buffer_to_buffer(&slot.upload, 0, &slot.inputs, 0, input_bytes);
        device.queue.submit([upload.finish()]);
        let bindings = device.bind(
            slot.params.as_entire_binding(),
            slot.inputs.as_entire_binding(),
            slot.outputs.as_entire_binding(),
        );
        for (pipeline, count) in pipelines.iter().zip([triangles, fans.len()]) {
            for first in (0..count).step_by(limits.dispatch) {
                let end = count.min(first + limits.dispatch);
                let params = Params { first: first as u32, end: end as u32, ..params };
                // Written before what is submitted next, and after what was before. A submission each, since a
                // driver's patience is with a submission.
                device.queue.write_buffer(&slot.params, 0, bytemuck::bytes_of(&params));
                let mut dispatch = encoder("tangents");
                let mut pass = dispatch.begin_compute_pass(&Default::default());
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &bindings, &[]);
                pass.dispatch_workgroups((end - first).div_ceil(WORKGROUP) as u32, 1, 1);
                drop(pass);
                device.queue.submit([dispatch.finish()]);
            }
        }
        let mut download = encoder("download");
        let bytes = 16 * fans.len() as u64;
        download.copy_buffer_to_buffer(&slot.outputs, 4 * tangents as u64, &slot.download, 0, bytes);
        let submission = device.queue.submit([download.finish()]);
        let mapping = Mapping::of(&slot, submission);
        Ok((slot, mapping))
    })?;

    device.guarded(|| {
        mapping.wait(device)?;
        let view = slot.download.get_mapped_range(..).map_err(|error| device.error(error))?;
        let computed = bytemuck::cast_slice::<u8, [u32; 4]>(&view[..16 * fans.len()]);
        for (fan, (&[x, y, z, proof], tangent)) in fans.zip(computed.iter().zip(&mut *out)) {
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

/// The corners of some fans, one after the other.
fn corners_of<'a>(plan: &TangentPlan<'a>, fans: &Range<usize>) -> &'a [u32] {
    let adjacency = &plan.fans.corners;
    &adjacency.corners()[adjacency.offsets()[fans.start] as usize..adjacency.offsets()[fans.end] as usize]
}

/// Writes a part's inputs, and tells where they lie.
fn write(view: BufferViewMut, plan: &TangentPlan<'_>, parts: &Parts<'_>, fans: &Range<usize>) -> Params {
    let TangentPlan { surface, fans: all, .. } = *plan;
    let Parts { triangles, vertices, .. } = parts;
    let offsets = &all.corners.offsets()[fans.start..=fans.end];
    let mut inputs = Inputs { view, words: 0 };
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
        ..Params::default()
    }
}

/// Inputs on their way to a device, one kind after the other.
struct Inputs {
    view: BufferViewMut,
    words: usize,
}

impl Inputs {
    /// Writes some more, and tells the word where they begin.
    fn add<T: NoUninit + Send>(&mut self, values: impl IndexedParallelIterator<Item = T>) -> u32 {
        let values: Vec<T> = values.collect();
        let bytes: &[u8] = bytemuck::cast_slice(&values);
        let place = self.words;
        self.words += bytes.len() / 4;
        self.view.slice(4 * place..4 * self.words).copy_from_slice(bytes);
        place as u32
    }
}
