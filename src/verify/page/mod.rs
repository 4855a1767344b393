//! The page of `texbake verify --html`: recordings in one file that any browser with WebGPU runs.

use crate::backend::gpu::recording::{Expected, Given, Pass, Recording, as_base64};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// A recording with a name that tells it from all others.
#[derive(Debug, Clone)]
pub(crate) struct PageCase {
    /// `bake, exact, u16 heights to unorm 16 xyz gl, scharr, clamp`.
    pub name: String,
    pub recording: Recording,
}

/// What the page's script reads.
#[derive(Serialize)]
struct Document<'a> {
    /// Label and text.
    notes: &'a [(&'a str, String)],
    kernels: Vec<PageKernel<'a>>,
    cases: Vec<PageRecording<'a>>,
}

/// A text that many passes compile.
#[derive(Serialize)]
struct PageKernel<'a> {
    name: &'static str,
    entry_point: &'static str,
    text: &'a str,
}

#[derive(Serialize)]
struct PageRecording<'a> {
    name: &'a str,
    operation: &'static str,
    precision: String,
    formats: &'a str,
    passes: Vec<PagePass<'a>>,
    #[serde(serialize_with = "as_base64")]
    inputs: &'a [u8],
    output_words: usize,
    given: &'a [Given],
    expected: &'a [Expected],
}

#[derive(Serialize)]
struct PagePass<'a> {
    /// Index of the kernel.
    kernel: usize,
    constants: BTreeMap<&'static str, u32>,
    #[serde(serialize_with = "as_base64")]
    params: &'a [u8],
    groups: [u32; 2],
}

/// The page: one file without any reference to another, which opens from a disk too. `notes` are what a reader should
/// know of it, such as version and seed: a label and a text each.
pub(crate) fn page(notes: &[(&str, String)], cases: &[PageCase]) -> String {
    let mut kernels = Kernels::default();
    let cases = cases.iter().map(|case| recorded(case, &mut kernels)).collect();
    let document = Document { notes, kernels: kernels.all, cases };
    let json = serde_json::to_string(&document).expect("names, numbers and texts");
    // In a script element nothing but `<` could end the data, and JSON holds it in strings alone.
    let json = json.replace('<', "\\u003c");
    // What is inserted last may hold the names of the others.
    TEMPLATE.replace("{{style}}", STYLE).replace("{{script}}", SCRIPT).replace("{{recordings}}", &json)
}

fn recorded<'a>(PageCase { name, recording }: &'a PageCase, kernels: &mut Kernels<'a>) -> PageRecording<'a> {
    let Recording { operation, precision, formats, passes, inputs, output_words, given, expected } = recording;
    let pass = |pass: &'a Pass| PagePass {
        kernel: kernels.index(pass),
        constants: pass.constants.iter().copied().collect(),
        params: &pass.params,
        groups: pass.groups,
    };
    PageRecording {
        name,
        operation,
        precision: precision.to_string(),
        formats,
        passes: passes.iter().map(pass).collect(),
        inputs,
        output_words: *output_words,
        given,
        expected,
    }
}

/// Every text once.
#[derive(Default)]
struct Kernels<'a> {
    all: Vec<PageKernel<'a>>,
    indices: HashMap<(&'static str, &'a str), usize>,
}

impl<'a> Kernels<'a> {
    fn index(&mut self, Pass { name, entry_point, text, .. }: &'a Pass) -> usize {
        *self.indices.entry((name, text)).or_insert_with(|| {
            self.all.push(PageKernel { name, entry_point, text });
            self.all.len() - 1
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::gpu::recording_tests::samples;

    fn cases() -> Vec<PageCase> {
        samples().into_iter().map(|(name, recording)| PageCase { name, recording }).collect()
    }

    /// The data of a page, as a browser finds them.
    fn data_of(page: &str) -> serde_json::Value {
        let (_, rest) = page.split_once("<script id=\"recordings\" type=\"application/json\">").unwrap();
        serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
    }

    #[test]
    fn pages_hold_every_kernel_once_and_every_case() {
        let cases = cases();
        let notes = [("seed", "</script><script>alert(1)</script>{{style}}".to_owned())];
        let page = page(&notes, &cases);
        let data = data_of(&page);
        assert_eq!(data["notes"][0][1], notes[0].1);
        assert_eq!(data["cases"].as_array().unwrap().len(), cases.len());
        let kernels = data["kernels"].as_array().unwrap();
        for (number, pass) in cases.iter().flat_map(|case| &case.recording.passes).enumerate() {
            let same = kernels.iter().filter(|kernel| kernel["text"] == pass.text.as_str()).count();
            assert_eq!(same, 1, "pass {number}: {}", pass.name);
        }
    }

    #[test]
    fn pages_need_nothing_else() {
        let page = page(&[], &cases()[..1]);
        for reference in ["src=", "href=", "url(", "@import", "http:", "https:/", "fetch("] {
            assert!(!page.contains(reference), "the page refers to something by {reference}");
        }
        assert_eq!(page.matches("</script").count(), 2);
        assert!(!page.contains("{{"), "a place of the template is left");
    }

    /// For the eye and a browser: TEXBAKE_PAGE names the file.
    #[test]
    fn write_a_page() {
        let Some(file) = std::env::var_os("TEXBAKE_PAGE") else { return };
        let mut cases = cases();
        match std::env::var("TEXBAKE_PAGE_KIND").as_deref() {
            Ok("empty") => cases.clear(),
            Ok("sabotaged") => {
                for pass in cases.iter_mut().step_by(3).flat_map(|case| &mut case.recording.passes) {
                    pass.text = pass.text.replace("const TEXELS: u32 = 4u;", "const TEXELS: u32 = 3u;");
                }
                cases[4].recording.expected[0].bytes[41] ^= 1;
                cases[5].recording.passes[0].text += "\nfn broken() { let x = ; }";
            }
            _ => {}
        }
        let notes = [("texbake", env!("CARGO_PKG_VERSION").to_owned()), ("seed", "5".to_owned())];
        std::fs::write(file, page(&notes, &cases)).unwrap();
    }
}
