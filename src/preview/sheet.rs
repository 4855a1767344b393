//! The ways to use a material side by side.

use super::labels::{Anchor, Labels};
use super::limits::{PANEL, check_method, check_pixels, within};
use super::{Camera, Look, Picture, Renderer, Samples, Shot, Surface};
use crate::error::Result;
use crate::inspect::ramp::Ramp;
use crate::material::{Material, ParallaxMethod};
use crate::measure::{Errors, distance};
use crate::stream::Monitor;
use plotters::style::FontStyle;

/// What is on a sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetOptions {
    /// Its first line.
    pub title: String,
    /// Columns. With [`Surface::Truth`] among them, the errors of the others' offsets are painted beneath.
    pub surfaces: Vec<Surface>,
    /// Rows: degrees above the plane, as [`Camera::elevation`].
    pub elevations: Vec<f32>,
    /// How much of the map's width is seen; `None`: ten times what is between the lowest and the highest, or all of it.
    pub width: Option<f32>,
    /// Error that is white, in texels; `None`: the longest offset that relief can have, in the middle of a panel.
    pub white: Option<f32>,
    /// Width and height of a panel in pixels, each from 16 to 4096.
    pub panel: [u32; 2],
    /// Light and colours.
    pub look: Look,
}

impl Default for SheetOptions {
    fn default() -> Self {
        Self {
            title: String::new(),
            surfaces: Self::every_surface(&[1, 4]),
            elevations: vec![60.0, 25.0],
            width: None,
            white: None,
            panel: [164, 128],
            look: Look::default(),
        }
    }
}

impl SheetOptions {
    /// All surfaces, with so many steps through the parallax map.
    pub fn every_surface(steps: &[u32]) -> Vec<Surface> {
        let single = [ParallaxMethod::None, ParallaxMethod::Welsh, ParallaxMethod::Limited];
        let plane = [1.0, 3.0].map(|limit| ParallaxMethod::Plane { limit });
        let steps = steps.iter().map(|&k| ParallaxMethod::steps(k));
        let mapped = single.into_iter().chain(plane).chain(steps).map(Surface::Mapped);
        [Surface::Flat].into_iter().chain(mapped).chain([Surface::Truth]).collect()
    }

    /// Fails if a number is outside its range.
    fn check(&self, material: &Material) -> Result<()> {
        self.panel.iter().try_for_each(|&side| within("panel", side, &PANEL))?;
        self.elevations.iter().try_for_each(|&elevation| self.camera(material, elevation).check())?;
        self.white.map_or(Ok(()), |white| within("error-max", white, &(1e-6..=1e9)))?;
        self.surfaces.iter().try_for_each(|surface| match surface {
            Surface::Mapped(method) => check_method(*method),
            Surface::Flat | Surface::Truth => Ok(()),
        })
    }

    fn white(&self, material: &Material, elevation: f32) -> f32 {
        // From straight above there is none: an eighth of the scale at least.
        let longest = highest(material) / 2.0 / elevation.to_radians().tan().min(4.0);
        // Of a map without relief every scale paints black.
        self.white.unwrap_or(if longest > 0.0 { longest } else { 1.0 })
    }

    fn camera(&self, material: &Material, elevation: f32) -> Camera {
        let share = 10.0 * highest(material) / material.size().width() as f32;
        let width = self.width.unwrap_or(if share > 0.0 { share.clamp(1.0 / 16.0, 1.0) } else { 1.0 });
        Camera { elevation, width }
    }
}

/// The height of h = 1 in texels, along the axis along which it has more.
fn highest(material: &Material) -> f32 {
    material.scale().map(f32::abs).into_iter().fold(0.0, f32::max)
}

/// A contact sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// The picture.
    pub picture: Picture,
    /// What it tells in numbers, row by row.
    pub told: Vec<Told>,
}

/// The errors of a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// Degrees above the plane.
    pub elevation: f32,
    /// How the maps are used.
    pub surface: Surface,
    /// How far the samples' offsets are from the truth, in texels.
    pub errors: Errors,
}

/// Each pixel is so many samples wide and high.
const SAMPLES: u32 = 2;
const MARGIN: usize = 12;
const GAP: usize = 6;
const TITLE: usize = 26;
const HEADING: usize = 24;
const LINE: usize = 17;
const PAPER: [u8; 3] = [248, 248, 246];
const SUN: [u8; 3] = [255, 214, 64];

impl Sheet {
    /// Renders a sheet.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if an option is outside its range, or the picture has too many pixels, before anything
    /// is rendered; [`crate::Error::Device`] if a GPU fails;
    /// [`crate::Error::Cancelled`] if `monitor` says so.
    pub fn render(material: &Material, options: &SheetOptions, renderer: &Renderer, monitor: &Monitor) -> Result<Self> {
        options.check(material)?;
        let has_truth = options.surfaces.contains(&Surface::Truth);
        let layout = Layout { options, has_truth };
        check_pixels(layout.size())?;
        let mut picture = Picture::filled(layout.size(), PAPER)?;
        let mut told = Vec::new();
        for (row, &elevation) in options.elevations.iter().enumerate() {
            let white = options.white(material, elevation);
            let take = |surface| {
                let camera = options.camera(material, elevation);
                let count = options.panel.map(|pixels| pixels * SAMPLES);
                renderer.take(&Shot { material, surface, camera, look: options.look, count }, monitor)
            };
            let truth = has_truth.then(|| take(Surface::Truth)).transpose()?;
            for (column, &surface) in options.surfaces.iter().enumerate() {
                let samples = match (surface, &truth) {
                    (Surface::Truth, Some(truth)) => truth.clone(),
                    _ => take(surface)?,
                };
                picture.paste(&layout.pixels(&samples)?, layout.panel(row, column));
                let Some(truth) = &truth else { continue };
                let errors = errors(material, &samples, truth);
                match surface {
                    Surface::Flat => picture.paste(&layout.ramp()?, layout.legend(row, column)),
                    _ => picture.paste(&layout.heat(&errors, white)?, layout.heat_panel(row, column)),
                }
                told.push(Told { elevation, surface, errors: Errors::of(errors) });
            }
        }
        layout.label(material, &mut picture, &told)?;
        Ok(Self { picture, told })
    }
}

/// How far each sample's offset is from the truth, in texels.
fn errors(material: &Material, samples: &Samples, truth: &Samples) -> Vec<f32> {
    let texels = material.texels();
    samples.offsets.iter().zip(&truth.offsets).map(|(&a, &b)| distance(a, b, texels)).collect()
}

/// Where everything is.
struct Layout<'a> {
    options: &'a SheetOptions,
    has_truth: bool,
}

impl Layout<'_> {
    fn panel_size(&self) -> [usize; 2] {
        self.options.panel.map(|pixels| pixels as usize)
    }

    /// Pixels of a row: heading, titles, pictures, heat maps, numbers.
    fn row_height(&self) -> usize {
        let height = self.panel_size()[1];
        HEADING + LINE + height + if self.has_truth { GAP + height + LINE + 4 } else { 0 } + GAP
    }

    fn size(&self) -> [usize; 2] {
        let (rows, columns) = (self.options.elevations.len(), self.options.surfaces.len());
        [
            2 * MARGIN + columns * (self.panel_size()[0] + GAP) - GAP.min(columns * GAP),
            2 * MARGIN + TITLE + rows * self.row_height(),
        ]
    }

    fn row(&self, row: usize) -> usize {
        MARGIN + TITLE + row * self.row_height()
    }

    fn panel(&self, row: usize, column: usize) -> [usize; 2] {
        [MARGIN + column * (self.panel_size()[0] + GAP), self.row(row) + HEADING + LINE]
    }

    fn heat_panel(&self, row: usize, column: usize) -> [usize; 2] {
        let [x, y] = self.panel(row, column);
        [x, y + self.panel_size()[1] + GAP]
    }

    /// What the colours of errors mean, in the place of a heat map of the flat surface.
    fn legend(&self, row: usize, column: usize) -> [usize; 2] {
        let [x, y] = self.heat_panel(row, column);
        [x, y + self.panel_size()[1] / 2]
    }

    /// The colours of errors from none to white.
    fn ramp(&self) -> Result<Picture> {
        let (ramp, width) = (Ramp::cubehelix(), self.panel_size()[0] - 2 * GAP);
        let shares: Vec<[f32; 1]> = (0..12 * width).map(|i| [(i % width) as f32 / width as f32]).collect();
        Picture::of_means(&shares, width, 1, |[share]| ramp.colour(share.into()))
    }

    fn pixels(&self, samples: &Samples) -> Result<Picture> {
        Picture::of_samples(&samples.colours, self.panel_size()[0] * SAMPLES as usize, SAMPLES as usize)
    }

    fn heat(&self, errors: &[f32], white: f32) -> Result<Picture> {
        let ramp = Ramp::cubehelix();
        let colour = |[error]: [f32; 1]| ramp.colour(f64::from(error / white));
        let samples: Vec<[f32; 1]> = errors.iter().map(|&error| [error]).collect();
        Picture::of_means(&samples, self.panel_size()[0] * SAMPLES as usize, SAMPLES as usize, colour)
    }

    fn label(&self, material: &Material, picture: &mut Picture, told: &[Told]) -> Result<()> {
        let labels = Labels::on(picture)?;
        let [width, height] = self.panel_size();
        // Words are as wide as a panel of the usual size.
        let small = |usual: usize| (usual * width / 164).clamp(8, usual);
        labels.text(&self.options.title, [MARGIN, MARGIN], 17, Anchor::Left, FontStyle::Bold)?;
        for (row, &elevation) in self.options.elevations.iter().enumerate() {
            let heading = format!("Seen from {elevation}° above the surface");
            labels.text(&heading, [MARGIN, self.row(row) + 4], 14, Anchor::Left, FontStyle::Normal)?;
            for (column, surface) in self.options.surfaces.iter().enumerate() {
                let [x, y] = self.panel(row, column);
                let middle = x + width / 2;
                labels.text(&surface.to_string(), [middle, y - LINE], small(13), Anchor::Middle, FontStyle::Bold)?;
                if *surface == Surface::Flat {
                    self.sun(&labels, [x, y])?;
                    if self.has_truth {
                        let white = self.options.white(material, elevation);
                        self.explain(&labels, self.legend(row, column), white)?;
                    }
                }
                let told = told.get(row * self.options.surfaces.len() + column);
                if let Some(Told { errors, .. }) = told.filter(|_| *surface != Surface::Flat) {
                    let text = format!("mean {:.2}, largest {:.1}", errors.mean, errors.largest);
                    let below = self.heat_panel(row, column)[1] + height + 4;
                    labels.text(&text, [middle, below], small(12), Anchor::Middle, FontStyle::Normal)?;
                }
            }
        }
        labels.finish()
    }

    /// What the ramp at a place means.
    fn explain(&self, labels: &Labels<'_>, [x, y]: [usize; 2], white: f32) -> Result<()> {
        let right = x + self.panel_size()[0] - 2 * GAP;
        for (line, text) in ["Error of the offsets", "in texels"].into_iter().enumerate() {
            labels.text(text, [x, y - 2 * LINE - 4 + line * LINE], 12, Anchor::Left, FontStyle::Normal)?;
        }
        labels.text("0", [x, y + LINE], 12, Anchor::Left, FontStyle::Normal)?;
        labels.text(&format!("{white:.1} and more"), [right, y + LINE], 12, Anchor::Right, FontStyle::Normal)
    }

    /// Where the light comes from, in the middle of a panel.
    fn sun(&self, labels: &Labels<'_>, [x, y]: [usize; 2]) -> Result<()> {
        let [width, height] = self.panel_size().map(|pixels| pixels as f32);
        let (sin, cos) = self.options.look.light.azimuth.to_radians().sin_cos();
        let middle = [x as f32 + width / 2.0, y as f32 + height / 2.0];
        let reach = 0.42 * width.min(height);
        let sun = [middle[0] + reach * cos, middle[1] - reach * sin];
        let tip = [middle[0] + 0.4 * reach * cos, middle[1] - 0.4 * reach * sin];
        labels.arrow(sun, tip, SUN)?;
        labels.disc(sun, 7, SUN)
    }
}
