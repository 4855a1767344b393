//! `texbake verify`: what it prints, its report, its exit status.

use crate::cli::support::{Folder, Run};
use serde_json::Value;

#[test]
fn what_agrees_is_a_table_a_report_and_status_0() {
    let folder = Folder::new();
    let run = folder.run(&["verify", "--backend", "cpu", "--json", "report.json", "--seed", "7"]).ends(0);
    let line = |words: [&str; 3]| {
        let found = run
            .stdout
            .lines()
            .find(|line| line.split_whitespace().take(4).collect::<Vec<_>>().join(" ").starts_with(&words.join(" ")));
        found.unwrap_or_else(|| panic!("no line of {words:?}:\n{}", run.stdout)).to_owned()
    };
    let exact = line(["normal", "map", "exact"]);
    assert!(exact.contains(" 192 ") && exact.ends_with("the same bits"), "{exact}");
    let fast = line(["normal", "map", "fast"]);
    assert!(fast.contains(", 8 ") && fast.contains(", 2.5e-5") && fast.ends_with("within the bounds"), "{fast}");
    assert!(run.stdout.ends_with(", seed 7: the device agrees in everything\n"), "{}", run.stdout);

    let report = folder.json("report.json");
    assert_eq!(report["seed"], 7);
    assert_eq!((&report["full"], &report["sabotaged"]), (&Value::Bool(false), &Value::Bool(false)));
    let device = &report["devices"][0];
    assert!(device["device"].as_str().unwrap().starts_with("cpu, "));
    assert_eq!(device["failure"], Value::Null);
    let comparisons = device["comparisons"].as_array().unwrap();
    assert_eq!(comparisons.len(), 16);
    for comparison in comparisons {
        assert_eq!(comparison["failed_cases"], 0);
        assert_eq!(comparison["mismatch"], Value::Null);
        assert!(comparison["agreement"]["values"].as_u64().unwrap() > 0);
    }
}

#[test]
fn sabotage_is_printed_with_its_smallest_input_and_ends_with_status_1() {
    let folder = Folder::new();
    let arguments = ["verify", "--backend", "cpu", "--sabotage", "--only", "normal map, exact, u8", "--json", "r.json"];
    let run = folder.run(&arguments).ends(1);
    for words in [
        "FAILED in ",
        "the smallest input that was found: scale ",
        "\n  heights, ",
        "\n    the device says ",
        "\n    the specification ",
        "\n    the formula         the component is ",
        "\n  again: texbake verify --backend cpu --seed 1 --sabotage --only \"normal map, exact, u8, ",
        ", sabotaged: 1 of 1 FAILED\n",
    ] {
        assert!(run.stdout.contains(words), "no {words:?}:\n{}", run.stdout);
    }
    let report = folder.json("r.json");
    assert_eq!(report["sabotaged"], true);
    let mismatch = &report["devices"][0]["comparisons"][0]["mismatch"];
    assert!(mismatch["input"].as_str().unwrap().starts_with("scale "), "{mismatch}");
    // The command that is printed repeats it.
    let case = mismatch["case"].as_str().unwrap();
    let device = format!("{} ({:#x})", mismatch["device"]["number"], mismatch["device"]["bits"].as_u64().unwrap());
    let device = device.replace(".0 ", " ");
    let again = folder.run(&["verify", "--backend", "cpu", "--seed", "1", "--sabotage", "--only", case]).ends(1);
    assert!(again.stdout.contains(&format!("the device says     {device}")), "{}", again.stdout);
}

#[test]
fn quiet_runs_print_failures_alone() {
    let folder = Folder::new();
    let case = "normal map, exact, u8, unorm 8 xyz gl|unorm 8 xyz dx";
    assert_eq!(folder.run(&["verify", "--backend", "cpu", "-q", "--only", case]).ends(0).stdout, "");
    let run = folder.run(&["verify", "--backend", "cpu", "-q", "--sabotage", "--only", case]).ends(1);
    assert!(run.stdout.contains("FAILED in "), "{}", run.stdout);
}

#[test]
fn what_cannot_be_verified_is_an_error() {
    let folder = Folder::new();
    let unknown = folder.run(&["verify", "--backend", "cpu", "--only", "normal map, u9"]).ends(2);
    let wanted = "error: --only is normal map, u9: it must be words of a case's name with commas between them";
    assert!(unknown.stderr.starts_with(wanted), "{}", unknown.stderr);
    let missing = folder.run(&["verify", "--adapter", "no such adapter"]).ends(1);
    assert!(missing.stderr.starts_with("error: adapter \"no such adapter\": "), "{}", missing.stderr);
    // What was not verified is no success.
    let mut none = folder.command(&["verify", "--only", "normal map, exact, u8, random"]);
    for drivers in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "__EGL_VENDOR_LIBRARY_FILENAMES"] {
        none.env(drivers, "/nonexistent");
    }
    let none = Run::from(none.output().unwrap()).ends(1);
    assert!(none.stdout.contains("FAILED: this machine has no adapter that runs compute kernels"), "{}", none.stdout);
    assert!(none.stdout.ends_with("1 of 2 FAILED\n"), "{}", none.stdout);
    let both = folder.run(&["verify", "--adapter", "a", "--backend", "cpu"]).ends(2);
    assert!(both.stderr.contains("cannot be used with"), "{}", both.stderr);
}
