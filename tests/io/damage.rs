//! Damaged files of every format: an answer or a reason, never a panic.

use super::support::{Folder, Noise, format, write};
use ::exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, FlatSamples, Image, Layer, LayerAttributes, LineOrder, Vec2,
    WritableImage,
};
use half::f16;
use std::panic::RefUnwindSafe;
use std::path::{Path, PathBuf};
use texbake::io::{NormalReadOptions, ReadOptions};
use texbake::{Channels, CodesRef, Depth, Encoding, Error, HeightMap, NormalMap};

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

/// Variants of a file: bytes replaced, mostly in its first part, where sizes and offsets stand; cut; grown.
fn variant(whole: &[u8], noise: &mut Noise) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let edits = 1 + noise.next() % 4;
    for _ in 0..edits {
        let reach = if noise.next().is_multiple_of(3) { bytes.len() } else { bytes.len().min(400) };
        let at = noise.next() as usize % reach;
        bytes[at] = match noise.next() % 4 {
            0 => 0,
            1 => 0xff,
            2 => bytes[at] ^ 1 << (noise.next() % 8),
            _ => noise.next() as u8,
        };
    }
    if noise.next().is_multiple_of(8) {
        bytes.truncate(noise.next() as usize % bytes.len());
    }
    bytes
}

/// Variants per file; more are tried with TEXBAKE_DAMAGE=n.
pub fn variants() -> u32 {
    std::env::var("TEXBAKE_DAMAGE").ok().and_then(|count| count.parse().ok()).unwrap_or(1000)
}

/// Small enough that a file that claims more is refused, not tried.
pub const MAX_BYTES: u64 = 64 << 20;

#[test]
fn damaged_height_maps_never_panic() {
    let folder = Folder::new();
    let options = ReadOptions { max_bytes: MAX_BYTES, channel: Some("r".parse().unwrap()), ..Default::default() };
    let samples = [colour_samples(&folder), grey_samples(&folder)].concat();
    assert_no_panic(&samples, |path| HeightMap::read_with(path, &options).map(|_| ()));
}

#[test]
fn damaged_normal_maps_never_panic() {
    let folder = Folder::new();
    let options = NormalReadOptions { max_bytes: MAX_BYTES, ..Default::default() };
    let samples = [colour_samples(&folder), normal_samples(&folder)].concat();
    assert_no_panic(&samples, |path| NormalMap::read_with(path, &options).map(|_| ()));
}

/// Reads variants of each file.
pub fn assert_no_panic(samples: &[PathBuf], read_file: impl Fn(&Path) -> Result<(), Error> + RefUnwindSafe) {
    for path in samples {
        let whole = std::fs::read(path).unwrap();
        read_file(path).expect("undamaged, the file reads");
        let mut noise = Noise(whole.len() as u64);
        let (mut read, mut refused) = (0, 0);
        for _ in 0..variants() {
            let bytes = variant(&whole, &mut noise);
            // A file that is cut and written again goes to the disk at once; a new one does not.
            std::fs::remove_file(path).unwrap();
            std::fs::write(path, &bytes).unwrap();
            let result = std::panic::catch_unwind(|| read_file(path));
            match result {
                Ok(Ok(())) => read += 1,
                Ok(Err(error)) => {
                    assert!(!error.to_string().is_empty());
                    refused += 1;
                }
                Err(_) => {
                    let kept = std::env::temp_dir().join(path.file_name().unwrap());
                    std::fs::write(&kept, &bytes).unwrap();
                    panic!("{} panicked; the file is {}", path.display(), kept.display());
                }
            }
        }
        assert!(refused > 0, "{}: {read} variants read, none was refused", path.display());
    }
}
