//! Where a textured plane is looked at from.

use super::limits::within;
use crate::error::Result;
use crate::material::Material;
use crate::measure::View;
use crate::vector::{add, normalized, times};

/// A camera in front of a textured plane, on the side to which v grows: its pictures stand upright, as the map does.
///
/// It looks at the map's middle; what it sees beyond the map is what the map's edges say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Degrees above the plane, from 5 to 90: 90 is straight from above.
    pub elevation: f32,
    /// How much of the map's width the picture shows in its middle, from 1e-9 to 1e6; 1 is all of it.
    pub width: f32,
}

/// Degrees between the middle of a picture and its upper border, at most: a long lens.
const HALF_FIELD: f32 = 8.0;

/// The rays from a camera's eye, in tangent space: x along growing u, y along growing v, z out of the plane, in units of
/// the map's width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rays {
    /// The eye.
    pub eye: [f32; 3],
    /// From the eye to the picture's middle, and from there to its right and its lower border.
    pub ahead: [f32; 3],
    /// See `ahead`.
    pub right: [f32; 3],
    /// See `ahead`.
    pub down: [f32; 3],
    /// The map's height in units of its width.
    pub proportion: f32,
    /// Rays along x and y.
    pub count: [u32; 2],
}

impl Camera {
    pub(super) fn check(&self) -> Result<()> {
        within("elevation", self.elevation, &(5.0..=90.0))?;
        within("width", self.width, &(1e-9..=1e6))
    }

    /// Its rays through the pixels of a picture of `count` pixels across and down.
    pub fn rays(&self, material: &Material, count: [u32; 2]) -> Rays {
        let [across, down] = count.map(|pixels| pixels as f32);
        let half_field = HALF_FIELD.min(self.elevation / 2.0).to_radians();
        let (sin, cos) = if self.elevation == 90.0 { (1.0, 0.0) } else { self.elevation.to_radians().sin_cos() };
        let proportion = proportion(material);
        let distance = self.width / 2.0 / (half_field.tan() * across / down);
        let middle = [0.5, 0.5 * proportion, 0.0];
        Rays {
            eye: add(middle, [0.0, distance * cos, distance * sin]),
            ahead: [0.0, -cos, -sin],
            right: [half_field.tan() * across / down, 0.0, 0.0],
            down: times(half_field.tan(), [0.0, sin, -cos]),
            proportion,
            count,
        }
    }
}

impl Rays {
    /// What the pixel at column x, row y sees of the plane; offsets of a half are in the middle of a pixel.
    pub fn at(&self, x: f32, y: f32) -> View {
        let [across, down] = self.count.map(|pixels| pixels as f32);
        let (right, below) = (times(2.0 * x / across - 1.0, self.right), times(2.0 * y / down - 1.0, self.down));
        let ray = add(self.ahead, add(right, below));
        // Every ray goes down: the field ends half way to the horizon.
        let [u, v, _] = add(self.eye, times(-self.eye[2] / ray[2], ray));
        View { uv: [u, v / self.proportion], eye: normalized(times(-1.0, ray)) }
    }

    /// The direction to the eye, of length one, of the ray that is the least steep.
    pub fn shallowest(&self) -> [f32; 3] {
        self.at(0.0, 0.0).eye
    }
}

/// Height over width of a map whose heights are as high along both axes.
fn proportion(material: &Material) -> f32 {
    let [x, y] = material.scale_in_uv();
    let size = material.size();
    if x == 0.0 || y == 0.0 { size.height() as f32 / size.width() as f32 } else { x / y }
}
