//! The cases as a page: the same kernels, by another compiler and another implementation of WebGPU.

use super::page::{PageCase, page};
use super::sabotage;
use super::subject::Options;
use crate::backend::gpu::recording::Recording;
use crate::error::Result;
use std::collections::HashMap;

/// Cases of a page that compile one kernel with the same constants: browsers take long to compile.
const CASES_OF_A_KERNEL: u32 = 2;

/// One self-contained page that runs the cases of `options` by the WebGPU of the browser that opens it, and compares
/// what comes back with answers of the specification that the page contains. Of cases with one kernel and the same
/// constants it has two.
///
/// With `sabotage` a constant of each kernel is changed: the page must then report differences.
///
/// # Errors
/// [`crate::Error::Parameter`] if the options mean no case.
pub fn html_page(options: &Options, sabotage: bool) -> Result<String> {
    let mut cases = Vec::new();
    let mut compiled: HashMap<_, u32> = HashMap::new();
    for case in options.cases()? {
        let job = case.job(options.seed)?;
        for mut recording in Recording::of(|baker| job.run(baker))? {
            let kernels: Vec<_> = recording.passes.iter().map(|pass| (pass.name, pass.constants.clone())).collect();
            let count = compiled.entry(kernels).or_default();
            *count += 1;
            if *count > CASES_OF_A_KERNEL {
                continue;
            }
            if sabotage {
                recording.passes.iter_mut().for_each(|pass| pass.text = sabotage::changed(&pass.text));
            }
            cases.push(PageCase { name: case.name.clone(), recording });
        }
    }
    let kernels =
        if sabotage { "a constant of each is changed, so every case should differ" } else { "their own text" };
    let notes = [
        ("texbake", env!("CARGO_PKG_VERSION").to_owned()),
        ("seed", options.seed.to_string()),
        ("kernels", kernels.to_owned()),
    ];
    Ok(page(&notes, &cases))
}
