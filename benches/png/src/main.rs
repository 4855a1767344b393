//! Which PNG decoder and encoder suit normal maps: speeds and sizes, measured interleaved.
//!
//!     png-codecs HEIGHT.png [ROUNDS]

#[macro_use]
#[path = "../../../src/vectorised.rs"]
mod vectorised;
mod io;
mod production;

use cpu_time::ProcessTime;
use io::Compression;
use production::filtered;
use std::hint::black_box;
use std::time::Instant;

/// An image as PNG stores it: samples of 16 bits in big-endian order.
struct Image {
    width: usize,
    height: usize,
    bpp: usize,
    samples: Vec<u8>,
}

impl Image {
    fn row(&self) -> usize {
        self.width * self.bpp
    }

    fn color(&self) -> (png::ColorType, png::BitDepth) {
        match self.bpp {
            1 => (png::ColorType::Grayscale, png::BitDepth::Eight),
            2 => (png::ColorType::Grayscale, png::BitDepth::Sixteen),
            3 => (png::ColorType::Rgb, png::BitDepth::Eight),
            _ => (png::ColorType::Rgb, png::BitDepth::Sixteen),
        }
    }
}

/// Something that is timed: what comes out is counted.
struct Case<'a> {
    name: String,
    run: Box<dyn Fn() -> usize + 'a>,
}

fn case<'a>(name: impl Into<String>, run: impl Fn() -> usize + 'a) -> Case<'a> {
    Case { name: name.into(), run: Box::new(run) }
}

/// Runs all cases in turn, `rounds` times, and prints the medians; `raw` bytes are what a speed counts.
///
/// Processor time counts, of all threads: a busy machine does not change it much.
fn measure(title: &str, raw: usize, rounds: usize, cases: &[Case]) {
    let mut seconds = vec![Vec::new(); cases.len()];
    let mut bytes = vec![0; cases.len()];
    for _ in 0..rounds {
        for (k, case) in cases.iter().enumerate() {
            let (cpu, wall) = (ProcessTime::now(), Instant::now());
            bytes[k] = black_box((case.run)());
            seconds[k].push((cpu.elapsed().as_secs_f64(), wall.elapsed().as_secs_f64()));
        }
    }
    let mut median = |k: usize, of: fn(&(f64, f64)) -> f64| {
        seconds[k].sort_by(|a, b| of(a).total_cmp(&of(b)));
        of(&seconds[k][rounds / 2])
    };
    let medians: Vec<_> = (0..cases.len()).map(|k| (median(k, |s| s.0), median(k, |s| s.1))).collect();
    println!("\n### {title}\n");
    println!("| | MB per processor second | times the first | MB per second of this run | MB out |");
    println!("| --- | ---: | ---: | ---: | ---: |");
    for ((case, bytes), (cpu, wall)) in cases.iter().zip(bytes).zip(&medians) {
        let (raw, out) = (raw as f64 / 1e6, bytes as f64 / 1e6);
        println!("| {} | {:.0} | {:.2} | {:.0} | {out:.3} |", case.name, raw / cpu, medians[0].0 / cpu, raw / wall);
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().expect("usage: png-codecs HEIGHT.png [ROUNDS]");
    let rounds = arguments.next().map_or(5, |r| r.parse().expect("ROUNDS is a number"));
    let file = std::fs::read(&path).expect("the height map is there");
    let heights = decode_png(&file);
    println!("{} x {}, {} rounds", heights.width, heights.height, rounds);
    decoding("decoding 16-bit grey heights", &file, &heights, rounds);
    for (name, scale) in [("steep", 100.0), ("gentle", 10.0)] {
        let normals = bake(&heights, scale);
        encoding(&format!("RGB8 normals, {name} (scale {scale})"), &normals, rounds);
        let file = encode_png(&normals, png::Compression::Balanced, png::Filter::Adaptive);
        decoding(&format!("decoding RGB8 normals, {name}"), &file, &normals, rounds);
    }
    encoding("RGB8 normals, nearly flat (scale 0.3)", &bake(&heights, 0.3), rounds);
    encoding("RGB16 normals, gentle (scale 10)", &bake_deep(&heights, 10.0), rounds);
    encoding("grey 8-bit parallax, gentle (scale 10)", &bake_parallax(&heights, 10.0), rounds);
}

/// The normal map as texbake stores it, near enough for a codec.
fn bake(heights: &Image, scale: f32) -> Image {
    baked(heights, scale, 3, |normal, _, out| out.extend(normal.map(|v| (v * 127.5 + 128.0) as u8)))
}

/// The same with 16 bits.
fn bake_deep(heights: &Image, scale: f32) -> Image {
    let code = |v: f32| ((v * 32767.5 + 32768.0) as u16).to_be_bytes();
    baked(heights, scale, 6, |normal, _, out| out.extend(normal.into_iter().flat_map(code)))
}

/// The parallax map, biased.
fn bake_parallax(heights: &Image, scale: f32) -> Image {
    baked(heights, scale, 1, |[_, _, z], h, out| out.push((z * (2.0 * h - 1.0) * 127.0 + 128.5) as u8))
}

/// Texels of `bpp` bytes from the normal and the height at each place.
fn baked(heights: &Image, scale: f32, bpp: usize, texel: impl Fn([f32; 3], f32, &mut Vec<u8>)) -> Image {
    let (w, h) = (heights.width, heights.height);
    let height = |x: usize, y: usize| {
        let at = (y % h * w + x % w) * 2;
        f32::from(u16::from_be_bytes([heights.samples[at], heights.samples[at + 1]])) / 65535.0
    };
    let mut samples = Vec::with_capacity(w * h * bpp);
    for y in 0..h {
        for x in 0..w {
            let dx = (height(x + 1, y) - height(x + w - 1, y)) * scale / 2.0;
            let dy = (height(x, y + 1) - height(x, y + h - 1)) * scale / 2.0;
            let inverse = 1.0 / (dx * dx + dy * dy + 1.0).sqrt();
            texel([-dx, dy, 1.0].map(|v| v * inverse), height(x, y), &mut samples);
        }
    }
    Image { width: w, height: h, bpp, samples }
}

// ---------------------------------------------------------------------------------------------------------- decoding

fn decoding(title: &str, file: &[u8], image: &Image, rounds: usize) {
    let zlib = idat(file);
    let filtered = image.height * (image.row() + 1);
    assert_eq!(decode_zune(file), image.samples, "zune-png");
    let cases = [
        case("`png` 0.18 (fdeflate)", || decode_png(file).samples.len()),
        case("`png`, checksums ignored", || decode_png_unchecked(file)),
        case("`zune-png`", || decode_zune(file).len()),
        case("`lodepng`", || decode_lode(file, image)),
        case("inflate alone: fdeflate", || fdeflate::decompress_to_vec(&zlib).expect("zlib").len()),
        case("inflate alone: zlib-rs", || {
            let mut out = vec![0; filtered];
            let mut inflate = zlib_rs::Inflate::new(true, 15);
            inflate.decompress(&zlib, &mut out, zlib_rs::InflateFlush::Finish).expect("zlib");
            inflate.total_out() as usize
        }),
        case("inflate alone: libdeflate", || {
            let mut out = vec![0; filtered];
            libdeflater::Decompressor::new().zlib_decompress(&zlib, &mut out).expect("zlib")
        }),
        case("inflate alone: miniz_oxide", || miniz_oxide::inflate::decompress_to_vec_zlib(&zlib).expect("zlib").len()),
    ];
    measure(
        &format!("{title} ({:.1} MB file; MB/s of raw data)", file.len() as f64 / 1e6),
        image.samples.len(),
        rounds,
        &cases,
    );
}

fn decode_png(file: &[u8]) -> Image {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG");
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let bpp = reader.info().bytes_per_pixel();
    let mut samples = vec![0; width * height * bpp];
    for row in samples.chunks_exact_mut(width * bpp) {
        reader.read_row(row).expect("a row");
    }
    Image { width, height, bpp, samples }
}

fn decode_png_unchecked(file: &[u8]) -> usize {
    let mut options = png::DecodeOptions::default();
    options.set_ignore_checksums(true);
    let mut reader = png::Decoder::new_with_options(std::io::Cursor::new(file), options).read_info().expect("a PNG");
    let mut samples = vec![0; reader.output_buffer_size().expect("fits")];
    reader.next_frame(&mut samples).expect("an image");
    samples.len()
}

fn decode_zune(file: &[u8]) -> Vec<u8> {
    zune_png::PngDecoder::new(zune_core::bytestream::ZCursor::new(file)).decode_raw().expect("a PNG")
}

fn decode_lode(file: &[u8], image: &Image) -> usize {
    let (color, bits) = if image.bpp == 2 { (lodepng::ColorType::GREY, 16) } else { (lodepng::ColorType::RGB, 8) };
    match lodepng::decode_memory(file, color, bits).expect("a PNG") {
        lodepng::Image::Grey16(b) => b.buffer.len() * 2,
        lodepng::Image::RGB(b) => b.buffer.len() * 3,
        _ => panic!("another type"),
    }
}

/// The zlib stream of a PNG.
fn idat(file: &[u8]) -> Vec<u8> {
    let (mut at, mut stream) = (8, Vec::new());
    while at < file.len() {
        let length = u32::from_be_bytes(file[at..at + 4].try_into().expect("four bytes")) as usize;
        if &file[at + 4..at + 8] == b"IDAT" {
            stream.extend_from_slice(&file[at + 8..at + 8 + length]);
        }
        at += length + 12;
    }
    stream
}

// ---------------------------------------------------------------------------------------------------------- encoding

fn encoding(title: &str, image: &Image, rounds: usize) {
    let (one, two) = (&threads(1), &threads(2));
    let mut cases = vec![
        case("texbake fast", move || production::encode(image, Compression::Fast, one)),
        case("texbake balanced", move || production::encode(image, Compression::Balanced, one)),
        case("texbake small", move || production::encode(image, Compression::Small, one)),
        case("texbake fast, 2 threads", move || production::encode(image, Compression::Fast, two)),
        case("`png` Fast (fdeflate), Paeth", || encode_png(image, png::Compression::Fast, png::Filter::Paeth).len()),
        case("`png` Fast (fdeflate), its own filter", || encode_png(image, png::Compression::Fast, None).len()),
        case("`png` Balanced, adaptive (zlib-rs 6)", || {
            encode_png(image, png::Compression::Balanced, png::Filter::Adaptive).len()
        }),
        case("`png` level 9, adaptive (zlib-rs)", || encode_png_level(image, 9, png::Filter::Adaptive).len()),
        case("zlib-rs Huffman only, Paeth", || {
            stripes(image, |data| deflate_zlib_rs(data, 1, zlib_rs::Strategy::HuffmanOnly)).len()
        }),
    ];
    for level in [1, 2, 6] {
        let deflate = move |data: &[u8]| deflate_zlib_rs(data, level, zlib_rs::Strategy::Default);
        cases.push(case(format!("zlib-rs {level}, Paeth"), move || stripes(image, deflate).len()));
    }
    for level in [1, 4, 8] {
        cases.push(case(format!("libdeflate {level}, Paeth"), move || deflate_libdeflate(image, level)));
    }
    assert!(inflates(image, |d| deflate_zlib_rs(d, 2, zlib_rs::Strategy::Default)), "zlib-rs");
    assert!(inflates(image, deflate_miniz), "miniz_oxide");
    cases.push(case("miniz_oxide 1, Paeth", move || stripes(image, deflate_miniz).len()));
    if image.bpp == 3 {
        cases.push(case("mtpng Fast, 1 thread", move || encode_mtpng(image)));
    }
    measure(title, image.samples.len(), rounds, &cases);
}

fn encode_png(image: &Image, compression: png::Compression, filter: impl Into<Option<png::Filter>>) -> Vec<u8> {
    let mut encoder = png_encoder(image);
    encoder.1.set_compression(compression);
    if let Some(filter) = filter.into() {
        encoder.1.set_filter(filter);
    }
    finish(encoder, image)
}

fn encode_png_level(image: &Image, level: u8, filter: png::Filter) -> Vec<u8> {
    let mut encoder = png_encoder(image);
    encoder.1.set_deflate_compression(png::DeflateCompression::Level(level));
    encoder.1.set_filter(filter);
    finish(encoder, image)
}

type Shared = std::rc::Rc<std::cell::RefCell<Vec<u8>>>;

struct SharedWriter(Shared);

impl std::io::Write for SharedWriter {
    fn write(&mut self, data: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(data);
        Ok(data.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn png_encoder(image: &Image) -> (Shared, png::Encoder<'static, SharedWriter>) {
    let out = Shared::default();
    let mut encoder = png::Encoder::new(SharedWriter(out.clone()), image.width as u32, image.height as u32);
    let (color, depth) = image.color();
    encoder.set_color(color);
    encoder.set_depth(depth);
    (out, encoder)
}

fn finish((out, encoder): (Shared, png::Encoder<'static, SharedWriter>), image: &Image) -> Vec<u8> {
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&image.samples).expect("an image");
    writer.finish().expect("an end");
    out.take()
}

/// Rows of a stripe: what one thread would take at a time.
const STRIPE: usize = 128;

/// One zlib stream from stripes that are filtered and deflated by themselves.
fn stripes(image: &Image, deflate: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    joined((0..image.height).step_by(STRIPE).map(|first| stripe(image, first, &deflate)))
}

/// A deflated stripe, with what the stream's checksum needs of it.
struct Stripe {
    deflated: Vec<u8>,
    adler: u32,
    length: usize,
}

fn stripe(image: &Image, first: usize, deflate: impl Fn(&[u8]) -> Vec<u8>) -> Stripe {
    let row = image.row();
    let rows = &image.samples[first * row..(first + STRIPE).min(image.height) * row];
    let above = (first > 0).then(|| &image.samples[(first - 1) * row..first * row]);
    let data = filtered(rows, above, row, image.bpp);
    let deflated = deflate(&data);
    // The checksum of the chunk that would hold the stripe.
    black_box(crc32fast::hash(&deflated));
    Stripe { deflated, adler: simd_adler32::adler32(&data.as_slice()), length: data.len() }
}

fn joined(stripes: impl Iterator<Item = Stripe>) -> Vec<u8> {
    let (mut out, mut adler) = (vec![0x78, 0x01], 1);
    for stripe in stripes {
        adler = adler_of_both(adler, stripe.adler, stripe.length);
        out.extend(stripe.deflated);
    }
    // An empty last block.
    out.extend([1, 0, 0, 0xFF, 0xFF]);
    out.extend(adler.to_be_bytes());
    out
}

/// Adler-32 of two pieces of data, the second `length` bytes long, from the checksums of each (RFC 1950).
fn adler_of_both(first: u32, second: u32, length: usize) -> u32 {
    const BASE: u64 = 65521;
    let (a1, b1, a2, b2) = (first & 0xFFFF, first >> 16, second & 0xFFFF, second >> 16);
    let [a1, b1, a2, b2] = [a1, b1, a2, b2].map(u64::from);
    // The second piece's sums started at 1 and 0 instead of a1 and b1.
    let before = a1 + BASE - 1;
    let a = (a2 + before) % BASE;
    let b = (b1 + b2 + length as u64 % BASE * before) % BASE;
    (b << 16 | a) as u32
}

/// Whether the stripes' stream inflates to the filtered rows.
fn inflates(image: &Image, deflate: impl Fn(&[u8]) -> Vec<u8>) -> bool {
    let plain: Vec<u8> =
        (0..image.height).step_by(STRIPE).flat_map(|first| stripe(image, first, <[u8]>::to_vec).deflated).collect();
    let mut out = vec![0; plain.len()];
    let stream = stripes(image, deflate);
    libdeflater::Decompressor::new().zlib_decompress(&stream, &mut out).is_ok() && out == plain
}

fn deflate_zlib_rs(data: &[u8], level: i32, strategy: zlib_rs::Strategy) -> Vec<u8> {
    let config = zlib_rs::DeflateConfig { window_bits: -15, level, strategy, ..Default::default() };
    let mut deflate = zlib_rs::Deflate::new_with_config(config);
    let mut out = vec![0; data.len() + data.len() / 8 + 1024];
    deflate.compress(data, &mut out, zlib_rs::DeflateFlush::FullFlush).expect("deflate");
    assert_eq!(deflate.total_in() as usize, data.len());
    out.truncate(deflate.total_out() as usize);
    out
}

/// libdeflate ends every stream, so its stripes do not concatenate; the whole image at once.
fn deflate_libdeflate(image: &Image, level: i32) -> usize {
    let data = filtered(&image.samples, None, image.row(), image.bpp);
    let mut compressor = libdeflater::Compressor::new(libdeflater::CompressionLvl::new(level).expect("a level"));
    let mut out = vec![0; compressor.zlib_compress_bound(data.len())];
    let length = compressor.zlib_compress(&data, &mut out).expect("room");
    black_box(crc32fast::hash(&out[..length]));
    length
}

fn deflate_miniz(data: &[u8]) -> Vec<u8> {
    use miniz_oxide::deflate::{core, stream};
    let flags = core::create_comp_flags_from_zip_params(1, -15, 0);
    let mut compressor = core::CompressorOxide::new(flags);
    let mut out = vec![0; data.len() + data.len() / 8 + 1024];
    let result = stream::deflate(&mut compressor, data, &mut out, miniz_oxide::MZFlush::Full);
    assert_eq!(result.bytes_consumed, data.len());
    out.truncate(result.bytes_written);
    out
}

fn encode_mtpng(image: &Image) -> usize {
    use mtpng::{
        ColorType, CompressionLevel, Header,
        encoder::{Encoder, Options},
    };
    let pool = threads(1);
    let mut options = Options::new();
    options.set_thread_pool(&pool).expect("a pool");
    options.set_compression_level(CompressionLevel::Fast).expect("a level");
    let mut header = Header::new();
    header.set_size(image.width as u32, image.height as u32).expect("a size");
    header.set_color(ColorType::Truecolor, 8).expect("a colour");
    let mut encoder = Encoder::new(Vec::new(), &options);
    encoder.write_header(&header).expect("a header");
    encoder.write_image_rows(&image.samples).expect("an image");
    encoder.finish().expect("an end").len()
}

fn threads(count: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("a pool")
}
