//! Maps of chosen normals, and maps with planted faults.

use crate::support::Random;
use half::f16;
use texbake::inspect::{CheckOptions, Findings, Problem, Texel, check};
use texbake::stream::Monitor;
use texbake::{
    Baker, Channels, Codes, CodesRef, Convention, Depth, Encoding, Grid, HeightMap, NormalFormat, NormalMap,
    NormalOptions, Scale, Size,
};

/// Bumps over all directions that tile: whole waves, so that the last column meets the first.
pub fn waves(width: usize, height: usize) -> HeightMap {
    let turn = |n: usize, i: usize, of: usize| std::f64::consts::TAU * (n * i) as f64 / of as f64;
    let grid = Grid::from_fn(width, height, |x, y| {
        let h = (turn(2, x, width) + turn(1, y, height)).sin()
            + (turn(3, y, height) - turn(1, x, width)).sin()
            + 0.3 * (turn(5, x, width) + turn(7, y, height)).cos();
        (32_768.0 + 14_000.0 * h) as u16
    });
    grid.unwrap().into()
}

/// A sound map of `format`.
pub fn sound(width: usize, height: usize, format: NormalFormat) -> NormalMap {
    let options = NormalOptions { scale: Scale::texels(10), format, ..Default::default() };
    Baker::reference().normal(&waves(width, height), &options).unwrap()
}

/// A map of these directions, each component rounded to the nearest code in f64.
pub fn encoded(
    width: usize,
    height: usize,
    format: NormalFormat,
    mut normal: impl FnMut(usize, usize) -> [f64; 3],
) -> NormalMap {
    let channels = format.channels.count();
    let normals: Vec<f64> =
        (0..width * height).flat_map(|i| normal(i % width, i / width)[..channels].to_vec()).collect();
    let greatest = |bits: i32| match format.encoding {
        Encoding::Unorm => f64::from((1 << bits) - 1),
        _ => f64::from((1 << (bits - 1)) - 1),
    };
    let code = |v: &f64, bits: i32| match format.encoding {
        Encoding::Unorm => (greatest(bits) * (v + 1.0) / 2.0 + 0.5).floor() as i32,
        Encoding::Biased => (greatest(bits) * v).round() as i32 + (1 << (bits - 1)),
        _ => (greatest(bits) * v).round() as i32,
    };
    let codes = match format.depth {
        Depth::Bits8 => Codes::U8(normals.iter().map(|v| code(v, 8) as u8).collect()),
        Depth::Bits16 => Codes::U16(normals.iter().map(|v| code(v, 16) as u16).collect()),
        Depth::Float16 => Codes::F16(normals.iter().map(|v| f16::from_f64(*v)).collect()),
        Depth::Float32 => Codes::F32(normals.iter().map(|v| *v as f32).collect()),
    };
    NormalMap::new(Size::new(width, height).unwrap(), format, codes).unwrap()
}

/// The map with other codes in some texels.
pub fn planted<const N: usize>(map: &NormalMap, texels: &[(Texel, [f64; N])]) -> NormalMap {
    let (size, format) = (map.size(), map.format());
    assert_eq!(format.channels.count(), N);
    let places = texels.iter().flat_map(|(texel, codes)| {
        let first = (texel.y * size.width() + texel.x) * N;
        (first..).zip(*codes)
    });
    let mut codes = match map.codes() {
        CodesRef::U8(codes) => Codes::U8(codes.to_vec()),
        CodesRef::U16(codes) => Codes::U16(codes.to_vec()),
        CodesRef::F16(codes) => Codes::F16(codes.to_vec()),
        CodesRef::F32(codes) => Codes::F32(codes.to_vec()),
    };
    for (at, code) in places {
        match &mut codes {
            Codes::U8(codes) => codes[at] = code as u8,
            Codes::U16(codes) => codes[at] = code as u16,
            Codes::F16(codes) => codes[at] = f16::from_f64(code),
            Codes::F32(codes) => codes[at] = code as f32,
        }
    }
    NormalMap::new(size, format, codes).unwrap()
}

/// What is found in a map that shall tile.
pub fn findings(map: &NormalMap) -> Findings {
    check(map.clone().into_rows(), &CheckOptions { tiles: true }, &Monitor::default()).unwrap()
}

/// The problems that are found, faults first.
pub fn problems(map: &NormalMap) -> Vec<Problem> {
    findings(map).list.iter().map(|finding| finding.problem).collect()
}

pub fn texel(x: usize, y: usize) -> Texel {
    Texel { x, y }
}

/// `format` with two channels.
pub fn xy(format: NormalFormat) -> NormalFormat {
    NormalFormat { channels: Channels::Xy, ..format }
}

/// `format` with green down.
pub fn dx(format: NormalFormat) -> NormalFormat {
    NormalFormat { convention: Convention::Dx, ..format }
}

/// A height between 0 and 1 for each texel, without any order.
pub fn noise(seed: u64, width: usize, height: usize) -> HeightMap {
    let mut random = Random::new(seed);
    Grid::from_fn(width, height, |_, _| random.below(65_536) as u16).unwrap().into()
}
