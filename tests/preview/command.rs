//! `texbake preview` as it is run.

use super::TAU;
use crate::cli::support::{Folder, read_png};
use texbake::Codes;

/// A folder with a small height map.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.grey8("wall_height.png", 48, 32, |x, y| {
        let (x, y) = (x as f64 / 48.0, y as f64 / 32.0);
        (127.5 + 60.0 * (TAU * x).sin() + 60.0 * (TAU * y).cos()) as u8
    });
    folder
}

/// Two triangles with texture coordinates or without.
fn obj(has_texcoords: bool) -> String {
    let texcoords = if has_texcoords { "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" } else { "" };
    let corner = |i: u32| if has_texcoords { format!("{i}/{i}") } else { i.to_string() };
    let face: Vec<String> = (1..=4).map(corner).collect();
    format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n{texcoords}f {}\n", face.join(" "))
}

fn pixels(folder: &Folder, name: &str) -> (usize, usize, Vec<u8>) {
    let (width, height, codes) = read_png(&folder.path(name));
    let Codes::U8(bytes) = codes else { panic!("8 bits") };
    assert_eq!(bytes.len(), 3 * width * height, "{name}");
    (width, height, bytes)
}

#[test]
fn a_sheet_is_written_and_its_numbers_are_told() {
    let folder = folder();
    let run = folder.run(&["preview", "wall_height.png", "-o", "new/sheet.png", "--scale", "6", "--panel", "128"]);
    let run = run.ends(0);
    run.says("new/sheet.png", &["pixels", " ("]);
    // Two elevations of seven surfaces: all but the flat one and the truth.
    assert_eq!(run.stdout.lines().count(), 14, "{}", run.stdout);
    assert!(run.stdout.lines().all(|line| line.contains("mean") && line.ends_with("texels")));
    let (width, height, bytes) = pixels(&folder, "new/sheet.png");
    assert_eq!(width, 2 * 12 + 9 * (128 + 6) - 6);
    assert!(height > 2 * 2 * 50 && bytes.iter().any(|byte| *byte != bytes[0]));

    let quiet = folder.run(&["preview", "wall_height.png", "-o", "sheet.png", "--scale", "6", "--panel", "128", "-q"]);
    let quiet = quiet.ends(0);
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
    assert_eq!(pixels(&folder, "sheet.png").2, bytes);
    let more = ["--iterations", "8", "--elevations", "70,50,30", "--panel", "128", "-q"];
    folder.run(&[&["preview", "wall_height.png", "-o", "more.png", "--scale", "6"][..], &more].concat()).ends(0);
    let (wider, higher, _) = pixels(&folder, "more.png");
    assert!(wider == width + 134 && higher > height);
}

/// Maps that were baked give the picture of the heights that they were baked of, in both conventions, and another one if
/// they are misread.
#[test]
fn maps_that_were_baked_before_are_shown() {
    let folder = folder();
    folder.run(&["bake", "wall_height.png", "-o", "gl", "--maps", "normal,parallax", "--scale", "6"]).ends(0);
    let dx = ["--convention", "dx"];
    folder.run(&[&["bake", "wall_height.png", "-o", "dx", "--scale", "6"][..], &dx].concat()).ends(0);
    let show = |name: &str, arguments: &[&str]| {
        let usual = ["preview", "-o", name, "--scale", "6", "--panel", "128", "--backend", "cpu"];
        let run = folder.run(&[&usual[..], arguments].concat()).ends(0);
        (run, pixels(&folder, name))
    };
    let (without, (narrow, ..)) = show("no_heights.png", &["--material", "gl"]);
    without.says("without heights", &["give the height map as INPUT"]);
    assert!(without.stdout.is_empty());
    // Flat, normal mapped, 1 step and 4.
    assert_eq!(narrow, 2 * 12 + 4 * 134 - 6);
    let (_, (narrower, ..)) = show("no_parallax.png", &["--material", "dx/wall", "--convention", "dx"]);
    assert_eq!(narrower, 2 * 12 + 2 * 134 - 6);

    std::fs::copy(folder.path("wall_height.png"), folder.path("gl/wall_height.png")).unwrap();
    let (_, of_folder) = show("folder.png", &["--material", "gl"]);
    let (_, of_input) = show("input.png", &["wall_height.png", "--material", "gl/"]);
    assert!(of_folder == of_input);
    let (_, right) = show("dx.png", &["wall_height.png", "--material", "dx", "--convention", "dx"]);
    let (_, wrong) = show("wrong.png", &["wall_height.png", "--material", "dx"]);
    let difference = |a: &[u8], b: &[u8]| a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>();
    // In unorm codes y and -y are one code apart where they are zero: hardly to be seen.
    let (misread, right) = (difference(&of_folder.2, &wrong.2), difference(&of_folder.2, &right.2));
    assert!(misread > 20 * right.max(1), "{misread} and {right}");
}

/// Other codes of the same values give the same picture: within the last of 16 bits.
#[test]
fn a_parallax_map_is_read_in_its_own_encoding() {
    let folder = folder();
    let bake = ["bake", "wall_height.png", "--maps", "normal,parallax", "--scale", "6"];
    let show = |name: &str, format: &[&str], read: &[&str]| {
        folder.run(&[&bake[..], &["-o", name, "--parallax-bits", "16"], format].concat()).ends(0);
        let (material, picture) = (format!("{name}/wall"), format!("{name}.png"));
        let usual = ["preview", "--material", &material, "-o", &picture, "--scale", "6", "--panel", "128", "-q"];
        folder.run(&[&usual[..], &["--backend", "cpu"], read].concat()).ends(0);
        pixels(&folder, &picture).2
    };
    let unorm = ["--parallax-encoding", "unorm"];
    let biased = show("biased", &[], &[]);
    for other in [show("signed", &["--format", "tif", "--bits", "8"], &[]), show("unorm", &unorm, &unorm)] {
        assert!(biased.iter().zip(&other).all(|(a, b)| a.abs_diff(*b) <= 1));
    }
    let arguments = ["preview", "--material", "biased/wall", "-o", "x.png", "--parallax-encoding", "snorm"];
    let refused = folder.run(&arguments).ends(2);
    refused.says("parallax-encoding is snorm, for wall_parallax.png", &["it must be biased or unorm"]);
}

#[test]
fn a_model_wears_the_material() {
    let folder = folder();
    folder.file("square.obj", obj(true));
    folder.run(&["tangents", "square.obj", "-o", "square.glb"]).ends(0);
    let show = |model: &str| {
        let arguments = ["wall_height.png", "--model", model, "-o", "shot.png", "--scale", "6", "--panel", "200"];
        let run = folder.run(&[&["preview"][..], &arguments].concat()).ends(0);
        assert!(run.stdout.is_empty());
        run.says("shot.png", &["pixels; cpu"]);
        pixels(&folder, "shot.png")
    };
    let (of_obj, of_glb) = (show("square.obj"), show("square.glb"));
    assert_eq!(of_obj.0, 2 * 12 + 4 * (200 + 8) - 8);
    // The title has the file's name; the panels, of the same tangents, are the same.
    let panels = |(width, _, bytes): &(usize, usize, Vec<u8>)| bytes[3 * width * (12 + 28)..].to_vec();
    assert!(panels(&of_obj) == panels(&of_glb));
}

#[test]
fn what_cannot_be_shown_is_an_error() {
    let folder = folder();
    folder.file("bare.obj", obj(false));
    folder.file("text.obj", "hello");
    std::fs::create_dir(folder.path("empty")).unwrap();
    folder.file("two/a_normal.png", "");
    folder.file("two/b_normal.png", "");
    for (arguments, status, words) in [
        (&["-o", "x.png"][..], 2, "give a height map, or --material with the folder of a material"),
        (&["wall_height.png", "-o", "x.jpg"], 2, "x.jpg: a picture is a PNG file; give a name that ends in .png"),
        (&["wall_height.png", "-o", "wall_height.png"], 2, "--output would overwrite wall_height.png"),
        (&["gone.png", "-o", "x.png"], 1, "gone.png"),
        (&["--material", "empty", "-o", "x.png"], 1, "empty: there is no normal map in it"),
        (&["--material", "gone", "-o", "x.png"], 1, "gone: there is neither a folder of this name nor gone_normal.png"),
        (
            &["--material", "two", "-o", "x.png"],
            1,
            "two: it holds several materials: a, b; name one, as --material two",
        ),
        (&["wall_height.png", "--model", "gone.glb", "-o", "x.png"], 1, "gone.glb"),
        (&["wall_height.png", "--model", "bare.obj", "-o", "x.png"], 1, "bare.obj"),
        (&["wall_height.png", "--model", "text.obj", "-o", "x.png"], 1, "text.obj"),
        (&["wall_height.png", "-o", "x.png", "--parallax-encoding", "unorm"], 2, "--material"),
        (&["wall_height.png", "-o", "x.png", "--elevations", "60,2"], 2, "from 5 to 90"),
        (&["wall_height.png", "-o", "x.png", "--light", "45"], 2, "two numbers of degrees"),
        (&["wall_height.png", "-o", "x.png", "--view", "45,90"], 2, "from -89 to 89"),
        (&["wall_height.png", "-o", "x.png", "--panel", "64"], 2, "a whole number from 128 to 1024"),
        (&["wall_height.png", "-o", "x.png", "--panel", "128", "--model", "bare.obj"], 2, "at least 200 for a model"),
        (&["wall_height.png", "-o", "x.png", "--view", "1,2"], 2, "--model"),
        (&["wall_height.png", "-o", "x.png", "--elevations", "-5"], 2, "from 5 to 90"),
        (&["wall_height.png", "-o", "x.png", "--model", "bare.obj", "--across", "9"], 2, "--across"),
        (&["--material", "two/a", "-o", "two/a_normal.png"], 2, "--output would overwrite two/a_normal.png"),
        (&["wall_height.png", "-o", "x.png", "--across", "0"], 2, "from 0.001"),
        (&["wall_height.png", "-o", "x.png", "--backend", "cpu", "--adapter", "x"], 2, "--adapter"),
        (&["wall_height.png", "-o", "x.png", "--encoding", "float", "--bits", "8"], 2, "--bits"),
    ] {
        let run = folder.run(&[&["preview"], arguments].concat());
        assert!(run.stderr.contains(words), "{arguments:?}: {}", run.stderr);
        run.ends(status);
    }
    assert!(!folder.files(".").contains(&"x.png".to_owned()));
}

/// --scale is in texels of the file: a map that is reduced to a quarter is as high as before.
#[test]
fn a_reduced_map_is_as_high() {
    let folder = folder();
    let show = |name: &str, scale: &[&str]| {
        let usual = ["preview", "wall_height.png", "-o", name, "--shrink", "4", "--panel", "128", "--backend", "cpu"];
        folder.run(&[&usual[..], scale].concat()).ends(0).stdout
    };
    let texels = show("texels.png", &["--scale", "8"]);
    assert_eq!(texels, show("physical.png", &["--size", "48x32", "--depth", "8"]));
    assert_ne!(texels, show("lower.png", &["--scale", "2"]));
}
