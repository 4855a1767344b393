//! Normals perturbed with tangents and without.

use super::{assert_near, clamped, quick};
use crate::support::{Random, map_u8, plane};
use texbake::material::Material;
use texbake::measure::{FrameFigure, MeasureOptions, Measured, measure};
use texbake::stream::Monitor;
use texbake::{BakeOptions, Baker};

fn figure<'a>(figures: &'a [FrameFigure], mesh: &str, frame: &str) -> &'a FrameFigure {
    let found = figures.iter().filter(|figure| figure.mesh == mesh && figure.frame == frame);
    let [figure] = found.collect::<Vec<_>>()[..] else { panic!("not one {frame} on {mesh}") };
    figure
}

/// Degrees that a frame may be off by roundings of u = 2^-24.
///
/// Differences of positions and of texture coordinates are rounded once; a cross product is off by 5 u, a product with a
/// difference of u by 7 u. The differences to the right and down are orthogonal on a plane that lies flat, so that a
/// gradient's two parts are twice as long as their sum at most: 16 u for each of T and B. Over the longer one's length, a
/// normal of length one beside them, and the sum of the three: 16 u more. Tangents, interpolated and made orthogonal, are
/// off by as much. The sum of a sheared frame is half as long as its parts at least.
const ROUNDING: f64 = 2.0 * 48.0 / (1 << 24) as f64 * 57.3;

#[test]
fn an_even_mapping_has_one_answer_with_tangents_and_without() {
    let mut random = Random::new(7);
    let heights = map_u8(32, 32, |_, _| random.below(256) as u8);
    let bake = BakeOptions { scale: crate::support::scale("4"), ..Default::default() };
    let figures = quick(&heights, None, &MeasureOptions { bake, ..Default::default() }).frames;
    for frame in ["tangents", "tangents, sign in a bit", "cotangent frame"] {
        let it = figure(&figures, "mirrored plane", frame);
        assert!(it.to_surface_degrees.unwrap().largest < ROUNDING, "{it:?}");
        assert!(it.to_tangents_degrees.largest < ROUNDING, "{it:?}");
        assert_eq!(it.pixels, 2048);
    }
    let bytes = ["tangents", "tangents, sign in a bit", "cotangent frame", "without perspective"]
        .map(|frame| figure(&figures, "torus", frame).bytes_per_vertex);
    assert_eq!(bytes, [16, 12, 0, 0]);
    // Seen at a slant, the shortcut is wrong on the same plane.
    assert!(figure(&figures, "mirrored plane", "without perspective").to_surface_degrees.unwrap().mean > 1.0);
    // On curved surfaces the gradients are those of flat triangles: of a circle in 48 parts, up to 3.75 degrees from
    // its tangent on either side of a vertex.
    for mesh in ["sphere", "torus"] {
        assert!(figure(&figures, mesh, "cotangent frame").to_surface_degrees.unwrap().percentile_99 < 7.5);
    }
}

#[test]
fn a_sheared_mapping_shows_what_tangents_leave_out() {
    // 4 codes of 255 for each texel, 63.75 texels high: a slope of 1, for all pixels but those at the borders.
    let heights = map_u8(64, 64, |x, _| 4 * x as u8);
    let options = clamped("63.75");
    let figures = quick(&heights, None, &options).frames;
    let material = Material::bake(&Baker::cpu(), &heights, &options.bake).unwrap();
    let m = material.normals().texels()[64 * 20 + 20].map(f64::from);
    let length = m.iter().map(|part| part * part).sum::<f64>().sqrt();
    let [x, y, z] = m.map(|part| part / length);
    // u = a + b: its gradient is (1, 1) / sqrt 2 where the tangent is (1, 0); v's is (0, -1) / sqrt 2 times the ratio of
    // their lengths, where the bitangent is (0, -1).
    let half = 0.5f64.sqrt();
    let surface = [x * half, x * half - y * half, z];
    let length = surface.iter().map(|part| part * part).sum::<f64>().sqrt();
    let cosine = (x * surface[0] - y * surface[1] + z * surface[2]) / length;
    let expected = cosine.acos().to_degrees();
    let it = figure(&figures, "sheared plane", "tangents").to_surface_degrees.unwrap();
    assert!(expected > 20.0);
    assert_near(it.largest, expected, ROUNDING, "tangents of a sheared plane");
    let it = figure(&figures, "sheared plane", "cotangent frame").to_surface_degrees.unwrap();
    assert!(it.largest < ROUNDING, "{it:?}");
}

#[test]
fn models_are_measured_without_the_surface_that_nobody_knows() {
    let heights = map_u8(16, 16, |x, y| (x * y) as u8);
    let models = [("wall, primitive 0".to_owned(), plane(4, 4))];
    let measured = Measured { heights: &heights, detail: None, models: &models, devices: &[Baker::cpu()] };
    let options = MeasureOptions { quick: true, runs: 1, ..Default::default() };
    let figures = measure(&measured, &options, &Monitor::default(), &mut |_| {}).unwrap();
    let it = figure(&figures.frames, "wall, primitive 0", "cotangent frame");
    assert!(it.to_surface_degrees.is_none() && it.to_tangents_degrees.largest < ROUNDING, "{it:?}");
    assert_eq!(figures.frames.len(), 5 * 4);
}
