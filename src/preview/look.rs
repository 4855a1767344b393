//! Light, and the colours of a surface.

use crate::shading::{blinn_phong, diffuse};
use crate::vector::{add, sub, times};

/// A light that is far away, in the space of a picture or of a plane seen from above: x to the right, y down, z to the
/// eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Degrees from the right, counterclockwise: 135 is the upper left.
    pub azimuth: f32,
    /// Degrees above the plane.
    pub elevation: f32,
}

impl Default for Light {
    /// From the upper left.
    fn default() -> Self {
        Self { azimuth: 135.0, elevation: 40.0 }
    }
}

impl Light {
    /// Towards the light, of length one, y down.
    pub fn direction(&self) -> [f32; 3] {
        let (up, across) = self.elevation.to_radians().sin_cos();
        let (sin, cos) = self.azimuth.to_radians().sin_cos();
        [across * cos, -across * sin, up]
    }
}

/// How a surface is lit, and what colour it has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Where the light is.
    pub light: Light,
    /// Light from everywhere, as a share of all light.
    pub ambient: f32,
    /// How bright highlights are.
    pub highlight: f32,
    /// Blinn and Phong's exponent.
    pub shininess: f32,
    /// The colour of the height 0, linear.
    pub low: [f32; 3],
    /// The colour of the height 1, linear.
    pub high: [f32; 3],
}

impl Default for Look {
    /// Depths are dark and cool, heights are bright and warm, so that it is seen what an offset moves.
    fn default() -> Self {
        Self {
            light: Light::default(),
            ambient: 0.12,
            highlight: 0.12,
            shininess: 24.0,
            low: [0.05, 0.08, 0.12],
            high: [0.95, 0.62, 0.42],
        }
    }
}

impl Look {
    /// The colour of the height `h`.
    pub fn colour(&self, h: f32) -> [f32; 3] {
        add(self.low, times(h, sub(self.high, self.low)))
    }

    /// What the eye in the direction `v` gets from a surface of this `colour` with the normal `m`; `l` points to the
    /// light. All three are of length one and in one space.
    pub fn lit(&self, colour: [f32; 3], m: [f32; 3], l: [f32; 3], v: [f32; 3]) -> [f32; 3] {
        let matt = times(self.ambient + (1.0 - self.ambient) * diffuse(m, l), colour);
        add(matt, [self.highlight * blinn_phong(m, l, v, self.shininess); 3])
    }
}
