//! The functions of kernels/shading on every device.

use super::every_baker;
use std::sync::OnceLock;
use texbake::verify::{Binding, KernelComparison, OwnKernel, Subject, Tolerance, Work};
use texbake::{Edges, Size};

/// A function of the shader library, and a call of it.
#[derive(Debug, Clone, Copy)]
pub struct ShaderFunction<'a> {
    pub wgsl: &'a str,
    /// With its arguments as `a[0]`, `a[1]` and so on, and the texture as `map` and `map_sampler`. It gives as many floats
    /// as are expected: 1 to 3 as a float or a vector, 6 as a `mat2x3`, 9 as a `mat3x3`.
    pub call: &'a str,
    pub texture: Option<&'a Texels>,
}

/// A texture of one channel, linear and repeating.
#[derive(Debug, Clone, PartialEq)]
pub struct Texels {
    pub size: Size,
    /// Row by row.
    pub values: Vec<f32>,
}

/// Arguments of a call, and what is expected of it.
#[derive(Debug, Clone, Copy)]
pub struct Call<const A: usize, const N: usize> {
    pub arguments: [f32; A],
    pub expected: [f32; N],
    /// How far each float may be from the expected one.
    pub bounds: [f32; N],
}

impl ShaderFunction<'_> {
    /// Calls the function on every device, beside the expected results: words agree if they are within the bounds, and
    /// at most so many floats more apart.
    pub fn on_every_device<const A: usize, const N: usize>(
        &self,
        calls: &[Call<A, N>],
        floats: u32,
    ) -> Vec<(String, KernelComparison)> {
        let text = self.kernel::<A, N>();
        let mut bindings = vec![Binding::Read, Binding::Read, Binding::Read, Binding::ReadWrite];
        let words = |values: &mut dyn Iterator<Item = f32>| values.map(f32::to_bits).collect::<Vec<u32>>();
        let expected = words(&mut calls.iter().flat_map(|call| call.expected));
        let mut buffers = vec![
            words(&mut calls.iter().flat_map(|call| call.arguments)),
            expected.clone(),
            words(&mut calls.iter().flat_map(|call| call.bounds)),
            // A NaN is no answer.
            vec![f32::NAN.to_bits(); N * calls.len()],
        ];
        if let Some(Texels { size, values }) = self.texture {
            bindings.extend([Binding::Texture(*size), Binding::Sampler(Edges::default())]);
            buffers.extend([words(&mut values.iter().copied()), vec![]]);
        }
        let kernel = OwnKernel { wgsl: &text, entry_point: "call", constants: &[], bindings: &bindings };
        let work = Work { buffers, workgroups: [calls.len().div_ceil(64) as u32, 1, 1] };
        // Of simpler arguments it knows no results, and gives none: they are not tried.
        let twin = |asked: &Work| if *asked == work { vec![expected.clone()] } else { Vec::new() };
        let compare = |device: &Subject| {
            let comparison = device.compare(&kernel, &twin, &work, Tolerance::Floats(floats));
            (device.name(), comparison.unwrap_or_else(|error| panic!("{}: {error}", self.call)))
        };
        devices().iter().map(compare).collect()
    }

    /// What is within its bound is written as what was expected.
    fn kernel<const A: usize, const N: usize>(&self) -> String {
        let Self { wgsl, call, texture } = self;
        let part = |i: usize| match N {
            1 => "result".to_owned(),
            2 | 3 => format!("result[{i}]"),
            6 | 9 => format!("result[{}][{}]", i / 3, i % 3),
            _ => panic!("no type has {N} floats"),
        };
        let stores = (0..N).map(|i| format!("    write({N}u * id.x + {i}u, {});\n", part(i))).collect::<String>();
        let texture = texture.map_or("", |_| {
            "@group(0) @binding(4) var map: texture_2d<f32>;
@group(0) @binding(5) var map_sampler: sampler;"
        });
        format!(
            "{wgsl}
@group(0) @binding(0) var<storage, read> arguments: array<f32>;
@group(0) @binding(1) var<storage, read> expected: array<f32>;
@group(0) @binding(2) var<storage, read> bounds: array<f32>;
@group(0) @binding(3) var<storage, read_write> results: array<f32>;
{texture}
fn write(at: u32, result: f32) {{
    results[at] = select(result, expected[at], abs(result - expected[at]) <= bounds[at]);
}}
@compute @workgroup_size(64)
fn call(@builtin(global_invocation_id) id: vec3<u32>) {{
    if (id.x >= arrayLength(&results) / {N}u) {{
        return;
    }}
    var a: array<f32, {A}>;
    for (var i = 0u; i < {A}u; i++) {{
        a[i] = arguments[{A}u * id.x + i];
    }}
    let result = {call};
{stores}}}"
        )
    }

    /// Fails unless every device agrees.
    pub fn assert_on_every_device<const A: usize, const N: usize>(&self, calls: &[Call<A, N>], floats: u32) {
        for (name, comparison) in self.on_every_device(calls, floats) {
            let Some(found) = &comparison.mismatch else {
                assert!(comparison.passed(), "{name}: {comparison:?}");
                continue;
            };
            let Call { arguments, expected, bounds } = calls[found.word / N];
            let part = found.word % N;
            let got = f32::from_bits(found.kernel);
            panic!(
                "{name}: {}: {arguments:?}: part {part} is {got:e}, not {:e} within {:e}; {} of {} differ",
                self.call, expected[part], bounds[part], comparison.differing, comparison.values
            );
        }
    }
}

/// The GPUs among the bakers, opened once for kernels of others.
fn devices() -> &'static [Subject] {
    static DEVICES: OnceLock<Vec<Subject>> = OnceLock::new();
    DEVICES.get_or_init(|| {
        let names = every_baker().iter().map(|subject| subject.name).filter(|name| name.contains(':'));
        names.map(|name| Subject::adapter(Some(name)).expect("it opened before")).collect()
    })
}
