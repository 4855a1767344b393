//! What was measured, with where, of what and how.

use super::{Figures, MeasureOptions};
use crate::baker::Baker;
use crate::error::Result;
use crate::map::HeightMap;
use serde::Serialize;

/// What was measured, with everything that says how it came about.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Version of texbake.
    pub version: &'static str,
    /// What was run, to run it again.
    pub command: String,
    /// What pixels are drawn from.
    pub seed: u64,
    /// Runs of which each time is the median.
    pub runs: usize,
    /// Whether less was measured.
    pub quick: bool,
    /// The map.
    pub input: Input,
    /// What ran it.
    pub machine: Machine,
    /// The figures.
    #[serde(flatten)]
    pub figures: Figures,
}

/// A map that was measured, and what it stands for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Input {
    /// The height map's file.
    pub heights: String,
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Type of the heights: `u8`, `u16`, `f32`.
    pub depth: String,
    /// The scale s in texels, along the rows and down them.
    pub scale_texels: [f64; 2],
    /// The slope stencil.
    pub filter: String,
    /// The edge mode, or those of x and y.
    pub edge: String,
    /// Which way green points.
    pub convention: String,
    /// The height map that is blended with it; null for its own quarter turn.
    pub detail: Option<String>,
}

/// What figures were measured on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Model of the processor, or its architecture where the system does not say.
    pub cpu: String,
    /// Threads that run at the same time.
    pub cores: usize,
    /// The operating system.
    pub system: &'static str,
    /// What baked.
    pub devices: Vec<String>,
}

impl Machine {
    /// This one.
    pub fn this(devices: &[Baker]) -> Self {
        Self {
            cpu: cpu_model().unwrap_or_else(|| std::env::consts::ARCH.into()),
            cores: std::thread::available_parallelism().map_or(1, Into::into),
            system: std::env::consts::OS,
            devices: devices.iter().map(Baker::name).collect(),
        }
    }
}

/// As Linux says it; Windows has it in an environment variable.
fn cpu_model() -> Option<String> {
    let of_linux = || {
        let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    of_linux().or_else(|| std::env::var("PROCESSOR_IDENTIFIER").ok())
}

impl Input {
    /// The map of the file `name`.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a scale out of range.
    pub fn new(name: String, heights: &HeightMap, detail: Option<String>, options: &MeasureOptions) -> Result<Self> {
        let size = heights.size();
        let axes = options.bake.scale.resolve(size)?;
        Ok(Self {
            heights: name,
            width: size.width(),
            height: size.height(),
            depth: heights.height_type().to_string(),
            scale_texels: [axes.x, axes.y].map(|part| f64::from(part) / f64::from(axes.q)),
            filter: options.bake.filter.to_string(),
            edge: options.bake.edges.to_string(),
            convention: options.convention.to_string(),
            detail,
        })
    }
}

impl Report {
    /// Of figures that `command` has measured.
    pub fn new(command: String, options: &MeasureOptions, input: Input, machine: Machine, figures: Figures) -> Self {
        let MeasureOptions { seed, runs, quick, .. } = *options;
        Self { version: env!("CARGO_PKG_VERSION"), command, seed, runs, quick, input, machine, figures }
    }
}
