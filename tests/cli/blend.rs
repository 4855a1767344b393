//! `texbake blend`: two normal maps.

use super::support::{Folder, bumps8, bumps16, read_png, write_normals};
use serde_json::{Value, json};
use texbake::{
    Baker, BlendInputs, BlendMethod, BlendOptions, Channels, Codes, CodesRef, Convention, Depth, Encoding, Grid,
    HeightMap, NormalFormat, NormalMap, NormalOptions, Rational, Scale, Size,
};

const FORMAT: NormalFormat = NormalFormat {
    encoding: Encoding::Unorm,
    depth: Depth::Bits8,
    channels: Channels::Xyz,
    convention: Convention::Gl,
};

/// The normal map of bumps, 8 bits, and its file.
fn base(folder: &Folder, name: &str, width: usize, height: usize) -> NormalMap {
    let heights = HeightMap::from(Grid::from_fn(width, height, bumps8).unwrap());
    let options = NormalOptions { scale: Scale::texels(3), ..NormalOptions::default() };
    let map = Baker::reference().normal(&heights, &options).unwrap();
    write_normals(folder, name, &map);
    map
}

/// The normal map of other bumps, 16 bits, and its file.
fn detail(folder: &Folder, name: &str, width: usize, height: usize) -> NormalMap {
    let heights = HeightMap::from(Grid::from_fn(width, height, bumps16).unwrap());
    let format = NormalFormat { depth: Depth::Bits16, ..FORMAT };
    let options = NormalOptions { scale: Scale::texels(2), format, ..NormalOptions::default() };
    let map = Baker::reference().normal(&heights, &options).unwrap();
    write_normals(folder, name, &map);
    map
}

fn ratio(text: &str) -> Rational {
    text.parse().unwrap()
}

fn weighted(base: &str, detail: &str) -> BlendMethod {
    BlendMethod::Weighted { base: ratio(base), detail: ratio(detail) }
}

/// The same codes, read in another format.
fn read_as(map: &NormalMap, format: NormalFormat) -> NormalMap {
    let codes = match map.codes() {
        CodesRef::U8(codes) => Codes::U8(codes.to_vec()),
        CodesRef::U16(codes) => Codes::U16(codes.to_vec()),
        _ => unreachable!("a PNG holds integers"),
    };
    NormalMap::new(map.size(), format, codes).unwrap()
}

/// Fails unless the PNG `name` holds the blend of the reference.
#[track_caller]
fn assert_blended(
    folder: &Folder,
    name: &str,
    (base, detail, mask): (&NormalMap, &NormalMap, Option<&HeightMap>),
    options: &BlendOptions,
) {
    let expected = Baker::reference().blend(&BlendInputs { base, detail, mask }, options).unwrap();
    let (width, height, codes) = read_png(&folder.path(name));
    assert_eq!((width, height), (base.size().width(), base.size().height()), "{name}");
    assert!(codes.as_ref() == expected.codes(), "{name}: other codes than the reference's");
}

#[test]
fn two_slopes_add_up() {
    let folder = Folder::new();
    let slope = NormalMap::new(Size::new(1, 1).unwrap(), FORMAT, Codes::U8(vec![218, 128, 218])).unwrap();
    write_normals(&folder, "a.png", &slope);
    std::fs::copy(folder.path("a.png"), folder.path("b.png")).unwrap();
    let run = folder.run(&["blend", "a.png", "b.png", "-o", "new/sum.png"]).ends(0);
    // 45 degrees and 45 degrees: (2, 0, 1) / sqrt(5) in 127.5 (v + 1).
    assert_eq!(read_png(&folder.path("new/sum.png")).2.as_ref(), CodesRef::U8(&[242, 128, 185]));
    assert_eq!(run.stdout, "");
    run.line("new/sum.png: 1 x 1, add of a.png (unorm 8 xyz gl) and b.png (unorm 8 xyz gl) to unorm 8 xyz gl, exact; ");
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    // b's bumps taken away.
    folder.run(&["blend", "a.png", "b.png", "-o", "flat.png", "--weights", "1,-1", "-q"]).ends(0);
    assert_eq!(read_png(&folder.path("flat.png")).2.as_ref(), CodesRef::U8(&[128, 128, 255]));
}

#[test]
fn every_option_reaches_the_blend() {
    let folder = Folder::new();
    let (a, b) = (base(&folder, "a.png", 13, 9), detail(&folder, "b.png", 13, 9));
    let as_read =
        |map: &NormalMap, format: NormalFormat| read_as(map, NormalFormat { depth: map.format().depth, ..format });
    let usual = BlendOptions::default();
    let of = |method| BlendOptions { method, ..usual };
    let biased = NormalFormat { encoding: Encoding::Biased, ..FORMAT };
    let dx = NormalFormat { convention: Convention::Dx, ..FORMAT };
    let fine = NormalFormat { depth: Depth::Bits16, encoding: Encoding::Biased, channels: Channels::Xy, ..dx };
    let cases: Vec<(&[&str], NormalFormat, NormalFormat, BlendOptions)> = vec![
        (&["--method", "add"], FORMAT, FORMAT, usual),
        (&["--method", "add", "--weights", "1,1"], FORMAT, FORMAT, usual),
        (&["--weights", "1,-0.5"], FORMAT, FORMAT, of(weighted("1", "-1/2"))),
        (&["--weights", "-1/3,7"], FORMAT, FORMAT, of(weighted("-1/3", "7"))),
        (&["--method", "weighted", "--weights", "2,0"], FORMAT, FORMAT, of(weighted("2", "0"))),
        (&["--transition", "0.25"], FORMAT, FORMAT, of(weighted("3/4", "1/4"))),
        (&["--method", "partial-derivative"], FORMAT, FORMAT, usual),
        (&["--method", "partial-derivative", "--weights", "2,3"], FORMAT, FORMAT, of(weighted("2", "3"))),
        (&["--method", "linear"], FORMAT, FORMAT, of(BlendMethod::Linear)),
        (&["--method", "overlay"], FORMAT, FORMAT, of(BlendMethod::Overlay)),
        (&["--method", "udn"], FORMAT, FORMAT, of(BlendMethod::Udn)),
        (&["--method", "whiteout"], FORMAT, FORMAT, of(BlendMethod::Whiteout)),
        (&["--method", "rnm"], FORMAT, FORMAT, of(BlendMethod::Rnm)),
        (&["--base-encoding", "biased"], biased, FORMAT, usual),
        (&["--detail-encoding", "biased", "--base-convention", "dx"], dx, biased, usual),
        (&["--detail-convention", "dx", "--backend", "reference"], FORMAT, dx, usual),
        (
            &["--encoding", "biased", "--bits", "16", "--channels", "xy", "--convention", "dx"],
            FORMAT,
            FORMAT,
            BlendOptions { format: fine, ..usual },
        ),
    ];
    for (arguments, base, detail, options) in cases {
        let run = folder.run(&[&["blend", "a.png", "b.png", "-o", "out.png", "--quiet"], arguments].concat()).ends(0);
        assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""), "{arguments:?}");
        if options.format.channels == Channels::Xy {
            // An RGB file whose blue is 0.
            let expected =
                Baker::reference().blend(&BlendInputs { base: &a, detail: &b, mask: None }, &options).unwrap();
            let CodesRef::U16(xy) = expected.codes() else { unreachable!("it was asked for") };
            let rgb: Vec<u16> = xy.as_chunks::<2>().0.iter().flat_map(|&[x, y]| [x, y, 0]).collect();
            assert_eq!(read_png(&folder.path("out.png")).2.as_ref(), CodesRef::U16(&rgb));
        } else {
            assert_blended(&folder, "out.png", (&as_read(&a, base), &as_read(&b, detail), None), &options);
        }
    }
}

#[test]
fn two_channels_of_an_input_are_enough() {
    let folder = Folder::new();
    let (a, b) = (base(&folder, "a.png", 7, 5), detail(&folder, "b.png", 7, 5));
    folder.run(&["blend", "a.png", "b.png", "-o", "out.png", "-q", "--base-channels", "xy"]).ends(0);
    let CodesRef::U8(codes) = a.codes() else { unreachable!("it is an 8-bit map") };
    let xy = codes.as_chunks::<3>().0.iter().flat_map(|&[x, y, _]| [x, y]).collect();
    let a = NormalMap::new(a.size(), NormalFormat { channels: Channels::Xy, ..FORMAT }, Codes::U8(xy)).unwrap();
    assert_blended(&folder, "out.png", (&a, &b, None), &BlendOptions::default());
}

#[test]
fn files_of_every_encoding_go_in_and_out() {
    let folder = Folder::new();
    let heights = HeightMap::from(Grid::from_fn(9, 6, bumps8).unwrap());
    let normals = |name: &str, encoding, depth| {
        let format = NormalFormat { encoding, depth, ..FORMAT };
        let options = NormalOptions { scale: Scale::texels(4), format, ..NormalOptions::default() };
        let map = Baker::reference().normal(&heights, &options).unwrap();
        map.write(folder.path(name)).unwrap();
        map
    };
    let a = normals("a.tif", Encoding::Snorm, Depth::Bits16);
    let b = normals("b.exr", Encoding::Float, Depth::Float32);
    let c = normals("c.png", Encoding::Unorm, Depth::Bits8);
    for (detail, name) in [(&b, "b.exr"), (&c, "c.png")] {
        let run = folder.run(&["blend", "a.tif", name, "-o", "out.png"]).ends(0);
        assert_blended(&folder, "out.png", (&a, detail, None), &BlendOptions::default());
        assert!(run.line("out.png: ").contains("add of a.tif (snorm 16 xyz gl) and "), "{}", run.stderr);
    }
    // Without a word a TIFF takes 16 bits and an EXR floats.
    for (output, encoding, depth) in
        [("out.tif", Encoding::Unorm, Depth::Bits16), ("out.exr", Encoding::Float, Depth::Float32)]
    {
        folder.run(&["blend", "a.tif", "c.png", "-o", output, "-q"]).ends(0);
        let options = BlendOptions { format: NormalFormat { encoding, depth, ..FORMAT }, ..BlendOptions::default() };
        let inputs = BlendInputs { base: &a, detail: &c, mask: None };
        let expected = folder.path(&format!("expected_{output}"));
        Baker::reference().blend(&inputs, &options).unwrap().write(&expected).unwrap();
        assert!(std::fs::read(folder.path(output)).unwrap() == std::fs::read(expected).unwrap(), "{output}");
    }
}

#[test]
fn a_smaller_map_tiles() {
    let folder = Folder::new();
    let (a, b) = (base(&folder, "a.png", 13, 9), detail(&folder, "b.png", 5, 4));
    let options = BlendOptions { tile: true, ..BlendOptions::default() };
    folder.run(&["blend", "a.png", "b.png", "-o", "out.png", "--tile", "-q"]).ends(0);
    assert_blended(&folder, "out.png", (&a, &b, None), &options);
    // A larger one is cut.
    folder.run(&["blend", "b.png", "a.png", "-o", "out.png", "--tile", "-q"]).ends(0);
    assert_blended(&folder, "out.png", (&b, &a, None), &options);
    // It is held in memory, and the limit is for that too.
    let run = folder.run(&["blend", "b.png", "a.png", "-o", "x.png", "--tile", "--max-bytes", "350"]).ends(1);
    run.says("error: a.png: ", &["13 x 9 texels, 351 bytes decoded, above the limit of 350", "--max-bytes"]);
}

#[test]
fn a_mask_is_a_transition_of_each_texel() {
    let folder = Folder::new();
    let (a, b) = (base(&folder, "a.png", 13, 9), detail(&folder, "b.png", 13, 9));
    let mask = folder.grey8("mask.png", 13, 9, |x, y| (x * 20 + y) as u8);
    let options = BlendOptions { method: BlendMethod::Masked, ..BlendOptions::default() };
    let run = folder.run(&["blend", "a.png", "b.png", "-o", "out.png", "--mask", "mask.png"]).ends(0);
    assert_blended(&folder, "out.png", (&a, &b, Some(&mask)), &options);
    run.line("weighted of a.png (unorm 8 xyz gl) and b.png (unorm 16 xyz gl) by mask.png to unorm 8 xyz gl");

    let fine = folder.grey16("fine.png", 13, 9, bumps16);
    folder.run(&["blend", "a.png", "b.png", "-o", "out.png", "-q", "--mask", "fine.png"]).ends(0);
    assert_blended(&folder, "out.png", (&a, &b, Some(&fine)), &options);

    let texbake::Heights::U8(codes) = mask.heights() else { unreachable!("it is an 8-bit map") };
    let samples: Vec<u8> = codes.iter().flat_map(|&code| [3, code, 200]).collect();
    folder.file("rgb.png", super::support::png(13, 9, png::ColorType::Rgb, png::BitDepth::Eight, &samples));
    let by_channel = ["--mask", "rgb.png", "--mask-channel", "g", "--method", "partial-derivative"];
    folder.run(&[&["blend", "a.png", "b.png", "-o", "out.png", "-q"], &by_channel[..]].concat()).ends(0);
    assert_blended(&folder, "out.png", (&a, &b, Some(&mask)), &options);
    let run = folder.run(&["blend", "a.png", "b.png", "-o", "x.png", "--mask", "rgb.png"]).ends(1);
    assert_eq!(
        run.stderr,
        "error: rgb.png: its channels differ, first at column 0, row 0: 3, 0, 200; choose one with --mask-channel r, g, \
         b, a or luma\n"
    );
    let by_alpha = ["--mask", "rgb.png", "--mask-channel", "a"];
    let run = folder.run(&[&["blend", "a.png", "b.png", "-o", "x.png"], &by_alpha[..]].concat()).ends(1);
    run.line("error: rgb.png: it has no alpha channel; choose another with --mask-channel r, g, b or luma");
}

#[test]
fn a_mask_that_is_the_same_everywhere_gives_a_warning() {
    let folder = Folder::new();
    base(&folder, "a.png", 3, 2);
    base(&folder, "b.png", 3, 2);
    let grey_alpha: Vec<u8> = (0..6).flat_map(|i| [255, 40 * i]).collect();
    folder.file("m.png", super::support::png(3, 2, png::ColorType::GrayscaleAlpha, png::BitDepth::Eight, &grey_alpha));
    let blend = |arguments: &[&str]| {
        folder.run(&[&["blend", "a.png", "b.png", "-o", "n.png", "--mask"], arguments].concat()).ends(0)
    };
    blend(&["m.png"]).line(
        "warning: m.png: the mask is the same everywhere: is it in the alpha channel? Then read it with --mask-channel a",
    );
    blend(&["m.png", "--mask-channel", "g"]).line("the same everywhere: is it in another channel? See --mask-channel");
    let run = blend(&["m.png", "--mask-channel", "a"]);
    assert!(!run.stderr.contains("warning"), "{}", run.stderr);
    // One that varies between rows alone.
    folder.grey16("rows.png", 3, 2, |_, y| y as u16);
    let run = blend(&["rows.png"]);
    assert!(!run.stderr.contains("warning"), "{}", run.stderr);
}

#[test]
fn options_of_the_inputs_are_called_by_their_names() {
    let folder = Folder::new();
    base(&folder, "a.png", 3, 2);
    let grey_alpha = super::support::png(3, 2, png::ColorType::GrayscaleAlpha, png::BitDepth::Eight, &[9; 12]);
    folder.file("ga.png", grey_alpha);
    let reason = "error: ga.png: it has one channel and alpha: a height map?; if they hold x and y, read it with";
    for (inputs, option) in [(["ga.png", "a.png"], "--base-channels xy"), (["a.png", "ga.png"], "--detail-channels xy")]
    {
        let run = folder.run(&[&["blend", "-o", "n.png"], &inputs[..]].concat()).ends(1);
        assert_eq!(run.stderr, format!("{reason} {option}\n"));
    }
    let run = folder.run(&["blend", "a.png", "a.png", "-o", "n.png", "--detail-encoding", "snorm"]).ends(1);
    run.line("detail-encoding is snorm, for a.png: it must be unorm or biased");
    folder.grey8("h.png", 3, 2, bumps8);
    let run = folder.run(&["parallax", "h.png", "-o", "p.png", "--normal", "ga.png"]).ends(1);
    assert_eq!(run.stderr, format!("{reason} --normal-channels xy\n"));
}

#[test]
fn a_map_without_z_is_told_from_one_that_is_wrong_here_and_there() {
    let folder = Folder::new();
    base(&folder, "a.png", 5, 4);
    folder.run(&["blend", "a.png", "a.png", "-o", "xy.png", "--channels", "xy", "-q"]).ends(0);
    for (inputs, option) in [(["xy.png", "a.png"], "--base-channels xy"), (["a.png", "xy.png"], "--detail-channels xy")]
    {
        let run = folder.run(&[&["blend", "-o", "n.png"], &inputs[..]].concat()).ends(0);
        let hint = format!("; if the map holds x and y alone, as xy maps in PNG do, read it with {option}");
        run.says("warning: xy.png: 20 normals, of them 20 with z below zero", &[&hint]);
        // The advice is good.
        let [option, xy] = [option.split(' ').next().unwrap(), "xy"];
        let run = folder.run(&[&["blend", "-o", "n.png", option, xy], &inputs[..]].concat()).ends(0);
        assert!(!run.stderr.contains("warning"), "{}", run.stderr);
    }
}

#[test]
fn a_map_that_is_cut_where_it_tiles_gives_a_warning() {
    let folder = Folder::new();
    base(&folder, "a.png", 12, 9);
    base(&folder, "b.png", 5, 3);
    base(&folder, "c.png", 24, 2);
    base(&folder, "d.png", 4, 3);
    let blend = |detail| folder.run(&["blend", "a.png", detail, "-o", "n.png", "--tile"]).ends(0);
    blend("b.png").line("warning: b.png: it is cut at the right edge (its width 5 does not divide 12)");
    blend("c.png").line(
        "warning: c.png: it is cut at the right edge (its width 24 does not divide 12) and at the bottom edge (its \
         height 2 does not divide 9)",
    );
    let run = blend("d.png");
    assert!(!run.stderr.contains("warning"), "{}", run.stderr);
}

#[test]
fn a_blend_is_reported() {
    let folder = Folder::new();
    base(&folder, "a.png", 6, 4);
    detail(&folder, "b.png", 6, 4);
    let arguments = ["blend", "a.png", "b.png", "-o", "out/n.png", "--weights", "1,-0.5", "--backend", "reference"];
    folder.run(&[&arguments[..], &["-q", "--report", "r.json"]].concat()).ends(0);
    let mut report = folder.json("r.json");
    let milliseconds = report.as_object_mut().unwrap().remove("milliseconds").unwrap();
    assert!(milliseconds.as_f64().unwrap() > 0.0);
    let bytes = |name: &str| std::fs::metadata(folder.path(name)).unwrap().len();
    let layer = |file: &str, bits: &str| {
        json!({
            "file": file, "format": { "encoding": "unorm", "bits": bits, "channels": "xyz", "convention": "gl" },
            "texels": 24, "below_zero": 0, "at_zero": 0, "zero_vectors": 0, "non_unit": 0,
        })
    };
    assert_eq!(
        report,
        json!({
            "version": env!("CARGO_PKG_VERSION"), "base": layer("a.png", "8"), "detail": layer("b.png", "16"),
            "mask": null, "mask_channel": null, "output": "out/n.png", "method": "weighted",
            "weights": { "used": "1,-0.5", "exact": true }, "tile": false,
            "format": { "encoding": "unorm", "bits": "8", "channels": "xyz", "convention": "gl" },
            "precision": "exact", "result": "baked", "error": null, "warnings": [], "backend": "cpu",
            "adapter": "reference, 1 thread", "reason": "asked for", "fallback": null, "width": 6, "height": 4,
            "bytes_in": bytes("a.png") + bytes("b.png"), "bytes_out": bytes("out/n.png"),
        })
    );
    // One that fails is reported too.
    let run = folder.run(&["blend", "a.png", "gone.png", "-o", "out/n.png", "--report", "r.json"]).ends(1);
    let report = folder.json("r.json");
    assert_eq!(
        (&report["result"], &report["weights"], &report["bytes_out"]),
        (&json!("failed"), &Value::Null, &json!(0))
    );
    assert_eq!(report["detail"]["format"], Value::Null);
    assert_eq!(run.stderr, format!("error: {}\n", report["error"].as_str().unwrap()));
}

#[test]
fn weights_of_many_digits_give_a_warning() {
    let folder = Folder::new();
    let (a, b) = (base(&folder, "a.png", 6, 4), detail(&folder, "b.png", 6, 4));
    let arguments = ["blend", "a.png", "b.png", "-o", "n.png", "--weights", "3.14159265358979,0", "--report", "r.json"];
    let run = folder.run(&arguments).ends(0);
    let warning = "the weights have too many digits: 65298/20785,0, the nearest ones that fit, were used";
    run.line(&format!("warning: {warning}"));
    let report = folder.json("r.json");
    assert_eq!(report["warnings"], json!([warning]));
    assert_eq!(report["weights"], json!({ "used": "65298/20785,0", "exact": false }));
    let method = weighted("65298/20785", "0");
    assert_blended(&folder, "n.png", (&a, &b, None), &BlendOptions { method, ..BlendOptions::default() });
    assert_eq!(folder.run(&[&arguments[..], &["-q"]].concat()).ends(0).stderr, "");
}

#[test]
fn texels_that_are_no_normals_are_counted() {
    let folder = Folder::new();
    // Flat, two below zero, one at zero, none at all, and one too short.
    let codes = vec![128, 128, 255, 128, 128, 0, 218, 128, 37, 255, 128, 128, 128, 128, 128, 160, 128, 160];
    let odd = NormalMap::new(Size::new(3, 2).unwrap(), FORMAT, Codes::U8(codes)).unwrap();
    write_normals(&folder, "odd.png", &odd);
    let even = base(&folder, "a.png", 3, 2);
    let run = folder.run(&["blend", "a.png", "odd.png", "-o", "n.png", "--report", "r.json"]).ends(0);
    assert_blended(&folder, "n.png", (&even, &odd, None), &BlendOptions::default());
    let warning = "odd.png: 6 normals, of them 2 with z below zero, 1 with z of zero, 1 with no component but zero, 1 \
                   with a length other than 1 (z counts as the least above zero where it is not above it); texbake \
                   check says more";
    run.line(&format!("warning: {warning}"));
    let report = folder.json("r.json");
    assert_eq!(report["warnings"], json!([warning]));
    let counts = |layer: &str| {
        ["texels", "below_zero", "at_zero", "zero_vectors", "non_unit"].map(|key| report[layer][key].as_u64().unwrap())
    };
    assert_eq!((counts("base"), counts("detail")), ([6, 0, 0, 0, 0], [6, 2, 1, 1, 1]));
}

#[test]
fn a_float_that_is_no_direction_names_its_file() {
    let folder = Folder::new();
    let floats = |name: &str, z: f32| {
        let format = NormalFormat { encoding: Encoding::Float, depth: Depth::Float32, ..FORMAT };
        let codes = Codes::F32(vec![0.0, 0.0, 1.0, 0.0, 0.0, z]);
        NormalMap::new(Size::new(1, 2).unwrap(), format, codes).unwrap().write(folder.path(name)).unwrap();
    };
    floats("good.exr", 1.0);
    floats("bad.exr", f32::NAN);
    for inputs in [["good.exr", "bad.exr"], ["bad.exr", "good.exr"]] {
        let run = folder.run(&[&["blend"], &inputs[..], &["-o", "n.png"]].concat()).ends(1);
        assert_eq!(
            run.stderr,
            "error: bad.exr: the normal at column 0, row 1 has a component of NaN: components must be between -65536 \
             and 65536; texbake check --repair -o FILE makes such texels flat\n"
        );
    }
    assert_eq!(folder.files("."), ["bad.exr", "good.exr"]);
}

#[test]
fn mistakes_are_refused_with_the_way_out() {
    let folder = Folder::new();
    base(&folder, "a.png", 6, 4);
    base(&folder, "b.png", 6, 4);
    base(&folder, "wide.png", 7, 4);
    folder.grey8("mask.png", 6, 4, bumps8);
    folder.grey8("height.png", 7, 4, bumps8);
    folder.file("text.png", "this is text");
    let before = folder.files(".");
    let cases: [(i32, &[&str], &str); 21] = [
        (
            1,
            &["a.png", "wide.png"],
            "wide.png: it is 7 x 4, and a.png is 6 x 4; give a map of the same size, or repeat a smaller one over the \
             first with --tile",
        ),
        (
            1,
            &["a.png", "b.png", "--mask", "height.png"],
            "height.png: it is 7 x 4, and a.png is 6 x 4; give a mask of the same size",
        ),
        (
            1,
            &["a.png", "height.png"],
            "height.png: it has one channel: a height map?; give a normal map, or bake one from the heights with \
             texbake normal",
        ),
        (1, &["gone.png", "b.png"], "gone.png: No such file"),
        (1, &["a.png", "gone.png"], "gone.png: No such file"),
        (1, &["a.png", "b.png", "--mask", "gone.png"], "gone.png: No such file"),
        (1, &["a.png", "text.png"], "text.png: this is no format that texbake knows; texbake reads PNG"),
        (
            1,
            &["a.png", "b.png", "--base-encoding", "float"],
            "base-encoding is float, for a.png: it must be unorm or biased",
        ),
        (2, &["a.png", "b.png", "--weights", "65536,1"], "--weights is 65536: it must be between -65535 and 65535"),
        (2, &["a.png", "b.png", "--weights", "1"], "it must be two numbers, as 1,-0.5 or 1/3,2/3"),
        (2, &["a.png", "b.png", "--transition", "1.5"], "--transition is 1.5: it must be between 0 and 1"),
        (2, &["a.png", "b.png", "--transition", "-0.1"], "--transition is -0.1: it must be between 0 and 1"),
        (
            2,
            &["a.png", "b.png", "--mask", "mask.png", "--method", "linear"],
            "--mask is mask.png: it must be left out with --method linear, which has no weights (see --method weighted)",
        ),
        (
            2,
            &["a.png", "b.png", "--weights", "1,2", "--method", "rnm"],
            "--weights is 1,2: it must be left out with --method rnm, which has no weights (see --method weighted)",
        ),
        (
            2,
            &["a.png", "b.png", "--weights", "1,2", "--method", "add"],
            "--weights is 1,2: it must be left out with --method add, whose weights are 1,1 (see --method weighted)",
        ),
        (
            2,
            &["a.png", "b.png", "--transition", "1/2", "--method", "add"],
            "--transition is 0.5: it must be left out with --method add, whose weights are 1,1 (see --method weighted)",
        ),
        (
            2,
            &["a.png", "b.png", "--method", "weighted"],
            "--weights is missing: it must be given with --method weighted, or else --transition or --mask",
        ),
        (2, &["a.png", "b.png", "--weights", "1,2", "--transition", "1/2"], "cannot be used with"),
        (2, &["a.png", "b.png", "--transition", "1/2", "--mask", "mask.png"], "cannot be used with"),
        (2, &["a.png", "b.png", "--mask-channel", "g"], "--mask <FILE>"),
        (2, &["a.png", "b.png", "--bits", "32f", "--encoding", "snorm"], "--bits is 32f: it must be 8 or 16"),
    ];
    for (status, arguments, message) in cases {
        let run = folder.run(&[&["blend", "-o", "out/n.png"], arguments].concat()).ends(status);
        assert!(run.stderr.contains(message), "{arguments:?}: {message:?} is not in {}", run.stderr);
        let run = run.stderr.lines().next().unwrap().to_owned();
        assert!(run.starts_with("error: "), "{run}");
    }
    let run = folder.run(&["blend", "a.png", "b.png", "-o", "n.jpg"]).ends(1);
    run.says("error: n.jpg: the extension .jpg is unknown", &["texbake writes .png"]);
    assert_eq!(folder.files("."), before);
}

#[test]
fn an_input_is_never_overwritten() {
    let folder = Folder::new();
    base(&folder, "a.png", 3, 3);
    base(&folder, "b.png", 3, 3);
    folder.grey8("mask.png", 3, 3, bumps8);
    let before = ["a.png", "b.png", "mask.png"].map(|name| std::fs::read(folder.path(name)).unwrap());
    for output in ["a.png", "./b.png", "mask.png"] {
        let run = folder.run(&["blend", "a.png", "b.png", "--mask", "mask.png", "-o", output]).ends(1);
        let name = output.trim_start_matches("./");
        run.says(&format!("error: {name}: the output of a.png would overwrite this input"), &["choose another output"]);
    }
    for (report, kind) in [("b.png", "input"), ("mask.png", "input"), ("n.png", "output")] {
        let arguments = ["blend", "a.png", "b.png", "--mask", "mask.png", "-o", "n.png", "--report", report];
        folder.run(&arguments).ends(1).says(&format!("the report would overwrite the {kind} {report}"), &["report"]);
    }
    assert_eq!(["a.png", "b.png", "mask.png"].map(|name| std::fs::read(folder.path(name)).unwrap()), before);
    assert_eq!(folder.files("."), ["a.png", "b.png", "mask.png"]);
}
