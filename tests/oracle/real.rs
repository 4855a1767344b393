//! Normals of float heights in f64.

use super::slopes::{axis_scales, neighbourhoods, stencil};
use num_traits::ToPrimitive;
use texbake::{Convention, HeightMap, Heights, NormalOptions};

/// The normal of a texel, and what bounds its rounding errors.
#[derive(Debug, Clone, Copy)]
pub struct RealNormal {
    pub normal: [f64; 3],
    /// Length of (-dx, -dy, 1).
    pub length: f64,
    /// Sum of the magnitudes of the weighted differences whose sum is the slope.
    pub magnitude: [f64; 2],
}

/// The normal of each texel of a map of floats.
pub fn real_normals(map: &HeightMap, options: &NormalOptions) -> Vec<RealNormal> {
    let Heights::F32(heights) = map.heights() else { panic!("heights are floats here") };
    let (weights, divisor) = stencil(options.filter);
    let scales = axis_scales(options.scale, map.size())
        .map(|(n, d)| n.to_f64().expect("finite") / d.to_f64().expect("finite") / divisor as f64);
    let green = match options.format.convention {
        Convention::Gl => 1.0,
        Convention::Dx => -1.0,
    };
    let normal = |around: [[f32; 3]; 3]| {
        // Weights are odd about the middle, so each row (column) is one difference.
        let across = |row: usize| weights[row][2] as f64 * (f64::from(around[row][2]) - f64::from(around[row][0]));
        let down =
            |column: usize| weights[column][2] as f64 * (f64::from(around[2][column]) - f64::from(around[0][column]));
        let differences = [[0, 1, 2].map(across), [0, 1, 2].map(down)];
        let slope = [0, 1].map(|axis| scales[axis] * differences[axis].iter().sum::<f64>());
        let magnitude = [0, 1].map(|axis| scales[axis].abs() * differences[axis].iter().map(|d| d.abs()).sum::<f64>());
        let length = (slope[0] * slope[0] + slope[1] * slope[1] + 1.0).sqrt();
        RealNormal { normal: [-slope[0] / length, green * slope[1] / length, 1.0 / length], length, magnitude }
    };
    neighbourhoods(heights, map.size(), options.edges).map(normal).collect()
}
