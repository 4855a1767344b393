//! `texbake normal`: one file.

use super::support::{Folder, bumps8, bumps16, flat, read_png};
use texbake::{
    Channels, CodesRef, Convention, Depth, Edge, Edges, Encoding, Filter, NormalFormat, NormalOptions, Precision, Scale,
};

#[test]
fn a_map_is_baked_with_the_defaults() {
    let folder = Folder::new();
    let map = folder.grey16("height.png", 37, 23, bumps16);
    let run = folder.run(&["normal", "height.png", "-o", "normal.png"]).ends(0);
    folder.assert_baked("normal.png", &map, &NormalOptions::default());
    assert_eq!(run.stdout, "");
    let line = run.line("normal.png: 37 x 23, u16 to unorm 8 xyz gl, scale 1 (nearly flat: see --scale), exact; ");
    assert!(line.contains(" Mtexel/s") && line.contains(" in, "), "{line}");
    assert_eq!(run.stderr.lines().count(), 1);
}

#[test]
fn every_option_reaches_the_bake() {
    let folder = Folder::new();
    let map = folder.grey8("height.png", 19, 21, bumps8);
    let format = |encoding, depth, channels, convention| NormalFormat { encoding, depth, channels, convention };
    let usual = NormalFormat::default();
    let base = NormalOptions::default();
    let half: texbake::Rational = "1/2".parse().unwrap();
    let physical = Scale::physical(2.into(), 1.into(), half);
    let cases: [(&[&str], NormalOptions); 11] = [
        (&["--scale", "24"], NormalOptions { scale: Scale::texels(24), ..base }),
        (
            &["--scale", "-7/3"],
            NormalOptions { scale: Scale::texels("-7/3".parse::<texbake::Rational>().unwrap()), ..base },
        ),
        (&["--size", "2x1.0", "--depth", "0.5"], NormalOptions { scale: physical, ..base }),
        (
            &["--scale=9", "--filter", "scharr"],
            NormalOptions { scale: Scale::texels(9), filter: Filter::Scharr, ..base },
        ),
        (&["--edge", "clamp"], NormalOptions { edges: Edges::both(Edge::Clamp), ..base }),
        (&["--edge", "mirror,clamp"], NormalOptions { edges: Edges { x: Edge::Mirror, y: Edge::Clamp }, ..base }),
        (
            &["--encoding", "biased"],
            NormalOptions { format: format(Encoding::Biased, Depth::Bits8, Channels::Xyz, Convention::Gl), ..base },
        ),
        (
            &["--bits", "16"],
            NormalOptions { format: format(Encoding::Unorm, Depth::Bits16, Channels::Xyz, Convention::Gl), ..base },
        ),
        (
            &["--convention", "dx"],
            NormalOptions { format: NormalFormat { convention: Convention::Dx, ..usual }, ..base },
        ),
        (&["--backend", "reference"], base),
        (&["--backend", "cpu", "--precision", "exact"], NormalOptions { precision: Precision::Exact, ..base }),
    ];
    for (arguments, options) in cases {
        let all = [&["normal", "height.png", "-o", "n/ormal.png", "--quiet"], arguments].concat();
        let run = folder.run(&all).ends(0);
        assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""), "{arguments:?}");
        folder.assert_baked("n/ormal.png", &map, &options);
    }
}

#[test]
fn raw_heights_and_chosen_channels_are_read() {
    let folder = Folder::new();
    folder.file("flat.raw", [7]);
    folder.run(&["normal", "flat.raw", "--raw", "1x1:u8", "-o", "flat.png"]).ends(0);
    assert_eq!(read_png(&folder.path("flat.png")).2.as_ref(), flat());

    let green = folder.grey8("green.png", 5, 4, bumps8);
    let texbake::Heights::U8(codes) = green.heights() else { unreachable!("it is an 8-bit map") };
    let samples: Vec<u8> = codes.iter().flat_map(|&code| [3, code, 200]).collect();
    folder.file("rgb.png", super::support::png(5, 4, png::ColorType::Rgb, png::BitDepth::Eight, &samples));
    folder.run(&["normal", "rgb.png", "--channel", "g", "-o", "normal.png"]).ends(0);
    folder.assert_baked("normal.png", &green, &NormalOptions::default());
}

#[test]
fn a_scale_of_many_digits_gives_a_warning() {
    let folder = Folder::new();
    folder.grey8("height.png", 3, 3, bumps8);
    let run = folder.run(&["normal", "height.png", "-o", "normal.png", "--scale", "3.14159265358979"]).ends(0);
    run.says("warning: height.png", &["too many digits", "5419351/1725033"]);
    let quiet = folder.run(&["normal", "height.png", "-o", "n.png", "--scale", "3.14159265358979", "-q"]).ends(0);
    assert_eq!(quiet.stderr, "");
}

#[test]
fn an_input_is_never_overwritten() {
    let folder = Folder::new();
    folder.grey8("height.png", 3, 3, bumps8);
    let before = std::fs::read(folder.path("height.png")).unwrap();
    std::fs::hard_link(folder.path("height.png"), folder.path("hard.png")).unwrap();
    let mut targets = vec!["height.png", "./height.png", "sub/../height.png"];
    std::fs::create_dir(folder.path("sub")).unwrap();
    if cfg!(unix) {
        targets.push("hard.png");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.path("height.png"), folder.path("soft.png")).unwrap();
        targets.push("soft.png");
    }
    for target in targets {
        let run = folder.run(&["normal", "height.png", "-o", target]).ends(1);
        run.says("error: height.png", &["would overwrite this input", "choose another output"]);
    }
    let run = folder.run(&["normal", "height.png", "-o", "n.png", "--report", "height.png"]).ends(1);
    run.says("error: height.png", &["the report would overwrite the input"]);
    assert_eq!(std::fs::read(folder.path("height.png")).unwrap(), before);
    assert!(!folder.path("n.png").exists());
}

#[test]
fn elevation_in_metres_has_the_depth_of_all_codes() {
    use tiff::encoder::{TiffEncoder, colortype::GrayI16};
    let folder = Folder::new();
    let file = std::fs::File::create(folder.path("dem.tif")).unwrap();
    TiffEncoder::new(file).unwrap().write_image::<GrayI16>(4, 1, &[-2, -1, 0, 1]).unwrap();
    // Texels of one metre, each a metre above the one before: the slope is 1.
    let metres = ["--size", "4x1", "--depth", "65535", "--edge", "clamp", "-q"];
    folder.run(&[&["normal", "dem.tif", "-o", "n.png"], &metres[..]].concat()).ends(0);
    let (_, _, codes) = read_png(&folder.path("n.png"));
    let CodesRef::U8(codes) = codes.as_ref() else { unreachable!("it is an 8-bit map") };
    // 127.5 (1 - 1 / sqrt(2)) and 127.5 (1 + 1 / sqrt(2)), rounded.
    assert_eq!(codes[3..9], [37, 128, 218, 37, 128, 218]);
}
