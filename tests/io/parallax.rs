//! Parallax maps out: one channel, read back by the formats' own crates; and in.

use super::support::{Folder, Noise, write_rows};
use ::exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use half::f16;
use png::{BitDepth, ColorType};
use std::path::Path;
use texbake::io::{ParallaxReadOptions, create_normals, create_parallax, default_parallax_format};
use texbake::{Codes, CodesRef, Depth, Encoding, NormalFormat, ParallaxFormat, ParallaxMap, Size};
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

fn format(encoding: Encoding, depth: Depth) -> ParallaxFormat {
    ParallaxFormat { encoding, depth }
}

/// Writes a map row by row.
fn write(path: &Path, width: usize, height: usize, format: ParallaxFormat, codes: CodesRef) {
    let sink = create_parallax(path, Size::new(width, height).unwrap(), format).unwrap();
    write_rows(sink, 0..height, codes, width).unwrap();
}

/// Width, height, colour type, bit depth and bytes of a PNG.
fn decode_png(path: &Path) -> (u32, u32, ColorType, BitDepth, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    reader.finish().unwrap();
    (info.width, info.height, info.color_type, info.bit_depth, bytes)
}

/// Samples per texel, bits, sample format, photometric interpretation and samples of a TIFF.
fn decode_tiff(path: &Path) -> ([u16; 4], DecodingResult) {
    let mut decoder = Decoder::new(std::fs::File::open(path).unwrap()).unwrap();
    assert_eq!(decoder.find_tag(Tag::ExtraSamples).unwrap(), None);
    let tags = [Tag::SamplesPerPixel, Tag::BitsPerSample, Tag::SampleFormat, Tag::PhotometricInterpretation];
    let tags = tags.map(|tag| match decoder.get_tag_u16_vec(tag).unwrap()[..] {
        [value] => value,
        ref values => panic!("one value was expected: {values:?}"),
    });
    (tags, decoder.read_image().unwrap())
}

/// Names and samples of a file's only layer.
fn decode_exr(path: &Path) -> Vec<(String, FlatSamples)> {
    let image = ::exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = image.all_attributes().pedantic().from_file(path).unwrap();
    let channels = image.layer_data.channel_data.list.into_iter();
    channels.map(|channel| (channel.name.to_string(), channel.sample_data)).collect()
}

#[test]
fn png_is_grey() {
    let folder = Folder::new();
    let path = folder.path("p.png");
    let codes = [1, 127, 128, 129, 255, 64];
    write(&path, 2, 3, format(Encoding::Biased, Depth::Bits8), CodesRef::U8(&codes));
    assert_eq!(decode_png(&path), (2, 3, ColorType::Grayscale, BitDepth::Eight, codes.to_vec()));
    write(&path, 3, 2, format(Encoding::Unorm, Depth::Bits8), CodesRef::U8(&codes));
    assert_eq!(decode_png(&path), (3, 2, ColorType::Grayscale, BitDepth::Eight, codes.to_vec()));
    let words = [0x8000, 0x0102, 0xfffe, 0x1234];
    write(&path, 1, 4, format(Encoding::Biased, Depth::Bits16), CodesRef::U16(&words));
    let bytes = vec![0x80, 0, 1, 2, 0xff, 0xfe, 0x12, 0x34];
    assert_eq!(decode_png(&path), (1, 4, ColorType::Grayscale, BitDepth::Sixteen, bytes));
    // One texel, and rows of many chunks, that hardly deflate.
    write(&path, 1, 1, format(Encoding::Biased, Depth::Bits8), CodesRef::U8(&[200]));
    assert_eq!(decode_png(&path), (1, 1, ColorType::Grayscale, BitDepth::Eight, vec![200]));
    let mut noise = Noise(23);
    let codes: Vec<u8> = (0..1500 * 701).map(|_| noise.next() as u8).collect();
    write(&path, 1500, 701, format(Encoding::Biased, Depth::Bits8), CodesRef::U8(&codes));
    assert_eq!(decode_png(&path).4, codes);
}

#[test]
fn tiff_has_one_sample_signed_or_not() {
    let folder = Folder::new();
    let path = folder.path("p.tif");
    let codes = [0x81, 0xff, 0, 1, 0x7f, 5];
    write(&path, 2, 3, format(Encoding::Snorm, Depth::Bits8), CodesRef::U8(&codes));
    let (tags, image) = decode_tiff(&path);
    assert_eq!(tags, [1, 8, 2, 1]);
    assert!(matches!(image, DecodingResult::I8(found) if found == [-127, -1, 0, 1, 127, 5]));
    write(&path, 3, 2, format(Encoding::Biased, Depth::Bits8), CodesRef::U8(&codes));
    let (tags, image) = decode_tiff(&path);
    assert_eq!(tags, [1, 8, 1, 1]);
    assert!(matches!(image, DecodingResult::U8(found) if found == codes));

    let words = [0x8001, 0xffff, 0, 0x7fff];
    write(&path, 4, 1, format(Encoding::Snorm, Depth::Bits16), CodesRef::U16(&words));
    let (tags, image) = decode_tiff(&path);
    assert_eq!(tags, [1, 16, 2, 1]);
    assert!(matches!(image, DecodingResult::I16(found) if found == [-32767, -1, 0, 32767]));
    write(&path, 1, 4, format(Encoding::Unorm, Depth::Bits16), CodesRef::U16(&words));
    let (tags, image) = decode_tiff(&path);
    assert_eq!(tags, [1, 16, 1, 1]);
    assert!(matches!(image, DecodingResult::U16(found) if found == words));

    let floats = [0.25, -1.0, 1e-40];
    write(&path, 3, 1, format(Encoding::Float, Depth::Float32), CodesRef::F32(&floats));
    let (tags, image) = decode_tiff(&path);
    assert_eq!(tags, [1, 32, 3, 1]);
    assert!(matches!(image, DecodingResult::F32(found) if found == floats));
}

#[test]
fn exr_has_the_channel_y() {
    let folder = Folder::new();
    let path = folder.path("p.exr");
    let mut noise = Noise(29);
    // 41 rows of 5 texels: two blocks of 16 lines, and one of 9.
    let floats: Vec<f32> = (0..5 * 41).map(|_| noise.next() as f32).collect();
    write(&path, 5, 41, format(Encoding::Float, Depth::Float32), CodesRef::F32(&floats));
    assert_eq!(decode_exr(&path), [("Y".to_string(), FlatSamples::F32(floats))]);
    let halves = [0.5, -0.25, 1.0, -0.0].map(f16::from_f32);
    write(&path, 2, 2, format(Encoding::Float, Depth::Float16), CodesRef::F16(&halves));
    assert_eq!(decode_exr(&path), [("Y".to_string(), FlatSamples::F16(halves.to_vec()))]);
}

/// The same file, whether row 0 comes first or last.
#[test]
fn the_first_row_may_come_last() {
    let folder = Folder::new();
    let (size, row) = (Size::new(41, 6).unwrap(), 41);
    for (extension, encoding, depth) in [
        ("png", Encoding::Biased, Depth::Bits8),
        ("png", Encoding::Biased, Depth::Bits16),
        ("tif", Encoding::Snorm, Depth::Bits8),
        ("tif", Encoding::Float, Depth::Float32),
    ] {
        let codes: Vec<u8> = (0..41 * 6 * depth.bytes() as u32).map(|i| (i * i % 251) as u8).collect();
        let codes = match depth {
            Depth::Bits8 => Codes::U8(codes),
            Depth::Bits16 => Codes::U16(codes.chunks(2).map(|code| u16::from_be_bytes([code[0], code[1]])).collect()),
            _ => Codes::F32(codes.chunks(4).map(|code| f32::from(code[0]) - 77.5).collect()),
        };
        let file = |name: &str, order: &[usize]| {
            let path = folder.path(&std::format!("{name}.{extension}"));
            let sink = create_parallax(&path, size, format(encoding, depth)).unwrap();
            assert!(sink.takes_first_row_last());
            write_rows(sink, order.iter().copied(), codes.as_ref(), row).unwrap();
            std::fs::read(path).unwrap()
        };
        assert_eq!(file("late", &[1, 2, 3, 4, 5, 0]), file("top", &[0, 1, 2, 3, 4, 5]), "{extension} {depth}");
        let bytes = codes.as_ref().bytes();
        match (extension, depth) {
            ("png", Depth::Bits8) => assert_eq!(decode_png(&folder.path("late.png")).4, bytes),
            ("tif", Depth::Bits8) => {
                let image = decode_tiff(&folder.path("late.tif")).1;
                assert!(
                    matches!(image, DecodingResult::I8(found) if found.iter().map(|v| *v as u8).eq(bytes.to_vec()))
                );
            }
            _ => (),
        }
    }
}

#[test]
fn each_extension_has_its_usual_format() {
    let usual = |name: &str| default_parallax_format(Path::new(name));
    assert_eq!(usual("p.png").unwrap(), format(Encoding::Biased, Depth::Bits8));
    assert_eq!(usual("p.TIF").unwrap(), format(Encoding::Snorm, Depth::Bits8));
    assert_eq!(usual("p.tiff").unwrap(), format(Encoding::Snorm, Depth::Bits8));
    assert_eq!(usual("p.exr").unwrap(), format(Encoding::Float, Depth::Float32));
    assert!(usual("p.jpg").unwrap_err().to_string().contains("texbake writes .png, .tif, .tiff, .exr, .ktx2 and .dds"));
    let folder = Folder::new();
    for (name, codes) in [("p.png", Codes::U8(vec![128, 1])), ("p.tif", Codes::U8(vec![0, 0x81]))] {
        let map = ParallaxMap::new(Size::new(1, 2).unwrap(), usual(name).unwrap(), codes).unwrap();
        map.write(folder.path(name)).unwrap();
    }
    assert_eq!(decode_png(&folder.path("p.png")).4, [128, 1]);
    assert!(matches!(decode_tiff(&folder.path("p.tif")).1, DecodingResult::I8(found) if found == [0, -127]));
}

#[test]
fn what_a_format_cannot_hold_is_refused_before_a_file_is_made() {
    let folder = Folder::new();
    for (name, encoding, depth, expected) in [
        (
            "p.png",
            Encoding::Snorm,
            Depth::Bits8,
            "encoding is snorm with 8 bits, for p.png: it must be biased in PNG, which has no signed numbers; \
             TIFF has them",
        ),
        (
            "p.png",
            Encoding::Float,
            Depth::Float32,
            "encoding is float with 32f bits, for p.png: it must be unorm or biased with 8 or 16 bits in PNG; \
             EXR and TIFF hold floats",
        ),
        (
            "p.tif",
            Encoding::Float,
            Depth::Float16,
            "encoding is float with 16f bits, for p.tif: it must be float with 32f bits in TIFF; EXR holds 16f",
        ),
        (
            "p.exr",
            Encoding::Snorm,
            Depth::Bits8,
            "encoding is snorm with 8 bits, for p.exr: it must be float with 16f or 32f bits in EXR; \
             PNG and TIFF hold integers",
        ),
        (
            "p.tif",
            Encoding::Snorm,
            Depth::Float32,
            "bits is 32f: it must be 8 or 16 for the encodings unorm, snorm and biased",
        ),
    ] {
        let error = create_parallax(&folder.path(name), Size::new(1, 1).unwrap(), format(encoding, depth));
        assert_eq!(error.err().unwrap().to_string(), expected);
    }
    assert_eq!(folder.names(), Vec::<String>::new());
}

fn read_as(path: &Path, encoding: Option<Encoding>) -> texbake::Result<ParallaxMap> {
    ParallaxMap::read_with(path, &ParallaxReadOptions { encoding, ..Default::default() }).map(|(map, _)| map)
}

/// Each format comes back as it was written; without a word by what the samples are.
#[test]
fn what_was_written_is_read() {
    let folder = Folder::new();
    let size = Size::new(3, 2).unwrap();
    let bytes = || Codes::U8(vec![1, 0x7f, 0x81, 0xff, 0, 64]);
    let words = || Codes::U16(vec![1, 0x7fff, 0x8001, 0xffff, 0, 0x1234]);
    for (name, encoding, depth, codes, usual) in [
        ("p.png", Encoding::Biased, Depth::Bits8, bytes(), Encoding::Biased),
        ("p.png", Encoding::Unorm, Depth::Bits16, words(), Encoding::Biased),
        ("p.tif", Encoding::Biased, Depth::Bits16, words(), Encoding::Biased),
        ("p.tif", Encoding::Unorm, Depth::Bits8, bytes(), Encoding::Biased),
        ("p.tif", Encoding::Snorm, Depth::Bits8, bytes(), Encoding::Snorm),
        ("p.tif", Encoding::Snorm, Depth::Bits16, words(), Encoding::Snorm),
        ("p.exr", Encoding::Float, Depth::Float32, Codes::F32(vec![0.1, -1.0, 1e-40, 1.0, 0.0, -0.5]), Encoding::Float),
    ] {
        let path = folder.path(name);
        let map = ParallaxMap::new(size, format(encoding, depth), codes.clone()).unwrap();
        map.write(&path).unwrap();
        assert_eq!(read_as(&path, Some(encoding)).unwrap(), map, "{name} {encoding} {depth}");
        let read = ParallaxMap::read(&path).unwrap();
        assert_eq!(read, ParallaxMap::new(size, format(usual, depth), codes).unwrap(), "{name} {encoding} {depth}");
    }
    // Half floats are floats, exactly.
    let halves = [0.5, -0.25, 1.0, 0.1].map(f16::from_f32);
    let path = folder.path("half.exr");
    write(&path, 2, 2, format(Encoding::Float, Depth::Float16), CodesRef::F16(&halves));
    let read = ParallaxMap::read(&path).unwrap();
    assert_eq!(read.format(), format(Encoding::Float, Depth::Float32));
    assert_eq!(read.codes(), CodesRef::F32(&halves.map(f16::to_f32)));
}

#[test]
fn what_is_no_parallax_map_is_refused() {
    let folder = Folder::new();
    let (png, tif, exr) = (folder.path("p.png"), folder.path("p.tif"), folder.path("p.exr"));
    write(&png, 1, 1, format(Encoding::Biased, Depth::Bits8), CodesRef::U8(&[5]));
    write(&tif, 1, 1, format(Encoding::Snorm, Depth::Bits8), CodesRef::U8(&[5]));
    write(&exr, 2, 1, format(Encoding::Float, Depth::Float32), CodesRef::F32(&[0.0, f32::NAN]));
    let refused = |path: &Path, encoding| read_as(path, encoding).unwrap_err().to_string();
    for (path, asked, expected) in [
        (&png, Encoding::Snorm, "snorm, for p.png: it must be biased or unorm: the file holds unsigned integers"),
        (&tif, Encoding::Biased, "biased, for p.tif: it must be snorm: the file holds signed integers"),
        (&exr, Encoding::Unorm, "unorm, for p.exr: it must be float: the file holds floats"),
    ] {
        assert_eq!(refused(path, Some(asked)), std::format!("encoding is {expected}"));
    }
    let remedy = "give a parallax map, or bake one from the heights with texbake parallax";
    assert!(refused(&exr, None).ends_with(&std::format!("the texel at column 1, row 0 is NaN; {remedy}")));
    let normals = folder.path("n.png");
    let mut sink = create_normals(&normals, Size::new(1, 1).unwrap(), NormalFormat::default()).unwrap();
    sink.write(0, CodesRef::U8(&[128, 128, 255])).unwrap();
    sink.finish().unwrap();
    assert!(refused(&normals, None).ends_with(&std::format!("row 0: 128, 128, 255; {remedy}")));
    // A map that needs more than it may.
    let small = ParallaxReadOptions { max_bytes: 7, ..Default::default() };
    assert!(matches!(
        ParallaxMap::read_with(&exr, &small),
        Err(texbake::Error::TooLarge { .. } | texbake::Error::File { .. })
    ));
    assert!(ParallaxMap::read(folder.path("gone.png")).unwrap_err().to_string().contains("gone.png"));
}
