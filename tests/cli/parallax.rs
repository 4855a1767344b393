//! `texbake parallax`: one file.

use super::support::{Folder, assert_parallax, bumps8, bumps16, read_png, write_normals};
use serde_json::{Value, json};
use texbake::{
    Baker, CodesRef, Depth, Edge, Edges, Encoding, NormalOptions, ParallaxFormat, ParallaxOptions, Precision, Scale,
};

const BIASED8: ParallaxFormat = ParallaxFormat { encoding: Encoding::Biased, depth: Depth::Bits8 };
const BIASED16: ParallaxFormat = ParallaxFormat { encoding: Encoding::Biased, depth: Depth::Bits16 };

fn options(scale: i32) -> ParallaxOptions {
    ParallaxOptions { scale: Scale::texels(scale), format: BIASED8, ..ParallaxOptions::default() }
}

#[test]
fn a_map_is_baked_from_heights_alone() {
    let folder = Folder::new();
    let map = folder.grey8("height.png", 64, 32, bumps8);
    let run = folder.run(&["parallax", "height.png", "-o", "p/parallax.png", "--scale", "24"]).ends(0);
    assert_parallax(&folder, "p/parallax.png", &map, &options(24));
    assert_eq!(run.stdout, "");
    run.line("p/parallax.png: 64 x 32, u8 to parallax biased 8 (128 is exactly zero), scale 24, exact; ");
    run.line(
        "in a shader: u = (0.046875, 0.09375) for 4 iterations; with the height map itself, scale (0.375, 0.75) and \
         bias (-0.1875, -0.375)",
    );
    assert_eq!(run.stderr.lines().count(), 2);
    // No sidecar unless it is asked for.
    assert_eq!(folder.files("p"), ["parallax.png"]);
}

#[test]
fn every_option_reaches_the_bake() {
    let folder = Folder::new();
    let map = folder.grey16("height.png", 19, 21, bumps16);
    let cases: [(&[&str], ParallaxOptions); 6] = [
        (&["--scale", "9"], options(9)),
        (&["--scale", "-7", "--edge", "mirror,clamp"], {
            ParallaxOptions { edges: Edges { x: Edge::Mirror, y: Edge::Clamp }, ..options(-7) }
        }),
        (&["--bits", "16", "--scale", "3"], ParallaxOptions { format: BIASED16, ..options(3) }),
        (&["--encoding", "unorm", "--scale", "3"], {
            ParallaxOptions { format: ParallaxFormat { encoding: Encoding::Unorm, ..BIASED8 }, ..options(3) }
        }),
        (&["--filter", "scharr", "--backend", "reference"], {
            ParallaxOptions { filter: texbake::Filter::Scharr, ..options(1) }
        }),
        (&["--size", "2x1", "--depth", "1/2", "--backend", "cpu"], {
            let scale = Scale::physical(2.into(), 1.into(), "1/2".parse().unwrap());
            ParallaxOptions { scale, ..options(1) }
        }),
    ];
    for (arguments, options) in cases {
        let run = folder.run(&[&["parallax", "height.png", "-o", "p.png", "--quiet"], arguments].concat()).ends(0);
        assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""), "{arguments:?}");
        assert_parallax(&folder, "p.png", &map, &options);
    }
}

#[test]
fn half_the_height_is_exactly_zero() {
    let folder = Folder::new();
    folder.file("half.raw", 0.5f32.to_le_bytes());
    folder.run(&["parallax", "half.raw", "--raw", "1x1:f32le", "-o", "p.png", "-q"]).ends(0);
    assert_eq!(read_png(&folder.path("p.png")).2.as_ref(), CodesRef::U8(&[128]));
    folder.run(&["parallax", "half.raw", "--raw", "1x1:f32le", "-o", "p.png", "-q", "--bits", "16"]).ends(0);
    assert_eq!(read_png(&folder.path("p.png")).2.as_ref(), CodesRef::U16(&[32768]));
}

#[test]
fn a_sidecar_tells_a_shader_what_it_needs() {
    let folder = Folder::new();
    folder.grey8("height.png", 64, 32, bumps8);
    let arguments =
        ["parallax", "height.png", "-o", "out/stones.v2.png", "--scale", "24", "--json", "--iterations", "4"];
    folder.run(&[&arguments[..], &["-q"]].concat()).ends(0);
    assert_eq!(folder.files("out"), ["stones.v2.json", "stones.v2.png"]);
    let shader = "vec2 step = eye.xy * u; for (int i = 0; i < 4; i++) { uv += step * (texture(map, uv).r * multiply + \
                  add); }";
    let expected = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "map": "stones.v2.png",
        "size": [64, 32],
        "encoding": "biased",
        "bits": "8",
        "scale_in_texels": [24.0, 24.0],
        "iterations": 4,
        // 24 / (2 * 4 * 64) and 24 / (2 * 4 * 32).
        "u": [0.046875, 0.09375],
        "welsh": { "scale": [0.375, 0.75], "bias": [-0.1875, -0.375] },
        "shader": shader,
        "axes": "x of eye and of the offset is along the tangent, in which u increases, and y along the second axis of \
                 tangent space, in which v increases (FGED2 listing 7.9): with green up, that is up the image; where v \
                 grows down the rows, change the sign of the offset's y",
    });
    let mut sidecar = folder.json("out/stones.v2.json");
    let decode = sidecar.as_object_mut().unwrap().remove("decode").unwrap();
    assert_eq!(sidecar, expected);
    assert_decodes(&decode, "max((code - 128) / 127, -1)", [255.0 / 127.0, -128.0 / 127.0]);
}

/// The reader of JSON may miss a number of 17 digits by one in the last.
#[track_caller]
fn assert_decodes(decode: &Value, code: &str, numbers: [f64; 2]) {
    assert_eq!((&decode["code"], decode.as_object().unwrap().len()), (&json!(code), 3));
    for (key, number) in ["multiply", "add"].into_iter().zip(numbers) {
        assert!((decode[key].as_f64().unwrap() - number).abs() <= 2.0 * f64::EPSILON, "{key}: {decode}");
    }
}

#[test]
fn a_sidecar_follows_the_scale_the_steps_and_the_codes() {
    let folder = Folder::new();
    folder.grey8("height.png", 10, 5, bumps8);
    let sidecar = |output: &str, arguments: &[&str]| {
        let all = [&["parallax", "height.png", "-o", output, "--json", "-q"], arguments].concat();
        folder.run(&all).ends(0);
        let all = folder.json(&format!("{}.json", output.split('.').next().unwrap()));
        ["u", "scale_in_texels", "decode"].map(|key| all[key].clone())
    };
    // 2 m by 1 m, 10 texels by 5: 5 texels to the metre on either axis, and 0.1 m are half a texel.
    let [u, scale, decode] = sidecar("a.tif", &["--size", "2x1", "--depth", "0.1", "--iterations", "1"]);
    assert_eq!((u, scale), (json!([0.5 / 20.0, 0.5 / 10.0]), json!([0.5, 0.5])));
    assert_decodes(&decode, "max(code / 127, -1)", [1.0, 0.0]);
    let [u, _, decode] = sidecar("b.png", &["--scale", "-3", "--iterations", "10", "--bits", "16"]);
    assert_eq!(u, json!([-3.0 / 200.0, -3.0 / 100.0]));
    assert_decodes(&decode, "max((code - 32768) / 32767, -1)", [65535.0 / 32767.0, -32768.0 / 32767.0]);
    let [_, _, decode] = sidecar("c.exr", &[]);
    assert_decodes(&decode, "code", [1.0, 0.0]);
}

#[test]
fn given_normals_take_the_place_of_slopes() {
    let folder = Folder::new();
    let heights = folder.grey8("height.png", 12, 7, bumps8);
    let other = folder.grey16("other.png", 12, 7, bumps16);
    let normal = NormalOptions { scale: Scale::texels(5), ..NormalOptions::default() };
    let normals = Baker::reference().normal(&other, &normal).unwrap();
    write_normals(&folder, "normal.png", &normals);
    let expected = |normals| Baker::reference().parallax_with_normals(&heights, normals, BIASED8, Precision::Exact);
    let given = ["--normal", "normal.png", "--scale", "24"];
    let run = folder.run(&[&["parallax", "height.png", "-o", "p.png"], &given[..]].concat()).ends(0);
    let line = "p.png: 12 x 7, u8 to parallax biased 8 (128 is exactly zero) with normal.png, scale 24, exact; ";
    assert_eq!(run.stderr.lines().count(), 2, "{}", run.line(line));
    assert_eq!(read_png(&folder.path("p.png")).2.as_ref(), expected(&normals).unwrap().codes());

    // The same file read as two channels of biased codes.
    let biased = ["--normal-encoding", "biased", "--normal-channels", "xy", "-q", "--report", "r.json"];
    folder.run(&[&["parallax", "height.png", "-o", "p.png"], &given[..], &biased[..]].concat()).ends(0);
    let CodesRef::U8(codes) = normals.codes() else { unreachable!("it is an 8-bit map") };
    let xy = codes.as_chunks::<3>().0.iter().flat_map(|&[x, y, _]| [x, y]).collect();
    let format = texbake::NormalFormat {
        encoding: Encoding::Biased,
        channels: texbake::Channels::Xy,
        ..texbake::NormalFormat::default()
    };
    let normals = texbake::NormalMap::new(normals.size(), format, texbake::Codes::U8(xy)).unwrap();
    assert_eq!(read_png(&folder.path("p.png")).2.as_ref(), expected(&normals).unwrap().codes());

    let file = &folder.json("r.json")["files"][0];
    assert_eq!((&file["normals"], &file["options"]["maps"]), (&json!("normal.png"), &json!("parallax")));
    assert_eq!(file["scale"], json!({ "x": "24", "y": "24", "exact": true }));
    assert_eq!(
        (&file["result"], &file["depth"], &file["options"]["encoding"]),
        (&json!("baked"), &json!("u8"), &Value::Null)
    );
    let bytes = |name: &str| std::fs::metadata(folder.path(name)).unwrap().len();
    assert_eq!(file["bytes_in"], bytes("height.png") + bytes("normal.png"));
    assert_eq!(file["bytes_out"], bytes("p.png"));
}

#[test]
fn heights_beyond_the_range_are_counted() {
    let folder = Folder::new();
    // The last row, which a map that wraps needs first, holds two of them.
    let heights = [0.0f32, 1.0, 0.5, 1.5, 0.25, 0.75, -0.001, 1.001];
    folder.file("h.raw", heights.map(f32::to_le_bytes).concat());
    for output in ["p.png", "p.tif", "p.exr"] {
        let run = folder.run(&["parallax", "h.raw", "--raw", "2x4:f32le", "-o", output, "--report", "r.json"]).ends(0);
        let warning = "3 heights lie outside 0 to 1 and count as 0 or 1 in the parallax map: export the map with \
                       heights from 0 to 1, or bring those from MIN to MAX there with gdal_translate -ot Float32 \
                       -scale MIN MAX 0 1, and multiply --scale by MAX - MIN";
        run.line(&format!("warning: h.raw: {warning}"));
        assert_eq!(folder.json("r.json")["files"][0]["warnings"], json!([warning]));
    }
    let run = folder.run(&["parallax", "h.raw", "--raw", "1x4:f32le", "-o", "p.png"]).ends(1);
    assert!(!run.stderr.contains("warning"), "{}", run.stderr);
    folder.file("h.raw", heights[..4].iter().flat_map(|height| height.to_le_bytes()).collect::<Vec<u8>>());
    let run = folder.run(&["parallax", "h.raw", "--raw", "2x2:f32le", "-o", "p.png", "--edge", "clamp"]).ends(0);
    run.line("warning: h.raw: 1 height lies outside 0 to 1 and counts as 0 or 1 in the parallax map");
    // A normal map keeps them as they are.
    let run = folder.run(&["normal", "h.raw", "--raw", "2x2:f32le", "-o", "n.png"]).ends(0);
    assert!(!run.stderr.contains("warning"), "{}", run.stderr);
}

#[test]
fn mistakes_are_refused_with_the_way_out() {
    let folder = Folder::new();
    folder.grey8("h.png", 4, 3, bumps8);
    folder.grey8("wide.png", 5, 3, bumps8);
    let wide = Baker::reference().normal(&folder.grey8("w.png", 5, 3, bumps8), &NormalOptions::default()).unwrap();
    write_normals(&folder, "wide_normal.png", &wide);
    folder.file("p.json", [7]);
    let cases: [(i32, &[&str], &str); 13] = [
        (1, &["h.png", "-o", "p.png", "--normal", "gone.png"], "gone.png: No such file"),
        (1, &["gone.png", "-o", "p.png"], "gone.png: No such file"),
        (
            1,
            &["h.png", "-o", "p.jpg"],
            "p.jpg: the extension .jpg is unknown; texbake writes .png, .tif, .tiff, .exr, .ktx2 and .dds",
        ),
        (
            1,
            &["h.png", "-o", "p.png", "--normal", "wide.png"],
            "wide.png: it has one channel: a height map?; give a normal map, or bake one from the heights with texbake normal",
        ),
        (
            1,
            &["h.png", "-o", "p.png", "--normal", "wide_normal.png"],
            "wide_normal.png: it is 5 x 3, and h.png is 4 x 3; give the normal map of these heights",
        ),
        (2, &["h.png", "-o", "p.png", "--normal", "wide_normal.png", "--edge", "clamp"], "--edge <MODE>"),
        (2, &["h.png", "-o", "p.png", "--normal-channels", "xy"], "--normal <FILE>"),
        (2, &["h.png", "-o", "p.png", "--iterations", "0"], "it must be a whole number from 1 to 1000"),
        (2, &["h.png", "-o", "p.png", "--bits", "32f", "--encoding", "snorm"], "--bits is 32f: it must be 8 or 16"),
        (2, &["h.png", "-o", "p.png", "--channels", "xy"], "unexpected argument '--channels'"),
        (1, &["h.png", "-o", "p.png", "--normal", "p.png"], "p.png: No such file"),
        (
            1,
            &["p.json", "--raw", "1x1:u8", "-o", "p.png", "--json"],
            "p.json: the sidecar would overwrite the input p.json; choose another name for the sidecar",
        ),
        (
            1,
            &["h.png", "-o", "q.png", "--json", "--report", "q.json"],
            "q.json: the report would overwrite the output q.json; choose another name for the report",
        ),
    ];
    for (status, arguments, message) in cases {
        let run = folder.run(&[&["parallax"], arguments].concat()).ends(status);
        assert!(run.stderr.contains(message), "{arguments:?}: {message:?} is not in {}", run.stderr);
    }
    let run = folder.run(&["parallax", "h.png", "-o", "wide_normal.png", "--normal", "wide_normal.png"]).ends(1);
    run.says("error: wide_normal.png: the output of h.png would overwrite this input", &["choose another output"]);
    assert_eq!(folder.files("."), ["h.png", "p.json", "w.png", "wide.png", "wide_normal.png"]);
}

#[test]
fn a_sidecar_takes_the_place_of_sidecars_alone() {
    let folder = Folder::new();
    folder.grey8("h.png", 4, 3, bumps8);
    let bake = |scale: &str| folder.run(&["parallax", "h.png", "-o", "p.png", "--json", "-q", "--scale", scale]);
    for other in ["", "{}", "{\"version\": \"1\"}", "[1, 2]", "notes"] {
        folder.file("p.json", other);
        let run = bake("2").ends(1);
        assert_eq!(
            run.stderr,
            "error: p.json: the sidecar would overwrite this file, which texbake did not write; move it away, or give \
             the output another name\n"
        );
        assert_eq!(std::fs::read_to_string(folder.path("p.json")).unwrap(), other);
        assert_eq!(folder.files("."), ["h.png", "p.json"]);
    }
    std::fs::remove_file(folder.path("p.json")).unwrap();
    for scale in ["2", "3"] {
        bake(scale).ends(0);
        assert_eq!(folder.json("p.json")["scale_in_texels"][0], json!(scale.parse::<f64>().unwrap()));
    }
}

#[test]
fn no_number_is_minus_zero() {
    let folder = Folder::new();
    folder.grey8("h.png", 4, 3, bumps8);
    let run = folder.run(&["parallax", "h.png", "-o", "p.png", "--scale", "0", "--json"]).ends(0);
    run.line("u = (0, 0) for 4 iterations; with the height map itself, scale (0, 0) and bias (0, 0)");
    assert!(!std::fs::read_to_string(folder.path("p.json")).unwrap().contains("-0.0"));
}

#[test]
fn a_failed_map_has_no_sidecar() {
    let folder = Folder::new();
    folder.file("h.png", "");
    folder.run(&["parallax", "h.png", "-o", "p.png", "--json"]).ends(1).line("error: h.png: the file is empty");
    assert_eq!(folder.files("."), ["h.png"]);
}
