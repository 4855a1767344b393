//! A report on the disk.

use super::Report;
use super::plots::{plot_files, plots};
use crate::error::{Error, Result};
use crate::io::replace::{Replacement, Step, take};
use std::io::Write;
use std::path::{Path, PathBuf};

/// A folder that takes a report: `report.json`, `report.md`, and plots as SVG and PNG.
pub struct ReportFolder {
    path: PathBuf,
    json: Replacement,
}

impl ReportFolder {
    /// Opens a folder, and makes it if it is missing. Nothing in it changes before the report is written.
    ///
    /// # Errors
    /// [`Error::Io`] if it takes no files; [`Error::File`] if a folder stands where `report.json` shall be, or one of
    /// `inputs` has a name that the report needs.
    pub fn create(path: &Path, inputs: &[&Path]) -> Result<Self> {
        std::fs::create_dir_all(path).map_err(Error::io(path))?;
        let place = |path: &Path| std::fs::canonicalize(path).ok();
        let files = plot_files().chain(["report.json".into(), "report.md".into()]).map(|name| path.join(name));
        for file in files.filter(|file| file.exists()) {
            if inputs.iter().any(|input| place(input) == place(&file)) {
                let reason = "the report would overwrite this input";
                return Err(Error::file(file, reason, "choose another folder"));
            }
        }
        let json = Replacement::create(&path.join("report.json"))?;
        Ok(Self { path: path.into(), json })
    }

    /// Writes the report. All files are complete before the first one gets its name.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::File`].
    pub fn write(self, report: &Report) -> Result<()> {
        let plots = plots(&report.figures)?;
        let pictures: Vec<_> = plots.iter().map(|plot| (format!("{}.png", plot.name), plot.title.clone())).collect();
        let mut steps = Vec::new();
        for plot in plots {
            steps.push(self.file(&format!("{}.svg", plot.name), plot.svg.as_bytes())?);
            steps.push(self.file(&format!("{}.png", plot.name), &plot.png)?);
        }
        steps.push(self.file("report.md", report.markdown(&pictures).as_bytes())?);
        let path = self.path.join("report.json");
        let mut json = serde_json::to_vec_pretty(report).map_err(|error| Error::io(&path)(error.into()))?;
        json.push(b'\n');
        self.json.output()?.write_all(&json).map_err(Error::io(&path))?;
        steps.push(Step::Place(self.json));
        take(steps)
    }

    fn file(&self, name: &str, bytes: &[u8]) -> Result<Step> {
        let path = self.path.join(name);
        let file = Replacement::create(&path)?;
        file.output()?.write_all(bytes).map_err(Error::io(&path))?;
        Ok(Step::Place(file))
    }
}
