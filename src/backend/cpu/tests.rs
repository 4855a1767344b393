//! The vectorised backend against the reference: the same bytes, whatever the options, the size and the threads.

mod fused;
mod layers;
mod tangents;

use super::round::{Round, ToF16, ToF32, ToInteger};
use super::slopes::{Estimate, Slopes};
use super::sums::Height;
use super::{Cpu, Reference};
use crate::backend::{Backend, RowBytes};
use crate::map::{
    Channels, Codes, CodesRef, Convention, Depth, Edge, Edges, Encoding, Grid, HeightMap, HeightType, NormalFormat,
    ParallaxFormat, Size, TexelFormat,
};
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, BakePlan, Filter, NormalOptions, ParallaxOptions, Slope};
use crate::split_mix::SplitMix;
use crate::stream::{CodeSink, MapBands, MapSink};
use crate::{Rational, Scale};

/// Heights of the three types: the same codes for all that can hold them.
fn maps([width, height]: [usize; 2], mut height_at: impl FnMut(usize, usize) -> u16) -> [HeightMap; 3] {
    let codes = Grid::from_fn(width, height, &mut height_at).unwrap().into_texels();
    let bytes = codes.iter().map(|code| *code as u8).collect();
    let floats = codes.iter().map(|code| f32::from(*code) / 65535.0).collect();
    [
        Grid::new(width, height, bytes).unwrap().into(),
        Grid::new(width, height, codes).unwrap().into(),
        Grid::new(width, height, floats).unwrap().try_into().unwrap(),
    ]
}

fn floats([width, height]: [usize; 2], height_at: impl FnMut(usize, usize) -> f32) -> HeightMap {
    Grid::from_fn(width, height, height_at).unwrap().try_into().unwrap()
}

/// Every encoding with every depth that goes with it.
fn parallax_formats() -> Vec<ParallaxFormat> {
    let mut formats = Vec::new();
    for (encoding, depths) in [
        (Encoding::Unorm, [Depth::Bits8, Depth::Bits16]),
        (Encoding::Snorm, [Depth::Bits8, Depth::Bits16]),
        (Encoding::Biased, [Depth::Bits8, Depth::Bits16]),
        (Encoding::Float, [Depth::Float16, Depth::Float32]),
    ] {
        formats.extend(depths.map(|depth| ParallaxFormat { encoding, depth }));
    }
    formats
}

/// The same with all channels and both conventions.
fn formats() -> Vec<NormalFormat> {
    let mut formats = Vec::new();
    for ParallaxFormat { encoding, depth } in parallax_formats() {
        for channels in [Channels::Xyz, Channels::Xy] {
            for convention in [Convention::Gl, Convention::Dx] {
                formats.push(NormalFormat { encoding, depth, channels, convention });
            }
        }
    }
    formats
}

/// The maps of a bake, one after the other.
fn baked_maps(backend: &dyn Backend, map: &HeightMap, options: &BakeOptions, band_rows: usize) -> Vec<Codes> {
    let plan = BakePlan::new(options, map.size(), map.height_type()).unwrap();
    let mut maps: Vec<Codes> = plan.outputs().map(|format| poisoned(plan.size, format)).collect();
    let sink =
        |(codes, format): (_, TexelFormat)| MapSink::new(Codes::as_mut(codes), format.row_codes(plan.size.width()));
    let mut sinks: Vec<MapSink<'_>> = maps.iter_mut().zip(plan.outputs()).map(sink).collect();
    let mut sinks: Vec<&mut dyn CodeSink> = sinks.iter_mut().map(|sink| sink as &mut dyn CodeSink).collect();
    backend.bake(&plan, &mut MapBands::new(map, plan.edges.y, band_rows), &mut sinks).unwrap();
    drop(sinks);
    maps
}

fn baked(backend: &dyn Backend, map: &HeightMap, options: &NormalOptions, band_rows: usize) -> Codes {
    baked_maps(backend, map, &(*options).into(), band_rows).remove(0)
}

/// Room that a texel which nobody writes cannot leave unnoticed.
fn poisoned(size: Size, format: TexelFormat) -> Codes {
    let mut codes = Codes::zeroed(format.depth, size.texels() * format.channels);
    codes.as_mut().bytes_mut().fill(0xa5);
    codes
}

/// The first texel whose bytes differ, in words.
fn difference(size: Size, format: TexelFormat, got: &Codes, expected: &Codes) -> Option<String> {
    let (got, expected) = (got.as_ref(), expected.as_ref());
    assert_eq!((got.len(), got.depth()), (expected.len(), expected.depth()));
    let code_bytes = format.depth.bytes();
    let at = got.bytes().iter().zip(expected.bytes()).position(|(got, expected)| got != expected)? / code_bytes;
    let texel = at / format.channels;
    let (x, y) = (texel % size.width(), texel / size.width());
    let code = |codes: CodesRef<'_>| format!("{:x?}", &codes.bytes()[at * code_bytes..][..code_bytes]);
    Some(format!("{size} code {at}, column {x}, row {y}: {} is not {}; {format:?}", code(got), code(expected)))
}

fn assert_same_bytes(map: &HeightMap, options: &NormalOptions) {
    let expected = baked(&Reference, map, options, map.size().height());
    let got = baked(&Cpu::shared(), map, options, 7);
    let difference = difference(map.size(), options.format.texel(), &got, &expected);
    assert_eq!(difference, None, "{} {options:?}", map.height_type());
}

fn scale(text: &str) -> Scale {
    Scale::texels(text.parse::<Rational>().unwrap())
}

const SIZES: [[usize; 2]; 9] = [[1, 1], [1, 9], [9, 1], [2, 2], [3, 5], [31, 37], [300, 7], [512, 3], [1031, 3]];

#[test]
fn every_format_of_random_heights() {
    let mut random = SplitMix(1);
    for map in maps([300, 7], |_, _| random.bits() as u16) {
        for format in formats() {
            for text in ["1", "24", "-0.35", "0.001"] {
                assert_same_bytes(&map, &NormalOptions { scale: scale(text), format, ..NormalOptions::default() });
            }
        }
    }
}

#[test]
fn every_edge_and_filter_at_every_size() {
    let mut random = SplitMix(2);
    for size in SIZES {
        for map in maps(size, |_, _| random.bits() as u16) {
            for filter in [Filter::Central, Filter::Sobel, Filter::Scharr, Filter::Prewitt] {
                for x in [Edge::Wrap, Edge::Clamp, Edge::Mirror] {
                    for y in [Edge::Wrap, Edge::Clamp, Edge::Mirror] {
                        let options = NormalOptions {
                            scale: scale("7/3"),
                            filter,
                            edges: Edges { x, y },
                            ..NormalOptions::default()
                        };
                        assert_same_bytes(&map, &options);
                    }
                }
            }
        }
    }
}

/// Slopes whose normals are (2, 1, 2)/3, (3, 0, 4)/5 and their like, which lie exactly between two codes.
#[test]
fn ties() {
    let mut random = SplitMix(3);
    // Levels M/15 apart: slopes of n/2, n/4 and the like on both axes for the scales below.
    for step in [255 / 15, 65535 / 15] {
        for map in maps([131, 40], |_, _| (random.bits() % 16) as u16 * step) {
            for text in ["15", "30", "15/2", "10", "20", "45/2", "-45", "40", "12", "30/7", "360/7", "16777215"] {
                for format in formats() {
                    assert_same_bytes(&map, &NormalOptions { scale: scale(text), format, ..NormalOptions::default() });
                }
            }
        }
    }
}

/// A roof of slope 3/4: every normal is (-3, 0, 4)/5, and 229.5 rounds up.
#[test]
fn a_plane_on_a_tie() {
    let roof = Grid::from_fn(600, 4, |x, _| 2 * x as u16).unwrap().into();
    let edges = Edges { x: Edge::Mirror, y: Edge::Clamp };
    let options = NormalOptions { scale: scale("196605/8"), edges, ..NormalOptions::default() };
    let codes = baked(&Cpu::shared(), &roof, &options, 4);
    let CodesRef::U8(codes) = codes.as_ref() else { panic!("8 bits were asked for") };
    for (texel, code) in codes.chunks(3).enumerate() {
        // At the mirrored borders the slope along the rows is 0.
        let at_border = [0, 599].contains(&(texel % 600));
        assert_eq!(code, if at_border { [128, 128, 255] } else { [51, 128, 230] }, "texel {texel}");
    }
}

#[test]
fn the_comparison_sees_one_code() {
    let map = floats([5, 3], |x, y| (x * y) as f32);
    let options = NormalOptions::default();
    let expected = baked(&Reference, &map, &options, 3);
    let mut sabotaged = expected.clone();
    sabotaged.as_mut().bytes_mut()[22] ^= 1;
    let difference = difference(map.size(), options.format.texel(), &sabotaged, &expected).unwrap();
    assert!(difference.contains("code 22, column 2, row 1"), "{difference}");
}

#[test]
fn gentle_and_flat_and_steep() {
    let mut random = SplitMix(4);
    let flat = maps([97, 5], |_, _| 200);
    let gentle = maps([97, 5], |_, _| 100 + (random.bits() % 3) as u16);
    let ramps = maps([97, 5], |x, y| (x * 3 + y * 50) as u16);
    for map in flat.iter().chain(&gentle).chain(&ramps) {
        for text in ["0", "1/16777215", "0.0001", "0.35", "1000", "16777215", "-16777215", "16777213/16777215"] {
            for format in formats() {
                for filter in [Filter::Central, Filter::Scharr] {
                    let options = NormalOptions { scale: scale(text), format, filter, ..NormalOptions::default() };
                    assert_same_bytes(map, &options);
                }
            }
        }
    }
}

/// Texels that are not square: the two axes have scales of their own.
#[test]
fn physical_scales() {
    let mut random = SplitMix(5);
    for map in maps([64, 9], |_, _| random.bits() as u16) {
        let scale = Scale::physical("2".parse().unwrap(), "0.7".parse().unwrap(), "0.1".parse().unwrap());
        for format in formats() {
            assert_same_bytes(&map, &NormalOptions { scale, format, ..NormalOptions::default() });
        }
    }
}

#[test]
fn extreme_floats() {
    let mut random = SplitMix(6);
    let size = [211, 6];
    let any_finite = floats(size, |_, _| {
        let bits = random.bits() as u32;
        if f32::from_bits(bits).is_finite() { f32::from_bits(bits) } else { f32::MAX }
    });
    let subnormal = floats(size, |_, _| f32::from_bits(random.bits() as u32 & 0x807f_ffff));
    let greatest = floats(size, |_, _| if random.bits() & 1 == 0 { f32::MAX } else { -f32::MAX });
    let zeros = floats(size, |_, _| if random.bits() & 1 == 0 { 0.0 } else { -0.0 });
    for map in [any_finite, subnormal, greatest, zeros] {
        for text in ["0", "1", "-24", "1/16777215", "16777215"] {
            for format in formats() {
                for filter in [Filter::Central, Filter::Sobel, Filter::Scharr, Filter::Prewitt] {
                    let options = NormalOptions { scale: scale(text), format, filter, ..NormalOptions::default() };
                    assert_same_bytes(&map, &options);
                }
            }
        }
    }
}

#[test]
fn neither_threads_nor_bands_change_a_byte() {
    let mut random = SplitMix(7);
    // Wide enough for several strips in a band.
    for map in &maps([4099, 61], |_, _| random.bits() as u16) {
        for precision in [Precision::Exact, Precision::Fast] {
            let options = NormalOptions { scale: scale("24"), precision, ..NormalOptions::default() };
            let expected = baked(&Cpu::with_threads(1).unwrap(), map, &options, 61);
            for (threads, band_rows) in [(1, 1), (2, 61), (2, 16), (3, 61), (3, 5)] {
                let got = baked(&Cpu::with_threads(threads).unwrap(), map, &options, band_rows);
                assert_eq!(
                    difference(map.size(), options.format.texel(), &got, &expected),
                    None,
                    "{threads} threads, {band_rows} rows"
                );
            }
        }
    }
}

/// `fast` may give the neighbour of a code near a boundary, and an f32 up to 16 places away (8.5 are proved).
#[test]
fn fast_is_next_to_exact() {
    let mut random = SplitMix(8);
    let [bytes, words, _] = maps([512, 64], |_, _| random.bits() as u16);
    for map in [bytes, words] {
        for format in formats() {
            for text in ["1", "24", "0.01"] {
                let exact = NormalOptions { scale: scale(text), format, ..NormalOptions::default() };
                let fast = NormalOptions { precision: Precision::Fast, ..exact };
                let [exact, fast] = [exact, fast].map(|options| baked(&Cpu::shared(), &map, &options, 64));
                let greatest = codes_apart(&fast, &exact);
                let bound = if format.depth == Depth::Float32 { 16.0 } else { 1.0 };
                assert!(greatest <= bound, "{greatest} codes apart: {format:?}, scale {text}");
            }
        }
    }
}

/// The same operations in a plain loop, which is compiled for the least instruction set: the widest gives the same bytes.
#[test]
fn no_instruction_set_changes_a_byte_of_fast() {
    let mut random = SplitMix(9);
    let size = Size::new(67, 41).unwrap();
    let map = Grid::from_fn(67, 41, |_, _| random.bits() as u16).unwrap();
    for format in formats() {
        for text in ["1", "24", "0.01", "-7/3"] {
            let precision = Precision::Fast;
            let options = NormalOptions { scale: scale(text), format, precision, ..NormalOptions::default() };
            let plan = BakePlan::new(&options.into(), size, HeightType::U16).unwrap();
            let Slope::Integer(slope) = plan.slope else { panic!("heights of integers") };
            let estimate = Estimate::<f32>::new(slope, 65_535);
            let height = |x: usize, y: usize| map.texels()[y % 41 * 67 + x % 67];
            let components = (0..67 * 41).flat_map(|at| {
                let (x, y) = (at % 67 + 66, at / 67 + 40);
                let around = [0, 1, 2].map(|down| [0, 1, 2].map(|right| height(x + right, y + down)));
                let normal = Slopes::<u16>::normal(&estimate, u16::sums(plan.stencil, around));
                normal.into_iter().take(format.channels.count())
            });
            let texel = format.texel();
            let plain = match format.depth {
                Depth::Bits8 => Codes::U8(components.map(|it| ToInteger::<u8>::new(texel).code(it)).collect()),
                Depth::Bits16 => Codes::U16(components.map(|it| ToInteger::<u16>::new(texel).code(it)).collect()),
                Depth::Float16 => Codes::F16(components.map(|it| ToF16.code(it)).collect()),
                Depth::Float32 => Codes::F32(components.map(|it| ToF32.code(it)).collect()),
            };
            let fast = baked(&Cpu::shared(), &map.clone().into(), &options, 41);
            assert_eq!(difference(size, texel, &fast, &plain), None, "{format:?}, scale {text}");
        }
    }
}

/// How far the codes of two maps are apart at most, in steps from one code to the next.
fn codes_apart(a: &Codes, b: &Codes) -> f64 {
    match (a.as_ref(), b.as_ref()) {
        (CodesRef::U8(a), CodesRef::U8(b)) => greatest_step(a, b, |a, b| a.wrapping_sub(b) as i8 as f64),
        (CodesRef::U16(a), CodesRef::U16(b)) => greatest_step(a, b, |a, b| a.wrapping_sub(b) as i16 as f64),
        (CodesRef::F16(a), CodesRef::F16(b)) => {
            greatest_step(a, b, |a, b| (a.to_bits() as i32 - b.to_bits() as i32) as f64)
        }
        (CodesRef::F32(a), CodesRef::F32(b)) => {
            greatest_step(a, b, |a, b| (a.to_bits() as i32 - b.to_bits() as i32) as f64)
        }
        _ => panic!("two depths"),
    }
}

fn greatest_step<T: Copy>(a: &[T], b: &[T], step: impl Fn(T, T) -> f64) -> f64 {
    a.iter().zip(b).map(|(a, b)| step(*a, *b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_device_says_what_runs() {
    let name = Cpu::with_threads(2).unwrap().device();
    let sets = ["avx512", "avx2", "sse2", "neon", "scalar"];
    assert!(sets.iter().any(|set| name == format!("2 threads, {set}")), "{name}");
}

#[test]
fn bands_hold_some_rows_for_every_thread() {
    let rows = |width, height| {
        let plan = BakePlan::new(&BakeOptions::default(), Size::new(width, height).unwrap(), HeightType::U16);
        Cpu::with_threads(3).unwrap().band_rows(RowBytes::of_bake(&plan.unwrap()))
    };
    assert_eq!(rows(4096, 4096), 51); // 1 MiB over 4096 (2 + 3) bytes
    assert_eq!(rows(1 << 24, 4096), 12);
    assert_eq!(rows(64, 64), 3276);
}
