//! Surfaces whose normals are known without a stencil.

use crate::support::{
    FILTERS, FLOAT32, Image, SNORM8, Subject, UNORM8, every_baker, map_f32, map_u8, map_u16, options,
};
use std::f64::consts::TAU;
use texbake::{Convention, Edge, Edges, HeightMap, NormalFormat, NormalOptions};

const U: f64 = 1.0 / (1 << 24) as f64;

fn bake(baker: &texbake::Baker, map: &HeightMap, options: &NormalOptions) -> Image {
    Image::from(&baker.normal(map, options).expect("a bake"))
}

/// The inner texels of a map: those with all their neighbours.
fn inner(map: &HeightMap) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (width, height) = (map.size().width(), map.size().height());
    (1..height - 1).flat_map(move |y| (1..width - 1).map(move |x| (x, y)))
}

#[test]
fn a_plane_has_one_normal() {
    // 51/255 = 1/5 of a texel per code: slopes 2/5 and 3/5, the normal (-2, -3, 5)/sqrt(38) down the rows.
    let bytes = map_u8(40, 40, |x, y| (2 * x + 3 * y) as u8);
    // 257 times the code is the same height in 16 bits.
    let words = map_u16(40, 40, |x, y| 257 * (2 * x + 3 * y) as u16);
    // 127.5 (v + 1) = 86.13, 190.55, 230.92 with green up, 65.45 in place of 190.55 with green down.
    for (convention, expected) in [(Convention::Gl, [86.0, 190.0, 231.0]), (Convention::Dx, [86.0, 65.0, 231.0])] {
        let format = NormalFormat { convention, ..UNORM8 };
        for Subject { name, baker } in every_baker() {
            for filter in FILTERS {
                for map in [&bytes, &words] {
                    let options = NormalOptions { filter, ..options("51", format) };
                    let baked = bake(baker, map, &options);
                    for (x, y) in inner(map) {
                        assert_eq!(baked.texel(x, y), expected, "{name}, {filter}, {convention}, column {x}, row {y}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_float_plane_has_one_normal() {
    // Heights, their differences and slopes 3/4 and -1 are exact: the normal is (-3, 4, 4)/sqrt(41) down the rows.
    let map = map_f32(33, 21, |x, y| 0.75 * x as f32 - y as f32);
    let length = 41f64.sqrt();
    let options = NormalOptions {
        edges: Edges::both(Edge::Mirror),
        ..options("1", NormalFormat { convention: Convention::Dx, ..FLOAT32 })
    };
    for Subject { name, baker } in every_baker() {
        let baked = bake(baker, &map, &options);
        for (x, y) in inner(&map) {
            for (got, exact) in baked.texel(x, y).into_iter().zip([-3.0 / length, 4.0 / length, 4.0 / length]) {
                // Five roundings on the way from exact slopes.
                assert!((got - exact).abs() <= 5.0 * U, "{name}, column {x}, row {y}: {got} for {exact}");
            }
        }
        // Mirrored borders are level across the border.
        assert_eq!(baked.texel(0, 5)[0], 0.0, "{name}");
        assert_eq!(baked.texel(7, 20)[1], 0.0, "{name}");
    }
}

#[test]
fn a_sinusoid_has_its_gradient() {
    let (width, height, a, b) = (128usize, 96usize, 3.0, 2.0);
    let (kx, ky) = (3.0 * TAU / width as f64, 2.0 * TAU / height as f64);
    let map = map_f32(width, height, |x, y| (a * (kx * x as f64).sin() + b * (ky * y as f64).cos()) as f32);
    // The central difference of h is h' + h'''(xi)/6 (Taylor), and h''' is at most a k^3. Every filter here averages
    // equal differences. Heights below 8 are rounded by 2^-22 at most, which moves half a difference as far; six
    // roundings, the snap below 2^-25 and the normal's own five come on top (float_heights.rs). The normal moves no
    // farther than the slopes.
    let slope_error =
        |k: f64, amplitude: f64| amplitude * k.powi(3) / 6.0 + 2f64.powi(-22) + 6.1 * U * amplitude * k + U;
    let bound = slope_error(kx, a).hypot(slope_error(ky, b)) + 5.0 * U;
    assert!(bound < 1.8e-3, "{bound}");
    for Subject { name, baker } in every_baker() {
        for filter in FILTERS {
            let format = NormalFormat { convention: Convention::Dx, ..FLOAT32 };
            let baked = bake(baker, &map, &NormalOptions { filter, ..options("1", format) });
            for i in 0..width * height {
                let (x, y) = (i % width, i / width);
                let [dx, dy] = [a * kx * (kx * x as f64).cos(), -b * ky * (ky * y as f64).sin()];
                let length = (dx * dx + dy * dy + 1.0).sqrt();
                for (got, exact) in baked.texel(x, y).into_iter().zip([-dx / length, -dy / length, 1.0 / length]) {
                    assert!((got - exact).abs() <= bound, "{name}, {filter}, ({x}, {y}): {got} for {exact}");
                }
            }
        }
    }
}

#[test]
fn the_normal_of_a_sphere_is_its_radius() {
    const RADIUS: f64 = 256.0;
    let middle = 90.0;
    let from_middle = |x: usize, y: usize| (x as f64 - middle, y as f64 - middle);
    let map = map_f32(181, 181, |x, y| {
        let (u, v) = from_middle(x, y);
        (RADIUS * RADIUS - u * u - v * v).sqrt() as f32
    });
    // Along a row h = sqrt(c^2 - u^2), h''' = -3 c^2 u / h^5 with c <= R, |u| <= 90, h >= 220; the central difference
    // is off by a sixth of that, heights below 256 by 2^-17, slopes are below 1.
    let slope_error = 3.0 * RADIUS.powi(2) * 90.0 / 220f64.powi(5) / 6.0 + 2f64.powi(-17) + 7.1 * U;
    let bound = slope_error * 2f64.sqrt() + 5.0 * U;
    assert!(bound < 2.5e-5, "{bound}");
    for Subject { name, baker } in every_baker() {
        let baked = bake(baker, &map, &options("1", FLOAT32));
        for (x, y) in inner(&map) {
            let (u, v) = from_middle(x, y);
            let h = (RADIUS * RADIUS - u * u - v * v).sqrt();
            // Green up: rows above the middle lean up.
            for (got, exact) in baked.texel(x, y).into_iter().zip([u / RADIUS, -v / RADIUS, h / RADIUS]) {
                assert!((got - exact).abs() <= bound, "{name}, ({x}, {y}): {got} for {exact}");
            }
        }
    }
}

#[test]
fn a_bump_leans_away_from_its_top() {
    let bump = |x: usize, y: usize| 200 - 10 * (x.abs_diff(4) + y.abs_diff(4));
    let maps = [
        map_u8(9, 9, |x, y| bump(x, y) as u8),
        map_u16(9, 9, |x, y| 257 * bump(x, y) as u16),
        map_f32(9, 9, |x, y| bump(x, y) as f32 / 255.0),
    ];
    for Subject { name, baker } in every_baker() {
        for map in &maps {
            let snorm = |scale, convention| bake(baker, map, &options(scale, NormalFormat { convention, ..SNORM8 }));
            let [gl, dx, hollow] = [("24", Convention::Gl), ("24", Convention::Dx), ("-24", Convention::Gl)]
                .map(|(scale, convention)| snorm(scale, convention));
            // Slope 24 * 10 / 255: 127 * 0.6854 = 87.04, 127 * 0.7282 = 92.48.
            assert_eq!(gl.texel(2, 4), [-87.0, 0.0, 92.0], "{name}: left of the top");
            assert_eq!(gl.texel(6, 4), [87.0, 0.0, 92.0], "{name}: right of the top");
            assert_eq!(gl.texel(4, 2), [0.0, 87.0, 92.0], "{name}: above the top, green up");
            assert_eq!(gl.texel(4, 6), [0.0, -87.0, 92.0], "{name}: below the top, green up");
            assert_eq!(dx.texel(4, 2), [0.0, -87.0, 92.0], "{name}: above the top, green down");
            assert_eq!(dx.texel(2, 4), [-87.0, 0.0, 92.0], "{name}: left of the top, green down");
            assert_eq!(hollow.texel(2, 4), [87.0, 0.0, 92.0], "{name}: left of the bottom");
            assert_eq!(hollow.texel(4, 2), [0.0, -87.0, 92.0], "{name}: above the bottom");
            assert_eq!(gl.texel(4, 4), [0.0, 0.0, 127.0], "{name}: the top");
        }
    }
}
