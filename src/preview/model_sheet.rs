//! A model that wears a material, beside its tangent space.

use super::labels::{Anchor, Labels};
use super::limits::{PANEL, check_method, check_pixels, within};
use super::raster::{Canvas, Viewpoint};
use super::worn::{Paint, Worn};
use super::{Look, Picture};
use crate::error::Result;
use crate::material::{Material, ParallaxMethod};
use crate::stream::Monitor;
use plotters::style::FontStyle;
use std::ops::Range;

/// What is on the picture of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelSheetOptions {
    /// Its first line.
    pub title: String,
    /// Panels, from the left.
    pub paints: Vec<Paint>,
    /// Degrees around the model, counterclockwise seen from above, from -360 to 360: 0 looks at what faces z.
    pub turn: f32,
    /// Degrees above the model, from -89 to 89.
    pub elevation: f32,
    /// Width and height of a panel in pixels, from 16 to 4096.
    pub panel: u32,
    /// Light and colours; the light stays with the picture.
    pub look: Look,
}

impl Default for ModelSheetOptions {
    fn default() -> Self {
        Self {
            title: String::new(),
            paints: vec![
                Paint::Lit(ParallaxMethod::None),
                Paint::Lit(ParallaxMethod::Limited),
                Paint::Vectors,
                Paint::Handedness,
            ],
            turn: 30.0,
            elevation: 25.0,
            panel: 340,
            look: Look::default(),
        }
    }
}

/// Each pixel is so many samples wide and high.
const SAMPLES: usize = 3;
const MARGIN: usize = 12;
const GAP: usize = 8;
const TITLE: usize = 28;
const LINE: usize = 20;
const PAPER: [u8; 3] = [248, 248, 246];
/// The same, linear.
const BACKGROUND: [f32; 3] = [0.939, 0.939, 0.922];

impl Paint {
    fn words(self) -> String {
        match self {
            Self::Lit(ParallaxMethod::None) => "normal mapped".into(),
            Self::Lit(ParallaxMethod::Limited) => "with parallax: Welsh, limited".into(),
            Self::Lit(method) => format!("with parallax: {method}"),
            Self::Vectors => "tangents red, bitangents green, normals blue".into(),
            Self::Handedness => "blue, and orange where mirrored".into(),
            Self::Tangents => "tangents".into(),
        }
    }
}

/// Renders a model's meshes on the CPU, y upwards, side by side for each [`Paint`].
///
/// # Errors
/// [`crate::Error::Parameter`] if an option is outside its range, or the picture has too many pixels; [`crate::Error::Cancelled`] if `monitor` says so.
pub fn model_sheet(
    meshes: &[Worn],
    material: &Material,
    options: &ModelSheetOptions,
    monitor: &Monitor,
) -> Result<Picture> {
    options.check()?;
    let (side, columns) = (options.panel as usize, options.paints.len());
    check_pixels([columns * side, side])?;
    let viewpoint = options.viewpoint(meshes);
    let paint = |&paint: &Paint| {
        let mut canvas = Canvas::new(side * SAMPLES, viewpoint, BACKGROUND);
        for mesh in meshes {
            monitor.check()?;
            mesh.paint(&mut canvas, &viewpoint, material, &options.look, paint);
        }
        Picture::of_samples(canvas.colours(), side * SAMPLES, SAMPLES)
    };
    // One after another: samples take nine times the room of pixels.
    let panels = options.paints.iter().map(paint).collect::<Result<Vec<Picture>>>()?;
    let rows = painted_rows(&panels, side);
    let size = [2 * MARGIN + columns * (side + GAP) - GAP.min(columns * GAP), 2 * MARGIN + TITLE + LINE + rows.len()];
    let mut picture = Picture::filled(size, PAPER)?;
    let left = |column: usize| MARGIN + column * (side + GAP);
    for (column, panel) in panels.iter().enumerate() {
        picture.paste(&panel.rows(rows.clone())?, [left(column), MARGIN + TITLE + LINE]);
    }
    let labels = Labels::on(&mut picture)?;
    labels.text(&options.title, [MARGIN, MARGIN], 17, Anchor::Left, FontStyle::Bold)?;
    for (column, paint) in options.paints.iter().enumerate() {
        let at = [left(column) + side / 2, MARGIN + TITLE];
        // The longest words are as wide as a panel of the usual size.
        let height = (13 * side / 340).clamp(8, 13);
        labels.text(&paint.words(), at, height, Anchor::Middle, FontStyle::Bold)?;
    }
    labels.finish()?;
    Ok(picture)
}

/// The rows of square panels from the first to the last one that is not empty in one of them, and a little more.
fn painted_rows(panels: &[Picture], side: usize) -> Range<usize> {
    let is_painted = |row: &usize| {
        panels.iter().any(|panel| panel.pixels()[row * side..][..side].iter().any(|pixel| *pixel != PAPER))
    };
    match ((0..side).find(is_painted), (0..side).rfind(is_painted)) {
        (Some(first), Some(last)) => first.saturating_sub(GAP)..(last + 1 + GAP).min(side),
        _ => 0..side,
    }
}

impl ModelSheetOptions {
    /// Fails if a number is outside its range.
    fn check(&self) -> Result<()> {
        within("panel", self.panel, &PANEL)?;
        within("turn", self.turn, &(-360.0..=360.0))?;
        within("elevation", self.elevation, &(-89.0..=89.0))?;
        self.paints.iter().try_for_each(|paint| match paint {
            Paint::Lit(method) => check_method(*method),
            Paint::Vectors | Paint::Handedness | Paint::Tangents => Ok(()),
        })
    }

    fn viewpoint(&self, meshes: &[Worn]) -> Viewpoint {
        let points: Vec<[f32; 3]> = meshes.iter().flat_map(Worn::positions).collect();
        let (up, across) = self.elevation.to_radians().sin_cos();
        let (sin, cos) = self.turn.to_radians().sin_cos();
        Viewpoint::around(&points, [across * sin, up, across * cos], [0.0, 1.0, 0.0])
    }
}
