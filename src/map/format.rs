//! What the numbers of a map mean.

use super::Size;
use crate::error::{Error, Result};
use crate::names::named;
use std::fmt;
use std::str::FromStr;

/// How a component v in [-1, 1] becomes a code of b bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Encoding {
    /// code = floor(L (v + 1) / 2 + 1/2), L = 2^b - 1: what PNG and every engine expect.
    #[default]
    Unorm,
    /// code = the nearest integer to L v, L = 2^(b-1) - 1, in two's complement. The code -2^(b-1) is never written.
    Snorm,
    /// The snorm code plus 2^(b-1), in an unsigned channel: 128 is exactly 0 (Schüler's sign expansion).
    Biased,
    /// The component itself.
    Float,
}

/// How a code is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Depth {
    /// 8-bit integers.
    #[default]
    Bits8,
    /// 16-bit integers.
    Bits16,
    /// IEEE binary16, for [`Encoding::Float`].
    Float16,
    /// IEEE binary32, for [`Encoding::Float`].
    Float32,
}

/// Which components a normal map stores.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Channels {
    /// All three.
    #[default]
    Xyz,
    /// x and y; the reader rebuilds z = sqrt(1 - x^2 - y^2) (FGED2 eq. 7.44).
    Xy,
}

/// Which way the green component points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Convention {
    /// Up the image: y is negated before it is rounded. glTF, OpenGL, Blender, Unity.
    #[default]
    Gl,
    /// Down the image rows: DirectX, Unreal.
    Dx,
}

/// What lies beyond the border of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Edge {
    /// The opposite border: the map tiles.
    #[default]
    Wrap,
    /// The border texel again.
    Clamp,
    /// The map reflected at its border texel, which is not repeated: texel -1 is texel 1.
    Mirror,
}

/// The edge of each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Edges {
    /// Left and right.
    pub x: Edge,
    /// Top and bottom.
    pub y: Edge,
}

/// What the codes of a normal map mean.
///
/// The default is what PNG normal maps hold almost everywhere: 8-bit unorm, three components, green up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct NormalFormat {
    /// How a component becomes a code.
    pub encoding: Encoding,
    /// How a code is stored: 8 or 16 bits for the integer encodings, a float for [`Encoding::Float`].
    pub depth: Depth,
    /// Which components there are.
    pub channels: Channels,
    /// Which way green points.
    pub convention: Convention,
}

/// What the codes of a parallax map mean: one signed component, n_z (2h - 1) (FGED2 section 7.7).
///
/// The default is 8-bit snorm. PNG has no signed numbers: there the same codes are stored biased, 128 for zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ParallaxFormat {
    /// How the value becomes a code.
    pub encoding: Encoding,
    /// How a code is stored: 8 or 16 bits for the integer encodings, a float for [`Encoding::Float`].
    pub depth: Depth,
}

/// How a roughness map is stored: one number from 0 to 1 as an unorm code, code = floor(L r + 1/2).
///
/// The default is 8 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct RoughnessFormat {
    /// How a code is stored: 8 or 16 bits.
    pub depth: Depth,
}

/// How a texel of any map is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TexelFormat {
    /// How a component becomes a code.
    pub encoding: Encoding,
    /// How a code is stored.
    pub depth: Depth,
    /// Codes of a texel.
    pub channels: usize,
}

/// The format of a [`super::CodeMap`]: [`NormalFormat`], [`ParallaxFormat`] or [`RoughnessFormat`].
pub trait MapFormat: Copy + sealed::Stored {}

impl MapFormat for NormalFormat {}
impl MapFormat for ParallaxFormat {}
impl MapFormat for RoughnessFormat {}

mod sealed {
    use super::{NormalFormat, ParallaxFormat, RoughnessFormat, TexelFormat};

    /// What a format says about storage; for this crate alone.
    pub trait Stored {
        fn stored(&self) -> TexelFormat;
    }

    impl Stored for NormalFormat {
        fn stored(&self) -> TexelFormat {
            self.texel()
        }
    }

    impl Stored for ParallaxFormat {
        fn stored(&self) -> TexelFormat {
            self.texel()
        }
    }

    impl Stored for RoughnessFormat {
        fn stored(&self) -> TexelFormat {
            self.texel()
        }
    }
}

impl Encoding {
    /// The largest code L of a depth of integers, for v = 1 (before biased adds its offset).
    ///
    /// `None` if the encoding and the depth do not go together.
    pub fn greatest_code(self, depth: Depth) -> Option<u32> {
        let bits = match depth {
            Depth::Bits8 => 8,
            Depth::Bits16 => 16,
            Depth::Float16 | Depth::Float32 => return None,
        };
        match self {
            Self::Unorm => Some((1 << bits) - 1),
            Self::Snorm | Self::Biased => Some((1 << (bits - 1)) - 1),
            Self::Float => None,
        }
    }
}

impl Depth {
    /// Bytes of one code.
    pub fn bytes(self) -> usize {
        match self {
            Self::Bits8 => 1,
            Self::Bits16 | Self::Float16 => 2,
            Self::Float32 => 4,
        }
    }

    /// Whether codes are floats.
    pub fn is_float(self) -> bool {
        matches!(self, Self::Float16 | Self::Float32)
    }
}

impl Channels {
    /// Components per texel.
    pub fn count(self) -> usize {
        match self {
            Self::Xyz => 3,
            Self::Xy => 2,
        }
    }
}

impl Edge {
    /// The texel that stands for texel `i` of an axis of `n` texels, however far outside.
    ///
    /// An axis of one texel is its own neighbour under every edge.
    pub(crate) fn resolve(self, i: isize, n: usize) -> usize {
        debug_assert!(n > 0);
        let last = n as isize - 1;
        let inside = match self {
            Self::Wrap => i.rem_euclid(n as isize),
            Self::Clamp => i.clamp(0, last),
            Self::Mirror if last == 0 => 0,
            Self::Mirror => last - (last - i.rem_euclid(2 * last)).abs(),
        };
        inside as usize
    }
}

impl Edges {
    /// The same edge on both axes.
    pub fn both(edge: Edge) -> Self {
        Self { x: edge, y: edge }
    }
}

impl NormalFormat {
    /// The greatest magnitude of a float component; what is beyond it, or no number, is refused where maps are read.
    pub const GREATEST_COMPONENT: f32 = 65_536.0;

    /// How a texel is stored.
    pub(crate) fn texel(&self) -> TexelFormat {
        TexelFormat { encoding: self.encoding, depth: self.depth, channels: self.channels.count() }
    }
}

impl Default for ParallaxFormat {
    /// 8-bit snorm.
    fn default() -> Self {
        Self { encoding: Encoding::Snorm, depth: Depth::Bits8 }
    }
}

impl ParallaxFormat {
    /// How a texel is stored.
    pub(crate) fn texel(&self) -> TexelFormat {
        TexelFormat { encoding: self.encoding, depth: self.depth, channels: 1 }
    }
}

impl RoughnessFormat {
    /// How a texel is stored.
    pub(crate) fn texel(&self) -> TexelFormat {
        TexelFormat { encoding: Encoding::Unorm, depth: self.depth, channels: 1 }
    }
}

impl TexelFormat {
    /// Codes of a row of `width` texels.
    pub fn row_codes(&self, width: usize) -> usize {
        width * self.channels
    }

    /// Bytes of a texel.
    pub fn bytes(&self) -> usize {
        self.channels * self.depth.bytes()
    }

    /// Fails if the encoding and the depth do not go together.
    pub fn check(&self) -> Result<()> {
        if (self.encoding == Encoding::Float) == self.depth.is_float() {
            return Ok(());
        }
        let range = match self.encoding {
            Encoding::Float => "16f or 32f for the encoding float",
            _ => "8 or 16 for the encodings unorm, snorm and biased",
        };
        Err(Error::parameter("bits", self.depth, range))
    }

    /// Fails if `count` codes of `depth` are not a map of this size and format.
    pub fn check_codes(&self, size: Size, count: usize, depth: Depth) -> Result<()> {
        let wanted = size.texels() * self.channels;
        if count == wanted && depth == self.depth {
            return Ok(());
        }
        let given = format!("{count} codes of {depth} bits");
        Err(Error::parameter("codes", given, format!("{wanted} codes of {} bits", self.depth)))
    }
}

named! {
    Encoding "encoding" { Unorm = "unorm", Snorm = "snorm", Biased = "biased", Float = "float" }
    Depth "bits" { Bits8 = "8", Bits16 = "16", Float16 = "16f", Float32 = "32f" }
    Channels "channels" { Xyz = "xyz", Xy = "xy" }
    Convention "convention" { Gl = "gl", Dx = "dx" }
    Edge "edge" { Wrap = "wrap", Clamp = "clamp", Mirror = "mirror" }
}

impl fmt::Display for Edges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.x == self.y { self.x.fmt(f) } else { write!(f, "{},{}", self.x, self.y) }
    }
}

impl FromStr for Edges {
    type Err = Error;

    /// `wrap` for both axes, `wrap,clamp` for x and y.
    fn from_str(text: &str) -> Result<Self> {
        let edge = |name: &str| name.trim().parse::<Edge>().ok();
        let edges = match text.split_once(',') {
            None => edge(text).map(Self::both),
            Some((x, y)) => edge(x).zip(edge(y)).map(|(x, y)| Self { x, y }),
        };
        let range = "wrap, clamp or mirror, or two of them for x and y: wrap,clamp";
        edges.ok_or_else(|| Error::parameter("edge", text, range))
    }
}

#[cfg(test)]
mod tests {
    use super::Edge::{Clamp, Mirror, Wrap};

    #[test]
    fn edges_resolve_one_texel_beyond_each_border() {
        for (edge, n, before, after) in [
            (Wrap, 5, 4, 0),
            (Clamp, 5, 0, 4),
            (Mirror, 5, 1, 3),
            (Wrap, 2, 1, 0),
            (Clamp, 2, 0, 1),
            (Mirror, 2, 1, 0),
            (Wrap, 1, 0, 0),
            (Clamp, 1, 0, 0),
            (Mirror, 1, 0, 0),
        ] {
            assert_eq!(edge.resolve(-1, n), before, "{edge} before {n}");
            assert_eq!(edge.resolve(n as isize, n), after, "{edge} after {n}");
            assert_eq!(edge.resolve(n as isize - 1, n), n - 1, "{edge} inside {n}");
        }
    }
}
