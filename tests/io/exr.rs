//! EXR in and out.

use super::support::{Folder, Noise, Values, format, read_all_ways, read_error, write};
use ::exr::prelude::*;
use std::path::Path;
use texbake::io::{ColorSpace, ReadOptions, create_normals, open_heights};
use texbake::{Channels, CodesRef, Depth, Size as MapSize};

fn default() -> ReadOptions {
    ReadOptions::default()
}

fn channel(name: &str) -> ReadOptions {
    ReadOptions { channel: Some(name.parse().unwrap()), ..default() }
}

fn channels(named: &[(&str, Vec<f32>)]) -> AnyChannels<FlatSamples> {
    let channel = |(name, values): &(&str, Vec<f32>)| AnyChannel::new(*name, FlatSamples::F32(values.clone()));
    AnyChannels::sort(named.iter().map(channel).collect())
}

fn save(path: &Path, width: usize, height: usize, encoding: Encoding, channels: AnyChannels<FlatSamples>) {
    let layer = Layer::new((width, height), LayerAttributes::named("layer"), encoding, channels);
    Image::from_layer(layer).write().to_file(path).unwrap();
}

fn scan_lines(compression: Compression, line_order: LineOrder) -> Encoding {
    Encoding { compression, blocks: Blocks::ScanLines, line_order }
}

/// 37 x 45 heights with a few bits each, so that every lossless compression has something to do.
fn heights() -> Vec<f32> {
    let mut noise = Noise(5);
    (0..37 * 45).map(|i| (i / 37) as f32 + (noise.next() % 8) as f32 / 8.0).collect()
}

#[test]
fn every_lossless_compression_block_shape_and_line_order() {
    let folder = Folder::new();
    let path = folder.path("h.exr");
    let tiles = |side| Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::Tiles(Vec2(side, side)),
        line_order: LineOrder::Increasing,
    };
    for encoding in [
        scan_lines(Compression::Uncompressed, LineOrder::Increasing),
        scan_lines(Compression::RLE, LineOrder::Increasing),
        scan_lines(Compression::ZIP1, LineOrder::Increasing),
        scan_lines(Compression::ZIP16, LineOrder::Increasing),
        scan_lines(Compression::PIZ, LineOrder::Increasing),
        scan_lines(Compression::ZIP16, LineOrder::Decreasing),
        tiles(16),
        tiles(64),
        Encoding { line_order: LineOrder::Decreasing, ..tiles(8) },
    ] {
        save(&path, 37, 45, encoding, channels(&[("Y", heights())]));
        assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::F32(heights()), "{encoding:?}");
    }
}

#[test]
fn half_floats_are_widened() {
    let folder = Folder::new();
    let path = folder.path("h.exr");
    let values: Vec<f16> = [0.0, 0.1, -65504.0, 2.0].map(f16::from_f32).to_vec();
    let halves = AnyChannels::sort([AnyChannel::new("height", FlatSamples::F16(values))].into_iter().collect());
    save(&path, 2, 2, scan_lines(Compression::ZIP16, LineOrder::Increasing), halves);
    // The half nearest to 0.1 is 0x2e66 = 1638 / 16384.
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::F32(vec![0.0, 1638.0 / 16384.0, -65504.0, 2.0]));
}

#[test]
fn the_channel_with_the_heights_is_found_or_asked_for() {
    let folder = Folder::new();
    let path = folder.path("c.exr");
    let encoding = scan_lines(Compression::ZIP16, LineOrder::Increasing);
    let (one, two, three) = (vec![1.0, 2.0], vec![3.0, 4.0], vec![5.0, 6.0]);
    let store = |named: &[(&str, Vec<f32>)]| save(&path, 2, 1, encoding, channels(named));

    store(&[("any", one.clone()), ("A", two.clone())]);
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::F32(one.clone()));
    assert_eq!(read_all_ways(&path, &channel("a")).unwrap(), Values::F32(two.clone()));
    assert_eq!(read_all_ways(&path, &channel("g")).unwrap(), Values::F32(one.clone()));

    store(&[("mask", one.clone()), ("disp.Height", two.clone())]);
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::F32(two.clone()));
    assert_eq!(read_all_ways(&path, &channel("mask")).unwrap(), Values::F32(one.clone()));
    let message = read_error(&path, &channel("other"));
    assert!(message.contains("it has no channel other, only disp.Height, mask"), "{message}");

    store(&[("first", one.clone()), ("second", two.clone())]);
    let message = read_error(&path, &default());
    assert!(message.contains("it is not clear which of its channels is meant: first, second"), "{message}");
    assert!(message.contains("choose one by its name with --channel"), "{message}");

    store(&[("R", one.clone()), ("G", one.clone()), ("B", one.clone()), ("A", two.clone())]);
    assert_eq!(read_all_ways(&path, &default()).unwrap(), Values::F32(one.clone()));

    store(&[("R", one.clone()), ("G", two.clone()), ("B", three.clone())]);
    let message = read_error(&path, &default());
    assert!(message.contains("its channels differ, first at column 0, row 0: 1, 3, 5"), "{message}");
    assert_eq!(read_all_ways(&path, &channel("r")).unwrap(), Values::F32(one.clone()));
    assert_eq!(read_all_ways(&path, &channel("b")).unwrap(), Values::F32(three.clone()));
    let luma = |r: f32, g: f32, b: f32| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let expected = vec![luma(1.0, 3.0, 5.0), luma(2.0, 4.0, 6.0)];
    assert_eq!(read_all_ways(&path, &channel("luma")).unwrap(), Values::F32(expected));
}

#[test]
fn the_first_layer_with_the_channel_is_read() {
    let folder = Folder::new();
    let path = folder.path("l.exr");
    let encoding = scan_lines(Compression::ZIP16, LineOrder::Increasing);
    let layer = |name: &str, named: &[(&str, Vec<f32>)]| {
        Layer::new((2, 1), LayerAttributes::named(name), encoding, channels(named))
    };
    let first = layer("beauty", &[("R", vec![9.0, 9.0]), ("Q", vec![8.0, 8.0])]);
    let second = layer("data", &[("Z", vec![1.0, 2.0])]);
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions((2, 1)));
    Image::empty(attributes).with_layer(first).with_layer(second).write().to_file(&path).unwrap();
    assert_eq!(read_all_ways(&path, &channel("Z")).unwrap(), Values::F32(vec![1.0, 2.0]));
    assert_eq!(read_all_ways(&path, &channel("Q")).unwrap(), Values::F32(vec![8.0, 8.0]));
}

#[test]
fn floats_are_linear_and_finite() {
    let folder = Folder::new();
    let path = folder.path("f.exr");
    let encoding = scan_lines(Compression::Uncompressed, LineOrder::Increasing);
    let mut values = heights();
    values[37 * 20 + 3] = f32::NEG_INFINITY;
    save(&path, 37, 45, encoding, channels(&[("Y", values)]));
    let message = read_error(&path, &default());
    assert!(message.starts_with("the height at column 3, row 20 is -inf"), "{message}");
    let message = read_error(&path, &ReadOptions { color_space: ColorSpace::Srgb, ..default() });
    assert!(message.contains("it holds floats"), "{message}");
    assert!(message.contains("leave out --color-space srgb"), "{message}");
}

#[test]
fn colours_that_are_no_numbers_are_no_difference() {
    let folder = Folder::new();
    let path = folder.path("c.exr");
    let encoding = scan_lines(Compression::Uncompressed, LineOrder::Increasing);
    let nan = vec![1.0, f32::NAN];
    save(&path, 1, 2, encoding, channels(&[("R", nan.clone()), ("G", nan.clone()), ("B", nan.clone())]));
    let message = read_error(&path, &default());
    assert!(message.starts_with("the height at column 0, row 1 is NaN"), "{message}");
    save(&path, 1, 2, encoding, channels(&[("R", vec![1.0, 2.0]), ("G", nan.clone()), ("B", nan)]));
    let message = read_error(&path, &default());
    assert!(message.starts_with("the height at column 0, row 1 is NaN"), "{message}");
}

#[test]
fn claims_are_checked_before_anything_is_allocated() {
    let folder = Folder::new();
    let path = folder.path("t.exr");
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::Tiles(Vec2(4, 4)),
        line_order: LineOrder::Increasing,
    };
    save(&path, 4, 4, encoding, channels(&[("Y", vec![0.0; 16])]));
    let whole = std::fs::read(&path).unwrap();
    // The data window's and the tiles' far corners, from 3 to 29999 and from 4 to 30000.
    let replace = |bytes: &[u8], name: &[u8], at: usize, values: [i32; 2]| -> Vec<u8> {
        let start = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len() + at;
        let mut bytes = bytes.to_vec();
        bytes[start..start + 8].copy_from_slice(&values.map(i32::to_le_bytes).concat());
        bytes
    };
    // Name, zero, type, zero, 4 bytes of length, then the value.
    let window = "\0box2i\0".len() + 4 + 8;
    let tile = "\0tiledesc\0".len() + 4;
    let one_tile = replace(&replace(&whole, b"dataWindow", window, [29999, 29999]), b"tiles", tile, [30000, 30000]);
    let message = read_error(&folder.file("bomb.exr", &one_tile), &default());
    assert!(message.contains("the header claims 30000 x 30000 texels"), "{message}");
    assert!(message.contains("raise it with --max-bytes"), "{message}");
    let many_tiles = replace(&whole, b"dataWindow", window, [29999, 29999]);
    let message = read_error(&folder.file("many.exr", &many_tiles), &default());
    assert!(message.contains("truncated") || message.contains("damaged"), "{message}");
    let greatest = replace(&whole, b"dataWindow", window, [i32::MAX - 1, i32::MAX - 1]);
    assert!(!read_error(&folder.file("max.exr", &greatest), &default()).is_empty());
    let backwards = replace(&whole, b"dataWindow", window, [-9, -9]);
    assert!(!read_error(&folder.file("back.exr", &backwards), &default()).is_empty());
    let no_tiles = replace(&whole, b"tiles", tile, [0, 0]);
    assert!(!read_error(&folder.file("none.exr", &no_tiles), &default()).is_empty());
    for length in [4, 10, 100, whole.len() - 60, whole.len() - 1] {
        let message = read_error(&folder.file("cut.exr", &whole[..length]), &default());
        assert!(message.contains("truncated") || message.contains("damaged"), "{length}: {message}");
    }
}

fn float(depth: Depth, channels: Channels) -> texbake::NormalFormat {
    format(texbake::Encoding::Float, depth, channels)
}

/// Names and samples of a file's only layer.
fn decode(path: &Path) -> Vec<(String, FlatSamples)> {
    let image = ::exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = image.all_attributes().pedantic().from_file(path).unwrap();
    let channels = image.layer_data.channel_data.list.into_iter();
    channels.map(|channel| (channel.name.to_string(), channel.sample_data)).collect()
}

fn compression(path: &Path) -> Compression {
    ::exr::meta::MetaData::read_from_file(path, true).unwrap().headers[0].compression
}

#[test]
fn normals_are_written_as_red_green_and_blue() {
    let folder = Folder::new();
    let path = folder.path("n.exr");
    let mut noise = Noise(9);
    // 41 rows of 5 texels: two blocks of 16 lines, and one of 9.
    let codes: Vec<f32> = (0..5 * 41 * 3).map(|_| noise.next() as f32).collect();
    write(&path, 5, 41, float(Depth::Float32, Channels::Xyz), CodesRef::F32(&codes)).unwrap();
    let component = |i: usize| codes.iter().skip(i).step_by(3).copied().collect::<Vec<f32>>();
    let expected = [("B", component(2)), ("G", component(1)), ("R", component(0))];
    let expected = expected.map(|(name, values)| (name.to_string(), FlatSamples::F32(values)));
    assert_eq!(decode(&path), expected);

    // Sixteen rows of 12000 texels would be 2.3 MB: each has a block of its own.
    let codes: Vec<f32> = (0..12_000 * 5 * 3).map(|_| noise.next() as f32).collect();
    write(&path, 12_000, 5, float(Depth::Float32, Channels::Xyz), CodesRef::F32(&codes)).unwrap();
    let component = |i: usize| codes.iter().skip(i).step_by(3).copied().collect::<Vec<f32>>();
    let expected = [("B", component(2)), ("G", component(1)), ("R", component(0))];
    let expected = expected.map(|(name, values)| (name.to_string(), FlatSamples::F32(values)));
    assert_eq!(compression(&path), Compression::ZIP1);
    assert!(decode(&path) == expected);

    let codes: Vec<f16> = [0.5, -0.25, 1.0, 0.0].map(f16::from_f32).to_vec();
    write(&path, 1, 2, float(Depth::Float16, Channels::Xy), CodesRef::F16(&codes)).unwrap();
    let expected = [("G", vec![codes[1], codes[3]]), ("R", vec![codes[0], codes[2]])];
    let expected = expected.map(|(name, values)| (name.to_string(), FlatSamples::F16(values)));
    assert_eq!(decode(&path), expected);
}

#[test]
fn integers_are_refused() {
    let folder = Folder::new();
    let unorm = format(texbake::Encoding::Unorm, Depth::Bits8, Channels::Xyz);
    let error = create_normals(&folder.path("n.exr"), MapSize::new(1, 1).unwrap(), unorm).err().unwrap();
    let message = error.to_string();
    assert!(message.contains("float with 16f or 32f bits in EXR; PNG and TIFF hold integers"), "{message}");
    assert_eq!(folder.names(), Vec::<String>::new());
}

#[test]
fn a_little_memory_is_enough_for_blocks() {
    let folder = Folder::new();
    let path = folder.path("b.exr");
    save(&path, 37, 45, scan_lines(Compression::ZIP16, LineOrder::Increasing), channels(&[("Y", heights())]));
    // 16 lines of 37 floats, as a block and as heights.
    assert!(open_heights(&path, &ReadOptions { max_bytes: 2 * 16 * 37 * 4, ..default() }).is_ok());
    let error = open_heights(&path, &ReadOptions { max_bytes: 2 * 16 * 37 * 4 - 1, ..default() }).err().unwrap();
    assert!(error.to_string().contains("37 x 45 texels, 4736 bytes decoded, above the limit of 4735"), "{error}");
}
