//! Two normal maps into one.

use super::{assert_refused, same};
use crate::support::{
    BIASED8, BIASED16, FLOAT16, FLOAT32, Image, SNORM8, SNORM16, Subject, UNORM8, UNORM16, assert_each, blend_options,
    dx, every_baker, flat_map, map_f32, map_u8, map_u16, normal_map, number, pair, weighted, xy,
};
use half::f16;
use texbake::{BlendInputs, BlendMethod, BlendOptions, Grid, HeightMap, NormalFormat, Weights};

/// A map of one texel: its format and its stored bits.
type Texel<'a> = (NormalFormat, &'a [u32]);

const FLAT: Texel<'_> = (SNORM8, &[0, 0, 127]);

/// Every baker blends two texels into these numbers.
pub fn assert_blend(texels: [Texel<'_>; 2], options: &BlendOptions, mask: Option<&HeightMap>, numbers: &[f64]) {
    let [base, detail] = texels.map(|(format, bits)| normal_map(1, 1, format, bits));
    let inputs = BlendInputs { mask, ..pair(&base, &detail) };
    assert_each(every_baker().iter(), |Subject { name, baker }| {
        let what = format!("{name}, {texels:?}, {options:?}");
        let blended = baker.blend(&inputs, options).map_err(|error| format!("{what}: {error}"))?;
        same(&what, &Image::from(&blended).texel(0, 0).as_slice(), &numbers)
    });
}

fn assert_sum(texels: [Texel<'_>; 2], format: NormalFormat, numbers: [f64; 3]) {
    assert_blend(texels, &blend_options(BlendMethod::add(), format), None, &numbers);
}

fn assert_weighted(weights: [&str; 2], texels: [Texel<'_>; 2], numbers: [f64; 3]) {
    assert_blend(texels, &blend_options(weighted(weights[0], weights[1]), SNORM8), None, &numbers);
}

fn refuse(texels: [Texel<'_>; 2], options: &BlendOptions, message: &str) {
    let [base, detail] = texels.map(|(format, bits)| normal_map(1, 1, format, bits));
    assert_refused(|baker| baker.blend(&pair(&base, &detail), options), message);
}

#[test]
fn z_of_zero_in_both_maps() {
    // z counts as 1 of 127: slopes of 127 + 127, then of 127 - 127.
    assert_sum([(SNORM8, &[127, 0, 0]); 2], SNORM8, [127.0, 0.0, 0.0]);
    assert_sum([(SNORM8, &[127, 0, 0]), (SNORM8, &[129, 0, 0])], SNORM8, [0.0, 0.0, 127.0]);
    // Unorm: 128 is 0; z as 1 of 255: a slope of 510, z is 127.5 (1 + 0.00196) = 127.75.
    assert_sum([(UNORM8, &[255, 128, 128]); 2], UNORM8, [255.0, 128.0, 128.0]);
    // Floats: z as 2^-24, a slope of 2^25.
    let steep = [1f32.to_bits(), 0, 0];
    assert_sum([(FLOAT32, &steep); 2], FLOAT32, [1.0, 0.0, 2f64.powi(-25)]);
}

#[test]
fn z_below_zero() {
    for z in [0x80, 0x81, 0xff] {
        assert_sum([(SNORM8, &[127, 0, z]), FLAT], SNORM8, [127.0, 0.0, 1.0]);
    }
    let below = [2f32.powi(-24).to_bits(), 0, (-3f32).to_bits()];
    assert_sum([(FLOAT32, &below), FLAT], SNORM8, [90.0, 0.0, 90.0]);
}

#[test]
fn weights_that_cancel() {
    let slope = (SNORM8, &[60, 186, 90][..]);
    for weights in [["1", "-1"], ["-65535", "65535"], ["1/3", "-1/3"]] {
        assert_weighted(weights, [slope; 2], [0.0, 0.0, 127.0]);
    }
    let float = [0.6f32.to_bits(), 0, 0.8f32.to_bits()];
    assert_weighted(["1", "-1"], [(FLOAT32, &float); 2], [0.0, 0.0, 127.0]);
}

#[test]
fn weights_of_zero() {
    for texel in [[60, 186, 90], [127, 0, 0], [0, 0, 0], [128, 128, 128]] {
        assert_weighted(["0", "0"], [(SNORM8, &texel); 2], [0.0, 0.0, 127.0]);
    }
}

#[test]
fn weights_at_their_ends() {
    // Slopes of 1/127 times 65535: 516.02. 127 (516.02, 0, 1)/516.02.
    let least = (SNORM8, &[1, 0, 127][..]);
    assert_weighted(["65535", "0"], [least; 2], [127.0, 0.0, 0.0]);
    assert_weighted(["-65535", "0"], [least; 2], [-127.0, 0.0, 0.0]);
    // 1/65535 of slopes of 127: 0.0019, a quarter of a code.
    assert_weighted(["1/65535", "0"], [(SNORM8, &[127, 0, 1]); 2], [0.0, 0.0, 127.0]);
    // The greatest of everything: 65535 (65535 + 65535), half of it along each axis.
    let steep = (UNORM16, &[65_535, 65_535, 0][..]);
    let options = blend_options(weighted("65535", "65535"), UNORM16);
    // 65535/2 (1 + 1/sqrt(2)) = 55937.6.
    assert_blend([steep; 2], &options, None, &[55_938.0, 55_938.0, 32_768.0]);
}

#[test]
fn weights_beyond_their_ends() {
    for (a, b, shown) in [("65536", "1", "65536"), ("1", "-65535.5", "-65535.5")] {
        let message = format!("weights is {shown}: it must be between -65535 and 65535");
        refuse([FLAT; 2], &blend_options(weighted(a, b), UNORM8), &message);
    }
}

/// pi has more digits than weights have bits; of all ratios with parts up to 65535, 65298/20785 is nearest.
#[test]
fn weights_of_many_digits() {
    let used = Weights::new(number("3.14159265358979"), number("0")).expect("weights");
    assert_eq!((used.base, used.detail, used.q, used.exact), (65_298, 0, 20_785, false));
    // A slope of pi: 127 (pi, 0, 1)/3.2969.
    assert_weighted(["3.14159265358979", "0"], [(SNORM8, &[90, 0, 90]), FLAT], [121.0, 0.0, 39.0]);
}

#[test]
fn transition_beyond_0_and_1() {
    for t in ["-0.001", "1.001"] {
        let error = BlendMethod::transition(number(t)).expect_err("out of range").to_string();
        assert_eq!(error, format!("transition is {t}: it must be between 0 and 1"));
    }
}

/// x^2 + y^2 > 1: z is the least above zero.
#[test]
fn two_channels_beyond_unit_length() {
    assert_sum([(xy(SNORM8), &[127, 127]), FLAT], SNORM8, [90.0, 90.0, 1.0]);
    assert_sum([(xy(UNORM8), &[255, 0]), FLAT], SNORM8, [90.0, -90.0, 0.0]);
    assert_sum([(xy(UNORM16), &[65_535, 0]), FLAT], SNORM16, [23_170.0, -23_170.0, 0.0]);
    // 2^-24 of floats: a slope of 2^24 along each axis.
    let one = 1f32.to_bits();
    assert_sum([(xy(FLOAT32), &[one, one]), FLAT], SNORM16, [23_170.0, 23_170.0, 0.0]);
}

/// 127^2 - 126^2 - 15^2 = 28: z is floor(5.29), not its root.
#[test]
fn two_channels_near_unit_length() {
    assert_sum([(xy(SNORM8), &[126, 15]), FLAT], SNORM8, [126.0, 15.0, 5.0]);
    // 127^2 - 127^2 = 0.
    assert_sum([(xy(SNORM8), &[127, 0]), FLAT], SNORM8, [127.0, 0.0, 1.0]);
}

#[test]
fn snorm_least_code_reads_as_minus_one() {
    // A slope of -1: -127/127, 127/127.
    for least in [0x80, 0x81] {
        assert_sum([(SNORM8, &[least, 0, 127]), FLAT], SNORM8, [-90.0, 0.0, 90.0]);
    }
    for least in [0x8000, 0x8001] {
        assert_sum([(SNORM16, &[least, 0, 0x7fff]), FLAT], SNORM16, [-23_170.0, 0.0, 23_170.0]);
    }
    for least in [0, 1] {
        assert_sum([(BIASED8, &[least, 128, 255]), FLAT], SNORM8, [-90.0, 0.0, 90.0]);
        assert_sum([(BIASED16, &[least, 32_768, 65_535]), FLAT], SNORM16, [-23_170.0, 0.0, 23_170.0]);
    }
}

/// 127.5 is zero, and no code: 128, which zero is written as, is read as zero; 127 is -1/255.
#[test]
fn unorm_code_of_zero() {
    let with = |x: u32| (UNORM8, [x, 128, 255]);
    for (x, expected) in [(128, 0.0), (127, -127.0), (129, 127.0)] {
        let (format, bits) = with(x);
        // Slopes of -1/255 and 3/255, 65535 times as steep.
        assert_weighted(["65535", "0"], [(format, &bits), FLAT], [expected, 0.0, if x == 128 { 127.0 } else { 0.0 }]);
    }
    let words = [32_768, 32_768, 65_535];
    assert_weighted(["65535", "0"], [(UNORM16, &words), FLAT], [0.0, 0.0, 127.0]);
}

#[test]
fn vectors_of_length_zero() {
    for (format, zero) in [(SNORM8, [0; 3]), (UNORM8, [128; 3]), (UNORM16, [32_768; 3]), (FLOAT32, [0; 3])] {
        for method in [BlendMethod::add(), BlendMethod::Linear, BlendMethod::Whiteout] {
            assert_blend([(format, &zero); 2], &blend_options(method, SNORM8), None, &[0.0, 0.0, 127.0]);
        }
    }
}

/// (60, 0, 1) + (-60, 0, 1), and Overlay's v1 + v2 (1 - |v1|), with z of 1 and -1 of 127.
#[test]
fn vectors_that_cancel() {
    let opposite = [(SNORM8, &[60, 0, 129][..]), (SNORM8, &[196, 0, 129][..])];
    assert_blend(opposite, &blend_options(BlendMethod::Linear, SNORM8), None, &[0.0, 0.0, 127.0]);
    let floats = [[0.6f32, 0.0, -0.8], [-0.6, -0.0, -0.8]].map(|texel| texel.map(f32::to_bits));
    let texels = [(FLOAT32, &floats[0][..]), (FLOAT32, &floats[1][..])];
    assert_blend(texels, &blend_options(BlendMethod::Linear, FLOAT32), None, &[0.0, 0.0, 1.0]);
}

/// Only directions count.
#[test]
fn normals_of_any_length() {
    for length in [1.0, 2f32.powi(-20), 65_536.0] {
        let slope = [0.75 * length, 0.0, length].map(f32::to_bits);
        // (3, 0, 4)/5.
        assert_sum([(FLOAT32, &slope), FLAT], SNORM16, [19_660.0, 0.0, 26_214.0]);
    }
    for slope in [[3, 0, 4], [93, 0, 124]] {
        assert_sum([(SNORM8, &slope), FLAT], SNORM16, [19_660.0, 0.0, 26_214.0]);
    }
}

#[test]
fn float_components_below_2_to_the_minus_25() {
    let least = 2f32.powi(-25).to_bits();
    let (minus_zero, minus_subnormal) = ((-0f32).to_bits(), (-f32::from_bits(1)).to_bits());
    let one = 1f32.to_bits();
    assert_sum([(FLOAT32, &[least, 0, one]), (FLOAT32, &[0, 0, one])], FLOAT32, [2f64.powi(-25), 0.0, 1.0]);
    for nothing in [least - 1, minus_zero, minus_subnormal] {
        let [base, detail] = [[nothing, nothing, one], [0, 0, one]].map(|texel| normal_map(1, 1, FLOAT32, &texel));
        assert_each(every_baker().iter(), |Subject { name, baker }| {
            let blended = baker.blend(&pair(&base, &detail), &blend_options(BlendMethod::add(), FLOAT32));
            // To the sign of zero.
            same(&format!("{name}, {nothing:#x}"), &Image::from(&blended.expect("a blend")).bits, &vec![0, 0, one])
        });
    }
}

const NO_DIRECTION: &str =
    "components must be between -65536 and 65536; texbake check --repair -o FILE makes such texels flat";

#[test]
fn normal_that_is_nan_or_infinite() {
    for (value, shown) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        let message = format!("the normal at column 0, row 0 has a component of {shown}: {NO_DIRECTION}");
        let add = blend_options(BlendMethod::add(), UNORM8);
        for texel in [[value, 0.0, 1.0], [0.0, 0.0, value]].map(|texel| texel.map(f32::to_bits)) {
            refuse([(FLOAT32, &texel), FLAT], &add, &message);
            refuse([FLAT, (FLOAT32, &texel)], &add, &message);
        }
        let halves = [0.0, value, 1.0].map(|part| u32::from(f16::from_f32(part).to_bits()));
        refuse([(FLOAT16, &halves), FLAT], &add, &message);
    }
}

#[test]
fn normal_component_of_65536() {
    let far = [65_536f32, -65_536.0, 65_536.0].map(f32::to_bits);
    assert_sum([(FLOAT32, &far), FLAT], SNORM8, [73.0, -73.0, 73.0]);
    let farther = [f32::from_bits(65_536f32.to_bits() + 1), 0.0, 1.0].map(f32::to_bits);
    refuse(
        [(FLOAT32, &farther), FLAT],
        &blend_options(BlendMethod::add(), SNORM8),
        &format!("the normal at column 0, row 0 has a component of 65536.01: {NO_DIRECTION}"),
    );
}

/// 65504 is the greatest half float.
#[test]
fn greatest_half_float() {
    let texel = [f16::MAX, f16::MIN, f16::MAX].map(|part| u32::from(part.to_bits()));
    assert_sum([(FLOAT16, &texel), FLAT], SNORM8, [73.0, -73.0, 73.0]);
}

#[test]
fn mask_of_zero_and_one() {
    let texels = [(SNORM8, &[90, 0, 90][..]), (SNORM8, &[0, 60, 120][..])];
    let masked = blend_options(BlendMethod::Masked, SNORM8);
    // A slope of 1 along x; of 1/2 along y: 127 (0, 1, 2)/sqrt(5).
    let (all_base, all_detail) = ([90.0, 0.0, 90.0], [0.0, 57.0, 114.0]);
    for (zero, one) in [
        (map_u8(1, 1, |_, _| 0), map_u8(1, 1, |_, _| 255)),
        (map_u16(1, 1, |_, _| 0), map_u16(1, 1, |_, _| 65_535)),
        (map_f32(1, 1, |_, _| 0.0), map_f32(1, 1, |_, _| 1.0)),
        (map_f32(1, 1, |_, _| -0.0), map_f32(1, 1, |_, _| 1.0 - 2f32.powi(-24))),
        // Beyond them.
        (map_f32(1, 1, |_, _| f32::MIN), map_f32(1, 1, |_, _| f32::MAX)),
    ] {
        assert_blend(texels, &masked, Some(&zero), &all_base);
        assert_blend(texels, &masked, Some(&one), &all_detail);
    }
}

#[test]
fn mask_that_is_nan() {
    let [base, detail] = [flat_map(1, 1, UNORM8), flat_map(1, 1, UNORM8)];
    assert_refused(
        |baker| {
            let mask = HeightMap::try_from(Grid::new(1, 1, vec![f32::NAN])?)?;
            let inputs = BlendInputs { mask: Some(&mask), ..pair(&base, &detail) };
            baker.blend(&inputs, &blend_options(BlendMethod::Masked, UNORM8))
        },
        "the height at column 0, row 0 is NaN: heights must be finite numbers; replace it in the map, or export the map \
         without no-data texels",
    );
}

/// 4/5 up is 229.5 of 255, 4/5 down is 25.5: both go up.
#[test]
fn blend_ties_under_either_convention() {
    for (up, format, code) in [(4, UNORM8, 230.0), (4, dx(UNORM8), 26.0), (252, UNORM8, 26.0), (252, dx(UNORM8), 230.0)]
    {
        assert_sum([(SNORM8, &[0, up, 3]), FLAT], format, [128.0, code, 204.0]);
    }
    assert_sum([(SNORM8, &[2, 1, 2]), FLAT], UNORM8, [213.0, 170.0, 213.0]);
}

/// A detail map of one texel, tiled over a base, is that texel everywhere.
#[test]
fn detail_of_one_texel() {
    let (base, detail) = (flat_map(5, 3, SNORM8), normal_map(1, 1, SNORM8, &[90, 0, 90]));
    let options = BlendOptions { tile: true, ..blend_options(BlendMethod::add(), SNORM8) };
    assert_each(every_baker().iter(), |Subject { name, baker }| {
        let blended = Image::from(&baker.blend(&pair(&base, &detail), &options).expect("a blend"));
        same(name, &blended.bits, &[90, 0, 90].repeat(15))
    });
    assert_refused(
        |baker| baker.blend(&pair(&base, &detail), &BlendOptions { tile: false, ..options }),
        "size of the second map is 1 x 1: it must be 5 x 3, as the first map's; to repeat a smaller one over the first, \
         tile it (--tile)",
    );
}
