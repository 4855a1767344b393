//! What has no direction, and what is refused.

use crate::support::{
    FLOAT16, FLOAT32, Image, SNORM8, Subject, UNORM8, UNORM16, blend_options, dx, every_baker, flat_map, map_f32,
    map_u8, normal_map, number, pair, weighted, xy,
};
use half::f16;
use texbake::{
    BlendInputs, BlendMethod, BlendOptions, Depth, Encoding, Error, HeightMap, NormalFormat, NormalMap, Rational,
    Weights,
};

/// The one texel of a blend, on every baker.
fn assert_texel(maps: [(NormalFormat, &[u32]); 2], method: BlendMethod, format: NormalFormat, expected: [f64; 3]) {
    let [base, detail] = maps.map(|(format, bits)| normal_map(1, 1, format, bits));
    for Subject { name, baker } in every_baker() {
        let blended = baker.blend(&pair(&base, &detail), &blend_options(method, format)).expect("a blend");
        assert_eq!(Image::from(&blended).texel(0, 0), expected, "{name}, {maps:?}, {method:?}");
    }
}

#[test]
fn z_at_or_below_zero_is_the_least_above_it() {
    let flat = (SNORM8, &[0, 0, 127][..]);
    // z = 0 and z = -127 count as 1: (127, 0, 1) over 127.004 leaves x = 127 and z = 1.
    for z in [0, 0x81, 0x80, 0xff] {
        assert_texel([(SNORM8, &[127, 0, z]), flat], BlendMethod::add(), SNORM8, [127.0, 0.0, 1.0]);
        // Two such slopes of 127: (254, 0, 1), z = 0.49998 of 127.
        assert_texel([(SNORM8, &[127, 0, z]); 2], BlendMethod::add(), SNORM8, [127.0, 0.0, 0.0]);
    }
    // Unorm: z = 127 is -1 and 128 is 0; both count as 1 of 255. (255, 0, 1): 127.5 (0.0039 + 1) = 128.0.
    for z in [0, 127, 128] {
        assert_texel(
            [(UNORM8, &[255, 128, z]), (UNORM8, &[128, 128, 255])],
            BlendMethod::add(),
            UNORM8,
            [255.0, 128.0, 128.0],
        );
    }
    // Floats: z = 2^-24, so (2^-24, 0, 2^-24) is a slope of 1.
    let tiny = 2f32.powi(-24).to_bits();
    for z in [0.0f32, -0.0, -3.0] {
        let steep = [tiny, 0, z.to_bits()];
        assert_texel([(FLOAT32, &steep), flat], BlendMethod::add(), SNORM8, [90.0, 0.0, 90.0]);
    }
}

#[test]
fn vectors_of_length_zero_are_flat() {
    for (format, zero) in [(SNORM8, [0; 3]), (UNORM8, [128; 3]), (UNORM16, [32_768; 3]), (FLOAT32, [0; 3])] {
        for method in [BlendMethod::add(), BlendMethod::Linear] {
            assert_texel([(format, &zero); 2], method, SNORM8, [0.0, 0.0, 127.0]);
        }
        // And leave the other map as it is: (3, 4, 12)/13.
        assert_texel([(format, &zero), (SNORM8, &[30, 40, 120])], BlendMethod::add(), SNORM8, [29.0, 39.0, 117.0]);
    }
}

#[test]
fn length_does_not_matter_in_slope_space() {
    // Slopes (3/4, 0) and (0, 1/2): (3, 2, 4)/sqrt(29), 127 of it 70.75, 47.17, 94.33.
    for (first, second) in [([3, 0, 4], [0, 1, 2]), ([93, 0, 124], [0, 60, 120]), ([3, 0, 4], [0, 50, 100])] {
        assert_texel([(SNORM8, &first), (SNORM8, &second)], BlendMethod::add(), SNORM8, [71.0, 47.0, 94.0]);
    }
    // Two channels beyond unit length: z is the least above zero.
    assert_texel([(xy(SNORM8), &[127, 127]), (SNORM8, &[0, 0, 127])], BlendMethod::add(), SNORM8, [90.0, 90.0, 1.0]);
}

#[test]
fn what_cancels_is_flat() {
    let slope = (SNORM8, &[60, 0x100 - 70, 90][..]);
    assert_texel([slope; 2], weighted("1", "-1"), SNORM8, [0.0, 0.0, 127.0]);
    assert_texel([slope; 2], weighted("-65535", "65535"), UNORM8, [128.0, 128.0, 255.0]);
    assert_texel([slope; 2], weighted("0", "0"), UNORM8, [128.0, 128.0, 255.0]);
    // Vectors that add up to nothing: z counts as 1 at least, so z is what is left.
    assert_texel([(SNORM8, &[60, 0, 1]), (SNORM8, &[196, 0, 1])], BlendMethod::Linear, SNORM8, [0.0, 0.0, 127.0]);
    // Floats that mirror each other.
    let float = |v: f32| v.to_bits();
    let (right, left) = ([float(0.6), 0, float(0.8)], [float(-0.6), 0, float(0.8)]);
    assert_texel([(FLOAT32, &right), (FLOAT32, &left)], BlendMethod::add(), UNORM8, [128.0, 128.0, 255.0]);
}

#[test]
fn green_points_as_each_map_says() {
    // Slope 1 up the image twice: once as green up, once as green down; (0, 2, 1)/sqrt(5) is 114 and 57 of 127.
    let (up, down) = ([0, 90, 90], [0, 0x100 - 90, 90]);
    for (first, second) in [(SNORM8, dx(SNORM8)), (dx(SNORM8), SNORM8)] {
        let bits = |format: NormalFormat| if format == SNORM8 { &up } else { &down };
        let maps = [(first, &bits(first)[..]), (second, &bits(second)[..])];
        assert_texel(maps, BlendMethod::add(), SNORM8, [0.0, 114.0, 57.0]);
        assert_texel(maps, BlendMethod::add(), dx(SNORM8), [0.0, -114.0, 57.0]);
    }
}

/// The message of a blend that every baker must refuse.
fn refusal(inputs: &BlendInputs<&NormalMap, &HeightMap>, options: &BlendOptions) -> String {
    let messages: Vec<String> = every_baker()
        .iter()
        .map(|Subject { name, baker }| match baker.blend(inputs, options) {
            Err(error) => error.to_string(),
            Ok(_) => panic!("{name} blends with {options:?}"),
        })
        .collect();
    assert!(messages.iter().all(|message| *message == messages[0]), "{messages:?}");
    messages[0].clone()
}

#[test]
fn other_sizes_are_refused() {
    let (base, small) = (flat_map(8, 6, UNORM8), flat_map(4, 6, UNORM8));
    let add = blend_options(BlendMethod::add(), UNORM8);
    assert_eq!(
        refusal(&pair(&base, &small), &add),
        "size of the second map is 4 x 6: it must be 8 x 6, as the first map's; to repeat a smaller one over the \
         first, tile it (--tile)"
    );
    for tile in [false, true] {
        let masked = BlendOptions { tile, ..blend_options(BlendMethod::Masked, UNORM8) };
        let mask = map_u8(8, 5, |_, _| 0);
        let inputs = BlendInputs { mask: Some(&mask), ..pair(&base, &base) };
        assert_eq!(refusal(&inputs, &masked), "size of the mask is 8 x 5: it must be 8 x 6, as the first map's");
    }
}

#[test]
fn masks_and_methods_go_together() {
    let (map, mask) = (flat_map(8, 6, UNORM8), map_u8(8, 6, |_, _| 7));
    assert_eq!(
        refusal(&pair(&map, &map), &blend_options(BlendMethod::Masked, UNORM8)),
        "mask is missing: it must be given for a masked blend"
    );
    let inputs = BlendInputs { mask: Some(&mask), ..pair(&map, &map) };
    for method in [BlendMethod::add(), BlendMethod::Linear, BlendMethod::Rnm] {
        assert_eq!(
            refusal(&inputs, &blend_options(method, UNORM8)),
            "mask is given: it must be left out unless the blend is masked"
        );
    }
    let hole = texbake::Grid::new(2, 1, vec![0.5, f32::NAN]).expect("a grid");
    assert!(HeightMap::try_from(hole).is_err(), "a mask holds numbers, as heights do");
    assert_eq!(map_f32(1, 1, |_, _| 2.0).size().texels(), 1, "and may be beyond 1");
}

#[test]
fn weights_out_of_range_are_refused() {
    let map = flat_map(3, 3, UNORM8);
    for (a, b, named) in [("65536", "1", "65536"), ("1", "-65535.5", "-65535.5"), ("-1e9", "1", "-1000000000")] {
        assert_eq!(
            refusal(&pair(&map, &map), &blend_options(weighted(a, b), UNORM8)),
            format!("weights is {named}: it must be between -65535 and 65535")
        );
    }
    let mixed = NormalFormat { encoding: Encoding::Snorm, depth: Depth::Float16, ..UNORM8 };
    assert_eq!(
        refusal(&pair(&map, &map), &blend_options(BlendMethod::add(), mixed)),
        "bits is 16f: it must be 8 or 16 for the encodings unorm, snorm and biased"
    );
}

/// Weights of many digits are replaced by the nearest ratios, which the report names.
#[test]
fn long_weights_are_replaced() {
    let maps = [[100, 20, 60], [30, 0x100 - 90, 80]].map(|texel| normal_map(1, 1, SNORM8, &texel));
    for (a, b) in [("3.14159265358979", "0.1234567"), ("1.000001", "-65534.9")] {
        let Weights { base, detail, q, exact } = Weights::new(number(a), number(b)).expect("in range");
        assert!(!exact && base.abs().max(detail.abs()).max(q as i32) <= 65_535, "{a}, {b}");
        let ratio = |part: i32| Rational::new(part.into(), q.into()).expect("a ratio");
        let nearby = BlendMethod::Weighted { base: ratio(base), detail: ratio(detail) };
        let expected = crate::oracle::blend(
            &pair(&maps[0], &maps[1]),
            &blend_options(nearby, UNORM16),
            crate::oracle::UnormZero::Zero,
        );
        let asked = blend_options(weighted(a, b), UNORM16);
        crate::support::assert_every_blend(&pair(&maps[0], &maps[1]), &asked, &expected.image);
    }
}

#[test]
fn floats_without_a_direction_are_named_by_position() {
    let flat = flat_map(3, 2, FLOAT32);
    let message = "components must be between -65536 and 65536; texbake check --repair -o FILE makes such texels flat";
    for (value, name) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (-65_537.0, "-65537"), (65_536.01, "65536.01")] {
        for (texel, channel, place) in [(1, 0, "column 1, row 0"), (5, 2, "column 2, row 1")] {
            let mut bits = Image::from(&flat).bits;
            bits[3 * texel + channel] = value.to_bits();
            let hole = normal_map(3, 2, FLOAT32, &bits);
            for inputs in [pair(&flat, &hole), pair(&hole, &flat)] {
                let found = refusal(&inputs, &blend_options(BlendMethod::add(), UNORM8));
                assert_eq!(found, format!("the normal at {place} has a component of {name}: {message}"));
            }
        }
    }
    let mut halves = Image::from(&flat_map(3, 2, xy(FLOAT16))).bits;
    halves[2 * 4 + 1] = f16::INFINITY.to_bits().into();
    let hole = normal_map(3, 2, xy(FLOAT16), &halves);
    let found = refusal(&pair(&hole, &flat), &blend_options(BlendMethod::add(), UNORM8));
    assert_eq!(found, format!("the normal at column 1, row 1 has a component of inf: {message}"));
    for Subject { name, baker } in every_baker() {
        let error = baker.blend(&pair(&hole, &flat), &BlendOptions::default()).expect_err("no direction");
        assert!(matches!(error, Error::NoDirection { x: 1, y: 1, .. }), "{name}: {error:?}");
        // 65536 itself is a component.
        let far = normal_map(3, 2, FLOAT32, &[65_536f32.to_bits(); 18]);
        assert!(baker.blend(&pair(&far, &flat), &BlendOptions::default()).is_ok(), "{name}");
    }
}
