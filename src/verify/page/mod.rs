//! The page of `texbake verify --html`: recordings in one file that any browser with WebGPU runs.

use crate::backend::gpu::recording::{Expected, Given, Pass, Recording, as_base64};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// A recording with a name that tells it from all others.
#[derive(Debug, Clone)]
pub(super) struct PageCase {
    pub name: String,
    /// The heading under which it is shown.
    pub operation: &'static str,
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
pub(super) fn page(notes: &[(&str, String)], cases: &[PageCase]) -> String {
    let mut kernels = Kernels::default();
    let cases = cases.iter().map(|case| recorded(case, &mut kernels)).collect();
    let document = Document { notes, kernels: kernels.all, cases };
    let json = serde_json::to_string(&document).expect("names, numbers and texts");
    // In a script element nothing but `<` could end the data, and JSON holds it in strings alone.
    let json = json.replace('<', "\\u003c");
    // What is inserted last may hold the names of the others.
    TEMPLATE.replace("{{style}}", STYLE).replace("{{script}}", SCRIPT).replace("{{recordings}}", &json)
}

fn recorded<'a>(case: &'a PageCase, kernels: &mut Kernels<'a>) -> PageRecording<'a> {
    let Recording { precision, formats, passes, inputs, output_words, given, expected } = &case.recording;
    let pass = |pass: &'a Pass| PagePass {
        kernel: kernels.index(pass),
        constants: pass.constants.iter().copied().collect(),
        params: &pass.params,
        groups: pass.groups,
    };
    PageRecording {
        name: &case.name,
        operation: case.operation,
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
pub(super) mod tests {
    use super::*;

    /// The data of a page, as a browser finds them.
    pub fn data_of(page: &str) -> serde_json::Value {
        let (_, rest) = page.split_once("<script id=\"recordings\" type=\"application/json\">").unwrap();
        serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
    }

    #[test]
    fn notes_end_no_script() {
        let notes = [("seed", "</script><script>alert(1)</script>{{style}}".to_owned())];
        let page = page(&notes, &[]);
        assert_eq!(data_of(&page)["notes"][0][1], notes[0].1);
        assert_eq!(page.matches("</script").count(), 2);
    }

    #[test]
    fn pages_need_nothing_else() {
        let page = page(&[], &[]);
        for reference in ["src=", "href=", "url(", "@import", "http:", "https:/", "fetch(", "import("] {
            assert!(!page.contains(reference), "the page refers to something by {reference}");
        }
        assert!(!page.contains("{{"), "a place of the template is left");
    }
}
