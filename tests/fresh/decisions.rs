//! What changed decides what is baked again, and nothing else.

use super::support::{baked, change_lines, contents, results_of, textures};
use crate::cli::support::{Folder, bumps8};
use serde_json::json;
use std::fs::{self, File};
use std::time::SystemTime;

#[test]
fn what_was_baked_is_fresh_and_stays_as_it_is() {
    let folder = textures();
    assert_eq!(baked(&folder, &[]), ["a new", "b new", "c new"]);
    let modified = |name: &str| fs::metadata(folder.path("out").join(name)).unwrap().modified().unwrap();
    let times: Vec<SystemTime> = folder.files("out").iter().map(|name| modified(name)).collect();
    let first = contents(&folder);
    assert_eq!(first.len(), 3);
    for _ in 0..2 {
        assert_eq!(baked(&folder, &[]), [""; 0]);
    }
    assert!(contents(&folder) == first);
    assert_eq!(folder.files("out").iter().map(|name| modified(name)).collect::<Vec<_>>(), times);
    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(0);
    assert_eq!(run.stderr, "");
    assert!(run.stdout.lines().last().unwrap().starts_with("0 of 3 files baked, 3 fresh; "), "{}", run.stdout);
    // Another folder knows nothing of it.
    folder.run(&["bake", "tex", "--out", "other"]).ends(0).says("a_height.png", &["baked"]);
}

#[test]
fn the_report_keeps_what_is_known() {
    let folder = textures();
    let bake = ["bake", "tex", "--out", "out", "-q", "--report", "r.json", "--scale", "3.14159265358979"];
    let both = [&bake[..], &["--maps", "normal,parallax"]].concat();
    folder.run(&both).ends(0);
    let mut before = folder.json("r.json");
    folder.run(&both).ends(0);
    let mut after = folder.json("r.json");
    let totals = &after["totals"];
    assert_eq!([&totals["files"], &totals["baked"], &totals["fresh"]], [&json!(3), &json!(0), &json!(3)]);
    assert_eq!((&totals["texels"], &totals["bytes_in"], &totals["bytes_out"]), (&json!(0), &json!(0), &json!(0)));
    for (before, after) in
        before["files"].as_array_mut().unwrap().iter_mut().zip(after["files"].as_array_mut().unwrap())
    {
        assert_eq!([before["result"].take(), after["result"].take()], ["baked", "fresh"]);
        assert_eq!(before.as_object_mut().unwrap().remove("stale"), Some(json!("new")));
        // No file was opened.
        assert!(before["milliseconds"].take().is_f64() && after["milliseconds"].is_null());
        assert_eq!(before, after);
        assert!(after["warnings"][0].as_str().unwrap().contains("too many digits") && after["parallax"].is_object());
    }
}

#[test]
fn an_option_bakes_again_what_it_is_for() {
    let folder = textures();
    let set = |text: &str| drop(folder.file("tex/texbake.toml", text));
    set("[defaults]\nscale = 8\n");
    assert_eq!(baked(&folder, &[]).len(), 3);
    set("[defaults]\nscale = 8\n[[override]]\nglob = 'b_*'\nscale = 24\n");
    assert_eq!(baked(&folder, &[]), ["b scale 8 -> 24"]);
    set(
        "[defaults]\nscale = 8\n[[override]]\nglob = 'b_*'\nscale = 24\n[[override]]\nglob = 'sub/*'\nedge = 'clamp,wrap'\n",
    );
    assert_eq!(baked(&folder, &[]), ["c edge wrap -> clamp,wrap"]);
    // What changes no byte changes nothing.
    assert_eq!(baked(&folder, &["--max-bytes", "1G", "--iterations", "9", "--jobs", "1", "--backend", "cpu"]), [""; 0]);
    assert_eq!(baked(&folder, &["--scale", "24"]), ["a scale 8 -> 24", "c scale 8 -> 24"]);
    set("");
    // The maps of a texture are baked in one pass.
    let both = ["--maps", "normal,parallax"];
    assert_eq!(baked(&folder, &both), ["a new", "b new", "c new"]);
    assert_eq!(baked(&folder, &both), [""; 0]);
    // Another name is another file.
    assert_eq!(baked(&folder, &["--name", "{stem}_n"]), ["a new", "b new", "c new"]);
    assert_eq!(baked(&folder, &["--format", "tif"]), ["a new", "b new", "c new"]);
}

#[test]
fn a_device_counts_where_it_decides_over_bytes() {
    let folder = textures();
    let bake = |precision, backend| baked(&folder, &["--precision", precision, "--backend", backend]).len();
    assert_eq!([bake("exact", "cpu"), bake("exact", "reference"), bake("exact", "cpu")], [3, 0, 0]);
    assert_eq!([bake("fast", "cpu"), bake("fast", "cpu"), bake("fast", "reference")], [3, 0, 3]);
    let found = baked(&folder, &["--precision", "fast", "--backend", "cpu"]);
    assert!(found.len() == 3 && found.iter().all(|it| it.contains(" device ") && it.ends_with(" -> cpu")), "{found:?}");
    for threads in ["1", "2"] {
        let fast = ["--precision", "fast", "--backend", "cpu", "--threads", threads];
        assert_eq!(baked(&folder, &fast), [""; 0], "a byte depends on no number of threads");
    }
    assert_eq!(bake("fast", "reference"), 3);
    assert_eq!([bake("fast", "reference"), bake("exact", "reference")], [0, 3]);
}

#[test]
fn another_version_of_the_kernels_bakes_all_again() {
    let folder = textures();
    folder.run(&["bake", "tex", "--out", "out", "-q"]).ends(0);
    let this = texbake::batch::KERNEL_VERSION;
    change_lines(&folder, |line| {
        assert_eq!(line["kernel"], this);
        if line["outputs"][0]["name"] != "sub/c_normal.png" {
            line["kernel"] = (this + 1).into();
        }
    });
    let why = format!("texbake bakes other bytes since (kernel version {} -> {this})", this + 1);
    assert_eq!(baked(&folder, &[]), [format!("a {why}"), format!("b {why}")]);
    assert_eq!(baked(&folder, &[]), [""; 0]);
}

#[test]
fn an_option_of_which_a_line_says_nothing_is_told() {
    let folder = textures();
    assert_eq!(baked(&folder, &[]).len(), 3);
    change_lines(&folder, |line| drop(line["options"].as_object_mut().unwrap().remove("shrink")));
    assert_eq!(baked(&folder, &[]), ["a", "b", "c"].map(|name| format!("{name} shrink none -> 1")));
    change_lines(&folder, |line| line["options"]["sides"] = "6".into());
    assert_eq!(baked(&folder, &[]), ["a", "b", "c"].map(|name| format!("{name} sides 6 -> none")));
    // Beside another change it goes without saying.
    change_lines(&folder, |line| line["options"]["sides"] = "6".into());
    assert_eq!(baked(&folder, &["--scale", "2"]), ["a", "b", "c"].map(|name| format!("{name} scale 1 -> 2")));
}

#[test]
fn an_input_is_known_by_its_content() {
    let folder = textures();
    assert_eq!(baked(&folder, &[]).len(), 3);
    folder.grey8("tex/a_height.png", 9, 8, |x, y| bumps8(x, y) ^ 1);
    assert_eq!(baked(&folder, &[]), ["a tex/a_height.png changed"]);
    // The same bytes at another time, in another file, or under another name.
    let b = folder.path("tex/b_height.png");
    File::options().write(true).open(&b).unwrap().set_modified(SystemTime::UNIX_EPOCH).unwrap();
    assert_eq!(baked(&folder, &[]), [""; 0]);
    let bytes = fs::read(&b).unwrap();
    fs::remove_file(&b).unwrap();
    fs::write(&b, &bytes).unwrap();
    assert_eq!(baked(&folder, &[]), [""; 0]);
    fs::rename(&b, folder.path("tex/b_disp.png")).unwrap();
    assert_eq!(baked(&folder, &[]), [""; 0]);
    // As many bytes, and the old time.
    let mut other = bytes.clone();
    *other.last_mut().unwrap() ^= 1;
    fs::write(folder.path("tex/b_disp.png"), &other).unwrap();
    let file = File::options().write(true).open(folder.path("tex/b_disp.png")).unwrap();
    file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
    let results = results_of(&folder, &["--dry-run"], 0);
    assert_eq!(results["b_disp.png"], "not_begun: tex/b_disp.png changed");
}

#[test]
fn an_output_that_was_edited_or_deleted_is_noticed() {
    let folder = textures();
    assert_eq!(baked(&folder, &[]).len(), 3);
    let first = contents(&folder);
    let output = folder.path("out/a_normal.png");
    // An edit that keeps the length and the time.
    let time = fs::metadata(&output).unwrap().modified().unwrap();
    let mut bytes = fs::read(&output).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&output, &bytes).unwrap();
    File::options().write(true).open(&output).unwrap().set_modified(time).unwrap();
    assert_eq!(baked(&folder, &[]), ["a out/a_normal.png was edited"]);
    fs::remove_file(folder.path("out/sub/c_normal.png")).unwrap();
    assert_eq!(baked(&folder, &[]), ["c out/sub/c_normal.png is missing"]);
    assert!(contents(&folder) == first);
    // Copied over itself it is the same.
    let bytes = fs::read(&output).unwrap();
    fs::remove_file(&output).unwrap();
    fs::write(&output, bytes).unwrap();
    assert_eq!(baked(&folder, &[]), [""; 0]);

    // One of two maps is enough.
    let both = ["--maps", "normal,parallax"];
    baked(&folder, &both);
    fs::write(folder.path("out/b_parallax.png"), "mine").unwrap();
    assert_eq!(baked(&folder, &both), ["b out/b_parallax.png was edited"]);
    fs::remove_file(folder.path("out/b_parallax.png")).unwrap();
    assert_eq!(baked(&folder, &both), ["b out/b_parallax.png is missing"]);
    assert_eq!(baked(&folder, &both), [""; 0]);
}

#[test]
fn a_roughness_map_is_an_output_as_others_are() {
    let folder = textures();
    let rough = ["--format", "dds", "--mips", "--maps", "normal,roughness"];
    assert_eq!(baked(&folder, &rough), ["a new", "b new", "c new"]);
    let first = contents(&folder);
    let output = folder.path("out/a_roughness.dds");
    let mut bytes = fs::read(&output).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&output, &bytes).unwrap();
    fs::remove_file(folder.path("out/sub/c_roughness.dds")).unwrap();
    let expected = ["a out/a_roughness.dds was edited", "c out/sub/c_roughness.dds is missing"];
    assert_eq!(baked(&folder, &rough), expected);
    assert_eq!(baked(&folder, &rough), [""; 0]);
    assert!(contents(&folder) == first);
}

/// An output that cannot be read was not edited.
#[test]
fn what_cannot_be_read_is_told_as_such() {
    let folder = textures();
    assert_eq!(baked(&folder, &[]).len(), 3);
    let output = folder.path("out/a_normal.png");
    fs::remove_file(&output).unwrap();
    fs::create_dir(&output).unwrap();
    let results = results_of(&folder, &["--dry-run"], 0);
    assert_eq!(results["a"], "not_begun: out/a_normal.png cannot be read: it is no file");
}

#[test]
fn force_bakes_all() {
    let folder = textures();
    assert_eq!(baked(&folder, &[]).len(), 3);
    assert_eq!(baked(&folder, &["--force"]), ["a forced", "b forced", "c forced"]);
    assert_eq!(baked(&folder, &[]), [""; 0]);
}

#[test]
fn a_clash_with_a_fresh_file_is_still_one() {
    let folder = Folder::new();
    folder.grey8("tex/wall_height.png", 6, 6, bumps8);
    assert_eq!(baked(&folder, &[]), ["wall new"]);
    let before = contents(&folder);
    folder.grey8("tex/wall_disp.png", 5, 5, bumps8);
    let results = results_of(&folder, &[], 1);
    assert!(results.values().all(|result| result.starts_with("failed: out/wall_normal.png: both ")), "{results:?}");
    assert!(contents(&folder) == before);
    // What would overwrite the input of a fresh file is not baked either.
    fs::remove_file(folder.path("tex/wall_disp.png")).unwrap();
    fs::create_dir(folder.path("x")).unwrap();
    folder.grey8("x/wall_h.png", 5, 5, bumps8);
    let run = folder.run(&["bake", "tex/wall_height.png", "x/wall_h.png", "--out", "tex", "--name", "{stem}_height"]);
    assert!(run.ends(1).stderr.contains("would overwrite this input"));
}
