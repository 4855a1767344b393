//! `texbake bake --maps`: both maps of a height map in one pass.

use super::support::{Folder, assert_parallax, bumps8, bumps16, read_png};
use serde_json::{Value, json};
use texbake::{Baker, Depth, Encoding, Filter, NormalOptions, ParallaxFormat, ParallaxOptions, Scale};

const BIASED8: ParallaxFormat = ParallaxFormat { encoding: Encoding::Biased, depth: Depth::Bits8 };

fn normal(scale: i32) -> NormalOptions {
    NormalOptions { scale: Scale::texels(scale), ..NormalOptions::default() }
}

fn parallax(scale: i32) -> ParallaxOptions {
    ParallaxOptions { scale: Scale::texels(scale), format: BIASED8, ..ParallaxOptions::default() }
}

#[test]
fn one_pass_gives_the_bytes_of_two() {
    let folder = Folder::new();
    let small = folder.grey8("tex/a_height_2k.png", 37, 23, bumps8);
    let fine = folder.grey16("tex/sub/b_height.png", 19, 41, bumps16);
    for (out, maps) in [("both", "normal,parallax"), ("n", "normal"), ("p", "parallax")] {
        folder.run(&["bake", "tex", "--out", out, "--maps", maps, "--scale", "7", "-q"]).ends(0);
    }
    let names = ["a_normal_2k.png", "a_parallax_2k.png", "sub/b_normal.png", "sub/b_parallax.png"];
    assert_eq!(folder.files("both"), names);
    assert_eq!(folder.files("n"), [names[0], names[2]]);
    assert_eq!(folder.files("p"), [names[1], names[3]]);
    for (name, alone) in names.iter().zip(["n", "p", "n", "p"]) {
        let bytes = |out: &str| std::fs::read(folder.path(out).join(name)).unwrap();
        assert!(bytes("both") == bytes(alone), "{name}");
    }
    folder.assert_baked("both/a_normal_2k.png", &small, &normal(7));
    folder.assert_baked("both/sub/b_normal.png", &fine, &normal(7));
    assert_parallax(&folder, "both/a_parallax_2k.png", &small, &parallax(7));
    assert_parallax(&folder, "both/sub/b_parallax.png", &fine, &parallax(7));
}

#[test]
fn every_output_is_told() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 9, 8, bumps8);
    let run = folder.run(&["bake", "tex", "--out", "out", "--maps", "parallax,normal"]).ends(0);
    assert!(
        run.line("[1/1] baked tex/a_height.png -> out/a_normal.png, out/a_parallax.png, 9 x 8, u8, ").contains("ms")
    );
    let row: Vec<&str> = run.stdout.lines().nth(1).unwrap().split_whitespace().collect();
    assert_eq!((row[0], row[5], row[7]), ("tex/a_height.png", "normal,parallax", "baked"), "{}", run.stdout);
    let bytes = |name: &str| std::fs::metadata(folder.path(name)).unwrap().len();
    let kilobytes = |count: u64| format!("{count} B out");
    let sum = bytes("out/a_normal.png") + bytes("out/a_parallax.png");
    assert!(sum < 1000 && run.stdout.contains(&kilobytes(sum)), "{sum}: {}", run.stdout);
}

#[test]
fn each_glob_has_its_maps() {
    let folder = Folder::new();
    let map = folder.grey8("tex/wall_h.png", 9, 8, bumps8);
    for name in ["sky_h.png", "sea_h.png", "stone/hut_h.png"] {
        folder.grey8(&format!("tex/{name}"), 9, 8, bumps8);
    }
    folder.file(
        "tex/texbake.toml",
        "[defaults]\nmaps = ['normal', 'parallax']\nscale = 5\nparallax-bits = 16\n\
         [[override]]\nglob = 'sky_*'\nmaps = 'normal'\n\
         [[override]]\nglob = 'sea_*'\nmaps = ['parallax']\nname = '{stem}_{map}_x'\nparallax-encoding = 'unorm'\n\
         [[override]]\nglob = 'stone/*'\nmaps = 'parallax,normal'\nparallax-bits = 8\nname = '{map}/{stem}'\n",
    );
    folder.run(&["bake", "tex", "--out", "out", "-q"]).ends(0);
    let names = [
        "sea_parallax_x.png",
        "sky_normal.png",
        "stone/normal/hut.png",
        "stone/parallax/hut.png",
        "wall_normal.png",
        "wall_parallax.png",
    ];
    assert_eq!(folder.files("out"), names);
    let of = |encoding, depth| ParallaxOptions { format: ParallaxFormat { encoding, depth }, ..parallax(5) };
    for name in ["sky_normal.png", "stone/normal/hut.png", "wall_normal.png"] {
        folder.assert_baked(&format!("out/{name}"), &map, &normal(5));
    }
    assert_parallax(&folder, "out/wall_parallax.png", &map, &of(Encoding::Biased, Depth::Bits16));
    assert_parallax(&folder, "out/stone/parallax/hut.png", &map, &parallax(5));
    assert_parallax(&folder, "out/sea_parallax_x.png", &map, &of(Encoding::Unorm, Depth::Bits16));
    // The command line is stronger.
    folder.run(&["bake", "tex", "--out", "own", "-q", "--maps", "normal"]).ends(0);
    assert_eq!(folder.files("own"), ["sea_normal_x.png", "sky_normal.png", "stone/normal/hut.png", "wall_normal.png"]);
}

#[test]
fn the_format_says_what_a_parallax_map_holds() {
    use tiff::decoder::{Decoder, DecodingResult};
    let folder = Folder::new();
    let map = folder.grey16("tex/a_h.png", 13, 9, bumps16);
    let both = ["--maps", "normal,parallax", "--filter", "sobel", "-q"];
    let run = |arguments: &[&str]| folder.run(&[&["bake", "tex"], &both[..], arguments].concat()).ends(0);
    let expected = |encoding, depth| {
        let format = ParallaxFormat { encoding, depth };
        let options = ParallaxOptions { format, filter: Filter::Sobel, ..ParallaxOptions::default() };
        Baker::reference().parallax(&map, &options).unwrap()
    };
    run(&["--out", "tif", "--format", "tif"]);
    let file = std::fs::File::open(folder.path("tif/a_parallax.tif")).unwrap();
    let DecodingResult::I8(codes) = Decoder::new(file).unwrap().read_image().unwrap() else {
        panic!("not signed bytes")
    };
    let codes: Vec<u8> = codes.iter().map(|code| *code as u8).collect();
    assert_eq!(expected(Encoding::Snorm, Depth::Bits8).codes(), texbake::CodesRef::U8(&codes));

    run(&["--out", "tif16", "--format", "tif", "--parallax-bits", "16"]);
    let file = std::fs::File::open(folder.path("tif16/a_parallax.tif")).unwrap();
    let DecodingResult::I16(codes) = Decoder::new(file).unwrap().read_image().unwrap() else {
        panic!("not signed words")
    };
    let codes: Vec<u16> = codes.iter().map(|code| *code as u16).collect();
    assert_eq!(expected(Encoding::Snorm, Depth::Bits16).codes(), texbake::CodesRef::U16(&codes));

    run(&["--out", "exr", "--format", "exr"]);
    let image = exr::prelude::read_first_flat_layer_from_file(folder.path("exr/a_parallax.exr")).unwrap();
    let channel = &image.layer_data.channel_data.list[..];
    assert_eq!(channel.len(), 1);
    let floats: Vec<f32> = channel[0].sample_data.values_as_f32().collect();
    assert_eq!(expected(Encoding::Float, Depth::Float32).codes(), texbake::CodesRef::F32(&floats));
}

#[test]
fn the_report_has_what_a_shader_needs() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 64, 32, bumps8);
    folder.grey8("tex/b_height.png", 4, 4, bumps8);
    folder.file("tex/texbake.toml", "[[override]]\nglob = 'a_*'\nmaps = 'normal,parallax'\nscale = 24\n");
    folder.run(&["bake", "tex", "--out", "out", "-q", "--report", "r.json"]).ends(0);
    let report = folder.json("r.json");
    let [a, b] = [&report["files"][0], &report["files"][1]];
    assert_eq!(a["outputs"], json!({ "normal": "out/a_normal.png", "parallax": "out/a_parallax.png" }));
    assert_eq!(b["outputs"], json!({ "normal": "out/b_normal.png", "parallax": null }));
    let options = |file: &Value| {
        ["maps", "encoding", "bits", "parallax_encoding", "parallax_bits", "iterations"]
            .map(|key| file["options"][key].clone())
    };
    assert_eq!(
        options(a),
        [json!("normal,parallax"), json!("unorm"), json!("8"), json!("biased"), json!("8"), json!(4)]
    );
    assert_eq!(options(b), [json!("normal"), json!("unorm"), json!("8"), Value::Null, Value::Null, Value::Null]);
    assert_eq!(b["parallax"], Value::Null);
    // 24 / (2 * 4 * 64) and 24 / (2 * 4 * 32); 24 / 64 and 24 / 32; minus half of them.
    assert_eq!(a["parallax"]["u"], json!([0.046875, 0.09375]));
    assert_eq!(a["parallax"]["welsh"], json!({ "scale": [0.375, 0.75], "bias": [-0.1875, -0.375] }));
    assert_eq!(a["parallax"]["decode"]["code"], "max((code - 128) / 127, -1)");
    assert!(a["parallax"]["axes"].as_str().unwrap().contains("where v grows down the rows, change the sign"), "{a}");

    let eight = ["bake", "tex", "--out", "out", "-q", "--report", "r.json", "--iterations", "8"];
    folder.run(&eight).ends(0);
    let a = &folder.json("r.json")["files"][0];
    assert_eq!((&a["options"]["iterations"], &a["parallax"]["iterations"]), (&json!(8), &json!(8)));
    assert_eq!(a["parallax"]["u"], json!([0.0234375, 0.046875]));
}

#[test]
fn two_maps_need_two_names() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 3, 3, bumps8);
    let expected = "name is {stem}_n: it must be a name with {map} in it, which keeps the normal map and the parallax \
                    map apart, as {stem}_{map}{size}\n";
    let both = ["bake", "tex", "--out", "out", "--maps", "normal,parallax"];
    let run = folder.run(&[&both[..], &["--name", "{stem}_n"]].concat()).ends(2);
    assert_eq!(run.stderr, format!("error: --{expected}"));
    folder.file("tex/texbake.toml", "[defaults]\nname = '{stem}_n'\n");
    let run = folder.run(&both).ends(2);
    assert!(run.stderr.ends_with(&format!("texbake.toml: {expected}")), "{}", run.stderr);
    // One map needs none.
    folder.run(&["bake", "tex", "--out", "out", "--maps", "parallax", "-q"]).ends(0);
    assert_eq!(folder.files("out"), ["a_n.png"]);
}

#[test]
fn every_output_is_kept_from_inputs_and_other_outputs() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 6, 6, bumps8);
    // The parallax map of one file would be the input of another.
    folder.grey8("tex/a_parallax.png", 6, 6, bumps8);
    let both = ["--maps", "normal,parallax"];
    let run = folder.run(&[&["bake", "tex/a_height.png", "tex/a_parallax.png", "--out", "tex"], &both[..]].concat());
    let run = run.ends(1);
    run.says(
        "failed tex/a_parallax.png: the output of tex/a_height.png would overwrite this input",
        &["another output"],
    );
    assert_eq!(
        folder.files("tex"),
        ["a_height.png", "a_parallax.png", "a_parallax_normal.png", "a_parallax_parallax.png"]
    );
    let report = ["--report", "out/x/../a_parallax.png"];
    let run = folder.run(&[&["bake", "tex/a_height.png", "--out", "out"], &both[..], &report[..]].concat()).ends(1);
    run.says("the report would overwrite the output out/a_parallax.png", &["choose another name for the report"]);
}

#[cfg(unix)]
#[test]
fn two_maps_of_one_file_never_share_a_target() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 6, 6, bumps8);
    let there = folder.file("out/a_normal.png", "there");
    std::os::unix::fs::symlink(&there, folder.path("out/a_parallax.png")).unwrap();
    let run = folder.run(&["bake", "tex", "--out", "out", "--maps", "normal,parallax"]).ends(1);
    run.says("failed out/a_normal.png: it would take two maps of tex/a_height.png; choose another output", &[]);
    assert_eq!(std::fs::read(there).unwrap(), b"there");
}

#[test]
fn wrong_maps_end_with_2() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 3, 3, bumps8);
    let cases: [(&[&str], &[&str]); 4] = [
        (&["--maps", "bump"], &["'bump' for '--maps", "[possible values: normal, parallax, roughness, none]"]),
        (&["--maps", ""], &["'--maps"]),
        (
            &["--maps", "parallax", "--parallax-encoding", "snorm", "--parallax-bits", "32f"],
            &["error: --parallax-bits is 32f: it must be 8 or 16 for the encodings unorm, snorm and biased"],
        ),
        (
            &["--parallax-bits", "16"],
            &["error: --parallax-encoding and --parallax-bits are for parallax maps: ask for them with --maps"],
        ),
    ];
    for (arguments, parts) in cases {
        let run = folder.run(&[&["bake", "tex", "--out", "out"], arguments].concat()).ends(2);
        for part in parts {
            assert!(run.stderr.contains(part), "{arguments:?}: {part:?} is not in {}", run.stderr);
        }
    }
    assert_eq!(folder.files("out"), [""; 0]);
}

#[test]
fn a_codes_depth_can_be_chosen_for_each_map() {
    let folder = Folder::new();
    let map = folder.grey8("tex/a_height.png", 9, 5, bumps8);
    let bits = ["--bits", "16", "--parallax-bits", "8", "--scale", "3"];
    folder.run(&[&["bake", "tex", "--out", "out", "--maps", "normal,parallax", "-q"], &bits[..]].concat()).ends(0);
    assert_eq!(read_png(&folder.path("out/a_normal.png")).2.as_ref().depth(), Depth::Bits16);
    assert_parallax(&folder, "out/a_parallax.png", &map, &parallax(3));
}
