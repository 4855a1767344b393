//! The page of `texbake verify --html` in headless Chromium: the kernels under Tint and Dawn, on SwiftShader.
//!
//! Debian's chromium, or what TEXBAKE_CHROMIUM names. Where there is none that is printed; with
//! TEXBAKE_REQUIRE_BROWSER=1 it fails the tests.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use half::f16;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use texbake::stream::Monitor;
use texbake::verify::{Options, Page, Subject};

/// Far beyond what the whole page takes on two busy cores.
const PATIENCE: Duration = Duration::from_secs(600);

/// How Chromium gets WebGPU without a GPU.
const SWIFTSHADER: [&str; 2] = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader"];

/// What a page wrote on its console at its end.
struct Told {
    line: String,
    report: Value,
}

fn browser() -> Option<PathBuf> {
    let named = std::env::var_os("TEXBAKE_CHROMIUM").filter(|name| !name.is_empty()).map(PathBuf::from);
    let path = std::env::var_os("PATH").unwrap_or_default();
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let found = std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name)));
    let browser = named.or_else(|| found.into_iter().find(|program| program.is_file()));
    if browser.is_none() {
        println!("not tested: no chromium on PATH, and TEXBAKE_CHROMIUM names none");
        let required = std::env::var("TEXBAKE_REQUIRE_BROWSER").is_ok_and(|value| value == "1");
        assert!(!required, "TEXBAKE_REQUIRE_BROWSER=1, but there is no chromium");
    }
    browser
}

/// Opens a page in a browser of its own and waits for its last words; `None` without a browser.
fn opened(page: &str, flags: &[&str]) -> Option<Told> {
    let browser = browser()?;
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("verify.html");
    std::fs::write(&file, page).unwrap();
    let child = Command::new(&browser)
        .args(["--headless=new", "--no-sandbox", "--no-first-run", "--enable-logging=stderr"])
        .args(flags)
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("file://{}", file.display()))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| panic!("{}: {error}", browser.display()));
    Some(Running::new(child).told())
}

/// A browser and what it says on stderr.
struct Running {
    child: Child,
    lines: Receiver<String>,
}

impl Running {
    fn new(mut child: Child) -> Self {
        let (send, lines) = channel();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        std::thread::spawn(move || {
            // Its words need not be UTF-8.
            for line in stderr.split(b'\n').map_while(Result::ok) {
                if send.send(String::from_utf8_lossy(&line).into_owned()).is_err() {
                    break;
                }
            }
        });
        Self { child, lines }
    }

    /// The last two lines of the page's console.
    fn told(self) -> Told {
        let begun = Instant::now();
        let (mut said, mut sentence) = (Vec::new(), None);
        loop {
            let line = match self.lines.recv_timeout(PATIENCE.saturating_sub(begun.elapsed())) {
                Ok(line) => line,
                Err(RecvTimeoutError::Timeout) => panic!("no report within {PATIENCE:?}; it said: {said:#?}"),
                Err(RecvTimeoutError::Disconnected) => panic!("the browser ended without a report: {said:#?}"),
            };
            if let Some((_, json)) = line.split_once("\"texbake verify report: ") {
                // The browser adds where in the page it was written.
                let report = serde_json::Deserializer::from_str(json).into_iter().next();
                let report = report.and_then(Result::ok).unwrap_or_else(|| panic!("no report in {line}"));
                return Told { line: sentence.expect("a sentence before the report"), report };
            }
            if let Some((_, rest)) = line.split_once("\"texbake verify: ") {
                sentence = rest.split_once("\", source: ").map(|(words, _)| words.to_owned());
            }
            said.push(line);
        }
    }
}

impl Drop for Running {
    /// Ends the browser and all its processes, which write to its profile until then.
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        // The last of them closes stderr.
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_secs(20)
            && self.lines.recv_timeout(Duration::from_secs(1)) != Err(RecvTimeoutError::Disconnected)
        {}
    }
}

fn page(sabotaged: bool) -> Page {
    Page::new(&Options::default(), sabotaged, &Monitor::default(), &mut |_| ()).unwrap()
}

const BEFORE_DATA: &str = "<script id=\"recordings\" type=\"application/json\">";

/// A page with other data.
fn edited(page: &str, edit: impl FnOnce(&mut Value)) -> String {
    let (head, rest) = page.split_once(BEFORE_DATA).unwrap();
    let (data, tail) = rest.split_once("</script>").unwrap();
    let mut data = serde_json::from_str(data).unwrap();
    edit(&mut data);
    format!("{head}{BEFORE_DATA}{}</script>{tail}", data.to_string().replace('<', "\\u003c"))
}

/// A page with the first `count` cases of each operation in each precision.
fn shortened(page: &str, count: usize) -> String {
    edited(page, |data| {
        let mut seen = BTreeMap::new();
        data["cases"].as_array_mut().unwrap().retain(|case| {
            let seen = seen.entry(line_of(case["name"].as_str().unwrap())).or_insert(0);
            *seen += 1;
            *seen <= count
        });
    })
}

/// A page before which a script has changed what the browser offers.
fn with_script(page: &str, script: &str) -> String {
    page.replacen(BEFORE_DATA, &format!("<script>{script}</script>{BEFORE_DATA}"), 1)
}

/// A page whose report holds its title and its words, as a reader sees them: `seen`.
fn with_words(page: &str) -> String {
    let script = "const log = console.log;
        console.log = (line) => {
            const seen = JSON.stringify(`${document.title}\n${document.body.innerText}`);
            log(line.replace(\"report: {\", () => `report: {\"seen\":${seen},`));
        };";
    with_script(page, script)
}

/// A page with one case alone, the first for which this holds.
fn with_one_case(page: &str, is_it: impl Fn(&Value) -> bool) -> String {
    edited(page, |data| {
        let cases = data["cases"].as_array_mut().unwrap();
        let place = cases.iter().position(is_it).expect("a case as it is wanted");
        *cases = vec![cases.swap_remove(place)];
    })
}

/// Gives the first code of a case's first map other bytes.
fn set_first_code(case: &mut Value, code: &[u8]) {
    let bytes = &mut case["expected"][0]["bytes"];
    let mut decoded = BASE64_STANDARD.decode(bytes.as_str().unwrap()).unwrap();
    decoded[..code.len()].copy_from_slice(code);
    *bytes = BASE64_STANDARD.encode(decoded).into();
}

fn first_byte(case: &Value) -> u8 {
    BASE64_STANDARD.decode(case["expected"][0]["bytes"].as_str().unwrap()).unwrap()[0]
}

/// Operation and precision of a case.
fn line_of(name: &str) -> String {
    name.split(", ").take(2).collect::<Vec<_>>().join(", ")
}

fn names(list: &Value) -> Vec<&str> {
    list.as_array().unwrap().iter().map(|case| case["name"].as_str().unwrap()).collect()
}

/// Operations times precisions: normal, parallax, both, parallax of given normals, blend, three methods of tangents.
const LINES: usize = 8 * 2;

#[test]
fn every_case_agrees() {
    let page = page(false);
    let Some(Told { line, report }) = opened(page.html(), &SWIFTSHADER) else { return };
    assert_eq!(line, format!("{} cases agree, 0 differ", page.cases()), "{report:#}");
    assert_eq!(report["values"], page.values(), "{report:#}");
    assert_eq!((&report["failed"], &report["unusable"]), (&json!(0), &Value::Null));
    assert_eq!(
        (&report["not_run"], &report["differences"], &report["failed_checks"]),
        (&json!(0), &json!(0), &json!(0))
    );
    // Fast has other bits than exact, within its bounds.
    assert!(report["values_with_other_bits"].as_u64().unwrap() > 0, "{report:#}");
    assert!(report["adapter"].as_str().unwrap().contains("swiftshader"), "{report:#}");
    assert!(page.cases() > 200 && page.values() > 400_000, "{} cases, {} values", page.cases(), page.values());
    println!("{} seconds; slowest to compile: {:#}", report["seconds"], report["slowest"]);
}

#[test]
fn sabotage_is_noticed_in_every_comparison() {
    // The first three fast blends store floats, in which no changed constant shows.
    let page = shortened(page(true).html(), 5);
    let Some(Told { report, .. }) = opened(&with_words(&page), &SWIFTSHADER) else { return };
    assert_eq!(report["failed"], 0, "{report:#}");
    let lines: BTreeSet<_> = names(&report["differing"]).into_iter().map(line_of).collect();
    assert_eq!(lines.len(), LINES, "{lines:#?}");
    assert_eq!(report["unnoticed"], json!([]));
    let seen = report["seen"].as_str().unwrap();
    assert!(seen.starts_with("sabotaged on purpose: must differ"), "{seen}");
    for words in ["Sabotaged on purpose: must differ", "a constant of each kernel changed on purpose"] {
        assert!(seen.contains(words), "no {words:?} in {seen}");
    }
    assert!(!seen.contains("as it stands in texbake"), "{seen}");
}

#[test]
fn sabotage_that_changes_nothing_is_not_noticed() {
    let honest = with_one_case(page(false).html(), |case| case["precision"] == "exact");
    let line = "normal map, exact";
    let page = edited(&honest, |data| data["notes"].as_array_mut().unwrap().push(json!(["sabotage", "none"])));
    let Some(Told { report, .. }) = opened(&with_words(&page), &SWIFTSHADER) else { return };
    assert_eq!(report["unnoticed"], json!([line]), "{report:#}");
    assert!(report["seen"].as_str().unwrap().contains(&format!("Not noticed in: {line}.")), "{report:#}");
    let Told { report, .. } = opened(&with_words(&honest), &SWIFTSHADER).unwrap();
    let seen = report["seen"].as_str().unwrap();
    assert!(seen.starts_with("Every case agrees") && seen.contains("as it stands in texbake"), "{seen}");
    assert!(!seen.to_lowercase().contains("sabotaged"), "{seen}");
}

/// Of tangents the kernels' outputs are compared, which corners share.
#[test]
fn values_are_counted_as_the_terminal_counts_them() {
    for only in ["normal map", "parallax map", "both in one pass", "parallax map of given normals", "blend"] {
        let options = Options { only: Some(only.into()), full: true, ..Options::default() };
        let page = Page::new(&options, false, &Monitor::default(), &mut |_| ()).unwrap();
        let options = Options { full: false, ..options };
        let report = Subject::cpu().verify(&options, &Monitor::default(), &mut |_| ()).unwrap();
        let values: u64 = report.comparisons.iter().map(|it| it.agreement.values).sum();
        assert!(values > 0);
        assert_eq!(page.values() as u64, values, "{only}");
    }
}

/// Flat maps: their x is 0 in every precision, so that an expected x is the error.
#[test]
fn fast_agrees_at_its_bound_and_differs_one_step_beyond() {
    let options = Options { only: Some("fast, scale 0".into()), full: true, ..Options::default() };
    let page = Page::new(&options, false, &Monitor::default(), &mut |_| ()).unwrap();
    let page = edited(page.html(), |data| {
        let all = data["cases"].as_array().unwrap();
        let mut cases = Vec::new();
        for (code, channels) in [("i8", 3), ("f16", 2), ("f32", 3)] {
            let is_it = |map: &Value| map["name"] == "normal" && map["code"] == code && map["channels"] == channels;
            let case = all.iter().find(|case| is_it(&case["expected"][0])).expect("a flat map of this type");
            let bound = |unit: &str| case["expected"][0]["tolerance"][unit].as_f64().unwrap();
            for (name, bytes) in [("at", at(code, bound)), ("beyond", beyond(code, bound)), ("NaN", nan(code))] {
                let mut case = case.clone();
                set_first_code(&mut case, &bytes);
                case["name"] = format!("{code}, {name}").into();
                cases.push(case);
            }
        }
        data["cases"] = cases.into();
    });
    let Some(Told { line, report }) = opened(&page, &SWIFTSHADER) else { return };
    assert_eq!(line, "3 cases agree, 6 differ", "{report:#}");
    let beyond = ["i8, beyond", "i8, NaN", "f16, beyond", "f16, NaN", "f32, beyond", "f32, NaN"];
    assert_eq!(names(&report["differing"]), beyond);
}

/// The x that is as far from 0 as `fast` may be: codes of integers, units of half floats, and an angle from z of floats.
fn at(code: &str, bound: impl Fn(&str) -> f64) -> Vec<u8> {
    match code {
        "i8" => vec![bound("codes") as u8],
        "f16" => f16::from_f64(bound("ulps") / 1024.0).to_le_bytes().to_vec(),
        _ => farthest(bound("degrees")).to_le_bytes().to_vec(),
    }
}

/// One step more.
fn beyond(code: &str, bound: impl Fn(&str) -> f64) -> Vec<u8> {
    match code {
        "i8" => vec![bound("codes") as u8 + 1],
        "f16" => (f16::from_f64(bound("ulps") / 1024.0).to_bits() + 1).to_le_bytes().to_vec(),
        _ => farthest(bound("degrees")).next_up().to_le_bytes().to_vec(),
    }
}

/// What is beyond every bound; of integers the number farthest from 0.
fn nan(code: &str) -> Vec<u8> {
    match code {
        "i8" => vec![0x80],
        "f16" => f16::NAN.to_le_bytes().to_vec(),
        _ => f32::NAN.to_le_bytes().to_vec(),
    }
}

/// The greatest x of a vector (x, 0, 1) that is turned from z by no more than so many degrees.
fn farthest(degrees: f64) -> f32 {
    let x = degrees.to_radians().tan() as f32;
    if f64::from(x).atan().to_degrees() > degrees { x.next_down() } else { x }
}

#[test]
fn a_difference_at_a_border_shows_what_the_edge_mode_takes_there() {
    let page = page(false);
    for (edge, west) in [("wrap", 66), ("mirror", 1), ("clamp", 0)] {
        let is_it = |case: &Value| {
            let name = case["name"].as_str().unwrap();
            let width = case["given"][0]["row_bytes"].as_u64().unwrap();
            name.starts_with("normal map, exact, u8, ") && name.contains(&format!(", {edge}")) && width == 67
        };
        let page = with_one_case(page.html(), is_it);
        let mut name = String::new();
        let page = edited(&page, |data| {
            let case = &mut data["cases"][0];
            name = case["name"].as_str().unwrap().to_owned();
            let byte = first_byte(case);
            set_first_code(case, &[byte ^ 0x08]);
        });
        let Some(Told { report, .. }) = opened(&with_words(&page), &SWIFTSHADER) else { return };
        let seen = report["seen"].as_str().unwrap();
        assert_eq!(report["differ"], 1, "{report:#}");
        assert!(seen.contains(&format!("column {west}\tcolumn 0\tcolumn 1")), "{name}: {seen}");
        assert!(seen.contains(&format!("texbake verify --seed 1 --only \"{name}\"")), "{name}: {seen}");
    }
}

/// A minute of compiling is no silence, and silence after it is.
#[test]
fn patience_begins_when_the_kernels_are_compiled() {
    let script = "const armed = new Set();
        const soon = setTimeout;
        setTimeout = (act, wait) => (wait > 1000 ? (armed.add(act), act) : soon(act, wait));
        clearTimeout = (act) => armed.delete(act);
        const passTime = () => armed.forEach((act) => act());
        const create = GPUDevice.prototype.createComputePipelineAsync;
        GPUDevice.prototype.createComputePipelineAsync = async function (kernel) {
            const pipeline = await create.call(this, kernel);
            passTime();
            return pipeline;
        };";
    let page = with_one_case(page(false).html(), |_| true);
    let Some(Told { line, report }) = opened(&with_script(&page, script), &SWIFTSHADER) else { return };
    assert_eq!(line, "1 cases agree, 0 differ", "{report:#}");
    let silence = "GPUBuffer.prototype.mapAsync = () => new Promise(() => soon(passTime));";
    let silent = format!("{script} {silence}");
    let Told { line, report } = opened(&with_script(&page, &silent), &SWIFTSHADER).unwrap();
    assert_eq!(line, "0 cases agree, 0 differ, 1 failed", "{report:#}");
    assert_eq!(report["reasons"], json!(["The device has not answered within 120 seconds."]));
}

#[test]
fn a_device_that_computes_nothing_is_noticed_in_every_case() {
    let page = shortened(page(false).html(), 1);
    let page = with_script(&page, "GPUComputePassEncoder.prototype.dispatchWorkgroups = () => {};");
    let Some(Told { line, report }) = opened(&page, &SWIFTSHADER) else { return };
    assert_eq!(line, format!("0 cases agree, {LINES} differ"), "{report:#}");
}

#[test]
fn one_wrong_bit_is_noticed() {
    let page = edited(&shortened(page(false).html(), 1), |data| {
        // The first code of the first case, with its lowest bit the other way round: the page is of exact codes.
        let bytes = &mut data["cases"][0]["expected"][0]["bytes"];
        let text = bytes.as_str().unwrap().to_owned();
        // Of base64 the second character has the lowest two bits of the first byte on top.
        let other = ALPHABET[ALPHABET.iter().position(|it| *it == text.as_bytes()[1]).unwrap() ^ 16];
        *bytes = format!("{}{}{}", &text[..1], char::from(other), &text[2..]).into();
    });
    let Some(Told { line, report }) = opened(&page, &SWIFTSHADER) else { return };
    assert_eq!(line, format!("{} cases agree, 1 differ", LINES - 1), "{report:#}");
    assert_eq!((&report["differences"], &report["differing"][0]["largest"]["codes"]), (&json!(1), &json!(1)));
}

/// Of base64.
const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

#[test]
fn a_lost_device_fails_what_is_left() {
    let script = "const request = GPUAdapter.prototype.requestDevice;
        GPUAdapter.prototype.requestDevice = async function () {
            const device = await request.call(this);
            let submissions = 0;
            const submit = device.queue.submit.bind(device.queue);
            device.queue.submit = (commands) => (++submissions > 3 ? device.destroy() : submit(commands));
            return device;
        };";
    let page = with_script(&shortened(page(false).html(), 1), script);
    let Some(Told { line, report }) = opened(&page, &SWIFTSHADER) else { return };
    assert_eq!(line, format!("3 cases agree, 0 differ, {} failed", LINES - 3), "{report:#}");
    assert_eq!(names(&report["failing"]).len(), LINES - 3);
    assert!(report["reasons"][0].as_str().unwrap().starts_with("The device was lost"), "{report:#}");
}

#[test]
fn a_kernel_that_is_refused_fails_its_cases() {
    let page = edited(&shortened(page(false).html(), 1), |data| {
        let text = &mut data["kernels"][0]["text"];
        *text = text.as_str().unwrap().replace("const TEXELS: u32 = 4u;", "const TEXELS: u32 = ;").into();
    });
    let Some(Told { report, .. }) = opened(&page, &SWIFTSHADER) else { return };
    assert!(report["failed"].as_u64().unwrap() > 0 && report["agree"].as_u64().unwrap() > 0, "{report:#}");
    let reason = report["reasons"][0].as_str().unwrap();
    assert!(reason.starts_with("The kernel \"bake, ") && reason.contains("is refused: line "), "{reason}");
}

#[test]
fn a_page_that_compares_nothing_fails() {
    let page = shortened(page(false).html(), 1);
    let empty = edited(&page, |data| data["cases"] = json!([]));
    let Some(Told { line, report }) = opened(&empty, &SWIFTSHADER) else { return };
    assert_eq!((line.as_str(), &report["passed"]), ("0 cases agree, 0 differ", &Value::Bool(false)), "{report:#}");
    for without in [json!([]), json!(null)] {
        let blind = edited(&page, |data| {
            let expected = &mut data["cases"][0]["expected"];
            match without {
                Value::Null => (expected[0]["rows"], expected[0]["bytes"]) = (json!(0), json!("")),
                _ => *expected = without.clone(),
            }
        });
        let Told { line, report } = opened(&blind, &SWIFTSHADER).unwrap();
        assert_eq!(line, format!("{} cases agree, 0 differ, 1 failed", LINES - 1), "{report:#}");
        assert_eq!(report["reasons"], json!(["Nothing was compared."]));
    }
}

#[test]
fn without_webgpu_the_page_says_so() {
    let page = shortened(page(false).html(), 1);
    let without_api = with_script(&page, "delete Navigator.prototype.gpu;");
    for (page, flags, words) in [
        (&page, &[][..], "This browser has WebGPU, but offers no GPU for it."),
        (&without_api, &SWIFTSHADER[..], "This browser offers no WebGPU to this page, so nothing was compared."),
    ] {
        let Some(Told { line, report }) = opened(page, flags) else { return };
        assert_eq!(line, format!("0 cases agree, 0 differ, {LINES} not run"));
        assert_eq!((&report["failed"], &report["not_run"]), (&json!(0), &json!(LINES)));
        assert!(report["unusable"].as_str().unwrap().starts_with(words), "{report:#}");
        assert_eq!((&report["values"], &report["passed"]), (&json!(0), &Value::Bool(false)));
    }
}
