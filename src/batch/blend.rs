//! Two normal maps that become one.

use super::job::create_folder_of;
use super::mask::MaskInput;
use super::normals::{Degenerate, NormalInput};
use super::outcome::Outcome;
use super::report::{RunReport, as_text};
use super::role::{Role, check_same_size};
use super::targets::{self, Files};
use crate::baker::{Baker, Blended};
use crate::error::{Error, Result};
use crate::io::{WriteOptions, create_normals_with};
use crate::map::{NormalFormat, Size};
use crate::ops::blend::{BlendInputs, BlendOptions};
use crate::stream::{Monitor, NormalRows};
use serde::Serialize;
use std::cell::Cell;
use std::path::PathBuf;
use std::sync::Arc;

/// Two normal map files to blend.
#[derive(Clone)]
pub struct BlendJob {
    /// The first normal map; its size is the result's.
    pub base: NormalInput,
    /// The second normal map.
    pub detail: NormalInput,
    /// The transition of each texel, for [`crate::BlendMethod::Masked`].
    pub mask: Option<MaskInput>,
    /// The normal map file that is written; its folders are created.
    pub output: PathBuf,
    /// How they are blended.
    pub options: BlendOptions,
    /// How the output is written.
    pub write: WriteOptions,
    /// Where it runs.
    pub baker: Arc<Baker>,
}

/// What became of a blend.
#[derive(Debug)]
pub struct BlendOutcome {
    /// How it ran, and what the user should know about the files.
    pub outcome: Outcome<Blended>,
    /// What the codes of the first and of the second map mean, and what was counted in them.
    pub inputs: [LayerFacts; 2],
}

/// What was found in a normal map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LayerFacts {
    /// What its codes mean; `None` if it was never opened.
    pub format: Option<NormalFormat>,
    /// Texels that are no normals of a height map.
    pub degenerate: Degenerate,
}

impl BlendJob {
    /// What it reads and writes.
    pub fn files(&self) -> Files<'_> {
        let mask = self.mask.iter().map(|mask| mask.path.as_path());
        let inputs = [&self.base, &self.detail].into_iter().map(|input| input.path.as_path()).chain(mask).collect();
        Files { inputs, outputs: vec![&self.output] }
    }

    /// Why it failed, with the names of the files; `None` if it did not.
    pub fn failure(&self, outcome: &Outcome<Blended>) -> Option<String> {
        match (&outcome.result, &self.mask) {
            // Of the files only the mask holds heights.
            (Err(Error::NotFinite { .. }), Some(mask)) => outcome.failure(mask.path.display()),
            _ => outcome.failure(format_args!("{} and {}", self.base.path.display(), self.detail.path.display())),
        }
    }

    /// Blends the files; `opened` is told the size of the result. An output that would overwrite an input is refused.
    pub fn run(&self, monitor: &Monitor, opened: &dyn Fn(Size)) -> BlendOutcome {
        let files = self.files();
        if let Some(refusal) = targets::refusals(std::slice::from_ref(&files)).into_iter().flatten().next() {
            return BlendOutcome { outcome: Outcome::unopened(refusal.error()), inputs: Default::default() };
        }
        let layers = [self.base.watch(Role::Base), self.detail.watch(Role::Detail)];
        let outcome = Outcome::of(&files, |warnings| {
            let mask = self.mask.as_ref().map(MaskInput::watch);
            let cut = Cell::new(None);
            let open = || {
                let [base, detail] = [layers[0].open()?, layers[1].open()?];
                let mask = mask.as_ref().map(|mask| mask.open()).transpose()?;
                self.check_sizes(base.size(), detail.size(), mask.as_ref().map(|mask| mask.size()))?;
                self.check_tile(&base, &detail)?;
                cut.set(Some([detail.size(), base.size()]));
                opened(base.size());
                Ok(BlendInputs { base, detail, mask })
            };
            let create = |size| {
                create_folder_of(&self.output)?;
                Ok(create_normals_with(&self.output, size, self.options.format, &self.write)?.rows)
            };
            let blended = self.baker.blend_rows(&open, &create, &self.options, monitor);
            let all_read = blended.is_ok();
            warnings.extend(layers.iter().flat_map(|layer| layer.warnings(all_read)));
            warnings.extend(mask.iter().flat_map(|mask| mask.warnings(all_read)));
            warnings.extend(cut.get().filter(|_| all_read).and_then(|[detail, base]| self.cut(detail, base)));
            warnings.extend(blended.as_ref().ok().and_then(inexact_weights));
            blended
        });
        let facts =
            |index: usize| LayerFacts { format: layers[index].format(), degenerate: layers[index].degenerate() };
        BlendOutcome { outcome, inputs: [facts(0), facts(1)] }
    }

    /// Fails if a map does not lie over the first one texel by texel.
    fn check_sizes(&self, base: Size, detail: Size, mask: Option<Size>) -> Result<()> {
        let first = (self.base.path.as_path(), base);
        if !self.options.tile {
            let remedy = "give a map of the same size, or repeat a smaller one over the first with --tile";
            check_same_size(first, (&self.detail.path, detail), remedy)?;
        }
        let mask = self.mask.as_ref().zip(mask);
        mask.map_or(Ok(()), |(mask, size)| check_same_size(first, (&mask.path, size), "give a mask of the same size"))
    }

    /// Says so if the map that tiles does not end with the first one.
    fn cut(&self, detail: Size, base: Size) -> Option<String> {
        let sides =
            [("right", detail.width(), base.width(), "width"), ("bottom", detail.height(), base.height(), "height")];
        let cut = sides.into_iter().filter(|(_, detail, base, _)| base % detail != 0);
        let cut: Vec<String> = cut
            .map(|(edge, detail, base, side)| {
                format!("at the {edge} edge (its {side} {detail} does not divide {base})")
            })
            .collect();
        (!cut.is_empty()).then(|| format!("{}: it is cut {}", self.detail.path.display(), cut.join(" and ")))
    }

    /// Fails if the second map has to be held in memory, and is above the limit.
    fn check_tile(&self, base: &NormalRows, detail: &NormalRows) -> Result<()> {
        let (size, limit) = (detail.size(), self.detail.read.max_bytes);
        let bytes = size.texels() as u64 * detail.format().texel().bytes() as u64;
        if !self.options.tile || size == base.size() || bytes <= limit {
            return Ok(());
        }
        let (width, height) = (size.width() as u64, size.height() as u64);
        Err(Error::TooLarge { path: self.detail.path.clone(), width, height, bytes, limit })
    }
}

/// Says so if the weights had to be rounded.
fn inexact_weights(blended: &Blended) -> Option<String> {
    let weights = blended.weights.filter(|weights| !weights.exact)?;
    Some(format!("the weights have too many digits: {weights}, the nearest ones that fit, were used"))
}

/// A blend, for other programs: JSON.
#[derive(Debug, Clone, Serialize)]
pub struct BlendReport {
    /// Version of texbake.
    pub version: &'static str,
    /// The first normal map.
    pub base: LayerReport,
    /// The second normal map.
    pub detail: LayerReport,
    /// The mask file.
    pub mask: Option<String>,
    /// The channel of the mask that was read.
    pub mask_channel: Option<String>,
    /// The blended map's file.
    #[serde(serialize_with = "as_text")]
    pub output: PathBuf,
    /// The formula, by its name on the command line.
    pub method: String,
    /// The weights that were used.
    pub weights: Option<UsedWeights>,
    /// Whether the second map repeats.
    pub tile: bool,
    /// What the codes of the result mean.
    pub format: FormatReport,
    /// Exact or fast.
    pub precision: String,
    /// How it went.
    #[serde(flatten)]
    pub run: RunReport,
}

/// A normal map that went into a blend.
#[derive(Debug, Clone, Serialize)]
pub struct LayerReport {
    /// The file.
    #[serde(serialize_with = "as_text")]
    pub file: PathBuf,
    /// How its codes were read; null if it was never opened.
    pub format: Option<FormatReport>,
    /// What was counted in it.
    #[serde(flatten)]
    pub degenerate: Degenerate,
}

/// What the codes of a normal map mean, by the names of the command line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FormatReport {
    /// How a component becomes a code.
    pub encoding: String,
    /// How a code is stored.
    pub bits: String,
    /// Which components there are.
    pub channels: String,
    /// Which way green points.
    pub convention: String,
}

/// The weights that a blend used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UsedWeights {
    /// Both, as integers, short decimals or ratios: `1,-0.5`.
    pub used: String,
    /// Whether they are those that were asked for.
    pub exact: bool,
}

impl BlendReport {
    /// What `job` came to; `method` is its formula's name on the command line.
    pub fn new(job: &BlendJob, method: &str, outcome: &BlendOutcome) -> Self {
        let BlendOutcome { outcome, inputs } = outcome;
        let layer = |input: &NormalInput, facts: &LayerFacts| LayerReport {
            file: input.path.clone(),
            format: facts.format.map(FormatReport::from),
            degenerate: facts.degenerate,
        };
        let blended = outcome.result.as_ref().ok();
        let weights = blended.and_then(|blended| blended.weights);
        let mask = job.mask.as_ref();
        Self {
            version: env!("CARGO_PKG_VERSION"),
            base: layer(&job.base, &inputs[0]),
            detail: layer(&job.detail, &inputs[1]),
            mask: mask.map(|mask| mask.path.display().to_string()),
            mask_channel: mask.and_then(|mask| mask.read.channel.as_ref()).map(ToString::to_string),
            output: job.output.clone(),
            method: method.to_owned(),
            weights: weights.map(|weights| UsedWeights { used: weights.to_string(), exact: weights.exact }),
            tile: job.options.tile,
            format: job.options.format.into(),
            precision: job.options.precision.to_string(),
            run: RunReport::of_maps(
                outcome,
                blended.map(|blended| (&blended.ran, blended.size)),
                &job.baker,
                job.failure(outcome),
            ),
        }
    }
}

impl From<NormalFormat> for FormatReport {
    fn from(format: NormalFormat) -> Self {
        Self {
            encoding: format.encoding.to_string(),
            bits: format.depth.to_string(),
            channels: format.channels.to_string(),
            convention: format.convention.to_string(),
        }
    }
}
