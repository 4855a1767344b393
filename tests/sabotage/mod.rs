//! A comparison that cannot fail proves nothing: every helper is shown to catch one wrong code.

mod extremes;
mod tangents;
mod two_maps;

use crate::oracle;
use crate::support::{
    FLOAT32, FORMATS, Image, SNORM8, UNORM8, assert_every_baker, assert_same, differences, every_baker, map_u8, options,
};
use std::panic::{AssertUnwindSafe, catch_unwind};
use texbake::{Channels, Size};

/// The message of a test that must fail.
fn failure(test: impl FnOnce()) -> String {
    let panic = catch_unwind(AssertUnwindSafe(test)).expect_err("the comparison must fail");
    panic.downcast_ref::<String>().expect("a message").clone()
}

fn some_map() -> texbake::HeightMap {
    map_u8(13, 7, |x, y| (17 * x + 5 * y * y) as u8)
}

#[test]
fn one_changed_code_is_caught_with_its_place_and_both_values() {
    let map = some_map();
    for format in FORMATS {
        let expected = oracle::image(&map, &options("24", format));
        // z of column 11, row 4; its lowest bit.
        let index = (4 * 13 + 11) * 3 + 2;
        let mut got = expected.clone();
        got.bits[index] ^= 1;
        let report = differences(&got, &expected).expect_err("a code differs");
        let (wrong, right) = (got.number(index), expected.number(index));
        let place = format!("column 11, row 4, z: got {wrong} (");
        assert!(wrong != right && report.starts_with("1 of 273 codes differ"), "{report}");
        assert!(report.contains(&place) && report.contains(&format!("expected {right} (")), "{report}");
    }
}

#[test]
fn every_baker_is_really_compared() {
    let map = some_map();
    let options = options("24", UNORM8);
    let right = oracle::image(&map, &options);
    for index in [0, 100, right.bits.len() - 1] {
        let mut wrong = right.clone();
        wrong.bits[index] ^= 1;
        let report = failure(|| assert_every_baker(&map, &options, &wrong));
        assert!(report.starts_with("reference, u8 heights") && report.contains("1 of 273 codes differ"), "{report}");
    }
    assert!(every_baker().len() >= 2 && every_baker()[1].name == "cpu");
}

#[test]
fn only_the_first_differences_are_shown() {
    let expected = oracle::image(&some_map(), &options("24", SNORM8));
    let mut got = expected.clone();
    got.bits.iter_mut().for_each(|code| *code ^= 1);
    let report = differences(&got, &expected).expect_err("all differ");
    assert!(report.starts_with("273 of 273 codes differ") && report.lines().count() == 9, "{report}");
}

#[test]
fn comparing_nothing_is_a_failure() {
    let size = Size::new(2, 2).expect("a size");
    let nothing = Image { size, format: UNORM8, bits: Vec::new() };
    let report = failure(|| assert_same("nothing", &nothing, &nothing));
    assert_eq!(report, "nothing: 0 codes of 2 x 2 x 3 were compared");
}

#[test]
fn maps_of_other_shapes_differ() {
    let expected = oracle::image(&some_map(), &options("24", UNORM8));
    let mut short = expected.clone();
    short.bits.pop();
    let mut other_format = expected.clone();
    other_format.format.channels = Channels::Xy;
    let other_size = Image { size: Size::new(7, 13).expect("a size"), ..expected.clone() };
    for got in [short, other_format, other_size] {
        assert!(differences(&got, &expected).expect_err("another shape").starts_with("got a map of"));
    }
}

#[test]
fn the_sign_of_zero_is_compared() {
    let zero = |bits| Image { size: Size::new(1, 1).expect("a size"), format: FLOAT32, bits: vec![bits, 0, 0] };
    assert!(differences(&zero(1 << 31), &zero(0)).is_err());
    assert!(differences(&zero(0), &zero(0)).is_ok());
}
