//! 16-bit heights: extremes, ties, and heights and scales so near to a code's boundary that f64 misrounds.

use super::assert_right;
use crate::oracle::parallax;
use crate::support::{
    FILTERS, Image, Random, assert_every_parallax, convergent, map_u16, parallax_formats, parallax_options,
};
use texbake::{Depth, Encoding, HeightMap, ParallaxFormat, ParallaxOptions, Rational, Scale};

#[test]
fn the_steepest_and_the_flattest_slopes() {
    let stripes = map_u16(64, 48, |x, y| match (x / 2 + y / 2) % 4 {
        0 | 1 => 65_535,
        2 => 0,
        _ => (x * y * 20) as u16,
    });
    for (i, filter) in FILTERS.into_iter().enumerate() {
        for scale in ["16777215", "16777215/16777214", "1/16777215", "-1/16777213", "0"] {
            for format in parallax_formats() {
                // The oracle of floats is slow.
                if !format.depth.is_float() || i == 2 {
                    assert_right(&stripes, &ParallaxOptions { filter, ..parallax_options(scale, format) });
                }
            }
        }
    }
}

/// Cells of 3 x 3 heights: the middle one, and a slope along x and y by central differences.
fn map_of_cells(cells: &[(u16, [i64; 2])]) -> HeightMap {
    let side = |g: i64, after: bool| {
        let before = 32_767 - g.div_euclid(2);
        u16::try_from(if after { before + g } else { before }).expect("a difference in range")
    };
    map_u16(3 * cells.len(), 3, |x, y| {
        let (height, [gx, gy]) = cells[x / 3];
        match (x % 3, y) {
            (1, 1) => height,
            (_, 1) => side(gx, x % 3 == 2),
            (1, _) => side(gy, y == 2),
            _ => 0,
        }
    })
}

/// X : Y : Z = -Gx : -Gy : c makes n_z = c/d, and L n_z (2H - M)/M = c (2H - M)/d for 16 bits: a tie of unorm where that
/// is even, so with an even c wherever d divides 2H - M; for 8 bits where 257 d does.
#[test]
fn pythagorean_ties() {
    let mut random = Random::new(0x71e5);
    for [a, b, c, d] in [[1, 2, 2, 3], [0, 3, 4, 5], [5, -14, 2, 15], [2, 5, 14, 15], [-12, 9, 8, 17], [8, 9, 12, 17]] {
        assert_eq!(a * a + b * b + c * c, d * d);
        // X = -p Gx and Z = q 2 M.
        let scale = Scale::texels(Rational::new(2 * 65_535, c).expect("a ratio"));
        let height = |divisor: i64| {
            let odd = 2 * (random.any_magnitude(65_535 / divisor - 1) / 2) + 1;
            ((65_535 + divisor * odd) / 2) as u16
        };
        let divisors = [d, d, d, 257 * d, 1].into_iter().cycle().take(200);
        let cells: Vec<_> = divisors.map(height).map(|height| (height, [a, b])).collect();
        let map = map_of_cells(&cells);
        for format in parallax_formats() {
            let options = ParallaxOptions { scale, ..parallax_options("1", format) };
            let expected = parallax(&map, &options);
            let least = match format.depth {
                _ if format.encoding != Encoding::Unorm => 0,
                Depth::Bits8 => 40,
                _ => 160,
            };
            assert!(expected.ties >= least, "{a} {b} {c}, {format:?}: {} ties", expected.ties);
            assert_every_parallax(&map, &options, &expected.image);
        }
    }
}

/// L n_z (2h - 1) of one slope, by f64.
fn by_f64(height: u16, [gx, gy]: [i64; 2], s: f64, format: ParallaxFormat) -> f64 {
    let [dx, dy] = [gx, gy].map(|g| s * g as f64 / (2.0 * 65_535.0));
    let value = (2.0 * f64::from(height) / 65_535.0 - 1.0) / (dx * dx + dy * dy + 1.0).sqrt();
    let l = f64::from(format.encoding.greatest_code(format.depth).expect("integer codes"));
    match format.encoding {
        Encoding::Unorm => (l / 2.0 * (value + 1.0) + 0.5).floor(),
        _ => (l * value + 0.5).floor(),
    }
}

/// A scale of two parts of 24 bits comes within 2^-47 of one that meets the middle between two codes.
#[test]
fn scales_nearest_to_a_boundary() {
    let mut random = Random::new(0x9a1);
    for encoding in [Encoding::Unorm, Encoding::Snorm] {
        let format = ParallaxFormat { encoding, depth: Depth::Bits16 };
        let l = f64::from(encoding.greatest_code(Depth::Bits16).expect("integer codes"));
        let mut misrounded_by_f64 = 0;
        for _ in 0..60 {
            let tries = (0..4_000).filter_map(|_| {
                let height = random.bits() as u16;
                let sums = [0; 2].map(|_| random.any_magnitude(60_000));
                let part = 2.0 * f64::from(height) / 65_535.0 - 1.0;
                // L (v + 1)/2 or L v in the middle between two codes, below what a flat map gives.
                let factor = if encoding == Encoding::Unorm { l / 2.0 } else { l };
                let least = random.below((factor * part.abs()).max(1.0) as u64) as f64;
                let v = (least + if encoding == Encoding::Unorm { 1.0 } else { 0.5 }) / factor;
                let slopes = sums.map(|g| g as f64 / (2.0 * 65_535.0));
                let square = slopes[0] * slopes[0] + slopes[1] * slopes[1];
                let scale = ((part * part / (v * v) - 1.0) / square).sqrt();
                let (p, q) = convergent(Some(scale).filter(|scale| (1e-3..1e6).contains(scale))?, (1 << 24) - 1);
                // The change of the value beside the scale's: 1 - z^2.
                let change = 1.0 - (v / part).powi(2);
                Some(((p as f64 / q as f64 / scale - 1.0).abs() * change, height, sums, (p, q)))
            });
            let (_, height, sums, (p, q)) = tries.min_by(|a, b| a.0.total_cmp(&b.0)).expect("some scale is in range");
            let scale = Scale::texels(Rational::new(p, q).expect("a ratio"));
            let options = ParallaxOptions { scale, ..parallax_options("1", format) };
            let map = map_of_cells(&[(height, sums)]);
            let exact: Image<ParallaxFormat> = parallax(&map, &options).image;
            assert_every_parallax(&map, &options, &exact);
            misrounded_by_f64 += usize::from(exact.texel(1, 1)[0] != by_f64(height, sums, p as f64 / q as f64, format));
        }
        assert!(misrounded_by_f64 > 0, "{encoding}: f64 would do");
    }
}
