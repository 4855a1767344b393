//! The angle whose cosine is a float.
//!
//! asin(w) = w P(w^2) with Taylor's series P(z) = sum of (2k)! / (4^k k!^2 (2k + 1)) z^k, and
//!
//! ```text
//! acos(x) = pi/2 - asin(x)                 |x| <= 1/2, w = |x|
//! acos(x) = 2 asin(sqrt((1 - x)/2))        x > 1/2
//! acos(x) = pi - acos(-x)                  x < -1/2
//! ```
//!
//! so that w <= 1/2 and z <= 1/4. In integers, no step is off by more than a unit of its last place, and the angle by
//! less than 2^-60: z and w are off by 2^-64, P by 3 units of 2^-63 (each step of Horner's rule by 1.5, of which z
//! leaves a quarter to the next; terms left out: 2^-64.6), asin(w) by 3 units of 2^-63, and pi by half a unit of 2^-62.
//! No angle but 0 is half-way between two floats or doubles, since the cosine of a fraction is none, and for no float x
//! is the angle so near to such a middle that 2^-60 would matter: of all floats from -1 to 1, the one that comes nearest
//! to the middle between two floats leaves 2^-56.4 (46 units; x = 0.00024868647).
//!
//! Rounded twice: to the nearest double, then to the nearest float. So does MikkTSpace's `(float)acos(x)`, and for two
//! floats, both with an angle within 2^-53 of a middle, the nearest float would be another. In a run over all floats,
//! `f64::acos` gave the same for each.

/// The float nearest to the double nearest to acos(x), for x from -1 to 1.
#[inline(always)]
pub(crate) fn acos(x: f32) -> f32 {
    let estimate = acos_estimate(x);
    if is_in_doubt(estimate) { nearest_acos(x) } else { estimate as f32 }
}

/// acos(x) for x from -1 to 1, off by less than 2^-46 of its value: without branches, for many at once.
///
/// The polynomial is within 2^-47.7 of P for z up to 1/4 (the best of its degree), and each rounding adds 2^-53 or less.
/// In a run over all floats, the greatest error was 2^-47.77 of the value.
#[inline(always)]
pub(crate) fn acos_estimate(x: f32) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI};
    let x = f64::from(x);
    let magnitude = x.abs();
    let is_small = magnitude <= 0.5;
    let z = if is_small { x * x } else { (1.0 - magnitude) * 0.5 };
    // Taken always: a selection is cheaper than a branch, and lanes have none.
    let root = z.sqrt();
    let w = if is_small { magnitude } else { root };
    let mut p = ESTIMATE[0];
    for &coefficient in &ESTIMATE[1..] {
        p = p * z + coefficient;
    }
    let asin = w * p;
    let of_magnitude = if is_small { FRAC_PI_2 - asin } else { 2.0 * asin };
    if x < 0.0 { PI - of_magnitude } else { of_magnitude }
}

/// Whether an estimate is so near to the middle between two floats that it does not tell which is nearer.
#[inline(always)]
pub(crate) fn is_in_doubt(estimate: f64) -> bool {
    // 29 bits of an f64 are not in an f32; 2^-46 of a value is at most 64 units of its last place.
    const MIDDLE: u32 = 1 << 28;
    const ERROR: u32 = 64;
    let dropped = estimate.to_bits() as u32 & (2 * MIDDLE - 1);
    dropped.wrapping_sub(MIDDLE - ERROR) <= 2 * ERROR
}

/// P(z) from z = 0 to 1/4, the highest power first.
const ESTIMATE: [f64; 11] = [
    0.03150097858285519,
    -0.007309161310274521,
    0.017924305774952437,
    0.012550386671737955,
    0.01755004624569455,
    0.02235471795166217,
    0.03038289742013321,
    0.04464282695575735,
    0.07500000048801558,
    0.1666666666636023,
    1.000000000000003,
];

/// The same as [`acos`], in integers throughout: the specification.
pub(crate) fn nearest_acos(x: f32) -> f32 {
    // Below 2^62 a unit is 2^-62.
    angle(x) as f64 as f32 * 2f32.powi(-62)
}

/// acos(x) in units of 2^-62.
fn angle(x: f32) -> u64 {
    const PI: u64 = 0xc90f_daa2_2168_c235;
    const HALF_PI: u64 = 0x6487_ed51_10b4_611a;
    let magnitude = x.abs();
    let of_magnitude = if magnitude <= 0.5 {
        // In units of 2^-64, cut.
        let w = (f64::from(magnitude) * 2f64.powi(64)) as u64;
        HALF_PI - (asin(w, times(w, w)) >> 1)
    } else {
        // (1 - |x|) 2^24 is an integer.
        let z = ((1.0 - magnitude) * 2f32.powi(24)) as u64;
        let w = (u128::from(z) << 103).isqrt() as u64;
        // Twice the angle, in twice the unit.
        asin(w, z << 39)
    };
    if x < 0.0 { PI - of_magnitude } else { of_magnitude }
}

/// asin(w) in units of 2^-63, for w and z = w^2 in units of 2^-64.
fn asin(w: u64, z: u64) -> u64 {
    times(w, SERIES.iter().rev().fold(0, |p, coefficient| times(p, z) + coefficient))
}

/// The high half of a product.
fn times(a: u64, b: u64) -> u64 {
    ((u128::from(a) * u128::from(b)) >> 64) as u64
}

/// The coefficients of P in units of 2^-63, rounded: also in kernels/shared/acos.wgsl.
const SERIES: [u64; 28] = [
    0x8000_0000_0000_0000,
    0x1555_5555_5555_5555,
    0x0999_9999_9999_999a,
    0x05b6_db6d_b6db_6db7,
    0x03e3_8e38_e38e_38e4,
    0x02dd_1745_d174_5d17,
    0x0238_9d89_d89d_89d9,
    0x01c9_9999_9999_999a,
    0x017a_8787_8787_8788,
    0x013f_de50_d794_35e5,
    0x0112_ef3c_f3cf_3cf4,
    0x00ef_9de9_bd37_a6f5,
    0x00d3_431e_b851_eb85,
    0x00bc_16ed_097b_425f,
    0x00a8_dd18_469e_e584,
    0x0098_b41d_ef7b_def8,
    0x008a_f74e_a2e8_ba2f,
    0x007f_2be3_edb6_db6e,
    0x0074_f4aa_3837_59f2,
    0x006c_09bd_5ec4_ec4f,
    0x0064_32dd_fd83_1f38,
    0x005d_4379_935f_417d,
    0x0057_17d5_bbea_aaab,
    0x0051_9302_543d_f51b,
    0x004c_9d56_1b17_cbc1,
    0x0048_234d_5c2b_9697,
    0x0044_14af_17ea_5827,
    0x0040_63e5_8f08_a6fb,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::rational::gcd;
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_3, PI};

    #[test]
    fn the_series_is_that_of_arcsine() {
        // (2k)! / (4^k k!^2) in lowest terms: each is (2k - 1)/(2k) of the one before.
        let (mut above, mut below) = (1, 1);
        for (k, &coefficient) in (0u128..).zip(&SERIES) {
            if k > 0 {
                (above, below) = (above * (2 * k - 1), below * 2 * k);
                let common = gcd(above, below);
                (above, below) = (above / common, below / common);
            }
            let divisor = below * (2 * k + 1);
            let rounded = ((above << 63) + divisor / 2) / divisor;
            assert_eq!(u128::from(coefficient), rounded, "{k}");
        }
    }

    #[test]
    fn known_angles() {
        let cases = [
            (1.0, 0.0),
            (-1.0, PI),
            (0.0, FRAC_PI_2),
            (-0.0, FRAC_PI_2),
            (0.5, FRAC_PI_3),
            (f32::MIN_POSITIVE, FRAC_PI_2),
            (-1e-45, FRAC_PI_2),
            // sqrt(2^-23), and pi less by that: the floats beside 1.
            (1.0 - 2f32.powi(-24), 3.452_669_8e-4),
            (2f32.powi(-24) - 1.0, 3.141_247_3),
        ];
        for (x, angle) in cases {
            assert_eq!([acos(x), nearest_acos(x)], [angle; 2], "{x:e}");
        }
    }

    #[test]
    fn both_ways_and_f64_give_the_same_float() {
        // The two whose nearest float is another.
        let twice_rounded = [2.486_864_7e-4f32, 1.589_325_5e-8].map(f32::to_bits);
        // Every 4999th float of either sign, and those around where the formula changes.
        let around = |x: f32| x.to_bits().saturating_sub(300)..=x.to_bits().saturating_add(300).min(ONE);
        let all = (0..=ONE).step_by(4999).chain(around(0.0)).chain(around(0.5)).chain(around(1.0)).chain(twice_rounded);
        for x in all.flat_map(|bits| [f32::from_bits(bits), -f32::from_bits(bits)]) {
            let angle = nearest_acos(x);
            assert_eq!([acos(x), f64::from(x).acos() as f32], [angle; 2], "{x:e}");
        }
    }

    const ONE: u32 = 0x3f80_0000;

    #[test]
    fn what_an_estimate_cannot_tell_is_in_doubt() {
        let between = (f64::from(1.5f32) + f64::from(1.5f32.next_up())) * 0.5;
        let units = |n: i64| f64::from_bits((between.to_bits() as i64 + n) as u64);
        assert_eq!([-65, -64, 0, 64, 65].map(|n| is_in_doubt(units(n))), [false, true, true, true, false]);
        assert!(!is_in_doubt(0.0) && !is_in_doubt(1.5));
    }
}
