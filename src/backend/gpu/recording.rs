//! One computation as data: what a device gets, and what it must answer. Made on the host, without a device, so that
//! any WebGPU can run it.
//!
//! The bytes are those that [`super::transfer`] and [`super::tangents`] send; the answers are the reference's.

use super::bake;
use super::input::one_channel;
use super::kernel::Kernel;
use super::layers::LayerOperation;
use super::lock::lock;
use super::mesh_parts::Parts;
use super::operation::{Layer, Operation, Rows, WORKGROUP, output_row_bytes, row_groups};
use super::tangents::{self, NEGATIVE};
use super::transfer::{placed, write_layers};
use crate::backend::cpu::Reference;
use crate::backend::{Backend, RowBytes, fill_rows};
use crate::baker::Baker;
use crate::error::Result;
use crate::map::{Codes, CodesMut, Depth, Encoding, NormalFormat, TexelFormat};
use crate::ops::Precision;
use crate::ops::bake::{BakePlan, codes_of_band};
use crate::ops::blend::{self, BlendPlan};
use crate::ops::parallax::{self, ParallaxPlan};
use crate::ops::tangents::{TangentPlan, tangents_of_fans};
use crate::stream::{CodeSink, HeightBand, HeightBands, LayerBand, LayerBands};
use serde::{Serialize, Serializer};
use std::sync::{Arc, Mutex};
use wgpu::WriteOnly;

/// One computation: its passes run one after the other on the same inputs and outputs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Recording {
    pub precision: Precision,
    /// The maps in and out, in words.
    pub formats: String,
    pub passes: Vec<Pass>,
    /// The bytes of `inputs`.
    pub inputs: Vec<u8>,
    /// Words of `outputs`.
    pub output_words: usize,
    pub given: Vec<Given>,
    pub expected: Vec<Expected>,
}

/// One dispatch.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pass {
    /// The kernel's name, for people.
    pub name: &'static str,
    pub entry_point: &'static str,
    /// The WGSL that is compiled: the kernel's own, unless somebody changes it.
    pub text: String,
    /// Every override; a bool is 0 or 1.
    pub constants: Vec<(&'static str, u32)>,
    /// The bytes of the kernel's `Params`.
    pub params: Vec<u8>,
    /// Workgroups across and down.
    pub groups: [u32; 2],
}

/// Where one map lies among the inputs, to show what a difference came from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Given {
    pub name: &'static str,
    #[serde(flatten)]
    pub rows: RowsOf,
    /// The output's row to which the first of these belongs: -1 where one row lies above.
    pub first_row: i32,
    /// Texels around that count, in each direction.
    pub reach: u32,
    /// The columns that the formula takes left of the first and right of the last, as the edge mode says; `None` where
    /// it takes none.
    pub beside: Option<[usize; 2]>,
}

/// What must lie in the outputs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Expected {
    pub name: &'static str,
    #[serde(flatten)]
    pub rows: RowsOf,
    /// How far from `bytes` a code may be; `None`: every bit must agree.
    pub tolerance: Option<Tolerance>,
    /// The reference's codes, row after row without padding.
    #[serde(serialize_with = "as_base64")]
    pub bytes: Vec<u8>,
}

/// Rows of texels in a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct RowsOf {
    /// Word of the first row.
    pub place: usize,
    /// Words from one row to the next.
    pub row_words: usize,
    pub rows: usize,
    /// Bytes of a row that count; the rest is padding.
    pub row_bytes: usize,
    pub code: CodeType,
    /// Codes of a texel.
    pub channels: usize,
}

/// How the bits of a code are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum CodeType {
    U8,
    I8,
    U16,
    I16,
    F16,
    F32,
    /// Raw words.
    Bits,
}

/// How far `fast` may be from the expected answer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Tolerance {
    /// Integer codes, in steps from one to the next.
    pub codes: f64,
    /// Floats, in units in the last place of 1: 2^-10 of 16f, 2^-23 of 32f.
    pub ulps: f64,
    /// Directions of three components in 32f.
    pub degrees: f64,
}

/// What marks the rows and tangents of a recording. Below 2^31, as tangents want it; no poison of one repeated byte.
const NONCE: u32 = 0x7465_7862;

impl CodeType {
    fn of(format: TexelFormat) -> Self {
        match (format.depth, format.encoding) {
            (Depth::Bits8, Encoding::Snorm) => Self::I8,
            (Depth::Bits8, _) => Self::U8,
            (Depth::Bits16, Encoding::Snorm) => Self::I16,
            (Depth::Bits16, _) => Self::U16,
            (Depth::Float16, _) => Self::F16,
            (Depth::Float32, _) => Self::F32,
        }
    }

    /// Of codes on their way up: half floats arrive as floats.
    fn sent(format: TexelFormat) -> Self {
        match Self::of(format) {
            Self::F16 => Self::F32,
            other => other,
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::F32 | Self::Bits => 4,
        }
    }
}

impl RowsOf {
    /// Rows of `width` texels.
    fn texels(at: Rows, rows: usize, width: usize, code: CodeType, channels: usize) -> Self {
        let row_bytes = width * channels * code.bytes();
        Self { place: at.place as usize, row_words: at.words as usize, rows, row_bytes, code, channels }
    }

    /// Some words of each of many things of `row_words`.
    fn words(place: usize, row_words: usize, rows: usize, words: usize, code: CodeType) -> Self {
        Self { place, row_words, rows, row_bytes: 4 * words, code, channels: words }
    }
}

impl Pass {
    fn new(kernel: Kernel, params: Vec<u8>, groups: [u32; 2]) -> Self {
        let Kernel { source, constants } = kernel;
        Self { name: source.name, entry_point: source.entry_point, text: source.text(), constants, params, groups }
    }
}

/// A backend that computes as the reference does, and records every band.
#[derive(Debug, Clone, Default)]
struct Recorder(Arc<Mutex<Vec<Recording>>>);

impl Recorder {
    /// Keeps a recording of `rows` rows, and hands its codes on.
    fn keep(&self, recording: Recording, rows: usize, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        fill_rows(sinks, rows, |maps| {
            for (map, expected) in maps.iter_mut().zip(&recording.expected) {
                map.bytes_mut().copy_from_slice(&expected.bytes);
            }
        })?;
        lock(&self.0).push(recording);
        Ok(())
    }
}

impl Backend for Recorder {
    fn kind(&self) -> &'static str {
        "recorder"
    }

    fn device(&self) -> String {
        Reference.device()
    }

    /// A map is one band.
    fn band_rows(&self, _: RowBytes) -> usize {
        // The most workgroups of a dispatch in each dimension, on every WebGPU device.
        65_535
    }

    fn bake(&self, plan: &BakePlan, bands: &mut dyn HeightBands, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        while let Some(band) = bands.next()? {
            self.keep(Recording::of_bake(plan, &band), band.rows(), sinks)?;
        }
        Ok(())
    }

    fn blend(&self, plan: &BlendPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        while let Some(band) = bands.next()? {
            self.keep(Recording::of_blend(plan, &band), band.rows, &mut [&mut *sink])?;
        }
        Ok(())
    }

    fn parallax(&self, plan: &ParallaxPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        while let Some(band) = bands.next()? {
            self.keep(Recording::of_parallax(plan, &band), band.rows, &mut [&mut *sink])?;
        }
        Ok(())
    }

    fn tangents(&self, plan: &TangentPlan<'_>, out: &mut [[f32; 4]]) -> Result<()> {
        tangents_of_fans(plan, out);
        lock(&self.0).push(Recording::of_tangents(plan, out));
        Ok(())
    }
}

impl Recording {
    /// What `job` asks of a baker: a recording for each dispatch.
    ///
    /// # Errors
    /// The job's.
    pub fn of<T>(job: impl FnOnce(&Baker) -> Result<T>) -> Result<Vec<Self>> {
        let recorder = Recorder::default();
        job(&Baker::on(Arc::new(recorder.clone())))?;
        Ok(std::mem::take(&mut *lock(&recorder.0)))
    }

    /// Lets what `fast` computes differ; marks and signs do not.
    pub fn allow(&mut self, tolerance: Tolerance) {
        let is_fast = self.precision == Precision::Fast;
        for expected in self.expected.iter_mut().filter(|it| is_fast && it.rows.code != CodeType::Bits) {
            expected.tolerance = Some(tolerance);
        }
    }

    /// Values that are compared; marks are proofs besides.
    pub fn values(&self) -> usize {
        self.expected
            .iter()
            .filter(|expected| expected.name != "marks")
            .map(|expected| expected.bytes.len() / expected.rows.code.bytes())
            .sum()
    }

    /// The bake of a band.
    fn of_bake(plan: &BakePlan, band: &HeightBand<'_>) -> Self {
        let answer = answer(plan, band.rows(), |maps| codes_of_band(plan, band, maps));
        let names = [plan.normal.map(|_| "normal"), plan.parallax.map(|_| "parallax")];
        let names: Vec<_> = names.into_iter().flatten().collect();
        let stored = plan.normal.map(words).into_iter().chain(plan.parallax.map(|format| texel_words(format.texel())));
        let formats = format!("{} heights to {}", plan.height_type, stored.collect::<Vec<_>>().join(" and "));
        let (places, this) = Self::of_maps(plan, plan.precision, formats, &bake::layers(band), &names, answer);
        // The row above, the rows and the row below lie one after the other.
        let code = CodeType::sent(one_channel(plan.height_type));
        let rows = RowsOf::texels(places[0], band.rows() + 2, plan.width(), code, 1);
        let beside = Some([-1, plan.width() as isize].map(|x| plan.edges.x.resolve(x, plan.width())));
        Self { given: vec![Given { name: "heights", rows, first_row: -1, reach: 1, beside }], ..this }
    }

    /// The blend of a band.
    fn of_blend(plan: &BlendPlan, band: &LayerBand<'_>) -> Self {
        let answer = answer(plan, band.rows, |maps| blend::codes_of_layers(plan, &band.layers, &mut maps[0]));
        let [base, detail] = plan.inputs.map(words);
        let mask = plan.mask.map_or(String::new(), |mask| format!(" by a {} mask", mask.height_type));
        let formats = format!("{base} and {detail}{mask} to {}", words(plan.format));
        Self::of_layers(plan, formats, band, &["base", "detail", "mask"], ("normal", answer))
    }

    /// The parallax map of a band.
    fn of_parallax(plan: &ParallaxPlan, band: &LayerBand<'_>) -> Self {
        let answer = answer(plan, band.rows, |maps| parallax::codes_of_layers(plan, &band.layers, &mut maps[0]));
        let stored = texel_words(plan.format.texel());
        let formats = format!("{} heights and {} to {stored}", plan.height_type, words(plan.input));
        Self::of_layers(plan, formats, band, &["heights", "normals"], ("parallax", answer))
    }

    fn of_layers(
        plan: &impl LayerOperation,
        formats: String,
        band: &LayerBand<'_>,
        names: &[&'static str],
        (result, answer): (&'static str, Vec<Codes>),
    ) -> Self {
        let layers: Vec<_> = band.layers.iter().map(|&codes| Layer { rows: band.rows, codes }).collect();
        let (places, this) = Self::of_maps(plan, plan.precision(), formats, &layers, &[result], answer);
        let maps = places.into_iter().zip(plan.layers()).zip(names);
        let given = maps.map(|((at, format), name)| {
            let rows = RowsOf::texels(at, band.rows, plan.width(), CodeType::sent(format), format.channels);
            Given { name, rows, first_row: 0, reach: 0, beside: None }
        });
        Self { given: given.collect(), ..this }
    }

    /// An operation on maps, a dispatch for all rows; and where each layer lies.
    fn of_maps(
        operation: &impl Operation,
        precision: Precision,
        formats: String,
        layers: &[Layer<'_>],
        names: &[&'static str],
        answer: Vec<Codes>,
    ) -> (Vec<Rows>, Self) {
        let width = operation.width();
        let row_bytes = [operation.inputs(), output_row_bytes(operation)];
        let height = layers.iter().map(|layer| layer.rows).max().unwrap_or(0);
        let (places, input_words) = placed([&row_bytes[0], &row_bytes[1]], height, layers, NONCE);
        let mut inputs = vec![0; 4 * input_words as usize];
        write_layers(WriteOnly::from_mut(inputs.as_mut_slice()), layers, &places);

        let maps = answer.iter().zip(operation.outputs()).zip(&places.outputs).zip(names);
        let mut expected: Vec<Expected> = maps
            .map(|(((codes, format), &at), name)| {
                let rows = RowsOf::texels(at, height, width, CodeType::of(format), format.channels);
                Expected { name, rows, tolerance: None, bytes: codes.as_ref().bytes().to_vec() }
            })
            .collect();
        let marks = RowsOf::words(places.marks as usize, 1, height, 1, CodeType::Bits);
        let bytes = NONCE.to_le_bytes().repeat(height);
        expected.push(Expected { name: "marks", rows: marks, tolerance: None, bytes });

        let kernel = operation.kernel();
        let this = Self {
            precision,
            formats,
            passes: vec![Pass::new(kernel, operation.params(&places), [row_groups(width) as u32, height as u32])],
            inputs,
            output_words: places.marks as usize + height,
            given: Vec::new(),
            expected,
        };
        (places.inputs, this)
    }

    /// The tangents of a mesh's fans: a pass over its triangles, then one over its fans.
    fn of_tangents(plan: &TangentPlan<'_>, answer: &[[f32; 4]]) -> Self {
        let mut parts = Parts::new(plan, tangents::frame_words(plan.method), usize::MAX, 0);
        let fans = parts.next().unwrap_or(0..0);
        let words = tangents::words(plan, &parts, &fans);
        let mut inputs = vec![0; 4 * words.inputs];
        let written = tangents::write(WriteOnly::from_mut(inputs.as_mut_slice()), plan, &parts, &fans);
        let params = tangents::Params { nonce: NONCE, longest_row: u32::MAX, ..written };
        let passes = tangents::kernels(plan).into_iter().zip([parts.triangles.of.len(), fans.len()]);
        let passes = passes.map(|(kernel, count)| {
            let params = tangents::Params { first: 0, end: count as u32, ..params };
            Pass::new(kernel, bytemuck::bytes_of(&params).to_vec(), [count.div_ceil(WORKGROUP) as u32, 1])
        });

        let place = params.tangents as usize;
        let rows = RowsOf::words(place, 4, fans.len(), 3, CodeType::F32);
        let bytes = answer.iter().flat_map(|[x, y, z, _]| [x, y, z]).flat_map(|part| part.to_le_bytes()).collect();
        let directions = Expected { name: "tangents", rows, tolerance: None, bytes };
        let rows = RowsOf::words(place + 3, 4, fans.len(), 1, CodeType::Bits);
        let proofs = answer.iter().map(|[.., w]| NONCE | if *w < 0.0 { NEGATIVE } else { 0 });
        let bytes = proofs.flat_map(u32::to_le_bytes).collect();
        let signs = Expected { name: "signs", rows, tolerance: None, bytes };
        let normals = RowsOf::words(params.normals as usize, 3, fans.len(), 3, CodeType::F32);
        Self {
            precision: plan.precision,
            formats: format!("{} of a mesh", plan.method),
            passes: passes.collect(),
            inputs,
            output_words: words.outputs,
            given: vec![Given { name: "normals", rows: normals, first_row: 0, reach: 0, beside: None }],
            expected: vec![directions, signs],
        }
    }
}

/// The specification's codes of `rows` rows, for each map.
fn answer(operation: &impl Operation, rows: usize, compute: impl FnOnce(&mut [CodesMut<'_>])) -> Vec<Codes> {
    let count = |format: &TexelFormat| rows * format.row_codes(operation.width());
    let mut maps: Vec<_> =
        operation.outputs().iter().map(|format| Codes::zeroed(format.depth, count(format))).collect();
    compute(&mut maps.iter_mut().map(Codes::as_mut).collect::<Vec<_>>());
    maps
}

/// `unorm 16 xyz gl`.
fn words(format: NormalFormat) -> String {
    let NormalFormat { encoding, depth, channels, convention } = format;
    format!("{encoding} {depth} {channels} {convention}")
}

/// `snorm 8`.
fn texel_words(format: TexelFormat) -> String {
    format!("{} {}", format.encoding, format.depth)
}

/// Bytes in a JSON document.
pub(crate) fn as_base64<S: Serializer>(bytes: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
    use base64::Engine;
    serializer.serialize_str(&base64::engine::general_purpose::STANDARD.encode(bytes))
}
