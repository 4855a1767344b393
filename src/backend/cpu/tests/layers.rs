//! Blends, and parallax maps with the normals of a map.

use super::*;
use crate::ops::blend::{BlendMethod, BlendOptions, BlendPlan};
use crate::ops::parallax::ParallaxPlan;
use crate::stream::MapLayers;
use half::f16;

/// Codes of a map: one in four is at or beside an end or the middle.
fn normals(random: &mut SplitMix, size: Size, format: NormalFormat) -> Codes {
    let count = size.texels() * format.channels.count();
    match format.depth {
        Depth::Bits8 => Codes::U8((0..count).map(|_| code(random, 8) as u8).collect()),
        Depth::Bits16 => Codes::U16((0..count).map(|_| code(random, 16)).collect()),
        Depth::Float16 => Codes::F16((0..count).map(|_| f16::from_f32(component(random, 65504.0))).collect()),
        Depth::Float32 => Codes::F32((0..count).map(|_| component(random, 65536.0)).collect()),
    }
}

fn code(random: &mut SplitMix, bits: u32) -> u16 {
    let [half, greatest] = [1u32 << (bits - 1), (1 << bits) - 1];
    let ends = [0, 1, half - 1, half, half + 1, greatest - 1, greatest, half / 2];
    let number = random.bits();
    (if number.is_multiple_of(4) { ends[(number >> 8) as usize % 8] } else { (number >> 32) as u32 & greatest }) as u16
}

fn component(random: &mut SplitMix, greatest: f32) -> f32 {
    let ends = [0.0, -0.0, 1.0, -1.0, greatest, -greatest, 2f32.powi(-24), f32::from_bits(1)];
    let number = random.bits();
    let inside = (number >> 40) as f32 / (1 << 23) as f32 - 1.0;
    if number.is_multiple_of(4) { ends[(number >> 8) as usize % 8] } else { inside }
}

fn mask(random: &mut SplitMix, size: Size, height_type: HeightType) -> Codes {
    match height_type {
        HeightType::U8 => Codes::U8((0..size.texels()).map(|_| code(random, 8) as u8).collect()),
        _ => Codes::U16((0..size.texels()).map(|_| code(random, 16)).collect()),
    }
}

/// Two normal maps and, perhaps, a mask.
struct Layers {
    formats: [NormalFormat; 2],
    codes: Vec<Codes>,
    mask: Option<HeightType>,
}

impl Layers {
    fn new(random: &mut SplitMix, size: Size, formats: [NormalFormat; 2], mask: Option<HeightType>) -> Self {
        let mut codes: Vec<Codes> = formats.iter().map(|format| normals(random, size, *format)).collect();
        codes.extend(mask.map(|height_type| self::mask(random, size, height_type)));
        Self { formats, codes, mask }
    }
}

fn blended(backend: &dyn Backend, size: Size, layers: &Layers, options: &BlendOptions, band_rows: usize) -> Codes {
    let plan = BlendPlan::new(options, size, layers.formats, layers.mask).unwrap();
    let format = plan.format.texel();
    let mut codes = poisoned(size, format);
    let mut bands = MapLayers::new(layers.codes.iter().map(Codes::as_ref).collect(), size.height(), band_rows);
    backend.blend(&plan, &mut bands, &mut MapSink::new(codes.as_mut(), format.row_codes(size.width()))).unwrap();
    codes
}

fn assert_same_blend(size: Size, layers: &Layers, options: &BlendOptions) {
    let expected = blended(&Reference, size, layers, options, size.height());
    let got = blended(&Cpu::shared(), size, layers, options, 2);
    let difference = difference(size, options.format.texel(), &got, &expected);
    assert_eq!(difference, None, "{:?} and mask {:?} by {options:?}", layers.formats, layers.mask);
}

fn weighted(base: &str, detail: &str) -> BlendMethod {
    BlendMethod::Weighted { base: base.parse().unwrap(), detail: detail.parse().unwrap() }
}

/// Every method, with the masks it takes; weights from nothing to the greatest parts.
fn methods() -> Vec<(BlendMethod, Option<HeightType>)> {
    let mut methods = vec![
        (BlendMethod::Masked, Some(HeightType::U8)),
        (BlendMethod::Masked, Some(HeightType::U16)),
        (BlendMethod::Linear, None),
        (BlendMethod::Overlay, None),
        (BlendMethod::Udn, None),
        (BlendMethod::Whiteout, None),
        (BlendMethod::Rnm, None),
    ];
    for [base, detail] in [
        ["1", "1"],
        ["1", "-0.5"],
        ["0", "0"],
        ["1", "-1"],
        ["0.37", "-12.5"],
        ["65535", "-65535"],
        ["65534/65535", "1"],
        ["1/65535", "1/65534"],
    ] {
        methods.push((weighted(base, detail), None));
    }
    methods
}

fn size(width: usize, height: usize) -> Size {
    Size::new(width, height).unwrap()
}

#[test]
fn every_method_in_every_mix_of_formats() {
    let mut random = SplitMix(21);
    let formats = formats();
    let size = size(131, 5);
    for base in &formats {
        for (method, mask) in methods() {
            // Every format meets this one in one role or the other.
            for _ in 0..3 {
                let mut any = || formats[random.bits() as usize % formats.len()];
                let (detail, format) = (any(), any());
                let options = BlendOptions { method, format, ..BlendOptions::default() };
                assert_same_blend(size, &Layers::new(&mut random, size, [*base, detail], mask), &options);
            }
        }
    }
}

/// The formats that most maps have, by every method, where f32 decides and where it cannot.
#[test]
fn every_method_of_8_and_16_bits() {
    let mut random = SplitMix(22);
    let unorm = NormalFormat::default();
    let words = NormalFormat { depth: Depth::Bits16, ..unorm };
    let snorm = NormalFormat { encoding: Encoding::Snorm, ..unorm };
    let size = size(1031, 9);
    for (inputs, format) in [
        ([unorm, unorm], unorm),
        ([snorm, snorm], snorm),
        ([words, words], unorm),
        ([unorm, unorm], words),
        ([words, words], words),
    ] {
        for (method, mask) in methods() {
            let options = BlendOptions { method, format, ..BlendOptions::default() };
            assert_same_blend(size, &Layers::new(&mut random, size, inputs, mask), &options);
        }
    }
}

/// Around blocks of 512 texels and groups of 64.
#[test]
fn every_size() {
    let mut random = SplitMix(23);
    let unorm = NormalFormat::default();
    let xy = NormalFormat { channels: Channels::Xy, depth: Depth::Bits16, ..unorm };
    for width in [1, 2, 63, 64, 65, 511, 512, 513, 577, 1031] {
        for height in [1, 3] {
            for (method, mask) in [(weighted("1", "1"), None), (BlendMethod::Masked, Some(HeightType::U8))] {
                let size = size(width, height);
                for format in [unorm, xy] {
                    let layers = Layers::new(&mut random, size, [unorm, xy], mask);
                    assert_same_blend(size, &layers, &BlendOptions { method, format, ..BlendOptions::default() });
                }
            }
        }
    }
}

/// Small Pythagorean slopes: the sums are ties of 8 and of 16 bits.
#[test]
fn ties() {
    let snorm = |depth| NormalFormat { encoding: Encoding::Snorm, depth, ..NormalFormat::default() };
    let size = size(600, 4);
    let parts =
        [[1i8, 2, 2], [2, 1, 2], [-2, 2, 1], [3, 0, 4], [0, -3, 4], [2, 3, 6], [4, 4, 7], [0, 0, 9], [-12, 0, 5]];
    let mut random = SplitMix(24);
    let mut codes = || {
        let texels = (0..size.texels()).flat_map(|_| parts[random.bits() as usize % parts.len()]);
        Codes::U8(texels.map(|part| part as u8).collect())
    };
    let formats = [snorm(Depth::Bits8); 2];
    for detail in [codes(), Codes::U8([0, 0, 1].repeat(size.texels()))] {
        let layers = Layers { formats, codes: vec![codes(), detail], mask: None };
        for format in self::formats() {
            for (method, _) in methods().into_iter().filter(|(_, mask)| mask.is_none()) {
                assert_same_blend(size, &layers, &BlendOptions { method, format, ..BlendOptions::default() });
            }
        }
    }
    // (3, 0, 4) on a flat map is itself: 0.6 and 0.8 of 127.5 from 127.5 are 204 and 229.5, of which each rounds up.
    let layers = Layers {
        formats,
        codes: vec![Codes::U8([3, 0, 4].repeat(size.texels())), Codes::U8([0, 0, 1].repeat(size.texels()))],
        mask: None,
    };
    let codes = blended(&Cpu::shared(), size, &layers, &BlendOptions::default(), 4);
    assert_eq!(codes, Codes::U8([204, 128, 230].repeat(size.texels())));
}

#[test]
fn what_cancels_is_flat() {
    let unorm = NormalFormat::default();
    let size = size(70, 2);
    let map = Codes::U8([200, 90, 250].repeat(size.texels()));
    let layers = Layers { formats: [unorm; 2], codes: vec![map.clone(), map], mask: None };
    let codes = |method| {
        let options = BlendOptions { method, ..BlendOptions::default() };
        blended(&Cpu::shared(), size, &layers, &options, 2)
    };
    assert_eq!(codes(weighted("1", "-1")), Codes::U8([128, 128, 255].repeat(size.texels())));
    assert_eq!(codes(weighted("0", "0")), Codes::U8([128, 128, 255].repeat(size.texels())));
}

#[test]
fn neither_threads_nor_bands_change_a_byte() {
    let mut random = SplitMix(25);
    let unorm = NormalFormat::default();
    let words = NormalFormat { depth: Depth::Bits16, ..unorm };
    let size = size(4099, 40);
    let layers = Layers::new(&mut random, size, [unorm, words], Some(HeightType::U16));
    let options = BlendOptions { method: BlendMethod::Masked, ..BlendOptions::default() };
    let expected = blended(&Reference, size, &layers, &options, 40);
    for (threads, band_rows) in [(1, 1), (2, 40), (3, 17)] {
        let got = blended(&Cpu::with_threads(threads).unwrap(), size, &layers, &options, band_rows);
        assert!(got == expected, "{threads} threads, {band_rows} rows");
    }
}

/// Of normal maps; where a method leaves next to nothing of its inputs, f32 has lost it.
#[test]
fn fast_is_next_to_exact() {
    let mut random = SplitMix(26);
    let [_, heights, _] = maps([512, 16], |_, _| random.bits() as u16);
    for input in formats().into_iter().filter(|format| !format.depth.is_float()) {
        let bake = |text| {
            let options = NormalOptions { scale: scale(text), format: input, ..NormalOptions::default() };
            baked(&Cpu::shared(), &heights, &options, 16)
        };
        let mut layers = Layers { formats: [input; 2], codes: vec![bake("2"), bake("-0.7")], mask: None };
        for (method, mask) in methods() {
            layers.mask = mask;
            layers.codes.truncate(2);
            layers.codes.extend(mask.map(|height_type| self::mask(&mut random, heights.size(), height_type)));
            for depth in [Depth::Bits8, Depth::Bits16] {
                let format = NormalFormat { depth, ..NormalFormat::default() };
                let exact = BlendOptions { method, format, ..BlendOptions::default() };
                let fast = BlendOptions { precision: Precision::Fast, ..exact };
                let [exact, fast] =
                    [exact, fast].map(|options| blended(&Cpu::shared(), heights.size(), &layers, &options, 16));
                assert!(codes_apart(&fast, &exact) <= 1.0, "{input:?} by {method:?} to {depth:?}");
            }
        }
    }
}

#[test]
fn parallax_of_every_mix_of_formats() {
    let mut random = SplitMix(27);
    for (width, height) in [(131, 5), (512, 1), (1031, 2)] {
        let size = size(width, height);
        let [bytes, words] = [HeightType::U8, HeightType::U16].map(|height_type| mask(&mut random, size, height_type));
        let heights = Codes::F32((0..size.texels()).map(|_| component(&mut random, f32::MAX)).collect());
        for (height_type, heights) in [(HeightType::U8, bytes), (HeightType::U16, words), (HeightType::F32, heights)] {
            for input in formats() {
                let normals = normals(&mut random, size, input);
                for format in parallax_formats() {
                    let plan = ParallaxPlan::new(size, height_type, input, format, Precision::Exact).unwrap();
                    let bake = |backend: &dyn Backend, band_rows| {
                        let mut codes = poisoned(size, format.texel());
                        let mut bands = MapLayers::new(vec![heights.as_ref(), normals.as_ref()], height, band_rows);
                        backend.parallax(&plan, &mut bands, &mut MapSink::new(codes.as_mut(), width)).unwrap();
                        codes
                    };
                    let (expected, got) = (bake(&Reference, height), bake(&Cpu::shared(), 2));
                    let difference = difference(size, format.texel(), &got, &expected);
                    assert_eq!(difference, None, "{height_type} with {input:?}");
                }
            }
        }
    }
}
