//! Height maps, normal maps and masks of chosen kinds.

use crate::error::Result;
use crate::exact::CodeRounding;
use crate::map::{Channels, Codes, Depth, Encoding, Grid, HeightMap, HeightType, NormalFormat, NormalMap, Size};
use crate::verify::chance::Chance;
use half::f16;
use std::fmt;

/// What the numbers of an input are like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Any number is as likely.
    Random,
    /// Few different numbers: slopes of zero, ties of unorm codes, Pythagorean quadruples.
    Small,
    /// The ends of the range beside each other; floats of every exponent, subnormals and the greatest included.
    Extreme,
    /// Texels whose components lie as near to the middle between two codes as chance finds them.
    Boundaries,
}

pub(super) const KINDS: [Kind; 4] = [Kind::Random, Kind::Small, Kind::Extreme, Kind::Boundaries];

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Random => "random",
            Self::Small => "small",
            Self::Extreme => "extreme",
            Self::Boundaries => "boundaries",
        })
    }
}

/// Not a multiple of the four texels of an invocation, nor of a workgroup, and more than one of both.
const WIDTH: usize = 67;
const HEIGHT: usize = 12;

impl Kind {
    /// The usual size; sometimes one that is its own neighbour, two texels wide, or wider than a workgroup.
    pub fn size(self, chance: &mut Chance) -> Result<Size> {
        let usual = (WIDTH, HEIGHT);
        let (width, height) = match self {
            Self::Random | Self::Extreme => chance.of(&[usual, usual, usual, (1, 1), (1, 9), (2, 5), (4, 1), (300, 3)]),
            Self::Small | Self::Boundaries => usual,
        };
        Size::new(width, height)
    }
}

/// What is searched for boundaries: how steep a difference of heights is, and the codes that are stored.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boundary {
    /// Slope of a difference of 1 between the texels on either side, in codes of the heights.
    pub per_height: f64,
    /// Of a float map those of 8 bits are as good as any.
    pub codes: (Encoding, Depth),
}

/// A height map whose normals are stored as `near` says, for the kind that searches for boundaries.
pub(super) fn heights(kind: Kind, height_type: HeightType, near: Boundary, chance: &mut Chance) -> Result<HeightMap> {
    if kind == Kind::Boundaries {
        return near_boundaries(height_type, near, chance);
    }
    let size = kind.size(chance)?;
    any_heights(kind, height_type, size, chance)
}

/// A height map of any kind but boundaries.
pub(super) fn any_heights(kind: Kind, height_type: HeightType, size: Size, chance: &mut Chance) -> Result<HeightMap> {
    let (width, height) = (size.width(), size.height());
    Ok(match height_type {
        HeightType::U8 => Grid::from_fn(width, height, |_, _| code(kind, 255, chance) as u8)?.into(),
        HeightType::U16 => Grid::from_fn(width, height, |_, _| code(kind, 65_535, chance) as u16)?.into(),
        HeightType::F32 => Grid::from_fn(width, height, |_, _| float_height(kind, chance))?.try_into()?,
    })
}

fn code(kind: Kind, greatest: u32, chance: &mut Chance) -> u32 {
    match kind {
        Kind::Small => chance.below(5) as u32,
        Kind::Extreme => chance.of(&[0, 0, greatest, greatest, 1, greatest / 2, greatest - 1]),
        Kind::Random | Kind::Boundaries => chance.below(u64::from(greatest) + 1) as u32,
    }
}

fn float_height(kind: Kind, chance: &mut Chance) -> f32 {
    match kind {
        Kind::Small => chance.below(5) as f32 / 4.0,
        Kind::Extreme => {
            let ends = [0.0, -0.0, f32::MAX, f32::MIN, f32::MIN_POSITIVE, f32::from_bits(1), 1.0, -1.0];
            if chance.below(2) == 0 { chance.of(&ends) } else { chance.finite() }
        }
        // From -1/2 to 3/2: heights beyond 0 and 1 have slopes too.
        Kind::Random | Kind::Boundaries => 0.5 + chance.unit(),
    }
}

/// Heights whose texels in columns 4i + 1 and rows 3j + 1 have chosen differences to either side: those of 64 random
/// pairs whose normal comes nearest to a boundary between two codes.
fn near_boundaries(height_type: HeightType, near: Boundary, chance: &mut Chance) -> Result<HeightMap> {
    let greatest = f64::from(height_type.greatest_code().unwrap_or(65_535));
    let mut heights = vec![0.0; WIDTH * HEIGHT];
    for y in (1..HEIGHT - 1).step_by(3) {
        for x in (1..WIDTH - 1).step_by(4) {
            let mut any = || (chance.below(greatest as u64 + 1) as f64, chance.below(greatest as u64 + 1) as f64);
            let nearest = (0..64).map(|_| (any(), any())).min_by(|a, b| {
                let far = |(h, v): &((f64, f64), (f64, f64))| near.distance([h.1 - h.0, v.1 - v.0]);
                far(a).total_cmp(&far(b))
            });
            let ((west, east), (north, south)) = nearest.unwrap_or_default();
            let at = |x: usize, y: usize| y * WIDTH + x;
            heights[at(x - 1, y)] = west;
            heights[at(x + 1, y)] = east;
            heights[at(x, y - 1)] = north;
            heights[at(x, y + 1)] = south;
        }
    }
    Ok(match height_type {
        HeightType::U8 => Grid::new(WIDTH, HEIGHT, heights.iter().map(|&h| h as u8).collect())?.into(),
        HeightType::U16 => Grid::new(WIDTH, HEIGHT, heights.iter().map(|&h| h as u16).collect())?.into(),
        HeightType::F32 => {
            Grid::new(WIDTH, HEIGHT, heights.iter().map(|&h| (h / greatest) as f32).collect())?.try_into()?
        }
    })
}

impl Boundary {
    /// How far the components are from the middle between two codes, at the nearest of them.
    fn distance(&self, [gx, gy]: [f64; 2]) -> f64 {
        let [x, y] = [gx, gy].map(|sum| self.per_height * sum);
        let length = (x * x + y * y + 1.0).sqrt();
        let (encoding, depth) = self.codes;
        let greatest = encoding.greatest_code(depth).map_or(255.0, f64::from);
        let off = |part: f64| {
            let v = part / length;
            let code = match encoding {
                Encoding::Snorm | Encoding::Biased => greatest * v,
                Encoding::Unorm | Encoding::Float => greatest * (v + 1.0) / 2.0,
            };
            (code.rem_euclid(1.0) - 0.5).abs()
        };
        off(x).min(off(y)).min(off(1.0))
    }
}

/// A normal map in any format. Its texels are unit vectors that lean up to 60 degrees, or, of kind extreme, any codes.
pub(super) fn normals(kind: Kind, format: NormalFormat, size: Size, chance: &mut Chance) -> Result<NormalMap> {
    let channels = format.channels.count();
    let texel = format.texel();
    let mut codes = Codes::zeroed(format.depth, size.texels() * channels);
    for index in 0..size.texels() {
        let components = match kind {
            Kind::Extreme => [chance.unit(), chance.unit(), chance.unit()],
            Kind::Small => direction(chance.of(&[0.0, 0.5, -0.5]), chance.of(&[0.0, 1.0, -0.25])),
            Kind::Random | Kind::Boundaries => direction(1.2 * chance.unit(), 1.2 * chance.unit()),
        };
        for (channel, &component) in components.iter().take(channels).enumerate() {
            let at = index * channels + channel;
            let any_code = kind == Kind::Extreme;
            let stored = |component: f32, chance: &mut Chance| match CodeRounding::new(texel) {
                Some(_) if any_code => chance.bits() as u32,
                Some(rounding) => rounding.code_of_float(component),
                None => 0,
            };
            match &mut codes {
                Codes::U8(codes) => codes[at] = stored(component, chance) as u8,
                Codes::U16(codes) => codes[at] = stored(component, chance) as u16,
                Codes::F16(codes) => codes[at] = f16::from_f32(any_float(kind, component, chance)),
                Codes::F32(codes) => codes[at] = any_float(kind, component, chance),
            }
        }
    }
    NormalMap::new(size, format, codes)
}

/// The normal of two slopes.
fn direction(dx: f32, dy: f32) -> [f32; 3] {
    let length = (dx * dx + dy * dy + 1.0).sqrt();
    [-dx / length, -dy / length, 1.0 / length]
}

/// Of kind extreme a component of any size that a float map may have, else the component.
fn any_float(kind: Kind, component: f32, chance: &mut Chance) -> f32 {
    match (kind, chance.below(4)) {
        (Kind::Extreme, 0) => chance.of(&[0.0, -0.0, 1.0, -1.0, 65_504.0, -65_504.0, f32::MIN_POSITIVE]),
        (Kind::Extreme, 1) => {
            let bits = chance.bits() as u32;
            // Exponents from 2^-40 to 2^14, below the greatest of 16f.
            f32::from_bits((bits & 0x807f_ffff) | (87 + (bits >> 23) % 55) << 23)
        }
        _ => component,
    }
}

/// Formats with two and three channels.
pub(super) fn normal_formats() -> Vec<NormalFormat> {
    let channels = [Channels::Xyz, Channels::Xy];
    let of =
        |(encoding, depth)| channels.map(|channels| NormalFormat { encoding, depth, channels, ..Default::default() });
    super::CODES.into_iter().flat_map(of).collect()
}

/// `unorm 8 xyz`.
pub(super) fn name_of(format: NormalFormat) -> String {
    let NormalFormat { encoding, depth, channels, convention } = format;
    format!("{encoding} {depth} {channels} {convention}")
}
