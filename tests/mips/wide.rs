//! A map whose width is a prime, so that each level is made from the largest: it takes no more memory, and is right.

use crate::cli::support::{Folder, limited, peak_of};
use ktx2::Reader;

/// Columns, a prime, and rows.
const SIZE: [usize; 2] = [999_983, 3];
const TEXELS: usize = SIZE[0] * SIZE[1];

/// What no map may take: a row as wide as the map for each of its 19 smaller levels would be more.
const MOST_BYTES: u64 = 512 << 20;

/// The slope where codes two texels apart differ by one, at a scale of 2.
const SLOPE: f64 = 1.0 / 255.0;

/// The least share of the mean square of slopes that their variance is.
const SCATTERED: f64 = 1.0 / 8.0;

/// Bumps on a slope down the rows that grows to the right: levels of any size have some.
fn height(x: usize, y: usize) -> u8 {
    let bump = (x * 7919 + y * 104_729) % 1009 % 64;
    (bump + 90 * y * x / SIZE[0]) as u8
}

/// Gx, Gy, and the sum of their squares, of central differences on a map that wraps across and is clamped down.
fn sums(x: usize, y: usize) -> [i128; 3] {
    let [width, rows] = SIZE;
    let [left, right] = [(x + width - 1) % width, (x + 1) % width].map(|x| i128::from(height(x, y)));
    let [above, below] = [y.saturating_sub(1), (y + 1).min(rows - 1)].map(|y| i128::from(height(x, y)));
    let [gx, gy] = [right - left, below - above];
    [gx, gy, gx * gx + gy * gy]
}

/// By how much a code is off the nearest one.
fn excess(code: u8, component: f64) -> f64 {
    (f64::from(code) - component).abs() - 0.5
}

/// Codes of normals are the nearest, but for what f64 costs here. Roughness is the fourth root of the difference of a mean
/// square and the squares of means: f64 adds up each with a product and a sum, both off by 2^-53, for each texel.
#[test]
fn a_prime_width_is_baked_within_the_bound() {
    let folder = Folder::new();
    let columns = || 0..SIZE[0];
    let heights: Vec<u8> = (0..SIZE[1]).flat_map(|y| columns().map(move |x| height(x, y))).collect();
    folder.file("h.raw", heights);
    let raw = format!("{}x{}:u8", SIZE[0], SIZE[1]);
    let bake = ["normal", "h.raw", "--raw", &raw, "--scale", "2", "--edge", "wrap,clamp", "--mips", "-o", "n.ktx2"];
    let peak = peak_of(limited(&folder.path(""), MOST_BYTES >> 10, &[&bake[..], &["--roughness", "r.ktx2"]].concat()));
    assert!(peak < MOST_BYTES, "{peak} bytes");

    // All smaller levels have one row: the sums of columns are over all of a texel's.
    let column = |x| (0..SIZE[1]).map(|y| sums(x, y)).fold([0; 3], |[a, b, c], [d, e, f]| [a + d, b + e, c + f]);
    let columns: Vec<[i128; 3]> = columns().map(column).collect();
    let [normal, rough] =
        ["n.ktx2", "r.ktx2"].map(|name| Reader::new(std::fs::read(folder.path(name)).unwrap()).unwrap());
    let [normal, rough] = [&normal, &rough].map(|file| file.levels().map(|level| level.data).collect::<Vec<_>>());
    assert_eq!([normal.len(), rough.len()], [20, 20]);
    let rounding = 255.0 / 4.0 * 3.0 * TEXELS as f64 * f64::EPSILON / SCATTERED;
    let mut codes = std::collections::BTreeSet::new();
    for level in 1..20 {
        let width = SIZE[0] >> level;
        assert_eq!([normal[level].len(), rough[level].len()], [4 * width, width]);
        // Each texel weighs by the parts that are covered of it, of which it has as many as the level has columns.
        let area = TEXELS as i128;
        for i in 0..width {
            let [begin, end] = [i * SIZE[0], (i + 1) * SIZE[0]];
            let mut sum = [0; 3];
            let covered = begin / width..end.div_ceil(width);
            for (x, column) in covered.clone().zip(&columns[covered]) {
                let part = end.min((x + 1) * width) - begin.max(x * width);
                (0..3).for_each(|at| sum[at] += column[at] * part as i128);
            }
            let [gx, gy, squares] = sum;
            let [dx, dy] = [gx, gy].map(|sum| SLOPE * sum as f64 / area as f64);
            let length = (dx * dx + dy * dy + 1.0).sqrt();
            let found = &normal[level][4 * i..][..4];
            // Green points up, against the rows.
            for (code, component) in found.iter().zip([-dx, dy, 1.0]) {
                let excess = excess(*code, (component / length + 1.0) * 127.5);
                assert!(excess < 1e-9, "level {level}, texel {i}: {found:?}, off by {excess}");
            }
            let variance = SLOPE * SLOPE * (squares * area - gx * gx - gy * gy) as f64 / (area * area) as f64;
            let code = rough[level][i];
            let excess = excess(code, 255.0 * variance.sqrt().sqrt().min(1.0));
            assert!(variance > SCATTERED * (variance + dx * dx + dy * dy), "level {level}, texel {i}: too even");
            assert!(excess < rounding, "level {level}, texel {i}: roughness {code}, off by {excess}");
            codes.extend([(level, found[1], code)]);
        }
    }
    let of_level = |level: usize| codes.iter().filter(|(of, ..)| *of == level).count();
    assert!((1..12).all(|level| of_level(level) > 20), "codes differ, and a fault would show");
}
