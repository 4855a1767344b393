//! A small file of every kind that the readers of maps know: for tests that damage them, and for the corpora of fuzz/.

use super::hand_made_png::hand_made;
use super::hand_made_tiff::Tiff;
use super::support::{Folder, Noise, format, write};
use ::exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, LineOrder, Vec2, WritableImage,
};
use half::f16;
use std::path::{Path, PathBuf};
use texbake::{Channels, CodesRef, Depth, Encoding};

/// Files that are read as height maps, their red or only channel.
pub fn height_maps(folder: &Folder) -> Vec<PathBuf> {
    [colour_samples(folder), grey_samples(folder), hand_made_samples(folder)].concat()
}

/// Files that are read as normal maps.
pub fn normal_maps(folder: &Folder) -> Vec<PathBuf> {
    [colour_samples(folder), normal_samples(folder)].concat()
}

/// Headerless heights: the file's layout and its bytes.
pub fn raw_maps(folder: &Folder) -> Vec<(&'static str, PathBuf)> {
    let bytes: Vec<u8> = (0..5 * 7 * 4).map(|i| (i % 7) as u8).collect();
    let file = |name: &str, code: usize| folder.file(name, &bytes[..5 * 7 * code]);
    vec![
        ("5x7:u8", file("r1.raw", 1)),
        ("5x7:u16le", file("r2.raw", 2)),
        ("5x7:u16be", file("r3.raw", 2)),
        ("5x7:f32le", file("r4.raw", 4)),
        ("5x7:f32be", file("r5.raw", 4)),
    ]
}

/// Codes of 24 x 40 texels with three channels, as bytes, words and floats.
fn codes() -> (Vec<u8>, Vec<u16>, Vec<f32>) {
    let mut noise = Noise(11);
    let bytes: Vec<u8> = (0..24 * 40 * 3).map(|_| noise.next() as u8 & 0x3f).collect();
    let words = bytes.iter().map(|byte| u16::from(*byte) * 999).collect();
    let floats = bytes.iter().map(|byte| f32::from(*byte)).collect();
    (bytes, words, floats)
}

/// A small file of each format and kind, three channels each.
fn colour_samples(folder: &Folder) -> Vec<PathBuf> {
    let (bytes, words, floats) = codes();
    let paths = ["a.png", "b.png", "c.tif", "d.tif", "e.exr"].map(|name| folder.path(name));
    let unorm = |depth| format(Encoding::Unorm, depth, Channels::Xyz);
    write(&paths[0], 24, 40, unorm(Depth::Bits8), CodesRef::U8(&bytes)).unwrap();
    write(&paths[1], 24, 40, unorm(Depth::Bits16), CodesRef::U16(&words)).unwrap();
    write(&paths[2], 24, 40, unorm(Depth::Bits16), CodesRef::U16(&words)).unwrap();
    let float = format(Encoding::Float, Depth::Float32, Channels::Xyz);
    write(&paths[3], 24, 40, float, CodesRef::F32(&floats)).unwrap();
    write(&paths[4], 24, 40, float, CodesRef::F32(&floats)).unwrap();

    let mut paths = paths.to_vec();
    for (name, kind) in [
        ("f.tga", image::ImageFormat::Tga),
        ("g.bmp", image::ImageFormat::Bmp),
        ("h.jpg", image::ImageFormat::Jpeg),
        ("i.webp", image::ImageFormat::WebP),
    ] {
        let path = folder.path(name);
        image::RgbImage::from_raw(24, 40, bytes.clone()).unwrap().save_with_format(&path, kind).unwrap();
        paths.push(path);
    }
    paths
}

/// A small file of each compression, of one channel.
fn grey_samples(folder: &Folder) -> Vec<PathBuf> {
    let (_, words, floats) = codes();
    let mut paths = Vec::new();
    for (name, compression, blocks) in [
        ("j.exr", Compression::PIZ, Blocks::ScanLines),
        ("k.exr", Compression::RLE, Blocks::Tiles(Vec2(16, 16))),
        ("l.exr", Compression::PXR24, Blocks::ScanLines),
        ("m.exr", Compression::B44, Blocks::ScanLines),
        ("q.exr", Compression::DWAA(None), Blocks::ScanLines),
    ] {
        let path = folder.path(name);
        save_exr(&path, &["Y"], &floats, compression, blocks);
        paths.push(path);
    }

    for (name, compression) in [
        ("n.tif", tiff::encoder::Compression::Deflate(tiff::encoder::DeflateLevel::Fast)),
        ("o.tif", tiff::encoder::Compression::Lzw),
        ("p.tif", tiff::encoder::Compression::Packbits),
    ] {
        let path = folder.path(name);
        let file = std::fs::File::create(&path).unwrap();
        let mut encoder = tiff::encoder::TiffEncoder::new(file).unwrap().with_compression(compression);
        encoder.write_image::<tiff::encoder::colortype::Gray16>(24, 40, &words[..24 * 40]).unwrap();
        paths.push(path);
    }
    paths
}

/// Channels of 24 x 40 texels, with the same floats.
fn save_exr(path: &Path, names: &[&str], floats: &[f32], compression: Compression, blocks: Blocks) {
    let channel = |name: &&str| AnyChannel::new(*name, FlatSamples::F32(floats[..24 * 40].to_vec()));
    let channels = AnyChannels::sort(names.iter().map(channel).collect());
    let encoding = ::exr::prelude::Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let layer = Layer::new((24, 40), LayerAttributes::named("l"), encoding, channels);
    Image::from_layer(layer).write().to_file(path).unwrap();
}

/// What is special in normal maps: signed codes, two channels, alpha that is left out, named channels, half floats.
fn normal_samples(folder: &Folder) -> Vec<PathBuf> {
    let (bytes, words, floats) = codes();
    let two = 24 * 40 * 2;
    let halves: Vec<f16> = floats.iter().map(|float| f16::from_f32(*float)).collect();
    let [snorm8, snorm16, half, rgba, named] =
        ["r.tif", "s.tif", "t.exr", "u.png", "v.exr"].map(|name| folder.path(name));
    write(&snorm8, 24, 40, format(Encoding::Snorm, Depth::Bits8, Channels::Xyz), CodesRef::U8(&bytes)).unwrap();
    let xy = format(Encoding::Snorm, Depth::Bits16, Channels::Xy);
    write(&snorm16, 24, 40, xy, CodesRef::U16(&words[..two])).unwrap();
    let xy = format(Encoding::Float, Depth::Float16, Channels::Xy);
    write(&half, 24, 40, xy, CodesRef::F16(&halves[..two])).unwrap();
    let file = std::fs::File::create(&rgba).unwrap();
    let mut encoder = png::Encoder::new(file, 24, 40);
    encoder.set_color(png::ColorType::Rgba);
    let texels: Vec<u8> = bytes.iter().cycle().take(24 * 40 * 4).copied().collect();
    encoder.write_header().unwrap().write_image_data(&texels).unwrap();
    save_exr(&named, &["n.X", "n.Y", "n.Z", "Y"], &floats, Compression::RLE, Blocks::Tiles(Vec2(16, 16)));
    vec![snorm8, snorm16, half, rgba, named]
}

/// What no encoder at hand writes: interlaced and 1-bit PNGs, palettes, TIFFs of tiles, planes and every sample type;
/// an EXR of two layers.
fn hand_made_samples(folder: &Folder) -> Vec<PathBuf> {
    let noise = |count: usize| {
        let mut noise = Noise(count as u64);
        (0..count).map(|_| noise.next() as u8).collect::<Vec<u8>>()
    };
    // Adam7's first pass of 1 x 1 texels, and its seven passes of 8 x 8.
    let passes = [(1, 1), (1, 1), (2, 1), (2, 2), (4, 2), (4, 4), (8, 4)];
    let interlaced: Vec<u8> = passes
        .iter()
        .flat_map(|&(width, rows)| (0..rows).flat_map(move |_| [vec![0], noise(2 * width)].concat()))
        .collect();
    let one_bit: Vec<u8> = (0..9).flat_map(|row| [0, row * 28, row * 31]).collect();
    let mut paths = vec![
        folder.file("interlaced.png", &hand_made(8, 8, 16, 0, 1, &interlaced)),
        folder.file("bits.png", &hand_made(12, 9, 1, 0, 0, &one_bit)),
    ];
    let palette = folder.path("palette.png");
    let mut encoder = png::Encoder::new(std::fs::File::create(&palette).unwrap(), 8, 3);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Four);
    encoder.set_palette(noise(3 * 16));
    encoder.set_trns(noise(5));
    encoder.write_header().unwrap().write_image_data(&noise(12)).unwrap();
    paths.push(palette);

    let tiled = Tiff { tile: Some((16, 16)), ..Tiff::grey(20, 18, 8, 1, (0..4).map(|_| noise(256)).collect()) };
    let planar = Tiff { samples: 3, photometric: 2, planar: true, ..Tiff::grey(4, 4, 16, 1, vec![]) };
    let planar = Tiff { chunks: (0..3).map(|_| noise(32)).collect(), rows_per_strip: 4, ..planar };
    let no_data = (42113, 2, 6, b"-9999\0".to_vec());
    let with_holes = Tiff { extra: vec![no_data], ..Tiff::grey(3, 2, 64, 3, vec![vec![0x40; 24], vec![0x3f; 24]]) };
    let half = Tiff::grey(3, 1, 16, 3, vec![vec![0x3c; 6]]);
    for (name, tiff) in
        [("tiled.tif", tiled), ("planar.tif", planar), ("doubles.tif", with_holes), ("halves.tif", half)]
    {
        paths.push(folder.file(name, &tiff.bytes()));
    }

    let layers = folder.path("layers.exr");
    let layer = |name: &str, channel: &str| {
        let channel = AnyChannel::new(channel, FlatSamples::F32(vec![1.5; 6]));
        let encoding = ::exr::prelude::Encoding {
            compression: Compression::ZIP1,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Decreasing,
        };
        let channels = AnyChannels::sort([channel].into_iter().collect());
        Layer::new((2, 3), LayerAttributes::named(name), encoding, channels)
    };
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions((2, 3)));
    let image = Image::empty(attributes).with_layer(layer("first", "Q")).with_layer(layer("second", "Z"));
    image.write().to_file(&layers).unwrap();
    paths.push(layers);
    paths
}
