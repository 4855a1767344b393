//! Numbers and names as users write them.

use std::fmt::{Debug, Display};
use std::path::{Component, Path};
use std::str::FromStr;
use texbake::batch::{Found, MapKind, NameTemplate};
use texbake::io::{Channel, ColorSpace, RawLayout};
use texbake::{
    Channels, Convention, Depth, Edge, Edges, Encoding, Error, Filter, MissingNormals, Precision, Rational, Scale,
    Size, TangentMethod,
};

/// Reads text as everything that is written as text: what is read is written as text that reads as the same, and what
/// is not is refused with its value and what it may be.
pub fn assert_reads(text: &str) {
    round_trip::<Encoding>(text);
    round_trip::<Depth>(text);
    round_trip::<Channels>(text);
    round_trip::<Convention>(text);
    round_trip::<Edge>(text);
    round_trip::<Edges>(text);
    round_trip::<Filter>(text);
    round_trip::<Precision>(text);
    round_trip::<MissingNormals>(text);
    round_trip::<TangentMethod>(text);
    round_trip::<ColorSpace>(text);
    round_trip::<MapKind>(text);
    round_trip::<RawLayout>(text);
    let Ok(channel) = text.parse::<Channel>();
    assert_eq!(channel.to_string().parse::<Channel>(), Ok(channel));
    if let Some(number) = round_trip::<Rational>(text) {
        assert_number(text, number);
    }
    if let Some(template) = round_trip::<NameTemplate>(text) {
        assert_stays_below(&template);
    }
}

fn round_trip<T: FromStr<Err = Error> + Display + Debug + PartialEq>(text: &str) -> Option<T> {
    match text.parse::<T>() {
        Ok(value) => {
            let again = value.to_string().parse::<T>().expect("what is written is read");
            assert_eq!(again, value, "{text:?}, written as {value}");
            Some(value)
        }
        Err(Error::Parameter { value, range, .. }) => {
            assert!(value == text && !range.is_empty(), "{text:?}: {value:?} must be {range:?}");
            None
        }
        Err(error) => panic!("{text:?}: {error:?} is no error of a parameter"),
    }
}

/// In lowest terms, near what Rust's own floats read, and a scale that resolves or is refused.
fn assert_number(text: &str, number: Rational) {
    let (above, below) = (number.numerator(), number.denominator());
    assert!(below > 0 && gcd(above.unsigned_abs(), below.unsigned_abs()) == 1, "{text:?}: {above}/{below}");
    if let Ok(float) = text.trim().parse::<f64>() {
        let read = above as f64 / below as f64;
        assert!((read - float).abs() <= 1e-14 * float.abs(), "{text:?}: {float} and {read}");
    }
    let size = Size::new(1920, 1080).expect("a size");
    for scale in [Scale::Texels(number), Scale::physical(number, Rational::from(2), number)] {
        if let Err(error) = scale.resolve(size) {
            assert!(matches!(error, Error::Parameter { .. }), "{text:?}: {error:?}");
        }
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Whatever an input is called, its maps lie below the output folder.
fn assert_stays_below(template: &NameTemplate) {
    let out = Path::new("out");
    for (stem, size) in [("wall", "_2k"), ("", ""), ("a.b", "")] {
        let found = Found { path: "a".into(), folder: "sub".into(), stem: stem.into(), size: size.into() };
        let Ok(maps) = template.outputs(&found, &[MapKind::Normal, MapKind::Parallax], out, "png") else { continue };
        for path in maps.iter() {
            let stays = path.components().all(|part| matches!(part, Component::Normal(_)));
            assert!(stays && path.starts_with("out/sub"), "{template}: {}", path.display());
        }
    }
}
