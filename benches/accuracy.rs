//! What `fast` precision costs: its codes and directions beside those of `exact`, on every backend of this machine.
//!
//! ```text
//! cargo bench --bench accuracy
//! ```
//!
//! The maps are noise of every steepness from flat to vertical, 16-bit and float heights, 1024 x 1024. The angle is
//! between the fast and the exact normal as floats, before any code is rounded.

use texbake::{
    Baker, CodesRef, Depth, Encoding, Filter, Grid, HeightMap, NormalFormat, NormalOptions, Precision, Result, Scale,
};

const SIDE: usize = 1024;
const SEED: u64 = 1;

fn main() -> Result<()> {
    println!(
        "{:<34} {:<8} {:>22} {:>22} {:>26}",
        "backend", "heights", "8-bit codes that differ", "16-bit", "angle, degrees"
    );
    println!(
        "{:<34} {:<8} {:>12} {:>10} {:>12} {:>9} {:>13} {:>12}",
        "", "", "share", "most", "share", "most", "mean", "most"
    );
    for baker in bakers() {
        for (name, map) in [("u16", steepnesses_u16()?), ("f32", steepnesses_f32()?)] {
            let [bits8, bits16] =
                [Depth::Bits8, Depth::Bits16].map(|depth| codes(&baker, &map, Encoding::Unorm, depth));
            let (mean, most) = angles(&baker, &map)?;
            let [a, b] = [bits8?, bits16?];
            let short = baker.name().chars().take(34).collect::<String>();
            println!(
                "{short:<34} {name:<8} {:>12.1e} {:>10} {:>12.1e} {:>9} {mean:>13.1e} {most:>12.1e}",
                a.0, a.1, b.0, b.1
            );
        }
    }
    Ok(())
}

fn bakers() -> Vec<Baker> {
    let gpus = texbake::devices().into_iter().filter(|device| device.api != "cpu");
    let opened = gpus.filter_map(|device| Baker::gpu(Some(&format!("{}:{}", device.api, device.name))).ok());
    std::iter::once(Baker::cpu()).chain(opened).collect()
}

/// Share of the codes that differ, and the largest difference.
fn codes(baker: &Baker, map: &HeightMap, encoding: Encoding, depth: Depth) -> Result<(f64, u32)> {
    let [exact, fast] = both(baker, map, encoding, depth)?;
    let off: Vec<u32> = exact.iter().zip(&fast).map(|(a, b)| (a - b).abs() as u32).collect();
    let differ = off.iter().filter(|off| **off > 0).count();
    Ok((differ as f64 / off.len() as f64, off.into_iter().max().unwrap_or(0)))
}

/// Mean and largest angle between the normals, in degrees.
fn angles(baker: &Baker, map: &HeightMap) -> Result<(f64, f64)> {
    let [exact, fast] = both(baker, map, Encoding::Float, Depth::Float32)?;
    let angles: Vec<f64> = exact.chunks(3).zip(fast.chunks(3)).map(|(a, b)| angle(a, b)).collect();
    Ok((angles.iter().sum::<f64>() / angles.len() as f64, angles.iter().copied().fold(0.0, f64::max)))
}

/// From the chord, which keeps its digits where a cosine would lose them.
fn angle(a: &[f64], b: &[f64]) -> f64 {
    let chord = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    (2.0 * (chord / 2.0).min(1.0).asin()).to_degrees()
}

fn both(baker: &Baker, map: &HeightMap, encoding: Encoding, depth: Depth) -> Result<[Vec<f64>; 2]> {
    let bake = |precision| {
        let format = NormalFormat { encoding, depth, ..Default::default() };
        let options = NormalOptions {
            scale: Scale::texels(24),
            filter: Filter::Central,
            format,
            precision,
            ..Default::default()
        };
        let baked = baker.normal(map, &options)?;
        Ok(match baked.codes() {
            CodesRef::U8(codes) => codes.iter().map(|code| f64::from(*code)).collect(),
            CodesRef::U16(codes) => codes.iter().map(|code| f64::from(*code)).collect(),
            CodesRef::F16(codes) => codes.iter().map(|code| code.to_f64()).collect(),
            CodesRef::F32(codes) => codes.iter().map(|code| f64::from(*code)).collect(),
        })
    };
    Ok([bake(Precision::Exact)?, bake(Precision::Fast)?])
}

/// Noise whose amplitude doubles every 64 columns.
fn steepnesses_u16() -> Result<HeightMap> {
    let mut noise = noise();
    Ok(Grid::from_fn(SIDE, SIDE, |x, _| (noise() >> (15 - x / 64)) as u16)?.into())
}

/// The same over many more powers of two.
fn steepnesses_f32() -> Result<HeightMap> {
    let mut noise = noise();
    Grid::from_fn(SIDE, SIDE, |x, _| noise() as f32 / 65536.0 * 2f32.powi((x / 8) as i32 - 64))?.try_into()
}

/// 16 random bits a call (Knuth's MMIX generator).
fn noise() -> impl FnMut() -> u32 {
    let mut state = SEED;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 48) as u32
    }
}
