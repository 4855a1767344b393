//! Whether one file is what was baked.

use super::KERNEL_VERSION;
use super::content::Content;
use super::key::Key;
use super::line::{Line, Output};
use super::plan::Decision;
use super::reader::Reader;
use super::reason::{Change, Reason};
use super::record::Record;
use crate::batch::{Files, Job};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::sync::Arc;

/// That the outputs of `job` are what it would bake, or why not; what needs no file to be read comes first.
pub(super) fn check(job: &Job, record: &Record, reader: Reader<'_>) -> Result<Decision, Reason> {
    let Files { inputs, outputs } = job.files();
    let lines = outputs.iter().map(|output| find(record, output)).collect::<Result<Vec<_>, _>>()?;
    let options = Key::of(job, None);
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
        return Err(Reason::Apart(outputs[other].into(), outputs[0].into()));
    }
    let line = lines.into_iter().next().ok_or(Reason::New)?;
    if line.inputs.len() != inputs.len() {
        return Err(Reason::OtherInputs);
    }
    let same = |then: &Content, path: &Path, changed: fn(std::path::PathBuf) -> Reason| {
        let now = reader.still(then, path).map_err(|error| unread(path, &error))?;
        now.ok_or_else(|| changed(path.into()))
    };
    let inputs = line.inputs.iter().zip(inputs).map(|(then, input)| same(then, input, Reason::Input));
    let inputs = inputs.collect::<Result<_, _>>()?;
    let outputs = outputs.into_iter().map(|path| {
        let name = record.name(path);
        let then = line.outputs.iter().find(|output| output.name == name);
        let then = then.ok_or_else(|| Reason::Unknown(path.into()))?;
        Ok(Output { content: same(&then.content, path, Reason::Edited)?, name })
    });
    let renewed = Line { inputs, outputs: outputs.collect::<Result<_, _>>()?, ..line.as_ref().clone() };
    let renewed = Some(renewed).filter(|renewed| renewed != line.as_ref());
    Ok(Decision::Fresh { line, renewed })
}

/// How an output was baked, if it is there.
fn find(record: &Record, output: &Path) -> Result<Arc<Line>, Reason> {
    let is_there = output.try_exists().map_err(|error| unread(output, &error))?;
    match (record.line(output), is_there) {
        (Some(line), true) => Ok(line),
        (Some(_), false) => Err(Reason::Missing(output.into())),
        (None, true) => Err(Reason::Unknown(output.into())),
        (None, false) => Err(Reason::New),
    }
}

/// Why nothing is known of a file's content.
fn unread(path: &Path, error: &io::Error) -> Reason {
    match error.kind() {
        ErrorKind::Interrupted => Reason::Interrupted,
        _ => Reason::Unreadable(path.into(), error.to_string()),
    }
}
