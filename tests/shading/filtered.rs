//! Textures, as a filter in f64 reads them.

use crate::support::Texels;
use texbake::Size;

/// A texture whose texels are f16, too, so that every device can filter them.
pub fn texels(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> Texels {
    let values: Vec<f32> = (0..width * height).map(|at| value(at % width, at / width)).collect();
    assert!(values.iter().all(|value| half::f16::from_f32(*value).to_f32() == *value));
    Texels { size: Size::new(width, height).unwrap(), values }
}

/// Bilinear between the middles of texels, repeating.
pub fn filtered(texels: &Texels, [u, v]: [f64; 2]) -> f64 {
    let (width, height) = (texels.size.width() as i64, texels.size.height() as i64);
    let at = |x: i64, y: i64| {
        let [x, y] = [x.rem_euclid(width), y.rem_euclid(height)];
        f64::from(texels.values[(y * width + x) as usize])
    };
    let [x, y] = [u * width as f64 - 0.5, v * height as f64 - 0.5];
    let ([column, row], [s, t]) = ([x, y].map(|place| place.floor() as i64), [x, y].map(|place| place - place.floor()));
    let along = |row: i64| at(column, row) * (1.0 - s) + at(column + 1, row) * s;
    along(row) * (1.0 - t) + along(row + 1) * t
}

/// The greatest difference between texels next to each other, along u and along v.
pub fn steepest(texels: &Texels) -> [f64; 2] {
    let (width, height) = (texels.size.width(), texels.size.height());
    let at = |x: usize, y: usize| f64::from(texels.values[y % height * width + x % width]);
    let greatest = |dx: usize, dy: usize| {
        let all = (0..width * height).map(|i| (i % width, i / width));
        all.map(|(x, y)| (at(x + dx, y + dy) - at(x, y)).abs()).fold(0.0, f64::max)
    };
    [greatest(1, 0), greatest(0, 1)]
}
