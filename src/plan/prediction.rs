//! What a plan says of a height map's maps, for a later check.

use super::scene::Facts;
use super::text::document;
use super::view::Seen;
use crate::error::{Error, Result};
use crate::exact::{Rational, Scale};
use crate::io::{Channel, ReadOptions};
use crate::map::{Channels, Convention, Depth, Encoding, NormalFormat, ParallaxFormat};
use crate::measure::Errors;
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
    /// `normal`, `parallax`, `normal,parallax` or `none`.
    pub maps: String,
    /// By which factor the height map is reduced.
    pub shrink: u32,
    /// `exact` or `fast`.
    pub precision: String,
    /// `tangents`, `cotangent frame` or `none`: how a shader comes to tangent space.
    pub tangent_space: String,
    /// What the height map means.
    pub material: MaterialFacts,
    /// From where it is seen.
    pub seen: Seen,
    /// The normals.
    pub normal: NormalPrediction,
    /// The parallax.
    pub parallax: ParallaxPrediction,
}

/// What a height map means, by the names of the command line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct MaterialFacts {
    scale: Option<String>,
    size: Option<[String; 2]>,
    depth: Option<String>,
    filter: String,
    edge: String,
    convention: String,
    channel: Option<String>,
    color_space: String,
    raw: Option<String>,
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
    /// What the shader does: `none`, `limited`, `steps 4`, `relief 64+5`.
    pub method: String,
    /// The error in pixels, as it was measured.
    #[serde(serialize_with = "above_zero")]
    pub pixels: f64,
    /// Of which pixels it is.
    pub of: ErrorOf,
    /// What the scene allows.
    pub tolerance: f64,
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
    pub encoding: String,
    /// How a code is stored.
    pub bits: String,
    /// Which components a normal map has.
    pub channels: Option<String>,
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
    document::<Predictions>(path, text).map(|predictions| predictions.plan)
}

impl MaterialFacts {
    /// As options of `bake`.
    pub(super) fn settings(&self) -> Vec<(&'static str, String)> {
        let size = self.size.as_ref().map(|[width, height]| format!("{width}x{height}"));
        let given = |key, value: &Option<String>| value.clone().map(|value| (key, value));
        let (filter, edge) = (("filter", self.filter.clone()), ("edge", self.edge.clone()));
        let (convention, color_space) =
            (("convention", self.convention.clone()), ("color-space", self.color_space.clone()));
        [given("scale", &self.scale), given("size", &size), given("depth", &self.depth), Some(filter), Some(edge)]
            .into_iter()
            .chain([Some(convention), given("channel", &self.channel), Some(color_space), given("raw", &self.raw)])
            .flatten()
            .collect()
    }

    pub(super) fn new(facts: &Facts) -> Self {
        let Facts { read, scale, filter, edges, convention } = facts;
        let (scale, size, depth) = match scale {
            Scale::Texels(scale) => (Some(scale.to_string()), None, None),
            Scale::Physical { size, depth } => (None, Some(size.map(|it| it.to_string())), Some(depth.to_string())),
        };
        Self {
            scale,
            size,
            depth,
            filter: filter.to_string(),
            edge: edges.to_string(),
            convention: convention.to_string(),
            channel: read.channel.as_ref().map(Channel::to_string),
            color_space: read.color_space.to_string(),
            raw: read.raw.map(|raw| raw.to_string()),
        }
    }

    pub(super) fn facts(&self) -> Result<Facts> {
        let scale = match (&self.scale, &self.size, &self.depth) {
            (Some(scale), ..) => Scale::texels(scale.parse::<Rational>()?),
            (None, Some([width, height]), Some(depth)) => {
                Scale::physical(width.parse()?, height.parse()?, depth.parse()?)
            }
            _ => return Err(Error::parameter("scale", "missing", "a number, or size and depth")),
        };
        let channel = self.channel.as_ref().map(|name| match name.parse::<Channel>() {
            Ok(channel) => channel,
            Err(never) => match never {},
        });
        let read = ReadOptions {
            channel,
            color_space: self.color_space.parse()?,
            raw: self.raw.as_ref().map(|raw| raw.parse()).transpose()?,
            ..ReadOptions::default()
        };
        let (filter, edges, convention) = (self.filter.parse()?, self.edge.parse()?, self.convention.parse()?);
        Ok(Facts { read, scale, filter, edges, convention })
    }
}

impl MapPrediction {
    pub(super) fn normals(&self, convention: Convention) -> Result<NormalFormat> {
        let channels = self.channels.as_deref().unwrap_or("xyz").parse::<Channels>()?;
        let (encoding, depth) = (self.encoding.parse::<Encoding>()?, self.bits.parse::<Depth>()?);
        Ok(NormalFormat { encoding, depth, channels, convention })
    }

    pub(super) fn parallax(&self) -> Result<ParallaxFormat> {
        Ok(ParallaxFormat { encoding: self.encoding.parse()?, depth: self.bits.parse()? })
    }
}
