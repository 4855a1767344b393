//! PNG in and out.

use super::hand_made_png::hand_made;
use super::support::{Folder, Noise, Values, format, read_all_ways, read_error, write};
use png::{BitDepth, ColorType};
use texbake::io::{Channel, ColorSpace, ReadOptions, create_normals, open_heights};
use texbake::{Channels, CodesRef, Depth, Encoding, Size};

/// The bytes of a PNG.
pub fn encode(width: u32, height: u32, color: ColorType, depth: BitDepth, rows: &[u8]) -> Vec<u8> {
    encode_with(width, height, color, depth, rows, |_| ())
}

pub fn encode_with(
    width: u32,
    height: u32,
    color: ColorType,
    depth: BitDepth,
    rows: &[u8],
    adjust: impl FnOnce(&mut png::Encoder<&mut Vec<u8>>),
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    adjust(&mut encoder);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(rows).unwrap();
    writer.finish().unwrap();
    bytes
}

fn channel(name: &str) -> ReadOptions {
    ReadOptions { channel: Some(name.parse().unwrap()), ..Default::default() }
}

fn default() -> ReadOptions {
    ReadOptions::default()
}

#[test]
fn grey_of_every_depth() {
    let folder = Folder::new();
    let read = |bytes: &[u8]| read_all_ways(&folder.file("g.png", bytes), &default()).unwrap();
    // Code H of n bits becomes H * 255 / (2^n - 1): the same height.
    let grey = ColorType::Grayscale;
    let one = encode(3, 2, grey, BitDepth::One, &[0b1010_0000, 0b0110_0000]);
    assert_eq!(read(&one), Values::U8(vec![255, 0, 255, 0, 255, 255]));
    let two = encode(4, 2, grey, BitDepth::Two, &[0b00_01_10_11, 0b11_10_01_00]);
    assert_eq!(read(&two), Values::U8(vec![0, 85, 170, 255, 255, 170, 85, 0]));
    let four = encode(3, 2, grey, BitDepth::Four, &[0x01, 0x20, 0xfe, 0x90]);
    assert_eq!(read(&four), Values::U8(vec![0, 17, 34, 255, 238, 153]));
    let eight = encode(3, 2, grey, BitDepth::Eight, &[0, 1, 127, 128, 254, 255]);
    assert_eq!(read(&eight), Values::U8(vec![0, 1, 127, 128, 254, 255]));
    let sixteen = encode(2, 2, grey, BitDepth::Sixteen, &[0x00, 0x01, 0x80, 0x00, 0xff, 0xfe, 0x12, 0x34]);
    assert_eq!(read(&sixteen), Values::U16(vec![0x0001, 0x8000, 0xfffe, 0x1234]));
}

#[test]
fn colours_that_are_equal_need_no_channel_and_alpha_is_ignored() {
    let folder = Folder::new();
    let read = |bytes: &[u8]| read_all_ways(&folder.file("c.png", bytes), &default()).unwrap();
    let eight = BitDepth::Eight;
    assert_eq!(read(&encode(2, 1, ColorType::Rgb, eight, &[9, 9, 9, 200, 200, 200])), Values::U8(vec![9, 200]));
    assert_eq!(read(&encode(2, 1, ColorType::Rgba, eight, &[9, 9, 9, 0, 7, 7, 7, 99])), Values::U8(vec![9, 7]));
    assert_eq!(read(&encode(2, 1, ColorType::GrayscaleAlpha, eight, &[3, 255, 4, 0])), Values::U8(vec![3, 4]));
    let wide = [0x12, 0x34, 0x00, 0x00, 0xab, 0xcd, 0xff, 0xff];
    let grey_alpha = encode(2, 1, ColorType::GrayscaleAlpha, BitDepth::Sixteen, &wide);
    assert_eq!(read(&grey_alpha), Values::U16(vec![0x1234, 0xabcd]));
    let wide = [0x12, 0x34, 0x12, 0x34, 0x12, 0x34];
    assert_eq!(read(&encode(1, 1, ColorType::Rgb, BitDepth::Sixteen, &wide)), Values::U16(vec![0x1234]));
    // Grey with one transparent code.
    let keyed = encode_with(2, 1, ColorType::Grayscale, eight, &[5, 6], |png| png.set_trns(vec![0, 5]));
    assert_eq!(read(&keyed), Values::U8(vec![5, 6]));
}

#[test]
fn palettes_of_every_depth() {
    let folder = Folder::new();
    let grey: Vec<u8> = (0..4).flat_map(|i| [i * 50; 3]).collect();
    for (depth, row) in
        [(BitDepth::Two, vec![0b11_10_01_00]), (BitDepth::Four, vec![0x32, 0x10]), (BitDepth::Eight, vec![3, 2, 1, 0])]
    {
        let bytes = encode_with(4, 1, ColorType::Indexed, depth, &row, |png| png.set_palette(grey.clone()));
        let path = folder.file("p.png", &bytes);
        assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::U8(vec![150, 100, 50, 0]), "{depth:?}");
    }
    let colours = vec![10, 20, 30, 40, 50, 60];
    let bytes = encode_with(3, 1, ColorType::Indexed, BitDepth::One, &[0b0100_0000], |png| {
        png.set_palette(colours);
        png.set_trns(vec![1, 2]);
    });
    let path = folder.file("p.png", &bytes);
    assert_eq!(read_all_ways(&path, &channel("g")).unwrap(), Values::U8(vec![20, 50, 20]));
    assert_eq!(read_all_ways(&path, &channel("a")).unwrap(), Values::U8(vec![1, 2, 1]));
}

#[test]
fn interlaced_files_read_like_others() {
    // 4 x 4 Adam7, hand-made: passes 1, 4, 5, 6 and 7 hold 1, 1, 2, 4 and 8 texels (PNG 3rd edition, 8.1).
    let codes: Vec<u8> = (0..16).collect();
    let passes: [&[u8]; 5] = [&[0], &[2], &[8, 10], &[1, 3], &[9, 11]];
    let mut rows = Vec::new();
    for pass in passes {
        rows.push(0);
        rows.extend_from_slice(pass);
    }
    for row in [&[4, 5, 6, 7], &[12, 13, 14, 15]] {
        rows.push(0);
        rows.extend_from_slice(row);
    }
    let folder = Folder::new();
    let file = folder.file("i.png", &hand_made(4, 4, 8, 0, 1, &rows));
    assert_eq!(read_all_ways(&file, &default()).unwrap(), Values::U8(codes));
}

#[test]
fn colours_that_differ_need_a_channel() {
    let folder = Folder::new();
    let rows = [1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 5];
    let path = folder.file("c.png", &encode(2, 2, ColorType::Rgb, BitDepth::Eight, &rows));
    let message = read_error(&path, &default());
    assert!(message.contains("its channels differ, first at column 1, row 1: 4, 4, 5"), "{message}");
    assert!(message.contains("--channel r, g, b, a or luma"), "{message}");

    let texels = [10, 20, 30, 40, 250, 0, 128, 255];
    let path = folder.file("d.png", &encode(2, 1, ColorType::Rgba, BitDepth::Eight, &texels));
    let read = |name| read_all_ways(&path, &channel(name)).unwrap();
    assert_eq!(read("r"), Values::U8(vec![10, 250]));
    assert_eq!(read("g"), Values::U8(vec![20, 0]));
    assert_eq!(read("b"), Values::U8(vec![30, 128]));
    assert_eq!(read("A"), Values::U8(vec![40, 255]));
    // (13933 * 10 + 46871 * 20 + 4732 * 30 + 32768) / 65536 = 19.096; 62.892 for the other.
    assert_eq!(read("luma"), Values::U8(vec![19, 62]));
    let message = read_error(&path, &channel("Z"));
    assert!(message.contains("channels have names in EXR files only, and Z was asked for"), "{message}");
}

#[test]
fn a_grey_file_is_its_own_red_green_blue_and_luma() {
    let folder = Folder::new();
    let path = folder.file("g.png", &encode(2, 1, ColorType::Grayscale, BitDepth::Eight, &[7, 9]));
    for name in ["r", "g", "b", "luma"] {
        assert_eq!(read_all_ways(&path, &channel(name)).unwrap(), Values::U8(vec![7, 9]), "{name}");
    }
    let message = read_error(&path, &channel("a"));
    assert!(message.contains("it has no alpha channel"), "{message}");
}

#[test]
fn luma_of_16_bits_is_rec_709() {
    let folder = Folder::new();
    let texels: Vec<u8> =
        [65535u16, 65535, 65535, 65535, 0, 0, 0, 65535, 0, 0, 0, 65535].iter().flat_map(|c| c.to_be_bytes()).collect();
    let path = folder.file("l.png", &encode(4, 1, ColorType::Rgb, BitDepth::Sixteen, &texels));
    // Weights 13933, 46871 and 4732 of 65536, times 65535, half up.
    assert_eq!(read_all_ways(&path, &channel("luma")).unwrap(), Values::U16(vec![65535, 13933, 46870, 4732]));
}

#[test]
fn srgb_is_decoded_only_when_asked_for() {
    let folder = Folder::new();
    let srgb = ReadOptions { color_space: ColorSpace::Srgb, ..default() };
    let codes = [0, 1, 10, 11, 64, 128, 188, 255];
    let eight = encode(8, 1, ColorType::Grayscale, BitDepth::Eight, &codes);
    let path = folder.file("s.png", &eight);
    // 65535 times the IEC 61966-2-1 curve, half up, computed with 50 digits.
    let linear = vec![0, 20, 199, 219, 3360, 14146, 32957, 65535];
    assert_eq!(read_all_ways(&path, &srgb).unwrap(), Values::U16(linear.clone()));
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::U8(codes.to_vec()));
    let wide: Vec<u8> = codes.iter().flat_map(|code| [*code, *code]).collect();
    let path = folder.file("w.png", &encode(8, 1, ColorType::Grayscale, BitDepth::Sixteen, &wide));
    assert_eq!(read_all_ways(&path, &srgb).unwrap(), Values::U16(linear));
}

#[test]
fn a_file_that_says_srgb_gives_a_warning() {
    let folder = Folder::new();
    let plain = encode(1, 1, ColorType::Grayscale, BitDepth::Eight, &[100]);
    let labelled = encode_with(1, 1, ColorType::Grayscale, BitDepth::Eight, &[100], |png| {
        png.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    });
    let warnings =
        |bytes: &[u8], options: &ReadOptions| open_heights(&folder.file("s.png", bytes), options).unwrap().warnings;
    assert_eq!(warnings(&plain, &default()), Vec::<String>::new());
    let found = warnings(&labelled, &default());
    assert_eq!(found.len(), 1);
    assert!(found[0].starts_with("the file says that its codes are sRGB colours"), "{found:?}");
    assert_eq!(warnings(&labelled, &ReadOptions { color_space: ColorSpace::Srgb, ..default() }), Vec::<String>::new());
    assert_eq!(read_all_ways(&folder.file("s.png", &labelled), &default()).unwrap(), Values::U8(vec![100]));
}

#[test]
fn damaged_files_end_in_a_reason() {
    let folder = Folder::new();
    let mut noise = Noise(1);
    let rows: Vec<u8> = (0..64 * 64).map(|_| noise.next() as u8).collect();
    let whole = encode(64, 64, ColorType::Grayscale, BitDepth::Eight, &rows);
    for length in [1, 4, 8, 20, 33, 100, whole.len() / 2, whole.len() - 13, whole.len() - 1] {
        let message = read_error(&folder.file("t.png", &whole[..length]), &default());
        let expected = if length < 4 { "no format that texbake knows" } else { "truncated" };
        assert!(message.contains(expected), "{length}: {message}");
    }
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 0x10;
    let message = read_error(&folder.file("f.png", &flipped), &default());
    assert!(message.contains("it is damaged; copy or export it again"), "{message}");
    let message = read_error(&folder.file("e.png", &[]), &default());
    assert!(message.contains("the file is empty; copy or export it again"), "{message}");
    let message = read_error(&folder.path("none.png"), &default());
    assert!(message.contains("No such file"), "{message}");
}

#[test]
fn sizes_are_judged_by_the_header() {
    let folder = Folder::new();
    let zero = folder.file("z.png", &hand_made(0, 5, 8, 0, 0, &[]));
    assert!(!read_error(&zero, &default()).is_empty());
    let huge = folder.file("h.png", &hand_made(0x7fff_ffff, 0x7fff_ffff, 16, 6, 0, &[0]));
    let message = read_error(&huge, &default());
    assert!(message.contains("more than any map holds"), "{message}");
    let long = folder.file("l.png", &hand_made(0x7fff_ffff, 3, 16, 0, 0, &[0]));
    let message = read_error(&long, &default());
    assert!(message.contains("the header claims 2147483647 x 3 texels"), "{message}");
    assert!(message.contains("raise it with --max-bytes"), "{message}");
    let hollow = folder.file("o.png", &hand_made(30000, 30000, 8, 0, 0, &[0]));
    let message = read_error(&hollow, &default());
    assert!(message.contains("its header claims 30000 x 30000 texels, which cannot come out of"), "{message}");
    // The limit counts what is decoded at once: a few rows, or an interlaced image.
    let rows: Vec<u8> = (0..100 * 101).map(|i| if i % 101 == 0 { 0 } else { i as u8 }).collect();
    let little = ReadOptions { max_bytes: 5000, ..default() };
    let by_rows = folder.file("r.png", &hand_made(100, 100, 8, 0, 0, &rows));
    assert!(open_heights(&by_rows, &little).is_ok());
    let message = read_error(&by_rows, &little);
    assert!(message.contains("100 x 100 texels, 10000 bytes decoded, above the limit of 5000"), "{message}");
    let interlaced = folder.file("i.png", &hand_made(100, 100, 8, 0, 1, &rows));
    assert!(open_heights(&interlaced, &little).is_err());
}

#[test]
fn a_transparent_colour_counts_as_the_alpha_that_it_becomes() {
    let folder = Folder::new();
    let file = hand_made(16, 16, 16, 2, 1, &[0]);
    let mut key = [b"tRNS".as_slice(), &[0; 6]].concat();
    let checksum = crc32fast::hash(&key).to_be_bytes();
    key = [&6u32.to_be_bytes()[..], &key, &checksum].concat();
    let path = folder.file("k.png", &[&file[..33], &key, &file[33..]].concat());
    // Six bytes a texel in the file, eight when it is decoded.
    let message = read_error(&path, &ReadOptions { max_bytes: 1800, ..default() });
    assert!(message.contains("16 x 16 texels, 2048 bytes decoded, above the limit of 1800"), "{message}");
}

/// Width, height, colour type, bit depth and bytes of a PNG.
fn decode(path: &std::path::Path) -> (u32, u32, ColorType, BitDepth, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    reader.finish().unwrap();
    (info.width, info.height, info.color_type, info.bit_depth, bytes)
}

#[test]
fn normals_are_written_as_rgb() {
    let folder = Folder::new();
    let path = folder.path("n.png");
    let codes: Vec<u8> = (0..18).map(|i| i * 14).collect();
    let xyz = format(Encoding::Unorm, Depth::Bits8, Channels::Xyz);
    write(&path, 2, 3, xyz, CodesRef::U8(&codes)).unwrap();
    assert_eq!(decode(&path), (2, 3, ColorType::Rgb, BitDepth::Eight, codes.clone()));

    let wide = [0x0102u16, 0xfffe, 0x8000, 0x1234, 0, 65535];
    let xyz = format(Encoding::Biased, Depth::Bits16, Channels::Xyz);
    write(&path, 1, 2, xyz, CodesRef::U16(&wide)).unwrap();
    let bytes = vec![0x01, 0x02, 0xff, 0xfe, 0x80, 0x00, 0x12, 0x34, 0, 0, 0xff, 0xff];
    assert_eq!(decode(&path), (1, 2, ColorType::Rgb, BitDepth::Sixteen, bytes));

    let xy = format(Encoding::Unorm, Depth::Bits8, Channels::Xy);
    write(&path, 2, 1, xy, CodesRef::U8(&[1, 2, 3, 4])).unwrap();
    assert_eq!(decode(&path), (2, 1, ColorType::Rgb, BitDepth::Eight, vec![1, 2, 0, 3, 4, 0]));
    let xy = format(Encoding::Unorm, Depth::Bits16, Channels::Xy);
    write(&path, 1, 1, xy, CodesRef::U16(&[0x0102, 0x0304])).unwrap();
    assert_eq!(decode(&path), (1, 1, ColorType::Rgb, BitDepth::Sixteen, vec![1, 2, 3, 4, 0, 0]));
}

#[test]
fn a_large_file_survives_many_chunks() {
    let folder = Folder::new();
    let path = folder.path("n.png");
    let mut noise = Noise(7);
    let codes: Vec<u8> = (0..700 * 301 * 3).map(|_| noise.next() as u8).collect();
    write(&path, 700, 301, format(Encoding::Unorm, Depth::Bits8, Channels::Xyz), CodesRef::U8(&codes)).unwrap();
    assert_eq!(decode(&path).4, codes);
}

#[test]
fn what_png_cannot_hold_is_refused_before_a_file_is_made() {
    let folder = Folder::new();
    let path = folder.path("n.png");
    for (encoding, depth, expected) in [
        (Encoding::Snorm, Depth::Bits8, "unorm or biased in PNG, which has no signed numbers"),
        (Encoding::Float, Depth::Float32, "EXR and TIFF hold floats"),
        (Encoding::Float, Depth::Float16, "EXR and TIFF hold floats"),
    ] {
        let format = format(encoding, depth, Channels::Xyz);
        let message = create_normals(&path, Size::new(1, 1).unwrap(), format).err().unwrap().to_string();
        assert!(message.contains(expected), "{message}");
    }
    assert_eq!(folder.names(), Vec::<String>::new());
    assert_eq!("Height.Z".parse::<Channel>(), Ok(Channel::Named("Height.Z".into())));
}
