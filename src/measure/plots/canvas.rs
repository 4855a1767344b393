//! What charts are drawn on: one drawing becomes SVG and PNG.

use crate::error::{Error, Result};
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, IntoFont, RGBColor, ShapeStyle, TextStyle, WHITE, register_font};

use std::io;

/// Width and height in points.
pub(super) const SIZE: (f64, f64) = (960.0, 600.0);

/// The font's name, and what a viewer of SVG that has no such font takes.
const FONT: &str = "DejaVu Sans, Verdana, sans-serif";

/// Pixels of the bitmap for each of the PNG, along each axis: lines have no steps then.
const FINER: usize = 2;

/// A drawing in both forms.
pub(super) struct Picture {
    pub svg: String,
    pub png: Vec<u8>,
}

/// Which way a text lies from its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Centre,
    Right,
}

/// What can be drawn; coordinates are points from the top left corner.
pub(super) trait Canvas {
    fn line(&mut self, points: &[(f64, f64)], width: f64, colour: [u8; 3]);
    fn dot(&mut self, at: (f64, f64), radius: f64, colour: [u8; 3]);
    /// A text whose middle has the height of the point.
    fn text(&mut self, text: &str, at: (f64, f64), size: f64, anchor: Anchor);
    /// The width of a text.
    fn width(&self, text: &str, size: f64) -> f64;
}

/// Draws a picture.
pub(super) fn picture(name: &str, draw: impl Fn(&mut dyn Canvas)) -> Result<Picture> {
    let failed = |reason: String| Error::io(format!("{name}.svg"))(io::Error::other(reason));
    register_font(FONT, FontStyle::Normal, dejavu::sans::regular()).map_err(|_| failed("no font".into()))?;
    let size = |finer: usize| (SIZE.0 as u32 * finer as u32, SIZE.1 as u32 * finer as u32);

    let mut svg = String::new();
    on_area(SVGBackend::with_string(&mut svg, size(1)).into_drawing_area(), 1.0, &draw).map_err(failed)?;

    let (width, height) = size(FINER);
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    let bitmap = BitMapBackend::with_buffer(&mut pixels, (width, height));
    on_area(bitmap.into_drawing_area(), FINER as f64, &draw).map_err(failed)?;
    let png = png_of(&pixels, width as usize, height as usize).map_err(|error| failed(error.to_string()))?;
    Ok(Picture { svg, png })
}

fn on_area<B: DrawingBackend>(
    area: DrawingArea<B, Shift>,
    zoom: f64,
    draw: &impl Fn(&mut dyn Canvas),
) -> Result<(), String> {
    let mut canvas = Plotters { area, zoom, failure: None };
    canvas.keep(|area| area.fill(&WHITE).map_err(|error| error.to_string()));
    draw(&mut canvas);
    canvas.keep(|area| area.present().map_err(|error| error.to_string()));
    canvas.failure.map_or(Ok(()), Err)
}

/// An area of plotters; the first failure stays.
struct Plotters<B: DrawingBackend> {
    area: DrawingArea<B, Shift>,
    zoom: f64,
    failure: Option<String>,
}

impl<B: DrawingBackend> Plotters<B> {
    fn keep(&mut self, work: impl FnOnce(&DrawingArea<B, Shift>) -> Result<(), String>) {
        if let Err(reason) = work(&self.area) {
            self.failure.get_or_insert(reason);
        }
    }

    fn pixel(&self, (x, y): (f64, f64)) -> (i32, i32) {
        ((x * self.zoom).round() as i32, (y * self.zoom).round() as i32)
    }

    fn style(&self, size: f64) -> TextStyle<'static> {
        TextStyle::from((FONT, size * self.zoom).into_font())
    }
}

impl<B: DrawingBackend> Canvas for Plotters<B> {
    fn line(&mut self, points: &[(f64, f64)], width: f64, colour: [u8; 3]) {
        let points: Vec<(i32, i32)> = points.iter().map(|&point| self.pixel(point)).collect();
        let style = ShapeStyle::from(rgb(colour)).stroke_width((width * self.zoom).round().max(1.0) as u32);
        self.keep(|area| area.draw(&PathElement::new(points, style)).map_err(|error| error.to_string()));
    }

    fn dot(&mut self, at: (f64, f64), radius: f64, colour: [u8; 3]) {
        let (at, radius) = (self.pixel(at), (radius * self.zoom).round() as i32);
        let style = rgb(colour).filled();
        self.keep(|area| area.draw(&Circle::new(at, radius, style)).map_err(|error| error.to_string()));
    }

    fn text(&mut self, text: &str, at: (f64, f64), size: f64, anchor: Anchor) {
        let side = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Centre => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        let (at, style) = (self.pixel(at), self.style(size).pos(Pos::new(side, VPos::Center)));
        self.keep(|area| area.draw(&Text::new(text, at, style)).map_err(|error| error.to_string()));
    }

    fn width(&self, text: &str, size: f64) -> f64 {
        let style = self.style(size);
        // Without a layout a guess does: letters are about half as wide as high.
        let guess = text.chars().count() as f64 * size * self.zoom * 0.6;
        self.area.estimate_text_size(text, &style).map_or(guess, |(width, _)| width.into()) / self.zoom
    }
}

fn rgb([r, g, b]: [u8; 3]) -> RGBColor {
    RGBColor(r, g, b)
}

/// A PNG of the means of squares of `FINER` x `FINER` pixels.
fn png_of(pixels: &[u8], width: usize, height: usize) -> Result<Vec<u8>, png::EncodingError> {
    let (columns, rows) = (width / FINER, height / FINER);
    let mean = |column: usize, row: usize, channel: usize| {
        let square = (0..FINER * FINER).map(|i| (row * FINER + i / FINER) * width + column * FINER + i % FINER);
        let sum: usize = square.map(|pixel| usize::from(pixels[3 * pixel + channel])).sum();
        (sum / (FINER * FINER)) as u8
    };
    let place = |i: usize| mean(i / 3 % columns, i / 3 / columns, i % 3);
    let codes: Vec<u8> = (0..3 * columns * rows).map(place).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns as u32, rows as u32);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&codes)?;
    writer.finish()?;
    Ok(bytes)
}
