//! What a plan says of a height map's maps, for a later check.

use super::file_plan::slashed;
use super::scene::Facts;
use super::text::{Text, document, named, named_option};
use super::view::Seen;
use crate::error::{Error, Result};
use crate::exact::{Rational, Scale};
use crate::io::{Channel, ColorSpace, RawLayout, ReadOptions};
use crate::map::{Channels, Convention, Depth, Edges, Encoding, NormalFormat, ParallaxFormat};
use crate::material::ParallaxMethod;
use crate::measure::Errors;
use crate::names;
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, Filter};
use serde::{Deserialize, Serialize, Serializer};
use std::path::Path;

/// A prediction: one `[[plan]]` of a settings file.
///
/// It has the material as the scene has it, not as it is baked: a bake with other settings breaks it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Prediction {
    /// The height map's path below the folder that is baked, with `/`.
    pub file: String,
    /// By which factor the height map is reduced.
    pub shrink: u32,
    /// Whether all devices make the same bytes of it.
    #[serde(with = "named")]
    pub precision: Precision,
    /// How a shader comes to tangent space.
    #[serde(with = "named")]
    pub tangent_space: TangentSpace,
    /// What the height map means.
    pub material: MaterialFacts,
    /// From where it is seen.
    pub seen: Seen,
    /// The normals.
    pub normal: NormalPrediction,
    /// The parallax.
    pub parallax: ParallaxPrediction,
}

/// How a shader comes to tangent space.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TangentSpace {
    /// By tangents at the vertices.
    Tangents,
    /// By the derivatives at each pixel.
    CotangentFrame,
    /// Not at all: there is no normal map.
    None,
}

names::named! {
    TangentSpace "tangent-space" {
        Tangents = "tangents",
        CotangentFrame = "cotangent frame",
        None = "none"
    }
}

/// What a height map means, by the names of the command line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct MaterialFacts {
    scale: Option<Text<Rational>>,
    size: Option<[Text<Rational>; 2]>,
    depth: Option<Text<Rational>>,
    filter: Text<Filter>,
    edge: Text<Edges>,
    convention: Text<Convention>,
    channel: Option<String>,
    color_space: Text<ColorSpace>,
    raw: Option<Text<RawLayout>>,
}

/// How far the normals that a scene shows may be from the height map's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct NormalPrediction {
    /// The map, if there is one.
    pub map: Option<MapPrediction>,
    /// The largest error in degrees, as it was measured.
    #[serde(serialize_with = "above_zero")]
    pub degrees: f64,
    /// What the scene allows.
    pub tolerance: f64,
}

/// How far the offsets that a scene shows may be from relief intersection; without parallax, the largest that there is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct ParallaxPrediction {
    /// The map, if there is one.
    pub map: Option<MapPrediction>,
    /// The largest error of a texel of the map, of values from -1 to 1, as it was measured.
    pub value: Option<f64>,
    /// What the shader does: `none`, `limited`, `steps 4`, `relief 64+5`.
    #[serde(with = "super::method")]
    pub method: ParallaxMethod,
    /// The error in pixels, as it was measured.
    #[serde(serialize_with = "above_zero")]
    pub pixels: f64,
    /// Of which pixels it is.
    pub of: ErrorOf,
    /// What the scene allows.
    pub tolerance: f64,
    /// What a screen full of it took, if that is bounded. No check measures it again: it is another machine's.
    pub milliseconds: Option<f64>,
}

/// Which of many errors counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorOf {
    /// The largest.
    All,
    /// What 99 of 100 do not exceed.
    #[serde(rename = "99 of 100")]
    Most,
}

impl ErrorOf {
    pub(super) fn errors(self, errors: Errors) -> f64 {
        match self {
            Self::All => errors.largest,
            Self::Most => errors.percentile_99,
        }
    }

    /// After "off by so much".
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::All => "at most",
            Self::Most => "at most in 99 of 100",
        }
    }
}

/// A map file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct MapPrediction {
    /// Its extension.
    pub format: String,
    /// Columns and rows.
    pub texels: [usize; 2],
    /// How a value becomes a code.
    #[serde(with = "named")]
    pub encoding: Encoding,
    /// How a code is stored.
    #[serde(with = "named")]
    pub bits: Depth,
    /// Which components a normal map has.
    #[serde(default, with = "named_option")]
    pub channels: Option<Channels>,
    /// Bytes of its codes, uncompressed.
    pub bytes: usize,
}

/// Zero is written as 0.0, never as -0.0.
fn above_zero<S: Serializer>(error: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(error + 0.0)
}

/// The predictions of a settings file; its other keys are not looked at.
///
/// # Errors
/// [`Error::File`] with file and line.
pub fn predictions(path: &Path, text: &str) -> Result<Vec<Prediction>> {
    #[derive(Deserialize)]
    struct Predictions {
        #[serde(default)]
        plan: Vec<Prediction>,
    }
    document::<Predictions>(path, text, "run texbake plan again").map(|predictions| predictions.plan)
}

impl Prediction {
    /// Whether it is of the file at this path below the folder that is baked.
    pub fn is_of(&self, file: &Path) -> bool {
        self.file == slashed(file)
    }

    /// What a bake with these settings does otherwise than the plan, in words.
    pub fn other_settings(&self, read: &ReadOptions, bake: &BakeOptions) -> Vec<String> {
        let Ok(Facts { read: planned, scale, filter, edges, .. }) = self.material.facts() else { return Vec::new() };
        let channel = |read: &ReadOptions| read.channel.as_ref().map_or("none".into(), Channel::to_string);
        let raw = |read: &ReadOptions| read.raw.map_or("none".into(), |raw| raw.to_string());
        let scale_of = |scale: Scale| match scale {
            Scale::Texels(scale) => scale.to_string(),
            Scale::Physical { size: [width, height], depth } => format!("{depth} over {width} x {height}"),
        };
        [
            ("scale", scale_of(bake.scale), scale_of(scale)),
            ("shrink", read.shrink.to_string(), self.shrink.to_string()),
            ("precision", bake.precision.to_string(), self.precision.to_string()),
            ("filter", bake.filter.to_string(), filter.to_string()),
            ("edge", bake.edges.to_string(), edges.to_string()),
            ("channel", channel(read), channel(&planned)),
            ("color-space", read.color_space.to_string(), planned.color_space.to_string()),
            ("raw", raw(read), raw(&planned)),
        ]
        .into_iter()
        .filter(|(_, baked, planned)| baked != planned)
        .map(|(setting, baked, planned)| format!("{setting} is {baked}, and the plan has {planned}"))
        .collect()
    }
}

impl MaterialFacts {
    /// As options of `bake`.
    pub(super) fn settings(&self) -> Vec<(&'static str, String)> {
        let Self { scale, size, depth, filter, edge, convention, channel, color_space, raw } = self;
        let size = size.map(|[Text(width), Text(height)]| format!("{width}x{height}"));
        let number = |number: &Option<Text<Rational>>| number.as_ref().map(|Text(number)| number.to_string());
        let settings = [
            ("scale", number(scale)),
            ("size", size),
            ("depth", number(depth)),
            ("filter", Some(filter.0.to_string())),
            ("edge", Some(edge.0.to_string())),
            ("convention", Some(convention.0.to_string())),
            ("channel", channel.clone()),
            ("color-space", Some(color_space.0.to_string())),
            ("raw", raw.as_ref().map(|Text(raw)| raw.to_string())),
        ];
        settings.into_iter().filter_map(|(key, value)| Some((key, value?))).collect()
    }

    pub(super) fn new(facts: &Facts) -> Self {
        let Facts { read, scale, filter, edges, convention } = facts;
        let (scale, size, depth) = match *scale {
            Scale::Texels(scale) => (Some(Text(scale)), None, None),
            Scale::Physical { size, depth } => (None, Some(size.map(Text)), Some(Text(depth))),
        };
        Self {
            scale,
            size,
            depth,
            filter: Text(*filter),
            edge: Text(*edges),
            convention: Text(*convention),
            channel: read.channel.as_ref().map(Channel::to_string),
            color_space: Text(read.color_space),
            raw: read.raw.map(Text),
        }
    }

    pub(super) fn facts(&self) -> Result<Facts> {
        let scale = match (self.scale, self.size, self.depth) {
            (Some(Text(scale)), ..) => Scale::texels(scale),
            (None, Some([width, height]), Some(depth)) => Scale::physical(width.0, height.0, depth.0),
            _ => return Err(Error::parameter("scale", "missing", "a number, or size and depth")),
        };
        let channel = self.channel.as_ref().map(|name| match name.parse::<Channel>() {
            Ok(channel) => channel,
            Err(never) => match never {},
        });
        let (color_space, raw) = (self.color_space.0, self.raw.map(|Text(raw)| raw));
        let read = ReadOptions { channel, color_space, raw, ..ReadOptions::default() };
        let (filter, edges, convention) = (self.filter.0, self.edge.0, self.convention.0);
        Ok(Facts { read, scale, filter, edges, convention })
    }
}

impl MapPrediction {
    pub(super) fn normals(&self, convention: Convention) -> NormalFormat {
        let channels = self.channels.unwrap_or(Channels::Xyz);
        NormalFormat { encoding: self.encoding, depth: self.bits, channels, convention }
    }

    pub(super) fn parallax(&self) -> ParallaxFormat {
        ParallaxFormat { encoding: self.encoding, depth: self.bits }
    }
}
