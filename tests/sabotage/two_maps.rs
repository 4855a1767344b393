//! Blends and parallax maps by other rules than the documented ones are seen to differ.

use super::{failure, some_map};
use crate::oracle::{UnormZero, blend, parallax, parallax_with_normals};
use crate::support::{
    FORMATS, Image, Random, SNORM8, UNORM8, assert_every_baker, assert_every_blend, assert_every_parallax,
    assert_every_parallax_with_normals, blend_options, differences, dx, flat_map, normal_map, options, pair,
    parallax_formats, parallax_options, random_codes, weighted,
};
use texbake::{BlendMethod, NormalFormat, NormalMap};

fn two_maps(format: NormalFormat) -> [NormalMap; 2] {
    let mut random = Random::new(0x5ab0);
    [0; 2].map(|_| random_codes(&mut random, 13, 7, format))
}

#[test]
fn one_changed_code_of_a_blend_or_a_parallax_map_is_caught() {
    let [base, detail] = two_maps(UNORM8);
    let options = blend_options(BlendMethod::add(), SNORM8);
    let mut wrong = blend(&pair(&base, &detail), &options, UnormZero::Zero).image;
    wrong.bits[3 * 90 + 1] ^= 1;
    let report = failure(|| assert_every_blend(&pair(&base, &detail), &options, &wrong));
    assert!(report.starts_with("reference, ") && report.contains("1 of 273 codes differ"), "{report}");
    assert!(report.contains("column 12, row 6, y: got "), "{report}");

    for format in parallax_formats() {
        let (map, options) = (some_map(), parallax_options("24", format));
        let mut wrong = parallax(&map, &options).image;
        wrong.bits[13 * 2 + 5] ^= 1;
        let report = failure(|| assert_every_parallax(&map, &options, &wrong));
        assert!(report.starts_with("reference, u8 heights") && report.contains("1 of 91 codes differ"), "{report}");
        assert!(report.contains("column 5, row 2, parallax: got "), "{report}");
    }

    let mut wrong = parallax_with_normals(&some_map(), &base, parallax_formats()[0]).image;
    wrong.bits[0] ^= 1;
    let report = failure(|| assert_every_parallax_with_normals(&some_map(), &base, &wrong));
    assert!(report.contains("1 of 91 codes differ"), "{report}");
}

/// Codes of maps by a rule and by another one; both were compared, and every baker follows the first.
fn assert_rules_differ(maps: &[NormalMap; 2], method: BlendMethod, format: NormalFormat, other: &Image) {
    let options = blend_options(method, format);
    let right = blend(&pair(&maps[0], &maps[1]), &options, UnormZero::Zero).image;
    assert!(differences(other, &right).is_err(), "{method:?} does not see the difference");
    assert_every_blend(&pair(&maps[0], &maps[1]), &options, &right);
    failure(|| assert_every_blend(&pair(&maps[0], &maps[1]), &options, other));
}

/// With 2c - L alone, 128 is 1/255: a flat map would tilt all others.
#[test]
fn the_code_of_zero_is_no_255th() {
    let map = normal_map(2, 1, UNORM8, &[218, 128, 218, 128, 255, 140]);
    let maps = [map, flat_map(2, 1, UNORM8)];
    let options = blend_options(BlendMethod::add(), UNORM8);
    let tilted = blend(&pair(&maps[0], &maps[1]), &options, UnormZero::OneOverL).image;
    assert_rules_differ(&maps, BlendMethod::add(), UNORM8, &tilted);
}

#[test]
fn a_wrong_sign_of_green_is_seen() {
    let [base, detail] = two_maps(SNORM8);
    let claimed = normal_map(13, 7, dx(SNORM8), &Image::from(&detail).bits);
    for method in [BlendMethod::add(), BlendMethod::Rnm, BlendMethod::Linear] {
        let turned = blend(&pair(&base, &claimed), &blend_options(method, UNORM8), UnormZero::Zero).image;
        assert_rules_differ(&[base.clone(), detail.clone()], method, UNORM8, &turned);
    }
    // Of a bake too.
    let (gl, down) = (options("24", SNORM8), options("24", dx(SNORM8)));
    let mut turned = crate::oracle::image(&some_map(), &down);
    turned.format = SNORM8;
    failure(|| assert_every_baker(&some_map(), &gl, &turned));
}

/// Each method, each weight and each order is another picture.
#[test]
fn every_method_differs_from_every_other() {
    let [base, detail] = two_maps(SNORM8);
    let methods = [
        BlendMethod::add(),
        weighted("1", "-1"),
        weighted("-1", "1"),
        weighted("1", "1.01"),
        BlendMethod::Linear,
        BlendMethod::Overlay,
        BlendMethod::Udn,
        BlendMethod::Whiteout,
        BlendMethod::Rnm,
    ];
    let images =
        methods.map(|method| blend(&pair(&base, &detail), &blend_options(method, FORMATS[1]), UnormZero::Zero).image);
    for (i, first) in images.iter().enumerate() {
        for (j, second) in images.iter().enumerate() {
            assert_eq!(differences(first, second).is_ok(), i == j, "{:?} and {:?}", methods[i], methods[j]);
        }
    }
}

/// (2h - 1) without n_z, or n_z of another scale, is another picture.
#[test]
fn another_normal_under_a_parallax_map_is_seen() {
    for format in parallax_formats() {
        let right = parallax(&some_map(), &parallax_options("24", format)).image;
        for scale in ["0", "23"] {
            let mut other = parallax(&some_map(), &parallax_options(scale, format)).image;
            assert!(differences(&other, &right).is_err(), "{scale}, {format:?}");
            other.bits.pop();
            assert!(differences(&other, &right).expect_err("another shape").starts_with("got a map of"));
        }
    }
}
