//! `texbake diff`: what is printed, and how it ends.

use super::support::{Folder, bumps8, png, read_png};
use texbake::CodesRef;

/// An 8-bit RGB file of flat texels but for these.
fn flat_but(folder: &Folder, name: &str, texels: &[(usize, usize, [u8; 3])]) {
    let mut codes = [128, 128, 255].repeat(20 * 10);
    for (x, y, texel) in texels {
        codes[3 * (y * 20 + x)..][..3].copy_from_slice(texel);
    }
    folder.file(name, png(20, 10, png::ColorType::Rgb, png::BitDepth::Eight, &codes));
}

fn folder() -> Folder {
    let folder = Folder::new();
    flat_but(&folder, "flat.png", &[]);
    flat_but(&folder, "other.png", &[(7, 8, [218, 128, 218]), (3, 9, [129, 128, 255])]);
    folder
}

#[test]
fn the_same_maps_end_with_0() {
    let run = folder().run(&["diff", "flat.png", "flat.png"]).ends(0);
    assert_eq!(
        run.stdout,
        "0 of 20 x 10 texels differ (0.0000%)\n\
         codes: largest difference 0, mean 0.000000 (x 0 and 0.000000, y 0 and 0.000000, z 0 and 0.000000)\n\
         angle: 0 degrees everywhere\n"
    );
    assert_eq!(run.stderr, "");
}

#[test]
fn maps_that_differ_end_with_1_above_the_tolerance() {
    let folder = folder();
    let run = folder.run(&["diff", "flat.png", "other.png"]).ends(1);
    // 90 + 1 codes in x, 37 in z; 45 degrees and atan(3 / 255), of 200 texels.
    assert_eq!(
        run.stdout,
        "2 of 20 x 10 texels differ (1.0000%)\n\
         codes: largest difference 90, mean 0.213333 (x 90 and 0.455000, y 0 and 0.000000, z 37 and 0.185000)\n\
         angle: largest 45.000000 degrees at column 7, row 8, 99th percentile 0.000000, mean 0.228370\n"
    );
    // atan(3 / 255) is 0.674 degrees.
    let above = |tolerance: &str, exit| {
        let run = folder.run(&["diff", "flat.png", "other.png", "--tolerance", tolerance]).ends(exit);
        run.stdout.lines().nth(1).unwrap().to_owned()
    };
    assert_eq!(above("0.6", 1), "2 texels (1.0000%) above 0.6 degrees");
    assert_eq!(above("44.99", 1), "1 texel (0.5000%) above 44.99 degrees");
    assert_eq!(above("50", 0), "0 texels (0.0000%) above 50 degrees");
    folder.run(&["diff", "flat.png", "other.png", "--tolerance", "45"]).ends(0);
}

#[test]
fn json_holds_the_same() {
    let folder = folder();
    let run = folder.run(&["diff", "flat.png", "other.png", "--json", "--tolerance", "50"]).ends(0);
    let json: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((&json["a"], &json["b"], &json["width"]), (&"flat.png".into(), &"other.png".into(), &20.into()));
    assert_eq!(
        (&json["differing"], &json["no_angle"], &json["within_tolerance"]),
        (&2.into(), &0.into(), &true.into())
    );
    assert_eq!((&json["above_tolerance"], &json["heatmap"]), (&0.into(), &serde_json::Value::Null));
    assert_eq!(json["codes"]["largest_of_channels"], serde_json::json!([90.0, 0.0, 37.0]));
    assert_eq!((&json["degrees"]["largest"], &json["tolerance"]), (&45.0.into(), &50.0.into()));
    assert_eq!(json["worst"], serde_json::json!({ "x": 7, "y": 8 }));
    assert_eq!(json["formats"][1]["encoding"], "unorm");
}

#[test]
fn each_map_may_be_read_in_its_own_way() {
    let folder = Folder::new();
    folder.grey8("height.png", 40, 30, bumps8);
    for (name, more) in [
        ("gl.png", &[][..]),
        ("dx.png", &["--convention", "dx"]),
        ("biased.png", &["--encoding", "biased"]),
        ("xy.tif", &["--channels", "xy"]),
    ] {
        folder.run(&[&["normal", "height.png", "-o", name, "--scale", "2", "-q"], more].concat()).ends(0);
    }
    folder.run(&["diff", "gl.png", "dx.png", "--tolerance", "20"]).ends(1);
    // Half a code to either side in y, and 128 for zero.
    let run = folder.run(&["diff", "gl.png", "dx.png", "--convention", "gl,dx", "--tolerance", "0.5"]).ends(0);
    assert!(run.stdout.contains("codes: of different formats, not compared"), "{}", run.stdout);
    folder.run(&["diff", "gl.png", "biased.png", "--encoding", "unorm,biased", "--tolerance", "1"]).ends(0);
    assert!(folder.run(&["diff", "gl.png", "biased.png"]).ends(1).stdout.contains("codes: largest difference 1, "));
    folder.run(&["diff", "gl.png", "gl.png", "--convention", "dx"]).ends(0);
    folder.run(&["diff", "gl.png", "gl.png", "--channels", "xyz,xy", "--tolerance", "30"]).ends(0);
    assert!(
        folder.run(&["diff", "gl.png", "xy.tif", "--tolerance", "30"]).ends(0).stdout.contains("of different formats")
    );
}

#[test]
fn the_heatmap_is_as_large_as_the_maps() {
    let folder = folder();
    // Missing folders are made.
    let run = folder.run(&["diff", "flat.png", "other.png", "--heatmap", "new/heat.png", "--json"]).ends(1);
    let json: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(json["heatmap"], serde_json::json!({ "file": "new/heat.png", "white_degrees": 45.0 }));
    let run = folder.run(&["diff", "flat.png", "other.png", "--heatmap", "heat.png"]).ends(1);
    assert!(run.stdout.ends_with("\nheat.png: white is 45.000000 degrees and more\n"), "{}", run.stdout);
    assert_eq!(std::fs::read(folder.path("new/heat.png")).unwrap(), std::fs::read(folder.path("heat.png")).unwrap());
    let (width, height, codes) = read_png(&folder.path("heat.png"));
    let CodesRef::U8(codes) = codes.as_ref() else { panic!("8 bits") };
    assert_eq!((width, height), (20, 10));
    let texel = |x: usize, y: usize| &codes[3 * (20 * y + x)..][..3];
    assert_eq!((texel(7, 8), texel(0, 0)), (&[255; 3][..], &[0; 3][..]));
    // 0.67 degrees are 4/255 of 45, and all of 0.5.
    assert!(texel(3, 9).iter().all(|&code| code < 20), "{:?}", texel(3, 9));
    folder.run(&["diff", "flat.png", "other.png", "--heatmap", "heat.png", "--heatmap-max", "0.5"]).ends(1);
    let (_, _, codes) = read_png(&folder.path("heat.png"));
    let CodesRef::U8(codes) = codes.as_ref() else { panic!("8 bits") };
    assert_eq!(codes[3 * (20 * 9 + 3)..][..3], [255; 3]);
    // Equal maps have a black one.
    folder.run(&["diff", "flat.png", "flat.png", "--heatmap", "black.png"]).ends(0);
    assert!(
        matches!(read_png(&folder.path("black.png")).2.as_ref(), CodesRef::U8(codes) if codes.iter().all(|&code| code == 0))
    );
}

#[test]
fn wrong_input_is_named() {
    let folder = folder();
    folder.grey8("height.png", 20, 10, bumps8);
    folder.file("small.png", png(2, 2, png::ColorType::Rgb, png::BitDepth::Eight, &[128; 12]));
    folder.run(&["diff", "flat.png", "missing.png"]).ends(1).says("error: missing.png", &["No such file"]);
    folder.run(&["diff", "height.png", "flat.png"]).ends(1).says("error: height.png", &["height map"]);
    let run = folder.run(&["diff", "flat.png", "small.png", "--heatmap", "heat.png"]).ends(1);
    run.says("error: flat.png has 20 x 10 texels", &["small.png 2 x 2: give two maps of one size"]);
    folder.run(&["diff", "flat.png", "other.png", "--heatmap", "h.gif"]).ends(1).says("error: h.gif", &[".gif"]);
    let cases: [(&[&str], &str); 8] = [
        (&["diff", "flat.png", "other.png", "--heatmap", "h.exr"], "--heatmap is h.exr: it must be a .png or .tif"),
        (&["diff", "flat.png"], "<B>"),
        (&["diff", "flat.png", "other.png", "--tolerance", "-1"], "number of degrees"),
        (&["diff", "flat.png", "other.png", "--tolerance", "x"], "number of degrees"),
        (&["diff", "flat.png", "other.png", "--heatmap-max", "3"], "--heatmap <FILE>"),
        (&["diff", "flat.png", "other.png", "--heatmap", "h.png", "--heatmap-max", "0"], "above 0"),
        (&["diff", "flat.png", "other.png", "--heatmap", "other.png"], "would overwrite other.png"),
        (&["diff", "flat.png", "other.png", "--convention", "gl,dx,gl"], "one for both maps, or two"),
    ];
    for (arguments, part) in cases {
        let run = folder.run(arguments).ends(2);
        assert!(run.stderr.contains(part), "{arguments:?}: {}", run.stderr);
    }
    assert_eq!(folder.files("."), ["flat.png", "height.png", "other.png", "small.png"]);
}

#[test]
fn a_map_of_two_channels_in_a_png_is_guessed() {
    let folder = Folder::new();
    folder.grey8("height.png", 40, 30, bumps8);
    for (name, channels) in [("xyz.png", "xyz"), ("xy.png", "xy")] {
        folder.run(&["normal", "height.png", "-o", name, "--channels", channels, "--scale", "2", "-q"]).ends(0);
    }
    let run = folder.run(&["diff", "xyz.png", "xy.png"]).ends(1);
    assert!(
        run.stderr.starts_with("warning: xy.png: ") && run.stderr.ends_with("read it with --channels xy\n"),
        "{}",
        run.stderr
    );
    assert_eq!(
        folder.run(&["diff", "xyz.png", "xy.png", "--channels", "xyz,xy", "--tolerance", "30"]).ends(0).stderr,
        ""
    );
}
