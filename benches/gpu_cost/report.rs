//! The tables.

use crate::cost::Cost;
use crate::figures::Figures;
use crate::part::{PARTS, Part};
use texbake::gpu::KernelVariant;

/// Everything, a block of lines for each kernel.
pub fn plain(kernels: &[KernelVariant], figures: &Figures) -> String {
    let mut text = format!("{}\n", figures.driver);
    for kernel in kernels {
        let bytes = kernel.bytes_read + kernel.bytes_written;
        let costs: Vec<(&Part, Cost)> = costs(kernel, figures).collect();
        if costs.is_empty() {
            continue;
        }
        text += &format!("\n{}: {bytes} bytes for each {}\n", kernel.name, kernel.item);
        for (part, cost) in costs {
            let Cost { instructions, vgprs, sgprs, spills, scratch, lds, waves, throughput, latency } = cost;
            text += &format!(
                "  {:11} {instructions:5} instructions  {vgprs:3} VGPRs  {sgprs:3} SGPRs  {spills} spills  {scratch} B \
                 scratch  {lds} B LDS  {waves:2} waves  throughput {throughput:5}  latency {latency:6}  {:7.2} cycles, \
                 {:6.1} ps, {:5.2} of memory's {:.1} ps\n",
                part.name,
                cycles(kernel, &cost),
                part.arithmetic(cycles(kernel, &cost)),
                share(part, kernel, &cost),
                part.memory(bytes),
            );
        }
    }
    text
}

/// The same for a document: cycles of a SIMD and the share of memory's time on each part.
pub fn markdown(kernels: &[KernelVariant], figures: &Figures) -> String {
    let names = PARTS.map(|part| part.name).join(" | ");
    let rule = PARTS.map(|_| "---:").join(" | ");
    let mut text = format!("| {} | bytes | VGPRs | {names} |\n| --- | ---: | ---: | {rule} |\n", figures.driver);
    for kernel in kernels {
        let costs: Vec<(&Part, Cost)> = costs(kernel, figures).collect();
        let Some(vgprs) = costs.iter().map(|(_, cost)| cost.vgprs).max() else { continue };
        let shares: Vec<String> = costs
            .iter()
            .map(|(part, cost)| format!("{:.1}, {:.2}", cycles(kernel, cost), share(part, kernel, cost)))
            .collect();
        let bytes = kernel.bytes_read + kernel.bytes_written;
        text += &format!("| {} | {bytes} | {vgprs} | {} |\n", kernel.name, shares.join(" | "));
    }
    text
}

/// The costs of a kernel, where it was compiled.
fn costs<'a>(kernel: &'a KernelVariant, figures: &'a Figures) -> impl Iterator<Item = (&'static Part, Cost)> {
    let cost = |part: &Part| figures.costs.get(&(part.family.to_string(), kernel.name.clone())).copied();
    PARTS.iter().filter_map(move |part| Some((part, cost(part)?)))
}

/// Cycles of one SIMD for an item.
fn cycles(kernel: &KernelVariant, cost: &Cost) -> f64 {
    cost.throughput as f64 / (64.0 * f64::from(kernel.items_per_invocation))
}

/// Arithmetic's time over memory's.
fn share(part: &Part, kernel: &KernelVariant, cost: &Cost) -> f64 {
    part.arithmetic(cycles(kernel, cost)) / part.memory(kernel.bytes_read + kernel.bytes_written)
}
