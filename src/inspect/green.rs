//! Which way green seems to point: the curl test.

use super::read::{Components, LANES};
use crate::map::{Convention, Size};

/// The curl of a map's slopes, as each convention reads them.
///
/// With the slopes p = -x/z and q = -y/z a height field has dp/dy = dq/dx, for y along green: the slopes of heights
/// have no curl. Read the wrong way round, q has the wrong sign and the curl is twice that derivative. Derivatives are
/// central differences inside the map; each texel weighs as much as the product of the z of its four neighbours, by
/// which the error of a slope made of codes grows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Green {
    /// What the map was read as.
    pub read_as: Convention,
    /// Mean square of the curl if green points up.
    pub gl: f64,
    /// Mean square of the curl if green points down.
    pub dx: f64,
    /// The difference of both in units of its own standard deviation, were the texels' signs chance.
    pub significance: f64,
}

/// One curl must be this many times the other. Random vectors have 1; slopes turned by a right angle everywhere, which
/// have curl alone, have 2 if they run in all directions alike; baked heights have 15 to 50 at a scale that makes them
/// nearly flat, and above 1000 otherwise; scanned and painted maps have 5 and more.
const DECISIVE_RATIO: f64 = 3.0;

/// A map of independent texels gets above this once in 10^15; a smooth one that is made of no heights and has few bumps
/// may do so more often.
const DECISIVE_SIGNIFICANCE: f64 = 8.0;

impl Green {
    /// The greater curl over the smaller one: infinite if the smaller one is zero, 1 if both are.
    pub fn ratio(&self) -> f64 {
        let (less, more) = (self.gl.min(self.dx), self.gl.max(self.dx));
        if more == 0.0 { 1.0 } else { more / less }
    }

    /// The convention that the map was likely made with; `None` if there is no telling: the map is flat, slopes along
    /// one axis only, or is not made of heights.
    pub fn likely(&self) -> Option<Convention> {
        let is_decisive = self.ratio() >= DECISIVE_RATIO && self.significance >= DECISIVE_SIGNIFICANCE;
        is_decisive.then_some(if self.gl < self.dx { Convention::Gl } else { Convention::Dx })
    }

    /// Whether the map was likely made with the other convention than it was read as.
    pub fn seems_wrong(&self) -> bool {
        self.likely().is_some_and(|likely| likely != self.read_as)
    }
}

/// Sums over the rows.
pub(super) struct GreenTest {
    /// The slopes of the last three rows; row y stands at y mod 3.
    rows: [Slopes; 3],
    next_row: usize,
    sums: Sums<f64>,
    texels: u64,
}

/// The slopes of a row.
#[derive(Clone)]
struct Slopes {
    p: Vec<f32>,
    q: Vec<f32>,
    z: Vec<f32>,
}

/// With a = dp/drow and b = dq/dcolumn, rows counting down: the sums of a^2 + b^2, of a b, and of (a b)^2.
#[derive(Clone, Copy, Default)]
struct Sums<T> {
    squares: T,
    products: T,
    variance: T,
}

/// Slopes are cut here: below it, z is within a few codes of zero and its slope means nothing.
const LEAST_Z: f32 = 1.0 / 64.0;

impl GreenTest {
    pub fn new(size: Size) -> Self {
        let room = || vec![0.0; size.width()];
        let row = Slopes { p: room(), q: room(), z: room() };
        Self { rows: [row.clone(), row.clone(), row], next_row: 0, sums: Sums::default(), texels: 0 }
    }

    pub fn add_row(&mut self, row: &Components) {
        self.rows[self.next_row % 3].set(row);
        self.next_row += 1;
        if self.next_row >= 3 {
            let [above, middle, below] = [3, 2, 1].map(|back| &self.rows[(self.next_row - back) % 3]);
            let sums = sums_of_row(above, middle, below);
            self.sums.squares += sums.squares;
            self.sums.products += sums.products;
            self.sums.variance += sums.variance;
            self.texels += middle.p.len().saturating_sub(2) as u64;
        }
    }

    pub fn result(&self, read_as: Convention) -> Green {
        let Sums { squares, products, variance } = self.sums;
        let texels = self.texels.max(1) as f64;
        // Down the rows the curl is a - b; green up turns the sign of b.
        let [gl, dx] = [2.0, -2.0].map(|sign| ((squares + sign * products) / texels).max(0.0));
        let significance = if variance > 0.0 { products.abs() / variance.sqrt() } else { 0.0 };
        Green { read_as, gl, dx, significance }
    }
}

impl Slopes {
    fn set(&mut self, row: &Components) {
        let components = row.x.iter().zip(&row.y).zip(&row.z);
        let slopes = self.p.iter_mut().zip(&mut self.q).zip(&mut self.z);
        for (((p, q), z), ((x, y), stored)) in slopes.zip(components) {
            *z = stored.clamp(LEAST_Z, 1.0);
            (*p, *q) = (-x / *z, -y / *z);
        }
    }
}

/// The sums over the texels of a row that have neighbours on all sides.
fn sums_of_row(above: &Slopes, middle: &Slopes, below: &Slopes) -> Sums<f64> {
    let inside = middle.p.len().saturating_sub(2);
    let mut lanes = [Sums::<f32>::default(); LANES];
    for first in (0..inside).step_by(LANES) {
        for (lane, sums) in lanes.iter_mut().enumerate().take(inside - first) {
            let i = first + lane;
            let a = below.p[i + 1] - above.p[i + 1];
            let b = middle.q[i + 2] - middle.q[i];
            let weight = above.z[i + 1] * below.z[i + 1] * middle.z[i] * middle.z[i + 2];
            let product = weight * (a * b);
            sums.squares += weight * (a * a + b * b);
            sums.products += product;
            sums.variance += product * product;
        }
    }
    lanes.iter().fold(Sums::default(), |sum, lane| Sums {
        squares: sum.squares + f64::from(lane.squares),
        products: sum.products + f64::from(lane.products),
        variance: sum.variance + f64::from(lane.variance),
    })
}
