//! A chart: two axes, and points or lines between them.

use super::axis::Axis;
use super::canvas::{Anchor, Canvas, SIZE};
use super::labels::{Area, Places};

/// Points of a line, by rising or falling x.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

/// What is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chart {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    /// Lines, with a legend on the right.
    pub lines: Vec<Series>,
    /// Points without a label.
    pub others: Vec<(f64, f64)>,
    /// Points with labels, by rising x, and the line between what they rule out and what not.
    pub front: Vec<(String, f64, f64)>,
}

const TEXT: f64 = 14.0;
const BLACK: [u8; 3] = [0; 3];
const GRID: [u8; 3] = [225; 3];
const OTHER: [u8; 3] = [165; 3];
const FRONT: [u8; 3] = [200, 60, 20];

/// Colours that people who see fewer colours tell apart too (Okabe and Ito, Color Universal Design, 2008), without the
/// yellow that white hides.
const COLOURS: [[u8; 3]; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [86, 180, 233],
    [230, 159, 0],
    [0, 0, 0],
    [140, 140, 140],
];

impl Chart {
    pub fn draw(&self, canvas: &mut dyn Canvas) {
        let legend = if self.lines.is_empty() { 0.0 } else { 170.0 };
        let area = Area { left: 84.0, top: 76.0, right: SIZE.0 - 24.0 - legend, bottom: SIZE.1 - 62.0 };
        canvas.text(&self.title, (24.0, 26.0), 18.0, Anchor::Left);
        self.draw_axes(canvas, area);
        self.draw_lines(canvas, area);
        self.draw_front(canvas, area);
    }

    /// Where a point is drawn.
    fn place(&self, area: Area, (x, y): (f64, f64)) -> (f64, f64) {
        let across = area.left + self.x.share(x) * (area.right - area.left);
        (across, area.bottom - self.y.share(y) * (area.bottom - area.top))
    }

    fn draw_axes(&self, canvas: &mut dyn Canvas, area: Area) {
        for (number, text) in self.x.ticks() {
            let x = area.left + self.x.share(number) * (area.right - area.left);
            canvas.line(&[(x, area.top), (x, area.bottom)], 1.0, GRID);
            canvas.text(&text, (x, area.bottom + 16.0), TEXT, Anchor::Centre);
        }
        for (number, text) in self.y.ticks() {
            let y = area.bottom - self.y.share(number) * (area.bottom - area.top);
            canvas.line(&[(area.left, y), (area.right, y)], 1.0, GRID);
            canvas.text(&text, (area.left - 8.0, y), TEXT, Anchor::Right);
        }
        canvas.line(&[(area.left, area.top), (area.left, area.bottom), (area.right, area.bottom)], 1.5, BLACK);
        canvas.text(&self.y.name, (24.0, area.top - 20.0), TEXT, Anchor::Left);
        canvas.text(&self.x.name, ((area.left + area.right) / 2.0, area.bottom + 42.0), TEXT, Anchor::Centre);
    }

    fn draw_lines(&self, canvas: &mut dyn Canvas, area: Area) {
        for (i, series) in self.lines.iter().enumerate() {
            let colour = COLOURS[i % COLOURS.len()];
            let points: Vec<(f64, f64)> = series.points.iter().map(|&point| self.place(area, point)).collect();
            canvas.line(&points, 2.0, colour);
            points.iter().for_each(|&point| canvas.dot(point, 3.5, colour));
            let (left, y) = (area.right + 20.0, area.top + 10.0 + 24.0 * i as f64);
            canvas.line(&[(left, y), (left + 24.0, y)], 2.0, colour);
            canvas.dot((left + 12.0, y), 3.5, colour);
            canvas.text(&series.name, (left + 32.0, y), TEXT, Anchor::Left);
        }
    }

    fn draw_front(&self, canvas: &mut dyn Canvas, area: Area) {
        let others: Vec<(f64, f64)> = self.others.iter().map(|&point| self.place(area, point)).collect();
        let front: Vec<(f64, f64)> = self.front.iter().map(|&(_, x, y)| self.place(area, (x, y))).collect();
        others.iter().for_each(|&point| canvas.dot(point, 3.5, OTHER));
        let stairs = stairs(&front);
        canvas.line(&stairs, 1.5, FRONT);
        front.iter().for_each(|&point| canvas.dot(point, 5.0, FRONT));

        let points = others.iter().chain(&front).map(|&point| Area::around(point, 5.0));
        let edges = stairs.windows(2).map(|edge| Area {
            left: edge[0].0.min(edge[1].0) - 2.0,
            top: edge[0].1.min(edge[1].1) - 2.0,
            right: edge[0].0.max(edge[1].0) + 2.0,
            bottom: edge[0].1.max(edge[1].1) + 2.0,
        });
        let mut places = Places { within: area, taken: points.chain(edges).collect() };
        for ((name, ..), &point) in self.front.iter().zip(&front) {
            let size = (canvas.width(name, TEXT), TEXT + 3.0);
            if let Some(place) = places.take(point, size) {
                canvas.text(name, place, TEXT, Anchor::Left);
            }
        }
    }
}

/// From each point straight to the right, then straight to the next: what lies above is beaten.
fn stairs(front: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let corners = front.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    corners.chain(front.last().copied()).collect()
}
