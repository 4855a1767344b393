//! Every byte that a bake writes belongs to the version of the kernels: who changes one, raises it.

use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use texbake::batch::{Job, KERNEL_VERSION, TileFolders, TileTemplate, run};
use texbake::io::{BlockCompression, ColorSpace, Compression, RawLayout, ReadOptions, WriteOptions};
use texbake::stream::Monitor;
use texbake::{
    BakeOptions, Baker, Channels, Convention, Depth, Edges, Encoding, Filter, Maps, NormalFormat, ParallaxFormat,
    Precision, RoughnessFormat, RoughnessMethod, RoughnessOptions, Scale,
};

/// The version that the table below is of.
const VERSION: u32 = 1;

/// The BLAKE3 hash of each output, as a whole file.
const TABLE: &[(&str, &str)] = &[
    ("u8_0_normal.png", "e672d5ecbc92f0a84a542eb9a85cf1b0"),
    ("u8_0_parallax.png", "53cb97361954e3662ffd7563289d4d27"),
    ("u8_1_normal.png", "27ae1f740cf86f043dd80227ae9d914e"),
    ("u8_1_parallax.png", "3f2ad90d42408da42a77c975591c77a9"),
    ("u8_2_normal.tif", "3f5c5dd882f4185eec41d8e7238caf44"),
    ("u8_2_parallax.tif", "107e59a5df8d70de97ae177005adf94a"),
    ("u8_3_normal.tif", "a8f6aefa35fcefb6f35fe8f332d889a8"),
    ("u8_3_parallax.tif", "4e0d89d7863f42db9332e51d30d4b789"),
    ("u8_4_normal.tif", "940a2ccd18abb14714e6e8713ccfa2f3"),
    ("u8_4_parallax.tif", "83f9a4f5ae940eb1d73892abeb85e04c"),
    ("u8_5_normal.exr", "e03b5ac43b2dcf8f412d3118a4acc0ae"),
    ("u8_5_parallax.exr", "4617833aaf756661f8cc857fb91923cf"),
    ("u8_6_normal.exr", "5faff663eaf7f7fdab1421f673cd4ef0"),
    ("u8_6_parallax.exr", "5dbded9d7c0d90eb945b4bd8dd7e8786"),
    ("u16le_0_normal.png", "6d2ef8abcb086d83970403eb16587a97"),
    ("u16le_0_parallax.png", "4bfadb10d37c552c6acd36724430a5be"),
    ("u16le_1_normal.png", "ab503e07044aa9263fcece5146ba111e"),
    ("u16le_1_parallax.png", "7e687313bb007e472a46060fdd5ee3dd"),
    ("u16le_2_normal.tif", "83a0f3c95da7f489c62e9695faf14c4a"),
    ("u16le_2_parallax.tif", "230404d9faa7d797622cb781dece5dbd"),
    ("u16le_3_normal.tif", "c8186b39e8ed66a03f24c370040e4d86"),
    ("u16le_3_parallax.tif", "626d7da13e366a2a5bffbf733887302b"),
    ("u16le_4_normal.tif", "3618aab89d1654b63927bc25cd3c487a"),
    ("u16le_4_parallax.tif", "528c138dbc127cd65df6c417bd56c850"),
    ("u16le_5_normal.exr", "c0fd68d4287787b165d557274effa58f"),
    ("u16le_5_parallax.exr", "dd6d77c60b791ee34645b63ab8f2d108"),
    ("u16le_6_normal.exr", "64a72a13f8353600e2a474e131338f4e"),
    ("u16le_6_parallax.exr", "26f2aeb98c5784dd40d90ab303aad10f"),
    ("f32le_0_normal.png", "6d2ef8abcb086d83970403eb16587a97"),
    ("f32le_0_parallax.png", "4bfadb10d37c552c6acd36724430a5be"),
    ("f32le_1_normal.png", "ffb71a4bcd0f1a63464ed3ff0effe47c"),
    ("f32le_1_parallax.png", "081524906f7436dcd474ddf14784e441"),
    ("f32le_2_normal.tif", "83a0f3c95da7f489c62e9695faf14c4a"),
    ("f32le_2_parallax.tif", "0a5fdae234316985236a30342685f0dc"),
    ("f32le_3_normal.tif", "fab8bc11b08a623db8e23ed6f99c9284"),
    ("f32le_3_parallax.tif", "b6d0a18c7e5ad1ffe2d5afd6d376fb69"),
    ("f32le_4_normal.tif", "f53252bf34b1e522965e7293e87ab996"),
    ("f32le_4_parallax.tif", "e8a2ae3984b4e8270d0afa09432329e2"),
    ("f32le_5_normal.exr", "e94a666083f5c7f0fb87a6f013f85450"),
    ("f32le_5_parallax.exr", "7486b487835b133d4c8dcc92cfc95fe3"),
    ("f32le_6_normal.exr", "5877393c06ac7fdd78e2b02c2d1f07f8"),
    ("f32le_6_parallax.exr", "45336425005287c1cd53d05f4f60d9f2"),
];

/// Sides without a factor in common, and those that can be reduced.
const ODD: [usize; 2] = [37, 23];
const EVEN: [usize; 2] = [36, 24];

/// Bumps of 16 bits: each bit of a height is used.
fn height(width: usize, index: usize) -> u16 {
    let (x, y) = (index % width, index / width);
    (x * x * 211 + y * 7919 + x * y * 13) as u16
}

/// What the heights are stored as.
const KINDS: [&str; 3] = ["u8", "u16le", "f32le"];

/// The tile to the right of each map, if anybody asks.
fn tiles() -> TileTemplate {
    "{x}_{y}.raw".parse().unwrap()
}

/// A height map without a header and the tile beside it, and their layout.
fn input(folder: &Path, kind: &str, [width, height]: [usize; 2]) -> (PathBuf, RawLayout) {
    let layout = format!("{width}x{height}:{kind}");
    let folder = folder.join(layout.replace(':', "_"));
    std::fs::create_dir_all(&folder).unwrap();
    for tile in 0..2 {
        let heights = (0..width * height).map(|index| self::height(width, index + 1000 * tile));
        let bytes: Vec<u8> = match kind {
            "u8" => heights.map(|height| (height >> 8) as u8).collect(),
            "u16le" => heights.flat_map(u16::to_le_bytes).collect(),
            _ => heights.flat_map(|height| (f32::from(height) / 65536.0).to_le_bytes()).collect(),
        };
        std::fs::write(folder.join(format!("{tile}_0.raw")), bytes).unwrap();
    }
    (folder.join("0_0.raw"), layout.parse().unwrap())
}

/// A bake and the format of its files.
struct Case {
    extension: &'static str,
    kinds: &'static [&'static str],
    size: [usize; 2],
    read: ReadOptions,
    options: BakeOptions,
    write: WriteOptions,
    has_neighbours: bool,
}

/// Slopes, formats of maps and files, and ways to get there: each at least once.
fn cases() -> Vec<Case> {
    use BlockCompression::{Bc5, Bc7};
    use Channels::{Xy, Xyz};
    use Convention::{Dx, Gl};
    use Depth::{Bits8, Bits16, Float16, Float32};
    use Encoding::{Biased, Float, Snorm, Unorm};
    let normal = |encoding, depth, channels, convention| NormalFormat { encoding, depth, channels, convention };
    let parallax = |encoding, depth| ParallaxFormat { encoding, depth };
    let case = |extension, scale: &str, filter: Filter, edges: &str, normal, parallax| Case {
        extension,
        kinds: &KINDS,
        size: ODD,
        read: ReadOptions::default(),
        options: BakeOptions {
            scale: Scale::texels(scale.parse::<texbake::Rational>().unwrap()),
            filter,
            edges: edges.parse::<Edges>().unwrap(),
            normal: Some(normal),
            parallax: Some(parallax),
            ..BakeOptions::default()
        },
        write: WriteOptions::default(),
        has_neighbours: false,
    };
    let plain =
        |extension, parallax| case(extension, "24", Filter::Central, "wrap", normal(Unorm, Bits8, Xyz, Gl), parallax);
    let png = || plain("png", parallax(Biased, Bits8));
    let packed = |compression| Case { write: WriteOptions { compression, ..WriteOptions::default() }, ..png() };
    let texture = |mips, blocks, case: Case| Case { write: WriteOptions { mips, blocks, ..case.write }, ..case };
    let rough = |method, depth, case: Case| {
        let roughness = RoughnessOptions { method, base: "1/4".parse().unwrap(), format: RoughnessFormat { depth } };
        Case { options: BakeOptions { roughness: Some(roughness), ..case.options }, ..case }
    };
    let fast = |case: Case| Case { options: BakeOptions { precision: Precision::Fast, ..case.options }, ..case };
    let words = |extension, filter| {
        case(extension, "7/3", filter, "mirror", normal(Unorm, Bits16, Xy, Dx), parallax(Unorm, Bits16))
    };
    let floats = |extension| {
        case(extension, "3", Filter::Central, "wrap", normal(Float, Float16, Xyz, Gl), parallax(Float, Float32))
    };
    let reduced = ReadOptions { shrink: NonZeroU32::new(2).unwrap(), ..ReadOptions::default() };
    let colours = ReadOptions { color_space: ColorSpace::Srgb, ..ReadOptions::default() };
    let tile = |filter, edges| Case {
        has_neighbours: true,
        ..case("png", "24", filter, edges, normal(Unorm, Bits8, Xyz, Gl), parallax(Biased, Bits8))
    };
    vec![
        png(),
        case("png", "7/3", Filter::Sobel, "clamp", normal(Biased, Bits16, Xy, Dx), parallax(Unorm, Bits16)),
        case("tif", "-0.35", Filter::Scharr, "mirror", normal(Snorm, Bits8, Xyz, Gl), parallax(Snorm, Bits8)),
        case("tif", "100", Filter::Prewitt, "wrap,clamp", normal(Unorm, Bits16, Xy, Gl), parallax(Snorm, Bits16)),
        case("tif", "3", Filter::Central, "wrap", normal(Float, Float32, Xyz, Dx), parallax(Float, Float32)),
        case("exr", "24", Filter::Sobel, "wrap", normal(Float, Float32, Xyz, Gl), parallax(Float, Float32)),
        case("exr", "24", Filter::Central, "clamp", normal(Float, Float16, Xy, Gl), parallax(Float, Float16)),
        packed(Compression::Balanced),
        packed(Compression::Small),
        plain("ktx2", parallax(Snorm, Bits8)),
        words("dds", Filter::Scharr),
        floats("ktx2"),
        texture(true, None, floats("dds")),
        rough(RoughnessMethod::Lean, Bits8, texture(true, None, plain("ktx2", parallax(Snorm, Bits8)))),
        rough(RoughnessMethod::Toksvig, Bits16, texture(true, None, words("dds", Filter::Sobel))),
        texture(false, Some(Bc5), plain("dds", parallax(Snorm, Bits8))),
        texture(true, Some(Bc5), plain("ktx2", parallax(Unorm, Bits8))),
        rough(RoughnessMethod::Lean, Bits8, texture(true, Some(Bc7), plain("dds", parallax(Unorm, Bits8)))),
        texture(false, Some(Bc7), plain("ktx2", parallax(Unorm, Bits8))),
        fast(words("png", Filter::Central)),
        fast(floats("exr")),
        Case { size: EVEN, read: reduced, ..png() },
        Case { kinds: &["u8", "u16le"], read: colours, ..words("png", Filter::Central) },
        tile(Filter::Central, "clamp"),
        tile(Filter::Sobel, "wrap,mirror"),
    ]
}

#[test]
fn a_changed_byte_is_a_new_version() {
    let folder = TempDir::new().unwrap();
    let mut jobs = Vec::new();
    let baker = Arc::new(Baker::cpu());
    for kind in KINDS {
        let cases = cases().into_iter().enumerate().filter(|(_, case)| case.kinds.contains(&kind));
        for (number, Case { extension, size, read, options, write, has_neighbours, .. }) in cases {
            let (input, raw) = input(folder.path(), kind, size);
            let output = |map: &str| Some(folder.path().join(format!("{kind}_{number}_{map}.{extension}")));
            let around = || TileFolders::default().around(&input, &tiles(), 0, &options).unwrap();
            jobs.push(Job {
                outputs: Maps {
                    normal: output("normal"),
                    parallax: output("parallax"),
                    roughness: options.roughness.and_then(|_| output("roughness")),
                },
                normals: None,
                neighbours: has_neighbours.then(around),
                read: ReadOptions { raw: Some(raw), ..read },
                input,
                options,
                write,
                baker: baker.clone(),
            });
        }
    }
    for (job, outcome) in jobs.iter().zip(run(&jobs, 2, &Monitor::default(), &|_| ())) {
        outcome.result.unwrap_or_else(|error| panic!("{:?}: {error}", job.outputs));
    }
    let outputs = jobs.iter().flat_map(|job| job.outputs.iter());
    let found: Vec<(String, String)> = outputs
        .map(|path| {
            let hash = blake3::hash(&std::fs::read(path).unwrap()).to_hex();
            (path.file_name().unwrap().to_str().unwrap().to_owned(), hash[..32].to_owned())
        })
        .collect();
    let is_same = found.iter().map(|(name, hash)| (name.as_str(), hash.as_str())).eq(TABLE.iter().copied());
    if !is_same || KERNEL_VERSION != VERSION {
        let lines = found.iter().map(|(name, hash)| format!("    (\"{name}\", \"{hash}\"),\n")).collect::<String>();
        panic!(
            "bakes write other bytes than those of version {VERSION}: maps that users have would count as fresh. Raise \
             KERNEL_VERSION in src/batch/fresh/kernel_version.rs, now {KERNEL_VERSION}, by one if this version was \
             released, set VERSION here to it, and put this table here:\n{lines}"
        );
    }
}
