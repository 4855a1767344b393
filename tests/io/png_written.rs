//! What PNG files are written: the same texels and the same bytes, however the rows come, and as small as they are.

use super::support::{Folder, Noise, format, read_error, write_rows};
use png::{BitDepth, ColorType};
use std::io::Read;
use std::path::Path;
use texbake::io::{Compression, ReadOptions, WriteOptions, create_normals_with, create_parallax_with};
use texbake::stream::RowSink;
use texbake::{Channels, Codes, Depth, Encoding, ParallaxFormat, Size};

const LEVELS: [Compression; 3] = [Compression::Fast, Compression::Balanced, Compression::Small];

/// What a file is made of: grey or RGB, its codes in the file's channels.
#[derive(Clone)]
struct Picture {
    width: usize,
    height: usize,
    channels: usize,
    depth: Depth,
    codes: Vec<u16>,
}

impl Picture {
    /// Codes of each texel and channel, cut to the depth.
    fn new(
        [width, height]: [usize; 2],
        channels: usize,
        depth: Depth,
        mut code: impl FnMut(usize, usize, usize) -> u16,
    ) -> Self {
        let mask = if depth == Depth::Bits8 { 0xff } else { 0xffff };
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let all = texels.flat_map(|(x, y)| (0..channels).map(move |channel| (x, y, channel)));
        let codes = all.map(|(x, y, channel)| code(x, y, channel) & mask).collect();
        Self { width, height, channels, depth, codes }
    }

    fn noise(size: [usize; 2], channels: usize, depth: Depth) -> Self {
        let mut noise = Noise((size[0] * 31 + size[1]) as u64);
        Self::new(size, channels, depth, |_, _, _| noise.next() as u16)
    }

    /// Waves of this height, with a little noise: a normal map of bumps, about.
    fn waves(size: [usize; 2], channels: usize, depth: Depth, height: f64, grain: u32) -> Self {
        let mut noise = Noise(5);
        let full = if depth == Depth::Bits8 { 127.0 } else { 32767.0 };
        Self::new(size, channels, depth, |x, y, channel| {
            let phase = x as f64 * 0.031 + y as f64 * 0.017 * (channel + 1) as f64;
            let wave = (phase.sin() * height + 1.0) * full;
            wave as u16 + (noise.next() >> 8) as u16 % (grain as u16 + 1)
        })
    }

    fn codes(&self) -> Codes {
        match self.depth {
            Depth::Bits8 => Codes::U8(self.codes.iter().map(|code| *code as u8).collect()),
            _ => Codes::U16(self.codes.clone()),
        }
    }

    fn sink(&self, path: &Path, compression: Compression) -> Box<dyn RowSink> {
        let size = Size::new(self.width, self.height).unwrap();
        let options = WriteOptions { compression, ..Default::default() };
        if self.channels == 1 {
            let parallax = ParallaxFormat { encoding: Encoding::Biased, depth: self.depth };
            return create_parallax_with(path, size, parallax, &options).unwrap().rows;
        }
        let channels = if self.channels == 2 { Channels::Xy } else { Channels::Xyz };
        create_normals_with(path, size, format(Encoding::Unorm, self.depth, channels), &options).unwrap().rows
    }

    /// The bytes of its file, whose rows come one by one.
    fn file(&self, compression: Compression) -> Vec<u8> {
        self.file_in_order(compression, 0..self.height)
    }

    fn file_in_order(&self, compression: Compression, order: impl IntoIterator<Item = usize>) -> Vec<u8> {
        let folder = Folder::new();
        let path = folder.path("n.png");
        write_rows(self.sink(&path, compression), order, self.codes().as_ref(), self.width * self.channels).unwrap();
        std::fs::read(path).unwrap()
    }

    /// As [`Picture::file`], with `rows` rows at a time.
    fn file_in_bands(&self, compression: Compression, rows: usize) -> Vec<u8> {
        let folder = Folder::new();
        let path = folder.path("n.png");
        let mut sink = self.sink(&path, compression);
        let (codes, row) = (self.codes(), self.width * self.channels);
        for first in (0..self.height).step_by(rows) {
            let end = (first + rows).min(self.height);
            sink.write(first, codes.as_ref().slice(first * row..end * row)).unwrap();
        }
        sink.finish().unwrap();
        std::fs::read(path).unwrap()
    }

    /// The samples that the file must hold, as PNG orders their bytes.
    fn samples(&self) -> Vec<u8> {
        let stored = self.codes.chunks_exact(self.channels).flat_map(|texel| match texel {
            [x, y] => vec![*x, *y, 0],
            others => others.to_vec(),
        });
        match self.depth {
            Depth::Bits8 => stored.map(|code| code as u8).collect(),
            _ => stored.flat_map(u16::to_be_bytes).collect(),
        }
    }

    fn texel_bytes(&self) -> usize {
        let samples = if self.channels == 1 { 1 } else { 3 };
        samples * if self.depth == Depth::Bits8 { 1 } else { 2 }
    }

    #[track_caller]
    fn assert_in(&self, file: &[u8]) {
        let case = format!("{} x {} x {}, {:?}", self.width, self.height, self.channels, self.depth);
        assert!(by_the_png_crate(file, self) == self.samples(), "png: {case}");
        assert!(by_the_specification(file, self).unwrap() == self.samples(), "by hand: {case}");
    }
}

fn by_the_png_crate(file: &[u8], picture: &Picture) -> Vec<u8> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    reader.finish().unwrap();
    let colour = if picture.channels == 1 { ColorType::Grayscale } else { ColorType::Rgb };
    let depth = if picture.depth == Depth::Bits8 { BitDepth::Eight } else { BitDepth::Sixteen };
    assert_eq!((info.color_type, info.bit_depth), (colour, depth));
    assert_eq!((info.width as usize, info.height as usize), (picture.width, picture.height));
    bytes
}

/// Strictly: every chunk's CRC, one zlib stream by another inflater with its checksum and nothing behind it, and the
/// filters in the words of the PNG specification, section 9.
fn by_the_specification(file: &[u8], picture: &Picture) -> Result<Vec<u8>, String> {
    let stream: Vec<u8> = idat(file)?.concat();
    let mut inflater = flate2::bufread::ZlibDecoder::new(&stream[..]);
    let mut filtered = Vec::new();
    inflater.read_to_end(&mut filtered).map_err(|error| error.to_string())?;
    let row_bytes = picture.width * picture.texel_bytes();
    if inflater.total_in() != stream.len() as u64 || filtered.len() != picture.height * (1 + row_bytes) {
        return Err("another length".into());
    }
    let mut rows: Vec<u8> = Vec::new();
    let mut above = vec![0; row_bytes];
    for filtered in filtered.chunks_exact(1 + row_bytes) {
        let mut row = vec![0u8; row_bytes];
        for at in 0..row_bytes {
            let before = |row: &[u8]| at.checked_sub(picture.texel_bytes()).map_or(0, |left| i32::from(row[left]));
            let (a, b, c) = (before(&row), i32::from(above[at]), before(&above));
            let p = a + b - c;
            let guess = match filtered[0] {
                0 => 0,
                1 => a,
                2 => b,
                3 => (a + b) / 2,
                4 if (p - a).abs() <= (p - b).abs() && (p - a).abs() <= (p - c).abs() => a,
                4 if (p - b).abs() <= (p - c).abs() => b,
                4 => c,
                filter => return Err(format!("filter {filter}")),
            };
            row[at] = filtered[1 + at].wrapping_add(guess as u8);
        }
        rows.extend(&row);
        above = row;
    }
    Ok(rows)
}

/// The content of the IDAT chunks, of a file in which all chunks are sound.
fn idat(file: &[u8]) -> Result<Vec<&[u8]>, String> {
    let (mut chunks, mut rest) = (Vec::new(), &file[8..]);
    while let [a, b, c, d, after @ ..] = rest {
        let length = u32::from_be_bytes([*a, *b, *c, *d]) as usize;
        let (named, after) = after.split_at(4 + length);
        if crc32fast::hash(named).to_be_bytes() != after[..4] {
            return Err("CRC".into());
        }
        if named.starts_with(b"IDAT") {
            chunks.push(&named[4..]);
        }
        rest = &after[4..];
    }
    Ok(chunks)
}

#[test]
fn every_kind_comes_back_at_every_level() {
    for compression in LEVELS {
        for (channels, depth) in [1, 2, 3].into_iter().flat_map(|n| [(n, Depth::Bits8), (n, Depth::Bits16)]) {
            for size in [[1, 1], [1, 7], [7, 1], [3, 2], [61, 40]] {
                let noise = Picture::noise(size, channels, depth);
                noise.assert_in(&noise.file(compression));
            }
            for height in [0.9, 0.05, 0.0] {
                let waves = Picture::waves([120, 30], channels, depth, height, 2);
                waves.assert_in(&waves.file(compression));
            }
        }
    }
}

/// Stripes have 128 or 512 KiB: of rows of 3000 bytes 43 or 174, behind the first row, which stands by itself.
#[test]
fn heights_around_the_borders_of_stripes_come_back() {
    for (compression, rows) in [(Compression::Fast, 43), (Compression::Balanced, 174)] {
        for height in [rows, rows + 1, rows + 2, 2 * rows, 2 * rows + 1, 2 * rows + 2] {
            let waves = Picture::waves([1000, height], 3, Depth::Bits8, 0.8, 3);
            let file = waves.file(compression);
            waves.assert_in(&file);
            // The first row, the stripes, and the end.
            assert_eq!(idat(&file).unwrap().len(), 1 + (height - 1).div_ceil(rows) + 1, "{compression:?}, {height}");
        }
    }
}

#[test]
fn a_row_that_is_longer_than_a_stripe_comes_back() {
    let waves = Picture::waves([200_000, 4], 3, Depth::Bits8, 0.8, 3);
    waves.assert_in(&waves.file(Compression::Fast));
}

#[test]
fn the_bytes_depend_on_neither_threads_nor_bands_nor_the_first_rows_turn() {
    // Nine stripes of the fast level, two of the slowest.
    for (compression, height) in [(Compression::Fast, 700), (Compression::Small, 370)] {
        let waves = Picture::waves([500, height], 3, Depth::Bits8, 0.6, 30);
        let expected = waves.file(compression);
        assert_eq!(idat(&expected).unwrap().len(), 2 + if compression == Compression::Fast { 9 } else { 2 });
        for threads in [1, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| waves.file(compression)) == expected, "{compression:?}, {threads} threads");
        }
        for rows in [7, height / 2, height] {
            assert!(waves.file_in_bands(compression, rows) == expected, "{compression:?}, bands of {rows}");
        }
        let last = (1..height).chain([0]);
        assert!(waves.file_in_order(compression, last) == expected, "{compression:?}, row 0 last");
    }
}

/// All threads of a pool write at once, so that none is left to encode for them.
#[test]
fn threads_that_all_write_do_not_wait_for_each_other() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let waves = Picture::waves([500, 900], 3, Depth::Bits8, 0.6, 3);
    let expected = waves.file(Compression::Fast);
    pool.broadcast(|_| assert!(waves.file(Compression::Fast) == expected));
}

/// The same on every machine. Whoever changes filters, codes, stripes or zlib-rs writes other numbers here.
#[test]
fn the_bytes_are_those_of_every_machine() {
    let bumps = |x: usize, y: usize, channel: usize| ((x * x + 3 * y * y) >> (6 + channel)) as u16 ^ (x & y) as u16;
    let picture = Picture::new([400, 150], 3, Depth::Bits8, bumps);
    let found = LEVELS.map(|compression| crc32fast::hash(&picture.file(compression)));
    assert_eq!(found, [3_217_503_341, 2_003_741_595, 988_685_413]);
}

#[test]
fn slower_levels_are_smaller() {
    let eight = |height, grain| Picture::waves([512, 100], 3, Depth::Bits8, height, grain);
    let maps = [
        ("steep", eight(0.9, 31)),
        ("gentle", eight(0.2, 3)),
        ("nearly flat", eight(0.02, 0)),
        ("flat", eight(0.0, 0)),
        ("16 bits", Picture::waves([512, 80], 3, Depth::Bits16, 0.3, 90)),
        ("parallax", Picture::waves([512, 100], 1, Depth::Bits8, 0.5, 2)),
        ("parallax of 16 bits", Picture::waves([512, 100], 1, Depth::Bits16, 0.5, 50)),
        ("xy", Picture::waves([512, 100], 2, Depth::Bits8, 0.2, 2)),
        ("noise", Picture::noise([512, 100], 3, Depth::Bits8)),
    ];
    // Row 0 is stored, behind the number of its filter.
    let stored = 1 + 512 * 3;
    for (name, map) in maps {
        let [fast, balanced, small] = LEVELS.map(|compression| map.file(compression).len());
        println!("{name}: {} fast {fast} balanced {balanced} small {small}", map.samples().len());
        assert!(small <= balanced && balanced <= fast, "{name}: {small} {balanced} {fast}");
        // What repeats is found, and noise grows by little more than the headers of its blocks.
        match name {
            "flat" => {
                assert!(small < balanced && (fast - stored) * 150 < map.samples().len(), "{small} {balanced} {fast}")
            }
            "nearly flat" => assert!(small * 10 < fast * 9, "{small} {fast}"),
            "noise" => assert!(fast < map.samples().len() * 1001 / 1000 + 600, "{fast}"),
            _ => assert!(fast < map.samples().len()),
        }
    }
}

/// A checksum that is wrong, and sound around it, is noticed by the inflater; a chunk that is wrong by both decoders.
#[test]
fn wrong_checksums_are_noticed() {
    let waves = Picture::waves([300, 50], 3, Depth::Bits8, 0.5, 2);
    let file = waves.file(Compression::Fast);
    // The stream's last four bytes; behind them are the CRC of their chunk and the 12 bytes of IEND.
    let adler = file.len() - 12 - 4 - 4;
    let mut wrong = file.clone();
    wrong[adler] ^= 1;
    assert_eq!(by_the_specification(&wrong, &waves), Err("CRC".into()));
    // The chunk's name and an empty block stand before them.
    let chunk = adler - 5 - 4;
    let crc = crc32fast::hash(&wrong[chunk..adler + 4]).to_be_bytes();
    wrong[adler + 4..adler + 8].copy_from_slice(&crc);
    let refused = by_the_specification(&wrong, &waves).unwrap_err();
    assert_ne!(refused, "CRC", "the inflater's own reason");

    let mut wrong = file.clone();
    wrong[file.len() / 2] ^= 1;
    assert_eq!(by_the_specification(&wrong, &waves), Err("CRC".into()));
    let folder = Folder::new();
    let options = ReadOptions { channel: Some("r".parse().unwrap()), ..Default::default() };
    let message = read_error(&folder.file("w.png", &wrong), &options);
    assert!(message.contains("it is damaged; copy or export it again"), "{message}");
}
