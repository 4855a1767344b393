//! TIFF in and out.

use super::hand_made_tiff::Tiff;
use super::support::{Folder, Noise, Values, format, read_all_ways, read_error, write};
use half::f16;
use std::path::Path;
use texbake::io::{ReadOptions, create_normals, open_heights};
use texbake::{Channels, CodesRef, Depth, Encoding, Size};
use tiff::decoder::{Decoder, DecodingResult};

fn default() -> ReadOptions {
    ReadOptions::default()
}

fn channel(name: &str) -> ReadOptions {
    ReadOptions { channel: Some(name.parse().unwrap()), ..default() }
}

fn words<const N: usize>(values: [u16; N]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn floats<const N: usize>(values: [f32; N]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

#[test]
fn every_sample_type_by_strips() {
    let folder = Folder::new();
    let read = |tiff: Tiff| read_all_ways(&folder.file("t.tif", &tiff.bytes()), &default()).unwrap();
    let bytes = Tiff::grey(2, 3, 8, 1, vec![vec![0, 1], vec![2, 3], vec![254, 255]]);
    assert_eq!(read(bytes), Values::U8(vec![0, 1, 2, 3, 254, 255]));
    let sixteen = Tiff::grey(2, 3, 16, 1, vec![words([0, 1, 0x1234, 0x8000]), words([0xfffe, 0xffff])]);
    assert_eq!(read(sixteen), Values::U16(vec![0, 1, 0x1234, 0x8000, 0xfffe, 0xffff]));
    // A signed height v has the code v + 32768, or v + 128.
    let signed = Tiff::grey(4, 1, 16, 2, vec![words([-32768i16, -1, 0, 32767].map(|v| v as u16))]);
    assert_eq!(read(signed), Values::U16(vec![0, 32767, 32768, 65535]));
    let signed = Tiff::grey(4, 1, 8, 2, vec![[-128i8, -1, 0, 127].map(|v| v as u8).to_vec()]);
    assert_eq!(read(signed), Values::U8(vec![0, 127, 128, 255]));
    let float = Tiff::grey(2, 2, 32, 3, vec![floats([0.5, -1e30]), floats([f32::MIN_POSITIVE, 123.25])]);
    assert_eq!(read(float), Values::F32(vec![0.5, -1e30, f32::MIN_POSITIVE, 123.25]));
    let half = Tiff::grey(3, 1, 16, 3, vec![words([0.5, -2.0, 65504.0].map(|v| f16::from_f32(v).to_bits()))]);
    assert_eq!(read(half), Values::F32(vec![0.5, -2.0, 65504.0]));
}

#[test]
fn doubles_are_rounded_with_a_warning() {
    let folder = Folder::new();
    let doubles = [0.1f64, 1e-300, -7.5].iter().flat_map(|v| v.to_le_bytes()).collect();
    let path = folder.file("d.tif", &Tiff::grey(3, 1, 64, 3, vec![doubles]).bytes());
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::F32(vec![0.1, 0.0, -7.5]));
    assert_eq!(open_heights(&path, &default()).unwrap().warnings, ["its 64-bit floats are rounded to 32 bits"]);
}

#[test]
fn integers_of_32_bits_are_refused() {
    let folder = Folder::new();
    let path = folder.file("i.tif", &Tiff::grey(1, 1, 32, 1, vec![vec![1, 2, 3, 4]]).bytes());
    let message = read_error(&path, &default());
    assert!(message.contains("its samples are 32-bit integers"), "{message}");
    assert!(message.contains("convert it to 16-bit integers or 32-bit floats"), "{message}");
}

/// A 20 x 18 elevation map in tiles of 16 x 16, heights 100 y + x.
fn tiled(no_data: &str) -> Tiff {
    let tile = |left: u32, top: u32| -> Vec<u8> {
        let texels = (0..256).map(|i| (left + i % 16, top + i / 16));
        texels.flat_map(|(x, y)| ((100 * y + x) as f32).to_le_bytes()).collect()
    };
    let mut tiff = Tiff::grey(20, 18, 32, 3, vec![tile(0, 0), tile(16, 0), tile(0, 16), tile(16, 16)]);
    tiff.tile = Some((16, 16));
    let text = [no_data.as_bytes(), b"\0"].concat();
    tiff.extra.push((42113, 2, text.len() as u32, text));
    tiff
}

#[test]
fn tiled_elevation_reads_and_its_holes_are_named() {
    let folder = Folder::new();
    let expected = (0..18).flat_map(|y| (0..20).map(move |x| (100 * y + x) as f32)).collect();
    let path = folder.file("dem.tif", &tiled("-9999").bytes());
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::F32(expected));

    let path = folder.file("hole.tif", &tiled("1719").bytes());
    let message = read_error(&path, &default());
    assert!(message.contains("the texel at column 19, row 17 holds 1719, the file's no-data value"), "{message}");
    assert!(message.contains("fill the holes with gdal_fillnodata, crop the map"), "{message}");
    assert!(message.contains("if 1719 is a height, remove the mark with gdal_edit -unsetnodata"), "{message}");

    let mut signed = Tiff::grey(2, 1, 16, 2, vec![words([5, -32768i16 as u16])]);
    signed.extra.push((42113, 2, 7, b"-32768\0".to_vec()));
    let message = read_error(&folder.file("s.tif", &signed.bytes()), &default());
    assert!(message.contains("the texel at column 1, row 0 holds -32768, the file's no-data value"), "{message}");
}

#[test]
fn colours_planes_and_bands() {
    let folder = Folder::new();
    let mut rgb = Tiff::grey(2, 1, 8, 1, vec![vec![7, 7, 7, 9, 9, 9]]);
    (rgb.samples, rgb.photometric) = (3, 2);
    assert_eq!(read_all_ways(&folder.file("c.tif", &rgb.bytes()), &default()).unwrap(), Values::U8(vec![7, 9]));

    let mut planar = Tiff::grey(2, 2, 16, 1, vec![]);
    (planar.samples, planar.photometric, planar.planar, planar.rows_per_strip) = (3, 2, true, 1);
    planar.chunks =
        vec![words([1, 2]), words([3, 4]), words([11, 12]), words([13, 14]), words([21, 22]), words([23, 24])];
    let path = folder.file("p.tif", &planar.bytes());
    assert_eq!(read_all_ways(&path, &channel("r")).unwrap(), Values::U16(vec![1, 2, 3, 4]));
    assert_eq!(read_all_ways(&path, &channel("b")).unwrap(), Values::U16(vec![21, 22, 23, 24]));
    let message = read_error(&path, &default());
    assert!(message.contains("its channels differ, first at column 0, row 0: 1, 11, 21"), "{message}");

    let mut bands = Tiff::grey(2, 1, 8, 1, vec![vec![1, 50, 2, 60]]);
    bands.samples = 2;
    let path = folder.file("b.tif", &bands.bytes());
    assert_eq!(read_all_ways(&path, &channel("g")).unwrap(), Values::U8(vec![50, 60]));
    assert!(read_error(&path, &channel("b")).contains("it has two channels, and no third"));
    bands.extra.push((338, 3, 1, vec![2, 0]));
    let path = folder.file("a.tif", &bands.bytes());
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::U8(vec![1, 2]));
    assert_eq!(read_all_ways(&path, &channel("a")).unwrap(), Values::U8(vec![50, 60]));
}

#[test]
fn heights_that_are_no_numbers_are_named_by_position() {
    let folder = Folder::new();
    let tiff = Tiff::grey(2, 2, 32, 3, vec![floats([0.0, 1.0]), floats([f32::NAN, 1.0])]);
    let message = read_error(&folder.file("n.tif", &tiff.bytes()), &default());
    assert!(message.starts_with("the height at column 0, row 1 is NaN"), "{message}");
}

#[test]
fn claims_that_the_file_cannot_keep_end_in_a_reason() {
    let folder = Folder::new();
    let tiff = Tiff::grey(2, 2, 16, 1, vec![words([1, 2]), words([3, 4])]);
    let empty = Tiff { width: 0, ..tiff.clone() };
    let message = read_error(&folder.file("z.tif", &empty.bytes()), &default());
    assert!(message.contains("invalid dimensions: 0x2"), "{message}");
    // Strips that are unpacked row by row need no room for the map; those of PackBits do.
    let one_strip = Tiff::grey(60000, 60000, 16, 1, vec![words([1])]);
    let message = read_error(&folder.file("h.tif", &one_strip.bytes()), &default());
    assert!(message.contains("the file ends before its last row: it is truncated"), "{message}");
    let one_strip = Tiff { compression: 32_773, ..one_strip };
    let message = read_error(&folder.file("h.tif", &one_strip.bytes()), &default());
    assert!(message.contains("the header claims 60000 x 60000 texels, 14400000000 bytes decoded"), "{message}");
    let mut tile = Tiff::grey(2, 2, 16, 1, vec![words([1])]);
    tile.tile = Some((1 << 20, 1 << 20));
    let message = read_error(&folder.file("t.tif", &tile.bytes()), &default());
    assert!(message.contains("raise it with --max-bytes"), "{message}");
    let strips = Tiff { height: 1 << 31, rows_per_strip: 1, ..tiff.clone() };
    let message = read_error(&folder.file("s.tif", &strips.bytes()), &default());
    assert!(message.contains("inconsistent sizes"), "{message}");
    let hollow = Tiff::grey(20000, 20000, 16, 1, vec![words([1])]);
    let message = read_error(&folder.file("o.tif", &hollow.bytes()), &default());
    assert!(message.contains("truncated") || message.contains("damaged"), "{message}");
    let whole = tiff.bytes();
    for length in [4, 7, 9, 20, whole.len() - 20] {
        let message = read_error(&folder.file("c.tif", &whole[..length]), &default());
        assert!(message.contains("truncated") || message.contains("damaged"), "{length}: {message}");
    }
}

/// Samples per texel, bits, sample format and samples of a TIFF.
fn decode(path: &Path) -> (u16, u16, u16, DecodingResult) {
    let mut decoder = Decoder::new(std::fs::File::open(path).unwrap()).unwrap();
    let mut first = |tag| decoder.get_tag_u16_vec(tag).unwrap()[0];
    let samples = first(tiff::tags::Tag::SamplesPerPixel);
    let bits = first(tiff::tags::Tag::BitsPerSample);
    let kind = first(tiff::tags::Tag::SampleFormat);
    (samples, bits, kind, decoder.read_image().unwrap())
}

#[test]
fn normals_are_written_in_every_encoding() {
    let folder = Folder::new();
    let path = folder.path("n.tif");
    let codes: Vec<u8> = (0..18).collect();
    write(&path, 2, 3, format(Encoding::Unorm, Depth::Bits8, Channels::Xyz), CodesRef::U8(&codes)).unwrap();
    let (samples, bits, kind, image) = decode(&path);
    assert_eq!((samples, bits, kind), (3, 8, 1));
    assert!(matches!(image, DecodingResult::U8(found) if found == codes));

    let codes = [0, 1, 2, 0x8000, 0xfffe, 0xffffu16];
    write(&path, 2, 1, format(Encoding::Biased, Depth::Bits16, Channels::Xyz), CodesRef::U16(&codes)).unwrap();
    let (samples, bits, kind, image) = decode(&path);
    assert_eq!((samples, bits, kind), (3, 16, 1));
    assert!(matches!(image, DecodingResult::U16(found) if found == codes));

    write(&path, 1, 2, format(Encoding::Snorm, Depth::Bits16, Channels::Xyz), CodesRef::U16(&codes)).unwrap();
    let (samples, bits, kind, image) = decode(&path);
    assert_eq!((samples, bits, kind), (3, 16, 2));
    assert!(matches!(image, DecodingResult::I16(found) if found == [0, 1, 2, -32768, -2, -1]));

    let snorm = format(Encoding::Snorm, Depth::Bits8, Channels::Xy);
    write(&path, 1, 2, snorm, CodesRef::U8(&[127, 0x81, 0, 1])).unwrap();
    let (samples, bits, kind, image) = decode(&path);
    assert_eq!((samples, bits, kind), (2, 8, 2));
    assert!(matches!(image, DecodingResult::I8(found) if found == [127, -127, 0, 1]));

    let floats = [0.25, -0.5, 1.0, 0.0, 1.0, -1.0];
    write(&path, 2, 1, format(Encoding::Float, Depth::Float32, Channels::Xyz), CodesRef::F32(&floats)).unwrap();
    let (samples, bits, kind, image) = decode(&path);
    assert_eq!((samples, bits, kind), (3, 32, 3));
    assert!(matches!(image, DecodingResult::F32(found) if found == floats));

    let half = format(Encoding::Float, Depth::Float16, Channels::Xyz);
    let message = create_normals(&path, Size::new(1, 1).unwrap(), half).err().unwrap().to_string();
    assert!(message.contains("float with 32f bits in TIFF; EXR holds 16f"), "{message}");
}

#[test]
fn many_strips_hold_every_row() {
    let folder = Folder::new();
    let path = folder.path("n.tif");
    let mut noise = Noise(3);
    // 3000 bytes a row: three strips of 349 rows and a last one of 53.
    let codes: Vec<u16> = (0..500 * 3 * 1100).map(|_| noise.next() as u16).collect();
    write(&path, 500, 1100, format(Encoding::Unorm, Depth::Bits16, Channels::Xyz), CodesRef::U16(&codes)).unwrap();
    let mut decoder = Decoder::new(std::fs::File::open(&path).unwrap()).unwrap();
    assert_eq!((decoder.dimensions().unwrap(), decoder.strip_count().unwrap()), ((500, 1100), 4));
    assert!(matches!(decoder.read_image().unwrap(), DecodingResult::U16(found) if found == codes));
}

#[test]
fn one_strip_counts_as_it_is_decoded_and_as_heights() {
    let folder = Folder::new();
    let path = folder.file("s.tif", &Tiff::grey(100, 100, 8, 1, vec![vec![7; 10_000]]).bytes());
    let message = read_error(&path, &ReadOptions { max_bytes: 15_000, ..default() });
    assert!(message.contains("100 x 100 texels, 20000 bytes decoded, above the limit of 15000"), "{message}");
    assert!(open_heights(&path, &ReadOptions { max_bytes: 20_000, ..default() }).is_ok());
    // Ten strips: a tenth of it.
    let path = folder.file("t.tif", &Tiff::grey(100, 100, 8, 1, vec![vec![7; 1000]; 10]).bytes());
    assert!(open_heights(&path, &ReadOptions { max_bytes: 2000, ..default() }).is_ok());
}
