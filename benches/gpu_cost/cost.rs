//! What a compiled kernel costs, as the driver says it, in one line of a table.

use crate::radv::Radv;
use crate::spirv;
use std::collections::BTreeMap;
use texbake::gpu::KernelVariant;

/// Of one kernel on one part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    pub instructions: u64,
    pub vgprs: u64,
    pub sgprs: u64,
    /// Registers that did not fit, scalar and vector.
    pub spills: u64,
    /// Bytes of memory that an invocation needs besides registers.
    pub scratch: u64,
    /// Bytes of a workgroup's shared memory.
    pub lds: u64,
    /// Waves that a SIMD holds at a time.
    pub waves: u64,
    /// Cycles of one SIMD for 64 invocations, when enough waves are in flight; loops of known turns unrolled.
    pub throughput: u64,
    /// Cycles from the first instruction of a wave to its last, likewise.
    pub latency: u64,
}

/// How much of what ACO counts for the integers of kernels/shared/estimate.wgsl a bake executes.
///
/// They decide where an estimate is in doubt. ACO takes two nested branches of four unrolled turns as 4 (3 / 4)^2
/// executions. A code of 8 bits is in doubt in 2^-10 of cases, and a wave takes a turn if one of its 64 lanes must.
/// Codes of 16 bits are in doubt far less often.
fn doubtful(kernel: &KernelVariant) -> f64 {
    let constant =
        |name| kernel.constants.iter().find(|constant| constant.0 == name).map_or(0.0, |constant| constant.1);
    let codes_of_8_bits = [
        if constant("NORMAL_BITS") == 8.0 { constant("NORMAL_CODES") } else { 0.0 },
        if constant("PARALLAX_BITS") == 8.0 { 1.0 } else { 0.0 },
    ];
    let turn = 1.0 - (1.0 - 1.0 / 1024.0_f64).powf(64.0 * codes_of_8_bits.iter().sum::<f64>());
    4.0 * turn / (4.0 * 0.75 * 0.75)
}

/// A kernel whose estimates are never in doubt, if it is one that estimates.
fn without_doubt(kernel: &KernelVariant) -> Result<Option<KernelVariant>, String> {
    const DOUBT: &str = "if (any(doubtful)) {";
    if !kernel.constants.contains(&("ESTIMATED", 1.0)) {
        return Ok(None);
    }
    if kernel.wgsl.matches(DOUBT).count() != 1 {
        return Err(format!("the text has not one {DOUBT:?}"));
    }
    Ok(Some(KernelVariant { wgsl: kernel.wgsl.replace(DOUBT, "if (false) {"), ..kernel.clone() }))
}

impl Cost {
    /// Names of the numbers, in the order of a line.
    pub const COLUMNS: [&str; 9] =
        ["instructions", "vgprs", "sgprs", "spills", "scratch", "lds", "waves", "throughput", "latency"];

    /// Compiles a kernel as it is and, for the cycles, with its loops unrolled.
    pub fn of(radv: &Radv, kernel: &KernelVariant, listing: bool) -> Result<Self, String> {
        let words = spirv::of(kernel)?;
        let shipped = radv.compile(&words, kernel.entry_point, listing)?;
        let unrolled = radv.compile(&spirv::unrolled(&words), kernel.entry_point, false)?;
        let mut cost = Self::read(&shipped, &unrolled)?;
        if let Some(sure) = without_doubt(kernel)? {
            let sure = radv.compile(&spirv::unrolled(&spirv::of(&sure)?), kernel.entry_point, false)?;
            let sure = Self::read(&shipped, &sure)?;
            let doubtful = doubtful(kernel);
            let mix = |sure: u64, all: u64| sure + (doubtful * all.saturating_sub(sure) as f64).ceil() as u64;
            cost.throughput = mix(sure.throughput, cost.throughput);
            cost.latency = mix(sure.latency, cost.latency);
        }
        Ok(cost)
    }

    fn read(shipped: &BTreeMap<String, u64>, unrolled: &BTreeMap<String, u64>) -> Result<Self, String> {
        let number = |of: &BTreeMap<String, u64>, name: &str| {
            of.get(name).copied().ok_or_else(|| format!("the driver tells no {name:?}, only {:?}", of.keys()))
        };
        Ok(Self {
            instructions: number(shipped, "Instructions")?,
            vgprs: number(shipped, "VGPRs")?,
            sgprs: number(shipped, "SGPRs")?,
            spills: number(shipped, "Spilled SGPRs")? + number(shipped, "Spilled VGPRs")?,
            scratch: number(shipped, "Scratch size")?,
            lds: number(shipped, "LDS size")?,
            waves: number(shipped, "Subgroups per SIMD")?,
            throughput: number(unrolled, "Inverse Throughput")?,
            latency: number(unrolled, "Latency")?,
        })
    }

    /// The numbers, separated by tabs.
    pub fn line(&self) -> String {
        self.numbers().map(|number| number.to_string()).join("\t")
    }

    /// Reads what [`Cost::line`] wrote.
    pub fn parse(line: &str) -> Option<Self> {
        let numbers: Vec<u64> = line.split('\t').map(|number| number.parse().ok()).collect::<Option<_>>()?;
        let [instructions, vgprs, sgprs, spills, scratch, lds, waves, throughput, latency] = numbers.try_into().ok()?;
        Some(Self { instructions, vgprs, sgprs, spills, scratch, lds, waves, throughput, latency })
    }

    pub fn numbers(&self) -> [u64; Self::COLUMNS.len()] {
        let Self { instructions, vgprs, sgprs, spills, scratch, lds, waves, throughput, latency } = *self;
        [instructions, vgprs, sgprs, spills, scratch, lds, waves, throughput, latency]
    }

    /// Whether registers did not suffice.
    pub fn spills(&self) -> bool {
        self.spills > 0 || self.scratch > 0
    }
}
