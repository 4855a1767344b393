//! Sizes, formats and numbers at their ends.

use super::assert_refused;
use crate::support::{SNORM8, Subject, every_baker, map_u8, options, xy};
use texbake::{CodesMut, Depth, Encoding, Error, Grid, HeightMap, NormalFormat, NormalOptions, Rational, Size};

#[test]
fn size_of_zero() {
    for (width, height) in [(0, 1), (1, 0), (0, 0)] {
        assert_refused(
            |baker| baker.normal(&HeightMap::from(Grid::<u8>::new(width, height, vec![])?), &NormalOptions::default()),
            &format!("size is {width}x{height}: it must be at least 1x1 and at most 2147483647 texels on each side"),
        );
    }
}

#[test]
fn size_of_2_to_the_31() {
    for (width, height) in [(1 << 31, 1), (1, 1 << 31), (usize::MAX, usize::MAX)] {
        let error = Size::new(width, height).expect_err("too large").to_string();
        let told = "it must be at least 1x1 and at most 2147483647 texels on each side";
        assert_eq!(error, format!("size is {width}x{height}: {told}"));
    }
    assert_eq!(Size::new((1 << 31) - 1, 1).expect("a size").texels(), (1 << 31) - 1);
}

#[test]
fn fewer_texels_than_the_size() {
    assert_refused(
        |baker| baker.normal(&HeightMap::from(Grid::new(3, 2, vec![0u8; 5])?), &NormalOptions::default()),
        "number of texels is 5: it must be 6 for a map of 3 x 2",
    );
    let map = map_u8(2, 1, |_, _| 0);
    assert_refused(
        |baker| baker.normal_into(&map, &NormalOptions::default(), CodesMut::U8(&mut [0; 5])),
        "codes is 5 codes of 8 bits: it must be 6 codes of 8 bits",
    );
}

#[test]
fn depth_without_its_encoding() {
    for (encoding, depth, message) in [
        (Encoding::Snorm, Depth::Float16, "bits is 16f: it must be 8 or 16 for the encodings unorm, snorm and biased"),
        (Encoding::Float, Depth::Bits16, "bits is 16: it must be 16f or 32f for the encoding float"),
    ] {
        let format = NormalFormat { encoding, depth, ..Default::default() };
        assert_refused(|baker| baker.normal(&map_u8(2, 1, |_, _| 0), &options("1", format)), message);
    }
}

#[test]
fn numbers_of_too_many_digits() {
    let range = "it must be an integer, a decimal (0.35, 1e-3) or a ratio (7/3) of at most 18 digits";
    for text in ["1234567890123456789", "1e18", "1e-18", "1/0", "nan", "inf", "1e999999999999", ""] {
        let error = text.parse::<Rational>().expect_err(text).to_string();
        assert_eq!(error, format!("number is {text}: {range}"));
    }
    let greatest: Rational = "999999999999999999".parse().expect("18 digits");
    assert_eq!(greatest.numerator(), 999_999_999_999_999_999);
    let least: Rational = "1e-17".parse().expect("18 digits");
    assert_eq!((least.numerator(), least.denominator()), (1, 100_000_000_000_000_000));
}

/// A dispatch has 65535 workgroups of 256 texels in a row. Where that is the end, a CPU goes on.
#[test]
fn map_wider_than_a_dispatch() {
    let width = 65_535 * 256 + 1;
    let map = map_u8(width, 1, |x, _| if x == 0 { 255 } else { 0 });
    let options = options("2", xy(SNORM8));
    for Subject { name, baker } in every_baker() {
        let mut codes = vec![0xaa; 2 * width];
        let result = baker.normal_into(&map, &options, CodesMut::U8(&mut codes));
        if ["reference", "cpu"].contains(name) {
            result.expect("a bake");
            // Texel 0 is one high, the others flat: only its neighbours lean, by 45 degrees.
            assert_eq!((codes[2], codes[2 * width - 2]), (90, 166), "{name}");
            codes[2] = 0;
            codes[2 * width - 2] = 0;
            assert!(codes.iter().all(|code| *code == 0), "{name}");
        } else {
            let Err(Error::Device { adapter, reason }) = result else { panic!("{name}: {result:?}") };
            assert!(!adapter.is_empty(), "{name}");
            assert_eq!(
                reason, "rows of 16776961 texels are too wide for it: 65536 workgroups where 65535 are allowed",
                "{name}"
            );
            assert!(codes.iter().all(|code| *code == 0xaa), "{name}: nothing is written");
        }
    }
}
