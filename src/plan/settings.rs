//! The settings file of a plan.

use super::decision::{Decision, wrapped};
use super::file_plan::{FilePlan, Plan, slashed};
use super::prediction::Prediction;
use crate::batch::place;
use crate::error::{Error, Result, plain};
use crate::io::replace::Replacement;
use serde::Serialize;
use std::io::{ErrorKind, Read, Write};
use std::path::Path;

/// How a settings file begins that a plan has written, and that another plan may replace.
const MARK: &str = "# Written by texbake plan.";

impl Plan {
    /// The settings that `bake` runs, with the reason of each choice, and the predictions that `bake --check-plan` holds
    /// it to.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a prediction cannot be written.
    pub fn settings(&self) -> Result<String> {
        let mut text = format!(
            "{MARK} Change {} and plan again: what is written here is lost then.\n# texbake bake {} --config THIS FILE \
             --out FOLDER --check-plan\n\n",
            plain(&self.scene.display().to_string()),
            plain(&self.folder.display().to_string()),
        );
        if let Some(suffixes) = &self.suffixes {
            let suffixes: Vec<String> = suffixes.iter().map(|suffix| quoted(suffix)).collect();
            text += &format!("suffix = [{}]\n\n", suffixes.join(", "));
        }
        text += "[defaults]\nmaps = \"none\"  # what the scene does not show\n";
        // A glob without a folder matches in all of them, and the last one that matches counts.
        let mut files: Vec<&FilePlan> = self.files.iter().collect();
        files.sort_by_key(|file| file.file.components().count());
        for file in files {
            text += &file.override_text();
        }
        #[derive(Serialize)]
        struct Predictions<'a> {
            plan: Vec<&'a Prediction>,
        }
        let predictions = Predictions { plan: self.files.iter().map(|file| &file.prediction).collect() };
        let predictions = toml::to_string(&predictions)
            .map_err(|error| Error::parameter("plan", error, "predictions that TOML can hold"))?;
        text += "\n# What was measured: bake --check-plan measures again, and fails if it is not so.\n\n";
        text += &predictions;
        Ok(text)
    }

    /// Writes the settings to `path`, at once or not at all.
    ///
    /// # Errors
    /// [`Error::File`] if something else than a plan's settings is there, unless `replaces_all`; [`Error::Io`].
    pub fn write(&self, path: &Path, replaces_all: bool) -> Result<()> {
        check_place(path, replaces_all)?;
        if place(path) == place(&self.scene) {
            return Err(Error::file(path, "it is the scene itself", "write elsewhere with -o"));
        }
        let text = self.settings()?;
        let folder = path.parent().unwrap_or(Path::new(""));
        std::fs::create_dir_all(folder).map_err(Error::io(folder))?;
        let file = Replacement::create(path)?;
        file.output()?.write_all(text.as_bytes()).map_err(Error::io(path))?;
        file.commit()
    }
}

/// Fails if `path` is no settings file by its name; or if, unless `replaces_all`, there is a file that no plan has
/// written: it would be lost.
///
/// # Errors
/// [`Error::File`]; [`Error::Io`] if what is there cannot be read.
pub fn check_place(path: &Path, replaces_all: bool) -> Result<()> {
    if path.extension().is_none_or(|extension| extension != "toml") {
        return Err(Error::file(path, "settings are TOML", "name it .toml, as texbake.toml"));
    }
    if replaces_all {
        return Ok(());
    }
    let mut begin = Vec::new();
    match std::fs::File::open(path) {
        Ok(file) => file.take(MARK.len() as u64).read_to_end(&mut begin).map_err(Error::io(path))?,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(Error::io(path)(error)),
    };
    if begin == MARK.as_bytes() {
        return Ok(());
    }
    let remedy = "move it away, write elsewhere with -o, or replace it with --force";
    Err(Error::file(path, "texbake plan did not write this file, and would overwrite it", remedy))
}

impl FilePlan {
    fn override_text(&self) -> String {
        let mut text = String::from("\n");
        for Decision { topic, choice, reason, .. } in &self.decisions {
            text += &wrapped(&format!("{topic}: {}; {}", plain(choice), plain(reason)), ["# ", "#   "]);
        }
        text +=
            &format!("[[override]]\nglob = {}\n", quoted(&globset::escape(&slashed(&self.file).replace('\\', "\\\\"))));
        for (key, value) in &self.settings {
            text += &format!("{key} = {}\n", if is_number(value) { value.clone() } else { quoted(value) });
        }
        text
    }
}

/// Whether it is a number to TOML as it is: `24`, `-0.35`.
fn is_number(text: &str) -> bool {
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let (whole, fraction) = text.trim_start_matches('-').split_once('.').unwrap_or((text.trim_start_matches('-'), "0"));
    digits(whole) && digits(fraction) && text.parse::<f64>().is_ok() && (whole == "0" || !whole.starts_with('0'))
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}
