//! Whether one file is what was baked.

use super::KERNEL_VERSION;
use super::content::Content;
use super::key;
use super::line::{Line, Output};
use super::plan::Decision;
use super::reason::{Change, Reason};
use super::record::Record;
use crate::batch::{Files, Job};
use crate::stream::Monitor;
use std::io;
use std::path::Path;
use std::sync::Arc;

/// That the outputs of `job` are what it would bake, or why not; what needs no file to be read comes first.
pub(super) fn check(job: &Job, record: &Record, monitor: &Monitor) -> Result<Decision, Reason> {
    let Files { inputs, outputs } = job.files();
    let lines = outputs.iter().map(|output| find(record, output)).collect::<Result<Vec<_>, _>>()?;
    let options = key::of(job, &job.baker.name());
    for line in &lines {
        if line.kernel != KERNEL_VERSION {
            return Err(Reason::Kernel { from: line.kernel, to: KERNEL_VERSION });
        }
        if line.options != options {
            return Err(Reason::Options(Change::all(&line.options, &options)));
        }
    }
    // Maps of one bake have one line.
    if let Some(other) = lines.iter().position(|line| !Arc::ptr_eq(line, &lines[0])) {
        return Err(Reason::Unknown(outputs[other].into()));
    }
    let line = lines.into_iter().next().ok_or(Reason::New)?;
    if line.inputs.len() != inputs.len() {
        return Err(Reason::OtherInputs);
    }
    let inputs = line.inputs.iter().zip(inputs).map(|(then, input)| {
        is_there(input).then_some(()).ok_or_else(|| Reason::Unreadable(input.into()))?;
        same(then.compare(input, monitor), || Reason::Input(input.into()))
    });
    let inputs = inputs.collect::<Result<_, _>>()?;
    let outputs = outputs.into_iter().map(|path| {
        let name = record.name(path);
        let edited = || Reason::Edited(path.into());
        let then = line.outputs.iter().find(|output| output.name == name).ok_or_else(edited)?;
        Ok(Output { content: same(then.content.compare(path, monitor), edited)?, name })
    });
    let renewed = Line { inputs, outputs: outputs.collect::<Result<_, _>>()?, ..line.as_ref().clone() };
    let renewed = Some(renewed).filter(|renewed| renewed != line.as_ref());
    Ok(Decision::Fresh { line, renewed })
}

/// How an output was baked, if it is there.
fn find(record: &Record, output: &Path) -> Result<Arc<Line>, Reason> {
    match (record.line(output), is_there(output)) {
        (Some(line), true) => Ok(line),
        (Some(_), false) => Err(Reason::Missing(output.into())),
        (None, true) => Err(Reason::Unknown(output.into())),
        (None, false) => Err(Reason::New),
    }
}

fn is_there(file: &Path) -> bool {
    file.try_exists().unwrap_or(false)
}

/// The content of a file that is as it was.
fn same(compared: io::Result<(Content, bool)>, changed: impl FnOnce() -> Reason) -> Result<Content, Reason> {
    match compared {
        Ok((content, true)) => Ok(content),
        _ => Err(changed()),
    }
}
