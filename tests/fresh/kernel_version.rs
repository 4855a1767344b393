//! Every byte that a bake writes belongs to the version of the kernels: who changes one, raises it.

use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;
use texbake::batch::{Job, KERNEL_VERSION, run};
use texbake::io::{BlockCompression, Compression, RawLayout, ReadOptions, WriteOptions};
use texbake::stream::Monitor;
use texbake::{
    BakeOptions, Baker, Channels, Convention, Depth, Edges, Encoding, Filter, Maps, NormalFormat, ParallaxFormat,
    RoughnessFormat, RoughnessMethod, RoughnessOptions, Scale,
};

/// The version that the table below is of.
const VERSION: u32 = 1;

/// The BLAKE3 hash of each output.
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

const WIDTH: usize = 37;
const HEIGHT: usize = 23;

/// Bumps of 16 bits: each bit of a height is used.
fn height(index: usize) -> u16 {
    let (x, y) = (index % WIDTH, index / WIDTH);
    (x * x * 211 + y * 7919 + x * y * 13) as u16
}

/// A height map without a header, and its layout.
fn input(folder: &Path, kind: &str) -> (std::path::PathBuf, RawLayout) {
    let heights = (0..WIDTH * HEIGHT).map(height);
    let bytes: Vec<u8> = match kind {
        "u8" => heights.map(|height| (height >> 8) as u8).collect(),
        "u16le" => heights.flat_map(u16::to_le_bytes).collect(),
        _ => heights.flat_map(|height| (f32::from(height) / 65536.0).to_le_bytes()).collect(),
    };
    let path = folder.join(format!("{kind}.raw"));
    std::fs::write(&path, bytes).unwrap();
    (path, format!("{WIDTH}x{HEIGHT}:{kind}").parse().unwrap())
}

/// A bake, and the files of its maps.
struct Case {
    extension: &'static str,
    options: BakeOptions,
    write: WriteOptions,
}

/// Slopes and the formats of the maps and files: each at least once.
fn cases() -> Vec<Case> {
    let normal = |encoding, depth, channels, convention| NormalFormat { encoding, depth, channels, convention };
    let parallax = |encoding, depth| ParallaxFormat { encoding, depth };
    let options = |scale: &str, filter: Filter, edges: &str, normal, parallax| BakeOptions {
        scale: Scale::texels(scale.parse::<texbake::Rational>().unwrap()),
        filter,
        edges: edges.parse::<Edges>().unwrap(),
        normal: Some(normal),
        parallax: Some(parallax),
        ..BakeOptions::default()
    };
    use Channels::{Xy, Xyz};
    use Convention::{Dx, Gl};
    use Depth::{Bits8, Bits16, Float16, Float32};
    use Encoding::{Biased, Float, Snorm, Unorm};
    let plain = |extension, options| Case { extension, options, write: WriteOptions::default() };
    let packed = |compression| Case {
        write: WriteOptions { compression, ..WriteOptions::default() },
        ..plain("png", options("24", Filter::Central, "wrap", normal(Unorm, Bits8, Xyz, Gl), parallax(Biased, Bits8)))
    };
    let rough = |method, depth| {
        Some(RoughnessOptions { method, base: "0.25".parse().unwrap(), format: RoughnessFormat { depth } })
    };
    let mips = |extension, blocks, options, roughness| Case {
        extension,
        options: BakeOptions { roughness, ..options },
        write: WriteOptions { mips: true, blocks, ..WriteOptions::default() },
    };
    let bytes = |filter, edges| options("24", filter, edges, normal(Unorm, Bits8, Xyz, Gl), parallax(Snorm, Bits8));
    let words = options("7/3", Filter::Scharr, "mirror", normal(Snorm, Bits16, Xy, Dx), parallax(Unorm, Bits16));
    let floats = options("3", Filter::Central, "wrap", normal(Float, Float16, Xyz, Gl), parallax(Float, Float32));
    vec![
        plain("png", options("24", Filter::Central, "wrap", normal(Unorm, Bits8, Xyz, Gl), parallax(Biased, Bits8))),
        plain("png", options("7/3", Filter::Sobel, "clamp", normal(Biased, Bits16, Xy, Dx), parallax(Unorm, Bits16))),
        plain("tif", options("-0.35", Filter::Scharr, "mirror", normal(Snorm, Bits8, Xyz, Gl), parallax(Snorm, Bits8))),
        plain(
            "tif",
            options("100", Filter::Prewitt, "wrap,clamp", normal(Unorm, Bits16, Xy, Gl), parallax(Snorm, Bits16)),
        ),
        plain("tif", options("3", Filter::Central, "wrap", normal(Float, Float32, Xyz, Dx), parallax(Float, Float32))),
        plain("exr", options("24", Filter::Sobel, "wrap", normal(Float, Float32, Xyz, Gl), parallax(Float, Float32))),
        plain("exr", options("24", Filter::Central, "clamp", normal(Float, Float16, Xy, Gl), parallax(Float, Float16))),
        packed(Compression::Balanced),
        packed(Compression::Small),
        mips("ktx2", None, bytes(Filter::Central, "wrap"), rough(RoughnessMethod::Lean, Bits8)),
        mips("dds", None, words, rough(RoughnessMethod::Toksvig, Bits16)),
        mips("ktx2", None, floats, None),
        mips("dds", Some(BlockCompression::Bc5), bytes(Filter::Sobel, "clamp"), rough(RoughnessMethod::Lean, Bits8)),
        mips("ktx2", Some(BlockCompression::Bc7), bytes(Filter::Central, "wrap,clamp"), None),
    ]
}

/// The bytes of a file that count: all, but of a KTX2 file those that name this version of texbake, and the places of what
/// stands behind them.
fn counted(path: &Path) -> Vec<u8> {
    let bytes = std::fs::read(path).unwrap();
    if path.extension().unwrap() != "ktx2" {
        return bytes;
    }
    let levels: Vec<Vec<u8>> = ktx2::Reader::new(&bytes).unwrap().levels().map(|level| level.data.to_vec()).collect();
    // From the format to the supercompression, and the data format descriptor (KTX 2.0, section 3).
    let at = |word: usize| u32::from_le_bytes(bytes[word..word + 4].try_into().unwrap()) as usize;
    let descriptor = &bytes[at(48)..at(48) + at(52)];
    [&bytes[12..48], descriptor, &levels.concat()].concat()
}

#[test]
fn a_changed_byte_is_a_new_version() {
    let folder = TempDir::new().unwrap();
    let mut jobs = Vec::new();
    let baker = Arc::new(Baker::cpu());
    for kind in ["u8", "u16le", "f32le"] {
        let (input, raw) = input(folder.path(), kind);
        for (number, Case { extension, options, write }) in cases().into_iter().enumerate() {
            let output = |map: &str| Some(folder.path().join(format!("{kind}_{number}_{map}.{extension}")));
            let roughness = options.roughness.and_then(|_| output("roughness"));
            jobs.push(Job {
                input: input.clone(),
                outputs: Maps { normal: output("normal"), parallax: output("parallax"), roughness },
                normals: None,
                neighbours: None,
                read: ReadOptions { raw: Some(raw), ..ReadOptions::default() },
                options,
                write,
                baker: baker.clone(),
            });
        }
    }
    for outcome in run(&jobs, 2, &Monitor::default(), &|_| ()) {
        outcome.result.unwrap();
    }
    let outputs = jobs.iter().flat_map(|job| job.outputs.iter());
    let found: Vec<(String, String)> = outputs
        .map(|path| {
            let hash = blake3::hash(&counted(path)).to_hex();
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
