//! Somebody else's kernel and its twin.

use crate::support::{Random, every_baker};
use texbake::verify::{Binding, OwnKernel, Subject, Tolerance, Work};
use texbake::{Edge, Edges, Size};

const SQUARES: OwnKernel<'static> = OwnKernel {
    wgsl: "
override SHIFT: u32 = 0u;
@group(0) @binding(0) var<uniform> count: vec4<u32>;
@group(0) @binding(1) var<storage, read> a: array<u32>;
@group(0) @binding(2) var<storage, read_write> squares: array<u32>;
@compute @workgroup_size(64)
fn square(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < count.x) {
        squares[id.x] = (a[id.x] * a[id.x]) >> SHIFT;
    }
}",
    entry_point: "square",
    constants: &[("SHIFT", 3.0)],
    bindings: &[Binding::Uniform, Binding::Read, Binding::ReadWrite],
};

const POISON: u32 = 0xdead_beef;

/// Some random words below 2^16.
fn work(count: usize) -> Work {
    let mut random = Random::new(7);
    let words = (0..count).map(|_| random.below(1 << 16) as u32).collect();
    let buffers = vec![vec![count as u32, 0, 0, 0], words, vec![POISON; count]];
    Work { buffers, workgroups: [count.div_ceil(64) as u32, 1, 1] }
}

fn squares(work: &Work) -> Vec<Vec<u32>> {
    vec![work.buffers[1].iter().map(|a| a.wrapping_mul(*a) >> 3).collect()]
}

fn gpus() -> Vec<Subject> {
    let names = every_baker().iter().map(|subject| subject.name).filter(|name| name.contains(':'));
    names.map(|name| Subject::adapter(Some(name)).unwrap()).collect()
}

#[test]
fn a_kernel_and_its_twin_agree() {
    for gpu in gpus() {
        let comparison = gpu.compare(&SQUARES, &squares, &work(1000), Tolerance::Bits).unwrap();
        assert!(comparison.passed());
        assert_eq!((comparison.values, comparison.differing, comparison.mismatch), (1000, 0, None));
    }
}

#[test]
fn a_wrong_twin_is_shown_by_the_simplest_words() {
    // Wrong from 40000 on alone.
    let wrong = |work: &Work| {
        let mut answer = squares(work);
        answer[0].iter_mut().zip(&work.buffers[1]).for_each(|(square, a)| *square ^= u32::from(*a >= 40_000));
        answer
    };
    for gpu in gpus() {
        let work = work(1000);
        let comparison = gpu.compare(&SQUARES, &wrong, &work, Tolerance::Bits).unwrap();
        let wrong_words = work.buffers[1].iter().filter(|word| **word >= 40_000).count();
        assert_eq!(comparison.differing as usize, wrong_words);
        let mismatch = comparison.mismatch.unwrap();
        let words: Vec<u32> = mismatch.buffers[1].iter().copied().filter(|word| *word != 0).collect();
        assert_eq!(words, [40_000]);
        assert_eq!(mismatch.buffers[1][mismatch.word], 40_000);
        assert_eq!((mismatch.binding, mismatch.kernel, mismatch.twin), (2, 200_000_000, 200_000_001));
    }
}

#[test]
fn a_word_that_is_not_written_is_a_difference() {
    for gpu in gpus() {
        let short = Work { workgroups: [1, 1, 1], ..work(100) };
        let comparison = gpu.compare(&SQUARES, &squares, &short, Tolerance::Bits).unwrap();
        assert_eq!(comparison.differing, 36);
        assert_eq!(comparison.mismatch.unwrap().kernel, POISON);
    }
}

#[test]
fn floats_may_be_neighbours() {
    let kernel = OwnKernel {
        wgsl: "
@group(0) @binding(0) var<storage, read> a: array<u32>;
@group(0) @binding(1) var<storage, read_write> next: array<u32>;
@compute @workgroup_size(1)
fn step(@builtin(global_invocation_id) id: vec3<u32>) { next[id.x] = a[id.x] + 2u; }",
        entry_point: "step",
        constants: &[],
        bindings: &[Binding::Read, Binding::ReadWrite],
    };
    let words = vec![1f32.to_bits(), 2.5f32.to_bits()];
    let work = Work { buffers: vec![words.clone(), vec![POISON; 2]], workgroups: [2, 1, 1] };
    let twin = |work: &Work| vec![work.buffers[0].clone()];
    for gpu in gpus() {
        let of = |tolerance| gpu.compare(&kernel, &twin, &work, tolerance).unwrap();
        assert_eq!((of(Tolerance::Floats(2)).passed(), of(Tolerance::Floats(2)).largest), (true, 2));
        assert!(!of(Tolerance::Floats(1)).passed() && !of(Tolerance::Bits).passed());
    }
}

const LOOKS: &str = "
@group(0) @binding(0) var map: texture_2d<f32>;
@group(0) @binding(1) var linear: sampler;
@group(0) @binding(2) var<storage, read> uv: array<vec2<f32>>;
@group(0) @binding(3) var<storage, read_write> heights: array<f32>;
@compute @workgroup_size(1)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    heights[id.x] = textureSampleLevel(map, linear, uv[id.x] / vec2<f32>(4.0, 2.0), 0.0).r;
}";

/// Looks at a rectangle of 4 x 2 texels.
fn looks(bindings: &[Binding]) -> OwnKernel<'_> {
    OwnKernel { wgsl: LOOKS, entry_point: "look", constants: &[], bindings }
}

/// The same with the sampler of these edges.
fn bindings(x: Edge, y: Edge) -> [Binding; 4] {
    [Binding::Texture(Size::new(4, 2).unwrap()), Binding::Sampler(Edges { x, y }), Binding::Read, Binding::ReadWrite]
}

/// Sampled at the middles of texels, between them, and beyond the borders.
#[test]
fn textures_are_filtered_and_repeat() {
    let bindings = bindings(Edge::Wrap, Edge::Wrap);
    let kernel = looks(&bindings);
    let words = |floats: &[f32]| -> Vec<u32> { floats.iter().map(|float| float.to_bits()).collect() };
    let texels = [0.0, 1.0, 2.0, 3.0, 10.0, 20.0, 30.0, -40.0];
    let places = [[0.5, 0.5], [3.5, 1.5], [2.0, 0.5], [0.5, 1.0], [2.0, 1.0], [4.0, 0.5], [-0.5, 2.5], [0.75, 0.5]];
    let heights = [0.0, -40.0, 1.5, 5.0, 13.25, 1.5, 3.0, 0.25];
    let poison = vec![f32::NAN.to_bits(); places.len()];
    let work = Work {
        buffers: vec![words(&texels), vec![], words(places.as_flattened()), poison],
        workgroups: [places.len() as u32, 1, 1],
    };
    for gpu in gpus() {
        let compare = |work: &Work, heights: &[f32]| {
            gpu.compare(&kernel, &|_: &Work| vec![words(heights)], work, Tolerance::Bits).map_err(|e| e.to_string())
        };
        let comparison = compare(&work, &heights).unwrap();
        assert!(comparison.passed(), "{}: {comparison:?}", gpu.name());
        // A texel that differs is seen, and nothing is tried in its place.
        let mut other = work.clone();
        other.buffers[0][2] = 2.5f32.to_bits();
        let comparison = compare(&other, &heights).unwrap();
        assert_eq!(comparison.differing, 2);
        assert_eq!(comparison.mismatch.unwrap().buffers[0], other.buffers[0]);
        other.buffers[0].pop();
        let error = compare(&other, &heights).unwrap_err();
        assert_eq!(error, "words of a texture is 7: it must be 8, the texels of 4 x 2");
        other.buffers[1] = other.buffers[0].split_off(0);
        other.buffers[0] = work.buffers[0].clone();
        assert_eq!(compare(&other, &heights).unwrap_err(), "words of a sampler is 7: it must be 0");
        // A third is no f16.
        other = work.clone();
        other.buffers[0][2] = (1f32 / 3.0).to_bits();
        match compare(&other, &heights) {
            Ok(comparison) => assert_eq!(comparison.differing, 2),
            Err(error) => assert!(error.ends_with("it filters textures of f16 alone, and a texel is none"), "{error}"),
        }
        // The device is none the worse for it.
        assert!(compare(&work, &heights).unwrap().passed());
    }
}

/// Beyond the borders there is the border texel, along the axis that clamps.
#[test]
fn textures_clamp() {
    let words = |floats: &[f32]| -> Vec<u32> { floats.iter().map(|float| float.to_bits()).collect() };
    let texels = [0.0, 1.0, 2.0, 3.0, 10.0, 20.0, 30.0, -40.0];
    let places = [[4.0, 0.5], [9.0, 1.5], [-0.5, 2.5], [0.5, 3.0], [2.0, -1.0]];
    for (x, y, heights) in [
        (Edge::Clamp, Edge::Wrap, [3.0, -40.0, 0.0, 5.0, 13.25]),
        (Edge::Wrap, Edge::Clamp, [1.5, 15.0, -40.0, 10.0, 1.5]),
        (Edge::Clamp, Edge::Clamp, [3.0, -40.0, 10.0, 10.0, 1.5]),
    ] {
        let poison = vec![f32::NAN.to_bits(); places.len()];
        let work = Work {
            buffers: vec![words(&texels), vec![], words(places.as_flattened()), poison],
            workgroups: [places.len() as u32, 1, 1],
        };
        for gpu in gpus() {
            let compare = |bindings: &[Binding]| {
                gpu.compare(&looks(bindings), &|_: &Work| vec![words(&heights)], &work, Tolerance::Bits)
            };
            let comparison = compare(&bindings(x, y)).unwrap();
            assert!(comparison.passed(), "{}, {x} and {y}: {comparison:?}", gpu.name());
            let error = compare(&bindings(x, Edge::Mirror)).unwrap_err().to_string();
            assert_eq!(error, format!("edges of a sampler is {x},mirror: it must be wrap or clamp, for each axis"));
        }
    }
}

#[test]
fn what_does_not_fit_is_an_error() {
    for gpu in gpus() {
        let compare = |kernel, twin, work| gpu.compare(kernel, twin, work, Tolerance::Bits).unwrap_err().to_string();
        let work = work(10);
        let fewer = Work { buffers: work.buffers[..2].to_vec(), ..work.clone() };
        assert_eq!(compare(&SQUARES, &squares, &fewer), "buffers is 2: it must be 3, one for each binding");
        let short = |_: &Work| vec![vec![0; 9]];
        let error = compare(&SQUARES, &short, &work);
        assert!(error.contains("lengths of the twin's buffers is [9]: it must be [10]"), "{error}");
        let error = compare(&OwnKernel { wgsl: "fn square( {", ..SQUARES }, &squares, &work);
        assert!(error.starts_with(&gpu.name()["gpu, ".len()..]) && error.contains("expected"), "{error}");
        let error = compare(&OwnKernel { entry_point: "cube", ..SQUARES }, &squares, &work);
        assert!(error.contains("cube"), "{error}");
        let swapped = [Binding::Read, Binding::Read, Binding::ReadWrite];
        let error = compare(&OwnKernel { bindings: &swapped, ..SQUARES }, &squares, &work);
        assert!(error.to_lowercase().contains("uniform"), "{error}");
        // The device is none the worse for it.
        assert!(gpu.compare(&SQUARES, &squares, &work, Tolerance::Bits).unwrap().passed());
    }
}

#[test]
fn the_cpu_runs_no_kernel() {
    let error = Subject::cpu().compare(&SQUARES, &squares, &work(10), Tolerance::Bits).unwrap_err().to_string();
    assert!(error.ends_with("it runs no WGSL; compare on an adapter"), "{error}");
}
