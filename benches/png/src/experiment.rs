//! Scratch: sizes of stripes.
use super::{deflate::{BitWriter, deflate}, filter::Filter};
use crate::Image;
use std::time::Instant;
use cpu_time::ProcessTime;

pub fn rows_filtered(image: &Image, choose: &mut dyn FnMut(&[u8], &[u8], usize, &mut Vec<u8>)) -> Vec<u8> {
    let row = image.row();
    let zero = vec![0; row];
    let mut above = &zero[..];
    let mut out = Vec::new();
    for r in image.samples.chunks_exact(row) {
        choose(r, above, image.bpp, &mut out);
        above = r;
    }
    out
}
fn stripes_of(f: &[u8], row: usize) -> Vec<&[u8]> {
    f.chunks((512 << 10) / row.max(1) * (row + 1)).collect()
}
fn sized(d: &[u8], n: usize) -> usize { d.chunks(n).map(|d| { let mut w = BitWriter::default(); deflate(d, &mut w); w.bytes().len() - 5 }).sum() }
fn entropy(bytes: &[u8]) -> f64 {
    let mut c = [0u32; 256];
    for b in bytes { c[*b as usize] += 1; }
    let n = bytes.len() as f64;
    c.iter().filter(|c| **c > 0).map(|c| f64::from(*c) * (n / f64::from(*c)).log2()).sum()
}
fn zlib(data: &[u8], level: i32, strategy: zlib_rs::Strategy) -> usize {
    let config = zlib_rs::DeflateConfig { window_bits: -15, level, strategy, ..Default::default() };
    let mut d = zlib_rs::Deflate::new_with_config(config);
    let mut out = vec![0; data.len() + data.len() / 8 + 1024];
    d.compress(data, &mut out, zlib_rs::DeflateFlush::FullFlush).expect("deflate");
    d.total_out() as usize
}
fn miniz(data: &[u8], level: u8) -> usize {
    use miniz_oxide::deflate::{core, stream};
    let flags = core::create_comp_flags_from_zip_params(level.into(), -15, 0);
    let mut c = core::CompressorOxide::new(flags);
    let mut out = vec![0; data.len() + data.len() / 8 + 1024];
    stream::deflate(&mut c, data, &mut out, miniz_oxide::MZFlush::Full).bytes_written
}
fn zop(data: &[u8]) -> usize {
    let mut out = Vec::new();
    zopfli::compress(zopfli::Options { iteration_count: 5.try_into().unwrap(), ..Default::default() }, zopfli::Format::Deflate, data, &mut out).unwrap();
    out.len()
}
pub fn run(name: &str, image: &Image, slow: bool) {
    let all = [Filter::Sub, Filter::Up, Filter::Average, Filter::Paeth];
    let mut tries: Vec<Vec<u8>> = vec![Vec::new(); 4];
    let mut by = |score: &dyn Fn(&[u8]) -> f64| {
        rows_filtered(image, &mut |r, a, t, out| {
            let mut best = (f64::MAX, 0);
            for (k, f) in all.iter().enumerate() {
                tries[k].clear();
                f.apply(r, a, t, &mut tries[k]);
                let s = score(&tries[k][1..]);
                if s < best.0 { best = (s, k); }
            }
            out.extend_from_slice(&tries[best.1]);
        })
    };
    println!("\n## {name}: {:.3} MB raw", image.samples.len() as f64 / 1e6);
    let t = ProcessTime::now();
    let sad = by(&|b| b.iter().map(|b| f64::from((*b as i8).unsigned_abs())).sum());
    let ts = t.elapsed();
    let t = ProcessTime::now();
    let ent = by(&entropy);
    println!("sad {:.3?} ent {:.3?}", ts, t.elapsed());
    let mut fixed: Vec<(String, Vec<u8>)> = all.iter().map(|f| (format!("{f:?}"), rows_filtered(image, &mut |r, a, t, o| f.apply(r, a, t, o)))).collect();
    fixed.push(("sad".into(), sad));
    fixed.push(("entropy".into(), ent));
    type F<'a> = (&'a str, Box<dyn Fn(&[u8]) -> usize>);
    let mut coders: Vec<F> = vec![
        ("own", Box::new(|d: &[u8]| { let mut w = BitWriter::default(); deflate(d, &mut w); w.bytes().len() })),
        ("own 64", Box::new(|d: &[u8]| sized(d, 64 << 10))),
        ("own 32", Box::new(|d: &[u8]| sized(d, 32 << 10))),
        ("own 16", Box::new(|d: &[u8]| sized(d, 16 << 10))),
        ("own 8", Box::new(|d: &[u8]| sized(d, 8 << 10))),
        ("zlib-rs huff", Box::new(|d: &[u8]| zlib(d, 6, zlib_rs::Strategy::HuffmanOnly))),
        ("zlib-rs 9", Box::new(|d: &[u8]| zlib(d, 9, zlib_rs::Strategy::Default))),
    ];
    if false && slow { coders.push(("zopfli", Box::new(zop))); }
    for (c, code) in &coders {
        for (f, data) in &fixed[2..] {
            let (t, _w) = (ProcessTime::now(), Instant::now());
            let n: usize = stripes_of(data, image.row()).iter().map(|s| code(s)).sum();
            let el = t.elapsed().as_secs_f64();
            println!("{c:20} {f:8} {:9.3} MB  {:6.1} MB/s", n as f64 / 1e6, data.len() as f64 / 1e6 / el);
        }
    }
}
