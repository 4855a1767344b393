//! Shots on every device beside the CPU's.
//!
//! What may differ, with u = 2^-24: a ray is a few u of a distance of 8 widths off, 1e-4 texels; a texture unit weighs
//! texels in steps of 2^-8 (Vulkan's least is 2^-4, and every driver has 2^-8), along two axes; and where it filters halves
//! alone, each texel is rounded to 2^-12.
//!
//! Hills are no steeper where a map is wide, or ends. A hill's neighbouring texels differ by at most 0.07 in height and 0.09 in normal, so that samples are at most
//! 2 * 0.07/256 + 2^-12 = 8e-4 and 2 * 0.09/256 + sqrt(3) 2^-12 = 1.2e-3 off. An offset is that times the scale times the
//! cotangent of the least elevation (17 degrees), 0.022 texels, and so for each of four steps at most, and thrice a height
//! in a plane: 0.03 texels. A colour changes by (0.88 + 0.12 * 24) of the normal's error, 4.5e-3, and with 0.4 of a texel's.

#![cfg(feature = "gpu")]

use super::{TAU, heights, hills, material, wide};
use crate::support::every_baker;
use std::sync::OnceLock;
use texbake::material::{Material, ParallaxMethod};
use texbake::preview::{Camera, Look, Renderer, Samples, Shot, Surface};
use texbake::stream::Monitor;
use texbake::{BakeOptions, Baker, Convention, Edge, Edges};

const TEXELS: f32 = 0.03;
const COLOUR: f32 = 0.0045 + 0.4 * TEXELS;

fn surfaces() -> Vec<Surface> {
    texbake::preview::SheetOptions::every_surface(&[1, 4])
}

fn shot(material: &Material, surface: Surface, elevation: f32) -> Shot<'_> {
    let camera = Camera { elevation, width: 0.7 };
    Shot { material, surface, camera, look: Look::default(), count: [45, 37] }
}

fn names() -> impl Iterator<Item = &'static str> {
    every_baker().iter().map(|subject| subject.name).filter(|name| name.contains(':'))
}

fn renderers() -> &'static [Renderer] {
    static RENDERERS: OnceLock<Vec<Renderer>> = OnceLock::new();
    RENDERERS.get_or_init(|| names().map(|name| Renderer::gpu(Some(name)).expect("it opened before")).collect())
}

/// How far two offsets are apart, in texels.
fn texels(material: &Material, a: [f32; 2], b: [f32; 2]) -> f32 {
    let size = material.size();
    ((a[0] - b[0]) * size.width() as f32).hypot((a[1] - b[1]) * size.height() as f32)
}

/// The samples that are too far apart; NaN is.
fn differing(material: &Material, got: &Samples, expected: &Samples) -> Vec<usize> {
    assert_eq!((got.colours.len(), got.offsets.len()), (expected.colours.len(), expected.offsets.len()));
    let is_close = |i: &usize| {
        let colours = got.colours[*i].into_iter().zip(expected.colours[*i]);
        texels(material, got.offsets[*i], expected.offsets[*i]) < TEXELS
            && colours.into_iter().all(|(a, b)| (a - b).abs() < COLOUR)
    };
    (0..got.colours.len()).filter(|i| !is_close(i)).collect()
}

/// What a renderer and the CPU take, and the samples that are too far apart.
fn taken(renderer: &Renderer, shot: &Shot<'_>) -> (Samples, Vec<usize>) {
    let expected = shot.on_cpu(&Monitor::default()).unwrap();
    let differing = differing(shot.material, &renderer.take(shot, &Monitor::default()).unwrap(), &expected);
    (expected, differing)
}

#[test]
fn every_device_sees_what_the_cpu_sees() {
    for material in [material(&hills(), Convention::Gl), wide()] {
        for renderer in renderers() {
            for surface in surfaces() {
                for elevation in [90.0, 60.0, 25.0] {
                    let (_, differing) = taken(renderer, &shot(&material, surface, elevation));
                    assert!(differing.is_empty(), "{}: {surface} from {elevation}: {differing:?}", renderer.name());
                }
            }
        }
    }
}

/// Where something is hidden, a ray that grazes it may hit or miss: its sample differs by more than a texel from one beside
/// it.
#[test]
fn what_is_hidden_is_hidden_on_every_device() {
    let blocks = heights(|x, y| if ((4.0 * x) as i32 + (4.0 * y) as i32) % 2 == 0 { 0.95 } else { 0.05 });
    let material = material(&blocks, Convention::Gl);
    for renderer in renderers() {
        let (expected, flipped) = taken(renderer, &shot(&material, Surface::Truth, 25.0));
        let is_edge = |i: &usize| {
            let beside = [i.wrapping_sub(1), i + 1, i.wrapping_sub(45), i + 45].into_iter();
            let far = |other: &[f32; 2]| texels(&material, expected.offsets[*i], *other) > 1.0;
            beside.filter_map(|other| expected.offsets.get(other)).any(far)
        };
        let edges = (0..45 * 37).filter(is_edge).count();
        assert!(flipped.iter().all(is_edge), "{}: {flipped:?}", renderer.name());
        assert!(edges > 0 && flipped.len() < edges, "{}: {} of {edges}", renderer.name(), flipped.len());
    }
}

#[test]
fn a_wrong_kernel_is_seen() {
    let (square, wide) = (material(&hills(), Convention::Gl), wide());
    let name = names().next();
    assert!(name.is_some() || std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none(), "no device");
    let Some(name) = name else { return eprintln!("skipped: no device") };
    for (material, surface, from, to) in [
        (&square, Surface::Flat, "let l = params.light.xyz", "let l = params.light.xzy"),
        (&square, Surface::Flat, "place.y * params.down.xyz", "-place.y * params.down.xyz"),
        (&wide, Surface::Flat, "met.y / params.proportion", "met.y"),
        (&square, Surface::Mapped(ParallaxMethod::None), "vec3<f32>(x, y, z)", "vec3<f32>(x, -y, z)"),
        (&square, Surface::Mapped(ParallaxMethod::None), "params.highlight * blinn", "0.0 * blinn"),
        (&square, Surface::Mapped(ParallaxMethod::Welsh), "-0.5 * scale, v)", "0.5 * scale, v)"),
        (&wide, Surface::Mapped(ParallaxMethod::Welsh), "v, params.scale", "v, params.scale.yx"),
        (&wide, Surface::Mapped(ParallaxMethod::Limited), "v, params.scale", "v, params.scale.yx"),
        (&wide, Surface::Mapped(ParallaxMethod::Plane { limit: 3.0 }), "v, params.scale", "v, params.scale.yx"),
        (&wide, Surface::Mapped(ParallaxMethod::steps(4)), "params.step)", "params.step.yx)"),
        (&wide, Surface::Truth, "v, params.scale", "v, params.scale.yx"),
        (&square, Surface::Mapped(ParallaxMethod::steps(4)), "vec2<f32>(1.0, 0.0)", "vec2<f32>(0.9, 0.0)"),
        (&square, Surface::Truth, "method.bisections)", "0u)"),
        (&square, Surface::Truth, "height(uv + moved)", "height(uv)"),
    ] {
        let changed = Renderer::gpu(Some(name)).unwrap().with_kernel(|text| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        });
        let (_, differing) = taken(&changed, &shot(material, surface, 25.0));
        assert!(!differing.is_empty(), "{surface}: {from} as {to}");
    }
}

/// A map that is smooth wherever it mirrors or clamps, and not symmetric, so that it looks otherwise where it wraps.
fn ending(edges: Edges) -> Material {
    let waves = heights(|x, y| 0.5 + 0.2 * (TAU / 2.0 * x).cos() + 0.2 * (1.5 * TAU * y).cos());
    let options = BakeOptions { edges, ..super::options(Convention::Gl) };
    Material::bake(&Baker::cpu(), &waves, &options).unwrap()
}

/// Beyond the borders of a map, which is less than half of the picture.
#[test]
fn every_device_sees_what_is_beyond_the_borders() {
    use Edge::{Clamp, Mirror, Wrap};
    for [x, y] in [[Mirror, Clamp], [Clamp, Mirror]] {
        let (material, wrapping) = (ending(Edges { x, y }), ending(Edges { x: Wrap, y: Wrap }));
        for renderer in renderers() {
            for surface in surfaces() {
                let camera = Camera { elevation: 50.0, width: 2.5 };
                let shot = Shot { camera, ..shot(&material, surface, 50.0) };
                let (expected, differing) = taken(renderer, &shot);
                assert!(differing.is_empty(), "{}: {surface}, {x} and {y}: {differing:?}", renderer.name());
                let wrapped = renderer.take(&Shot { material: &wrapping, ..shot }, &Monitor::default()).unwrap();
                assert!(self::differing(&material, &wrapped, &expected).len() > 45 * 37 / 4, "{surface}, {x} and {y}");
            }
        }
    }
}

/// Maps of two sizes that mirror are the CPU's.
#[test]
fn maps_of_two_sizes_that_mirror_are_refused() {
    let mirror = BakeOptions { edges: Edges::both(Edge::Mirror), ..super::options(Convention::Gl) };
    let (large, small) = (hills(), super::heights_of([16, 16], |x, _| x));
    let maps = |heights| Baker::cpu().bake(heights, &mirror).unwrap();
    let (normals, parallax) = (maps(&large).normal.unwrap(), maps(&small).parallax.unwrap());
    let scale = mirror.scale.resolve(large.size()).unwrap();
    let material = Material::of_maps(&large, &normals, &parallax, scale, mirror.edges);
    for renderer in renderers() {
        let error = renderer.take(&shot(&material, Surface::Truth, 60.0), &Monitor::default()).unwrap_err().to_string();
        assert!(error.ends_with("mirror if all are of one size; use --backend cpu for these"), "{error}");
    }
}
