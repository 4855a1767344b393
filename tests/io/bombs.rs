//! Files that claim or unfold to more than they are: the program refuses each by name, says what to do, writes
//! nothing, and stays within an address space of [`LIMIT_KIB`].
//!
//! `ulimit -v` makes an allocation beyond that fail, which ends the program by a signal: no reader may even try.

use super::gltf::builder::{Builder, POSITIONS, TRIANGLES, U16, glb};
use super::hand_made_png::{of_chunks, stored};
use super::hand_made_tiff::Tiff;
use super::support::Folder;
use ::exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, FlatSamples, Image, Layer, LayerAttributes, LineOrder, Vec2,
    WritableImage,
};
use serde_json::json;
use std::fmt::Write;
use std::io::Write as _;
use std::process::Command;

/// The address space of the program: its code, its threads' stacks and its allocator's arena, and what it allocates.
const LIMIT_KIB: u64 = 768 << 10;

/// What the program is told to hold at most: 64 MiB.
const MAX_BYTES: &str = "64M";

/// How a run ended: its exit status, or none if a signal ended it; and what it said.
struct Run {
    status: Option<i32>,
    stderr: String,
}

/// Runs the program in a folder, within the limits.
fn run(folder: &Folder, arguments: &[&str]) -> Run {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit -v {LIMIT_KIB} && exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_texbake")]);
    command.args(arguments).current_dir(folder.path(""));
    // Each thread's arena would reserve 64 MiB of addresses, and each thread of a machine with many cores a stack.
    command.env("MALLOC_ARENA_MAX", "1").env("RAYON_NUM_THREADS", "2");
    let output = command.output().unwrap();
    Run { status: output.status.code(), stderr: String::from_utf8(output.stderr).unwrap() }
}

/// Fails unless the program refuses a file with this content as it should.
#[track_caller]
fn assert_refused(name: &str, bytes: &[u8], arguments: &[&str], expected: &str) {
    let folder = Folder::new();
    folder.file(name, bytes);
    let Run { status, stderr } = run(&folder, arguments);
    assert_eq!(status, Some(1), "{name}: {stderr}");
    let lines: Vec<&str> = stderr.lines().collect();
    let [line] = lines[..] else { panic!("{name}: not one line: {stderr}") };
    assert!(line.contains(name) && line.contains(expected) && !line.contains("panicked"), "{expected:?}: {line}");
    assert!(line.contains("; ") || line.contains(": raise it"), "{name}: no way out: {line}");
    assert_eq!(folder.names(), [name], "nothing was written");
}

#[track_caller]
fn assert_map_refused(name: &str, bytes: &[u8], expected: &str) {
    let bake = ["normal", name, "-o", "out.png", "--max-bytes", MAX_BYTES, "--backend", "cpu"];
    assert_refused(name, bytes, &bake, expected);
    let repair = ["check", name, "--repair", "-o", "out.png", "--max-bytes", MAX_BYTES];
    let folder = Folder::new();
    folder.file(name, bytes);
    let Run { status, stderr } = run(&folder, &repair);
    assert_eq!(status, Some(1), "as a normal map, {name}: {stderr}");
    assert!(stderr.contains(name) && !stderr.contains("panicked"), "{stderr}");
    assert_eq!(folder.names(), [name], "nothing was written");
}

#[track_caller]
fn assert_model_refused(name: &str, bytes: &[u8], expected: &str) {
    assert_refused(
        name,
        bytes,
        &["tangents", name, "-o", "out.glb", "--all", "--max-bytes", MAX_BYTES, "--backend", "cpu"],
        expected,
    );
}

/// A zlib stream that inflates to zeros, as dense as can be.
fn zeros(bytes: usize) -> Vec<u8> {
    let mut deflate = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    let piece = vec![0; 1 << 20];
    for begin in (0..bytes).step_by(piece.len()) {
        deflate.write_all(&piece[..piece.len().min(bytes - begin)]).unwrap();
    }
    deflate.finish().unwrap()
}

const GREY: [u8; 3] = [8, 0, 0];
const INTERLACED: [u8; 3] = [8, 0, 1];

#[test]
fn png() {
    let idat = |bytes: Vec<u8>| [(b"IDAT", bytes)];
    let small = idat(stored(&[0; 9]));
    assert_map_refused("greatest.png", &of_chunks([i32::MAX as u32; 2], GREY, &small), "more than any map holds");
    assert_map_refused("hollow.png", &of_chunks([30_000, 30_000], GREY, &small), "cannot come out of");
    assert_map_refused("wide.png", &of_chunks([100_000_000, 1], [16, 6, 0], &small), "raise it with --max-bytes");
    let whole = of_chunks([20_000, 20_000], INTERLACED, &idat(zeros(400 << 20)));
    assert!(whole.len() < 3 << 20, "{} bytes", whole.len());
    assert_map_refused("interlaced.png", &whole, "above the limit of 67108864; raise it with --max-bytes");
    // A profile, "p", of 400 MiB.
    let profile = [b"p\0\0".to_vec(), zeros(400 << 20)].concat();
    let with_profile = of_chunks([1, 1], GREY, &[(b"iCCP", profile), (b"IDAT", stored(&[0; 2]))]);
    assert_reads_or_refuses("profile.png", &with_profile);
    for (name, head) in [(b"zTXt", &b"t\0\0"[..]), (b"iTXt", b"t\0\x01\0\0\0")] {
        let text = [head, &zeros(400 << 20)].concat();
        let with_text = of_chunks([1, 1], GREY, &[(name, text), (b"IDAT", stored(&[0; 2]))]);
        assert_reads_or_refuses("text.png", &with_text);
    }
    // Far more rows than the header says.
    assert_reads_or_refuses("long.png", &of_chunks([16, 16], GREY, &idat(zeros(400 << 20))));
    // Chunks of two gigabytes that are not there.
    for name in [b"IDAT", b"iCCP", b"eXIf", b"tEXt", b"PLTE", b"juNk"] {
        let mut bytes = of_chunks([16, 16], GREY, &[(name, Vec::new())]);
        bytes[33..37].copy_from_slice(&(i32::MAX as u32).to_be_bytes());
        assert_map_refused("claims.png", &bytes, "");
    }
}

/// What is more than its map but not too large: a map or a reason, within the limits.
#[track_caller]
fn assert_reads_or_refuses(name: &str, bytes: &[u8]) {
    let folder = Folder::new();
    folder.file(name, bytes);
    let bake = ["normal", name, "-o", "out.png", "--max-bytes", MAX_BYTES, "--backend", "cpu", "-q"];
    let Run { status, stderr } = run(&folder, &bake);
    match status {
        Some(0) => assert_eq!(folder.names(), sorted(["out.png", name])),
        Some(1) => {
            assert!(stderr.contains(name) && !stderr.contains("panicked"), "{stderr}");
            assert_eq!(folder.names(), [name], "nothing was written");
        }
        status => panic!("{name}: {status:?}: {stderr}"),
    }
}

fn sorted<const N: usize>(mut names: [&str; N]) -> [&str; N] {
    names.sort_unstable();
    names
}

#[test]
fn tiff() {
    let hollow = Tiff::grey(60_000, 60_000, 16, 1, vec![vec![1; 4]]);
    assert_map_refused("strip.tif", &hollow.bytes(), "raise it with --max-bytes");
    let tile = Tiff { tile: Some((1 << 30, 1 << 30)), ..Tiff::grey(16, 16, 8, 1, vec![vec![0; 16]]) };
    assert_map_refused("tile.tif", &tile.bytes(), "");
    let greatest = Tiff { width: u32::MAX, height: u32::MAX, rows_per_strip: 1, ..hollow.clone() };
    assert_map_refused("greatest.tif", &greatest.bytes(), "");
    // Deflate, LZW, PackBits: one strip of 4 MiB, of which four bytes are there.
    for compression in [8u16, 5, 32_773] {
        let mut bytes = Tiff::grey(2048, 2048, 8, 1, vec![vec![0; 4]]).bytes();
        set_tag(&mut bytes, 259, compression.into());
        assert_map_refused("packed.tif", &bytes, "");
    }
    // A deflated strip of 400 MiB for a map of 16 x 16.
    let mut bytes = Tiff::grey(16, 16, 8, 1, vec![zeros(400 << 20)]).bytes();
    set_tag(&mut bytes, 259, 8);
    assert_reads_or_refuses("deflated.tif", &bytes);
    // Tables with four billion entries.
    for tag in [258, 273, 279] {
        let mut bytes = Tiff::grey(16, 16, 8, 1, vec![vec![7; 256]]).bytes();
        set_count(&mut bytes, tag, u32::MAX);
        assert_map_refused("table.tif", &bytes, "values, more than the file holds; it is damaged");
    }
    for tag in [34_675u16, 42_113] {
        let extra = vec![(tag, 2, 8, vec![b'1'; 8])];
        let mut bytes = Tiff { extra, ..Tiff::grey(16, 16, 8, 1, vec![vec![7; 256]]) }.bytes();
        set_count(&mut bytes, tag, u32::MAX);
        assert_reads_or_refuses("text.tif", &bytes);
    }
    // A directory that follows itself: only the first is read.
    let mut circle = Tiff::grey(16, 16, 8, 1, vec![vec![7; 256]]).bytes();
    let directory = u32::from_le_bytes(circle[4..8].try_into().unwrap());
    let entries = u16::from_le_bytes(circle[directory as usize..][..2].try_into().unwrap());
    let next = directory as usize + 2 + 12 * usize::from(entries);
    circle[next..next + 4].copy_from_slice(&directory.to_le_bytes());
    assert_reads_or_refuses("circle.tif", &circle);
    // BigTIFF: a directory of 2^63 entries, and one entry of 2^60 values.
    let big = |entries: u64, rest: &[u8]| {
        [b"II\x2b\0\x08\0\0\0\x10\0\0\0\0\0\0\0", &entries.to_le_bytes()[..], rest].concat()
    };
    assert_map_refused("big.tif", &big(1 << 63, &[0; 20]), "its directory has more entries than the file holds");
    let width = [&256u16.to_le_bytes()[..], &16u16.to_le_bytes(), &(1u64 << 60).to_le_bytes(), &[0; 8]].concat();
    assert_map_refused("values.tif", &big(1, &[width, vec![0; 8]].concat()), "more than the file holds");
}

/// Where a TIFF's entry of a tag stands.
fn entry(bytes: &[u8], tag: u16) -> usize {
    let directory = u32::from_le_bytes(bytes[4..8].try_into().unwrap()) as usize;
    (directory + 2..bytes.len()).step_by(12).find(|&at| bytes[at..at + 2] == tag.to_le_bytes()).unwrap()
}

fn set_tag(bytes: &mut [u8], tag: u16, value: u32) {
    let at = entry(bytes, tag);
    bytes[at + 8..at + 12].copy_from_slice(&value.to_le_bytes());
}

fn set_count(bytes: &mut [u8], tag: u16, count: u32) {
    let at = entry(bytes, tag);
    bytes[at + 4..at + 8].copy_from_slice(&count.to_le_bytes());
}

/// An EXR of 4 x 4 zeros.
fn exr_file(compression: Compression, blocks: Blocks) -> Vec<u8> {
    let folder = Folder::new();
    let path = folder.path("e.exr");
    let channels = AnyChannels::sort([AnyChannel::new("Y", FlatSamples::F32(vec![0.0; 16]))].into_iter().collect());
    let encoding = ::exr::prelude::Encoding { compression, blocks, line_order: LineOrder::Increasing };
    Image::from_layer(Layer::new((4, 4), LayerAttributes::named("l"), encoding, channels))
        .write()
        .to_file(&path)
        .unwrap();
    std::fs::read(&path).unwrap()
}

/// Replaces an attribute's value: name, zero, type, zero, four bytes of length, value.
fn set_attribute(bytes: &mut [u8], name: &str, type_: &str, at: usize, value: &[u8]) {
    let head = [name.as_bytes(), b"\0", type_.as_bytes(), b"\0"].concat();
    let begin = bytes.windows(head.len()).position(|window| window == head).unwrap() + head.len() + 4 + at;
    bytes[begin..begin + value.len()].copy_from_slice(value);
}

#[test]
fn exr() {
    let corner = |side: i32| [side - 1; 2].map(i32::to_le_bytes).concat();
    let tiles = |side: u32| [side; 2].map(u32::to_le_bytes).concat();
    // The decoder, left alone, allocates 3.6 GB for 491 bytes.
    let mut one_tile = exr_file(Compression::ZIP16, Blocks::Tiles(Vec2(4, 4)));
    set_attribute(&mut one_tile, "dataWindow", "box2i", 8, &corner(30_000));
    set_attribute(&mut one_tile, "tiles", "tiledesc", 0, &tiles(30_000));
    assert!(one_tile.len() < 512, "{} bytes", one_tile.len());
    assert_map_refused("tile.exr", &one_tile, "the header claims 30000 x 30000 texels");
    // As much as the limit lets pass.
    set_attribute(&mut one_tile, "dataWindow", "box2i", 8, &corner(2800));
    set_attribute(&mut one_tile, "tiles", "tiledesc", 0, &tiles(2800));
    assert_map_refused("tile.exr", &one_tile, "");
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::DWAA(None),
        Compression::DWAB(None),
    ] {
        let lines = exr_file(compression, Blocks::ScanLines);
        let mut wide = lines.clone();
        set_attribute(
            &mut wide,
            "dataWindow",
            "box2i",
            8,
            &[(100_000_000i32 - 1).to_le_bytes(), 3i32.to_le_bytes()].concat(),
        );
        assert_map_refused("wide.exr", &wide, "");
        // The same four rows in one block after another, or in a table that is not there.
        let mut high = lines.clone();
        set_attribute(
            &mut high,
            "dataWindow",
            "box2i",
            8,
            &[3i32.to_le_bytes(), (i32::MAX - 1).to_le_bytes()].concat(),
        );
        assert_map_refused("high.exr", &high, "");
        // A block of two gigabytes: its length stands behind its first row.
        let mut block = lines.clone();
        let first = block.windows(16).position(|window| window[..4] == [0; 4] && window[8..] == [0; 8]);
        for at in first.into_iter().chain(lines.len().checked_sub(80)) {
            let mut block = block.clone();
            block[at..at + 8].fill(0x7f);
            assert_reads_or_refuses("block.exr", &block);
        }
        block.truncate(lines.len() - 1);
        assert_map_refused("cut.exr", &block, "");
    }
    // An attribute of two gigabytes; deep data; several parts.
    let mut text = exr_file(Compression::ZIP1, Blocks::ScanLines);
    set_attribute(&mut text, "name", "string", 0, b"x");
    let head = b"name\0string\0";
    let at = text.windows(head.len()).position(|window| window == head).unwrap() + head.len();
    text[at..at + 4].copy_from_slice(&i32::MAX.to_le_bytes());
    assert_map_refused("text.exr", &text, "");
    for flags in [0x08u8, 0x10, 0x18] {
        let mut bytes = exr_file(Compression::ZIP1, Blocks::ScanLines);
        bytes[5] |= flags;
        assert_reads_or_refuses("parts.exr", &bytes);
    }
}

#[test]
fn tga_bmp_jpeg_webp() {
    // Types 2 and 10: plain and run-length encoded colours.
    for kind in [2, 10] {
        let tga = [&[0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 32, 0][..], &[0xff; 64]].concat();
        assert_map_refused("claims.tga", &tga, "raise it with --max-bytes");
        let small = [&[0, 0, kind, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xa0, 0x0f, 0xa0, 0x0f, 24, 0][..], &[0xff; 64]].concat();
        assert_map_refused("cut.tga", &small, "");
    }
    let folder = Folder::new();
    let image = image::RgbImage::from_pixel(4, 4, image::Rgb([128, 128, 255]));
    let file = |name: &str, format| {
        let path = folder.path(name);
        image.save_with_format(&path, format).unwrap();
        std::fs::read(path).unwrap()
    };
    let mut bmp = file("a.bmp", image::ImageFormat::Bmp);
    bmp[18..26].copy_from_slice(&[60_000u32, 60_000].map(u32::to_le_bytes).concat());
    assert_map_refused("claims.bmp", &bmp, "raise it with --max-bytes");
    bmp[18..26].copy_from_slice(&[i32::MAX, i32::MIN].map(i32::to_le_bytes).concat());
    assert_map_refused("greatest.bmp", &bmp, "");
    // RLE8, whose rows may be skipped by a byte or two.
    bmp[18..26].copy_from_slice(&[4000u32, 4000].map(u32::to_le_bytes).concat());
    bmp[28] = 8;
    bmp[30] = 1;
    assert_map_refused("rle.bmp", &bmp, "");
    let mut jpeg = file("a.jpg", image::ImageFormat::Jpeg);
    let frame = jpeg.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[60_000u16, 60_000].map(u16::to_be_bytes).concat());
    assert_map_refused("claims.jpg", &jpeg, "raise it with --max-bytes");
    let mut webp = file("a.webp", image::ImageFormat::WebP);
    let data = webp.windows(4).position(|letters| letters == b"VP8L").unwrap() + 8;
    // 14 bits of width - 1, and of height - 1, behind the byte 0x2f.
    webp[data + 1..data + 5].copy_from_slice(&(16_382u32 << 14 | 16_382).to_le_bytes());
    assert_map_refused("claims.webp", &webp, "raise it with --max-bytes");
}

/// A .gltf of one triangle without buffers, after a change.
fn document(change: impl FnOnce(&mut serde_json::Value)) -> Vec<u8> {
    let mut json = json!({
        "asset": { "version": "2.0" },
        "accessors": [
            { "componentType": 5126, "count": 3, "type": "VEC3" },
            { "componentType": 5126, "count": 3, "type": "VEC2" }
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 } }] }]
    });
    change(&mut json);
    serde_json::to_vec(&json).unwrap()
}

#[test]
fn gltf() {
    // Accessors that no byte stands for: as many vertices as one likes.
    for count in [1_000_000u64, 1_000_000_000, 1 << 60] {
        let claims = document(|json| (0..2).for_each(|i| json["accessors"][i]["count"] = count.into()));
        assert_model_refused("claims.gltf", &claims, "--max-bytes: raise it");
    }
    // Many primitives of a few of them.
    let many = document(|json| {
        (0..2).for_each(|i| json["accessors"][i]["count"] = 100_000.into());
        let accessor = json["accessors"][0].clone();
        json["accessors"].as_array_mut().unwrap().extend(vec![accessor; 100]);
        let primitive = |i: usize| json!({ "attributes": { "POSITION": 2 + i, "TEXCOORD_0": 1 } });
        json["meshes"][0]["primitives"] = (0..100).map(primitive).collect();
    });
    assert_model_refused("many.gltf", &many, "raise it with --max-bytes, or split the model");
    let buffers = document(|json| json["buffers"] = json!([{ "uri": "data:;base64,AAAA", "byteLength": 1u64 << 50 }]));
    assert_model_refused("buffers.gltf", &buffers, "of the 1125899906842624 bytes that it claims");

    let nested = |open: &str, count: usize| {
        [br#"{"asset":{"version":"2.0"},"extras":"#.to_vec(), open.repeat(count).into()].concat()
    };
    assert_model_refused("deep.gltf", &nested("[", 1_000_000), "");
    assert_model_refused("deep.gltf", &nested("{\"a\":", 100_000), "");
    // Four megabytes of text would be a hundred times as many of values.
    let values = document(|json| json["extras"] = vec![0; 2_000_000].into());
    assert_model_refused("values.gltf", &values, "raise it with --max-bytes");
    let objects = document(|json| json["extras"] = vec![json!({}); 1_000_000].into());
    assert_model_refused("objects.gltf", &objects, "raise it with --max-bytes");

    let (mut square, position, texcoord) = Builder::square();
    let indices = square.indices(U16, TRIANGLES.as_flattened());
    square.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "indices": indices }));
    let mut chunk = square.glb();
    chunk[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_model_refused("chunk.glb", &chunk, "");
    // A hundred thousand meshes of the same bytes, each of which gets tangents of its own.
    let mut shared = square.clone();
    shared.json["accessors"] = vec![shared.json["accessors"][position].clone(); 20_000].into();
    assert_model_refused("shared.glb", &glb(&shared.json, bytemuck::cast_slice(&POSITIONS)), "");
}

#[test]
fn obj() {
    let mut corners = String::new();
    for i in 0..100_000 {
        let (x, y) = (i, [0, 5, 1, 7][i % 4]);
        writeln!(corners, "v {x} {y} 0").unwrap();
    }
    let face: String = (1..=100_000).map(|i| format!(" {i}")).collect();
    assert_model_refused(
        "comb.obj",
        format!("{corners}f{face}\n").as_bytes(),
        "a polygon of 100000 corners is not convex",
    );
    let face: String = (0..5_000_000).map(|_| " 1").collect();
    assert_model_refused("face.obj", format!("v 0 0 0\nf{face}\n").as_bytes(), "raise it with --max-bytes");
    for index in ["4294967295", "4294967296", "9223372036854775808", "-1000000", "0"] {
        assert_model_refused("index.obj", format!("v 0 0 0\nf 1 {index} 1\n").as_bytes(), "");
    }
    // Twenty bytes of text make a primitive with its accessors and views.
    let parts: String = (0..100_000).map(|i| format!("usemtl {i}\nf 1 1 1\n")).collect();
    assert_model_refused("parts.obj", format!("v 0 0 0\n{parts}").as_bytes(), "raise it with --max-bytes");
}

#[test]
fn materials_of_an_obj() {
    let folder = Folder::new();
    // A library that is named ten thousand times, by two names, is read once.
    folder.file("m.mtl", "newmtl a\nKd 1 0 0\n".repeat(5000).as_bytes());
    let libraries = "mtllib m.mtl\nmtllib ./m.mtl\n".repeat(5000);
    // One that would be much larger in memory is not read.
    folder.file("large.mtl", "newmtl a\n".repeat(200_000).as_bytes());
    folder.file(
        "m.obj",
        format!("{libraries}mtllib large.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
            .as_bytes(),
    );
    let Run { status, stderr } =
        run(&folder, &["tangents", "m.obj", "-o", "out.glb", "--max-bytes", MAX_BYTES, "--backend", "cpu"]);
    assert_eq!(status, Some(0), "{stderr}");
    assert_eq!(stderr.matches("its materials keep only their names").count(), 1, "{stderr}");
    assert!(stderr.contains("large.mtl") && stderr.contains("raise it with --max-bytes"), "{stderr}");
}

#[test]
fn images_that_go_with_a_model_count() {
    let folder = Folder::new();
    std::fs::File::create(folder.path("large.png")).unwrap().set_len(100 << 20).unwrap();
    folder.file("m.gltf", &document(|json| json["images"] = json!([{ "uri": "large.png" }])));
    let convert = |output: &str| {
        run(&folder, &["tangents", "m.gltf", "-o", output, "--all", "--max-bytes", MAX_BYTES, "--backend", "cpu"])
    };
    for output in ["out.glb", "out/m.gltf"] {
        let Run { status, stderr } = convert(output);
        assert_eq!(status, Some(1), "{output}: {stderr}");
        assert!(
            stderr.contains("large.png: it has 104857600 bytes") && stderr.contains("raise it with --max-bytes"),
            "{stderr}"
        );
        assert!(!folder.path(output).exists(), "nothing was written");
    }
}

#[test]
fn settings() {
    let long = vec![b'#'; 2 << 20];
    let deep = [b"a = ".to_vec(), b"[".repeat(100_000)].concat();
    let dotted = [b"a".to_vec(), b".a".repeat(100_000), b" = 1".to_vec()].concat();
    for (text, expected) in [(&long[..], "1048576"), (&deep, ""), (&dotted, "")] {
        let folder = Folder::new();
        folder.file("texbake.toml", text);
        let Run { status, stderr } = run(&folder, &["bake", ".", "--out", "baked", "--backend", "cpu"]);
        assert_eq!(status, Some(2), "{stderr}");
        assert!(
            stderr.contains("texbake.toml") && stderr.contains(expected) && !stderr.contains("panicked"),
            "{stderr}"
        );
        assert_eq!(folder.names(), ["texbake.toml"]);
    }
}
