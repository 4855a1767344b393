//! Recordings on the software devices: each is right before a browser sees it.

use super::device::Device;
use super::operation::PARAMS_BYTES;
use super::recording::{CodeType, Expected, Recording, Tolerance};
use super::tangent_tests::{devices, torus};
use super::{layers, self_test, tangents_self_test};
use crate::baker::Baker;
use crate::error::Result;
use crate::exact::{Rational, Scale};
use crate::map::{
    Channels, Convention, Depth, Edge, Edges, Encoding, Grid, HeightMap, HeightType, NormalFormat, NormalMap,
    ParallaxFormat, Size,
};
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, Filter};
use crate::ops::blend::{BlendInputs, BlendMethod, BlendOptions};
use crate::ops::tangents::{TangentMethod, TangentOptions};
use half::f16;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BufferUsages, ComputePipelineDescriptor, MapMode, PipelineCompilationOptions, PollType};

/// What stands in the outputs before: -6328 or -5.8 of floats, far from every answer.
const POISON: u8 = 0xc5;

fn normal(encoding: Encoding, depth: Depth, channels: Channels, convention: Convention) -> NormalFormat {
    NormalFormat { encoding, depth, channels, convention }
}

/// Some of every kernel, in both precisions, with names.
fn samples() -> Vec<(String, Recording)> {
    [bakes(), blends(), parallaxes(), tangents()].concat()
}

/// The one recording of a job.
fn one<T>(job: impl FnOnce(&Baker) -> Result<T>) -> Recording {
    let recordings = Recording::of(job).unwrap();
    let [mut recording] = <[Recording; 1]>::try_from(recordings).unwrap();
    // As the table of bounds has it; 3600 of tangents.
    let ulps = if recording.passes.len() == 2 { 3600.0 } else { 16.0 };
    recording.allow(Tolerance { codes: 1.0, ulps, degrees: 0.0 });
    recording
}

fn bakes() -> Vec<(String, Recording)> {
    use {Channels::*, Convention::*, Depth::*, Encoding::*};
    let steep = Scale::texels(Rational::new(16_777_213, 9_699_691).unwrap());
    let parallax = |encoding, depth| Some(ParallaxFormat { encoding, depth });
    let cases = [
        (HeightType::U8, Some(normal(Unorm, Bits8, Xyz, Gl)), None, Filter::Central, Edge::Wrap),
        (HeightType::U8, Some(normal(Snorm, Bits8, Xy, Dx)), parallax(Snorm, Bits8), Filter::Sobel, Edge::Clamp),
        (HeightType::U16, Some(normal(Unorm, Bits16, Xyz, Gl)), None, Filter::Scharr, Edge::Mirror),
        (HeightType::U16, Some(normal(Float, Float16, Xyz, Dx)), None, Filter::Prewitt, Edge::Wrap),
        (HeightType::U16, Some(normal(Float, Float32, Xyz, Gl)), parallax(Biased, Bits16), Filter::Sobel, Edge::Clamp),
        (HeightType::F32, Some(normal(Snorm, Bits16, Xyz, Gl)), None, Filter::Scharr, Edge::Mirror),
        (HeightType::F32, Some(normal(Float, Float32, Xy, Gl)), parallax(Float, Float16), Filter::Central, Edge::Wrap),
        (HeightType::F32, None, parallax(Float, Float32), Filter::Prewitt, Edge::Clamp),
    ];
    let mut recordings = Vec::new();
    for (heights, normal, parallax, filter, edge) in cases {
        for precision in [Precision::Exact, Precision::Fast] {
            // Native floats have no promise for heights of every exponent.
            if precision == Precision::Fast && heights == HeightType::F32 {
                continue;
            }
            let map = self_test::noise(heights).unwrap();
            let edges = Edges::both(edge);
            let options = BakeOptions { scale: steep, filter, edges, normal, parallax, roughness: None, precision };
            let recording = one(|baker| baker.bake(&map, &options));
            let name = format!("bake, {precision}, {}, {filter}, {edge}", recording.formats);
            recordings.push((name, recording));
        }
    }
    recordings
}

fn blends() -> Vec<(String, Recording)> {
    use {Channels::*, Convention::*, Depth::*, Encoding::*};
    let (unorm8, snorm16) = (normal(Unorm, Bits8, Xyz, Gl), normal(Snorm, Bits16, Xy, Dx));
    let (half, float) = (normal(Float, Float16, Xyz, Gl), normal(Float, Float32, Xy, Gl));
    // Where z is near zero, a code of native floats is near nothing: they blend what is easy.
    let cases = [
        ("add", BlendMethod::add(), [unorm8; 3], Precision::Exact),
        ("add", BlendMethod::add(), [unorm8; 3], Precision::Fast),
        ("masked", BlendMethod::Masked, [unorm8, snorm16, snorm16], Precision::Exact),
        ("rnm", BlendMethod::Rnm, [snorm16, unorm8, half], Precision::Exact),
        ("whiteout", BlendMethod::Whiteout, [half, float, float], Precision::Exact),
    ];
    let record = |(name, method, formats, precision): (_, _, [NormalFormat; 3], _)| {
        let [base, detail, format] = formats;
        let mask = Grid::from_fn(WIDTH, HEIGHT, |x, y| self_test::scrambled((y * WIDTH + x) as u32) as u8).unwrap();
        let mask = (method == BlendMethod::Masked).then(|| HeightMap::from(mask));
        let (base, detail) = (normals(base, 1), normals(detail, 2));
        let options = BlendOptions { method, format, precision, ..Default::default() };
        let inputs = BlendInputs { base: &base, detail: &detail, mask: mask.as_ref() };
        let recording = one(|baker| baker.blend(&inputs, &options));
        (format!("blend, {precision}, {}, {name}", recording.formats), recording)
    };
    cases.map(record).into()
}

/// The size of blended maps.
const WIDTH: usize = 37;
const HEIGHT: usize = 5;

fn normals(format: NormalFormat, seed: u32) -> NormalMap {
    let size = Size::new(WIDTH, HEIGHT).unwrap();
    NormalMap::new(size, format, layers::noise(format.texel(), size, seed)).unwrap()
}

fn parallaxes() -> Vec<(String, Recording)> {
    use {Channels::*, Convention::*, Depth::*, Encoding::*};
    let cases = [
        (HeightType::U8, normal(Unorm, Bits8, Xyz, Gl), Snorm, Bits8, Precision::Exact),
        (HeightType::U16, normal(Snorm, Bits16, Xy, Dx), Unorm, Bits16, Precision::Exact),
        (HeightType::F32, normal(Float, Float16, Xyz, Gl), Float, Float32, Precision::Exact),
        (HeightType::U8, normal(Unorm, Bits8, Xyz, Gl), Biased, Bits8, Precision::Fast),
    ];
    let record = |(heights, format, encoding, depth, precision)| {
        let heights = self_test::noise(heights).unwrap();
        let size = heights.size();
        let normals = NormalMap::new(size, format, layers::noise(format.texel(), size, 3)).unwrap();
        let format = ParallaxFormat { encoding, depth };
        let recording = one(|baker| baker.parallax_with_normals(&heights, &normals, format, precision));
        (format!("parallax, {precision}, {}", recording.formats), recording)
    };
    cases.map(record).into()
}

fn tangents() -> Vec<(String, Recording)> {
    use TangentMethod::{Hegde, Lengyel, Mikktspace};
    let with_normals = |(mesh, normals): (crate::Mesh, _)| mesh.with_normals(normals).unwrap();
    let rough = with_normals(tangents_self_test::noise(90, 1).unwrap());
    let smooth = with_normals(torus(12, 9));
    let mut recordings = Vec::new();
    for method in [Lengyel, Hegde, Mikktspace] {
        for (precision, mesh) in [(Precision::Exact, &rough), (Precision::Fast, &smooth)] {
            let options = TangentOptions { method, precision, ..Default::default() };
            let recording = one(|baker| baker.tangents(mesh, &options));
            recordings.push((format!("tangents, {precision}, {}", recording.formats), recording));
        }
    }
    recordings
}

impl Recording {
    /// What a device leaves in the outputs.
    fn run(&self, device: &Device) -> Vec<u8> {
        let Device { device: wgpu, queue, .. } = device;
        let buffer =
            |contents: &[u8], usage| wgpu.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage });
        let output_bytes = 4 * self.output_words as u64;
        let inputs = buffer(&self.inputs, BufferUsages::STORAGE);
        let poison = vec![POISON; 4 * self.output_words];
        let outputs = buffer(&poison, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let download = buffer(&poison, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        let mut encoder = wgpu.create_command_encoder(&Default::default());
        for pass in &self.passes {
            let module = wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(pass.name),
                source: wgpu::ShaderSource::Wgsl(pass.text.as_str().into()),
            });
            let layout = wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                bind_group_layouts: &[Some(&device.layout)],
                ..Default::default()
            });
            let constants: Vec<_> = pass.constants.iter().map(|&(name, value)| (name, f64::from(value))).collect();
            let pipeline = wgpu.create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(pass.name),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(pass.entry_point),
                compilation_options: PipelineCompilationOptions { constants: &constants, ..Default::default() },
                cache: None,
            });
            let mut params = pass.params.clone();
            params.resize(PARAMS_BYTES, 0);
            let params = buffer(&params, BufferUsages::UNIFORM);
            let bindings = [&params, &inputs, &outputs].map(|buffer| buffer.as_entire_binding());
            let [params, inputs, outputs] = bindings;
            let bindings = device.bind(params, inputs, outputs);
            let mut compute = encoder.begin_compute_pass(&Default::default());
            compute.set_pipeline(&pipeline);
            compute.set_bind_group(0, &bindings, &[]);
            let [x, y] = pass.groups;
            compute.dispatch_workgroups(x, y, 1);
        }
        encoder.copy_buffer_to_buffer(&outputs, 0, &download, 0, output_bytes);
        queue.submit([encoder.finish()]);
        download.map_async(MapMode::Read, .., |result| result.unwrap());
        wgpu.poll(PollType::wait_indefinitely()).unwrap();
        download.get_mapped_range(..).unwrap().to_vec()
    }

    /// Values that are not as expected, of how many; panics if there are none.
    fn compare(&self, outputs: &[u8]) -> [usize; 2] {
        let counts = self.expected.iter().map(|expected| expected.compare(outputs));
        let [differ, all] = counts.fold([0, 0], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
        assert!(all > 0, "nothing was compared");
        [differ, all]
    }
}

impl Expected {
    fn compare(&self, outputs: &[u8]) -> [usize; 2] {
        let rows = self.rows;
        let got = (0..rows.rows).flat_map(|row| {
            let start = 4 * (rows.place + row * rows.row_words);
            &outputs[start..start + rows.row_bytes]
        });
        let got: Vec<u8> = got.copied().collect();
        assert_eq!(got.len(), self.bytes.len());
        let [got, expected] = [&got, &self.bytes].map(|bytes| numbers(rows.code, bytes));
        let differ = got.iter().zip(&expected).filter(|(got, expected)| !self.agree(**got, **expected)).count();
        [differ, expected.len()]
    }

    /// Of codes as bits and as numbers.
    fn agree(&self, got: (u32, f64), expected: (u32, f64)) -> bool {
        let Some(tolerance) = self.tolerance else { return got.0 == expected.0 };
        match self.rows.code {
            CodeType::F16 => (got.1 - expected.1).abs() * 1024.0 <= tolerance.ulps,
            CodeType::F32 => (got.1 - expected.1).abs() * 8_388_608.0 <= tolerance.ulps,
            _ => (got.1 - expected.1).abs() <= tolerance.codes,
        }
    }
}

/// The codes in some bytes, as bits and as numbers.
fn numbers(code: CodeType, bytes: &[u8]) -> Vec<(u32, f64)> {
    let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte));
    let number = |bits: u32| match code {
        CodeType::U8 | CodeType::U16 | CodeType::Bits => bits.into(),
        CodeType::I8 => (bits as u8 as i8).into(),
        CodeType::I16 => (bits as u16 as i16).into(),
        CodeType::F16 => f16::from_bits(bits as u16).to_f64(),
        CodeType::F32 => f32::from_bits(bits).into(),
    };
    let bytes_of_code = match code {
        CodeType::U8 | CodeType::I8 => 1,
        CodeType::U16 | CodeType::I16 | CodeType::F16 => 2,
        CodeType::F32 | CodeType::Bits => 4,
    };
    bytes.chunks_exact(bytes_of_code).map(word).map(|bits| (bits, number(bits))).collect()
}

#[test]
fn recordings_are_what_devices_compute() {
    let samples = samples();
    for device in devices() {
        for (name, recording) in &samples {
            let outputs = recording.run(&device);
            let [differ, all] = recording.compare(&outputs);
            assert_eq!(differ, 0, "{}: {name}: of {all} values", device.name);
        }
    }
}

#[test]
fn recordings_need_what_they_hold() {
    let Some(device) = devices().into_iter().next() else { return };
    for (name, recording) in samples() {
        let untouched = vec![POISON; 4 * recording.output_words];
        let [differ, all] = recording.compare(&untouched);
        assert!(differ * 10 > all * 9, "{name}: {differ} of {all} values of poison differ");

        let outputs = recording.run(&device);
        for (number, expected) in recording.expected.iter().enumerate() {
            let mut changed = recording.clone();
            let rows = expected.rows;
            let middle = rows.rows / 2 * rows.row_bytes + rows.row_bytes / 2;
            // The sign, the exponent or the highest bit of a code of any type.
            let high_byte = middle / 4 * 4 + 3;
            changed.expected[number].bytes[high_byte.min(expected.bytes.len() - 1)] ^= 0xc0;
            assert_eq!(changed.compare(&outputs)[0], 1, "{name}: {}", expected.name);
        }
        let mut others = recording.clone();
        let half = others.inputs.len() / 2;
        others.inputs[half..].fill(0);
        assert!(others.compare(&others.run(&device))[0] > 0, "{name}: of other inputs");
    }
}
