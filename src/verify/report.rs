//! What was found.

use super::agreement::{Agreement, Bound};
use super::options::Options;
use serde::Serialize;

/// What verification found, on each device.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The version of texbake.
    pub version: &'static str,
    /// What all inputs were made from.
    pub seed: u64,
    /// Whether every pair of options was verified, as [`Options::full`] says.
    pub full: bool,
    /// Whether somebody stopped it: devices that would have followed are missing.
    pub interrupted: bool,
    /// Whether kernels were changed first, to see that it is noticed.
    pub sabotaged: bool,
    /// Each device.
    pub devices: Vec<DeviceReport>,
}

/// What was found on one device.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviceReport {
    /// Its name, as [`crate::Baker::name`] gives it, or what was asked for.
    pub device: String,
    /// Each operation in each precision.
    pub comparisons: Vec<Comparison>,
    /// Why the device could not be verified, or not to the end.
    pub failure: Option<String>,
}

/// What was found of one operation in one precision.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// What was computed.
    pub operation: &'static str,
    /// `exact`: every bit must agree; `fast`: all within the bound.
    pub precision: String,
    /// Jobs that ran.
    pub cases: u64,
    /// Jobs with a difference, of `fast` one beyond the bound.
    pub failed_cases: u64,
    /// How the answers agree with the specification's.
    pub agreement: Agreement,
    /// The documented bound of `fast`.
    pub bound: Option<Bound>,
    /// The first failure, shrunk.
    pub mismatch: Option<Mismatch>,
}

/// The smallest input that fails, and what each says of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mismatch {
    /// The case in which it was found.
    pub case: String,
    /// The input in full.
    pub input: String,
    /// Where the answers differ: `normal, column 3, row 0, x`.
    pub place: String,
    /// The device's answer; `None` if it gives none any more.
    pub device: Option<Stored>,
    /// The answer of the vectorised CPU.
    pub cpu: Option<Stored>,
    /// The answer of the specification, which is plain scalar code.
    pub specification: Option<Stored>,
    /// The formula in whole numbers of any size, where they can say it: not of tangents, nor of the z that float maps
    /// of two channels leave out.
    pub oracle: Option<OracleAnswer>,
    /// What repeats the case.
    pub command: String,
}

/// What is stored.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Stored {
    /// The number: of snorm with its sign.
    pub number: f64,
    /// Its bits.
    pub bits: u32,
}

/// What the formula gives in whole numbers of any size.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct OracleAnswer {
    /// The component, to twelve digits after the point.
    pub component: String,
    /// The bits that store the nearest integer code; `None` for floats.
    pub bits: Option<u32>,
}

impl Report {
    /// Of no device yet.
    pub fn new(options: &Options, sabotaged: bool) -> Self {
        let (seed, full) = (options.seed, options.full);
        Self { version: env!("CARGO_PKG_VERSION"), seed, full, interrupted: false, sabotaged, devices: Vec::new() }
    }

    /// Whether every comparison of every device found something: what must be if it was sabotaged.
    pub fn is_noticed(&self) -> bool {
        let is_noticed = |device: &DeviceReport| {
            let all_failed = device.comparisons.iter().all(|comparison| comparison.failed_cases > 0);
            device.failure.is_none() && !device.comparisons.is_empty() && all_failed
        };
        !self.interrupted && !self.devices.is_empty() && self.devices.iter().all(is_noticed)
    }

    /// Cases that ran, on all devices.
    pub fn cases(&self) -> u64 {
        self.devices.iter().flat_map(|device| &device.comparisons).map(|comparison| comparison.cases).sum()
    }

    /// Whether there is a device, every device has passed, and none is missing.
    pub fn passed(&self) -> bool {
        !self.interrupted && !self.devices.is_empty() && self.devices.iter().all(DeviceReport::passed)
    }
}

impl DeviceReport {
    /// Of a device that could not be opened.
    pub fn failed(device: String, reason: String) -> Self {
        Self { device, comparisons: Vec::new(), failure: Some(reason) }
    }

    /// Whether all of it was verified, and nothing differs.
    pub fn passed(&self) -> bool {
        self.failure.is_none() && !self.comparisons.is_empty() && self.comparisons.iter().all(Comparison::passed)
    }
}

impl Comparison {
    /// Whether values were compared, and no case failed.
    pub fn passed(&self) -> bool {
        self.agreement.values > 0 && self.failed_cases == 0
    }
}
