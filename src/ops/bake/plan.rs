//! The options resolved for one map: the constants that every backend computes with.

use super::{BakeOptions, Filter};
use crate::error::{Error, Result};
use crate::exact::AxisScale;
use crate::map::{Convention, Edges, HeightType, Maps, NormalFormat, ParallaxFormat, Size, TexelFormat};
use crate::mips::RoughnessOptions;
use crate::ops::Precision;

/// A slope stencil as data.
///
/// The sum over three rows (for the slope along x; columns for y) of `weight * (right - left)`, where the middle row
/// weighs `centre` and the other two `outer`; the slope per texel is that sum over [`Stencil::divisor`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Stencil {
    pub centre: i32,
    pub outer: i32,
}

impl Stencil {
    /// D of DESIGN 3.1: the two sides are two texels apart.
    pub fn divisor(self) -> i32 {
        2 * (self.centre + 2 * self.outer)
    }
}

impl From<Filter> for Stencil {
    fn from(filter: Filter) -> Self {
        let (centre, outer) = match filter {
            Filter::Central => (1, 0),
            Filter::Sobel => (2, 1),
            Filter::Scharr => (10, 3),
            Filter::Prewitt => (1, 1),
        };
        Self { centre, outer }
    }
}

/// From the stencil sums Gx, Gy of integer codes to the normal (X, Y, Z) / sqrt(X^2 + Y^2 + Z^2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct IntegerSlope {
    /// X = px Gx, below 2^44.
    pub px: i32,
    /// Y = py Gy, below 2^44; its sign holds the convention.
    pub py: i32,
    /// Z, above zero, below 2^45.
    pub z: i64,
}

/// From the stencil sums of heights over 64 to the slopes over 2^64.
///
/// The two powers of two keep every sum and slope of finite f32 heights finite; they cost no accuracy, since slopes
/// below 2^-25 count as zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FloatSlope {
    pub kx: f32,
    pub ky: f32,
}

/// How heights become slopes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Slope {
    Integer(IntegerSlope),
    Float(FloatSlope),
}

/// One bake, ready for a backend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BakePlan {
    pub size: Size,
    pub height_type: HeightType,
    pub stencil: Stencil,
    pub edges: Edges,
    pub slope: Slope,
    pub normal: Option<NormalFormat>,
    pub parallax: Option<ParallaxFormat>,
    /// What is made beside the maps that a backend bakes.
    pub roughness: Option<RoughnessOptions>,
    pub precision: Precision,
    /// The scale that the bake really uses.
    pub scale: AxisScale,
}

impl BakePlan {
    /// Bytes of all heights.
    pub fn map_bytes(&self) -> usize {
        self.size.texels() * self.height_type.bytes()
    }

    /// Checks the options and resolves them for a map.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] names the option that is out of range.
    pub fn new(options: &BakeOptions, size: Size, height_type: HeightType) -> Result<Self> {
        let BakeOptions { edges, normal, parallax, roughness, precision, .. } = *options;
        if normal.is_none() && parallax.is_none() {
            return Err(Error::parameter("maps", "none", "normal, parallax or both"));
        }
        let scale = options.scale.resolve(size)?;
        let stencil = Stencil::from(options.filter);
        // The normal leans away from the slope (eq. 7.43); green up turns y around again.
        let y = match normal.unwrap_or_default().convention {
            Convention::Gl => scale.y,
            Convention::Dx => -scale.y,
        };
        let slope = match height_type.greatest_code() {
            Some(greatest) => {
                let kept = if parallax.is_some() { greatest } else { 1 };
                Slope::Integer(IntegerSlope::new(-scale.x, y, scale.q, stencil, greatest, kept))
            }
            None => {
                let divisor = i64::from(scale.q) * i64::from(stencil.divisor());
                Slope::Float(FloatSlope::new(-scale.x, y, divisor))
            }
        };
        let plan = Self { size, height_type, stencil, edges, slope, normal, parallax, roughness, precision, scale };
        plan.formats().iter().try_for_each(TexelFormat::check)?;
        roughness.as_ref().map_or(Ok(()), RoughnessOptions::check)?;
        Ok(plan)
    }

    /// The formats of all maps.
    pub fn formats(&self) -> Maps<TexelFormat> {
        Maps {
            normal: self.normal.map(|format| format.texel()),
            parallax: self.parallax.map(|format| format.texel()),
            roughness: self.roughness.map(|options| options.format.texel()),
        }
    }

    /// Those of the maps that a backend bakes: normal, then parallax.
    pub fn outputs(&self) -> impl Iterator<Item = TexelFormat> {
        let Maps { normal, parallax, .. } = self.formats();
        normal.into_iter().chain(parallax)
    }

    /// The slope constants in floats, whatever the heights are: what `fast` computes with on a GPU.
    #[cfg(feature = "gpu")]
    pub fn float_slope(&self) -> FloatSlope {
        match self.slope {
            Slope::Float(slope) => slope,
            Slope::Integer(IntegerSlope { px, py, z }) => FloatSlope::new(px, py, z),
        }
    }
}

impl IntegerSlope {
    /// (X, Y, Z) = (x Gx, y Gy, q D M) without the factor that they share; Z stays a multiple of `kept`, 1 or M.
    fn new(x: i32, y: i32, q: u32, stencil: Stencil, greatest_height: u32, kept: u32) -> Self {
        let z = i64::from(q) * i64::from(stencil.divisor()) * i64::from(greatest_height);
        let common = [x, y].map(|part| i64::from(part.unsigned_abs())).into_iter().fold(z / i64::from(kept), gcd);
        let part = |part: i32| (i64::from(part) / common) as i32;
        Self { px: part(x), py: part(y), z: z / common }
    }
}

impl FloatSlope {
    /// The slopes are x / divisor and y / divisor times the stencil sums; each quotient is rounded to f32 once.
    ///
    /// Both parts are below 2^53, so the f64 quotient is correctly rounded, and a second rounding to 24 bits of a
    /// quotient of parts below 2^24 and 2^29 cannot differ from one.
    fn new(x: i32, y: i32, divisor: i64) -> Self {
        let per_sum = |part: i32| (f64::from(part) / divisor as f64) as f32 * (2f32.powi(6) * 2f32.powi(-64));
        Self { kx: per_sum(x), ky: per_sum(y) }
    }
}

fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
