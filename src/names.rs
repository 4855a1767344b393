//! The names of closed choices: one table gives what is printed, what is read, and what may be read.

/// Implements `NAMES`, `Display` and `FromStr` from the names of the variants.
///
/// The text is the parameter that an [`Error`](crate::Error) names.
macro_rules! named {
    ($($type:ident $parameter:literal { $($variant:ident = $name:literal),* })*) => {$(
        impl $type {
            /// The names of all variants, as the command line, settings and reports write them.
            pub const NAMES: &'static [&'static str] = &[$($name),*];
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(match self { $(Self::$variant => $name),* })
            }
        }

        impl std::str::FromStr for $type {
            type Err = crate::Error;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                match text {
                    $($name => Ok(Self::$variant),)*
                    _ => Err(crate::Error::parameter($parameter, text, crate::names::one_of(Self::NAMES))),
                }
            }
        }
    )*};
}

pub(crate) use named;

/// `a, b or c`.
pub(crate) fn one_of(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => names.concat(),
    }
}

#[cfg(test)]
mod tests {
    use crate::{Depth, Edges, Encoding, Filter};

    #[test]
    fn names_read_as_they_print() {
        for name in Filter::NAMES {
            assert_eq!(name.parse::<Filter>().unwrap().to_string(), *name);
        }
        assert_eq!("16f".parse::<Depth>().unwrap(), Depth::Float16);
        let error = "srgb".parse::<Encoding>().unwrap_err().to_string();
        assert_eq!(error, "encoding is srgb: it must be unorm, snorm, biased or float");
    }

    #[test]
    fn edges_are_one_name_or_one_for_each_axis() {
        for (text, printed) in [("wrap", "wrap"), ("wrap,clamp", "wrap,clamp"), ("mirror,mirror", "mirror")] {
            assert_eq!(text.parse::<Edges>().unwrap().to_string(), printed);
        }
        assert!("wrap,".parse::<Edges>().is_err());
        assert!("wrap,wrap,wrap".parse::<Edges>().is_err());
    }
}
