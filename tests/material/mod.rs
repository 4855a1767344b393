//! Materials as a scene samples them: where rays meet the relief.

use crate::support::Random;
use texbake::material::Material;
use texbake::{BakeOptions, Baker, Edge, Edges, Grid, HeightMap, Scale};

/// A material of heights, with `along` and `down` texels of height on its axes.
fn material(heights: &HeightMap, [along, down]: [i64; 2], edge: Edge) -> Material {
    let size = heights.size();
    // A map as wide as texels / scale has its depth of one as high as the scale.
    let extent = |texels: usize, scale: i64| texbake::Rational::new(texels as i64, scale.abs()).unwrap();
    let depth = if along < 0 { -1 } else { 1 };
    let scale = Scale::physical(extent(size.width(), along), extent(size.height(), down), depth.into());
    let options = BakeOptions { scale, edges: Edges::both(edge), ..Default::default() };
    Material::bake(&Baker::cpu(), heights, &options).unwrap()
}

/// A wall between texels 3 and 4 of eight, four texels high, under a ray of 45 degrees, x = p + 4 z.
#[test]
fn a_wall_is_met_or_passed_where_it_should_be() {
    let heights = HeightMap::from(Grid::from_fn(8, 1, |x, _| if x < 4 { 0u8 } else { 255 }).unwrap());
    let material = material(&heights, [4, 4], Edge::Clamp);
    let eye = [0.5f32.sqrt(), 0.0, 0.5f32.sqrt()];
    for (p, texels) in [
        // It enters above the wall, which is as high as heights can be.
        (5.5, 2.0),
        (2.0, 2.0),
        // It enters above the wall's slope, over 0.9, which falls faster than the ray, down to the ground.
        (1.9, -2.0),
        // It comes down on the ground, far from the wall.
        (-1.0, -2.0),
    ] {
        let [u, v] = material.intersection([(p + 0.5) / 8.0, 0.5], eye).unwrap();
        assert!((f64::from(u) * 8.0 - texels).abs() < 1e-5 && v == 0.0, "{p}: {u} {v}");
    }
    // From the other side the slope is met: x = p - 4 z, and x - 3 = 1/2 + z at z = (p - 3.5) / 5.
    let [u, _] = material.intersection([(3.0 + 0.5) / 8.0, 0.5], [-eye[0], 0.0, eye[2]]).unwrap();
    assert!((f64::from(u) * 8.0 - -4.0 * (3.0 - 3.5) / 5.0).abs() < 1e-5, "{u}");
}

/// A point is the first one of the relief on its ray if it is on the relief and the ray above it is free, which is looked
/// at in five thousand places.
#[test]
fn rays_end_at_the_first_point_of_the_relief() {
    const PLACES: usize = 5_000;
    let mut random = Random::new(0x5ee);
    let mut unit = move || random.below(1 << 20) as f64 / f64::from(1 << 20);
    let mut met = 0;
    for (width, height, scale, edge) in [
        (7, 5, [3, 3], Edge::Wrap),
        (16, 4, [12, 3], Edge::Wrap),
        (5, 9, [2, 5], Edge::Clamp),
        (6, 6, [-4, -4], Edge::Mirror),
        (3, 8, [-9, -2], Edge::Wrap),
        (1, 1, [4, 4], Edge::Mirror),
    ] {
        let heights = HeightMap::from(Grid::from_fn(width, height, |_, _| (256.0 * unit()) as u8).unwrap());
        let material = material(&heights, scale, edge);
        let side = if scale[0] < 0 { -1.0 } else { 1.0 };
        for view in 0..60 {
            let uv = [unit() as f32, unit() as f32];
            let (turn, rise) = (std::f64::consts::TAU * unit(), 0.2 + 1.3 * unit());
            // Along the axes too, where a ray stays in a row of cells.
            let turn = if view % 6 == 0 { std::f64::consts::FRAC_PI_2 * f64::from(view / 6 % 4) } else { turn };
            let eye = [turn.cos() * rise.cos(), turn.sin() * rise.cos(), rise.sin()];
            let found = material.intersection(uv, eye.map(|part| part as f32)).unwrap();
            let slant = [0, 1].map(|axis| {
                let texels = [width, height][axis] as f64;
                scale[axis].abs() as f64 / texels * f64::from(eye[axis] as f32) / f64::from(eye[2] as f32)
            });
            let longer = if slant[0].abs() > slant[1].abs() { 0 } else { 1 };
            let z = f64::from(found[longer]) / slant[longer];
            // How far the ray is above the relief at a height.
            let clearance = |z: f64| {
                let at = [0, 1].map(|axis| f64::from(uv[axis]) + slant[axis] * z);
                z - side * (bilinear(&heights, at, edge) - 0.5)
            };
            // f32 coordinates are off by 2^-24 of themselves, and heights rise by one within a texel at most.
            let rounding = 1e-5 * (1.0 + scale[0].abs() as f64);
            let is_at_top = (z - 0.5).abs() < 1e-6 && clearance(z) <= rounding;
            assert!(is_at_top || clearance(z).abs() < rounding, "{uv:?} {eye:?}: {z}, {}", clearance(z));
            for place in 0..PLACES {
                let above = 0.5 - (0.5 - z) * place as f64 / PLACES as f64;
                assert!(clearance(above) > -rounding, "{uv:?} {eye:?}: {z} is behind {above}");
            }
            met += usize::from(z < 0.45);
        }
    }
    assert!(met > 200, "{met}");
}

#[test]
fn a_ray_that_cannot_be_followed_is_refused() {
    let heights = HeightMap::from(Grid::new(1, 1, vec![0u8]).unwrap());
    let material = material(&heights, [1000, 1000], Edge::Wrap);
    let error = material.intersection([0.0; 2], [1.0, 0.0, 0.01]).unwrap_err().to_string();
    assert!(error.starts_with("scale is 1000: it must be at most 16"), "{error}");
}

/// Heights between the centres of texels, in f64.
fn bilinear(heights: &HeightMap, uv: [f64; 2], edge: Edge) -> f64 {
    let (width, height) = (heights.size().width() as i64, heights.size().height() as i64);
    let texbake::Heights::U8(codes) = heights.heights() else { unreachable!("the maps of this test") };
    let resolve = |i: i64, n: i64| match edge {
        Edge::Wrap => i.rem_euclid(n),
        Edge::Clamp => i.clamp(0, n - 1),
        // Back and forth between both ends.
        Edge::Mirror => {
            let (mut at, mut way) = (0, 1);
            for _ in 0..i.abs() {
                if n > 1 {
                    way = if at == n - 1 {
                        -1
                    } else if at == 0 {
                        1
                    } else {
                        way
                    };
                    at += way;
                }
            }
            at
        }
    };
    let texel = |x: i64, y: i64| f64::from(codes[(resolve(y, height) * width + resolve(x, width)) as usize]) / 255.0;
    let [x, y] = [uv[0] * width as f64 - 0.5, uv[1] * height as f64 - 0.5];
    let (left, top) = (x.floor(), y.floor());
    let (across, down) = (x - left, y - top);
    let (i, j) = (left as i64, top as i64);
    let above = texel(i, j) * (1.0 - across) + texel(i + 1, j) * across;
    let below = texel(i, j + 1) * (1.0 - across) + texel(i + 1, j + 1) * across;
    above * (1.0 - down) + below * down
}
