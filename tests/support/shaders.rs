//! The functions of kernels/shading on every device.

use super::every_baker;
use std::sync::OnceLock;
use texbake::verify::{Binding, KernelComparison, OwnKernel, Subject, Tolerance, Work};

/// A function of the shader library that gives a `vec2<f32>`, and a call of it.
#[derive(Debug, Clone, Copy)]
pub struct ShaderFunction<'a> {
    pub wgsl: &'a str,
    /// With its arguments as `a[0]`, `a[1]` and so on.
    pub call: &'a str,
}

const ARGUMENTS: usize = 8;

impl ShaderFunction<'_> {
    /// Calls the function for each element of `arguments` on every device, beside the expected results: words agree if
    /// they are at most so many floats apart.
    pub fn on_every_device(
        &self,
        arguments: &[[f32; ARGUMENTS]],
        expected: &[[f32; 2]],
        floats: u32,
    ) -> Vec<(String, KernelComparison)> {
        let Self { wgsl, call } = self;
        let text = format!(
            "{wgsl}
@group(0) @binding(0) var<storage, read> arguments: array<f32>;
@group(0) @binding(1) var<storage, read_write> results: array<f32>;
@compute @workgroup_size(64)
fn call(@builtin(global_invocation_id) id: vec3<u32>) {{
    if (id.x >= arrayLength(&results) / 2u) {{
        return;
    }}
    var a: array<f32, {ARGUMENTS}>;
    for (var i = 0u; i < {ARGUMENTS}u; i++) {{
        a[i] = arguments[{ARGUMENTS}u * id.x + i];
    }}
    let result: vec2<f32> = {call};
    results[2u * id.x] = result.x;
    results[2u * id.x + 1u] = result.y;
}}"
        );
        let bindings = [Binding::Read, Binding::ReadWrite];
        let kernel = OwnKernel { wgsl: &text, entry_point: "call", constants: &[], bindings: &bindings };
        let words = |vectors: &[f32]| -> Vec<u32> { vectors.iter().map(|part| part.to_bits()).collect() };
        // A NaN is no answer.
        let poison = vec![f32::NAN.to_bits(); 2 * expected.len()];
        let work = Work {
            buffers: vec![words(arguments.as_flattened()), poison],
            workgroups: [expected.len().div_ceil(64) as u32, 1, 1],
        };
        // Of simpler arguments it knows no results, and gives none: they are not tried.
        let twin = |asked: &Work| match *asked == work {
            true => vec![words(expected.as_flattened())],
            false => Vec::new(),
        };
        let compare = |device: &Subject| {
            let comparison = device.compare(&kernel, &twin, &work, Tolerance::Floats(floats));
            (device.name(), comparison.unwrap_or_else(|error| panic!("{call}: {error}")))
        };
        devices().iter().map(compare).collect()
    }

    /// Fails unless every device agrees.
    pub fn assert_on_every_device(&self, arguments: &[[f32; ARGUMENTS]], expected: &[[f32; 2]], floats: u32) {
        for (name, comparison) in self.on_every_device(arguments, expected, floats) {
            let Some(found) = &comparison.mismatch else {
                assert!(comparison.passed(), "{name}: {comparison:?}");
                continue;
            };
            let at = found.word / 2;
            let [kernel, twin] = [found.kernel, found.twin].map(f32::from_bits);
            panic!("{name}: {:?}: got {kernel:e}, expected {twin:e}; {comparison:?}", arguments[at]);
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
