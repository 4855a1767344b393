//! Words and lines in a picture.

use super::picture::Picture;
use crate::error::{Error, Result};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon};
use plotters::prelude::BitMapBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, IntoFont, RGBColor, TextStyle, register_font};

/// What words are drawn in.
const FONT: &str = "texbake";

/// Where a text stands: right of its point, around it, or left of it; its upper border is at the point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Middle,
    Right,
}

/// A picture that is drawn into.
pub(super) struct Labels<'a>(DrawingArea<BitMapBackend<'a>, Shift>);

impl<'a> Labels<'a> {
    pub fn on(picture: &'a mut Picture) -> Result<Self> {
        // The same font again and again.
        register_font(FONT, FontStyle::Normal, dejavu::sans::regular())
            .and_then(|()| register_font(FONT, FontStyle::Bold, dejavu::sans::bold()))
            .map_err(|_| wrong("the font is damaged"))?;
        let size = picture.size();
        let area = BitMapBackend::with_buffer(picture.bytes_mut(), (size.width() as u32, size.height() as u32));
        Ok(Self(area.into_drawing_area()))
    }

    /// A line of text, `height` pixels from the lowest to the highest letters' ends.
    pub fn text(&self, text: &str, at: [usize; 2], height: usize, anchor: Anchor, style: FontStyle) -> Result<()> {
        let side = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        let font = (FONT, height as f64, style).into_font();
        let style = TextStyle::from(font).color(&INK).pos(Pos::new(side, VPos::Top));
        self.0.draw_text(text, &style, signed(at)).map_err(wrong)
    }

    /// An arrow that ends at `to`.
    pub fn arrow(&self, from: [f32; 2], to: [f32; 2], colour: [u8; 3]) -> Result<()> {
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        let length = x.hypot(y).max(1.0);
        let (along, aside) = ([x / length, y / length], [-y / length, x / length]);
        let head = |side: f32| [0, 1].map(|i| to[i] - 7.0 * along[i] + side * 4.0 * aside[i]);
        let point = |[x, y]: [f32; 2]| (x.round() as i32, y.round() as i32);
        let [red, green, blue] = colour;
        let colour = RGBColor(red, green, blue);
        self.0.draw(&PathElement::new(vec![point(from), point(to)], colour.stroke_width(2))).map_err(wrong)?;
        let corners = vec![point(to), point(head(1.0)), point(head(-1.0))];
        self.0.draw(&Polygon::new(corners, colour.filled())).map_err(wrong)
    }

    /// A disc.
    pub fn disc(&self, [x, y]: [f32; 2], radius: i32, [red, green, blue]: [u8; 3]) -> Result<()> {
        let disc = Circle::new((x.round() as i32, y.round() as i32), radius, RGBColor(red, green, blue).filled());
        self.0.draw(&disc).map_err(wrong)
    }

    /// Brings everything into the picture.
    pub fn finish(self) -> Result<()> {
        self.0.present().map_err(wrong)
    }
}

const INK: RGBColor = RGBColor(32, 32, 36);

fn signed([x, y]: [usize; 2]) -> (i32, i32) {
    (x as i32, y as i32)
}

fn wrong(reason: impl ToString) -> Error {
    Error::file("picture", reason, "report this as a bug of texbake")
}
