//! What a shader needs to know of a parallax map.

use super::{Job, Outcome};
use crate::error::{Error, Result};
use crate::exact::AxisScale;
use crate::map::{Depth, Encoding, ParallaxFormat, Size};
use serde::Serialize;
use std::io::ErrorKind;
use std::num::NonZeroU32;
use std::path::Path;

/// The numbers of a parallax map for a shader: how its codes are read, and how far they move texture coordinates.
///
/// All vectors are for x and y. Texture coordinates run from 0 to 1 over the map, so a scale of s texels on an axis of
/// r texels is s/r of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParallaxNumbers {
    /// The scale s of each axis: the height of h = 1 in texels.
    pub scale_in_texels: [f64; 2],
    /// Steps k towards the eye, each of which looks the map up once.
    pub iterations: u32,
    /// What a step multiplies the unit tangent-space vector to the eye by: u = s / (2 k r) (FGED2 eq. 7.52).
    pub u: [f64; 2],
    /// How a value in [-1, 1] is read from the map.
    pub decode: Decoding,
    /// The same for parallax mapping with the height map itself.
    pub welsh: WelshNumbers,
    /// The steps in a shader (FGED2 listing 7.9); `eye` is the unit tangent-space vector to the eye.
    pub shader: String,
    /// Which way x and y point.
    pub axes: &'static str,
}

/// The axes of FGED2 listing 7.9: those of tangent space, in which the normal map's vectors are too.
const AXES: &str = "x of eye and of the offset is along the tangent, in which u increases, and y along the second axis of \
     tangent space, in which v increases (FGED2 listing 7.9): with green up, that is up the image; where v grows down \
     the rows, change the sign of the offset's y";

/// A parallax map for a shader: what lies beside it as JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParallaxSidecar {
    /// Version of texbake.
    pub version: &'static str,
    /// Name of the map's file.
    pub map: String,
    /// Texels in a row, and rows.
    pub size: [usize; 2],
    /// How a value becomes a code.
    pub encoding: String,
    /// How a code is stored.
    pub bits: String,
    /// What a shader computes with.
    #[serde(flatten)]
    pub numbers: ParallaxNumbers,
}

/// How the value v in [-1, 1] is read from a parallax map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decoding {
    /// From the code in the file: `max((code - 128) / 127, -1)`.
    pub code: String,
    /// From what a texture unit makes of the code, a float in [0, 1] for unsigned channels and in [-1, 1] for signed
    /// ones: v = multiply * sample + add.
    pub multiply: f64,
    /// See `multiply`.
    pub add: f64,
}

/// Scale and bias of h in parallax mapping: the texture coordinates move by (scale h + bias) times the view vector's
/// xy (with offset limiting), or xy/z (Terry Welsh, Parallax Mapping with Offset Limiting, 2004).
///
/// The bias is -scale/2, so that a height of 1/2 moves nothing. Welsh's text gives s/2, and the example "a bias of
/// 0.01"; his programs have the scale 0.04 and the bias -0.02, which is right.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WelshNumbers {
    /// s / r.
    pub scale: [f64; 2],
    /// -s / (2 r).
    pub bias: [f64; 2],
}

impl ParallaxNumbers {
    /// Those of the parallax map that `job` made, for `iterations` steps; `None` if it made none.
    pub fn of(job: &Job, outcome: &Outcome, iterations: NonZeroU32) -> Option<Self> {
        let (baked, format) = outcome.result.as_ref().ok().zip(job.options.parallax)?;
        Some(Self::new(baked.scale, baked.size, format, iterations))
    }

    /// The numbers of a map of `size` and `format`, baked with `scale`, for `iterations` steps.
    pub fn new(scale: AxisScale, size: Size, format: ParallaxFormat, iterations: NonZeroU32) -> Self {
        let parts = [(scale.x, size.width()), (scale.y, size.height())];
        // Each is one division of integers below 2^53: rounded once.
        let over = |divisor: fn(f64, f64) -> f64| {
            parts.map(|(part, r)| {
                f64::from(part) / (f64::from(scale.q) * divisor(r as f64, f64::from(iterations.get())))
            })
        };
        Self {
            scale_in_texels: over(|_, _| 1.0),
            iterations: iterations.get(),
            u: over(|r, k| 2.0 * k * r),
            decode: Decoding::of(format),
            // Plus zero: no number is -0.
            welsh: WelshNumbers { scale: over(|r, _| r), bias: over(|r, _| -2.0 * r).map(|bias| bias + 0.0) },
            shader: format!(
                "vec2 step = eye.xy * u; for (int i = 0; i < {iterations}; i++) {{ uv += step * (texture(map, uv).r * \
                 multiply + add); }}"
            ),
            axes: AXES,
        }
    }
}

impl ParallaxSidecar {
    /// Describes the parallax map that `job` made, for `iterations` steps; `None` if it made none.
    pub fn of(job: &Job, outcome: &Outcome, iterations: NonZeroU32) -> Option<Self> {
        let (baked, format) = outcome.result.as_ref().ok().zip(job.options.parallax)?;
        let size = baked.size;
        Some(Self {
            version: env!("CARGO_PKG_VERSION"),
            map: job.outputs.parallax.as_ref()?.file_name()?.to_string_lossy().into(),
            size: [size.width(), size.height()],
            encoding: format.encoding.to_string(),
            bits: format.depth.to_string(),
            numbers: ParallaxNumbers::of(job, outcome, iterations)?,
        })
    }
}

/// What every sidecar has, and hardly another file.
const KEYS: [&str; 3] = ["scale_in_texels", "decode", "welsh"];

impl ParallaxSidecar {
    /// Fails if something else than a sidecar is at `path`, a name that nobody has written: it would be lost.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::Io`] if what is there cannot be read.
    pub fn check_place(path: &Path) -> Result<()> {
        if std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir()) {
            return Err(Error::file(path, "it is a device or a pipe", "give the output another name"));
        }
        let bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(Error::io(path)(error)),
        };
        let content: Option<serde_json::Value> = serde_json::from_slice(&bytes).ok();
        if content.is_some_and(|content| KEYS.iter().all(|key| content.get(key).is_some())) {
            return Ok(());
        }
        let remedy = "move it away, or give the output another name";
        Err(Error::file(path, "the sidecar would overwrite this file, which texbake did not write", remedy))
    }
}

impl Decoding {
    /// How codes of `format` are read.
    fn of(format: ParallaxFormat) -> Self {
        let greatest = format.encoding.greatest_code(format.depth);
        let l = greatest.map_or(1.0, f64::from);
        let (code, multiply, add) = match format.encoding {
            Encoding::Unorm => (format!("2 * code / {l} - 1"), 2.0, -1.0),
            Encoding::Snorm => (format!("max(code / {l}, -1)"), 1.0, 0.0),
            // Schüler's sign expansion: 255/127 c - 128/127.
            Encoding::Biased => (format!("max((code - {}) / {l}, -1)", l + 1.0), (2.0 * l + 1.0) / l, -(l + 1.0) / l),
            Encoding::Float => ("code".into(), 1.0, 0.0),
        };
        Self { code, multiply, add }
    }
}

/// What a code of zero is, where it is not 0: `biased 8 (128 is exactly zero)`.
pub fn describe_codes(format: ParallaxFormat) -> String {
    let zero = match (format.encoding, format.depth) {
        (Encoding::Biased, Depth::Bits8) => " (128 is exactly zero)",
        (Encoding::Biased, Depth::Bits16) => " (32768 is exactly zero)",
        (Encoding::Unorm, _) => " (no code is exactly zero)",
        _ => "",
    };
    format!("{} {}{zero}", format.encoding, format.depth)
}
