//! What `fast` precision costs: its codes and directions beside those of `exact`, on every backend of this machine.
//!
//! ```text
//! cargo bench --bench accuracy                                       # all
//! cargo bench --bench accuracy -- tangents                           # tangents alone; or maps
//! TEXBAKE_MODELS=target/models cargo bench --bench accuracy -- tangents
//! ```
//!
//! The maps are noise of every steepness from flat to vertical, 16-bit and float heights, 1024 x 1024. The angle is
//! between the fast and the exact normal as floats, before any code is rounded. Blends and parallax maps have codes
//! alone: blends are of the normal maps of the noise and of the same noise turned around, weighted 1 and -1/2. Tangents
//! are of a torus, a sphere, a heightfield and, if TEXBAKE_MODELS names their folder, of real models.

mod tangents;

use texbake::{
    Baker, BlendInputs, BlendMethod, BlendOptions, CodesRef, Depth, Encoding, Filter, Grid, HeightMap, NormalFormat,
    NormalMap, NormalOptions, ParallaxFormat, ParallaxOptions, Precision, Rational, Result, Scale,
};

const SIDE: usize = 1024;
const SEED: u64 = 1;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let is_wanted = |name: &str| arguments.is_empty() || arguments.iter().any(|argument| argument == name);
    let bakers = bakers();
    if is_wanted("maps") {
        print_maps(&bakers)?;
    }
    if is_wanted("tangents") {
        tangents::print(&bakers)?;
    }
    Ok(())
}

fn print_maps(bakers: &[Baker]) -> Result<()> {
    println!(
        "{:<34} {:<8} {:>22} {:>22} {:>26}",
        "backend", "heights", "8-bit codes that differ", "16-bit", "angle, degrees"
    );
    println!(
        "{:<34} {:<8} {:>12} {:>10} {:>12} {:>9} {:>13} {:>12}",
        "", "", "share", "most", "share", "most", "mean", "most"
    );
    for baker in bakers {
        for (name, map) in [("u16", steepnesses_u16()?), ("f32", steepnesses_f32()?)] {
            let [bits8, bits16] = [Depth::Bits8, Depth::Bits16].map(|depth| codes(baker, &map, Encoding::Unorm, depth));
            let (mean, most) = angles(baker, &map)?;
            let [a, b] = [bits8?, bits16?];
            let short = baker.name().chars().take(34).collect::<String>();
            println!(
                "{short:<34} {name:<8} {:>12.1e} {:>10} {:>12.1e} {:>9} {mean:>13.1e} {most:>12.1e}",
                a.0, a.1, b.0, b.1
            );
        }
        let maps = NormalMaps::new()?;
        for (name, method) in methods()? {
            let [a, b] = [Depth::Bits8, Depth::Bits16].map(|depth| maps.blended(baker, method, depth));
            print_codes(baker, name, a?, b?);
        }
        for (name, map) in [("u16 to parallax", steepnesses_u16()?), ("f32 to parallax", parallax_heights()?)] {
            let [a, b] = [Depth::Bits8, Depth::Bits16].map(|depth| parallaxes(baker, &map, depth));
            print_codes(baker, name, a?, b?);
        }
    }
    Ok(())
}

fn print_codes(baker: &Baker, name: &str, a: (f64, u32), b: (f64, u32)) {
    let short = baker.name().chars().take(34).collect::<String>();
    println!("{short:<34} {name:<16} {:>4.1e} {:>10} {:>12.1e} {:>9}", a.0, a.1, b.0, b.1);
}

fn methods() -> Result<[(&'static str, BlendMethod); 4]> {
    let weighted = BlendMethod::Weighted { base: 1.into(), detail: Rational::new(-1, 2)? };
    Ok([
        ("blend add", BlendMethod::add()),
        ("blend weighted", weighted),
        ("blend linear", BlendMethod::Linear),
        ("blend rnm", BlendMethod::Rnm),
    ])
}

/// Two maps of 8 bits and two of 16.
struct NormalMaps {
    bits8: [NormalMap; 2],
    bits16: [NormalMap; 2],
}

impl NormalMaps {
    fn new() -> Result<Self> {
        let maps = |depth| -> Result<[NormalMap; 2]> {
            let format = NormalFormat { depth, ..NormalFormat::default() };
            let options = NormalOptions { scale: Scale::texels(24), format, ..NormalOptions::default() };
            Ok([
                Baker::cpu().normal(&steepnesses_u16()?, &options)?,
                Baker::cpu().normal(&turned_steepnesses_u16()?, &options)?,
            ])
        };
        Ok(Self { bits8: maps(Depth::Bits8)?, bits16: maps(Depth::Bits16)? })
    }

    /// Share of the codes of a blend that differ, and the largest difference; inputs have the result's depth.
    fn blended(&self, baker: &Baker, method: BlendMethod, depth: Depth) -> Result<(f64, u32)> {
        let [base, detail] = if depth == Depth::Bits8 { &self.bits8 } else { &self.bits16 };
        let blend = |precision| {
            let format = NormalFormat { depth, ..NormalFormat::default() };
            let options = BlendOptions { method, format, precision, ..BlendOptions::default() };
            Ok(numbers(baker.blend(&BlendInputs { base, detail, mask: None }, &options)?.codes()))
        };
        Ok(differing(&blend(Precision::Exact)?, &blend(Precision::Fast)?))
    }
}

/// Share of the codes of a parallax map that differ, and the largest difference.
fn parallaxes(baker: &Baker, map: &HeightMap, depth: Depth) -> Result<(f64, u32)> {
    let bake = |precision| {
        // Biased codes differ as signed ones do, and are numbers as they stand.
        let format = ParallaxFormat { encoding: Encoding::Biased, depth };
        let options = ParallaxOptions { scale: Scale::texels(24), format, precision, ..ParallaxOptions::default() };
        Ok(numbers(baker.parallax(map, &options)?.codes()))
    };
    Ok(differing(&bake(Precision::Exact)?, &bake(Precision::Fast)?))
}

fn bakers() -> Vec<Baker> {
    let gpus = texbake::devices().into_iter().filter(|device| device.api != "cpu");
    let opened = gpus.filter_map(|device| Baker::gpu(Some(&format!("{}:{}", device.api, device.name))).ok());
    std::iter::once(Baker::cpu()).chain(opened).collect()
}

/// Share of the codes that differ, and the largest difference.
fn codes(baker: &Baker, map: &HeightMap, encoding: Encoding, depth: Depth) -> Result<(f64, u32)> {
    let [exact, fast] = both(baker, map, encoding, depth)?;
    Ok(differing(&exact, &fast))
}

fn differing(exact: &[f64], fast: &[f64]) -> (f64, u32) {
    let off: Vec<u32> = exact.iter().zip(fast).map(|(a, b)| (a - b).abs() as u32).collect();
    let differ = off.iter().filter(|off| **off > 0).count();
    (differ as f64 / off.len() as f64, off.into_iter().max().unwrap_or(0))
}

fn numbers(codes: CodesRef<'_>) -> Vec<f64> {
    match codes {
        CodesRef::U8(codes) => codes.iter().map(|code| f64::from(*code)).collect(),
        CodesRef::U16(codes) => codes.iter().map(|code| f64::from(*code)).collect(),
        CodesRef::F16(codes) => codes.iter().map(|code| code.to_f64()).collect(),
        CodesRef::F32(codes) => codes.iter().map(|code| f64::from(*code)).collect(),
    }
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
        Ok(numbers(baker.normal(map, &options)?.codes()))
    };
    Ok([bake(Precision::Exact)?, bake(Precision::Fast)?])
}

/// Noise whose amplitude doubles every 64 columns.
fn steepnesses_u16() -> Result<HeightMap> {
    let mut noise = noise();
    Ok(Grid::from_fn(SIDE, SIDE, |x, _| (noise() >> (15 - x / 64)) as u16)?.into())
}

/// The same noise, turned around.
fn turned_steepnesses_u16() -> Result<HeightMap> {
    let mut noise = noise();
    Ok(Grid::from_fn(SIDE, SIDE, |x, _| (noise() >> (x / 64)) as u16)?.into())
}

/// Heights in [0, 1] whose slopes double every 64 columns.
fn parallax_heights() -> Result<HeightMap> {
    let mut noise = noise();
    Grid::from_fn(SIDE, SIDE, |x, _| 0.3 + noise() as f32 / 65536.0 * 2f32.powi((x / 64) as i32 - 16))?.try_into()
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
