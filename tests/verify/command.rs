//! `texbake verify`: what it prints, its report, its exit status.

use crate::cli::support::{Folder, Run};
use serde_json::Value;

#[test]
fn what_agrees_is_a_table_a_report_and_status_0() {
    let folder = Folder::new();
    let run = folder.run(&["verify", "--backend", "cpu", "--json", "report.json", "--seed", "7"]).ends(0);
    let rows = |words: &str| -> Vec<String> {
        let rows = run.stdout.lines().filter(|line| line.trim_start().starts_with(words));
        rows.map(|row| row.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
    };
    let [exact] = &rows("normal map, exact ")[..] else { panic!("{}", run.stdout) };
    assert!(exact.starts_with("normal map, exact 192 ") && exact.ends_with(" 0 same bits"), "{exact}");
    let [fast] = &rows("normal map, fast ")[..] else { panic!("{}", run.stdout) };
    assert!(fast.starts_with("normal map, fast 144 ") && fast.ends_with(" in bounds"), "{fast}");
    let [errors] = &rows("normal map  ")[..] else { panic!("{}", run.stdout) };
    assert!(errors.contains("/8 ") && errors.ends_with("/2.5e-5"), "{errors}");
    assert!(run.stdout.contains(" codes of the specification were judged by the formulas in whole numbers\n"));
    // A terminal's usual width.
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 80), "{}", run.stdout);
    assert!(run.stderr.contains("verifying cpu, "), "{}", run.stderr);
    assert!(run.stdout.ends_with(", seed 7: it agrees in all 1492 cases\n"), "{}", run.stdout);

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
fn sabotage_is_printed_with_its_smallest_input_and_is_a_success_if_it_is_noticed() {
    let folder = Folder::new();
    let arguments = ["verify", "--backend", "cpu", "--sabotage", "--only", "normal map, exact, u8", "--json", "r.json"];
    let run = folder.run(&arguments).ends(0);
    for words in [
        "FAILED in ",
        "the smallest input that was found: scale ",
        "\n  heights, ",
        "\n    this device says ",
        "\n    the specification ",
        "\n    the formula         the component is ",
        "\n  again: texbake verify --backend cpu --seed 1 --sabotage --only \"normal map, exact, u8, ",
        ": sabotaged on purpose, and every comparison has noticed it\n",
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
    let again = folder.run(&["verify", "--backend", "cpu", "--seed", "1", "--sabotage", "--only", case]).ends(0);
    assert!(again.stdout.contains(&format!("this device says    {device}")), "{}", again.stdout);
}

#[test]
fn quiet_runs_print_failures_alone() {
    let folder = Folder::new();
    let case = "normal map, exact, u8, unorm 8 xyz gl|unorm 8 xyz dx";
    assert_eq!(folder.run(&["verify", "--backend", "cpu", "-q", "--only", case]).ends(0).stdout, "");
    let run = folder.run(&["verify", "--backend", "cpu", "-q", "--sabotage", "--only", case]).ends(0);
    assert!(run.stdout.contains("FAILED in "), "{}", run.stdout);
}

#[test]
fn what_cannot_be_verified_is_an_error() {
    let folder = Folder::new();
    let only = |words| folder.run(&["verify", "--backend", "cpu", "--only", words]).ends(2).stderr;
    let unknown = only("normal map, u9|u10");
    assert!(unknown.starts_with("error: --only is normal map, u9|u10: it must be words of a case's name"), "{unknown}");
    assert!(unknown.ends_with("no case has u9, u10\n"), "{unknown}");
    let apart = only("blend, wrap");
    assert!(apart.starts_with("error: --only is blend, wrap: it must be words that some case has together"), "{apart}");
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

/// Sabotage that nothing notices: a slope of 1e-6 more or less is within the bound of `fast`.
#[test]
fn sabotage_that_is_not_noticed_ends_with_status_1() {
    let folder = Folder::new();
    let arguments =
        ["verify", "--backend", "cpu", "--sabotage", "--only", "parallax map, fast, u8|u16, scale 0.000001"];
    let run = folder.run(&arguments).ends(1);
    assert!(
        run.stdout.ends_with(": sabotaged on purpose, and NOT every comparison has noticed it\n"),
        "{}",
        run.stdout
    );
}

#[cfg(feature = "gpu")]
#[test]
fn an_adapter_is_verified_by_its_name_and_a_page_is_written() {
    let folder = Folder::new();
    for subject in crate::support::every_baker().iter().filter(|subject| subject.name.contains(':')) {
        let only = "parallax map, exact, u8, random";
        let run = folder.run(&["verify", "--adapter", subject.name, "--only", only]).ends(0);
        assert!(run.stdout.starts_with("gpu, ") && run.stdout.contains("same bits"), "{}", run.stdout);
        let sabotaged = folder.run(&["verify", "--adapter", subject.name, "--only", only, "--sabotage"]).ends(0);
        let again = sabotaged.stdout.lines().find_map(|line| line.trim().strip_prefix("again: texbake ")).unwrap();
        let quoted: Vec<&str> = again.split('"').collect();
        let [options, adapter, more, case, _] = quoted[..] else { panic!("{again}") };
        let words = options.split_whitespace().chain([adapter]).chain(more.split_whitespace()).chain([case]);
        let repeated = folder.run(&words.collect::<Vec<_>>()).ends(0);
        assert!(repeated.stdout.contains("FAILED in 1"), "{}", repeated.stdout);
    }
    let run = folder.run(&["verify", "--html", "pages/v.html", "--only", "parallax map, exact, u8"]).ends(0);
    assert!(run.stdout.starts_with("pages/v.html: "), "{}", run.stdout);
    let page = std::fs::read_to_string(folder.path("pages/v.html")).unwrap();
    assert!(page.contains("fn bake(") && page.contains("parallax map, exact, u8"), "no kernel or no case");
}
