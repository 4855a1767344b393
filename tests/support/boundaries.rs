//! What lies next to the boundary between two codes.

use half::f16;
use texbake::{Depth, Encoding, NormalFormat};

/// The code of v is the nearest to factor v + centre.
pub fn factor_and_centre(format: NormalFormat) -> (f64, f64) {
    let l = f64::from(format.encoding.greatest_code(format.depth).expect("integer codes"));
    if format.encoding == Encoding::Unorm { (l / 2.0, l / 2.0) } else { (l, 0.0) }
}

/// What f64 makes of a component.
pub fn rounded_by_f64(v: f64, format: NormalFormat) -> f64 {
    match format.depth {
        Depth::Float16 => f16::from_f64(v).to_f64(),
        Depth::Float32 => f64::from(v as f32),
        Depth::Bits8 | Depth::Bits16 => {
            let (factor, centre) = factor_and_centre(format);
            (v * factor + centre + 0.5).floor()
        }
    }
}

/// The ratio of parts of at most `greatest` beside `value`: the last convergent of its continued fraction.
pub fn convergent(value: f64, greatest: i64) -> (i64, i64) {
    let ((mut p0, mut q0), (mut p, mut q)) = ((0, 1), (1, 0));
    let mut rest = value;
    loop {
        let whole = rest.floor();
        let (p1, q1) = (whole as i64 * p + p0, whole as i64 * q + q0);
        if p1.max(q1) > greatest {
            return (p, q);
        }
        ((p0, q0), (p, q)) = ((p, q), (p1, q1));
        if rest == whole {
            return (p, q);
        }
        rest = 1.0 / (rest - whole);
    }
}
