//! Normal maps in: what each file's codes mean, and the way there and back.

use super::hand_made_tiff::Tiff;
use super::support::{Folder, Noise, format, normals_error, read_normals_all_ways};
use crate::support::FORMATS;
use ::exr::prelude::{
    AnyChannel, AnyChannels, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes, WritableImage,
};
use half::f16;
use std::path::{Path, PathBuf};
use texbake::io::{NormalFile, NormalReadOptions, open_normals};
use texbake::{Channels, Codes, CodesMut, CodesRef, Convention, Depth, Encoding, NormalMap, Size};

fn default() -> NormalReadOptions {
    NormalReadOptions::default()
}

fn encoding(encoding: Encoding) -> NormalReadOptions {
    NormalReadOptions { encoding: Some(encoding), ..default() }
}

fn channels(channels: Channels) -> NormalReadOptions {
    NormalReadOptions { channels: Some(channels), ..default() }
}

/// A PNG file of these rows.
fn png(folder: &Folder, size: [u32; 2], colour: png::ColorType, depth: png::BitDepth, rows: &[u8]) -> PathBuf {
    let path = folder.path("n.png");
    let mut encoder = png::Encoder::new(std::fs::File::create(&path).unwrap(), size[0], size[1]);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(rows).unwrap();
    path
}

/// An EXR file of one layer for each list of channels, two texels in a row.
fn exr(folder: &Folder, layers: &[&[(&str, [f32; 2])]]) -> PathBuf {
    let path = folder.path("n.exr");
    let layer = |(index, named): (usize, &&[(&str, [f32; 2])])| {
        let channel = |(name, values): &(&str, [f32; 2])| AnyChannel::new(*name, FlatSamples::F32(values.to_vec()));
        let channels = AnyChannels::sort(named.iter().map(channel).collect());
        let attributes = LayerAttributes::named(std::format!("layer {index}").as_str());
        Layer::new((2, 1), attributes, ::exr::prelude::Encoding::FAST_LOSSLESS, channels)
    };
    let layers: Vec<_> = layers.iter().enumerate().map(layer).collect();
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions((2, 1)));
    Image::from_layers(attributes, layers).write().to_file(&path).unwrap();
    path
}

/// A TIFF of one strip, bits and kind (1 unsigned, 2 signed, 3 float) of each sample.
fn tiff(folder: &Folder, size: [u32; 2], samples: u16, bits: u16, kind: u16, strip: Vec<u8>) -> PathBuf {
    let photometric = if samples == 3 { 2 } else { 1 };
    let tiff = Tiff { samples, photometric, ..Tiff::grey(size[0], size[1], bits, kind, vec![strip]) };
    folder.file("n.tif", &tiff.bytes())
}

/// Asserts that a file reads, in every way, as these codes and what they mean.
fn assert_reads(path: &Path, options: &NormalReadOptions, encoding: Encoding, of: Channels, codes: CodesRef<'_>) {
    let map = read_normals_all_ways(path, options).unwrap();
    assert_eq!(map.format(), format(encoding, codes.depth(), of));
    assert_eq!(map.codes(), codes);
}

#[test]
fn png_is_unorm_unless_it_is_said_to_be_biased() {
    use Channels::{Xy, Xyz};
    use png::{BitDepth, ColorType};
    let folder = Folder::new();
    let texels = [1, 2, 3, 250, 128, 0, 7, 8, 9, 255, 254, 253];
    let path = png(&folder, [2, 2], ColorType::Rgb, BitDepth::Eight, &texels);
    assert_reads(&path, &default(), Encoding::Unorm, Xyz, CodesRef::U8(&texels));
    assert_reads(&path, &encoding(Encoding::Biased), Encoding::Biased, Xyz, CodesRef::U8(&texels));
    let xy = [1, 2, 250, 128, 7, 8, 255, 254];
    assert_reads(&path, &channels(Xy), Encoding::Unorm, Xy, CodesRef::U8(&xy));
    let down = NormalReadOptions { convention: Convention::Dx, ..default() };
    assert_eq!(NormalMap::read_with(&path, &down).unwrap().0.format().convention, Convention::Dx);
    assert_eq!(NormalMap::read(&path).unwrap().format().convention, Convention::Gl);

    let wide = [0x12, 0x34, 0, 1, 0xff, 0xfe, 0x80, 0, 0x7f, 0xff, 0, 0];
    let path = png(&folder, [2, 1], ColorType::Rgb, BitDepth::Sixteen, &wide);
    let words = [0x1234, 1, 0xfffe, 0x8000, 0x7fff, 0];
    assert_reads(&path, &default(), Encoding::Unorm, Xyz, CodesRef::U16(&words));
    assert_reads(&path, &channels(Xy), Encoding::Unorm, Xy, CodesRef::U16(&[0x1234, 1, 0x8000, 0x7fff]));

    let texels = [1, 2, 3, 0, 4, 5, 6, 99];
    let path = png(&folder, [1, 2], ColorType::Rgba, BitDepth::Eight, &texels);
    assert_reads(&path, &default(), Encoding::Unorm, Xyz, CodesRef::U8(&[1, 2, 3, 4, 5, 6]));
    assert_reads(&path, &channels(Xy), Encoding::Unorm, Xy, CodesRef::U8(&[1, 2, 4, 5]));
}

#[test]
fn one_channel_is_no_normal_map() {
    use png::{BitDepth, ColorType};
    let folder = Folder::new();
    let path = png(&folder, [2, 1], ColorType::Grayscale, BitDepth::Eight, &[1, 2]);
    for options in [default(), channels(Channels::Xy)] {
        let message = normals_error(&path, &options);
        assert!(message.contains("it has one channel: a height map?; give a normal map, or bake one"), "{message}");
    }
    let path = png(&folder, [2, 1], ColorType::GrayscaleAlpha, BitDepth::Eight, &[1, 2, 3, 4]);
    let message = normals_error(&path, &default());
    assert!(
        message.contains("one channel and alpha: a height map?; if they hold x and y, read it with --channels xy"),
        "{message}"
    );
    assert_reads(&path, &channels(Channels::Xy), Encoding::Unorm, Channels::Xy, CodesRef::U8(&[1, 2, 3, 4]));

    let path = tiff(&folder, [1, 1], 2, 8, 1, vec![1, 2]);
    let message = normals_error(&path, &channels(Channels::Xyz));
    assert!(message.contains("it has two channels, and no z; read it with --channels xy"), "{message}");
}

#[test]
fn tiff_says_whether_its_integers_are_signed() {
    use Channels::{Xy, Xyz};
    let folder = Folder::new();
    let signed = [-128i8, -127, -1, 0, 1, 127].map(|v| v as u8);
    let path = tiff(&folder, [2, 1], 3, 8, 2, signed.to_vec());
    assert_reads(&path, &default(), Encoding::Snorm, Xyz, CodesRef::U8(&[0x80, 0x81, 0xff, 0, 1, 0x7f]));
    assert_reads(&path, &encoding(Encoding::Snorm), Encoding::Snorm, Xyz, CodesRef::U8(&signed));
    for wrong in [Encoding::Unorm, Encoding::Biased, Encoding::Float] {
        let expected = std::format!("encoding is {wrong}, for n.tif: it must be snorm: the file holds signed integers");
        assert_eq!(normals_error(&path, &encoding(wrong)), expected);
    }
    let wide = [-32768i16, 32767, -2, 3].map(|v| v as u16);
    let path = tiff(&folder, [1, 2], 2, 16, 2, wide.iter().flat_map(|v| v.to_le_bytes()).collect());
    assert_reads(&path, &default(), Encoding::Snorm, Xy, CodesRef::U16(&[0x8000, 0x7fff, 0xfffe, 3]));

    let path = tiff(&folder, [1, 2], 2, 16, 1, wide.iter().flat_map(|v| v.to_le_bytes()).collect());
    assert_reads(&path, &default(), Encoding::Unorm, Xy, CodesRef::U16(&wide));
    assert_reads(&path, &encoding(Encoding::Biased), Encoding::Biased, Xy, CodesRef::U16(&wide));
    for wrong in [Encoding::Snorm, Encoding::Float] {
        let expected = "it must be unorm or biased: the file holds unsigned integers";
        assert!(normals_error(&path, &encoding(wrong)).ends_with(expected), "{wrong}");
    }
    // Four samples without a meaning: the first three.
    let path = tiff(&folder, [2, 1], 4, 8, 1, (0..8).collect());
    assert_reads(&path, &default(), Encoding::Unorm, Xyz, CodesRef::U8(&[0, 1, 2, 4, 5, 6]));
}

#[test]
fn samples_in_planes_are_brought_together() {
    let folder = Folder::new();
    let planes = vec![vec![1, 2], vec![11, 12], vec![0x81, 0x82]];
    let tiff = Tiff { samples: 3, photometric: 2, planar: true, rows_per_strip: 1, ..Tiff::grey(2, 1, 8, 2, planes) };
    let path = folder.file("p.tif", &tiff.bytes());
    assert_reads(&path, &default(), Encoding::Snorm, Channels::Xyz, CodesRef::U8(&[1, 11, 0x81, 2, 12, 0x82]));
}

#[test]
fn floats_pass_as_they_are() {
    let folder = Folder::new();
    let floats = [0.25, -0.0, f32::NAN, f32::INFINITY, -1e30, f32::MIN_POSITIVE / 2.0];
    let path = tiff(&folder, [2, 1], 3, 32, 3, floats.iter().flat_map(|v| v.to_le_bytes()).collect());
    let map = read_normals_all_ways(&path, &default()).unwrap();
    assert_eq!(map.format(), format(Encoding::Float, Depth::Float32, Channels::Xyz));
    assert_eq!(map.codes().bytes(), CodesRef::F32(&floats).bytes());
    for wrong in [Encoding::Snorm, Encoding::Biased] {
        let expected = std::format!(
            "encoding is {wrong}, for n.tif: it must be float, or unorm if they lie between 0 and 1: the file holds floats"
        );
        assert_eq!(normals_error(&path, &encoding(wrong)), expected);
    }
    // Halves become the same floats, doubles the nearest: 0x2e66 is 1638 / 16384.
    let halves = [0x2e66u16, 0x8000, 0x3c00].iter().flat_map(|v| v.to_le_bytes()).collect();
    let path = tiff(&folder, [1, 1], 3, 16, 3, halves);
    assert_reads(&path, &default(), Encoding::Float, Channels::Xyz, CodesRef::F32(&[1638.0 / 16384.0, 0.0, 1.0]));
    let path = tiff(&folder, [1, 1], 2, 64, 3, [0.1f64, -7.5].iter().flat_map(|v| v.to_le_bytes()).collect());
    assert_reads(&path, &default(), Encoding::Float, Channels::Xy, CodesRef::F32(&[0.1, -7.5]));
    assert_eq!(open_normals(&path, &default()).unwrap().warnings, ["its 64-bit floats are rounded to 32 bits"]);
}

#[test]
fn floats_between_0_and_1_may_be_read_as_unorm() {
    let folder = Folder::new();
    // 0.1 is 13421773 / 2^27, of which 2v - 1 is -13421772.75 / 2^24, to be rounded; beyond [0, 1] it goes on.
    let floats = [0.5, 0.75, 1.0, 0.1, 0.0, 1.5];
    let components = CodesRef::F32(&[0.0, 0.5, 1.0, -13_421_773.0 / 16_777_216.0, -1.0, 2.0]);
    let path = tiff(&folder, [2, 1], 3, 32, 3, floats.iter().flat_map(|v: &f32| v.to_le_bytes()).collect());
    assert_reads(&path, &encoding(Encoding::Unorm), Encoding::Float, Channels::Xyz, components);
    let layer: &[_] = &[("R", [0.5f32, 0.1]), ("G", [0.75, 0.0]), ("B", [1.0, 1.5])];
    let path = exr(&folder, &[layer]);
    assert_reads(&path, &encoding(Encoding::Unorm), Encoding::Float, Channels::Xyz, components);
    // Two of three samples.
    let two = NormalReadOptions { channels: Some(Channels::Xy), ..encoding(Encoding::Unorm) };
    let components = CodesRef::F32(&[0.0, 0.5, -13_421_773.0 / 16_777_216.0, -1.0]);
    assert_reads(&path, &two, Encoding::Float, Channels::Xy, components);
}

#[test]
fn exr_channels_go_by_their_names() {
    use Channels::{Xy, Xyz};
    let folder = Folder::new();
    let [one, two, three, other] = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0], [7.0, 8.0]];
    let reads = |layers: &[&[(&str, [f32; 2])]], options: &NormalReadOptions, of, codes: &[f32]| {
        assert_reads(&exr(&folder, layers), options, Encoding::Float, of, CodesRef::F32(codes));
    };
    let (xyz, xy) = ([1.0, 3.0, 5.0, 2.0, 4.0, 6.0], [1.0, 3.0, 2.0, 4.0]);
    let rgb: &[_] = &[("R", one), ("G", two), ("B", three), ("A", other)];
    reads(&[rgb], &default(), Xyz, &xyz);
    reads(&[rgb], &channels(Xyz), Xyz, &xyz);
    reads(&[rgb], &channels(Xy), Xy, &xy);
    reads(&[&[("x", one), ("Y", two), ("z", three)]], &default(), Xyz, &xyz);
    reads(&[&[("G", two), ("R", one)]], &default(), Xy, &xy);
    reads(&[&[("Y", two), ("X", one)]], &channels(Xy), Xy, &xy);
    // A picture with its normals: components go before colours.
    let colours = [("C.R", other), ("C.G", other), ("C.B", other)];
    reads(&[&[&colours[..], &[("N.X", one), ("N.Y", two), ("N.Z", three)]].concat()], &default(), Xyz, &xyz);
    // Names without a prefix go before others.
    reads(&[&[&colours[..], &[("r", one), ("g", two), ("b", three)]].concat()], &default(), Xyz, &xyz);
    // The first layer that has them.
    reads(&[&[("Z", other)], &[("R", one), ("G", two), ("B", three)]], &default(), Xyz, &xyz);

    let refused =
        |layers: &[&[(&str, [f32; 2])]], options: &NormalReadOptions| normals_error(&exr(&folder, layers), options);
    let message = refused(&[&[("Y", one)]], &default());
    assert!(message.contains("it is not clear which of its channels hold the normals: Y; name them R, G"), "{message}");
    let message = refused(&[&[("R", one), ("G", two)]], &channels(Xyz));
    assert!(message.contains("which of its channels hold the normals: G, R"), "{message}");
    let message = refused(&[&[("R", one), ("B", two)], &[("Y", one)]], &channels(Xy));
    assert!(message.contains("which of its channels hold x and y: B, R, Y; name them R and G or X and Y"), "{message}");
    // Two normals, and colours beside them, which are none.
    let twice = [("M.X", one), ("M.Y", two), ("M.Z", three), ("N.X", one), ("N.Y", two), ("N.Z", three)];
    let message = refused(&[&[&colours[..], &twice].concat()], &default());
    assert!(message.contains("not clear which of its channels hold the normals: C.B, C.G, C.R, M.X"), "{message}");
    let message = refused(&[rgb], &encoding(Encoding::Snorm));
    assert!(message.starts_with("encoding is snorm, for n.exr: it must be float, or unorm "), "{message}");
}

#[test]
fn tga_bmp_and_webp_are_unorm() {
    let folder = Folder::new();
    let codes: Vec<u8> = (0..24).map(|i| i * 10).collect();
    let image = image::RgbImage::from_raw(4, 2, codes.clone()).unwrap();
    for name in ["n.tga", "n.bmp", "n.webp"] {
        let path = folder.path(name);
        image.save(&path).unwrap();
        assert_reads(&path, &default(), Encoding::Unorm, Channels::Xyz, CodesRef::U8(&codes));
        assert_eq!(open_normals(&path, &default()).unwrap().warnings, Vec::<String>::new(), "{name}");
    }
}

#[test]
fn srgb_is_a_warning_and_converts_nothing() {
    let folder = Folder::new();
    let path = folder.path("s.png");
    let mut encoder = png::Encoder::new(std::fs::File::create(&path).unwrap(), 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.write_header().unwrap().write_image_data(&[100, 128, 255]).unwrap();
    let file = open_normals(&path, &default()).unwrap();
    let srgb = file.srgb.as_deref().unwrap();
    assert!(srgb.contains("sRGB colours; a normal map is data, and they are read unconverted"), "{srgb}");
    assert_eq!((file.all_warnings().as_slice(), file.warnings.len()), ([srgb.to_owned()].as_slice(), 0));
    assert_reads(&path, &default(), Encoding::Unorm, Channels::Xyz, CodesRef::U8(&[100, 128, 255]));

    let path = png(&folder, [1, 1], png::ColorType::Rgb, png::BitDepth::Eight, &[100, 128, 255]);
    let NormalFile { warnings, srgb, .. } = open_normals(&path, &default()).unwrap();
    assert!(srgb.is_none() && warnings.is_empty(), "{warnings:?}");
}

/// The smallest lossy WebP, one black texel: its only chunk, behind RIFF, length and WEBP.
const LOSSY_CHUNK: [u8; 30] = [
    b'V', b'P', b'8', b' ', 22, 0, 0, 0, 0x30, 1, 0, 0x9d, 1, 0x2a, 1, 0, 1, 0, 0x0e, 0xc0, 0xfe, 0x25, 0xa4, 0, 3,
    0x70, 0, 0, 0, 0,
];

#[test]
fn lossy_compression_is_a_warning() {
    let folder = Folder::new();
    let warnings = |path: &Path| open_normals(path, &default()).unwrap().warnings;
    let jpeg = folder.path("n.jpg");
    image::RgbImage::from_pixel(8, 8, image::Rgb([128, 128, 255])).save(&jpeg).unwrap();
    assert_eq!(warnings(&jpeg).len(), 1);
    assert!(warnings(&jpeg)[0].contains("its compression is lossy, which bends normals"));

    let riff = |chunks: &[u8]| {
        let length = (4 + chunks.len() as u32).to_le_bytes();
        [b"RIFF", &length[..], b"WEBP", chunks].concat()
    };
    let simple = folder.file("s.webp", &riff(&LOSSY_CHUNK));
    assert_eq!(warnings(&simple), warnings(&jpeg));
    // With features announced, and a chunk of odd length, before the picture.
    let features = [&b"VP8X"[..], &[10, 0, 0, 0], &[0; 10], b"ODD \x03\0\0\0abc\0"].concat();
    let extended = folder.file("e.webp", &riff(&[&features[..], &LOSSY_CHUNK].concat()));
    assert_eq!(warnings(&extended), warnings(&jpeg));
}

#[test]
fn the_limit_counts_what_is_held_at_once() {
    let folder = Folder::new();
    let little = |max_bytes| NormalReadOptions { max_bytes, ..default() };
    let rows: Vec<u8> = vec![7; 100 * 100 * 3];
    let path = png(&folder, [100, 100], png::ColorType::Rgb, png::BitDepth::Eight, &rows);
    // Five rows to read them one by one: three buffers hold one each at least, and there are the last one and the
    // next. The whole map to hold it.
    assert!(open_normals(&path, &little(1500)).is_ok());
    assert!(open_normals(&path, &little(1499)).is_err());
    let message = normals_error(&path, &little(29_999));
    assert!(message.contains("100 x 100 texels, 30000 bytes decoded, above the limit of 29999"), "{message}");
    assert!(NormalMap::read_with(&path, &little(30_000)).is_ok());
    let cut = std::fs::read(&path).unwrap();
    let message = normals_error(&folder.file("c.png", &cut[..cut.len() - 20]), &default());
    assert!(message.contains("truncated"), "{message}");
}

#[test]
fn room_that_does_not_fit_is_refused() {
    let folder = Folder::new();
    let path = png(&folder, [2, 2], png::ColorType::Rgb, png::BitDepth::Eight, &[0; 12]);
    let mut rows = open_normals(&path, &default()).unwrap().rows;
    for (count, depth) in [(5, Depth::Bits8), (18, Depth::Bits8), (6, Depth::Bits16), (6, Depth::Float16)] {
        let message = rows.read(Codes::zeroed(depth, count).as_mut()).unwrap_err().to_string();
        let expected = std::format!(
            "room for rows is {count} codes of {depth} bits: it must be whole rows of 6 codes of 8 bits, at most 2"
        );
        assert_eq!(message, expected);
    }
    rows.read(CodesMut::U8(&mut [0; 12])).unwrap();
    assert!(rows.read(CodesMut::U8(&mut [0; 6])).unwrap_err().to_string().ends_with("at most 0"));
}

/// What a file that holds these codes reads as: half floats become floats.
fn widened(codes: &Codes) -> Codes {
    match codes {
        Codes::F16(halves) => Codes::F32(halves.iter().map(|half| half.to_f32()).collect()),
        other => other.clone(),
    }
}

#[test]
fn what_was_written_is_read_back() {
    let folder = Folder::new();
    let size = Size::new(7, 37).unwrap();
    let mut noise = Noise(17);
    let mut held = Vec::new();
    for (form, of) in FORMATS.iter().flat_map(|form| [(form, Channels::Xyz), (form, Channels::Xy)]) {
        let count = size.texels() * of.count();
        let codes = match form.depth {
            Depth::Bits8 => Codes::U8((0..count).map(|_| noise.next() as u8).collect()),
            Depth::Bits16 => Codes::U16((0..count).map(|_| noise.next() as u16).collect()),
            // Every finite half, subnormal ones too.
            Depth::Float16 => Codes::F16((0..count).map(|_| f16::from_bits(noise.next() as u16 & 0xbfff)).collect()),
            Depth::Float32 => Codes::F32((0..count).map(|_| f32::from_bits(noise.next() & 0xbfff_ffff)).collect()),
        };
        for (convention, extension) in [(Convention::Gl, "png"), (Convention::Dx, "tif"), (Convention::Gl, "exr")] {
            let written = texbake::NormalFormat { channels: of, convention, ..*form };
            let path = folder.path(&std::format!("n.{extension}"));
            if NormalMap::new(size, written, codes.clone()).unwrap().write(&path).is_err() {
                continue;
            }
            // What the file cannot say.
            let options = NormalReadOptions {
                encoding: (form.encoding == Encoding::Biased).then_some(Encoding::Biased),
                channels: (extension == "png" && of == Channels::Xy).then_some(Channels::Xy),
                convention,
                ..default()
            };
            let (read, expected) = (read_normals_all_ways(&path, &options).unwrap(), widened(&codes));
            let depth = expected.as_ref().depth();
            assert_eq!(read.format(), texbake::NormalFormat { depth, ..written }, "{path:?}");
            assert_eq!(read.codes().bytes(), expected.as_ref().bytes(), "{written:?} in {extension}");
            held.push(std::format!("{extension} {} {} {of}", form.encoding, form.depth));
        }
    }
    held.sort();
    let expected = "exr float 16f, exr float 32f, png biased 16, png biased 8, png unorm 16, png unorm 8, \
         tif biased 16, tif biased 8, tif float 32f, tif snorm 16, tif snorm 8, tif unorm 16, tif unorm 8";
    let expected: Vec<String> =
        expected.split(", ").flat_map(|held| [std::format!("{held} xy"), std::format!("{held} xyz")]).collect();
    assert_eq!(held, expected);
}
