//! Normals from samples: f64, and the values of codes written out.

use super::examined::{Examined, reals};
use super::real::Real;
use texbake::shading::{
    decode_biased_8_bit, decode_biased_16_bit, decode_snorm, decode_unorm, green_turned, rebuild_z,
};

/// Every code of 8 bits, and each component another one, as a texture unit gives them: c / 255.
fn codes_8() -> Vec<[f32; 3]> {
    (0..256).map(|code| [code, 255 - code, (code * 7) % 256].map(|code| code as f32 / 255.0)).collect()
}

/// A line through two points.
fn line([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> impl Fn(f64) -> f64 {
    move |x| y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}

fn decoder<'a>(
    call: &'static str,
    twin: &'a dyn Fn([f32; 3]) -> [f32; 3],
    exact: &'a dyn Fn([f64; 3]) -> [f64; 3],
    formula: &'a dyn Fn([Real; 3]) -> [Real; 3],
    arguments: Vec<[f32; 3]>,
) -> Examined<'a, 3, 3> {
    Examined {
        file: "decode_normal",
        call,
        twin,
        exact,
        formula,
        arguments,
        #[cfg(feature = "gpu")]
        texture: None,
    }
}

#[test]
fn unorm_is_a_line_from_minus_one_to_one() {
    let exact = |s: [f64; 3]| s.map(line([0.0, -1.0], [1.0, 1.0]));
    let formula = |s: [Real; 3]| s.map(|s| s.constant(2.0) * s - s.constant(1.0));
    let decode = decoder("decode_unorm(vec3(a[0], a[1], a[2]))", &decode_unorm, &exact, &formula, codes_8());
    decode.assert();
    decode.notices(&[("2.0 * s - 1.0", "2.0 * s - 1.004"), ("2.0 * s", "2.008 * s")]);
}

/// A signed channel gives max(c / 127, -1) itself, and a driver that gives -128/127 is put right.
#[test]
fn snorm_ends_at_minus_one() {
    let samples = (-128..128).map(|code| [code, -code, (code * 5) % 128].map(|code| code as f32 / 127.0)).collect();
    let exact = |s: [f64; 3]| s.map(|s| if s < -1.0 { -1.0 } else { s });
    let formula = |s: [Real; 3]| s.map(|s| s.max(s.constant(-1.0)));
    let decode = decoder("decode_snorm(vec3(a[0], a[1], a[2]))", &decode_snorm, &exact, &formula, samples);
    decode.assert();
    decode.notices(&[("max(s, vec3<f32>(-1.0))", "s")]);
}

#[test]
fn biased_codes_are_lines_through_their_zero_and_one() {
    let exact = |s: [f64; 3]| s.map(line([128.0 / 255.0, 0.0], [1.0, 1.0])).map(|v| v.max(-1.0));
    let formula = |s: [Real; 3]| {
        s.map(|s| ((s.constant(255.0) * s - s.constant(128.0)) / s.constant(127.0)).max(s.constant(-1.0)))
    };
    let call = "decode_biased_8_bit(vec3(a[0], a[1], a[2]))";
    let decode = decoder(call, &decode_biased_8_bit, &exact, &formula, codes_8());
    decode.assert();
    decode.notices(&[
        ("255.0 * s - 128.0", "255.0 * s - 127.5"),
        ("128.0) / 127.0, vec3<f32>(-1.0)", "128.0) / 127.0, vec3<f32>(-2.0)"),
    ]);

    let samples = (0..=65_535).step_by(97).map(|code| [code, 65_535 - code, 32_768].map(|code| code as f32 / 65_535.0));
    let exact = |s: [f64; 3]| s.map(line([32_768.0 / 65_535.0, 0.0], [1.0, 1.0])).map(|v| v.max(-1.0));
    let formula = |s: [Real; 3]| {
        s.map(|s| ((s.constant(65_535.0) * s - s.constant(32_768.0)) / s.constant(32_767.0)).max(s.constant(-1.0)))
    };
    let call = "decode_biased_16_bit(vec3(a[0], a[1], a[2]))";
    let decode = decoder(call, &decode_biased_16_bit, &exact, &formula, samples.collect());
    decode.assert();
    decode.notices(&[("65535.0 * s - 32768.0", "65535.0 * s - 32767.5")]);
}

/// What the encodings give for the same codes, written out: only signed and biased ones have a zero.
#[test]
fn the_code_128_is_zero_if_it_is_biased() {
    let sample = [128.0, 1.0, 255.0].map(|code: f32| code / 255.0);
    assert_eq!(decode_biased_8_bit(sample), [0.0, -1.0, 1.0]);
    assert_eq!(decode_unorm(sample).map(|v| (v * 255.0).round()), [1.0, -253.0, 255.0]);
    assert_eq!(decode_biased_8_bit([0.0; 3]), [-1.0; 3], "0 is a second -1");
    assert_eq!(decode_biased_16_bit([32_768.0 / 65_535.0, 1.0 / 65_535.0, 1.0]), [0.0, -1.0, 1.0]);
    // Schüler's constants: v = s 255/127 - 128/127.
    for code in 1..256 {
        let schueler = f64::from(code) / 255.0 * (255.0 / 127.0) - 128.0 / 127.0;
        let got = decode_biased_8_bit([code as f32 / 255.0, 0.0, 0.0])[0];
        assert!((f64::from(got) - schueler).abs() < 2e-7 && (schueler - f64::from(code - 128) / 127.0).abs() < 1e-15);
    }
}

#[test]
fn z_is_that_of_the_half_sphere() {
    let mut real = reals(0x744);
    let mut arguments: Vec<[f32; 2]> = Vec::new();
    while arguments.len() < 2000 {
        let [x, y] = [real(), real()];
        // The root of what is left by rounding has no bound: z of 0.01 and more, or beyond the rim.
        if (x * x + y * y - 1.0).abs() > 1e-4 {
            arguments.push([x as f32, y as f32]);
        }
    }
    let z = Examined {
        file: "decode_normal",
        call: "rebuild_z(vec2(a[0], a[1]))",
        twin: &rebuild_z,
        exact: &|[x, y]: [f64; 2]| [x, y, if x.hypot(y) > 1.0 { 0.0 } else { x.hypot(y).asin().cos() }],
        formula: &|[x, y]: [Real; 2]| {
            let rest = x.constant(1.0) - (x * x + y * y);
            [x, y, if rest.value > 0.0 { rest.sqrt() } else { x.constant(0.0) }]
        },
        arguments,
        #[cfg(feature = "gpu")]
        texture: None,
    };
    z.assert();
    z.notices(&[("1.0 - dot(xy, xy)", "1.0 - xy.x"), ("vec3<f32>(xy, sqrt(", "vec3<f32>(xy.yx, sqrt(")]);
    assert_eq!(rebuild_z([0.6, 0.0]), [0.6, 0.0, 0.8]);
    assert_eq!(rebuild_z([1.0, 1.0]), [1.0, 1.0, 0.0], "no NaN beyond the rim");
}

#[test]
fn green_is_turned() {
    let arguments = (0..20).map(|i| [i as f32, 10.0 - i as f32, 3.0]).collect();
    let exact = |[x, y, z]: [f64; 3]| [x, 0.0 - y, z];
    let formula = |[x, y, z]: [Real; 3]| [x, -y, z];
    let turned = decoder("green_turned(vec3(a[0], a[1], a[2]))", &green_turned, &exact, &formula, arguments);
    turned.assert();
    turned.notices(&[("-m.y", "m.y"), ("vec3<f32>(m.x, -m.y", "vec3<f32>(-m.x, -m.y")]);
}
