//! Maps that are wider and higher than any memory, end to end: every row is right, and the program holds little.

use super::peaks::{Peaks, SCALE};
use crate::cli::support::{Folder, limited, peak_of, png};
use crate::io::hand_made_tiff::Tiff;
use ::exr::prelude::*;
use std::fs::File;
use std::io::Write;

const WIDTH: usize = 65_536;

/// What no map may take.
const MOST_BYTES: u64 = 512 << 20;

/// Bakes within an address space in which the bytes of a larger map would not fit; what it holds at most.
fn bake(folder: &Folder, arguments: &[&str]) -> u64 {
    let peak = peak_of(limited(&folder.path(""), MOST_BYTES >> 10, arguments));
    assert!(peak < MOST_BYTES, "{arguments:?}: {peak} bytes");
    peak
}

fn bake_normals(folder: &Folder, peaks: &Peaks, input: &[&str]) -> u64 {
    let peak = bake(folder, &[&["normal"], input, &["-o", "n.png", "--scale", SCALE]].concat());
    peaks.assert_normals(&folder.path("n.png"));
    peak
}

/// Bakes maps of two heights: what holds all rows, of `texel_bytes`, needs the bytes of those that the second one has
/// more, and no bake may need half of them.
fn assert_does_not_grow(rows: [usize; 2], texel_bytes: usize, bake: impl Fn(&Peaks) -> u64) {
    let peaks = rows.map(|rows| bake(&Peaks::new(WIDTH, rows)));
    let more = ((rows[1] - rows[0]) * WIDTH * texel_bytes) as u64;
    assert!(peaks[1] < peaks[0] + more / 2, "{peaks:?} bytes for {rows:?} rows");
}

fn bake_raw(folder: &Folder, peaks: &Peaks) -> u64 {
    peaks.dig(&File::create(folder.path("h.raw")).unwrap(), 0, 1);
    let raw = format!("{WIDTH}x{}:u8", peaks.size[1]);
    bake_normals(folder, peaks, &["h.raw", "--raw", &raw])
}

#[test]
fn a_sparse_raw_map() {
    let folder = Folder::new();
    assert_does_not_grow([256, 2048], 1, |peaks| bake_raw(&folder, peaks));
}

#[test]
fn a_raw_map_of_full_size() {
    bake_raw(&Folder::new(), &Peaks::new(WIDTH, WIDTH));
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

/// All heights as bytes.
fn bytes_of(peaks: &Peaks) -> Vec<u8> {
    (0..peaks.size[1]).flat_map(|y| peaks.row(y, 1)).collect()
}

/// A strip that holds the whole map, as numpy writes it.
#[test]
fn a_tiff_of_one_packed_strip() {
    let folder = Folder::new();
    let deflate = |bytes: &[u8]| {
        let mut deflate = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        deflate.write_all(bytes).unwrap();
        deflate.finish().unwrap()
    };
    let lzw =
        |bytes: &[u8]| weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8).encode(bytes).unwrap();
    type Pack<'a> = &'a dyn Fn(&[u8]) -> Vec<u8>;
    let packings: [(u16, Pack<'_>); 2] = [(8, &deflate), (5, &lzw)];
    for (compression, pack) in packings {
        assert_does_not_grow([256, 2048], 1, |peaks| {
            let tiff = Tiff::grey(WIDTH as u32, peaks.size[1] as u32, 8, 1, vec![pack(&bytes_of(peaks))]);
            folder.file("h.tif", Tiff { compression, ..tiff }.bytes());
            bake_normals(&folder, peaks, &["h.tif"])
        });
    }
}

/// Uncompressed, and twice as large as the address space: the file is sparse.
#[test]
fn a_tiff_of_one_plain_strip() {
    let rows = 2 * MOST_BYTES as usize / (2 * WIDTH);
    let (folder, tall) = (Folder::new(), Peaks::new(WIDTH, rows));
    let file = Tiff::grey(WIDTH as u32, rows as u32, 16, 1, vec![vec![0; 8]]).bytes();
    let header = file.len().next_multiple_of(8);
    let entry =
        |tag: u16| (8..file.len() - 12).find(|at| file[*at..][..4] == [tag.to_le_bytes(), [4, 0]].concat()).unwrap();
    let mut bytes = file.clone();
    bytes[entry(273) + 8..][..4].copy_from_slice(&(header as u32).to_le_bytes());
    bytes[entry(279) + 8..][..4].copy_from_slice(&((2 * WIDTH * rows) as u32).to_le_bytes());
    let path = folder.file("plain.tif", bytes);
    tall.dig(&File::options().write(true).open(path).unwrap(), header as u64, 2);
    bake_normals(&folder, &tall, &["plain.tif"]);
}

#[test]
fn a_tiff_of_tiles() {
    const TILE: usize = 256;
    let folder = Folder::new();
    let tile = |peaks: &Peaks, left: usize, top: usize| {
        let inside = |[x, y]: &&[usize; 2]| (left..left + TILE).contains(x) && (top..top + TILE).contains(y);
        let mut bytes = vec![0; TILE * TILE];
        peaks.peaks.iter().filter(inside).for_each(|[x, y]| bytes[(y - top) * TILE + x - left] = 255);
        bytes
    };
    assert_does_not_grow([TILE, 6 * TILE], 1, |peaks| {
        let lefts = || (0..WIDTH).step_by(TILE);
        let corners = (0..peaks.size[1]).step_by(TILE).flat_map(|top| lefts().map(move |left| (left, top)));
        let tiles = corners.map(|(left, top)| tile(peaks, left, top)).collect();
        let tiff = Tiff::grey(WIDTH as u32, peaks.size[1] as u32, 8, 1, tiles);
        folder.file("h.tif", Tiff { tile: Some((TILE as u32, TILE as u32)), ..tiff }.bytes());
        bake_normals(&folder, peaks, &["h.tif"])
    });
}

/// More than the 64 MiB up to which a map is held where its last row is needed first and far: it is decoded twice.
#[test]
fn a_png_that_wraps_into_an_exr() {
    let folder = Folder::new();
    let write = |peaks: &Peaks| {
        let [width, height] = peaks.size;
        let grey = (::png::ColorType::Grayscale, ::png::BitDepth::Eight);
        folder.file("h.png", png(width, height, grey.0, grey.1, &bytes_of(peaks)));
    };
    assert_does_not_grow([256, 1100], 1, |peaks| {
        write(peaks);
        let peak = bake(&folder, &["parallax", "h.png", "-o", "p.exr", "--scale", SCALE]);
        peaks.assert_parallax(&folder.path("p.exr"));
        peak
    });
    assert_does_not_grow([256, 1100], 1, |peaks| {
        write(peaks);
        bake_normals(&folder, peaks, &["h.png"])
    });
}

#[test]
fn an_exr_of_lines_and_of_tiles() {
    let folder = Folder::new();
    for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(64, 64))] {
        assert_does_not_grow([64, 512], 2, |peaks| {
            let heights = bytes_of(peaks).into_iter().map(|code| f16::from_f32(f32::from(code / 255))).collect();
            let encoding = Encoding { compression: Compression::ZIP16, blocks, line_order: LineOrder::Increasing };
            let channel = AnyChannel::new("Y", FlatSamples::F16(heights));
            let channels = AnyChannels::sort([channel].into_iter().collect());
            let layer = Layer::new((WIDTH, peaks.size[1]), LayerAttributes::named("heights"), encoding, channels);
            Image::from_layer(layer).write().to_file(folder.path("h.exr")).unwrap();
            bake_normals(&folder, peaks, &["h.exr"])
        });
    }
}
