//! The file that remembers what was baked: a help that may be lost, damaged or made elsewhere, and never a hindrance.

use super::support::{baked, change_lines, contents, lines, record, results_of, textures};
use crate::cli::support::Folder;
use serde_json::{Value, json};
use std::fs;
use std::time::{Duration, Instant};

/// What a run of three textures says on stderr besides the files that it bakes.
fn words(folder: &Folder, arguments: &[&str], fresh: usize) -> Vec<String> {
    let run = folder.run(&[&["bake", "tex", "--out", "out"], arguments].concat()).ends(0);
    let counts = match fresh {
        0 => "3 of 3 files baked; ".to_owned(),
        fresh => format!("{} of 3 files baked, {fresh} fresh; ", 3 - fresh),
    };
    assert!(run.stdout.lines().last().unwrap().starts_with(&counts), "{}", run.stdout);
    run.stderr.lines().filter(|line| !line.contains("] baked ")).map(str::to_owned).collect()
}

#[test]
fn it_is_a_line_for_each_texture_that_people_can_read() {
    let folder = textures();
    folder.run(&["bake", "tex", "--out", "out", "-q", "--scale", "7/3"]).ends(0);
    let text = fs::read_to_string(record(&folder)).unwrap();
    assert_eq!(text.lines().count(), 4);
    let header: Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
    assert_eq!(header["format"], 1);
    let lines = lines(&folder);
    let c = lines.iter().find(|line| line["outputs"][0]["name"] == "sub/c_normal.png").unwrap();
    // All texts that decide whether it is baked again: who changes one here bakes the users' textures again.
    let options = json!({
        "bits": "8",
        "block-compression": "none",
        "channel": "none",
        "channels": "xyz",
        "color-space": "linear",
        "compression": "fast",
        "convention": "gl",
        "edge": "wrap",
        "encoding": "unorm",
        "filter": "central",
        "maps": "normal",
        "mips": "false",
        "neighbours": "off",
        "normals": "none",
        "precision": "exact",
        "raw": "none",
        "scale": "7/3",
        "shrink": "1",
    });
    assert_eq!(c["options"], options);
    assert_eq!((&c["baked"]["width"], &c["baked"]["depth"]), (&7.into(), &"u8".into()));
    let hash = |name: &str| blake3::hash(&fs::read(folder.path(name)).unwrap()).to_hex().to_string();
    assert_eq!(c["inputs"][0]["hash"], hash("tex/sub/c_height.png"));
    assert_eq!(c["outputs"][0]["hash"], hash("out/sub/c_normal.png"));
}

#[test]
fn without_it_all_is_baked_again() {
    let folder = textures();
    baked(&folder, &[]);
    let first = contents(&folder);
    fs::remove_file(record(&folder)).unwrap();
    let unknown = |name: &str, file: &str| format!("{name} out/{file} is there, and not in the record");
    let all = [unknown("a", "a_normal.png"), unknown("b", "b_normal.png"), unknown("c", "sub/c_normal.png")];
    assert_eq!(baked(&folder, &[]), all);
    assert!(contents(&folder) == first);
    assert_eq!(baked(&folder, &[]), [""; 0]);
}

#[test]
fn a_line_that_a_kill_cut_short_costs_one_texture() {
    let folder = textures();
    baked(&folder, &["--jobs", "1"]);
    let whole = fs::read(record(&folder)).unwrap();
    // Anywhere in the last line, its end included.
    let last = whole[..whole.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap() + 1;
    for end in [last, last + 1, last + 40, whole.len() - 2, whole.len() - 1] {
        fs::write(record(&folder), &whole[..end]).unwrap();
        assert_eq!(words(&folder, &[], 2), [""; 0], "cut at {end} of {}", whole.len());
        assert_eq!(words(&folder, &[], 3), [""; 0], "cut at {end}: it is whole again");
    }
    // In the header, the textures are lost with it.
    fs::write(record(&folder), &whole[..10]).unwrap();
    assert_eq!(words(&folder, &[], 0), [""; 0]);
    assert_eq!(words(&folder, &[], 3), [""; 0]);
}

/// What becomes of the bytes of a record.
type Damage = fn(Vec<u8>) -> Vec<u8>;

#[test]
fn what_cannot_be_read_is_baked_again_with_a_warning() {
    let folder = textures();
    let damages: [(&str, Damage, &str, usize); 7] = [
        (
            "noise",
            |_| (0..5000u32).map(|i| (i.wrapping_mul(2654435761) >> 24) as u8).collect(),
            "it is no record of texbake",
            0,
        ),
        ("text", |_| b"# my own notes\n".to_vec(), "it is no record of texbake", 0),
        (
            "newer",
            |_| b"{\"texbake\":\"what was baked\",\"format\":2}\n[1]\n".to_vec(),
            "it is of another version of texbake",
            0,
        ),
        ("zeros", |bytes| vec![0; bytes.len()], "it is no record of texbake", 0),
        ("empty", |_| Vec::new(), "", 0),
        ("a line", |bytes| replaced(bytes, 2, "{\"outputs\":3}"), "a line of it cannot be read", 2),
        ("two lines", |bytes| replaced(replaced(bytes, 2, "\u{0}"), 3, ""), "2 lines of it cannot be read", 1),
    ];
    for (what, damage, warning, fresh) in damages {
        baked(&folder, &["--force"]);
        fs::remove_file(record(&folder)).unwrap();
        baked(&folder, &[]);
        let bytes = fs::read(record(&folder)).unwrap();
        fs::write(record(&folder), damage(bytes)).unwrap();
        // Nothing is mended by a look.
        let dry = folder.run(&["bake", "tex", "--out", "out", "--dry-run"]).ends(0);
        assert!(dry.stderr.contains(warning), "{what}: {}", dry.stderr);
        let said = words(&folder, &[], fresh);
        match warning {
            "" => assert_eq!(said, [""; 0], "{what}"),
            _ => {
                let expected = format!("warning: out/.texbake-baked: {warning}: what it was about is baked again");
                assert_eq!(said, [expected], "{what}");
            }
        }
        words(&folder, &[], 3);
    }
}

/// `bytes` with another line in the place of one, counted from 1.
fn replaced(bytes: Vec<u8>, line: usize, by: &str) -> Vec<u8> {
    let text = String::from_utf8(bytes).unwrap();
    let lines = text.lines().enumerate().map(|(index, old)| if index + 1 == line { by } else { old });
    (lines.collect::<Vec<_>>().join("\n") + "\n").into_bytes()
}

#[test]
fn numbers_that_mean_nothing_are_no_line() {
    let folder = textures();
    for (key, value) in
        [("scale", "[1, 1, 0]"), ("width", "0"), ("width", "-1"), ("depth", "\"u32\""), ("backend", "\"x\"")]
    {
        fs::remove_dir_all(folder.path("out")).unwrap_or_default();
        baked(&folder, &[]);
        change_lines(&folder, |line| line["baked"][key] = serde_json::from_str(value).unwrap());
        words(&folder, &[], 0);
    }
}

#[cfg(unix)]
#[test]
fn where_it_cannot_be_written_the_bake_succeeds() {
    let folder = textures();
    fs::create_dir_all(record(&folder)).unwrap();
    let said = words(&folder, &[], 0);
    assert!(
        said.len() == 2 && said.iter().all(|line| line.starts_with("warning: out/.texbake-baked: it is no file")),
        "{said:?}"
    );
    fs::remove_dir(record(&folder)).unwrap();
    // A pipe is not waited for.
    assert!(std::process::Command::new("mkfifo").arg(record(&folder)).status().unwrap().success());
    words(&folder, &[], 0);
    fs::remove_file(record(&folder)).unwrap();
    words(&folder, &[], 0);
    words(&folder, &[], 3);
}

#[test]
fn lines_of_no_use_go() {
    let folder = textures();
    let mut longest = 0;
    for scale in 1..12 {
        let scale = scale.to_string();
        assert_eq!(baked(&folder, &["--scale", &scale]).len(), 3);
        longest = longest.max(lines(&folder).len());
    }
    // Three of use, as many more before it is rewritten, and those of a run.
    assert!((6..=9).contains(&longest), "{longest}");
    assert_eq!(baked(&folder, &["--scale", "11"]), [""; 0]);
    assert_eq!(folder.files("out").len(), 3, "{:?}", folder.files("out"));
}

#[test]
fn lines_of_outputs_that_are_gone_go() {
    let folder = textures();
    let names = || -> std::collections::BTreeSet<String> {
        lines(&folder).iter().map(|line| line["outputs"][0]["name"].as_str().unwrap().to_owned()).collect()
    };
    // Names that the record escapes stay, since it cannot look for them.
    let templates = ["{stem}_1", "{stem}_2", "{stem}_\u{301}", "{stem}_3"];
    for name in templates {
        assert_eq!(baked(&folder, &["--name", name]).len(), 3);
    }
    assert_eq!(names().len(), 12);
    for name in folder.files("out").iter().filter(|name| !name.contains("_3")) {
        fs::remove_file(folder.path("out").join(name)).unwrap();
    }
    // Six lines of twelve say nothing; one more, and they go.
    assert_eq!(baked(&folder, &["--name", "{stem}_3"]), [""; 0]);
    fs::remove_file(folder.path("out/a_3.png")).unwrap();
    assert_eq!(baked(&folder, &["--name", "{stem}_3"]), ["a out/a_3.png is missing"]);
    let found = names();
    assert!(!found.iter().any(|name| name.contains("_1") || name.contains("_2")), "{found:?}");
    assert_eq!(baked(&folder, &["--name", "{stem}_3"]), [""; 0]);
}

/// Once files were left alone for two seconds their state is remembered, and they are not read again: another content in
/// the record goes unseen, until the state is another one.
#[test]
fn files_that_were_left_alone_are_not_read() {
    let folder = textures();
    baked(&folder, &[]);
    assert!(lines(&folder).iter().all(|line| line["outputs"][0].get("state").is_none()), "they were just written");
    let begin = Instant::now();
    let is_known = |line: &Value| line["inputs"][0].get("state").is_some() && line["outputs"][0].get("state").is_some();
    let latest = || {
        let by_name = lines(&folder).into_iter().map(|line| (line["outputs"][0]["name"].to_string(), line));
        by_name.collect::<std::collections::BTreeMap<_, _>>()
    };
    while !latest().values().all(is_known) {
        assert!(begin.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(100));
        assert_eq!(baked(&folder, &[]), [""; 0]);
    }
    // The lines without states go.
    assert_eq!(baked(&folder, &[]), [""; 0]);
    let known = fs::read(record(&folder)).unwrap();
    assert_eq!(baked(&folder, &[]), [""; 0]);
    assert!(fs::read(record(&folder)).unwrap() == known, "there is nothing new to remember");

    for side in ["inputs", "outputs"] {
        fs::write(record(&folder), &known).unwrap();
        change_lines(&folder, |line| line[side][0]["hash"] = "0".repeat(64).into());
        assert_eq!(baked(&folder, &[]), [""; 0], "{side} were read");
        // The sabotage that shows that the content counts where the state does not speak for it.
        change_lines(&folder, |line| drop(line[side][0].as_object_mut().unwrap().remove("state")));
        let results = results_of(&folder, &["--dry-run"], 0);
        let why = if side == "inputs" { "changed" } else { "was edited" };
        assert!(results.values().all(|result| result.ends_with(why)), "{results:?}");
    }
}
