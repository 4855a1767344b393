//! What the kernels cost on real GPUs, without one: Mesa's RADV compiles for parts that are not there.
//!
//! ```text
//! cargo bench --bench gpu_cost                     # all kernels, compared with the kept figures
//! cargo bench --bench gpu_cost -- "bake u16"       # those with this in their name
//! cargo bench --bench gpu_cost -- --markdown       # the tables that README.md has
//! cargo bench --bench gpu_cost -- --keep           # writes figures.tsv
//! cargo bench --bench gpu_cost -- "bake u16 to 8-bit unorm xyz, exact" --listing NAVI21   # the instructions
//! ```
//!
//! Each kernel is translated to SPIR-V as wgpu does (spirv.rs) and compiled by RADV with `RADV_FORCE_FAMILY` for each
//! part; statistics come from VK_KHR_pipeline_executable_properties. A missing driver or part is an error. A kernel
//! that is dearer than in figures.tsv, or spills registers, fails the run; with another Mesa than the file's, only
//! spills do.
//!
//! **The unit.** RADV's "Inverse Throughput" is 1 / wave64_per_cycle of `collect_preasm_stats` in Mesa's
//! src/amd/compiler/aco_statistics.cpp (as read in 23.2; that another version counts so too is what calibration.rs
//! checks): cycles of **one SIMD for 64 invocations**. For
//! each resource of a SIMD (vector unit, scalar unit, memory instructions, ...) the cycles of all instructions of a wave
//! are added up (`get_perf_info`: of a vector instruction 4 on GCN's 16 lanes, 1 on RDNA's 32, which a wave of 64
//! invocations issues twice; four times as much for 32-bit integer products); the busiest resource decides, unless the
//! waves that fit on the SIMD are too few to hide latency. So an item takes
//!
//! ```text
//! seconds = throughput / (64 * items per invocation) / (compute units * SIMDs per unit * clock)
//! ```
//!
//! Which is checked on every run by kernels that differ by a known number of instructions (calibration.rs).
//!
//! **What the unit guesses.** A loop counts as 8 turns (4 inside another, 2 further inside), a side of a branch as 3 / 4
//! or 1 / 2. All loops of known turns are therefore unrolled by a hint before the cycles are counted, so that nothing is
//! guessed of them; the other statistics are of the kernel as it is. The integers that decide what an estimate leaves
//! open (kernels/shared/estimate.wgsl) count as often as they run on noise: cost.rs. The loops over a fan's corners stay and count 8
//! turns, where a closed mesh has 6 corners on average. GFX11's dual issue is not counted by Mesa 22.3.
//!
//! **Memory.** Bytes are those that a GPU moves if its caches lose nothing, over the card's bandwidth. Arithmetic as a
//! share of that time: below 1 memory is what a bake waits for.

mod calibration;
mod cost;
mod figures;
mod part;
mod radv;
mod report;
mod spirv;

use cost::Cost;
use figures::Figures;
use part::{PARTS, Part};
use radv::Radv;
use std::process::{Command, ExitCode};

/// What to do.
#[derive(Debug, Default)]
struct Arguments {
    filter: String,
    keep: bool,
    markdown: bool,
    /// The part to print instructions of.
    listing: Option<String>,
    /// The part that this process compiles for: the bench runs itself once for each.
    part: Option<String>,
}

fn main() -> ExitCode {
    let done = arguments().and_then(|arguments| match &arguments.part {
        Some(family) => compile_for(family, &arguments),
        None => run(&arguments),
    });
    done.map_or_else(
        |error| {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        },
        |()| ExitCode::SUCCESS,
    )
}

fn arguments() -> Result<Arguments, String> {
    let mut arguments = Arguments::default();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            // What cargo adds.
            "--bench" => {}
            "--keep" => arguments.keep = true,
            "--markdown" => arguments.markdown = true,
            "--listing" => arguments.listing = Some(words.next().ok_or("--listing needs a part")?),
            "--part" => arguments.part = Some(words.next().ok_or("--part needs a part")?),
            option if option.starts_with('-') => return Err(format!("{option} is no option of this bench")),
            _ => arguments.filter = word,
        }
    }
    if arguments.keep && !arguments.filter.is_empty() {
        return Err("--keep is for all kernels".into());
    }
    Ok(arguments)
}

/// Compiles for every part, and says what it costs.
fn run(arguments: &Arguments) -> Result<(), String> {
    if let Some(family) = &arguments.listing {
        let listing = compiled(family, arguments)?;
        return print_all(&listing);
    }
    let mut now = Figures::default();
    for part in &PARTS {
        let output = compiled(part.family, arguments)?;
        let (driver, lines) = output.split_once('\n').ok_or_else(|| format!("{}: nothing came back", part.family))?;
        now.driver = driver.into();
        for line in lines.lines() {
            let (key, cost) = figures::parse_line(line).ok_or_else(|| format!("{}: {line}", part.family))?;
            now.costs.insert(key, cost);
        }
    }
    let kernels = texbake::gpu::kernels().map_err(|error| error.to_string())?;
    let count = kernels.iter().filter(|kernel| kernel.name.contains(&arguments.filter)).count();
    if count == 0 || now.costs.len() != PARTS.len() * count {
        return Err(format!("{} costs of {count} kernels on {} parts", now.costs.len(), PARTS.len()));
    }
    print_all(&if arguments.markdown { report::markdown(&kernels, &now) } else { report::plain(&kernels, &now) })?;
    judge(&now, arguments.keep)
}

/// Compares with the kept figures, or keeps these.
fn judge(now: &Figures, keep: bool) -> Result<(), String> {
    let spilling: Vec<_> =
        now.costs.iter().filter(|(_, cost)| cost.spills()).map(|((part, name), _)| format!("{part}, {name}")).collect();
    if !spilling.is_empty() {
        return Err(format!("registers are spilled: {}", spilling.join("; ")));
    }
    if keep {
        return now.keep();
    }
    let kept = Figures::kept()?;
    if kept.driver != now.driver {
        println!("not compared: the kept figures are of {}, this is {}", kept.driver, now.driver);
        return Ok(());
    }
    let (lines, fails) = now.compare(&kept);
    println!("{} costs compared with the kept ones, {} differ", now.costs.len(), lines.len());
    lines.iter().for_each(|line| println!("{line}"));
    match fails {
        true => Err("kernels are dearer than kept, or new: make them cheaper, or say so with --keep".into()),
        false => Ok(()),
    }
}

/// What this bench prints when it runs with RADV alone, for one part.
fn compiled(family: &str, arguments: &Arguments) -> Result<String, String> {
    let part = part(family)?;
    let driver = radv::driver_file()?;
    let itself = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut command = Command::new(itself);
    command.args(["--part", part.family, &arguments.filter]);
    if arguments.listing.is_some() {
        command.args(["--listing", part.family]);
    }
    // VK_ICD_FILENAMES: the name of the same setting before Vulkan's loader 1.3.207.
    command.env("RADV_FORCE_FAMILY", part.family).env("VK_DRIVER_FILES", &driver).env("VK_ICD_FILENAMES", &driver);
    let output = command.output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{} ({}) does not compile: {}", part.name, part.family, said.trim()));
    }
    String::from_utf8(output.stdout).map_err(|error| error.to_string())
}

/// In the process for one part: prints the driver, then a line for each kernel.
fn compile_for(family: &str, arguments: &Arguments) -> Result<(), String> {
    let radv = Radv::open()?;
    if !radv.name.contains(family) {
        return Err(format!("the device that opened is {}", radv.name));
    }
    calibration::check(&radv, part(family)?)?;
    let mut text = format!("{}\n", radv.driver);
    for kernel in texbake::gpu::kernels().map_err(|error| error.to_string())? {
        if kernel.name.contains(&arguments.filter) {
            let cost = Cost::of(&radv, &kernel, arguments.listing.is_some())
                .map_err(|error| format!("{}: {error}", kernel.name))?;
            text += &format!("{family}\t{}\t{}\n", kernel.name, cost.line());
        }
    }
    print_all(&text)
}

fn part(family: &str) -> Result<&'static Part, String> {
    let families = PARTS.map(|part| part.family).join(", ");
    PARTS.iter().find(|part| part.family == family).ok_or_else(|| format!("{family} is none of {families}"))
}

/// Prints; that nobody reads is no failure.
fn print_all(text: &str) -> Result<(), String> {
    use std::io::Write;
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.to_string()),
        _ => Ok(()),
    }
}
