//! Maps that are wider and higher than any memory, end to end: every row is right, and the program holds little.
//!
//! `TEXBAKE_FULL_SIZE=1` bakes 65536 x 65536 texels where else fewer rows do.

use super::peaks::{Peaks, SCALE};
use crate::cli::support::{Folder, limited, peak_bytes, png};
use crate::io::hand_made_tiff::Tiff;
use ::exr::prelude::*;
use std::fs::File;
use std::io::Write;
use std::process::Stdio;

const WIDTH: usize = 65_536;

/// What no map may take.
const MOST_BYTES: u64 = 512 << 20;

/// Bakes within an address space in which the bytes of a larger map would not fit.
fn bake(folder: &Folder, arguments: &[&str]) {
    let mut command = limited(&folder.path(""), MOST_BYTES >> 10, arguments);
    let peak = peak_bytes(&mut command.args(["--backend", "cpu", "-q"]).stderr(Stdio::inherit()).spawn().unwrap());
    assert!(peak > 1 << 20 && peak < MOST_BYTES, "{arguments:?}: {peak} bytes");
}

fn assert_baked(folder: &Folder, peaks: &Peaks, input: &[&str]) {
    bake(folder, &[&["normal"], input, &["-o", "n.png", "--scale", SCALE]].concat());
    peaks.assert_normals(&folder.path("n.png"));
}

fn rows_of_full_size() -> usize {
    if std::env::var("TEXBAKE_FULL_SIZE").is_ok_and(|set| set == "1") { WIDTH } else { 2048 }
}

#[test]
fn a_sparse_raw_map() {
    let (folder, peaks) = (Folder::new(), Peaks::new(WIDTH, rows_of_full_size()));
    peaks.dig(&File::create(folder.path("h.raw")).unwrap(), 0, 1);
    let raw = format!("{WIDTH}x{}:u8", peaks.size[1]);
    assert_baked(&folder, &peaks, &["h.raw", "--raw", &raw]);
}

#[test]
fn one_row_and_one_column_of_a_million_texels() {
    let folder = Folder::new();
    File::create(folder.path("h.raw")).unwrap().set_len(1_000_000).unwrap();
    for size in ["1000000x1", "1x1000000"] {
        for output in ["n.png", "n.tif", "n.exr"] {
            bake(&folder, &["normal", "h.raw", "--raw", &format!("{size}:u8"), "-o", output]);
        }
        let [width, height] = [0, 1].map(|side| size.split('x').nth(side).unwrap().parse().unwrap());
        Peaks { size: [width, height], peaks: Vec::new() }.assert_normals(&folder.path("n.png"));
    }
}

/// A strip that holds the whole map, as numpy writes it: 256 MiB of samples.
#[test]
fn a_tiff_of_one_strip() {
    let (folder, peaks) = (Folder::new(), Peaks::new(WIDTH, 2048));
    let all: Vec<u8> = (0..peaks.size[1]).flat_map(|y| peaks.row(y, 1)).collect();
    let strip = |compression, bytes| {
        let tiff = Tiff::grey(WIDTH as u32, peaks.size[1] as u32, 8, 1, vec![bytes]);
        folder.file("h.tif", Tiff { compression, ..tiff }.bytes());
        assert_baked(&folder, &peaks, &["h.tif"]);
    };
    let mut deflate = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    deflate.write_all(&all).unwrap();
    strip(8, deflate.finish().unwrap());
    strip(5, weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8).encode(&all).unwrap());
    drop(all);

    // Uncompressed, twice as large as the address space, and the file is sparse.
    let rows = 2 * MOST_BYTES as usize / (2 * WIDTH);
    let tall = Peaks::new(WIDTH, rows);
    let file = Tiff::grey(WIDTH as u32, rows as u32, 16, 1, vec![vec![0; 8]]).bytes();
    let header = file.len().next_multiple_of(8);
    let entry =
        |tag: u16| (8..file.len() - 12).find(|at| file[*at..][..4] == [tag.to_le_bytes(), [4, 0]].concat()).unwrap();
    let mut bytes = file.clone();
    bytes[entry(273) + 8..][..4].copy_from_slice(&(header as u32).to_le_bytes());
    bytes[entry(279) + 8..][..4].copy_from_slice(&((2 * WIDTH * rows) as u32).to_le_bytes());
    let path = folder.file("plain.tif", bytes);
    tall.dig(&File::options().write(true).open(path).unwrap(), header as u64, 2);
    assert_baked(&folder, &tall, &["plain.tif"]);
}

#[test]
fn a_tiff_of_tiles() {
    const TILE: usize = 512;
    let (folder, peaks) = (Folder::new(), Peaks::new(WIDTH, 2 * TILE));
    let tile = |left: usize, top: usize| {
        let inside = |[x, y]: &&[usize; 2]| (left..left + TILE).contains(x) && (top..top + TILE).contains(y);
        let mut bytes = vec![0; TILE * TILE];
        peaks.peaks.iter().filter(inside).for_each(|[x, y]| bytes[(y - top) * TILE + x - left] = 255);
        bytes
    };
    let corners = (0..2 * TILE).step_by(TILE).flat_map(|top| (0..WIDTH).step_by(TILE).map(move |left| (left, top)));
    let tiles = corners.map(|(left, top)| tile(left, top)).collect();
    let tiff = Tiff::grey(WIDTH as u32, 2 * TILE as u32, 8, 1, tiles);
    folder.file("h.tif", Tiff { tile: Some((TILE as u32, TILE as u32)), ..tiff }.bytes());
    assert_baked(&folder, &peaks, &["h.tif"]);
}

/// More than the 64 MiB up to which a map is held where its last row is needed first and far: it is decoded twice.
#[test]
fn a_png_that_wraps_into_an_exr() {
    let (folder, peaks) = (Folder::new(), Peaks::new(WIDTH, 1100));
    let all: Vec<u8> = (0..peaks.size[1]).flat_map(|y| peaks.row(y, 1)).collect();
    folder.file("h.png", png(WIDTH, peaks.size[1], ::png::ColorType::Grayscale, ::png::BitDepth::Eight, &all));
    bake(&folder, &["parallax", "h.png", "-o", "p.exr", "--scale", SCALE]);
    peaks.assert_parallax(&folder.path("p.exr"));
    assert_baked(&folder, &peaks, &["h.png"]);
}

#[test]
fn an_exr_of_lines_and_of_tiles() {
    let (folder, peaks) = (Folder::new(), Peaks::new(WIDTH, 300));
    let height = |x: usize, y: usize| f16::from_f32(f32::from(u8::from(peaks.peaks.contains(&[x, y]))));
    let heights: Vec<f16> = (0..300).flat_map(|y| (0..WIDTH).map(move |x| (x, y))).map(|(x, y)| height(x, y)).collect();
    for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(256, 256))] {
        let encoding = Encoding { compression: Compression::ZIP16, blocks, line_order: LineOrder::Increasing };
        let channel = AnyChannel::new("Y", FlatSamples::F16(heights.clone()));
        let channels = AnyChannels::sort([channel].into_iter().collect());
        let layer = Layer::new((WIDTH, 300), LayerAttributes::named("heights"), encoding, channels);
        Image::from_layer(layer).write().to_file(folder.path("h.exr")).unwrap();
        assert_baked(&folder, &peaks, &["h.exr"]);
    }
}
