//! pixel_cotangent_frame by the derivatives of real pixels: triangles that are drawn on every device, straight ahead and in
//! perspective, mirrored and from behind.
//!
//! On a triangle the texture coordinates are an affine function of the position, in perspective, too; so every difference,
//! fine or coarse, has the gradients of the triangle's edges. What remains is the interpolation, whose precision no API
//! states: it is taken that attributes of at most 4 are off by 2^-20 of that, the last 16 codes of an f32, so a difference
//! of two by e = 2^-17. T = a du1 + b du2 of a = dp2 x n and b = n x dp1 is then off by sqrt(3) e (|du1| + |du2|) +
//! e (|a| + |b|): over |T|, at most 0.00183 in any pixel of the triangles below. The 60 roundings of the formula are 2^-18.

use super::examined::f64s::{self, Vector};
use super::examined::text_of;
use crate::support::{Gpu, gpus};
use texbake::Size;
use texbake::gpu::wgpu;

/// Pixels along each side of the picture.
const SIDE: usize = 32;

/// Share of its length that T or B may be off.
const OFF: f64 = 0.00183 + 1.0 / (1 << 18) as f64;

/// A triangle: clip positions that cover the picture, positions and texture coordinates at the corners.
struct Triangle {
    clip: [[f32; 4]; 3],
    p: [[f32; 3]; 3],
    uv: [[f32; 2]; 3],
    n: [f32; 3],
}

/// What a pixel gives: T and B of the general frame, T of the shortcut.
type Pixel = [Vector; 3];

const DRAW: &str = "
struct Corner { clip: vec4<f32>, p: vec4<f32>, uv: vec4<f32>, n: vec4<f32> }
struct Varying { @builtin(position) at: vec4<f32>, @location(0) p: vec3<f32>, @location(1) uv: vec2<f32> }
@group(0) @binding(0) var<uniform> corners: array<Corner, 3>;
@group(0) @binding(1) var<storage, read_write> pixels: array<vec4<f32>>;
@vertex fn corner(@builtin(vertex_index) i: u32) -> Varying {
    return Varying(corners[i].clip, corners[i].p.xyz, corners[i].uv.xy);
}
@fragment fn pixel(v: Varying) -> @location(0) vec4<f32> {
    let n = corners[0].n.xyz;
    let frame = pixel_cotangent_frame(n, v.p, v.uv);
    let short = without_perspective(n, dpdx(v.p), dpdy(v.p), dpdx(v.uv), dpdy(v.uv));
    let at = 3u * (u32(v.at.y) * 32u + u32(v.at.x));
    pixels[at] = vec4<f32>(frame[0], 1.0);
    pixels[at + 1u] = vec4<f32>(frame[1], 1.0);
    pixels[at + 2u] = vec4<f32>(short[0], 1.0);
    return vec4<f32>(frame[2], 1.0);
}";

/// The pixels of a triangle that covers all of them.
fn draw(gpu: &Gpu, library: &str, triangle: &Triangle) -> Vec<Pixel> {
    use wgpu::util::{BufferInitDescriptor, DeviceExt};
    let pad = |corner: usize| {
        let Triangle { clip, p, uv, n } = triangle;
        let four = |part: &[f32]| std::array::from_fn::<f32, 4, _>(|at| part.get(at).copied().unwrap_or_default());
        [clip[corner], four(&p[corner]), four(&uv[corner]), four(n)].concat()
    };
    let corners: Vec<u8> = (0..3).flat_map(pad).flat_map(f32::to_le_bytes).collect();
    let poison = vec![f32::NAN; 3 * 4 * SIDE * SIDE];
    let poison: Vec<u8> = poison.into_iter().flat_map(f32::to_le_bytes).collect();
    let buffer =
        |contents: &[u8], usage| gpu.device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage });
    let corners = buffer(&corners, wgpu::BufferUsages::UNIFORM);
    let pixels = buffer(&poison, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let (size, format) = (Size::new(SIDE, SIDE).unwrap(), wgpu::TextureFormat::Rgba8Unorm);
    let target = gpu.texture(size, 1, format, wgpu::TextureUsages::RENDER_ATTACHMENT);
    let pipeline = gpu.pipeline(format!("{library}{DRAW}"), None, format);
    let bindings = [corners.as_entire_binding(), pixels.as_entire_binding()];
    gpu.draw(&pipeline, bindings, &target, wgpu::Color::TRANSPARENT);
    let bytes = gpu.read(&pixels);
    let floats: Vec<f64> =
        bytes.chunks_exact(4).map(|word| f32::from_le_bytes(word.try_into().unwrap()).into()).collect();
    floats.chunks_exact(12).map(|pixel| [0, 4, 8].map(|at| [pixel[at], pixel[at + 1], pixel[at + 2]])).collect()
}

/// T and B of the triangle's own edges, by elimination, the longer one of length one.
fn truth(Triangle { p, uv, n, .. }: &Triangle) -> [Vector; 2] {
    let edge = |corner: usize| [0, 1, 2].map(|axis| f64::from(p[corner][axis]) - f64::from(p[0][axis]));
    let growth = |corner: usize, axis: usize| f64::from(uv[corner][axis]) - f64::from(uv[0][axis]);
    let rows = [edge(1), edge(2), n.map(f64::from)];
    let [t, b] = [0, 1].map(|axis| f64s::solve(rows, [growth(1, axis), growth(2, axis), 0.0]));
    let longest = f64s::length(t).max(f64s::length(b));
    [t, b].map(|vector| f64s::times(1.0 / longest, vector))
}

/// Straight ahead, or as a floor that goes away: w grows to 4 up the picture; from the front, or from behind, by exchanged
/// corners; u turned round or not; the mapping skewed.
fn triangles() -> Vec<(String, Triangle)> {
    let mut triangles = Vec::new();
    for perspective in [false, true] {
        for from_behind in [false, true] {
            for mirrored in [false, true] {
                // Corners of a triangle that covers the picture from (-1, -1) to (1, 1).
                let w = if perspective { [1.0, 1.0, 4.0] } else { [1.0; 3] };
                let corner = |x: f32, y: f32, w: f32| [x * w, y * w, 0.5 * w, w];
                let mut clip = [corner(-1.0, -1.0, w[0]), corner(3.0, -1.0, w[1]), corner(-1.0, 3.0, w[2])];
                let mut p = [[-1.0, -1.0, 0.25], [3.0, -1.0, 0.5], [-1.0, 3.0, 1.0]];
                let u = if mirrored { -1.0 } else { 1.0 };
                let mut uv = p.map(|[x, y, _]: [f32; 3]| [u * (x + 0.5 * y), 0.75 * y]);
                if from_behind {
                    clip.swap(1, 2);
                    p.swap(1, 2);
                    uv.swap(1, 2);
                }
                // Of the interpolated normal, which leans from the face's.
                let n = [0.0, 0.28, 0.96];
                triangles.push((
                    format!("perspective {perspective}, from behind {from_behind}, mirrored {mirrored}"),
                    Triangle { clip, p, uv, n },
                ));
            }
        }
    }
    triangles
}

#[test]
fn pixels_have_the_frame_of_their_triangle() {
    for (name, gpu) in gpus(wgpu::Features::empty()) {
        for (what, triangle) in triangles() {
            let [t, b] = truth(&triangle);
            let pixels = draw(&gpu, text_of("cotangent_frame"), &triangle);
            for (at, [got_t, got_b, _]) in pixels.iter().enumerate() {
                for (got, exact) in [(got_t, t), (got_b, b)] {
                    let off = f64s::angle(*got, exact);
                    let ratio = f64s::length(*got) / f64s::length(exact);
                    // Lengths are over that of the longer one, which is off too.
                    assert!(
                        off < OFF.asin().to_degrees() && (ratio - 1.0).abs() < 2.0 * OFF / (1.0 - OFF),
                        "{name}: {what}: pixel {at}: {got:?}, {exact:?}, {off}"
                    );
                }
            }
        }
    }
}

/// The shortcut has another direction where pixels are longer than wide; Schüler's own sign points the other way, since
/// dpdy goes down the picture; and exchanged derivatives are noticed.
#[test]
fn shortcuts_and_wrong_signs_are_seen_in_pixels() {
    for (name, gpu) in gpus(wgpu::Features::empty()) {
        for (what, triangle) in triangles() {
            let [t, _] = truth(&triangle);
            let worst = |library: &str, part: usize| {
                let pixels = draw(&gpu, library, &triangle);
                pixels.iter().map(|pixel| f64s::angle(pixel[part], t)).fold(0.0, f64::max)
            };
            let text = text_of("cotangent_frame");
            assert!(worst(text, 2) > 5.0, "{name}: {what}: the shortcut is as good");
            let unsigned = text.replacen("select(-1.0, 1.0, dot(dp1, dp2perp) >= 0.0)", "1.0", 1);
            assert!(unsigned != text && worst(&unsigned, 0) > 179.0, "{name}: {what}: the sign");
            let exchanged = text.replacen("dpdx(uv), dpdy(uv))", "dpdy(uv), dpdx(uv))", 1);
            assert!(exchanged != text && worst(&exchanged, 0) > 5.0, "{name}: {what}: exchanged");
        }
    }
}
