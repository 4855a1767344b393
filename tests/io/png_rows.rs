//! Rows of PNGs that are inflated on one thread and unfiltered on another: as they were written, in files of many
//! buffers; and damage is noticed, behind the last row too.

use super::hand_made_png::{hand_made, of_chunks, stored};
use super::hand_made_tiff::Tiff;
use super::png::encode_with;
use super::support::{Folder, Noise, Values, read_all_ways, read_error, read_normals_all_ways};
use png::{BitDepth, ColorType, Compression, Filter};
use texbake::io::{NormalReadOptions, ReadOptions, create_normals, open_heights};
use texbake::stream::Monitor;
use texbake::{BakeOptions, Baker, CodesRef, Depth, Edge, Edges, Encoding, HeightsMut, Maps, NormalFormat, Size};

/// Bytes that repeat the noise 30,000 bytes before them: inflating looks back as far as it may, across buffers.
fn repeating(count: usize) -> Vec<u8> {
    let mut noise = Noise(3);
    let period: Vec<u8> = (0..29_989).map(|_| noise.next() as u8).collect();
    period.iter().copied().cycle().take(count).collect()
}

fn encode(size: [u32; 2], color: ColorType, depth: BitDepth, filter: Filter, rows: &[u8]) -> Vec<u8> {
    encode_with(size[0], size[1], color, depth, rows, |encoder| {
        encoder.set_compression(Compression::Balanced);
        encoder.set_filter(filter);
    })
}

fn wide(bytes: &[u8]) -> Vec<u16> {
    bytes.chunks_exact(2).map(|code| u16::from_be_bytes([code[0], code[1]])).collect()
}

#[test]
fn files_of_many_buffers_come_back() {
    let folder = Folder::new();
    let filters = [Filter::NoFilter, Filter::Sub, Filter::Up, Filter::Avg, Filter::Paeth, Filter::Adaptive];
    for filter in filters {
        let file = |size, color, depth, rows: &[u8]| {
            let bytes = encode(size, color, depth, filter, rows);
            if filter == Filter::NoFilter {
                assert!(bytes.len() < rows.len() / 2, "what repeats is found");
            }
            folder.file("m.png", &bytes)
        };
        let bytes = repeating(600_000);
        let path = file([1000, 600], ColorType::Grayscale, BitDepth::Eight, &bytes);
        assert!(read_all_ways(&path, &ReadOptions::default()).unwrap() == Values::U8(bytes.clone()), "{filter:?}");
        let path = file([500, 600], ColorType::Grayscale, BitDepth::Sixteen, &bytes);
        assert!(read_all_ways(&path, &ReadOptions::default()).unwrap() == Values::U16(wide(&bytes)), "{filter:?}");

        let normals = |path: &_| read_normals_all_ways(path, &NormalReadOptions::default()).unwrap();
        let path = file([400, 500], ColorType::Rgb, BitDepth::Eight, &bytes);
        assert!(normals(&path).codes() == CodesRef::U8(&bytes), "{filter:?}");
        let path = file([200, 500], ColorType::Rgb, BitDepth::Sixteen, &bytes);
        assert!(normals(&path).codes() == CodesRef::U16(&wide(&bytes)), "{filter:?}");
        let path = file([300, 500], ColorType::Rgba, BitDepth::Eight, &bytes);
        let codes: Vec<u8> = bytes.chunks_exact(4).flat_map(|texel| &texel[..3]).copied().collect();
        assert!(normals(&path).codes() == CodesRef::U8(&codes), "{filter:?}");
        let path = file([150, 500], ColorType::Rgba, BitDepth::Sixteen, &bytes);
        let codes: Vec<u16> = wide(&bytes).chunks_exact(4).flat_map(|texel| &texel[..3]).copied().collect();
        assert!(normals(&path).codes() == CodesRef::U16(&codes), "{filter:?}");
    }
}

/// A row is longer than a buffer is at its usual size.
#[test]
fn long_rows_come_back() {
    let folder = Folder::new();
    let bytes = repeating(6 * 300_000);
    let file = encode([300_000, 6], ColorType::Grayscale, BitDepth::Eight, Filter::Paeth, &bytes);
    let read = read_all_ways(&folder.file("l.png", &file), &ReadOptions::default()).unwrap();
    assert!(read == Values::U8(bytes));
}

/// 40 rows of 30 codes, each behind the number of its filter, 0.
fn filtered() -> Vec<u8> {
    (0..40 * 31).map(|k| if k % 31 == 0 { 0 } else { k as u8 }).collect()
}

fn error_of(file: &[u8]) -> String {
    read_error(&Folder::new().file("d.png", file), &ReadOptions::default())
}

#[test]
fn a_filter_that_does_not_exist_is_refused_at_its_row() {
    let folder = Folder::new();
    for (row, filter) in [(0, 5), (17, 255), (39, 9)] {
        let mut rows = filtered();
        rows[row * 31] = filter;
        let path = folder.file("f.png", &hand_made(30, 40, 8, 0, 0, &rows));
        let mut read = vec![0xa5; 40 * 30];
        let mut heights = open_heights(&path, &ReadOptions::default()).unwrap().rows;
        if row > 0 {
            heights.read(HeightsMut::U8(&mut read[..row * 30])).unwrap();
        }
        let message = heights.read(HeightsMut::U8(&mut read[row * 30..])).unwrap_err().to_string();
        assert!(message.ends_with(&format!("Unknown filter method {filter}; it is damaged; copy or export it again")));
        let expected: Vec<u8> = rows.chunks(31).take(row).flat_map(|row| &row[1..]).copied().collect();
        assert_eq!(read[..row * 30], expected);
    }
}

#[test]
fn too_few_rows_are_noticed() {
    let rows = filtered();
    assert!(
        read_all_ways(&Folder::new().file("w.png", &hand_made(30, 40, 8, 0, 0, &rows)), &Default::default()).is_ok()
    );
    for length in [39 * 31, 39 * 31 + 1, 40 * 31 - 1] {
        let message = error_of(&hand_made(30, 40, 8, 0, 0, &rows[..length]));
        assert!(message.contains("it is damaged; copy or export it again"), "{length}: {message}");
    }
    // The stream is cut, and the chunks around it are sound.
    let cut = &stored(&rows)[..700];
    let message = error_of(&of_chunks([30, 40], [8, 0, 0], &[(b"IDAT", cut.to_vec())]));
    assert!(message.contains("it is damaged; copy or export it again"), "{message}");
}

/// All rows are there, and a chunk behind them is wrong: the end of the stream in a chunk of its own, or the end mark.
#[test]
fn damage_behind_the_rows_is_noticed() {
    let stream = stored(&filtered());
    let (rows, end) = stream.split_at(stream.len() - 4);
    let whole = of_chunks([30, 40], [8, 0, 0], &[(b"IDAT", rows.to_vec()), (b"IDAT", end.to_vec())]);
    let folder = Folder::new();
    assert!(read_all_ways(&folder.file("w.png", &whole), &ReadOptions::default()).is_ok());
    // From the file's end: 12 bytes of IEND; before them the CRC of the stream's end, and that.
    for (what, at) in [("CRC of IEND", 1), ("name of IEND", 6), ("CRC of the end", 13), ("the end", 17)] {
        let mut damaged = whole.clone();
        let at = damaged.len() - at;
        damaged[at] ^= 1;
        let path = folder.file("d.png", &damaged);
        let message = read_error(&path, &ReadOptions::default());
        assert!(message.contains("it is damaged") || message.contains("it is truncated"), "{what}: {message}");
        // Row by row too, with the last row at the latest.
        let mut heights = open_heights(&path, &ReadOptions::default()).unwrap().rows;
        let mut row = [0; 30];
        let refused = (0..40).position(|_| heights.read(HeightsMut::U8(&mut row)).is_err());
        assert!(refused.is_some(), "{what}");
    }
    for missing in [1, 12, 20] {
        let message = error_of(&whole[..whole.len() - missing]);
        assert!(message.contains("it is truncated"), "{missing}: {message}");
    }
}

#[test]
fn of_an_animation_the_first_frame_is_read() {
    let folder = Folder::new();
    let frames = [repeating(200 * 300), vec![7; 200 * 300]];
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 200, 300);
    encoder.set_animated(2, 0).unwrap();
    let mut writer = encoder.write_header().unwrap();
    frames.iter().for_each(|frame| writer.write_image_data(frame).unwrap());
    writer.finish().unwrap();
    assert!(file.windows(4).any(|name| name == b"fdAT"), "the second frame");
    let read = read_all_ways(&folder.file("a.png", &file), &ReadOptions::default()).unwrap();
    assert!(read == Values::U8(frames[0].clone()));
}

/// EXR takes its rows from the top, so a map that wraps goes to its last row and back. A TIFF has no way to go.
#[test]
fn a_map_that_wraps_goes_back_into_exr() {
    let folder = Folder::new();
    let [width, height] = [500, 400];
    let bytes = repeating(width * height * 2);
    let png = encode([500, 400], ColorType::Grayscale, BitDepth::Sixteen, Filter::Adaptive, &bytes);
    let little_endian: Vec<u8> = wide(&bytes).into_iter().flat_map(u16::to_le_bytes).collect();
    let strips = little_endian.chunks(width * 2 * 8).map(<[u8]>::to_vec).collect();
    let tiff = Tiff::grey(500, 400, 16, 1, strips).bytes();
    let baked = [("h.png", &png), ("h.tif", &tiff)].map(|(name, file)| {
        let (input, output) = (folder.file(name, file), folder.path("n.exr"));
        let normal = NormalFormat { encoding: Encoding::Float, depth: Depth::Float32, ..Default::default() };
        let edges = Edges { x: Edge::Wrap, y: Edge::Wrap };
        let options = BakeOptions { normal: Some(normal), edges, ..Default::default() };
        let create = |size: Size| {
            Ok(Maps { normal: Some(create_normals(&output, size, normal)?.into()), parallax: None, roughness: None })
        };
        let open = || Ok(open_heights(&input, &ReadOptions::default())?.rows);
        Baker::cpu().bake_rows(&open, &create, &options, &Monitor::default()).unwrap();
        std::fs::read(&output).unwrap()
    });
    assert!(baked[0] == baked[1]);
}
