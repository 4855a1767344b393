//! Colours for how much of something there is.

use std::f64::consts::PI;

/// Colours from black over blue, green and red to white, of evenly rising brightness.
pub(crate) struct Ramp([[u8; 3]; 256]);

impl Ramp {
    /// D. A. Green, A colour scheme for the display of astronomical intensity images, Bulletin of the Astronomical Society
    /// of India 39, 2011, with start 0.5, -1.5 rotations, hue 1 and gamma 1.
    pub fn cubehelix() -> Self {
        let mut ramp = [[0; 3]; 256];
        for (step, colour) in ramp.iter_mut().enumerate() {
            let brightness = step as f64 / 255.0;
            let angle = 2.0 * PI * (0.5 / 3.0 - 1.5 * brightness);
            let amplitude = brightness * (1.0 - brightness) / 2.0;
            let (sin, cos) = libm::sincos(angle);
            let channel = |of_cos: f64, of_sin: f64| {
                let value = brightness + amplitude * (of_cos * cos + of_sin * sin);
                (255.0 * value.clamp(0.0, 1.0)).round() as u8
            };
            *colour = [channel(-0.14861, 1.78277), channel(-0.29227, -0.90649), channel(1.97294, 0.0)];
        }
        Self(ramp)
    }

    /// The colour of a share of what is white; of 1 and more white, of 0 and less black.
    pub fn colour(&self, share: f64) -> [u8; 3] {
        self.0[(255.0 * share.clamp(0.0, 1.0)).round() as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_rises_in_brightness_from_black_to_white() {
        let ramp = Ramp::cubehelix();
        assert_eq!([-1.0, 0.0, 1.0, 7.0].map(|share| ramp.colour(share)), [[0; 3], [0; 3], [255; 3], [255; 3]]);
        // NTSC luma, in which Green defines the ramp.
        let luma = |[r, g, b]: [u8; 3]| 0.30 * f64::from(r) + 0.59 * f64::from(g) + 0.11 * f64::from(b);
        assert!(ramp.0.windows(2).all(|pair| luma(pair[0]) < luma(pair[1]) + 0.5));
    }
}
