//! Any two normal maps, any mask, any method: the same bytes everywhere, or a refusal that names what is wrong.

use super::inputs::{any_normal_format, finite_float, is_stored, normal_format, normal_map, rational, side};
use super::{CASES, FEW, agreed, holds, on_the_cpu};
use crate::support::{
    FLOAT32, Image, SNORM8, SNORM16, UNORM8, UNORM16, assert_same, blend_options, differences, every_baker, flat_map,
    pair, xy,
};
use proptest::collection::vec;
use proptest::prelude::*;
use texbake::inspect::{CheckOptions, Difference, check};
use texbake::stream::Monitor;
use texbake::{
    Baker, BlendInputs, BlendMethod, BlendOptions, Depth, Encoding, Error, Grid, HeightMap, NormalFormat, NormalMap,
    Rational,
};

fn method(weight: BoxedStrategy<Rational>) -> impl Strategy<Value = BlendMethod> {
    use BlendMethod::{Linear, Masked, Overlay, Rnm, Udn, Whiteout};
    let weighted = (weight.clone(), weight).prop_map(|(base, detail)| BlendMethod::Weighted { base, detail });
    prop_oneof![
        2 => weighted,
        3 => prop::sample::select(vec![BlendMethod::add(), Masked, Linear, Overlay, Udn, Whiteout, Rnm]),
    ]
}

/// A weight that there is.
fn weight() -> impl Strategy<Value = Rational> + Clone {
    (-65_535..=65_535i64, 1..=99i64).prop_map(|(n, d)| Rational::new(n, d).expect("a weight"))
}

fn mask(width: usize, height: usize) -> impl Strategy<Value = HeightMap> {
    let count = width * height;
    prop_oneof![
        vec(any::<u8>(), count).prop_map(move |codes| Grid::new(width, height, codes).expect("a grid").into()),
        vec(any::<u16>(), count).prop_map(move |codes| Grid::new(width, height, codes).expect("a grid").into()),
        vec(finite_float(), count).prop_map(move |values| {
            Grid::new(width, height, values).expect("a grid").try_into().expect("finite floats")
        }),
    ]
}

/// Two maps, sometimes of two sizes, and a mask of the base's size or, rarely, another.
fn layers() -> impl Strategy<Value = (NormalMap, NormalMap, HeightMap)> {
    let sizes = prop_oneof![
        4 => (side(), side()).prop_map(|size| (size, size)),
        1 => ((side(), side()), (side(), side())),
    ];
    (sizes, normal_format(), normal_format()).prop_flat_map(|((base, detail), first, second)| {
        (normal_map(base.0, base.1, first), normal_map(detail.0, detail.1, second), mask(base.0, base.1))
    })
}

fn blend(baker: &Baker, inputs: &BlendInputs<&NormalMap, &HeightMap>, options: &BlendOptions) -> Result<Image, Error> {
    Ok(Image::from(&baker.blend(inputs, options)?))
}

#[test]
fn blends_are_the_same_everywhere_or_refused() {
    let inputs = (layers(), method(rational()), any_normal_format(), any::<bool>(), any::<bool>());
    holds(CASES, inputs, |((base, detail, mask), method, format, tile, with_mask)| {
        // Mostly a mask where one is wanted.
        let mask = (with_mask == (method == BlendMethod::Masked)).then_some(&mask);
        let options = BlendOptions { method, tile, format, ..Default::default() };
        let inputs = BlendInputs { mask, ..pair(&base, &detail) };
        match agreed(on_the_cpu(), |baker| blend(baker, &inputs, &options), differences) {
            Ok(image) => assert_eq!(image.size, base.size()),
            Err(Error::Parameter { parameter, .. }) => {
                let (is_masked, is_far) = (
                    method == BlendMethod::Masked,
                    match method {
                        BlendMethod::Weighted { base, detail } => {
                            [base, detail].iter().any(|w| w.numerator().abs() / w.denominator() >= 65_535)
                        }
                        _ => false,
                    },
                );
                match parameter {
                    "bits" => assert!(!is_stored(format.encoding, format.depth)),
                    "weights" => assert!(is_far),
                    "mask" => assert_ne!(is_masked, mask.is_some()),
                    "size of the second map" => assert!(!tile && base.size() != detail.size()),
                    other => panic!("{other}"),
                }
            }
            Err(Error::NoDirection { value, .. }) => assert!(value.is_nan() || value.abs() > 65_536.0),
            Err(other) => panic!("{other}"),
        }
    });
}

/// What GPUs blend: a kernel is compiled for each of these.
#[test]
fn gpus_blend_the_same_bytes() {
    let formats: Vec<[NormalFormat; 3]> = vec![
        [UNORM8, UNORM8, UNORM8],
        [SNORM8, xy(UNORM16), SNORM16],
        [UNORM16, SNORM16, UNORM16],
        [FLOAT32, UNORM8, FLOAT32],
    ];
    let inputs = (side(), side(), prop::sample::select(formats), weight(), weight()).prop_flat_map(
        |(width, height, [first, second, format], base, detail)| {
            let maps = (normal_map(width, height, first), normal_map(width, height, second));
            (maps, Just(blend_options(BlendMethod::Weighted { base, detail }, format)))
        },
    );
    holds(4 * FEW, inputs, |((base, detail), options)| {
        let result = agreed(every_baker(), |baker| blend(baker, &pair(&base, &detail), &options), differences);
        assert!(matches!(result, Ok(_) | Err(Error::NoDirection { .. })), "{result:?}");
    });
}

fn integer_format() -> impl Strategy<Value = NormalFormat> {
    normal_format().prop_map(|format| match format.encoding {
        Encoding::Float => NormalFormat { encoding: Encoding::Snorm, depth: Depth::Bits8, ..format },
        _ => format,
    })
}

fn integer_maps() -> impl Strategy<Value = (NormalMap, NormalMap)> {
    (side(), side(), integer_format(), integer_format()).prop_flat_map(|(width, height, first, second)| {
        (normal_map(width, height, first), normal_map(width, height, second))
    })
}

/// A flat map leaves each normal's direction: as a weight of zero does, on either side.
#[test]
fn a_flat_map_changes_nothing() {
    holds(CASES, (integer_maps(), integer_format()), |((map, other), format)| {
        let size = map.size();
        let flat = flat_map(size.width(), size.height(), other.format());
        let [one, zero] = [1, 0].map(Rational::from);
        for subject in on_the_cpu() {
            let blend = |first: &NormalMap, second: &NormalMap, base, detail| {
                let options = blend_options(BlendMethod::Weighted { base, detail }, format);
                blend(&subject.baker, &pair(first, second), &options).expect("a blend")
            };
            let alone = blend(&map, &other, one, zero);
            assert_same(subject.name, &blend(&map, &flat, one, one), &alone);
            assert_same(subject.name, &blend(&flat, &map, one, one), &alone);
        }
    });
}

/// Integer maps may change places with their weights.
#[test]
fn sums_commute() {
    holds(CASES, (integer_maps(), integer_format(), weight(), weight()), |((first, second), format, a, b)| {
        for subject in on_the_cpu() {
            let blend = |maps, base, detail| {
                blend(&subject.baker, &maps, &blend_options(BlendMethod::Weighted { base, detail }, format))
            };
            let there = blend(pair(&first, &second), a, b).expect("a blend");
            assert_same(subject.name, &blend(pair(&second, &first), b, a).expect("a blend"), &there);
        }
    });
}

/// Whatever is in a map, looking at it ends with findings or an error that says why not.
#[test]
fn any_map_can_be_checked_and_compared() {
    holds(CASES, layers(), |(map, other, _)| {
        let monitor = Monitor::default();
        let findings = check(map.clone().into_rows(), &CheckOptions::default(), &monitor).expect("findings");
        assert_eq!(findings.size, map.size());
        match Difference::between(map.clone().into_rows(), other.clone().into_rows(), 1.0, &monitor) {
            Ok(_) => assert_eq!(map.size(), other.size()),
            Err(error) => {
                super::assert_names_its_cause(&error);
                assert_ne!(map.size(), other.size());
            }
        }
        let same = Difference::between(map.clone().into_rows(), map.clone().into_rows(), 0.0, &monitor);
        let same = same.expect("a comparison");
        assert!(same.largest.is_none_or(|(degrees, _)| degrees == 0.0), "{same:?}");
    });
}
