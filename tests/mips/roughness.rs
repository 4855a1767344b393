//! Roughness of levels: what filtering removes, by the definitions and by closed forms.

use crate::oracle::{SCATTERED, roughness};
use crate::support::{FILTERS, Random, every_edges, map_f32, map_u8, map_u16, scale};
use texbake::{
    BakeOptions, Baker, CodesRef, Depth, HeightMap, RoughnessFormat, RoughnessMap, RoughnessMethod, RoughnessOptions,
};

fn options(method: RoughnessMethod, base: &str, scale_text: &str) -> BakeOptions {
    let base = base.parse().expect("a number");
    let roughness = Some(RoughnessOptions { method, base, format: RoughnessFormat { depth: Depth::Bits16 } });
    BakeOptions { scale: scale(scale_text), roughness, ..Default::default() }
}

fn levels(map: &HeightMap, options: &BakeOptions) -> Vec<RoughnessMap> {
    let levels = Baker::cpu().bake_levels(map, options).expect("levels").roughness.expect("a roughness map");
    let reference = Baker::reference().bake_levels(map, options).expect("levels").roughness;
    assert_eq!(Some(&levels), reference.as_ref());
    levels
}

fn codes(map: &RoughnessMap) -> &[u16] {
    match map.codes() {
        CodesRef::U16(codes) => codes,
        _ => panic!("16 bits were asked for"),
    }
}

/// The code of alpha^2: the roughness is its fourth root.
fn code_of(alpha_squared: f64) -> f64 {
    65_535.0 * alpha_squared.min(1.0).powf(0.25)
}

const METHODS: [RoughnessMethod; 2] = [RoughnessMethod::Lean, RoughnessMethod::Toksvig];

/// How far codes are from half a code of what they stand for, at most, beyond what f64 explains. What is scattered is the
/// difference of two sums, to which each row and column adds a product and a sum that are rounded by 2^-53, and at least
/// [`SCATTERED`] of them; the roughness is its fourth root.
fn excess(levels: &[RoughnessMap], expected: &[(texbake::Size, Vec<f64>)]) -> f64 {
    assert_eq!(levels.len(), expected.len());
    let sides = levels[0].size().width() + levels[0].size().height();
    let sums = 2.0 * sides as f64 * f64::EPSILON / SCATTERED / 4.0;
    let of_level = |(level, (size, expected)): (&RoughnessMap, &(_, Vec<f64>))| {
        assert_eq!((level.size(), codes(level).len()), (*size, expected.len()));
        let off = |(code, expected): (&u16, &f64)| (f64::from(*code) - 65_535.0 * expected).abs();
        codes(level).iter().zip(expected).map(off).fold(0.0, f64::max)
    };
    levels.iter().zip(expected).map(of_level).fold(0.0, f64::max) - 0.5 - 65_535.0 * sums
}

/// By the definitions: sizes that levels cut, and one of several strips.
#[test]
fn any_map_has_the_roughness_of_what_it_loses() {
    let mut random = Random::new(93);
    let edges: Vec<_> = every_edges().collect();
    let sizes =
        [[1, 1], [2, 1], [5, 3], [7, 1], [1, 9], [13, 13], [37, 22], [64, 64], [100, 37], [255, 63], [601, 500]];
    for (turn, [width, height]) in sizes.into_iter().enumerate() {
        let maps = [
            map_u8(width, height, |_, _| random.bits() as u8),
            map_u16(width, height, |_, _| random.bits() as u16),
            // Multiples of 1/64, so that stencils are exact in f32.
            map_f32(width, height, |_, _| random.below(65) as f32 / 64.0),
        ];
        for (at, map) in maps.iter().enumerate().take(if width > 600 { 1 } else { 3 }) {
            let turn = 3 * turn + at;
            let (base, scale) = (["0", "0.25", "0.7", "1"][turn % 4], ["0.1", "1", "7/3"][turn / 2 % 3]);
            let with = |method| BakeOptions {
                filter: FILTERS[turn % 4],
                edges: edges[turn % 9],
                ..options(method, base, scale)
            };
            for method in METHODS {
                let excess = excess(&levels(map, &with(method)), &roughness(map, &with(method)));
                assert!(excess <= 0.0, "{method}, {} of {}, turn {turn}: {excess}", map.height_type(), map.size());
            }
            // The comparison is awake: either method is noticed in the place of the other.
            if base != "1" && scale != "0.1" && width * height > 100 {
                let [lean, toksvig] = METHODS.map(with);
                assert!(excess(&levels(map, &lean), &roughness(map, &toksvig)) > 100.0, "turn {turn}");
            }
        }
    }
}

/// Rows 0, 0, 255, 255 repeat, so slopes along x are a, a, -a, -a with a = s/2: two by two they agree, four by four they
/// have the variance a^2 and a mean normal of length 1/sqrt(1 + a^2).
#[test]
fn a_sawtooth_has_the_variance_of_its_slopes() {
    // Differences H(x + 1) - H(x - 1) of 0, 255, 255, 0: 255, 255, -255, -255 from x = 0 on.
    let map = map_u8(16, 4, |x, _| [0, 255, 255, 0][x % 4]);
    let a = |x: usize| [1, 1, -1, -1][x % 4];
    assert_eq!([0, 1, 2, 3].map(a), [1, 1, -1, -1]);
    for (text, slope) in [("0.5", 0.25), ("1", 0.5), ("0.02", 0.01)] {
        for base in ["0", "0.3", "1"] {
            let base_alpha_squared = base.parse::<f64>().expect("a number").powi(4);
            let lean = levels(&map, &options(RoughnessMethod::Lean, base, text));
            let toksvig = levels(&map, &options(RoughnessMethod::Toksvig, base, text));
            let flat = (base.parse::<f64>().expect("a number") * 65_535.0 + 0.5).floor() as u16;
            for levels in [&lean, &toksvig] {
                assert!(codes(&levels[0]).iter().chain(codes(&levels[1])).all(|code| *code == flat), "{text}, {base}");
            }
            let lean_expected = code_of(base_alpha_squared + slope * slope);
            // 1/s' = 1/s + sqrt(1 + a^2) - 1, with 2/s = alpha^2 / (1 - alpha^2) and alpha'^2 = 2 / (s' + 2).
            let one_over =
                base_alpha_squared / (2.0 - 2.0 * base_alpha_squared) + (1.0f64 + slope * slope).sqrt() - 1.0;
            let toksvig_expected =
                if base_alpha_squared == 1.0 { 65_535.0 } else { code_of(2.0 * one_over / (1.0 + 2.0 * one_over)) };
            for level in 2..lean.len() {
                for (levels, expected) in [(&lean, lean_expected), (&toksvig, toksvig_expected)] {
                    let off = |code: &u16| (f64::from(*code) - expected).abs();
                    // Half a code, and what f64 is off by in either computation.
                    assert!(
                        codes(&levels[level]).iter().all(|code| off(code) <= 0.501),
                        "{text}, {base}, level {level}"
                    );
                }
            }
        }
    }
}

/// Where nothing differs nothing is removed, whatever sums round: only the borders of a plane are bent.
#[test]
fn a_plane_stays_as_smooth_as_it_is() {
    let planes =
        [map_u16(99, 99, |x, y| (300 * x + 200 * y) as u16), map_f32(99, 99, |x, y| (3 * x + 2 * y) as f32 / 64.0)];
    for map in &planes {
        for method in METHODS {
            for base in ["0", "0.5"] {
                let flat = (base.parse::<f64>().expect("a number") * 65_535.0 + 0.5).floor() as u16;
                let levels = levels(map, &options(method, base, "24"));
                for level in &levels[..4] {
                    let (width, height) = (level.size().width(), level.size().height());
                    for y in 1..height - 1 {
                        let row = &codes(level)[y * width + 1..(y + 1) * width - 1];
                        assert!(row.iter().all(|code| *code == flat), "{method}, {base}, {}: {row:?}", level.size());
                    }
                }
            }
        }
    }
}

/// Both methods are the second-order same: 2 (sqrt(1 + a^2) - 1) is a^2 for small slopes.
#[test]
fn methods_agree_on_small_slopes() {
    let map = map_u16(64, 64, |x, y| ((x * 7919 + y * 104_729) % 1009) as u16);
    let [lean, toksvig] = METHODS.map(|method| levels(&map, &options(method, "0", "1")));
    for (lean, toksvig) in lean.iter().zip(&toksvig).skip(1) {
        for (lean, toksvig) in codes(lean).iter().zip(codes(toksvig)) {
            assert!(lean.abs_diff(*toksvig) <= 2, "{lean} and {toksvig}");
        }
    }
}

#[test]
fn what_is_out_of_range_is_refused() {
    let map = map_u8(4, 4, |x, _| x as u8);
    let refused = |options: BakeOptions| Baker::cpu().bake_levels(&map, &options).expect_err("refused").to_string();
    for base in ["-0.1", "1.01"] {
        let error = refused(options(RoughnessMethod::Lean, base, "1"));
        assert_eq!(error, format!("base-roughness is {base}: it must be from 0 to 1"));
    }
    let mut floats = options(RoughnessMethod::Lean, "0", "1");
    if let Some(roughness) = &mut floats.roughness {
        roughness.format.depth = Depth::Float32;
    }
    let error = refused(floats);
    assert_eq!(error, "bits is 32f: it must be 8 or 16 for the encodings unorm, snorm and biased");
}

/// Without levels nothing is filtered, and the map is flat.
#[test]
fn the_largest_level_is_the_base() {
    let map = map_u8(5, 3, |x, y| (50 * x * y) as u8);
    let options = options(RoughnessMethod::Lean, "0.5", "24");
    let alone = Baker::cpu().bake(&map, &options).expect("a bake").roughness.expect("a roughness map");
    assert_eq!(codes(&alone), [32_768; 15]);
    assert_eq!(levels(&map, &options)[0], alone);
}
