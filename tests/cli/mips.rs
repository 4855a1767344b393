//! `--mips` and roughness maps by the command line and `texbake.toml`: the levels in the files are those of the oracle.

use super::support::{Folder, bumps8, bumps16};
use crate::oracle::{integer_levels, integer_parallax_levels};
use crate::support::{Format, Image, UNORM8, options};
use texbake::{
    BakeOptions, Baker, Depth, Encoding, HeightMap, ParallaxFormat, ParallaxOptions, RoughnessFormat, RoughnessMethod,
    RoughnessOptions,
};

/// The bytes of each level of a file, the largest first, by the format's own crate.
fn levels(folder: &Folder, name: &str) -> Vec<Vec<u8>> {
    let bytes = std::fs::read(folder.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    if name.ends_with(".ktx2") {
        let reader = ktx2::Reader::new(bytes).unwrap();
        return reader.levels().map(|level| level.data.to_vec()).collect();
    }
    let dds = ddsfile::Dds::read(bytes.as_slice()).unwrap();
    let [width, height] = [dds.get_width(), dds.get_height()].map(|side| side as usize);
    let mut data = dds.get_data(0).unwrap();
    let texel_bytes = dds.get_bits_per_pixel().unwrap() as usize / 8;
    let sizes = (0..dds.get_num_mipmap_levels()).map(|level| (width >> level).max(1) * (height >> level).max(1));
    sizes.map(|texels| data.split_off(..texels * texel_bytes).unwrap().to_vec()).collect()
}

/// 8-bit codes of levels as texels; three components have an opaque alpha.
fn texels<F: Format>(levels: &[Image<F>], alpha: &[u8]) -> Vec<Vec<u8>> {
    let level = |level: &Image<F>| {
        let texel =
            |codes: &[u32]| codes.iter().map(|code| *code as u8).chain(alpha.iter().copied()).collect::<Vec<_>>();
        level.bits.chunks(level.format.channels().len()).flat_map(texel).collect()
    };
    levels.iter().map(level).collect()
}

fn normals(map: &HeightMap, scale: &str) -> Vec<Vec<u8>> {
    texels(&integer_levels(map, &options(scale, UNORM8)), &[255])
}

fn parallax(map: &HeightMap, scale: &str) -> Vec<Vec<u8>> {
    let format = ParallaxFormat { encoding: Encoding::Snorm, depth: Depth::Bits8 };
    let texbake::NormalOptions { scale, filter, edges, precision, .. } = options(scale, UNORM8);
    texels(&integer_parallax_levels(map, &ParallaxOptions { scale, filter, edges, precision, format }), &[])
}

fn roughness(map: &HeightMap, scale: &str, roughness: RoughnessOptions) -> Vec<Vec<u8>> {
    let options = BakeOptions { roughness: Some(roughness), ..options(scale, UNORM8).into() };
    let levels = Baker::reference().bake_levels(map, &options).unwrap().roughness.unwrap();
    levels.iter().map(|level| level.codes().bytes().to_vec()).collect()
}

#[test]
fn normal_and_parallax_write_every_level() {
    let folder = Folder::new();
    let map = folder.grey16("h.png", 45, 22, bumps16);
    let smooth = RoughnessOptions::default();
    for extension in ["ktx2", "dds"] {
        let [n, r, p] = ["n", "r", "p"].map(|name| format!("{name}.{extension}"));
        let scale = ["--scale", "24", "--backend", "cpu"];
        folder.run(&[&["normal", "h.png", "-o", &n, "--mips", "--roughness", &r], &scale[..]].concat()).ends(0);
        assert_eq!(levels(&folder, &n), normals(&map, "24"), "{n}");
        assert_eq!(levels(&folder, &r), roughness(&map, "24", smooth), "{r}");
        folder.run(&[&["parallax", "h.png", "-o", &p, "--mips"], &scale[..]].concat()).ends(0);
        assert_eq!(levels(&folder, &p), parallax(&map, "24"), "{p}");
        folder.run(&[&["normal", "h.png", "-o", &n, "--mips=false"], &scale[..]].concat()).ends(0);
        assert_eq!(levels(&folder, &n), normals(&map, "24")[..1], "{n}");
    }
}

#[test]
fn roughness_options_decide_over_the_map() {
    let folder = Folder::new();
    let map = folder.grey8("h.png", 20, 31, bumps8);
    let bake = |more: &[&str]| {
        let command = ["normal", "h.png", "-o", "n.dds", "--mips", "--roughness", "r.dds", "--scale", "3"];
        folder.run(&[&command, more].concat()).ends(0);
        levels(&folder, "r.dds")
    };
    let toksvig =
        RoughnessOptions { method: RoughnessMethod::Toksvig, base: "0.3".parse().unwrap(), ..Default::default() };
    assert_eq!(bake(&["--roughness-method", "toksvig", "--base-roughness", "0.3"]), roughness(&map, "3", toksvig));
    let fine = RoughnessOptions { format: RoughnessFormat { depth: Depth::Bits16 }, ..Default::default() };
    assert_eq!(bake(&["--roughness-bits", "16"]), roughness(&map, "3", fine));
    assert!(roughness(&map, "3", toksvig)[2] != roughness(&map, "3", RoughnessOptions::default())[2]);
}

#[test]
fn settings_choose_levels_file_by_file() {
    let folder = Folder::new();
    let [a, b] = ["a", "b"].map(|name| folder.grey8(&format!("tex/{name}_height.png"), 17, 12, bumps8));
    folder.grey8("tex/c_height.png", 9, 9, bumps8);
    folder.file(
        "tex/texbake.toml",
        "[defaults]\nformat = 'ktx2'\nmips = true\nscale = 24\nmaps = ['normal', 'parallax', 'roughness']\n\
         [[override]]\nglob = 'b_*'\nscale = 3\nroughness-method = 'toksvig'\nbase-roughness = 0.5\n\
         [[override]]\nglob = 'c_*'\nformat = 'png'\nmips = false\nmaps = 'normal'\n",
    );
    folder.run(&["bake", "tex", "--out", "out", "--backend", "cpu", "--report", "r.json"]).ends(0);
    let files = ["a_normal.ktx2", "a_parallax.ktx2", "a_roughness.ktx2"].map(str::to_owned);
    let others = files.clone().map(|name| name.replacen('a', "b", 1));
    assert_eq!(folder.files("out"), [&files[..], &others, &["c_normal.png".to_owned()]].concat());
    let found = |name: &str| levels(&folder, &format!("out/{name}"));
    assert_eq!(found("a_normal.ktx2"), normals(&a, "24"));
    assert_eq!(found("a_parallax.ktx2"), parallax(&a, "24"));
    assert_eq!(found("a_roughness.ktx2"), roughness(&a, "24", RoughnessOptions::default()));
    assert_eq!(found("b_normal.ktx2"), normals(&b, "3"));
    let toksvig =
        RoughnessOptions { method: RoughnessMethod::Toksvig, base: "0.5".parse().unwrap(), ..Default::default() };
    assert_eq!(found("b_roughness.ktx2"), roughness(&b, "3", toksvig));
    let report = folder.json("r.json");
    let of = |index: usize, option: &str| report["files"][index]["options"][option].clone();
    assert_eq!(
        [of(0, "mips"), of(1, "roughness_method"), of(2, "mips")],
        [serde_json::Value::from(true), "toksvig".into(), false.into()]
    );

    // The command line is stronger, and a format without levels leaves those of the settings.
    folder.run(&["bake", "tex", "--out", "one", "--backend", "cpu", "--mips=false", "--maps", "normal"]).ends(0);
    assert_eq!(levels(&folder, "one/a_normal.ktx2"), normals(&a, "24")[..1]);
    folder.run(&["bake", "tex", "--out", "png", "--backend", "cpu", "--format", "png", "--maps", "normal"]).ends(0);
    assert_eq!(folder.files("png"), ["a_normal.png", "b_normal.png", "c_normal.png"]);
}

#[test]
fn what_has_no_levels_is_told_before_anything_is_baked() {
    let folder = Folder::new();
    folder.grey8("tex/h_height.png", 9, 9, bumps8);
    folder.grey8("tex/n.png", 9, 9, bumps8);
    let normal = |more: &[&'static str]| [&["normal", "tex/h_height.png", "-o"], more].concat();
    for (arguments, message) in [
        (
            normal(&["n.png", "--mips"]),
            "--mips is on, for n.png: it must be for .ktx2 and .dds: other files have one level",
        ),
        (
            normal(&["n.ktx2", "--roughness", "r.ktx2"]),
            "--mips is off, for r.ktx2: it must be on: roughness is what mip levels lose",
        ),
        (
            normal(&["n.ktx2", "--mips", "--roughness", "r.png"]),
            "--roughness is r.png: it must be a .ktx2 or .dds file, with mips: roughness is what mip levels lose",
        ),
        (
            normal(&["n.ktx2", "--mips", "--roughness", "r.ktx2", "--base-roughness", "1.5"]),
            "--base-roughness is 1.5: it must be from 0 to 1",
        ),
        (
            normal(&["n.ktx2", "--mips", "--roughness", "r.ktx2", "--roughness-bits", "32f"]),
            "invalid value '32f' for '--roughness-bits",
        ),
        (normal(&["n.ktx2", "--mips=perhaps"]), "invalid value 'perhaps' for '--mips"),
        (
            vec!["bake", "tex", "--out", "out", "--format", "dds", "--mips", "--maps", "roughness"],
            "--maps is roughness: it must be normal,roughness",
        ),
        (
            vec!["bake", "tex", "--out", "out", "--format", "dds", "--maps", "normal,roughness"],
            "--mips is off, for h_roughness.dds: it must be on",
        ),
        (
            vec!["bake", "tex", "--out", "out", "--maps", "normal,roughness"],
            "--maps is roughness too: it must be used with --format ktx2 or dds and with --mips: roughness is what mip",
        ),
        (
            normal(&["n.dds", "--base-roughness", "0.5"]),
            "--base-roughness is 0.5: it must be left out where there is no",
        ),
        (
            vec!["bake", "tex", "--out", "out", "--roughness-method", "lean"],
            "--roughness-method is lean: it must be left out where there is no roughness map",
        ),
    ] {
        let run = folder.run(&arguments).ends(2);
        assert!(run.stderr.contains(message), "{arguments:?}: {}", run.stderr);
    }
    assert_eq!(folder.files("."), ["tex/h_height.png", "tex/n.png"]);
}

#[test]
fn tiles_and_given_normals_have_no_levels() {
    let folder = Folder::new();
    let _ = ["t_0_0_height.png", "t_1_0_height.png"].map(|name| folder.grey8(&format!("tex/{name}"), 8, 8, bumps8));
    let told = "--mips is on: it must be left out where a map has neighbours";
    let mips = ["--mips", "--neighbours", "t_{x}_{y}_height.png", "--backend", "cpu"];
    let one = ["normal", "tex/t_0_0_height.png", "-o", "n.ktx2"];
    let all = ["bake", "tex", "--out", "out", "--format", "ktx2"];
    for (command, more) in [
        (&one[..], &[][..]),
        (&one, &["--roughness", "r.ktx2"]),
        (&all, &[]),
        (&all, &["--dry-run"]),
        (&all, &["--maps", "normal,roughness"]),
    ] {
        folder.run(&[command, more, &mips].concat()).ends(2).says("error: ", &[told]);
    }

    folder.run(&["normal", "tex/t_0_0_height.png", "-o", "given.png", "--backend", "cpu"]).ends(0);
    let given = ["parallax", "tex/t_0_0_height.png", "-o", "p.ktx2", "--mips", "--normal", "given.png"];
    let run = folder.run(&given).ends(1);
    assert!(run.stderr.contains("mips is on: it must be left out where a normal map is given"), "{}", run.stderr);
    let names = ["given.png", "tex/t_0_0_height.png", "tex/t_1_0_height.png"];
    assert_eq!(folder.files("."), names);
}
