//! How a material is seen.

use crate::exact::Rational;
use crate::map::Size;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use toml::Spanned;

/// From where a material is seen at its nearest, and at its shallowest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint {
    /// The nearest view.
    pub sight: Sight,
    /// The shallowest angle in degrees between the surface and the ray to the eye; 90 is straight from above.
    pub angle: f64,
    /// Width and height of the screen in pixels.
    pub resolution: Option<[f64; 2]>,
}

/// The nearest view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sight {
    /// Texels along the side of a pixel there, on the axis that has more of them.
    TexelsPerPixel(f64),
    /// A perspective view, straight from above.
    Perspective {
        /// From the eye to the surface, along the view's axis, in the unit of the material's size.
        distance: f64,
        /// Of the whole screen from bottom to top, in degrees.
        fov: f64,
        /// Rows of pixels of the screen.
        rows: f64,
    },
}

/// What a prediction keeps of a view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Seen {
    /// Pixels along the sides of a texel of the height map, x and y, at the nearest view.
    pub pixels_per_texel: [f64; 2],
    /// The shallowest angle in degrees.
    pub angle: f64,
}

impl Viewpoint {
    /// What is seen of a map of `size` that covers `extent`.
    pub fn of(&self, size: Size, extent: Option<[Rational; 2]>) -> Seen {
        let length =
            |side: Rational, texels: usize| side.numerator() as f64 / side.denominator() as f64 / texels as f64;
        let texel = extent.map(|[width, height]| [length(width, size.width()), length(height, size.height())]);
        let pixels_per_texel = match (self.sight, texel) {
            (Sight::Perspective { distance, fov, rows }, Some(texel)) => {
                // At the distance d the screen's rows show 2 d tan(fov / 2).
                let pixels_per_unit = rows / (2.0 * distance * libm::tan((fov / 2.0).to_radians()));
                texel.map(|side| pixels_per_unit * side)
            }
            (Sight::TexelsPerPixel(texels), Some([x, y])) => [x, y].map(|side| side / x.min(y) / texels),
            (Sight::TexelsPerPixel(texels), None) => [1.0 / texels; 2],
            // A scene with such a material is refused.
            (Sight::Perspective { .. }, None) => [1.0; 2],
        };
        Seen { pixels_per_texel, angle: self.angle }
    }
}

impl Seen {
    /// Pixels along the longer side of a texel.
    pub fn longer_side(&self) -> f64 {
        let [x, y] = self.pixels_per_texel;
        x.max(y)
    }
}

/// The keys of a view.
#[derive(Deserialize, Default, Clone)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ViewText {
    distance: Option<Spanned<f64>>,
    fov: Option<Spanned<f64>>,
    texels_per_pixel: Option<Spanned<f64>>,
    angle: Option<Spanned<f64>>,
    resolution: Option<Spanned<[f64; 2]>>,
}

/// What is wrong with a view.
pub(super) struct Wrong {
    pub at: Option<usize>,
    pub reason: String,
    pub remedy: &'static str,
}

impl ViewText {
    /// These keys, and those of `weaker` that are not here; a distance here leaves no texels per pixel from there, and
    /// the other way round.
    pub fn over(&self, weaker: &Self) -> Self {
        let own = self.clone();
        let pixel = weaker.texels_per_pixel.clone().filter(|_| self.distance.is_none());
        let distance = weaker.distance.clone().filter(|_| self.texels_per_pixel.is_none());
        Self {
            distance: own.distance.or(distance),
            fov: own.fov.or_else(|| weaker.fov.clone()),
            texels_per_pixel: own.texels_per_pixel.or(pixel),
            angle: own.angle.or_else(|| weaker.angle.clone()),
            resolution: own.resolution.or_else(|| weaker.resolution.clone()),
        }
    }

    pub fn resolve(&self) -> Result<Viewpoint, Wrong> {
        let angle = within("angle", &self.angle, "a number of degrees from 1 to 90", 1.0..=90.0)?;
        let angle = angle.ok_or_else(|| missing("angle", "write the shallowest angle in degrees, as angle = 20"))?;
        let resolution = self.resolution.as_ref().map(|resolution| match *resolution.get_ref() {
            pixels if pixels.iter().all(|side| (1.0..=1e6).contains(side)) => Ok(pixels),
            [width, height] => Err(Wrong {
                at: Some(resolution.span().start),
                reason: format!("resolution is [{width}, {height}]"),
                remedy: "write the screen's width and height in pixels, as resolution = [1920, 1080]",
            }),
        });
        let resolution = resolution.transpose()?;
        let (wide, range) = (1e-6..=1e6, "a number from 0.000001 to 1000000");
        let texels = within("texels-per-pixel", &self.texels_per_pixel, range, wide.clone())?;
        let distance = within("distance", &self.distance, range, wide)?;
        let fov = within("fov", &self.fov, "a number of degrees from 1 to 179", 1.0..=179.0)?;
        let sight = match (texels, distance) {
            (Some(texels), None) => Sight::TexelsPerPixel(texels),
            (None, Some(distance)) => {
                let fov = fov.ok_or_else(|| missing("fov", "write the vertical field of view, as fov = 60"))?;
                let whole_screen = || missing("resolution", "write it in pixels, as resolution = [1920, 1080]");
                Sight::Perspective { distance, fov, rows: resolution.ok_or_else(whole_screen)?[1] }
            }
            (Some(_), Some(_)) => {
                let reason = "both distance and texels-per-pixel are given".into();
                let at = self.distance.as_ref().map(|it| it.span().start);
                return Err(Wrong { at, reason, remedy: "give one: the nearest view" });
            }
            (None, None) => {
                let remedy = "write distance = 1.5 with fov and resolution, or texels-per-pixel = 0.5";
                return Err(missing("distance", remedy));
            }
        };
        Ok(Viewpoint { sight, angle, resolution })
    }
}

fn missing(key: &str, remedy: &'static str) -> Wrong {
    Wrong { at: None, reason: format!("{key} is missing"), remedy }
}

fn within(
    key: &str,
    value: &Option<Spanned<f64>>,
    range: &'static str,
    values: RangeInclusive<f64>,
) -> Result<Option<f64>, Wrong> {
    let Some(spanned) = value else { return Ok(None) };
    let value = *spanned.get_ref();
    if values.contains(&value) {
        return Ok(Some(value));
    }
    Err(Wrong {
        at: Some(spanned.span().start),
        reason: format!("{key} is {value}: it must be {range}"),
        remedy: "correct it",
    })
}
