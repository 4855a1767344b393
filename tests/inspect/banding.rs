//! Traces of 8 bits: widened codes in fine maps, terraces in coarse ones.

use super::support::{encoded, findings, problems, sound, xy};
use crate::support::{BIASED8, BIASED16, FLOAT16, FLOAT32, FORMATS, SNORM16, UNORM8, UNORM16};
use texbake::inspect::{Banding, Problem};
use texbake::{Codes, CodesRef, NormalFormat, NormalMap};

/// The components of an 8-bit unorm map, c / 127.5 - 1, or of a signed one, in a finer format.
fn widened(map: &NormalMap, format: NormalFormat, code: impl Fn(u8) -> f64) -> NormalMap {
    let CodesRef::U8(codes) = map.codes() else { panic!("8 bits") };
    let numbers = codes.iter().map(|c| code(*c));
    let codes = match format.depth {
        texbake::Depth::Bits16 => Codes::U16(numbers.map(|code| code as i64 as u16).collect()),
        texbake::Depth::Float16 => Codes::F16(numbers.map(half::f16::from_f64).collect()),
        _ => Codes::F32(numbers.map(|code| code as f32).collect()),
    };
    NormalMap::new(map.size(), format, codes).unwrap()
}

#[test]
fn fine_maps_that_hold_8_bits_are_found() {
    let (unorm, biased) = (sound(64, 64, UNORM8), sound(64, 64, BIASED8));
    let signed = |c: u8| f64::from(c) - 128.0;
    let cases = [
        ("repeated", widened(&unorm, UNORM16, |c| f64::from(c) * 257.0)),
        ("shifted", widened(&unorm, UNORM16, |c| f64::from(c) * 256.0)),
        ("snorm", widened(&biased, SNORM16, |c| (signed(c) / 127.0 * 32_767.0).round())),
        ("biased", widened(&biased, BIASED16, |c| (signed(c) / 127.0 * 32_767.0).round() + 32_768.0)),
        ("float", widened(&unorm, FLOAT32, |c| f64::from(c) / 127.5 - 1.0)),
        ("half", widened(&unorm, FLOAT16, |c| f64::from(c) / 127.5 - 1.0)),
        ("signed float", widened(&biased, FLOAT32, |c| signed(c) / 127.0)),
        ("half in a float", {
            let code = |c: u8| half::f16::from_f64(f64::from(c) / 127.5 - 1.0).to_f64();
            widened(&unorm, FLOAT32, code)
        }),
    ];
    for (name, map) in cases {
        let found = findings(&map);
        assert_eq!(found.banding, Banding::Fine { holds_8_bits: true }, "{name}");
        let finding = found.of(Problem::EightBit).unwrap_or_else(|| panic!("{name}: {found:?}"));
        let depth = map.format().depth;
        assert_eq!(
            finding.what,
            format!("every code is one of 8 bits, widened to {depth}: the file is larger, and no finer")
        );
    }
}

#[test]
fn one_code_between_those_of_8_bits_shows_a_finer_map() {
    let map = widened(&sound(64, 64, UNORM8), UNORM16, |c| f64::from(c) * 257.0);
    let finer = super::support::planted(&map, &[(super::support::texel(63, 63), [32_768.0, 32_768.0, 65_535.0])]);
    assert_eq!(findings(&finer).banding, Banding::Fine { holds_8_bits: false });
    for format in FORMATS.into_iter().chain(FORMATS.map(xy)).filter(|format| format.depth != UNORM8.depth) {
        assert_eq!(findings(&sound(64, 64, format)).banding, Banding::Fine { holds_8_bits: false }, "{format:?}");
    }
}

/// Direction (v, 0, sqrt(1 - v^2)) with the code 128 + step in x.
fn steps(width: usize, height: usize, step: impl Fn(usize) -> usize) -> NormalMap {
    encoded(width, height, UNORM8, |x, _| {
        let v = (2 * (128 + step(x)) - 255) as f64 / 255.0;
        [v, 0.0, (1.0 - v * v).sqrt()]
    })
}

#[test]
fn terraces_are_counted() {
    // Plateaus of 10 texels up to column 80: 7 steps of one code in each of 40 rows. z is 255 up to x = 10 codes.
    let map = steps(80, 40, |x| x / 10);
    assert_eq!(findings(&map).banding, Banding::Coarse { changes: 7 * 40, terraces: 7 * 40 });
    let found = findings(&map);
    let finding = found.of(Problem::Banding).unwrap();
    assert_eq!(finding.worst, Some(1.0));
    assert!(
        finding.what.contains("100% of the changes between neighbours are single codes between plateaus"),
        "{finding}"
    );
    // Plateaus of 7 are too short, steps of two codes too high.
    assert_eq!(findings(&steps(70, 40, |x| x / 7)).banding, Banding::Coarse { changes: 9 * 40, terraces: 0 });
    assert_eq!(findings(&steps(60, 40, |x| x / 10 * 2)).banding, Banding::Coarse { changes: 5 * 40, terraces: 0 });
    // A plateau of 8 on either side is enough, one of 7 on either is not.
    let of =
        |lengths: [usize; 2]| findings(&steps(lengths[0] + lengths[1], 1, |x| usize::from(x >= lengths[0]))).banding;
    assert_eq!(of([8, 8]), Banding::Coarse { changes: 1, terraces: 1 });
    assert_eq!([of([7, 20]), of([20, 7])], [Banding::Coarse { changes: 1, terraces: 0 }; 2]);
}

#[test]
fn terraces_down_the_columns_count_too() {
    let across = steps(80, 40, |x| x / 10);
    let CodesRef::U8(codes) = across.codes() else { panic!("8 bits") };
    let turned = (0..80 * 40).flat_map(|i| {
        let (x, y) = (i / 40, i % 40);
        codes[3 * (80 * y + x)..][..3].to_vec()
    });
    let map = NormalMap::new(texbake::Size::new(40, 80).unwrap(), UNORM8, Codes::U8(turned.collect())).unwrap();
    assert_eq!(findings(&map).banding, Banding::Coarse { changes: 7 * 40, terraces: 7 * 40 });
    assert_eq!(problems(&map).first(), Some(&Problem::Banding));
}

#[test]
fn a_gentle_wave_bands_in_8_bits_and_not_in_16() {
    let wave = |format| {
        encoded(512, 64, format, |x, _| {
            let v = 0.05 * (x as f64 / 512.0 * std::f64::consts::TAU).sin();
            [v, 0.0, (1.0 - v * v).sqrt()]
        })
    };
    assert_eq!(problems(&wave(UNORM8)), [Problem::Banding]);
    assert_eq!(problems(&wave(UNORM16)), []);
}
