//! The JSON report, field by field.

use super::support::{Folder, bumps8, bumps16};
use serde_json::{Value, json};

/// What a run measures itself stands apart from what it must say.
fn take(object: &mut Value, key: &str) -> Value {
    object.as_object_mut().unwrap().remove(key).unwrap_or_else(|| panic!("there is no {key}"))
}

#[test]
fn a_folder_is_reported_file_by_file() {
    let folder = Folder::new();
    folder.grey16("tex/a_height.png", 20, 10, bumps16);
    folder.grey8("tex/b_height_2k.png", 4, 4, bumps8);
    folder.file("tex/c_height.png", "");
    folder.file(
        "tex/texbake.toml",
        "[[override]]\nglob = 'b_*'\nsize = '2x1'\ndepth = 0.1\nbits = 16\nchannels = 'xy'\n",
    );
    let arguments = ["bake", "tex", "--out", "out", "--backend", "reference", "--edge", "wrap,clamp", "-q"];
    let run = folder.run(&[&arguments[..], &["--report", "report.json"]].concat()).ends(1);
    assert_eq!(run.stdout, "");

    let mut report = folder.json("report.json");
    let mut files = take(&mut report, "files");
    let mut totals = take(&mut report, "totals");
    let expected = json!({
        "version": env!("CARGO_PKG_VERSION"), "settings": "tex/texbake.toml", "errors": [], "warnings": [],
        "left_out": [],
    });
    assert_eq!(report, expected);

    let bytes = |name: &str| std::fs::metadata(folder.path(name)).unwrap().len();
    let (seconds, rate) = (take(&mut totals, "seconds"), take(&mut totals, "megatexels_per_second"));
    let (seconds, rate) = (seconds.as_f64().unwrap(), rate.as_f64().unwrap());
    assert!(seconds > 0.0 && (rate * seconds * 1e6 / 216.0 - 1.0).abs() < 1e-9, "{seconds} {rate}");
    assert_eq!(
        totals,
        json!({
            "files": 3, "baked": 2, "fresh": 0, "failed": 1, "stopped": 0, "not_begun": 0, "texels": 216,
            "bytes_in": bytes("tex/a_height.png") + bytes("tex/b_height_2k.png"),
            "bytes_out": bytes("out/a_normal.png") + bytes("out/b_normal_2k.png"),
        })
    );

    let files = files.as_array_mut().unwrap();
    for file in files.iter_mut() {
        assert!(take(file, "milliseconds").as_f64().unwrap() > 0.0);
    }
    let mut options = json!({
        "scale": "1", "filter": "central", "edge": "wrap,clamp", "maps": "normal", "encoding": "unorm", "bits": "8",
        "channels": "xyz", "convention": "gl", "parallax_encoding": null, "parallax_bits": null, "iterations": null,
        "precision": "exact", "compression": "fast", "mips": false, "roughness_method": null, "base_roughness": null,
        "roughness_bits": null, "block_compression": null, "neighbours": null, "channel": null,
        "color_space": "linear", "raw": null, "shrink": 1, "max_bytes": 4_294_967_296u64,
    });
    assert_eq!(
        files[0],
        json!({
            "input": "tex/a_height.png", "normals": null, "parallax": null, "stale": "new",
            "outputs": { "normal": "out/a_normal.png", "parallax": null }, "result": "baked", "error": null,
            "warnings": [], "options": options, "backend": "cpu", "adapter": "reference, 1 thread",
            "reason": "asked for", "fallback": null, "width": 20, "height": 10, "depth": "u16",
            "scale": { "x": "1", "y": "1", "exact": true },
            "bytes_in": bytes("tex/a_height.png"), "bytes_out": bytes("out/a_normal.png"),
        })
    );
    assert_eq!(files[2]["error"], "tex/c_height.png: the file is empty; copy or export it again");
    assert_eq!(files[2]["result"], "failed");
    assert_eq!([&files[2]["backend"], &files[2]["width"], &files[2]["scale"]], [&Value::Null; 3]);
    assert_eq!([&files[2]["bytes_in"], &files[2]["bytes_out"]], [&json!(0); 2]);
    assert_eq!(files[2]["options"], options);

    options["scale"] = "2 x 1 by 0.1 high".into();
    options["bits"] = "16".into();
    options["channels"] = "xy".into();
    assert_eq!(files[1]["options"], options);
    // 0.1 over 2 / 4 and over 1 / 4.
    assert_eq!(files[1]["scale"], json!({ "x": "0.2", "y": "0.4", "exact": true }));
    assert_eq!(files[1]["outputs"]["normal"], "out/b_normal_2k.png");
}

#[test]
fn what_textures_and_tiles_were_asked_for_is_reported() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 4, 4, bumps8);
    let options = |arguments: &[&str]| {
        let bake = ["bake", "tex", "--out", "out", "--backend", "reference", "-q", "--report", "r.json"];
        folder.run(&[&bake, arguments].concat()).ends(0);
        take(&mut folder.json("r.json")["files"][0], "options")
    };
    let found = options(&[
        "--format=dds",
        "--maps=normal,roughness",
        "--mips",
        "--block-compression=bc5",
        "--roughness-method=toksvig",
        "--base-roughness=1/4",
    ]);
    for (name, expected) in [
        ("maps", json!("normal,roughness")),
        ("encoding", json!("unorm")),
        ("mips", json!(true)),
        ("roughness_method", json!("toksvig")),
        ("base_roughness", json!("0.25")),
        ("roughness_bits", json!("8")),
        ("block_compression", json!("bc5")),
    ] {
        assert_eq!(found[name], expected, "{name}");
    }
    folder.grey8("tex/t_0_0_height.png", 4, 4, bumps8);
    folder.grey8("tex/t_1_0_height.png", 4, 4, bumps8);
    std::fs::remove_file(folder.path("tex/a_height.png")).unwrap();
    let found = options(&["--neighbours", "t_{x}_{y}_height.png", "--edge", "clamp"]);
    assert_eq!(found["neighbours"], json!({ "right": "t_1_0_height.png" }));
    let found = options(&["--neighbours", "t_{x}_{y}_height.png", "--edge", "wrap"]);
    let sides = json!({ "left": "t_1_0_height.png", "right": "t_1_0_height.png" });
    assert_eq!(found["neighbours"], sides);
}

#[test]
fn one_file_is_reported_too() {
    let folder = Folder::new();
    folder.grey8("h.png", 3, 2, bumps8);
    folder.run(&["normal", "h.png", "-o", "n.png", "--report", "r.json", "--scale", "3.14159265358979", "-q"]).ends(0);
    let report = folder.json("r.json");
    assert_eq!((&report["settings"], &report["totals"]["baked"]), (&Value::Null, &json!(1)));
    let file = &report["files"][0];
    assert_eq!((&file["input"], &file["outputs"]["normal"]), (&json!("h.png"), &json!("n.png")));
    assert_eq!(file["scale"], json!({ "x": "5419351/1725033", "y": "5419351/1725033", "exact": false }));
    assert!(file["warnings"][0].as_str().unwrap().contains("too many digits"));
}

#[test]
fn a_report_that_cannot_be_written_is_known_before_the_bake() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 3, 3, bumps8);
    for (report, parts) in [
        ("tex/a_height.png/r.json", ["tex/a_height.png/r.json", "a part of its path is a file"]),
        ("tex", ["it is a folder", "give the name of a file"]),
        ("tex/a_height.png", ["the report would overwrite the input tex/a_height.png", "another name for the report"]),
        ("out/../out/a_normal.png", ["the report would overwrite the output out/a_normal.png", "another name"]),
    ] {
        let run = folder.run(&["bake", "tex", "--out", "out", "--report", report]).ends(1);
        run.says("error: ", &parts);
    }
    assert_eq!(folder.files("."), ["tex/a_height.png"]);
    // The outputs' folder need not exist yet.
    folder.run(&["bake", "tex", "--out", "out", "--report", "out/r.json"]).ends(0);
    assert_eq!(folder.files("out"), ["a_normal.png", "r.json"]);
}

#[cfg(unix)]
#[test]
fn a_report_has_the_permissions_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    folder.grey8("h.png", 3, 2, bumps8);
    folder.file("plain", "");
    folder.run(&["normal", "h.png", "-o", "n.png", "--report", "r.json", "-q"]).ends(0);
    let mode = |name: &str| std::fs::metadata(folder.path(name)).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode("r.json"), mode("plain"));
}

#[test]
fn files_that_were_never_opened_have_no_time() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 3, 3, bumps8);
    folder.grey8("tex/a_disp.png", 3, 3, bumps8);
    folder.run(&["bake", "tex", "--out", "out", "-q", "--report", "r.json"]).ends(1);
    let report = folder.json("r.json");
    for file in report["files"].as_array().unwrap() {
        assert_eq!((&file["result"], &file["milliseconds"]), (&json!("failed"), &Value::Null));
    }
    assert_eq!(report["totals"]["failed"], 2);
}

#[test]
fn a_report_does_not_replace_the_settings() {
    let folder = Folder::new();
    folder.grey8("tex/wall_h.png", 9, 8, bumps8);
    let settings = folder.file("tex/texbake.toml", "[defaults]\nscale = 2\n");
    let run = folder.run(&["bake", "tex", "--out", "out", "--report", "tex/texbake.toml"]).ends(1);
    assert!(run.stderr.contains("the report would overwrite the settings file"), "{}", run.stderr);
    assert_eq!(std::fs::read_to_string(settings).unwrap(), "[defaults]\nscale = 2\n");
}

/// An old report would stand for a run that did not come to its files.
#[test]
fn what_stops_a_bake_before_its_first_file_is_reported() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 3, 2, bumps8);
    let bake = |more: &[&str], status| {
        folder.run(&[&["bake", "tex", "--out", "out", "--report", "r.json", "-q"], more].concat()).ends(status);
        folder.json("r.json")
    };
    assert_eq!(bake(&[], 0)["totals"]["baked"], 1);
    for (arguments, status, reason) in [
        (&["--config", "none.toml"][..], 2, "none.toml: "),
        (&["--suffix", "_q"], 1, "tex: no height map found"),
        (
            &["--compression", "small", "--format", "exr"],
            2,
            "--compression is small: it must be left out where no output",
        ),
        (&["--memory", "1M"], 2, "--memory is 1M: "),
    ] {
        let report = bake(arguments, status);
        assert!(report["errors"][0].as_str().unwrap().starts_with(reason), "{report}");
        assert_eq!((&report["files"], &report["totals"]["files"]), (&json!([]), &json!(0)));
    }
    // Which files are inputs is not known then: no file but a report is replaced.
    let input = std::fs::read(folder.path("tex/a_height.png")).unwrap();
    let wrong = ["bake", "tex", "--out", "out", "--suffix", "_q", "--report", "tex/a_height.png"];
    folder.run(&wrong).ends(1).says("error: ", &["no height map found"]);
    assert!(std::fs::read(folder.path("tex/a_height.png")).unwrap() == input);
}
