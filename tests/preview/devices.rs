//! Shots on every device beside the CPU's.
//!
//! What may differ, with u = 2^-24: a ray is a few u of a distance of 8 widths off, 1e-4 texels; a texture unit weighs
//! texels in steps of 2^-8 (Vulkan's least is 2^-4, and every driver has 2^-8), along two axes; and where it filters halves
//! alone, each texel is rounded to 2^-12.
//!
//! A hill's neighbouring texels differ by at most 0.07 in height and 0.09 in normal, so that samples are at most
//! 2 * 0.07/256 + 2^-12 = 8e-4 and 2 * 0.09/256 + sqrt(3) 2^-12 = 1.2e-3 off. An offset is that times the scale times the
//! cotangent of the least elevation (17 degrees), 0.022 texels, and so for each of four steps at most, and thrice a height
//! in a plane: 0.03 texels. A colour changes by (0.88 + 0.12 * 24) of the normal's error, 4.5e-3, and with 0.4 of a texel's.

#![cfg(feature = "gpu")]

use super::{SIDE, heights, hills, material};
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

/// How many samples are too far apart; NaN is.
fn differing(got: &Samples, expected: &Samples) -> usize {
    assert_eq!((got.colours.len(), got.offsets.len()), (expected.colours.len(), expected.offsets.len()));
    let is_close = |i: &usize| {
        let [a, b] = [got.offsets[*i], expected.offsets[*i]];
        let texels = SIDE as f32 * (a[0] - b[0]).hypot(a[1] - b[1]);
        let colours = got.colours[*i].into_iter().zip(expected.colours[*i]);
        texels < TEXELS && colours.into_iter().all(|(a, b)| (a - b).abs() < COLOUR)
    };
    (0..got.colours.len()).filter(|i| !is_close(i)).count()
}

#[test]
fn every_device_sees_what_the_cpu_sees() {
    let material = material(&hills(), Convention::Gl);
    for renderer in renderers() {
        for surface in surfaces() {
            for elevation in [90.0, 60.0, 25.0] {
                let shot = shot(&material, surface, elevation);
                let got = renderer.take(&shot, &Monitor::default()).unwrap();
                let expected = shot.on_cpu(&Monitor::default()).unwrap();
                let differing = differing(&got, &expected);
                assert_eq!(differing, 0, "{}: {surface} from {elevation}", renderer.name());
            }
        }
    }
}

/// Where something is hidden, a ray that grazes it may hit or miss: single samples along the edges.
#[test]
fn what_is_hidden_is_hidden_on_every_device() {
    let blocks = heights(|x, y| if ((4.0 * x) as i32 + (4.0 * y) as i32) % 2 == 0 { 0.95 } else { 0.05 });
    let material = material(&blocks, Convention::Gl);
    for renderer in renderers() {
        let shot = shot(&material, Surface::Truth, 25.0);
        let got = renderer.take(&shot, &Monitor::default()).unwrap();
        let expected = shot.on_cpu(&Monitor::default()).unwrap();
        let flipped = differing(&got, &expected);
        assert!(flipped * 100 < 45 * 37, "{}: {flipped} of {}", renderer.name(), 45 * 37);
    }
}

#[test]
fn a_wrong_kernel_is_seen() {
    let material = material(&hills(), Convention::Gl);
    let name = names().next();
    assert!(name.is_some() || std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none(), "no device");
    let Some(name) = name else { return eprintln!("skipped: no device") };
    for (surface, from, to) in [
        (Surface::Flat, "let l = params.light.xyz", "let l = params.light.xzy"),
        (Surface::Flat, "place.y * params.down.xyz", "-place.y * params.down.xyz"),
        (Surface::Flat, "met.y / params.proportion", "met.y / 1.01"),
        (Surface::Mapped(ParallaxMethod::None), "vec3<f32>(x, y, z)", "vec3<f32>(x, -y, z)"),
        (Surface::Mapped(ParallaxMethod::None), "params.highlight * blinn", "0.0 * blinn"),
        (Surface::Mapped(ParallaxMethod::Welsh), "-0.5 * params.scale, v)", "0.5 * params.scale, v)"),
        (Surface::Mapped(ParallaxMethod::steps(4)), "vec2<f32>(1.0, 0.0)", "vec2<f32>(0.9, 0.0)"),
        (Surface::Truth, "params.bisections)", "0u)"),
        (Surface::Truth, "height(uv + moved)", "height(uv)"),
    ] {
        let changed = Renderer::gpu(Some(name)).unwrap().with_kernel(|text| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        });
        let shot = shot(&material, surface, 25.0);
        let got = changed.take(&shot, &Monitor::default()).unwrap();
        let differing = differing(&got, &shot.on_cpu(&Monitor::default()).unwrap());
        assert!(differing > 0, "{surface}: {from} as {to}");
    }
}

/// The device's sampler repeats; other edges are the CPU's.
#[test]
fn edges_that_do_not_wrap_are_refused() {
    let options = BakeOptions { edges: Edges { x: Edge::Wrap, y: Edge::Clamp }, ..super::options(Convention::Gl) };
    let material = Material::bake(&Baker::cpu(), &hills(), &options).unwrap();
    for renderer in renderers() {
        let error = renderer.take(&shot(&material, Surface::Truth, 60.0), &Monitor::default()).unwrap_err().to_string();
        assert!(error.ends_with("it renders maps that wrap; use --backend cpu for other edges"), "{error}");
    }
}
