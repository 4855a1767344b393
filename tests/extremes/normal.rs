//! Height maps into normal maps.

use super::{Expected, assert_all_normals, assert_normals, assert_refused, same};
use crate::support::{
    BIASED8, EDGES, FILTERS, FLOAT16, FLOAT32, FORMATS, Image, SNORM8, SNORM16, Subject, UNORM8, UNORM16, assert_each,
    dx, every_baker, map_f32, map_u8, map_u16, options, xy,
};
use texbake::{Edge, Edges, Grid, HeightMap, NormalFormat, NormalOptions, Scale, Size};

/// Four texels in a row that wrap: two at 0, two at 1. The full step is half a height for each of them: the slopes are
/// -s/2, s/2, s/2, -s/2.
fn step() -> HeightMap {
    map_u8(4, 1, |x, _| if x < 2 { 0 } else { 255 })
}

/// The texels of [`step`]: one for a falling and one for a rising slope.
fn of_step(falling: &[f64], rising: &[f64]) -> Vec<f64> {
    [falling, rising, rising, falling].concat()
}

fn assert_step(scale: &str, expected: &[(NormalFormat, [f64; 3], [f64; 3])]) {
    for (format, falling, rising) in expected {
        assert_normals(&step(), &options(scale, *format), &of_step(falling, rising));
    }
}

const FLAT: [Expected<'_>; 8] = [
    (FORMATS[0], &[128.0, 128.0, 255.0]),
    (FORMATS[1], &[32_768.0, 32_768.0, 65_535.0]),
    (FORMATS[2], &[0.0, 0.0, 127.0]),
    (FORMATS[3], &[0.0, 0.0, 32_767.0]),
    (FORMATS[4], &[128.0, 128.0, 255.0]),
    (FORMATS[5], &[32_768.0, 32_768.0, 65_535.0]),
    (FORMATS[6], &[0.0, 0.0, 1.0]),
    (FORMATS[7], &[0.0, 0.0, 1.0]),
];

/// Every texel of a map is flat, in every format, to the sign of zero.
fn assert_flat(map: &HeightMap, scale: &str, edges: Edges) {
    for (format, texel) in FLAT {
        assert_all_normals(map, &NormalOptions { edges, ..options(scale, format) }, texel);
    }
}

#[test]
fn scale_zero() {
    assert_flat(&step(), "0", Edges::default());
    assert_flat(&map_f32(4, 4, |x, y| if (x + y) % 2 == 0 { f32::MAX } else { f32::MIN }), "0", Edges::default());
}

#[test]
fn scale_of_a_million_full_step() {
    assert_step(
        "1e6",
        &[
            (UNORM8, [255.0, 128.0, 128.0], [0.0, 128.0, 128.0]),
            (SNORM8, [127.0, 0.0, 0.0], [-127.0, 0.0, 0.0]),
            (BIASED8, [255.0, 128.0, 128.0], [1.0, 128.0, 128.0]),
            (UNORM16, [65_535.0, 32_768.0, 32_768.0], [0.0, 32_768.0, 32_768.0]),
            (SNORM16, [32_767.0, 0.0, 0.0], [-32_767.0, 0.0, 0.0]),
            (FLOAT32, [1.0, 0.0, 2e-6], [-1.0, 0.0, 2e-6]),
            // 34 of the half float's least steps of 2^-24.
            (FLOAT16, [1.0, 0.0, 34.0 / 16_777_216.0], [-1.0, 0.0, 34.0 / 16_777_216.0]),
        ],
    );
}

#[test]
fn scale_of_a_millionth_full_step() {
    assert_step(
        "1e-6",
        &[
            (UNORM8, [128.0, 128.0, 255.0], [127.0, 128.0, 255.0]),
            (SNORM8, [0.0, 0.0, 127.0], [0.0, 0.0, 127.0]),
            (BIASED8, [128.0, 128.0, 255.0], [128.0, 128.0, 255.0]),
            (UNORM16, [32_768.0, 32_768.0, 65_535.0], [32_767.0, 32_768.0, 65_535.0]),
            (SNORM16, [0.0, 0.0, 32_767.0], [0.0, 0.0, 32_767.0]),
            (FLOAT32, [5e-7, 0.0, 1.0], [-5e-7, 0.0, 1.0]),
            // 8 steps of 2^-24.
            (FLOAT16, [8.0 / 16_777_216.0, 0.0, 1.0], [-8.0 / 16_777_216.0, 0.0, 1.0]),
        ],
    );
}

#[test]
fn greatest_scale_full_step() {
    assert_step(
        "16777215",
        &[
            (UNORM16, [65_535.0, 32_768.0, 32_768.0], [0.0, 32_768.0, 32_768.0]),
            (SNORM16, [32_767.0, 0.0, 0.0], [-32_767.0, 0.0, 0.0]),
            // 2/16777215 = 2^-23 (1 + 2^-24 + ...): 2^-23 is the nearest float.
            (FLOAT32, [1.0, 0.0, 1.0 / 8_388_608.0], [-1.0, 0.0, 1.0 / 8_388_608.0]),
        ],
    );
}

/// A slope of 1/(2 * 65535 * 16777215), 4.5e-13, is a tilt of 1.5e-8 of a 16-bit code from the tie at 32767.5.
#[test]
fn least_scale_one_code() {
    let map = map_u16(4, 1, |x, _| if x < 2 { 7 } else { 8 });
    let [falling, rising] = [[32_768.0, 32_768.0, 65_535.0], [32_767.0, 32_768.0, 65_535.0]];
    assert_normals(&map, &options("1/16777215", UNORM16), &of_step(&falling, &rising));
    let slope = 4.547_543_169_917_183e-13;
    assert_normals(&map, &options("1/16777215", FLOAT32), &of_step(&[slope, 0.0, 1.0], &[-slope, 0.0, 1.0]));
}

#[test]
fn scale_beyond_24_bits() {
    for (scale, shown) in [("16777216", "16777216"), ("-16777215.5", "-16777215.5")] {
        assert_refused(
            |baker| baker.normal(&step(), &options(scale, UNORM8)),
            &format!("scale is {shown}: it must be between -16777215 and 16777215 texels"),
        );
    }
}

/// 3.14159265358979 needs more than 24 bits; of all ratios that do not, 5419351/1725033 is nearest, 3e-14 off.
#[test]
fn scale_of_many_digits() {
    let used = options("3.14159265358979", UNORM8).scale.resolve(Size::new(4, 1).expect("a size")).expect("a scale");
    assert_eq!((used.x, used.y, used.q, used.exact), (5_419_351, 5_419_351, 1_725_033, false));
    // A slope of pi/2: -0.843545.. 0.537054..
    assert_step(
        "3.14159265358979",
        &[
            (UNORM8, [235.0, 128.0, 196.0], [20.0, 128.0, 196.0]),
            (SNORM16, [27_641.0, 0.0, 17_597.0], [-27_641.0, 0.0, 17_597.0]),
        ],
    );
}

#[test]
fn negative_scale() {
    // A slope of -+1.
    assert_step("-2", &[(SNORM8, [-90.0, 0.0, 90.0], [90.0, 0.0, 90.0])]);
}

#[test]
fn physical_size_of_zero() {
    for size in [0, -2] {
        let scale = Scale::physical(size.into(), 2.into(), 1.into());
        assert_refused(
            |baker| baker.normal(&step(), &NormalOptions { scale, ..Default::default() }),
            &format!("size is {size}: it must be above zero"),
        );
    }
}

#[test]
fn f32_max_beside_minus_f32_max() {
    // Central differences of -2 MAX, 0, 2 MAX and 0.
    let map = map_f32(4, 1, |x, _| [f32::MAX, 0.0, f32::MIN, 0.0][x]);
    for (format, flat, down, up) in [
        (UNORM8, [128.0, 128.0, 255.0], [255.0, 128.0, 128.0], [0.0, 128.0, 128.0]),
        (SNORM16, [0.0, 0.0, 32_767.0], [32_767.0, 0.0, 0.0], [-32_767.0, 0.0, 0.0]),
        // z is 1/MAX, below 2^-100.
        (FLOAT32, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
    ] {
        assert_normals(&map, &options("1", format), &[flat, down, flat, up].concat());
        assert_normals(&map, &options("16777215", format), &[flat, down, flat, up].concat());
    }
    // Both axes at once: 45 degrees between them.
    let corner = map_f32(4, 4, |x, y| if [x, y] == [0, 1] || [x, y] == [1, 0] { f32::MAX } else { 0.0 });
    let mut codes = [0.0, 0.0, 127.0].repeat(16);
    for (x, y, texel) in [
        (1, 1, [90.0, -90.0, 0.0]),
        (3, 1, [-127.0, 0.0, 0.0]),
        (1, 3, [0.0, 127.0, 0.0]),
        (0, 0, [-90.0, 90.0, 0.0]),
        (2, 0, [127.0, 0.0, 0.0]),
        (0, 2, [0.0, -127.0, 0.0]),
    ] {
        codes[3 * (4 * y + x)..][..3].copy_from_slice(&texel);
    }
    assert_normals(&corner, &options("1", SNORM8), &codes);
}

#[test]
fn subnormal_heights() {
    let map = map_f32(4, 4, |x, y| f32::from_bits(if (x / 2 + y) % 2 == 0 { 1 } else { 0x007f_ffff }));
    assert_flat(&map, "16777215", Edges::default());
    assert_flat(&map, "-1/16777215", Edges::both(Edge::Mirror));
}

/// 2^-90 is the first height that is not zero; its slope is far below 2^-25.
#[test]
fn float_heights_of_2_to_the_minus_90() {
    for height in [2f32.powi(-90), 2f32.powi(-91), -2f32.powi(-90)] {
        assert_flat(&map_f32(4, 1, |x, _| if x < 2 { 0.0 } else { height }), "16777215", Edges::default());
    }
}

#[test]
fn float_slopes_of_2_to_the_minus_25() {
    let least = 2f64.powi(-25);
    for (rise, slope) in [(2f32.powi(-24), least), (2f32.powi(-24) - 2f32.powi(-48), 0.0)] {
        let map = map_f32(4, 1, |x, _| if x < 2 { 0.0 } else { rise });
        let expected = of_step(&[slope, 0.0, 1.0], &[-slope, 0.0, 1.0]);
        // The lesser's -0 is +0.
        let expected: Vec<f64> = expected.into_iter().map(|part| part + 0.0).collect();
        assert_normals(&map, &options("1", FLOAT32), &expected);
    }
}

/// Half floats have nothing below 2^-24; from 2^-25 on that is the nearest.
#[test]
fn half_float_results_below_2_to_the_minus_24() {
    let least = 2f64.powi(-24);
    for scale in ["1/8388608", "1/16777215"] {
        assert_step(scale, &[(FLOAT16, [least, 0.0, 1.0], [-least, 0.0, 1.0])]);
    }
    // 1/(2 * 16777215 * 255) is below 2^-25: zero, with its sign.
    let map = map_u8(4, 1, |x, _| if x < 2 { 0 } else { 1 });
    assert_normals(&map, &options("1/16777215", FLOAT16), &of_step(&[0.0, 0.0, 1.0], &[-0.0, 0.0, 1.0]));
}

#[test]
fn negative_zero_heights() {
    assert_flat(&map_f32(5, 3, |x, y| if (x * y) % 2 == 0 { -0.0 } else { 0.0 }), "24", Edges::default());
}

/// Heights of 1e30 and one texel 2^77 higher, the next float: the difference alone counts.
#[test]
fn small_steps_of_huge_heights() {
    let next = f32::from_bits(1e30f32.to_bits() + 1);
    let map = map_f32(4, 1, |x, _| if x < 2 { 1e30 } else { next });
    let texels = of_step(&[127.0, 0.0, 0.0], &[-127.0, 0.0, 0.0]);
    assert_normals(&map, &options("1/16777215", SNORM8), &texels);
}

#[test]
fn height_that_is_nan() {
    refuse_height(f32::NAN, "NaN");
}

#[test]
fn height_that_is_infinite() {
    refuse_height(f32::INFINITY, "inf");
    refuse_height(f32::NEG_INFINITY, "-inf");
}

/// The first in reading order is named.
fn refuse_height(value: f32, shown: &str) {
    let heights = |i: usize| if i == 5 || i == 6 { value } else { 0.5 };
    assert_refused(
        |baker| {
            let map = HeightMap::try_from(Grid::from_fn(3, 3, |x, y| heights(3 * y + x))?)?;
            baker.normal(&map, &NormalOptions::default())
        },
        &format!(
            "the height at column 2, row 1 is {shown}: heights must be finite numbers; replace it in the map, or export \
             the map without no-data texels"
        ),
    );
}

#[test]
fn one_texel() {
    for edge in EDGES {
        assert_flat(&map_u16(1, 1, |_, _| 40_000), "16777215", Edges::both(edge));
        assert_flat(&map_f32(1, 1, |_, _| f32::MAX), "16777215", Edges::both(edge));
    }
}

/// 0, 51 and 255 of 255: with s = 10 and clamped, slopes of 1, 5 and 4 along the row or the column, none across.
fn ramp(along_x: bool) -> (HeightMap, Vec<[f64; 2]>) {
    let height = |i: usize| [0, 51, 255][i];
    // 127 (1, 1)/sqrt(2), 127 (5, 1)/sqrt(26), 127 (4, 1)/sqrt(17).
    let parts = vec![[90.0, 90.0], [125.0, 25.0], [123.0, 31.0]];
    (if along_x { map_u8(3, 1, |x, _| height(x)) } else { map_u8(1, 3, |_, y| height(y)) }, parts)
}

#[test]
fn one_row() {
    for across in EDGES {
        let (map, parts) = ramp(true);
        let edges = Edges { x: Edge::Clamp, y: across };
        let texels: Vec<f64> = parts.iter().flat_map(|&[lean, z]| [-lean, 0.0, z]).collect();
        for filter in FILTERS {
            assert_normals(&map, &NormalOptions { edges, filter, ..options("10", SNORM8) }, &texels);
        }
    }
}

#[test]
fn one_column() {
    for across in EDGES {
        let (map, parts) = ramp(false);
        let edges = Edges { x: across, y: Edge::Clamp };
        let texels: Vec<f64> = parts.iter().flat_map(|&[lean, z]| [0.0, lean, z]).collect();
        for filter in FILTERS {
            assert_normals(&map, &NormalOptions { edges, filter, ..options("10", SNORM8) }, &texels);
        }
    }
}

#[test]
fn two_texels_that_wrap() {
    for edge in [Edge::Wrap, Edge::Mirror] {
        for filter in FILTERS {
            let options = NormalOptions { edges: Edges::both(edge), filter, ..options("16777215", UNORM8) };
            let map = map_u8(2, 2, |x, y| [[0, 255], [255, 7]][y][x]);
            assert_all_normals(&map, &options, &[128.0, 128.0, 255.0]);
        }
    }
}

#[test]
fn two_texels_that_clamp() {
    // Half of the step of 1, s = 2: a slope of 1 for both.
    let map = map_u8(2, 1, |x, _| [0, 255][x]);
    let options = NormalOptions { edges: Edges::both(Edge::Clamp), ..options("2", SNORM8) };
    assert_all_normals(&map, &options, &[-90.0, 0.0, 90.0]);
}

#[test]
fn one_row_that_mirrors() {
    // The end texels have the same neighbour twice.
    let (map, _) = ramp(true);
    let options = NormalOptions { edges: Edges::both(Edge::Mirror), ..options("10", SNORM8) };
    assert_normals(&map, &options, &[0.0, 0.0, 127.0, -125.0, 0.0, 25.0, 0.0, 0.0, 127.0]);
}

/// Scharr's sums of full steps are 16 * 65535: products of 123 bits. The slope is s/2 by every filter.
#[test]
fn greatest_sums_of_every_filter() {
    let map = map_u16(4, 4, |x, _| if x < 2 { 0 } else { 65_535 });
    for filter in FILTERS {
        for (format, falling, rising) in [
            // z is 65535/2 (1 + 1.2e-7) = 32767.504.
            (UNORM16, [65_535.0, 32_768.0, 32_768.0], [0.0, 32_768.0, 32_768.0]),
            (SNORM16, [32_767.0, 0.0, 0.0], [-32_767.0, 0.0, 0.0]),
        ] {
            let texels = of_step(&falling, &rising).repeat(4);
            assert_normals(&map, &NormalOptions { filter, ..options("16777215", format) }, &texels);
        }
    }
}

#[test]
fn ties_at_zero() {
    // Each axis without a slope lies half-way between 127 and 128.
    assert_step("2", &[(UNORM8, [218.0, 128.0, 218.0], [37.0, 128.0, 218.0])]);
    assert_normals(&step(), &options("2", dx(UNORM8)), &of_step(&[218.0, 128.0, 218.0], &[37.0, 128.0, 218.0]));
    assert_step("2", &[(UNORM16, [55_938.0, 32_768.0, 55_938.0], [9_597.0, 32_768.0, 55_938.0])]);
}

#[test]
fn ties_under_either_convention() {
    // A column of slopes of -+4/3 down the rows: y = +-4/5 up, 229.5 and 25.5: both go up, so 230 + 26 is 256.
    let map = map_u8(1, 4, |_, y| if y < 2 { 0 } else { 255 });
    for (format, first, others) in [(UNORM8, 26.0, 230.0), (dx(UNORM8), 230.0, 26.0)] {
        let texel = |y: f64| [128.0, y, 204.0];
        let texels = [texel(first), texel(others), texel(others), texel(first)].concat();
        assert_normals(&map, &options("8/3", format), &texels);
    }
}

#[test]
fn steepest_slope_in_two_channels() {
    for (format, codes) in [(xy(SNORM8), [127.0, 0.0, -127.0]), (xy(UNORM16), [65_535.0, 32_768.0, 0.0])] {
        let texels = of_step(&[codes[0], codes[1]], &[codes[2], codes[1]]);
        assert_normals(&step(), &options("16777215", format), &texels);
    }
}

/// One texel, on every baker.
pub fn assert_texel(map: &HeightMap, scale: &str, format: NormalFormat, [x, y]: [usize; 2], numbers: [f64; 3]) {
    assert_each(every_baker().iter(), |Subject { name, baker }| {
        let baked = Image::from(&baker.normal(map, &options(scale, format)).expect("a bake"));
        same(&format!("{name}, {scale}, {format:?}"), &baked.texel(x, y).as_slice(), &numbers.as_slice())
    });
}

/// 0 < x <= 1 and x = E/255 with E even are the components that lie half-way between two 8-bit codes. Of a normal
/// (a, b, c)/d in lowest terms:
///
/// - d divides 255: two of a, b and c are even, so two of the components are ties;
/// - else one may be, as 26/39 is in (26, 29, 2)/39.
///
/// Heights of 8 bits have differences of 255 at most, so a/b is one of them over another; c is whatever a scale makes it.
fn quadruples() -> Vec<[i64; 4]> {
    let mut found = std::collections::BTreeSet::new();
    let mut add = |[a, b, c]: [i64; 3]| {
        let common = [a, b, c].into_iter().fold(0, num_integer::gcd);
        let [a, b, c] = [a / common, b / common, c / common];
        let d = root(a * a + b * b + c * c).expect("a quadruple");
        found.extend([[a, b, c, d], [b, a, c, d]]);
    };
    for even in (2..255).step_by(2) {
        let rest = 255 * 255 - even * even;
        for (gx, gy) in (0..256).flat_map(|gx| (0..256).map(move |gy| (gx, gy))) {
            // x is E/255, along gx: c = sqrt(gx^2 (255^2 - E^2) - gy^2 E^2) where a = gx E.
            if let Some(c) = root(gx * gx * rest - gy * gy * even * even).filter(|c| *c > 0) {
                add([gx * even, gy * even, c]);
            }
            // z is E/255: the lean's length is sqrt(255^2 - E^2).
            let square = gx * gx + gy * gy;
            if let Some(lean) = root(square * rest).filter(|lean| *lean > 0) {
                add([gx * lean, gy * lean, even * square]);
            }
        }
    }
    found.into_iter().collect()
}

/// The root of a square.
fn root(square: i64) -> Option<i64> {
    let root = (square.max(0) as f64).sqrt().round() as i64;
    (root * root == square).then_some(root)
}

#[test]
fn every_pythagorean_tie() {
    let quadruples = quadruples();
    assert_eq!(quadruples.len(), 2_772);
    let primitive = quadruples.iter().filter(|[.., d]| 255 % d == 0).count();
    assert_eq!(primitive, 322);
    for known in [[2, 1, 2, 3], [3, 0, 4, 5], [26, 29, 2, 39]] {
        assert!(quadruples.contains(&known), "{known:?}");
    }
    // Of one scale, all in one map.
    let mut by_scale = std::collections::BTreeMap::<[i64; 2], Vec<[i64; 4]>>::new();
    for &[a, b, c, d] in &quadruples {
        let common = num_integer::gcd(a, b);
        by_scale.entry([510 * common, c]).or_default().push([a, b, common, d]);
    }
    println!("{} scales", by_scale.len());
    let mut tied = 0;
    for ([p, q], normals) in by_scale {
        let signed = |[a, b, common, d]: [i64; 4]| {
            [[1, 1], [-1, 1], [1, -1], [-1, -1]].map(|[i, j]| [i * a, j * b, i * a / common, j * b / common, d])
        };
        let cells: Vec<[i64; 5]> = normals.iter().flat_map(|&normal| signed(normal)).collect();
        // The differences of a cell are east - west and south - north: the normal leans back, and green is up.
        let side = |g: i64, last: bool| if (g < 0) == last { 0 } else { g.unsigned_abs() as u8 };
        let map = map_u8(3 * cells.len(), 3, |x, y| {
            let [.., gx, gy, _] = cells[x / 3];
            match (x % 3, y) {
                (0, 1) => side(-gx, false),
                (2, 1) => side(-gx, true),
                (1, 0) => side(gy, false),
                (1, 2) => side(gy, true),
                _ => 0,
            }
        });
        let expected: Vec<([i64; 4], [f64; 3])> = cells
            .iter()
            .map(|&[a, b, .., d]| {
                let c = root(d * d - a * a - b * b).expect("a quadruple");
                // A code is the floor of 255 (v + 1)/2 + 1/2, which is whole for a tie alone.
                let is_tie = |part: i64| part != 0 && (255 * (d + part) + d) % (2 * d) == 0;
                assert!([a, b, c].into_iter().any(is_tie), "({a}, {b}, {c})/{d} ties nowhere");
                ([a, b, c, d], [a, b, c].map(|part| (255 * (d + part) + d).div_euclid(2 * d) as f64))
            })
            .collect();
        tied += expected.len();
        assert_each(every_baker().iter(), |Subject { name, baker }| {
            let baked = baker.normal(&map, &options(&format!("{p}/{q}"), UNORM8)).expect("a bake");
            let baked = Image::from(&baked);
            expected.iter().enumerate().try_for_each(|(i, ([a, b, c, d], codes))| {
                same(&format!("{name}: ({a}, {b}, {c})/{d}"), &baked.texel(3 * i + 1, 1).as_slice(), &codes.as_slice())
            })
        });
    }
    assert_eq!(tied, 4 * 2_772);
}

#[test]
fn ties_of_16_bits() {
    // (2, 1, 2)/3 and (3, 0, 4)/5: 65535/2 (1 + 2/3) is 54612.5, and 65535/2 (1 + 4/5) is 58981.5.
    for (scale, gx, gy, codes) in [
        ("65535/32767", 65_534, 32_767, [54_613.0, 43_690.0, 54_613.0]),
        ("3/2", 65_535, 0, [52_428.0, 32_768.0, 58_982.0]),
    ] {
        let map = map_u16(3, 3, |column, row| match (column, row) {
            (0, 1) => gx,
            (1, 2) => gy,
            _ => 0,
        });
        assert_texel(&map, scale, UNORM16, [1, 1], codes);
    }
}
