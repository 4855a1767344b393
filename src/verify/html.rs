//! The page of `texbake verify --html`: which cases it has, and how far they may differ.

use super::bounds;
use super::cases::Case;
use super::options::Options;
use super::page::{PageCase, page};
use super::sabotage;
use super::subject::Progress;
use crate::backend::gpu::recording::{Recording, Tolerance};
use crate::error::Result;
use crate::stream::Monitor;
use std::collections::HashSet;

/// A page that verifies the WebGPU of whatever browser opens it: one file that holds the kernels, inputs, and the
/// specification's answers, refers to nothing else, and opens from a disk too.
///
/// It ends by writing two lines to the browser's console, for programs: `texbake verify: 12 cases agree, 0 differ`, after
/// which come how many failed and how many were not run, if any, and `texbake verify report: ` with a JSON object. What
/// it compares are the kernels' outputs, before anything that the CPU does with them.
#[derive(Debug, Clone)]
pub struct Page {
    html: String,
    cases: usize,
    values: usize,
}

impl Page {
    /// A page of those cases of a quick run that have, together, every choice that there is; with `full` of all cases of
    /// a quick run. Sabotaged, with a constant changed in each kernel.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) if the options mean no case;
    /// [`Error::Cancelled`](crate::Error::Cancelled) if the monitor says so.
    pub fn new(
        options: &Options,
        sabotaged: bool,
        monitor: &Monitor,
        watch: &mut dyn FnMut(Progress<'_>),
    ) -> Result<Self> {
        let cases = if options.full { options.quick().cases()? } else { covering(options.cases()?) };
        let mut recorded = Vec::new();
        for (done, case) in cases.iter().enumerate() {
            monitor.check()?;
            watch(Progress { done, of: cases.len(), case: &case.name });
            recorded.extend(record(case, options.seed)?);
        }
        if sabotaged {
            let passes = recorded.iter_mut().flat_map(|case| &mut case.recording.passes);
            passes.for_each(|pass| pass.text = sabotage::changed(&pass.text));
        }
        let mut notes = vec![("texbake", env!("CARGO_PKG_VERSION").to_owned()), ("seed", options.seed.to_string())];
        notes.extend(options.only.clone().map(|only| ("only", only)));
        notes.extend(sabotaged.then(|| ("sabotage", "a constant of each kernel is changed".to_owned())));
        let values = recorded.iter().map(|case| case.recording.values()).sum();
        Ok(Self { html: page(&notes, &recorded), cases: recorded.len(), values })
    }

    /// The page's text.
    pub fn html(&self) -> &str {
        &self.html
    }

    /// Writes the page, which appears under its name when it is complete; its folders are made.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if there is something else than a file under its name;
    /// [`Error::Io`](crate::Error::Io).
    pub fn write(&self, path: impl AsRef<std::path::Path>) -> Result<()> {
        crate::io::replace::replace_file(path.as_ref(), self.html.as_bytes())
    }

    /// Cases that it runs.
    pub fn cases(&self) -> usize {
        self.cases
    }

    /// Values that it compares.
    pub fn values(&self) -> usize {
        self.values
    }
}

/// Those of many cases that together have every word of all of them, by operation and precision: browsers take long to
/// compile a kernel, and a page holds all its inputs.
fn covering(mut cases: Vec<Case>) -> Vec<Case> {
    let mut seen = HashSet::new();
    cases.retain(|case| {
        // What is blended has its place counted from the end: methods have different numbers of words.
        let words = case.name.replace(" and ", ", ").replace(" to ", ", ");
        let places = words.rsplit(", ").enumerate();
        let is_new =
            |(place, word): (usize, &str)| seen.insert((case.operation, case.precision, place, word.to_owned()));
        // All of them: a case shows everything it has.
        places.map(is_new).filter(|is_new| *is_new).count() > 0
    });
    cases
}

/// A case as data; its kernels may run more than once.
fn record(case: &Case, seed: u64) -> Result<Vec<PageCase>> {
    let job = case.job(seed)?;
    let recordings = Recording::of(|baker| job.run(baker))?;
    let bound = bounds::fast(case.operation);
    let name = |number: usize| match number {
        0 => case.name.clone(),
        _ => format!("{}, dispatch {}", case.name, number + 1),
    };
    let page_case = |(number, mut recording): (usize, Recording)| {
        recording.allow(Tolerance { codes: bound.codes, ulps: bound.ulps, degrees: bound.degrees });
        PageCase { name: name(number), operation: case.operation, recording }
    };
    Ok(recordings.into_iter().enumerate().map(page_case).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::gpu::sources;
    use crate::verify::page::tests::data_of;

    fn page(words: &str, sabotaged: bool) -> Page {
        let options = Options { only: Some(words.into()), ..Default::default() };
        Page::new(&options, sabotaged, &Monitor::default(), &mut |_| ()).unwrap()
    }

    #[test]
    fn pages_hold_every_case_and_every_kernel_once() {
        let page = page("fast, random", false);
        let data = data_of(page.html());
        let cases = data["cases"].as_array().unwrap();
        assert_eq!(cases.len(), page.cases());
        assert!(cases.len() > 20 && page.values() > 20 * 800);
        assert_eq!(page.values(), cases.iter().map(values).sum::<usize>());
        let kernels = data["kernels"].as_array().unwrap();
        let names: Vec<_> = kernels.iter().map(|kernel| kernel["name"].as_str().unwrap()).collect();
        assert_eq!(names, ["bake, fast", "parallax, fast", "blend, fast"]);
        for kernel in kernels {
            let source = sources().iter().find(|source| kernel["name"] == source.name).unwrap();
            assert_eq!(kernel["text"], source.text());
        }
    }

    fn values(case: &serde_json::Value) -> usize {
        let expected = case["expected"].as_array().unwrap().iter().filter(|it| it["name"] != "marks");
        let values = expected.map(|it| {
            let per_texel = if it["code"] == "bits" { 1 } else { it["channels"].as_u64().unwrap() };
            it["rows"].as_u64().unwrap() * per_texel * width(it)
        });
        values.sum::<u64>() as usize
    }

    /// Texels of a row.
    fn width(rows: &serde_json::Value) -> u64 {
        let bytes = match rows["code"].as_str().unwrap() {
            "u8" | "i8" => 1,
            "u16" | "i16" | "f16" => 2,
            _ => 4,
        };
        rows["row_bytes"].as_u64().unwrap() / bytes / rows["channels"].as_u64().unwrap()
    }

    #[test]
    fn pages_have_every_choice_in_a_part_of_the_cases() {
        let all = Options::default().cases().unwrap();
        let (count, words) = (all.len(), all.iter().flat_map(words_of).collect::<HashSet<_>>());
        let some = covering(all);
        assert_eq!(words, some.iter().flat_map(words_of).collect());
        assert!(some.len() < count, "{} of {count}", some.len());
    }

    fn words_of(case: &Case) -> Vec<(&'static str, String)> {
        case.name.split([',', ' ']).map(|word| (case.operation, word.to_owned())).collect()
    }

    #[test]
    fn sabotage_changes_every_kernel() {
        let words = "exact, u8, unorm 8 xyz gl, central";
        let [data, sabotaged] = [false, true].map(|sabotaged| data_of(page(words, sabotaged).html()));
        assert_eq!(data["cases"], sabotaged["cases"]);
        let [kernels, changed] = [data, sabotaged].map(|data| data["kernels"].as_array().unwrap().clone());
        assert!(!kernels.is_empty());
        for (kernel, changed) in kernels.iter().zip(&changed) {
            assert_eq!(kernel["name"], changed["name"]);
            assert_ne!(kernel["text"], changed["text"], "{}", kernel["name"]);
        }
    }
}
