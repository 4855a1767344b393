//! Names and numbers as text: what is printed reads as it was, and what does not read is named.

use super::inputs::{any_float, edges, rational, scale};
use super::{CASES, assert_names_its_cause, holds};
use proptest::prelude::*;
use std::fmt::{Debug, Display};
use std::str::FromStr;
use texbake::inspect::{Problem, Severity};
use texbake::io::{Channel, RawLayout};
use texbake::{
    Channels, Convention, Depth, Edge, Edges, Encoding, Error, Filter, MissingNormals, Precision, Rational, Size,
    TangentMethod, Weights,
};

/// Any text reads as a value, which prints as a text that reads as that value; or it is refused by its name.
fn assert_reads<T: FromStr<Err = Error> + Display + PartialEq + Debug>(text: &str, parameter: &str) {
    match text.parse::<T>() {
        Ok(value) => assert_eq!(value.to_string().parse::<T>().ok(), Some(value), "{text:?}"),
        Err(error) => {
            assert_names_its_cause(&error);
            let Error::Parameter { parameter: named, value, .. } = error else { panic!("{error:?}") };
            assert_eq!((named, value.as_str()), (parameter, text));
        }
    }
}

/// Texts like those that are meant, and any others.
fn text() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => "[-+0-9./eE ]{0,24}",
        3 => "-?[0-9]{1,20}(\\.[0-9]{0,20})?([eE]-?[0-9]{1,3})?(/-?[0-9]{1,20})?",
        2 => "(wrap|clamp|mirror|unorm|8|16f|gl|xy|exact|red|alpha|central)[ ,]?(wrap|clamp|mirror)?",
        2 => "[0-9]{0,21}x[0-9]{0,21}:(u8|u16le|u16be|f32le|f32be|f32)",
        1 => "\\PC{0,20}",
    ]
}

#[test]
fn any_text_reads_or_is_refused_by_its_name() {
    holds(4 * CASES, text(), |text| {
        assert_reads::<Rational>(&text, "number");
        assert_reads::<Edges>(&text, "edge");
        assert_reads::<Edge>(&text, "edge");
        assert_reads::<Filter>(&text, "filter");
        assert_reads::<Encoding>(&text, "encoding");
        assert_reads::<Depth>(&text, "bits");
        assert_reads::<Channels>(&text, "channels");
        assert_reads::<Convention>(&text, "convention");
        assert_reads::<Precision>(&text, "precision");
        assert_reads::<TangentMethod>(&text, "method");
        assert_reads::<MissingNormals>(&text, "normals");
        assert_reads::<Problem>(&text, "problem");
        assert_reads::<Severity>(&text, "severity");
        assert_reads::<RawLayout>(&text, "raw");
        // Every text is a channel's name.
        let channel: Channel = text.parse().expect("a channel");
        assert_eq!(channel.to_string().parse(), Ok(channel));
        #[cfg(feature = "cli")]
        assert_reads::<texbake::batch::NameTemplate>(&text, "name");
    });
}

/// All of them: every name reads as itself.
#[test]
fn every_name_reads() {
    fn assert_all<T: FromStr<Err = Error> + Display>(names: &[&str]) {
        assert!(!names.is_empty());
        for name in names {
            assert_eq!(name.parse::<T>().expect("a name").to_string(), *name);
        }
    }
    assert_all::<Filter>(Filter::NAMES);
    assert_all::<Encoding>(Encoding::NAMES);
    assert_all::<Depth>(Depth::NAMES);
    assert_all::<Channels>(Channels::NAMES);
    assert_all::<Convention>(Convention::NAMES);
    assert_all::<Edge>(Edge::NAMES);
    assert_all::<Precision>(Precision::NAMES);
    assert_all::<TangentMethod>(TangentMethod::NAMES);
    assert_all::<MissingNormals>(MissingNormals::NAMES);
    assert_all::<Problem>(Problem::NAMES);
    assert_all::<Severity>(Severity::NAMES);
}

#[test]
fn what_is_printed_reads_as_it_was() {
    holds(CASES, (rational(), edges()), |(number, edges)| {
        assert_eq!(number.to_string().parse::<Rational>().ok(), Some(number));
        assert_eq!(edges.to_string().parse::<Edges>().ok(), Some(edges));
    });
}

/// Found: 999999999999999999/64 was printed as a decimal of 23 digits, which does not read.
#[test]
fn numbers_of_eighteen_digits_read_as_they_print() {
    for (numerator, denominator) in [
        (999_999_999_999_999_999, 64),
        (-999_999_999_999_999_999, 1),
        (1, 999_999_999_999_999_999),
        (99_999_999_999_999_999, 2),
    ] {
        let number = Rational::new(numerator, denominator).expect("a number");
        assert_eq!(number.to_string().parse::<Rational>().ok(), Some(number), "{number}");
    }
    // Found: parts of 19 digits were numbers, but printed as none.
    for (numerator, denominator) in [(i64::MAX, 1), (1, i64::MAX), (1_000_000_000_000_000_000, 1)] {
        assert!(Rational::new(numerator, denominator).is_err(), "{numerator}/{denominator}");
    }
}

#[test]
fn any_float_is_a_number_or_refused() {
    holds(CASES, any_float(), |value| match Rational::try_from(f64::from(value)) {
        Ok(number) => {
            let back = number.numerator() as f64 / number.denominator() as f64;
            assert!((back - f64::from(value)).abs() <= 1e-15 * back.abs(), "{value}: {number}");
        }
        Err(error) => assert_names_its_cause(&error),
    });
}

#[test]
fn any_ratio_is_a_number_or_refused() {
    holds(CASES, (any::<i64>(), any::<i64>()), |(numerator, denominator)| {
        match Rational::new(numerator, denominator) {
            Ok(number) => {
                let product = |a: i64, b: i64| i128::from(a) * i128::from(b);
                assert_eq!(product(number.numerator(), denominator), product(numerator, number.denominator()));
                assert!(number.denominator() > 0);
            }
            Err(error) => assert_names_its_cause(&error),
        }
    });
}

/// Parts below 2^24 and up to 65535, or a refusal.
#[test]
fn any_scale_and_any_weights_become_small_ratios() {
    let sides = (1..=70_000usize, 1..=70_000usize);
    holds(CASES, (scale(), sides, rational(), rational()), |(scale, (width, height), base, detail)| {
        match scale.resolve(Size::new(width, height).expect("a size")) {
            Ok(used) => {
                let most = used.x.unsigned_abs().max(used.y.unsigned_abs()).max(used.q);
                assert!(most < 1 << 24 && used.q > 0, "{used:?}");
            }
            Err(error) => assert_names_its_cause(&error),
        }
        match Weights::new(base, detail) {
            Ok(used) => {
                let most = used.base.unsigned_abs().max(used.detail.unsigned_abs()).max(used.q);
                assert!(most <= 65_535 && used.q > 0, "{used:?}");
            }
            Err(error) => assert_names_its_cause(&error),
        }
    });
}
