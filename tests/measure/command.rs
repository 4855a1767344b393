//! `texbake measure`: its files, its words, and what it refuses.

use crate::cli::support::{Folder, bumps8, read_png};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

const PLOTS: [&str; 13] = [
    "bake-time",
    "blend-time",
    "parallax-bake-time",
    "parallax-elevations",
    "parallax-elevations-mean",
    "parallax-fetches",
    "parallax-fetches-mean",
    "parallax-steps",
    "parallax-steps-mean",
    "parallax-storage",
    "parallax-time",
    "parallax-time-mean",
    "storage",
];

fn folder() -> Folder {
    let folder = Folder::new();
    folder.grey8("height.png", 48, 32, bumps8);
    folder
}

/// Takes away times, what follows from them, and what differs between runs on purpose.
fn without_times(value: &mut serde_json::Value) {
    match value {
        serde_json::Value::Object(fields) => {
            // The CPU's name counts its threads.
            let differs =
                |name: &str| ["command", "device", "devices"].contains(&name) || name.starts_with("nanoseconds");
            fields.retain(|name, _| !differs(name));
            fields.values_mut().for_each(without_times);
        }
        serde_json::Value::Array(items) => {
            items.retain(|item| item["cost_unit"].as_str().is_none_or(|unit| !unit.starts_with("ns")));
            items.iter_mut().for_each(without_times);
        }
        _ => {}
    }
}

#[test]
fn the_report_is_whole_and_its_errors_do_not_depend_on_threads() {
    let folder = folder();
    let arguments = |out| ["measure", "height.png", "--scale", "24", "--quick", "--backend", "cpu", "-o", out];
    let run = folder.run(&arguments("new/report")).ends(0);
    assert!(
        run.stdout.contains("storage of normal maps, by the error that 99 of 100 do not exceed:\n"),
        "{}",
        run.stdout
    );
    assert!(run.stdout.contains(" buys "), "{}", run.stdout);
    assert!(run.stdout.ends_with("new/report: report.json, report.md and plots\n"), "{}", run.stdout);
    assert_eq!(run.stderr, "measuring height.png, 69 steps\n");

    let mut files: Vec<String> = PLOTS.iter().flat_map(|name| [format!("{name}.png"), format!("{name}.svg")]).collect();
    files.extend(["report.json".into(), "report.md".into()]);
    files.sort();
    assert_eq!(folder.files("new/report"), files);
    let text = |name: &str| std::fs::read_to_string(folder.path(&format!("new/report/{name}"))).unwrap();
    let page = text("report.md");
    for name in PLOTS {
        let (width, height, codes) = read_png(&folder.path(&format!("new/report/{name}.png")));
        assert_eq!((width, height, codes.as_ref().len()), (960, 600, 960 * 600 * 3));
        let svg = text(&format!("{name}.svg"));
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"), "{name}");
        assert!(page.contains(&format!("]({name}.png)")), "{name}");
    }
    assert!(page.contains("texbake measure height.png --scale 24 --quick --backend cpu -o new/report"), "{page}");

    let mut report = folder.json("new/report/report.json");
    for (list, count) in
        [("normal_maps", 32), ("parallax_maps", 16), ("blends", 14), ("offsets", 75), ("frames", 16), ("fronts", 9)]
    {
        assert_eq!(report[list].as_array().unwrap().len(), count, "{list}");
    }
    assert_eq!((&report["seed"], &report["runs"], &report["quick"]), (&1.into(), &1.into(), &true.into()));
    assert_eq!(report["input"]["scale_texels"], serde_json::json!([24.0, 24.0]));
    assert_eq!(report["command"], "texbake measure height.png --scale 24 --quick --backend cpu -o new/report");
    for key in ["cpu", "system", "devices"] {
        assert!(!report["machine"][key].is_null(), "{key}");
    }
    let one_thread = folder.command(&arguments("one")).env("RAYON_NUM_THREADS", "1").output().unwrap();
    assert!(one_thread.status.success());
    let mut of_one_thread = folder.json("one/report.json");
    without_times(&mut report);
    without_times(&mut of_one_thread);
    assert_eq!(report, of_one_thread);
}

#[cfg(feature = "gpu")]
#[test]
fn adapters_are_measured_besides_the_cpu() {
    if std::env::var("TEXBAKE_REQUIRE_GPU").is_err() && texbake::Baker::gpu(Some("vulkan:llvmpipe")).is_err() {
        println!("not tested: no vulkan:llvmpipe");
        return;
    }
    let folder = folder();
    let arguments = ["measure", "height.png", "-o", "out", "--quick", "--adapter", "vulkan:llvmpipe", "-q"];
    let run = folder.run(&arguments).ends(0);
    assert_eq!(run.stdout, "");
    let report = folder.json("out/report.json");
    let devices = report["machine"]["devices"].as_array().unwrap();
    assert_eq!(devices.len(), 2, "{devices:?}");
    assert!(devices[1].as_str().unwrap().contains("llvmpipe"), "{devices:?}");
    assert_eq!(report["normal_maps"].as_array().unwrap().len(), 64);
    // Every parallax method at the elevation of the fronts, timed by the shader library's own text.
    assert_eq!((report["offset_times"].as_array().unwrap().len(), &report["notes"]), (25, &serde_json::json!([])));
}

#[test]
fn a_map_that_is_reduced_keeps_its_height() {
    let folder = folder();
    let reduced = ["--scale", "24", "--shrink", "2", "-o", "out", "--quick", "--backend", "cpu", "-q"];
    folder.run(&[&["measure", "height.png"], &reduced[..]].concat()).ends(0);
    let input = &folder.json("out/report.json")["input"];
    assert_eq!((&input["width"], &input["scale_texels"]), (&24.into(), &serde_json::json!([12.0, 12.0])));
}

#[test]
fn what_is_wrong_is_said_before_anything_is_measured() {
    let folder = folder();
    folder.file("taken", "a file");
    folder.grey8("own/storage.png", 4, 4, bumps8);
    for (arguments, status, parts) in [
        (&["missing.png", "-o", "out"][..], 1, &["missing.png"][..]),
        (
            &["height.png", "-o", "out", "--elevation", "90"],
            2,
            &["--elevation is 90: it must be 1 degree or more, and below 90"],
        ),
        (&["height.png", "-o", "out", "--precision", "fast"], 2, &["--precision is fast: it must be left out"]),
        (&["height.png", "-o", "out", "--size", "2x2"], 2, &["--depth is missing"]),
        (&["height.png", "-o", "out", "--runs", "0"], 2, &["--runs", "1..=1000"]),
        (&["height.png", "-o", "out", "--runs", "18446744073709551615"], 2, &["--runs"]),
        (&["height.png", "-o", "out", "--runs", "1001"], 2, &["--runs", "1..=1000"]),
        (
            &["height.png", "-o", "out", "--backend", "cpu", "--adapter", "x"],
            2,
            &["--adapter is x: it must be left out"],
        ),
        (&["height.png", "-o", "taken"], 1, &["taken"]),
        (&["height.png", "-o", "out", "--detail", "taken"], 1, &["taken"]),
        (&["height.png", "-o", "out", "--model", "taken"], 1, &["taken"]),
        (&["own/storage.png", "-o", "own"], 1, &["own/storage.png", "would overwrite this input", "another folder"]),
    ] {
        let run = folder.run(&[&["measure", "--quick"], arguments].concat()).ends(status);
        for part in parts {
            assert!(run.stderr.contains(part), "{arguments:?}: {part:?} is not in: {}", run.stderr);
        }
        assert!(!run.stderr.contains("measuring"), "{arguments:?}: {}", run.stderr);
    }
    assert_eq!(folder.files("out"), [""; 0]);
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_the_old_report_whole() {
    let folder = Folder::new();
    folder.grey8("height.png", 1024, 1024, bumps8);
    folder.file("out/report.json", "the old one");
    // So many runs that no machine is done before the signal comes.
    let arguments = ["measure", "height.png", "-o", "out", "--backend", "cpu", "--runs", "1000"];
    let mut child = folder.command(&arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert_eq!(lines.next().unwrap().unwrap(), "measuring height.png, 72 steps");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let said: Vec<String> = lines.map(Result::unwrap).collect();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said:?}");
    assert_eq!(said.last().unwrap(), "out was not written");
    assert_eq!(folder.files("out"), ["report.json"]);
    assert_eq!(std::fs::read_to_string(folder.path("out/report.json")).unwrap(), "the old one");
}
