//! What a user can choose.

use crate::exact::Rational;
use crate::map::NormalFormat;
use crate::ops::Precision;

/// What is blended: normal maps in any mix of formats, and a mask where the method wants one.
///
/// ```
/// use texbake::{Baker, BlendInputs, BlendOptions, Codes, CodesRef, NormalFormat, NormalMap, Size};
///
/// let map = |codes| NormalMap::new(Size::new(1, 1)?, NormalFormat::default(), Codes::U8(codes));
/// // Two slopes of 45 degrees add up to one of atan 2: (2, 0, 1) / sqrt(5).
/// let slope = map(vec![218, 128, 218])?;
/// let inputs = BlendInputs { base: &slope, detail: &slope, mask: None };
/// let sum = Baker::cpu().blend(&inputs, &BlendOptions::default())?;
/// assert_eq!(sum.codes(), CodesRef::U8(&[242, 128, 185]));
/// # Ok::<(), texbake::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlendInputs<N, H> {
    /// The first normal map; its size is the result's.
    pub base: N,
    /// The second normal map, of the same size, or any size with [`BlendOptions::tile`].
    pub detail: N,
    /// The transition t of each texel, for [`BlendMethod::Masked`]: t = H / (2^B - 1) as of heights; a float t
    /// below 0 or above 1 counts as 0 or 1, and is rounded to 16 bits. Of the size of `base`.
    pub mask: Option<H>,
}

/// How two normal maps become one.
///
/// The default adds the slopes (FGED2 eq. 7.47) into an 8-bit unorm map with green up, `exact`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct BlendOptions {
    /// The formula.
    pub method: BlendMethod,
    /// Repeats the second map, from its first texel on, over a larger base; cuts it over a smaller one.
    pub tile: bool,
    /// What the codes of the result shall mean.
    pub format: NormalFormat,
    /// Exact bytes, or speed.
    pub precision: Precision,
}

/// The formula of a blend, from the normals (x1, y1, z1) and (x2, y2, z2); all results are normalised.
///
/// Slope space is what adding the height maps does, and the length of the inputs does not matter there. The others are
/// approximations, for comparison, from Stephen Hill and Colin Barré-Brisebois, Blending in Detail, 2012; they take the
/// inputs as unit vectors, and inputs of other lengths as they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BlendMethod {
    /// (a x1/z1 + b x2/z2, a y1/z1 + b y2/z2, 1) (FGED2 eq. 7.46; "partial derivative" in Blending in Detail). A
    /// negative weight subtracts the bumps. Both are between -65535 and 65535.
    Weighted {
        /// The weight a of the first map.
        base: Rational,
        /// The weight b of the second map.
        detail: Rational,
    },
    /// The same with a = 1 - t and b = t of each texel of a mask.
    Masked,
    /// (x1 + x2, y1 + y2, z1 + z2).
    Linear,
    /// The overlay of two pictures, component by component: v1 + v2 (1 - |v1|).
    Overlay,
    /// (x1 + x2, y1 + y2, z1), Unreal Developer Network.
    Udn,
    /// (x1 + x2, y1 + y2, z1 z2), Christopher Oat's whiteout.
    Whiteout,
    /// The second normal turned by the rotation that takes (0, 0, 1) to the first: reoriented normal mapping.
    Rnm,
}

impl BlendMethod {
    /// a = b = 1 (FGED2 eq. 7.47).
    pub fn add() -> Self {
        Self::Weighted { base: 1.into(), detail: 1.into() }
    }

    /// a = 1 - t, b = t for one t, between the first map at 0 and the second at 1.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if t is below 0 or above 1.
    pub fn transition(t: Rational) -> crate::Result<Self> {
        if t.numerator() < 0 || t.numerator() > t.denominator() {
            return Err(crate::Error::parameter("transition", t, "between 0 and 1"));
        }
        let base = Rational::new(t.denominator() - t.numerator(), t.denominator())?;
        Ok(Self::Weighted { base, detail: t })
    }
}

impl Default for BlendMethod {
    fn default() -> Self {
        Self::add()
    }
}
