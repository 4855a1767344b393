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
    ("u8_0_normal.png", "4ff93f50451c15d759fe4d938438bbc8"),
    ("u8_0_parallax.png", "f1722f1d462a69c0a1c6e665584d227d"),
    ("u8_1_normal.png", "764f3b1bb0dae1e53489f76c48fcab2d"),
    ("u8_1_parallax.png", "6d552c5b2ce8c56e449fbfe91dc36d44"),
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
    ("u8_7_normal.png", "4ff93f50451c15d759fe4d938438bbc8"),
    ("u8_7_parallax.png", "01c0394399ccfe228efa515d6bfeb6b0"),
    ("u8_8_normal.png", "6d67ed715691b538437ee6b174c06e98"),
    ("u8_8_parallax.png", "4c3a2e5b97f5a21aea0fbdabd6880c84"),
    ("u8_9_normal.ktx2", "0418e8d144246cab51e2db4dbd9e3306"),
    ("u8_9_parallax.ktx2", "33ead68e94bfaeffdbce191437500b64"),
    ("u8_10_normal.dds", "e125c205cffb9aa6d0d0b0f11601905f"),
    ("u8_10_parallax.dds", "c04d60962819a0bb22de183970139cf7"),
    ("u8_11_normal.ktx2", "e95912cdc42b90e8fb932216122909e2"),
    ("u8_11_parallax.ktx2", "eefae9ebb55f797c3dc71b3e6cdb92e8"),
    ("u8_12_normal.dds", "a5db87ca956e705f907bb0afc54d8946"),
    ("u8_12_parallax.dds", "843005acba1a3a7962b98b1b96d1d472"),
    ("u8_13_normal.ktx2", "e5ef2a4a8f61d310811b8ad529777d99"),
    ("u8_13_parallax.ktx2", "702f63f09f17c55b10329f3a4879e2a4"),
    ("u8_13_roughness.ktx2", "4893076381524b01ff7c1edd01ba00a5"),
    ("u8_14_normal.dds", "8eb0f0ee38a679069e62217a075c8bbd"),
    ("u8_14_parallax.dds", "f16e5270954ef788ae1a65d6d188c9bb"),
    ("u8_14_roughness.dds", "3cdecb67830119db6bc1205a58b57180"),
    ("u8_15_normal.dds", "62b4360068371e5f643ef6b38b6d534a"),
    ("u8_15_parallax.dds", "7e37d2442ba7cde749ed3fb1da4e2fa9"),
    ("u8_16_normal.ktx2", "094b710010cb752cb34500466885508d"),
    ("u8_16_parallax.ktx2", "6e34e7c4517945f08fd07a6c9e96b223"),
    ("u8_17_normal.dds", "740bd780cb3bd08144a835be01b54e31"),
    ("u8_17_parallax.dds", "96be5c7c5c445c58b4e9485c6276082d"),
    ("u8_17_roughness.dds", "8576f47980e32365ceddf490c68ad007"),
    ("u8_18_normal.ktx2", "67f5d788eb15c2d9dd89571153650d36"),
    ("u8_18_parallax.ktx2", "1702d727fb74c13c58abecdf40798192"),
    ("u8_19_normal.png", "4d719fd6073983eab17abf3960dcda0c"),
    ("u8_19_parallax.png", "9632eb48254d359bc5e403dfa1318d76"),
    ("u8_20_normal.exr", "09aa65f50e511c694a212853b9f7e8af"),
    ("u8_20_parallax.exr", "99ebbc18469c1c3980bae3ea1f70d555"),
    ("u8_21_normal.png", "fec58838c3b0d9e17dfab564b0c6f806"),
    ("u8_21_parallax.png", "2f17354e057ea75304ac2a39a0f6da3d"),
    ("u8_22_normal.png", "a067456d9f413b2bd905d314fca445e2"),
    ("u8_22_parallax.png", "eddb196336e6716bb0581bbd083c917c"),
    ("u8_23_normal.png", "5629a0005332928941501787541a7cdf"),
    ("u8_23_parallax.png", "37e26e6f746a3c56a3bcafa17c4ffeb8"),
    ("u8_24_normal.png", "9ccfcb09042017146c47c6d797a3e772"),
    ("u8_24_parallax.png", "c1036ff47561272e8841647141ec142b"),
    ("u16le_0_normal.png", "b912835cc96304e1ae3c49a70f9adb79"),
    ("u16le_0_parallax.png", "7b36b5b9878d81069803b11da58adf0a"),
    ("u16le_1_normal.png", "6b00618fc1f409f95f12cc7f48878651"),
    ("u16le_1_parallax.png", "d7fb7dc1218a0853497f18e46b4016be"),
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
    ("u16le_7_normal.png", "c1599f2c4286126cfa698c4b6528a563"),
    ("u16le_7_parallax.png", "53e406b6a7ee6fda35bc5f92e9a04fcd"),
    ("u16le_8_normal.png", "c1599f2c4286126cfa698c4b6528a563"),
    ("u16le_8_parallax.png", "a827047804dc79f0030146195a68a9c7"),
    ("u16le_9_normal.ktx2", "481c3aabf04c8ac10be1871a16e39ab5"),
    ("u16le_9_parallax.ktx2", "79adf14a0d47f4e402e1ba87bc9ffa93"),
    ("u16le_10_normal.dds", "fd6d1de3c37103e2a24957537cc1f563"),
    ("u16le_10_parallax.dds", "ec20233219add030026b646976a42207"),
    ("u16le_11_normal.ktx2", "17799fecf677ffdbd0e34ea6c8b069c8"),
    ("u16le_11_parallax.ktx2", "1c741826433f227c2b10f28ab5b31e43"),
    ("u16le_12_normal.dds", "9461cac49d3ae6d975da1ed67e898022"),
    ("u16le_12_parallax.dds", "216db3a6b21919dfad242cdc7e21900b"),
    ("u16le_13_normal.ktx2", "6dbdc575c537612dba53ed4ae6c76d57"),
    ("u16le_13_parallax.ktx2", "f53993d53169d2ac03434ded8e21baa2"),
    ("u16le_13_roughness.ktx2", "85acc4572453a743c237c31956a8ed16"),
    ("u16le_14_normal.dds", "f6c5739d021804ca77bd3f0d3f410de2"),
    ("u16le_14_parallax.dds", "761269d5927ac28c911949ab55cece33"),
    ("u16le_14_roughness.dds", "214170755b0e703b8bb73a0f3d44f72d"),
    ("u16le_15_normal.dds", "074ff62297519376d6d1c535c31b1aad"),
    ("u16le_15_parallax.dds", "037419869f073ef1495672b71cf3cd29"),
    ("u16le_16_normal.ktx2", "47499e7661575a396ee1c4702479bfb3"),
    ("u16le_16_parallax.ktx2", "0e5969ca84d0c5e496c79a13a6fe7be9"),
    ("u16le_17_normal.dds", "2aa9f25ffd3bbbf6da51ca9dcbb5e3bc"),
    ("u16le_17_parallax.dds", "fbf3d0995b73bdb5293ab8f6357f3dde"),
    ("u16le_17_roughness.dds", "3ead84f4ffa486f2e3a6deca15e1c0cd"),
    ("u16le_18_normal.ktx2", "13ae584285a60a57dd2c1c7861d869d3"),
    ("u16le_18_parallax.ktx2", "6d2fd020e197d5b13bc29e1b028e74bd"),
    ("u16le_19_normal.png", "0125594e8a7c218fd4d371b23ccd6d19"),
    ("u16le_19_parallax.png", "46db39156bef90b3c0303b01bd4da798"),
    ("u16le_20_normal.exr", "6655979c491b229b7c7170893f4177a5"),
    ("u16le_20_parallax.exr", "d4e20fad6fe407a81dca662624196d7c"),
    ("u16le_21_normal.png", "95f7928d19c85850ef3f37fd7b55c8b0"),
    ("u16le_21_parallax.png", "6481e5ef4915a5fb2a92b911b71c5072"),
    ("u16le_22_normal.png", "cd5e58fcfea4e7ce760adda2a1ef9b13"),
    ("u16le_22_parallax.png", "416eaec8995deb0b0637f1541e553f62"),
    ("u16le_23_normal.png", "e98dbe8b36783c819e3f18c1f868dce1"),
    ("u16le_23_parallax.png", "3da28c2dae590dc2a355086a95c3ac19"),
    ("u16le_24_normal.png", "eac353a2f22b001770e1e1110007f377"),
    ("u16le_24_parallax.png", "bc52a2ac9441bf6e44f3efdd305ab54c"),
    ("f32le_0_normal.png", "b912835cc96304e1ae3c49a70f9adb79"),
    ("f32le_0_parallax.png", "7b36b5b9878d81069803b11da58adf0a"),
    ("f32le_1_normal.png", "74210284264dcc293ba92f9c1457946f"),
    ("f32le_1_parallax.png", "46c675cc3ba2cdc188946d19f0b5c958"),
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
    ("f32le_7_normal.png", "c1599f2c4286126cfa698c4b6528a563"),
    ("f32le_7_parallax.png", "53e406b6a7ee6fda35bc5f92e9a04fcd"),
    ("f32le_8_normal.png", "c1599f2c4286126cfa698c4b6528a563"),
    ("f32le_8_parallax.png", "a827047804dc79f0030146195a68a9c7"),
    ("f32le_9_normal.ktx2", "481c3aabf04c8ac10be1871a16e39ab5"),
    ("f32le_9_parallax.ktx2", "79adf14a0d47f4e402e1ba87bc9ffa93"),
    ("f32le_10_normal.dds", "597efc2698ad315dac982e7b214ac0e8"),
    ("f32le_10_parallax.dds", "83b107a8d6279d8ae70c038fa43137b6"),
    ("f32le_11_normal.ktx2", "131795d167a800ed913b022085bb43fd"),
    ("f32le_11_parallax.ktx2", "3eac96c2d4b5d6259dbf3cdfb5610eef"),
    ("f32le_12_normal.dds", "69fe152fcecb64aac37e8680fc4389a2"),
    ("f32le_12_parallax.dds", "a0559c1204c89b33b6d03f7c8c04bea4"),
    ("f32le_13_normal.ktx2", "6dbdc575c537612dba53ed4ae6c76d57"),
    ("f32le_13_parallax.ktx2", "f53993d53169d2ac03434ded8e21baa2"),
    ("f32le_13_roughness.ktx2", "85acc4572453a743c237c31956a8ed16"),
    ("f32le_14_normal.dds", "87e0d35a6acae29591c788f215334704"),
    ("f32le_14_parallax.dds", "5aa96a10af284c5247513d2faa1314ac"),
    ("f32le_14_roughness.dds", "2675847f65c5b06a827df516bbe7b50d"),
    ("f32le_15_normal.dds", "074ff62297519376d6d1c535c31b1aad"),
    ("f32le_15_parallax.dds", "037419869f073ef1495672b71cf3cd29"),
    ("f32le_16_normal.ktx2", "47499e7661575a396ee1c4702479bfb3"),
    ("f32le_16_parallax.ktx2", "0e5969ca84d0c5e496c79a13a6fe7be9"),
    ("f32le_17_normal.dds", "2aa9f25ffd3bbbf6da51ca9dcbb5e3bc"),
    ("f32le_17_parallax.dds", "fbf3d0995b73bdb5293ab8f6357f3dde"),
    ("f32le_17_roughness.dds", "3ead84f4ffa486f2e3a6deca15e1c0cd"),
    ("f32le_18_normal.ktx2", "13ae584285a60a57dd2c1c7861d869d3"),
    ("f32le_18_parallax.ktx2", "6d2fd020e197d5b13bc29e1b028e74bd"),
    ("f32le_19_normal.png", "cd1f74808d746ae8ce179b5ab75fc41a"),
    ("f32le_19_parallax.png", "4659556590e24770f5eaf56da0e02e43"),
    ("f32le_20_normal.exr", "ea8b345bcde3d51b74d36d5608e872b6"),
    ("f32le_20_parallax.exr", "f4c4eecb2c5ba6c8cacdcab61d82f4ea"),
    ("f32le_21_normal.png", "95f7928d19c85850ef3f37fd7b55c8b0"),
    ("f32le_21_parallax.png", "32d98c0eb2086420c5125db557ee2e65"),
    ("f32le_23_normal.png", "e98dbe8b36783c819e3f18c1f868dce1"),
    ("f32le_23_parallax.png", "3da28c2dae590dc2a355086a95c3ac19"),
    ("f32le_24_normal.png", "eac353a2f22b001770e1e1110007f377"),
    ("f32le_24_parallax.png", "bc52a2ac9441bf6e44f3efdd305ab54c"),
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
