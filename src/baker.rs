//! The front door: a backend, chosen once, that bakes maps.

use crate::backend::Backend;
use crate::backend::cpu::{Cpu, Reference};
use crate::error::{Error, Result};
use crate::exact::AxisScale;
use crate::map::{CodesMut, Edge, HeightDepth, HeightMap, NormalMap, Size};
use crate::ops::normal::{NormalOptions, NormalPlan};
use crate::stream::{
    BandReader, CodeSink, CodeWriter, HeightBands, MapBands, MapSink, Monitor, RowSink, RowSource, read_map,
};
use std::sync::Arc;

/// Bakes maps on one backend.
pub struct Baker {
    backend: Arc<dyn Backend>,
    reason: String,
}

/// How a bake ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Ran {
    /// What baked it.
    pub backend: String,
    /// Why another backend failed before, if one did.
    pub fallback: Option<String>,
    /// Size of the map.
    pub size: Size,
    /// How its heights are stored.
    pub depth: HeightDepth,
    /// The scale that was used, and whether it is the one that was asked for.
    pub scale: AxisScale,
}

/// A device that could run bakes.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// Name of the adapter, or `cpu`.
    pub name: String,
    /// `vulkan`, `gl`, `metal`, `dx12` or `cpu`.
    pub api: String,
    /// `discrete gpu`, `integrated gpu`, `virtual gpu`, `software` or `cpu`.
    pub kind: String,
    /// The driver and its version.
    pub driver: String,
    /// Whether the known-answer test passed; the reason if not.
    pub self_test: std::result::Result<(), String>,
    /// Whether `auto` picks this device.
    pub picked: bool,
    /// Why, or why not.
    pub reason: String,
}

/// Everything that could run bakes on this machine, in the order in which `auto` would choose.
pub fn devices() -> Vec<Device> {
    todo!()
}

/// Maps up to this many bytes are held in memory if they wrap from bottom to top; larger ones are read twice.
const HELD_BYTES: usize = 64 << 20;

impl Baker {
    /// A real GPU if there is one that passes its self-test, else the CPU. When a GPU fails during a job, the job
    /// runs again on the CPU.
    pub fn auto() -> Self {
        Self::cpu()
    }

    /// All cores, vectorised.
    pub fn cpu() -> Self {
        Self { backend: Arc::new(Cpu::new(None)), reason: "asked for".into() }
    }

    /// One GPU and nothing else: the adapter whose description contains `adapter`, or the best one.
    /// `vulkan:llvmpipe` names the API too.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if there is none, or it fails its self-test; later, if it fails during a job.
    pub fn gpu(_adapter: Option<&str>) -> Result<Self> {
        todo!()
    }

    /// The specification: plain scalar code on one thread, to compare with.
    pub fn reference() -> Self {
        Self { backend: Arc::new(Reference), reason: "asked for".into() }
    }

    /// What runs: the backend and its device.
    pub fn name(&self) -> String {
        self.backend.name()
    }

    /// Why this backend was chosen.
    pub fn reason(&self) -> &str {
        &self.reason
    }

    /// Bakes a height map into a normal map.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if an option is out of range.
    pub fn normal(&self, heights: &HeightMap, options: &NormalOptions) -> Result<NormalMap> {
        options.format.check()?;
        let mut map = NormalMap::zeroed(heights.size(), options.format);
        self.normal_into(heights, options, map.codes_mut())?;
        Ok(map)
    }

    /// Bakes a height map into the caller's memory: texel by texel, in rows from the top, x, y, z or x, y.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if an option is out of range, or `codes` is of another depth or length than the
    /// normal map.
    pub fn normal_into(&self, heights: &HeightMap, options: &NormalOptions, codes: CodesMut<'_>) -> Result<()> {
        let plan = NormalPlan::new(options, heights.size(), heights.depth())?;
        if codes.depth() != plan.format.depth {
            return Err(Error::parameter("depth of the codes", codes.depth(), format!("{}", plan.format.depth)));
        }
        let count = plan.size.texels() * plan.format.channels.count();
        if codes.len() != count {
            let range = format!("{count} for a map of {} with {}", plan.size, plan.format.channels);
            return Err(Error::parameter("number of codes", codes.len(), range));
        }
        let mut bands = MapBands::new(heights, plan.edges.y, self.backend.band_rows(&plan));
        self.backend.normal(&plan, &mut bands, &mut MapSink::new(codes, plan.row_codes()))
    }

    /// Bakes rows from `open` into rows for `create` while they are read and written.
    ///
    /// Both may be called again if a GPU fails and the job moves to the CPU; no row of the failed try is kept.
    ///
    /// # Errors
    /// What opening, reading, creating and writing report; [`crate::Error::Cancelled`] when `monitor` says so.
    pub fn normal_rows(
        &self,
        open: &dyn Fn() -> Result<Box<dyn RowSource>>,
        create: &dyn Fn(Size) -> Result<Box<dyn RowSink>>,
        options: &NormalOptions,
        monitor: &Monitor,
    ) -> Result<Ran> {
        let mut source = open()?;
        let plan = NormalPlan::new(options, source.size(), source.depth())?;
        let writer = CodeWriter::new(create(plan.size)?, plan.format.depth, plan.row_codes());
        let mut sink = Monitored { sink: writer, width: plan.size.width(), monitor };
        let band_rows = self.backend.band_rows(&plan);
        let wraps = plan.edges.y == Edge::Wrap;
        if wraps && plan.size.texels() * plan.depth.bytes() <= HELD_BYTES {
            let map = read_map(source.as_mut())?;
            self.backend.normal(&plan, &mut MapBands::new(&map, plan.edges.y, band_rows), &mut sink)?;
        } else {
            self.backend.normal(&plan, &mut BandReader::new(source, plan.edges.y, band_rows), &mut sink)?;
        }
        sink.sink.finish()?;
        Ok(Ran { backend: self.name(), fallback: None, size: plan.size, depth: plan.depth, scale: plan.scale })
    }
}

/// Counts what passes to a sink.
struct Monitored<'a> {
    sink: CodeWriter,
    width: usize,
    monitor: &'a Monitor,
}

impl CodeSink for Monitored<'_> {
    fn write(&mut self, rows: usize, fill: &mut dyn FnMut(&mut CodesMut<'_>) -> Result<()>) -> Result<()> {
        self.monitor.check()?;
        self.sink.write(rows, fill)?;
        self.monitor.add((rows * self.width) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Codes, Depth, Grid};

    #[test]
    fn normal_into_refuses_codes_that_do_not_fit() {
        let map = HeightMap::from(Grid::new(2, 2, vec![0u8, 1, 2, 3]).unwrap());
        let bake = |depth, count| {
            let mut codes = Codes::zeroed(depth, count);
            Baker::reference().normal_into(&map, &NormalOptions::default(), codes.as_mut()).map_err(|e| e.to_string())
        };
        assert_eq!(bake(Depth::Bits8, 12), Ok(()));
        assert_eq!(bake(Depth::Bits16, 12), Err("depth of the codes is 16: it must be 8".into()));
        let range = "number of codes is 11: it must be 12 for a map of 2 x 2 with xyz";
        assert_eq!(bake(Depth::Bits8, 11), Err(range.into()));
    }
}
