//! Parallax maps, alone and in one pass with the normal map.

use super::*;

/// Whatever is baked together is what the reference bakes alone.
fn assert_alone_and_fused(
    map: &HeightMap,
    options: &BakeOptions,
    normals: &[NormalFormat],
    parallaxes: &[ParallaxFormat],
) {
    let bake = |backend: &dyn Backend, normal, parallax| {
        baked_maps(backend, map, &BakeOptions { normal, parallax, ..*options }, 7)
    };
    let alone = |format: &ParallaxFormat| bake(&Reference, None, Some(*format)).remove(0);
    let expected: Vec<Codes> = parallaxes.iter().map(alone).collect();
    for (format, expected) in parallaxes.iter().zip(&expected) {
        let got = bake(&Cpu::shared(), None, Some(*format));
        let difference = difference(map.size(), format.texel(), &got[0], expected);
        assert_eq!((difference, got.len()), (None, 1), "parallax alone of {} {options:?}", map.height_type());
    }
    for normal in normals {
        let expected_normal = bake(&Reference, Some(*normal), None).remove(0);
        for (parallax, expected_parallax) in parallaxes.iter().zip(&expected) {
            let got = bake(&Cpu::shared(), Some(*normal), Some(*parallax));
            let differences = [
                difference(map.size(), normal.texel(), &got[0], &expected_normal),
                difference(map.size(), parallax.texel(), &got[1], expected_parallax),
            ];
            assert_eq!(differences, [None, None], "{} {normal:?} with {parallax:?}, {options:?}", map.height_type());
        }
    }
}

#[test]
fn every_mix_of_formats() {
    let mut random = SplitMix(11);
    for map in maps([131, 9], |_, _| random.bits() as u16) {
        for text in ["24", "-0.35"] {
            let options = BakeOptions { scale: scale(text), ..BakeOptions::default() };
            assert_alone_and_fused(&map, &options, &formats(), &parallax_formats());
        }
    }
}

/// Around blocks of 512 texels and groups of 64.
#[test]
fn every_size_edge_and_filter() {
    let mut random = SplitMix(12);
    let [words, bytes] =
        [Depth::Bits16, Depth::Bits8].map(|depth| ParallaxFormat { depth, ..ParallaxFormat::default() });
    for width in [1, 2, 63, 64, 65, 511, 512, 513, 577, 1031] {
        for map in maps([width, 3], |_, _| random.bits() as u16) {
            for filter in [Filter::Central, Filter::Sobel, Filter::Scharr, Filter::Prewitt] {
                for x in [Edge::Wrap, Edge::Clamp, Edge::Mirror] {
                    let edges = Edges { x, y: Edge::Clamp };
                    let options = BakeOptions { scale: scale("7/3"), filter, edges, ..BakeOptions::default() };
                    assert_alone_and_fused(&map, &options, &[NormalFormat::default()], &[bytes, words]);
                }
            }
        }
    }
}

/// Slopes whose normals are (3, 0, 4)/5 and their like, under heights where 2h - 1 keeps the tie.
#[test]
fn ties() {
    let mut random = SplitMix(13);
    for step in [255 / 15, 65535 / 15] {
        for map in maps([131, 20], |_, _| (random.bits() % 16) as u16 * step) {
            for text in ["15", "30", "15/2", "10", "45/2", "-45", "40", "360/7", "16777215", "0"] {
                let options = BakeOptions { scale: scale(text), ..BakeOptions::default() };
                assert_alone_and_fused(&map, &options, &[NormalFormat::default()], &parallax_formats());
            }
        }
    }
}

/// A roof of slope 3/4: n_z is 4/5, and 0.8 (2H - 255) / 2 + 128 is an integer, a tie, for every fifth height.
#[test]
fn a_plane_of_parallax_on_ties() {
    let roof = Grid::from_fn(120, 2, |x, _| 2 * x as u8).unwrap().into();
    let edges = Edges { x: Edge::Mirror, y: Edge::Clamp };
    let format = ParallaxFormat { encoding: Encoding::Unorm, ..ParallaxFormat::default() };
    let options = ParallaxOptions { scale: scale("765/8"), edges, format, ..ParallaxOptions::default() };
    let codes = baked_maps(&Cpu::shared(), &roof, &options.into(), 2).remove(0);
    let CodesRef::U8(codes) = codes.as_ref() else { panic!("8 bits were asked for") };
    // Heights 10, 20, 110 and 230 at both rows: 0.4 (2H - 255) + 128.
    for (column, code) in [(5, 34), (10, 42), (55, 114), (115, 210)] {
        assert_eq!([codes[column], codes[120 + column]], [code; 2], "column {column}");
    }
    // Flat at the mirrored border, with height 0 and 238.
    assert_eq!([codes[0], codes[119]], [0, 238]);
}

#[test]
fn steep_and_flat_and_extreme() {
    let mut random = SplitMix(14);
    let size = [97, 5];
    let flat = maps(size, |_, _| 200);
    let edge_codes = maps(size, |_, _| if random.bits() & 1 == 0 { 0 } else { u16::MAX });
    let any_finite = floats(size, |_, _| {
        let bits = random.bits() as u32;
        if f32::from_bits(bits).is_finite() { f32::from_bits(bits) } else { f32::MAX }
    });
    let half = floats(size, |_, _| 0.5);
    for map in flat.iter().chain(&edge_codes).chain([&any_finite, &half]) {
        for text in ["0", "1/16777215", "0.0001", "1000", "16777215", "-16777215", "16777213/16777215"] {
            let options = BakeOptions { scale: scale(text), filter: Filter::Scharr, ..BakeOptions::default() };
            let xy = NormalFormat { channels: Channels::Xy, ..NormalFormat::default() };
            assert_alone_and_fused(map, &options, &[xy], &parallax_formats());
        }
    }
}

#[test]
fn fast_parallax_is_next_to_exact() {
    let mut random = SplitMix(15);
    let [bytes, words, _] = maps([512, 16], |_, _| random.bits() as u16);
    for map in [bytes, words] {
        for format in parallax_formats() {
            let exact = ParallaxOptions { scale: scale("24"), format, ..ParallaxOptions::default() };
            let fast = ParallaxOptions { precision: Precision::Fast, ..exact };
            let [exact, fast] = [exact, fast].map(|it| baked_maps(&Cpu::shared(), &map, &it.into(), 16).remove(0));
            let bound = if format.depth == Depth::Float32 { 16.0 } else { 1.0 };
            assert!(codes_apart(&fast, &exact) <= bound, "{format:?}");
        }
    }
}

#[test]
fn neither_threads_nor_bands_change_a_byte() {
    let mut random = SplitMix(16);
    let [_, map, _] = maps([4099, 40], |_, _| random.bits() as u16);
    let parallax = Some(ParallaxFormat { depth: Depth::Bits16, ..ParallaxFormat::default() });
    let options = BakeOptions { scale: scale("24"), parallax, ..BakeOptions::default() };
    let expected = baked_maps(&Reference, &map, &options, 40);
    for (threads, band_rows) in [(1, 1), (2, 40), (3, 17)] {
        let got = baked_maps(&Cpu::with_threads(threads).unwrap(), &map, &options, band_rows);
        assert!(got == expected, "{threads} threads, {band_rows} rows");
    }
}
