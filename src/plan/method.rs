//! Parallax methods as plans name them.

use crate::error::{Error, Result};
use crate::material::ParallaxMethod;
use serde::de::{self, Deserialize, Deserializer};
use serde::ser::Serializer;

/// The method that [`ParallaxMethod`]'s `Display` calls by this name.
///
/// # Errors
/// [`Error::Parameter`].
fn method(name: &str) -> Result<ParallaxMethod> {
    let words: Vec<&str> = name.split([' ', '+', ',']).filter(|word| !word.is_empty()).collect();
    let number = |word: &str| word.parse::<u32>().ok().filter(|number| *number <= 65_536);
    let found = match words[..] {
        ["none"] => Some(ParallaxMethod::None),
        ["welsh"] => Some(ParallaxMethod::Welsh),
        ["limited"] => Some(ParallaxMethod::Limited),
        ["plane", "limit", limit] => limit.parse().ok().map(|limit| ParallaxMethod::Plane { limit }),
        ["steps", k] => number(k).filter(|k| *k > 0).map(ParallaxMethod::steps),
        ["relief", steps, bisections] => number(steps)
            .zip(number(bisections))
            .map(|(steps, bisections)| ParallaxMethod::Relief { steps, bisections }),
        _ => None,
    };
    let range = "none, welsh, limited, plane, limit L, steps K or relief STEPS+BISECTIONS";
    found.ok_or_else(|| Error::parameter("method", name, range))
}

/// For fields of predictions.
pub(super) fn serialize<S: Serializer>(method: &ParallaxMethod, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(method)
}

/// The same.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<ParallaxMethod, D::Error> {
    method(&String::deserialize(deserializer)?).map_err(de::Error::custom)
}

/// What a method looks up.
pub(super) fn reads(method: ParallaxMethod) -> &'static str {
    match method {
        ParallaxMethod::None => "nothing",
        ParallaxMethod::Welsh | ParallaxMethod::Limited | ParallaxMethod::Relief { .. } => "the height map",
        ParallaxMethod::Plane { .. } => "the height map and the normal map",
        ParallaxMethod::Steps { .. } => "the parallax map",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_read_as_they_print() {
        use ParallaxMethod::{Limited, None, Plane, Relief, Welsh};
        let relief = Relief { steps: 64, bisections: 8 };
        for named in [None, Welsh, Limited, Plane { limit: 1.0 }, ParallaxMethod::steps(7), relief] {
            assert_eq!(method(&named.to_string()).unwrap(), named, "{named}");
        }
        for wrong in ["", "steps", "steps 0", "steps -1", "relief 64", "relief 99999999+1", "plane", "none 1"] {
            assert!(method(wrong).unwrap_err().to_string().starts_with("method is "), "{wrong}");
        }
    }
}
