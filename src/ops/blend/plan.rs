//! The options resolved for two maps: the constants that every backend computes with.

use super::{BlendMethod, BlendOptions};
use crate::error::{Error, Result};
use crate::exact::Weights;
use crate::map::{HeightType, NormalFormat, Size};
use crate::ops::{LayerReading, Precision};

/// The codes of a mask: 8 or 16 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Mask {
    /// `U8` or `U16`.
    pub height_type: HeightType,
    /// The code M of t = 1.
    pub greatest: u32,
}

/// One blend, ready for a backend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BlendPlan {
    pub size: Size,
    /// The formats of the two normal maps.
    pub inputs: [NormalFormat; 2],
    /// How their texels are read: green as the result has it.
    pub layers: [LayerReading; 2],
    pub mask: Option<Mask>,
    pub method: BlendMethod,
    /// Of [`BlendMethod::Weighted`]; 1 and 1 for the methods without weights.
    pub weights: Weights,
    pub format: NormalFormat,
    pub precision: Precision,
}

impl BlendPlan {
    /// Checks the options and resolves them for a base of `size`, two normal maps and, perhaps, a mask.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the option that is out of range, or the mask that is missing or not wanted.
    pub fn new(
        options: &BlendOptions,
        size: Size,
        inputs: [NormalFormat; 2],
        mask: Option<HeightType>,
    ) -> Result<Self> {
        let BlendOptions { method, format, precision, .. } = *options;
        [inputs[0], inputs[1], format].iter().try_for_each(|format| format.texel().check())?;
        match (method, mask) {
            (BlendMethod::Masked, None) => return Err(Error::parameter("mask", "missing", "given for a masked blend")),
            (BlendMethod::Masked, Some(_)) | (_, None) => {}
            (_, Some(_)) => return Err(Error::parameter("mask", "given", "left out unless the blend is masked")),
        }
        let weights = match method {
            BlendMethod::Weighted { base, detail } => Weights::new(base, detail)?,
            _ => Weights::new(1.into(), 1.into())?,
        };
        let mask = mask.map(|height_type| match height_type {
            HeightType::U8 => Mask { height_type, greatest: 255 },
            HeightType::U16 | HeightType::F32 => Mask { height_type: HeightType::U16, greatest: 65_535 },
        });
        let layers = inputs.map(|input| LayerReading::new(input, format.convention));
        Ok(Self { size, inputs, layers, mask, method, weights, format, precision })
    }

    /// The weights, of the method that has some.
    pub fn used_weights(&self) -> Option<Weights> {
        matches!(self.method, BlendMethod::Weighted { .. }).then_some(self.weights)
    }

    /// The greatest components L1 and L2 if both maps hold integers: then the blend is correctly rounded.
    pub fn integer_scales(&self) -> Option<[i32; 2]> {
        let [base, detail] = self.layers.map(|layer| layer.codes.map(|codes| codes.greatest));
        Some([base?, detail?])
    }

    /// The greatest magnitudes of X or Y and of Z, and of every product on the way there (`blend_integers`), for
    /// normals over L1 and L2. All are below 2^53: the largest are those of two reoriented 16-bit maps, 6 L1^2 L2.
    pub fn greatest_parts(&self, scales: [i32; 2]) -> [u128; 2] {
        let [l1, l2] = scales.map(|l| l as u128);
        let parts = |leaning, z| [leaning * l1 * l2, z * l1 * l2];
        match (self.method, self.mask) {
            (BlendMethod::Masked, Some(mask)) => parts(mask.greatest.into(), mask.greatest.into()),
            (BlendMethod::Weighted { .. } | BlendMethod::Masked, _) => {
                let weights = self.weights;
                let sum = weights.base.unsigned_abs() + weights.detail.unsigned_abs();
                parts(sum.into(), weights.q.into())
            }
            (BlendMethod::Linear, _) => parts(2, 2),
            (BlendMethod::Overlay, _) => parts(1, 1),
            (BlendMethod::Udn | BlendMethod::Whiteout, _) => parts(2, 1),
            (BlendMethod::Rnm, _) => parts(6 * l1, 6 * l1),
        }
    }
}
