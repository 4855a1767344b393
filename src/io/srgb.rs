//! sRGB codes as linear ones, for heights that were saved as colours by mistake.

use crate::map::{HeightType, Heights};

/// What the user should know about a file that says it is sRGB and is read as data.
pub(super) const WARNING: &str = "the file says that its codes are sRGB colours; they are read as they are, unconverted. \
     If they really were converted to sRGB, export them as linear data, or decode a height map with --color-space srgb";

/// The 16-bit linear code of each sRGB code.
pub(super) struct SrgbTable(Vec<u16>);

impl SrgbTable {
    /// The table for codes of `depth`; floats have none.
    pub fn new(depth: HeightType) -> Option<Self> {
        let greatest = depth.greatest_code()?;
        let linear = |code| (65535.0 * eotf(f64::from(code) / f64::from(greatest)) + 0.5) as u16;
        Some(Self((0..=greatest).map(linear).collect()))
    }

    /// Decodes codes of the table's depth.
    pub fn decode(&self, codes: Heights<'_>, linear: &mut [u16]) {
        match codes {
            Heights::U8(codes) => self.look_up(codes.iter().copied(), linear),
            Heights::U16(codes) => self.look_up(codes.iter().copied(), linear),
            Heights::F32(_) => unreachable!("no table is made for floats"),
        }
    }

    fn look_up(&self, codes: impl Iterator<Item = impl Into<usize>>, linear: &mut [u16]) {
        linear.iter_mut().zip(codes).for_each(|(linear, code)| *linear = self.0[code.into()]);
    }
}

/// The sRGB electro-optical transfer function, IEC 61966-2-1, for v in [0, 1].
///
/// `libm`'s `pow` gives the same bits on every platform, which the standard library's does not promise.
fn eotf(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
}

/// Whether an ICC profile names sRGB in its description, which is ASCII (version 2) or UTF-16 (version 4).
pub(super) fn is_named_by(profile: &[u8]) -> bool {
    let contains = |name: &[u8]| profile.windows(name.len()).any(|window| window == name);
    contains(b"sRGB") || contains(b"s\0R\0G\0B")
}
