//! The GPUs that RADV compiles for here, and their published figures.

/// One graphics card. Seconds come from peaks, of clock and memory alike, as in every roofline.
#[derive(Debug)]
pub struct Part {
    /// What `RADV_FORCE_FAMILY` and the kept figures call the chip.
    pub family: &'static str,
    /// The card.
    pub name: &'static str,
    /// Compute units.
    pub units: f64,
    /// SIMDs of a compute unit, each of which issues one vector instruction at a time.
    pub simds_per_unit: f64,
    /// Boost clock in GHz.
    pub clock: f64,
    /// Memory bandwidth in GB/s.
    pub bandwidth: f64,
    /// Cycles that 64 invocations of a full-rate vector instruction hold a SIMD: four on GCN's 16 lanes, two on RDNA's 32.
    pub full_rate: u64,
    /// The same of a 32-bit integer product, of a quarter of the rate.
    pub product: u64,
}

/// Units, clocks and bandwidths: AMD's product pages (amd.com, specifications of Radeon RX Vega 64, RX 6900 XT, RX 7900
/// XTX). SIMDs and their lanes: AMD's Vega ISA reference and RDNA white paper.
pub const PARTS: [Part; 3] = [
    Part {
        family: "VEGA10",
        name: "RX Vega 64",
        units: 64.0,
        simds_per_unit: 4.0,
        clock: 1.546,
        bandwidth: 483.8,
        full_rate: 4,
        product: 16,
    },
    Part {
        family: "NAVI21",
        name: "RX 6900 XT",
        units: 80.0,
        simds_per_unit: 2.0,
        clock: 2.25,
        bandwidth: 512.0,
        full_rate: 2,
        product: 8,
    },
    Part {
        family: "GFX1100",
        name: "RX 7900 XTX",
        units: 96.0,
        simds_per_unit: 2.0,
        clock: 2.5,
        bandwidth: 960.0,
        full_rate: 2,
        product: 8,
    },
];

impl Part {
    /// Picoseconds of arithmetic for an item that takes so many cycles of one SIMD.
    pub fn arithmetic(&self, cycles: f64) -> f64 {
        1e3 * cycles / (self.units * self.simds_per_unit * self.clock)
    }

    /// Picoseconds for an item that moves so many bytes.
    pub fn memory(&self, bytes: f64) -> f64 {
        1e3 * bytes / self.bandwidth
    }
}
