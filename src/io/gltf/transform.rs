//! KHR_texture_transform: texture coordinates as a texture's user sees them.

use super::document::Document;
use crate::error::Result;
use serde_json::Value;
use std::hash::{Hash, Hasher};

/// Scales, then turns counterclockwise as the image is seen, then moves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TextureTransform {
    offset: [f64; 2],
    /// Radians.
    rotation: f64,
    scale: [f64; 2],
}

// All numbers are finite.
impl Eq for TextureTransform {}

impl Hash for TextureTransform {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let [[x, y], [width, height]] = [self.offset, self.scale];
        // Minus zero is zero.
        [x, y, self.rotation, width, height].map(|part| (part + 0.0).to_bits()).hash(state);
    }
}

impl TextureTransform {
    /// The transform that an extension describes; `None` if it changes nothing.
    pub fn of(document: &Document, extension: &Value) -> Result<Option<Self>> {
        let pair = |field: &str, absent: f64| match &extension[field] {
            Value::Null => Some([absent; 2]),
            Value::Array(parts) => match parts.as_slice() {
                [x, y] => Some([x.as_f64()?, y.as_f64()?]),
                _ => None,
            },
            _ => None,
        };
        let rotation = extension.get("rotation").map_or(Some(0.0), Value::as_f64);
        let (Some(offset), Some(rotation), Some(scale)) = (pair("offset", 0.0), rotation, pair("scale", 1.0)) else {
            return Err(document.damaged("the KHR_texture_transform of its normal map does not hold numbers"));
        };
        let is_identity = (offset, rotation, scale) == ([0.0; 2], 0.0, [1.0; 2]);
        Ok((!is_identity).then_some(Self { offset, rotation, scale }))
    }

    /// In f64, with sine and cosine that are the same on every platform.
    pub fn apply(&self, texcoords: &mut [[f32; 2]]) {
        let ([x, y], [width, height]) = (self.offset, self.scale);
        let (sine, cosine) = libm::sincos(self.rotation);
        for texcoord in texcoords {
            let (u, v) = (f64::from(texcoord[0]) * width, f64::from(texcoord[1]) * height);
            *texcoord = [(cosine * u + sine * v + x) as f32, (cosine * v - sine * u + y) as f32];
        }
    }
}
