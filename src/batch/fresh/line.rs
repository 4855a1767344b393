//! What is remembered of one bake.

use super::content::Content;
use super::key::Key;
use crate::baker::{Baked, Ran};
use crate::exact::AxisScale;
use crate::map::{HeightType, Size};
use serde::{Deserialize, Serialize};

/// A line of the record: one texture that was baked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Line {
    pub outputs: Vec<Output>,
    /// [`super::KERNEL_VERSION`] at that time.
    pub kernel: u32,
    pub options: Key,
    /// In the order of the job's inputs.
    pub inputs: Vec<Content>,
    pub baked: BakedLine,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// A file that was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Output {
    /// Its path below the record's folder, as [`super::record::name`] writes it.
    pub name: String,
    #[serde(flatten)]
    pub content: Content,
}

/// How it was baked, for reports.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Fields", into = "Fields")]
pub(super) struct BakedLine(pub Baked);

#[derive(Serialize, Deserialize)]
struct Fields {
    width: usize,
    height: usize,
    depth: String,
    /// Numerators of x and y, and their denominator.
    scale: (i32, i32, u32),
    scale_is_exact: bool,
    backend: String,
    device: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fallback: Option<String>,
}

impl From<BakedLine> for Fields {
    fn from(BakedLine(baked): BakedLine) -> Self {
        let Baked { ran: Ran { backend, device, fallback }, size, height_type, scale } = baked;
        let AxisScale { x, y, q, exact } = scale;
        Self {
            width: size.width(),
            height: size.height(),
            depth: height_type.to_string(),
            scale: (x, y, q),
            scale_is_exact: exact,
            backend: backend.into(),
            device,
            fallback,
        }
    }
}

impl TryFrom<Fields> for BakedLine {
    type Error = String;

    fn try_from(fields: Fields) -> Result<Self, String> {
        let Fields { width, height, depth, scale: (x, y, q), scale_is_exact: exact, backend, device, fallback } =
            fields;
        if q == 0 {
            return Err("a scale over zero".into());
        }
        let types = [HeightType::U8, HeightType::U16, HeightType::F32];
        let height_type = types.into_iter().find(|kind| kind.to_string() == depth).ok_or("an unknown depth")?;
        let backend = ["cpu", "gpu"].into_iter().find(|kind| *kind == backend).ok_or("an unknown backend")?;
        Ok(Self(Baked {
            ran: Ran { backend, device, fallback },
            size: Size::new(width, height).map_err(|error| error.to_string())?,
            height_type,
            scale: AxisScale { x, y, q, exact },
        }))
    }
}
