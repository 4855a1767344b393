//! Lines and tables.

use super::jobs::Refused;
use comfy_table::{CellAlignment, Table, presets};
use std::cmp::Reverse;
use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};
use std::thread::JoinHandle;
use texbake::batch::{
    BlendJob, BlendOutcome, FileResult, Freshness, Job, ModelTangents, Outcome, ParallaxNumbers, Report, TangentJob,
    describe_codes,
};
use texbake::io::BlockCompression;
use texbake::measure::digits;
use texbake::verify::{Agreement, Comparison, Errors};
use texbake::{Baked, Baker, Device, Error, HeightType, Maps, NormalFormat, Ran, Scale, Size};

/// Longer folders get a table of what was not baked, and of the slowest.
const TABLE_ROWS: usize = 40;
const SLOWEST: usize = 10;

/// A line on stderr. Nobody may be listening, which is no reason to stop.
pub fn say(line: impl std::fmt::Display) {
    finish_announcement();
    write(line);
}

fn write(line: impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

static ANNOUNCEMENT: Mutex<Option<JoinHandle<()>>> = Mutex::new(None);

/// Does `work`, and says a line before anything else that is said because of it. Where nobody reads stderr, it is
/// not waited for: a second interrupt must still be heard.
pub fn announce(line: &'static str, work: impl FnOnce()) {
    let mut announcement = ANNOUNCEMENT.lock().unwrap_or_else(PoisonError::into_inner);
    work();
    *announcement = std::thread::Builder::new().name("interrupt".into()).spawn(move || write(line)).ok();
}

/// Waits until what was announced is said.
pub fn finish_announcement() {
    let announcement = ANNOUNCEMENT.lock().unwrap_or_else(PoisonError::into_inner).take();
    announcement.map(JoinHandle::join);
}

/// Whether a text did not get through stdout.
static LOST: AtomicBool = AtomicBool::new(false);

/// Text on stdout. Nobody may be listening, but a disk that is full is told, and remembered for [`is_lost`].
pub fn put(text: impl std::fmt::Display) {
    let mut stdout = std::io::stdout().lock();
    let written = writeln!(stdout, "{text}").and_then(|()| stdout.flush());
    if let Err(source) =
        written.or_else(|error| if error.kind() == ErrorKind::BrokenPipe { Ok(()) } else { Err(error) })
    {
        let path = "standard output".into();
        if !LOST.swap(true, Relaxed) {
            say(format_args!("error: {}", Error::Io { path, source }));
        }
    }
}

/// Whether [`put`] failed.
pub fn is_lost() -> bool {
    LOST.load(Relaxed)
}

/// What became of one file of a folder.
pub fn file_line(job: &Job, outcome: &Outcome) -> String {
    match (&outcome.result, job.failure(outcome)) {
        (Ok(baked), _) => format!(
            "baked {} -> {}, {}, {}, {}",
            job.input.display(),
            outputs(job),
            size(job, baked),
            baked.height_type,
            milliseconds(outcome)
        ),
        (Err(_), Some(reason)) => format!("failed {reason}"),
        (Err(error), None) => format!("stopped {}: {error}", job.input.display()),
    }
}

/// What was baked, where and why there, and how fast.
pub fn bake_line(job: &Job, outcome: &Outcome) -> Option<String> {
    let baked = outcome.result.as_ref().ok()?;
    let options = &job.options;
    let blocks = job.write.blocks;
    let normal = options.normal.map(|format| format!("{}{}", describe_normals(format), in_blocks(blocks)));
    let of_one = blocks.map(|_| BlockCompression::Bc4);
    let parallax = |format| format!("parallax {}{}", describe_codes(format), in_blocks(of_one));
    let parallax = options.parallax.map(parallax);
    let levels = job.write.mips.then(|| format!(", {}", plural(baked.size.levels().len(), "level")));
    let formats: Vec<String> = normal.into_iter().chain(parallax).collect();
    // Codes from 0 to white over one texel; floats have a height of their own.
    let nearly_flat = options.scale == Scale::default() && baked.height_type != HeightType::F32;
    Some(format!(
        "{}: {}, {} to {}{}{}, scale {}{}, {}; {}",
        outputs(job),
        size(job, baked),
        baked.height_type,
        formats.join(" and "),
        job.normals.iter().map(|normals| format!(" with {}", normals.path.display())).collect::<String>(),
        levels.unwrap_or_default(),
        baked.scale,
        if nearly_flat { " (nearly flat: see --scale)" } else { "" },
        options.precision,
        how_it_ran(&baked.ran, baked.size, &job.baker, outcome),
    ))
}

/// What a shader computes with.
pub fn parallax_line(numbers: &ParallaxNumbers) -> String {
    let pair = |[x, y]: [f64; 2]| format!("({x}, {y})");
    format!(
        "in a shader: u = {} for {} iterations; with the height map itself, scale {} and bias {}",
        pair(numbers.u),
        numbers.iterations,
        pair(numbers.welsh.scale),
        pair(numbers.welsh.bias),
    )
}

/// What was blended, where and why there, and how fast.
pub fn blend_line(job: &BlendJob, method: &str, blended: &BlendOutcome) -> Option<String> {
    let done = blended.outcome.result.as_ref().ok()?;
    let inputs = [&job.base, &job.detail].into_iter().zip(&blended.inputs);
    let inputs = inputs.map(|(input, facts)| {
        format!("{} ({})", input.path.display(), facts.format.map(describe_normals).unwrap_or_default())
    });
    let mask = job.mask.iter().map(|mask| format!(" by {}", mask.path.display())).collect::<String>();
    let weights = done.weights.filter(|_| method != "add").map(|weights| format!(" {weights}")).unwrap_or_default();
    Some(format!(
        "{}: {}, {method}{weights} of {}{mask} to {}, {}; {}",
        job.output.display(),
        done.size,
        inputs.collect::<Vec<_>>().join(" and "),
        format_args!("{}{}", describe_normals(job.options.format), in_blocks(job.write.blocks)),
        job.options.precision,
        how_it_ran(&done.ran, done.size, &job.baker, &blended.outcome),
    ))
}

/// Of which meshes tangents were computed, what was found in them, where and why there, and how fast.
pub fn tangents_line(job: &TangentJob, outcome: &Outcome<ModelTangents>) -> Option<String> {
    let model = outcome.result.as_ref().ok()?;
    let (total, options) = (model.total(), &job.options);
    let mut line = format!(
        "{}: {} of {}, {}, {}, {}, {}, {}",
        job.output.display(),
        model.with_tangents(),
        plural(model.with_tangents() + model.left_out.len(), "primitive"),
        plural(total.vertices, "vertex"),
        plural(total.triangles, "triangle"),
        options.method,
        options.precision,
        options.convention,
    );
    if model.had_tangents() > 0 {
        line += &format!(", tangents of {} replaced", plural(model.had_tangents(), "primitive"));
    }
    let made = model.normals_of_their_own();
    let unwrapped = if options.unwrap { total.jumps } else { 0 };
    let spanning = total.jumps - unwrapped;
    for (count, what) in [
        (total.copies, "made by splits"),
        (total.mirrored, "between mirrored halves"),
        (total.undirected, "undirected"),
        (total.welded, "welded"),
        (made, "with made normals"),
        (total.normals_made - made + total.normals_normalised, "with repaired normals"),
    ] {
        if count > 0 {
            line += &format!(", {count} {what}");
        }
    }
    for (count, what) in [
        (unwrapped, "unwrapped"),
        (spanning, "across more than half of the texture"),
        (total.without_area, "without area"),
        (total.without_texture_area, "without area in the texture"),
    ] {
        if count > 0 {
            line += &format!(", {} {what}", plural(count, "triangle"));
        }
    }
    if let Some(ran) = &model.ran {
        let seconds = model.computing.as_secs_f64();
        let rate = total.triangles as f64 / 1e6 / seconds.max(1e-9);
        line += &format!("; {} ({})", ran.name(), job.baker.reason());
        line += &format!("; {} ms, {} Mtriangle/s", digits(seconds * 1e3), digits(rate));
    }
    let (all, bytes_in, bytes_out) = (milliseconds(outcome), bytes(outcome.bytes_in), bytes(outcome.bytes_out));
    line += &format!("; {all} with files, {bytes_in} in, {bytes_out} out");
    Some(line)
}

/// `1 vertex`, `2 vertices`.
fn plural(count: usize, what: &str) -> String {
    match (count, what) {
        (1, what) => format!("1 {what}"),
        (_, "vertex") => format!("{count} vertices"),
        _ => format!("{count} {what}s"),
    }
}

/// `unorm 8 xyz gl`.
fn describe_normals(format: NormalFormat) -> String {
    let NormalFormat { encoding, depth, channels, convention } = format;
    format!("{encoding} {depth} {channels} {convention}")
}

/// ` in bc7 blocks`.
fn in_blocks(blocks: Option<BlockCompression>) -> String {
    match blocks {
        // What its readers see, whatever was asked for.
        Some(BlockCompression::Bc5) => " in bc5 blocks, x and y alone".into(),
        Some(blocks) => format!(" in {blocks} blocks"),
        None => String::new(),
    }
}

/// The size of the maps: `256 x 256`, or `256 x 256 (shrunk by 4)`.
fn size(job: &Job, baked: &Baked) -> String {
    match job.read.shrink.get() {
        1 => baked.size.to_string(),
        by => format!("{} (shrunk by {by})", baked.size),
    }
}

/// The files of a job's maps.
fn outputs(job: &Job) -> String {
    job.outputs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Where and why there, how fast, and how many bytes.
fn how_it_ran<T>(ran: &Ran, size: Size, baker: &Baker, outcome: &Outcome<T>) -> String {
    let rate = size.texels() as f64 / 1e6 / outcome.time.unwrap_or_default().as_secs_f64().max(1e-9);
    format!(
        "{} ({}); {}, {rate:.1} Mtexel/s, {} in, {} out",
        ran.name(),
        baker.reason(),
        milliseconds(outcome),
        bytes(outcome.bytes_in),
        bytes(outcome.bytes_out),
    )
}

/// The files of a folder; of many only those that were not baked, and the slowest.
pub fn file_table(jobs: &[Job], outcomes: &[Outcome], left_out: &[String], refused: &[Refused]) -> String {
    let (files, all) = (|| jobs.iter().zip(outcomes), jobs.len() + refused.len());
    if all + left_out.len() <= TABLE_ROWS {
        return rows_of(files(), left_out, refused);
    }
    let worked_on = files().filter(|(_, outcome)| FileResult::of(outcome) != FileResult::Fresh);
    let (mut baked, unbaked): (Vec<_>, Vec<_>) = worked_on.partition(|(_, outcome)| outcome.result.is_ok());
    baked.sort_by_key(|(_, outcome)| Reverse(outcome.time));
    baked.truncate(SLOWEST);
    let what = match (unbaked.len() + refused.len(), baked.len()) {
        (0, 0) => return format!("of {all} files all fresh"),
        (0, slowest) => format!("the {slowest} slowest"),
        (unbaked, 0) => format!("{unbaked} not baked"),
        (unbaked, slowest) => format!("{unbaked} not baked, and the {slowest} slowest"),
    };
    format!("of {all} files {what}:\n{}", rows_of(unbaked.into_iter().chain(baked), &[], refused))
}

fn rows_of<'a>(
    files: impl Iterator<Item = (&'a Job, &'a Outcome)>,
    left_out: &[String],
    refused: &[Refused],
) -> String {
    let mut table = plain_table(&["file", "size", "depth", "maps", "ms", "result"], &[4]);
    for (job, outcome) in files {
        let (size, depth) = match &outcome.result {
            Ok(baked) => (size(job, baked), baked.height_type.to_string()),
            Err(_) => Default::default(),
        };
        let time = outcome.time.map_or(String::new(), |time| format!("{:.1}", time.as_secs_f64() * 1e3));
        let result = match FileResult::of(outcome) {
            FileResult::Baked => "baked".to_owned(),
            FileResult::Fresh => "fresh".to_owned(),
            FileResult::Failed => "failed".to_owned(),
            FileResult::Stopped => "stopped".to_owned(),
            FileResult::NotBegun => "not begun".to_owned(),
        };
        let Maps { normal, parallax, roughness } = &job.outputs;
        let maps = [("normal", normal), ("parallax", parallax), ("roughness", roughness)];
        let maps: Vec<_> = maps.iter().filter(|(_, path)| path.is_some()).map(|(map, _)| *map).collect();
        let maps = maps.join(",");
        table.add_row([job.input.display().to_string(), size, depth, maps, time, result]);
    }
    for Refused { input, .. } in refused {
        table.add_row([&*input.to_string_lossy(), "", "", "", "", "failed"]);
    }
    for file in left_out {
        table.add_row([file, "", "", "none", "", "left out"]);
    }
    table.trim_fmt()
}

/// One line about a run.
pub fn summary(report: &Report, jobs: &[Job], outcomes: &[Outcome]) -> String {
    let totals = &report.totals;
    let mut counts = vec![format!("{} of {} files baked", totals.baked, totals.files)];
    for (count, what) in [
        (totals.fresh, "fresh"),
        (totals.failed, "failed"),
        (totals.stopped, "stopped"),
        (totals.not_begun, "not begun"),
        (report.left_out.len(), "left out"),
        (report.errors.len(), if report.errors.len() == 1 { "error" } else { "errors" }),
    ] {
        if count > 0 {
            counts.push(format!("{count} {what}"));
        }
    }
    let mut places: Vec<String> = Vec::new();
    for (job, Baked { ran, .. }) in jobs.iter().zip(outcomes).filter_map(|(job, outcome)| Some((job, outcome.baked()?)))
    {
        let reason = ran.fallback.as_deref().unwrap_or(job.baker.reason());
        let place = format!("{} ({reason})", ran.name());
        if !places.contains(&place) {
            places.push(place);
        }
    }
    let mut line = format!(
        "{}; {:.2} Mtexel in {:.2} s, {:.1} Mtexel/s, {} in, {} out",
        counts.join(", "),
        totals.texels as f64 / 1e6,
        totals.seconds,
        totals.megatexels_per_second,
        bytes(totals.bytes_in),
        bytes(totals.bytes_out),
    );
    for place in places {
        line += "; ";
        line += &place;
    }
    line
}

/// What would become of each file of a folder, and why; these are the outcomes of a dry run.
pub fn plan_table(jobs: &[Job], outcomes: &[Outcome], refused: &[Refused]) -> String {
    let line = |(job, outcome): (&Job, &Outcome)| {
        let files = format!("{} -> {}", job.input.display(), outputs(job));
        match (job.failure(outcome), &outcome.freshness) {
            (Some(reason), _) => format!("fail {files}: {reason}"),
            (None, Some(Freshness::Stale(reason))) => format!("bake {files}: {reason}"),
            (None, Some(Freshness::Fresh) | None) => format!("fresh {files}"),
        }
    };
    let count = |result| outcomes.iter().filter(|outcome| FileResult::of(outcome) == result).count();
    let (failed, all) = (count(FileResult::Failed) + refused.len(), outcomes.len() + refused.len());
    let mut summary = format!("{} of {all} files would be baked", count(FileResult::NotBegun));
    for (count, what) in [(count(FileResult::Fresh), "fresh"), (failed, "would fail")] {
        if count > 0 {
            summary += &format!(", {count} {what}");
        }
    }
    let refused = refused.iter().map(|Refused { input, reason }| format!("fail {}: {reason}", input.display()));
    jobs.iter().zip(outcomes).map(line).chain(refused).chain([summary]).collect::<Vec<_>>().join("\n")
}

/// What could run bakes.
pub fn device_table(devices: &[Device]) -> String {
    let mut table = plain_table(&["device", "api", "kind", "driver", "self-test", "auto"], &[]);
    for device in devices {
        let self_test =
            device.self_test.as_ref().map_or_else(|reason| format!("failed: {reason}"), |()| "passed".into());
        let picked = format!("{}{}", if device.picked { "picked: " } else { "no: " }, device.reason);
        table.add_row([&device.name, &device.api, &device.kind, &device.driver, &self_test, &picked]);
    }
    table.trim_fmt()
}

/// How each operation of a device agrees with the specification; then the errors of `fast`, beside their bounds.
pub fn comparison_table(comparisons: &[Comparison]) -> String {
    let mut table = plain_table(&["operation", "cases", "values", "differ", "result"], &[1, 2, 3]);
    let mut errors = plain_table(&["fast: largest/mean/bound", "codes", "ulp", "degrees"], &[]);
    for comparison in comparisons {
        let Agreement { values, differing, codes, ulps, degrees, .. } = comparison.agreement;
        let result = match (comparison.failed_cases, comparison.bound) {
            (0, _) if !comparison.passed() => "FAILED: nothing was compared".to_owned(),
            (0, None) => "same bits".to_owned(),
            (0, Some(_)) => "in bounds".to_owned(),
            (failed, _) => format!("FAILED in {failed}"),
        };
        let name = format!("{}, {}", comparison.operation, comparison.precision);
        table.add_row([name, comparison.cases.to_string(), values.to_string(), differing.to_string(), result]);
        if let Some(bound) = comparison.bound {
            let cell = |errors: Errors, bound: f64| match errors.count {
                0 => String::new(),
                _ => format!("{}/{}/{}", narrow(errors.largest), narrow(errors.mean), narrow(bound)),
            };
            let name = comparison.operation.to_owned();
            let cells = [cell(codes, bound.codes), cell(ulps, bound.ulps), cell(degrees, bound.degrees)];
            errors.add_row([&[name][..], &cells].concat());
        }
    }
    if errors.is_empty() { table.trim_fmt() } else { format!("{}\n{}", table.trim_fmt(), errors.trim_fmt()) }
}

/// A number in six characters at most where [`digits`] has eight: three of them stand in a column.
fn narrow(number: f64) -> String {
    match number {
        0.0 => "0".into(),
        0.01..1.0 => format!("{number:.3}").trim_end_matches('0').into(),
        1.0..100.0 => format!("{number:.1}").trim_end_matches(".0").into(),
        100.0..1e6 => format!("{number:.0}"),
        _ => format!("{number:.1e}"),
    }
}

fn plain_table(header: &[&str], numbers: &[usize]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header.iter().copied());
    for &column in numbers {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

fn milliseconds<T>(outcome: &Outcome<T>) -> String {
    format!("{:.1} ms", outcome.time.unwrap_or_default().as_secs_f64() * 1e3)
}

/// `12.3 MB`.
fn bytes(count: u64) -> String {
    match count {
        0..1_000 => format!("{count} B"),
        1_000..1_000_000 => format!("{:.1} kB", count as f64 / 1e3),
        _ => format!("{:.1} MB", count as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn byte_counts_are_decimal() {
        assert_eq!(["999 B", "1.0 kB", "12.3 MB"].map(str::to_owned), [999, 1000, 12_345_678].map(super::bytes));
    }
}
