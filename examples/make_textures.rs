//! Draws the height maps under `examples/textures`: small, tileable, one of each kind of file.
//!
//!     cargo run --release --example make_textures
//!
//! Every map repeats without a seam, because everything is drawn on a torus: noise has a lattice that wraps, and
//! distances are taken to the nearest copy.

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes, LineOrder,
    WritableImage,
};
use std::error::Error;
use std::f32::consts::{PI, TAU};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A height for each place (u, v) in [0, 1) x [0, 1).
type Surface = fn(f32, f32) -> f32;

fn main() -> Result<()> {
    let folder = Path::new("examples/textures");
    for sub in ["walls", "ground", "cloth", "terrain"] {
        std::fs::create_dir_all(folder.join(sub))?;
    }
    png(&folder.join("walls/bricks_height.png"), 512, 16, bricks)?;
    png(&folder.join("ground/pebbles_disp.png"), 512, 8, pebbles)?;
    png(&folder.join("cloth/weave_h.png"), 256, 8, weave)?;
    exr(&folder.join("terrain/dunes_height.exr"), 256, dunes)?;
    tiff(&folder.join("terrain/terrain_height.tif"), 256, mountains)?;
    Ok(())
}

/// Bricks in running bond: bevelled, worn, each at its own depth, in recessed mortar.
fn bricks(u: f32, v: f32) -> f32 {
    const ROWS: f32 = 8.0;
    const COLUMNS: f32 = 4.0;
    // No edge of a worn brick is straight.
    let (u, v) = (u + 0.004 * (fbm(u, v, 16, 3, 1) - 0.5), v + 0.006 * (fbm(u, v, 16, 3, 2) - 0.5));
    let row = (v * ROWS).floor();
    let shift = if row as i32 % 2 == 0 { 0.0 } else { 0.5 };
    let along = u * COLUMNS + shift;
    let column = along.floor();
    // Distance to the brick's border in units of its height.
    let x = (0.5 - (along - column - 0.5).abs()) * ROWS / COLUMNS;
    let y = 0.5 - (v * ROWS - row - 0.5).abs();
    let inside = smooth_min(x, y, 0.06) - 0.05;
    let brick = hash(column.rem_euclid(COLUMNS) as i32, row.rem_euclid(ROWS) as i32, 3);
    let bevel = smoothstep(0.0, 0.09, inside);
    let grain = fbm(u, v, 32, 4, 4) - 0.5;
    let pits = smoothstep(0.62, 0.8, fbm(u, v, 24, 3, 5));
    let tilt = (brick - 0.5) * 0.1 * (along - column - 0.5);
    let face = 0.78 + 0.14 * (brick - 0.5) + tilt + 0.09 * grain - 0.08 * pits;
    let mortar = 0.28 + 0.12 * (fbm(u, v, 64, 3, 6) - 0.5);
    mortar + (face - mortar) * bevel
}

/// Pebbles: rounded stones of many sizes, lying over each other and over sand.
fn pebbles(u: f32, v: f32) -> f32 {
    let sand = 0.10 + 0.10 * fbm(u, v, 32, 4, 10);
    let layers = [(26, 0.34, 11), (15, 0.50, 12), (9, 0.66, 13)];
    layers
        .iter()
        .fold(sand, |ground, (cells, height, seed)| smooth_max(ground, height * stones(u, v, *cells, *seed), 0.02))
}

/// The tallest of one layer's stones at a place: one half-ellipsoid per cell of a jittered lattice.
fn stones(u: f32, v: f32, cells: i32, seed: u32) -> f32 {
    let (x, y) = (u * cells as f32, v * cells as f32);
    let (column, row) = (x.floor() as i32, y.floor() as i32);
    let mut tallest = 0.0f32;
    for (i, j) in (-1..=1).flat_map(|j| (-1..=1).map(move |i| (column + i, row + j))) {
        let random = |salt| hash(i.rem_euclid(cells), j.rem_euclid(cells), seed * 8 + salt);
        let (dx, dy) = (x - i as f32 - 0.25 - 0.5 * random(0), y - j as f32 - 0.25 - 0.5 * random(1));
        let (sin, cos) = (random(2) * TAU).sin_cos();
        let (along, across) = (dx * cos + dy * sin, dy * cos - dx * sin);
        let size = 0.42 + 0.30 * random(3);
        let (along, across) = (along / size, across / (size * (0.62 + 0.3 * random(4))));
        let inside = 1.0 - along * along - across * across;
        if inside > 0.0 {
            tallest = tallest.max(inside.sqrt() * (0.7 + 0.3 * random(5)));
        }
    }
    tallest * (1.0 + 0.06 * (fbm(u, v, 48, 3, seed) - 0.5))
}

/// A plain weave: threads that pass over and under each other, each twisted from fibres.
fn weave(u: f32, v: f32) -> f32 {
    const THREADS: f32 = 12.0;
    let (x, y) = (u * THREADS, v * THREADS);
    let (column, row) = (x.floor(), y.floor());
    // The warp passes over the weft at every second crossing, and the weft over the warp at the others.
    let over = if (column + row) as i32 % 2 == 0 { 1.0 } else { -1.0 };
    let (across_x, across_y) = (x - column - 0.5, y - row - 0.5);
    let round = |across: f32| (1.0 - (across / 0.46).powi(2)).max(0.0).sqrt();
    let fibres = |along: f32, across: f32| (TAU * (3.0 * along + 2.0 * across)).sin();
    let warp = round(across_x) * (0.62 + 0.26 * over * (PI * across_y).cos() + 0.03 * fibres(y, across_x));
    let weft = round(across_y) * (0.62 - 0.26 * over * (PI * across_x).cos() + 0.03 * fibres(x, across_y));
    0.06 + 0.9 * warp.max(weft) + 0.05 * fbm(u, v, 64, 2, 20)
}

/// Dunes: gentle to the wind, steep to the lee, with ripples across them. In metres, 12 from trough to crest.
fn dunes(u: f32, v: f32) -> f32 {
    let bend = 0.5 * fbm(u, v, 3, 3, 30) + 0.12 * (TAU * u).sin();
    let phase = (3.0 * (v + bend * 0.6)).rem_euclid(1.0);
    let profile = if phase < 0.72 { smoothstep(0.0, 1.0, phase / 0.72) } else { 1.0 - smoothstep(0.72, 1.0, phase) };
    let size = 0.45 + 0.55 * fbm(u, v, 4, 3, 31);
    let ripples = (TAU * (40.0 * v + 3.0 * fbm(u, v, 6, 3, 32) + (TAU * u).sin())).sin();
    12.0 * profile * size + 0.05 * ripples + 0.3 * fbm(u, v, 16, 4, 33)
}

/// Mountains: ridges where gradient noise crosses zero, rough where they are high and smooth in the valleys.
fn mountains(u: f32, v: f32) -> f32 {
    let bend = |seed| 0.06 * gradient_noise(u, v, 4, seed) + 0.02 * gradient_noise(u, v, 9, seed + 1);
    let (u, v) = (u + bend(40), v + bend(42));
    let (mut height, mut weight, mut amplitude) = (0.25 * gradient_noise(u, v, 3, 44), 1.0f32, 0.5);
    for octave in 0..6 {
        let ridge = 1.0 - (1.4 * gradient_noise(u, v, 5 << octave, 45 + octave)).abs().min(1.0);
        let ridge = ridge * ridge * weight;
        weight = (1.6 * ridge).clamp(0.0, 1.0);
        height += amplitude * ridge;
        amplitude *= 0.45;
    }
    height
}

/// Perlin's gradient noise, about [-1, 1], on a lattice that wraps after `cells` cells.
fn gradient_noise(u: f32, v: f32, cells: i32, seed: u32) -> f32 {
    let (x, y) = (u * cells as f32, v * cells as f32);
    let (column, row) = (x.floor(), y.floor());
    let (dx, dy) = (x - column, y - row);
    let slope = |i: i32, j: i32| {
        let turn = hash((column as i32 + i).rem_euclid(cells), (row as i32 + j).rem_euclid(cells), seed) * TAU;
        turn.cos() * (dx - i as f32) + turn.sin() * (dy - j as f32)
    };
    let (s, t) = (ease(dx), ease(dy));
    let above = slope(0, 0) + (slope(1, 0) - slope(0, 0)) * s;
    let below = slope(0, 1) + (slope(1, 1) - slope(0, 1)) * s;
    1.4 * (above + (below - above) * t)
}

/// A step without first and second derivatives at its ends (Perlin 2002).
fn ease(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// Fractal noise in [0, 1]: octaves of value noise, the first with `cells` cells on each side.
fn fbm(u: f32, v: f32, cells: i32, octaves: u32, seed: u32) -> f32 {
    let octave = |i: u32| noise(u, v, cells << i, seed.wrapping_mul(31) + i) / (1 << i) as f32;
    (0..octaves).map(octave).sum::<f32>() / (2.0 - 2.0 / (1 << octaves) as f32)
}

/// Value noise in [0, 1] on a lattice that wraps after `cells` cells, quintic between its points.
fn noise(u: f32, v: f32, cells: i32, seed: u32) -> f32 {
    let (x, y) = (u * cells as f32, v * cells as f32);
    let (column, row) = (x.floor() as i32, y.floor() as i32);
    let (s, t) = (ease(x - x.floor()), ease(y - y.floor()));
    let at = |i: i32, j: i32| hash((column + i).rem_euclid(cells), (row + j).rem_euclid(cells), seed);
    let above = at(0, 0) + (at(1, 0) - at(0, 0)) * s;
    let below = at(0, 1) + (at(1, 1) - at(0, 1)) * s;
    above + (below - above) * t
}

/// A number in [0, 1) for each lattice point: the finaliser of MurmurHash3 over its coordinates.
fn hash(x: i32, y: i32, seed: u32) -> f32 {
    let (x, y) = ((x as u32).wrapping_mul(0x9e37_79b1), (y as u32).wrapping_mul(0x85eb_ca77));
    let mut h = x ^ y.rotate_left(13) ^ seed.wrapping_mul(0xc2b2_ae3d);
    h = (h ^ h >> 16).wrapping_mul(0x85eb_ca6b);
    h = (h ^ h >> 13).wrapping_mul(0xc2b2_ae35);
    (h ^ h >> 16) as f32 / 4_294_967_296.0
}

fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The lesser of two, rounded over a width of `k`.
fn smooth_min(a: f32, b: f32, k: f32) -> f32 {
    let h = (0.5 + 0.5 * (b - a) / k).clamp(0.0, 1.0);
    b + (a - b) * h - k * h * (1.0 - h)
}

fn smooth_max(a: f32, b: f32, k: f32) -> f32 {
    -smooth_min(-a, -b, k)
}

/// The heights of a square map, row by row.
fn draw(side: usize, surface: Surface) -> Vec<f32> {
    let place = |i: usize| (i as f32 + 0.5) / side as f32;
    (0..side * side).map(|i| surface(place(i % side), place(i / side))).collect()
}

/// Codes of heights stretched to the whole of [0, greatest].
fn codes(heights: &[f32], greatest: f32) -> impl Iterator<Item = u16> {
    let low = heights.iter().copied().fold(f32::INFINITY, f32::min);
    let high = heights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    heights.iter().map(move |height| ((height - low) / (high - low) * greatest + 0.5) as u16)
}

fn png(path: &Path, side: usize, bits: u8, surface: Surface) -> Result<()> {
    let heights = draw(side, surface);
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), side as u32, side as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::High);
    let bytes: Vec<u8> = if bits == 8 {
        encoder.set_depth(png::BitDepth::Eight);
        codes(&heights, 255.0).map(|code| code as u8).collect()
    } else {
        encoder.set_depth(png::BitDepth::Sixteen);
        codes(&heights, 65535.0).flat_map(u16::to_be_bytes).collect()
    };
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    Ok(writer.finish()?)
}

fn tiff(path: &Path, side: usize, surface: Surface) -> Result<()> {
    use tiff::encoder::{Compression, DeflateLevel, TiffEncoder, colortype::Gray16};
    let codes: Vec<u16> = codes(&draw(side, surface), 65535.0).collect();
    let encoder = TiffEncoder::new(BufWriter::new(File::create(path)?))?;
    let mut encoder = encoder.with_compression(Compression::Deflate(DeflateLevel::Best));
    Ok(encoder.write_image::<Gray16>(side as u32, side as u32, &codes)?)
}

fn exr(path: &Path, side: usize, surface: Surface) -> Result<()> {
    let channel = AnyChannel::new("height", FlatSamples::F32(draw(side, surface)));
    let channels = AnyChannels::sort([channel].into_iter().collect());
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let layer = Layer::new((side, side), LayerAttributes::named("dunes"), encoding, channels);
    Ok(Image::from_layer(layer).write().to_file(path)?)
}
