//! Damaged files of every format: an answer or a reason, never a panic.

use super::support::{Folder, Noise, format, write};
use ::exr::prelude::WritableImage;
use std::path::PathBuf;
use texbake::io::ReadOptions;
use texbake::{Channels, CodesRef, Depth, Encoding, HeightMap};

/// A small file of each format and kind.
fn samples(folder: &Folder) -> Vec<PathBuf> {
    let mut noise = Noise(11);
    let bytes: Vec<u8> = (0..24 * 40 * 3).map(|_| noise.next() as u8 & 0x3f).collect();
    let words: Vec<u16> = bytes.iter().map(|byte| u16::from(*byte) * 999).collect();
    let floats: Vec<f32> = bytes.iter().map(|byte| f32::from(*byte)).collect();
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

    use ::exr::prelude::{AnyChannel, AnyChannels, Blocks, Compression, FlatSamples, Image, Layer, LayerAttributes};
    for (name, compression, blocks) in [
        ("j.exr", Compression::PIZ, Blocks::ScanLines),
        ("k.exr", Compression::RLE, Blocks::Tiles(::exr::prelude::Vec2(16, 16))),
        ("l.exr", Compression::PXR24, Blocks::ScanLines),
        ("m.exr", Compression::B44, Blocks::ScanLines),
        ("q.exr", Compression::DWAA(None), Blocks::ScanLines),
    ] {
        let channel = AnyChannel::new("Y", FlatSamples::F32(floats[..24 * 40].to_vec()));
        let encoding =
            ::exr::prelude::Encoding { compression, blocks, line_order: ::exr::prelude::LineOrder::Increasing };
        let channels = AnyChannels::sort([channel].into_iter().collect());
        let layer = Layer::new((24, 40), LayerAttributes::named("l"), encoding, channels);
        let path = folder.path(name);
        Image::from_layer(layer).write().to_file(&path).unwrap();
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
fn variants() -> u32 {
    std::env::var("TEXBAKE_DAMAGE").ok().and_then(|count| count.parse().ok()).unwrap_or(1000)
}

#[test]
fn damage_never_panics() {
    let folder = Folder::new();
    // Small enough that a file that claims more is refused, not tried.
    let options = ReadOptions { max_bytes: 64 << 20, channel: Some("r".parse().unwrap()), ..Default::default() };
    for path in samples(&folder) {
        let whole = std::fs::read(&path).unwrap();
        HeightMap::read_with(&path, &options).expect("undamaged, the file reads");
        let mut noise = Noise(whole.len() as u64);
        let (mut read, mut refused) = (0, 0);
        for _ in 0..variants() {
            let bytes = variant(&whole, &mut noise);
            // A file that is cut and written again goes to the disk at once; a new one does not.
            std::fs::remove_file(&path).unwrap();
            std::fs::write(&path, &bytes).unwrap();
            let result = std::panic::catch_unwind(|| HeightMap::read_with(&path, &options).map(|_| ()));
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
