//! Real maps: two PBR materials, 16-bit heights and 8-bit normals of 1024 x 1024 texels each.
//!
//! They are the test data of the package pypbr (PyPI), which `tests/run.sh` fetches; TEXBAKE_MATERIALS names the folder
//! with `tiles/` and `rocks/`. Without them these tests print so and pass; with TEXBAKE_REQUIRE_MATERIALS=1 they fail.

use crate::oracle::{UnormZero, blend, image, parallax, parallax_with_normals};
use crate::support::{
    Format, Image, SNORM16, Subject, UNORM8, UNORM16, assert_same, blend_options, every_baker, fetched, map_u16,
    normal_map, pair, parallax_options, scale, weighted, xy,
};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use texbake::{
    BakeOptions, BlendInputs, BlendMethod, Depth, HeightMap, Heights, NormalFormat, NormalMap, NormalOptions,
    ParallaxFormat, Precision, Size,
};

/// Side of a sample that the oracle judges, and where the samples begin: inside, at the seams, and across them.
const SAMPLE: usize = 48;
const SAMPLES: [[usize; 2]; 6] = [[0, 0], [1000, 1000], [512, 300], [77, 900], [1010, 40], [600, 1023]];

struct Material {
    heights: HeightMap,
    /// As it was shipped, by another program.
    normals: NormalMap,
}

/// Both materials, or `None` if they were not fetched.
fn materials() -> Option<[Material; 2]> {
    let folder = fetched("MATERIALS")?;
    Some(["tiles", "rocks"].map(|name| Material::read(&folder.join(name))))
}

impl Material {
    fn read(folder: &Path) -> Self {
        let (size, samples) =
            png_samples(&folder.join("height.png"), png::ColorType::Grayscale, png::BitDepth::Sixteen);
        let words: Vec<u16> = samples.chunks(2).map(|word| u16::from_be_bytes([word[0], word[1]])).collect();
        let heights = map_u16(size.width(), size.height(), |x, y| words[size.width() * y + x]);
        let (normal_size, samples) = png_samples(&folder.join("normal.png"), png::ColorType::Rgb, png::BitDepth::Eight);
        assert_eq!(normal_size, size, "{}", folder.display());
        let bits: Vec<u32> = samples.into_iter().map(u32::from).collect();
        Self { heights, normals: normal_map(size.width(), size.height(), UNORM8, &bits) }
    }
}

/// The samples of a PNG file of one kind, by the format's own crate.
fn png_samples(path: &Path, color: png::ColorType, depth: png::BitDepth) -> (Size, Vec<u8>) {
    let file = File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().expect("a PNG file");
    let mut samples = vec![0; reader.output_buffer_size().expect("a size that fits")];
    let info = reader.next_frame(&mut samples).expect("whole rows");
    assert_eq!((info.color_type, info.bit_depth), (color, depth), "{}", path.display());
    (Size::new(info.width as usize, info.height as usize).expect("a size"), samples)
}

/// The texels of a square that begins at `corner`, with `border` more around it; beyond the border the map repeats.
fn square<F: Format>(map: &Image<F>, [left, top]: [usize; 2], border: usize) -> Vec<u32> {
    let (width, height) = (map.size.width(), map.size.height());
    let (side, channels) = (SAMPLE + 2 * border, map.format.channels().len());
    let texel = |i: usize| {
        let (x, y) = ((left + width - border + i % side) % width, (top + height - border + i / side) % height);
        map.bits[(width * y + x) * channels..][..channels].iter().copied()
    };
    (0..side * side).flat_map(texel).collect()
}

fn sample<F: Format>(map: &Image<F>, corner: [usize; 2]) -> Image<F> {
    let size = Size::new(SAMPLE, SAMPLE).expect("a size");
    Image { size, format: map.format, bits: square(map, corner, 0) }
}

/// The heights of a sample, with those around it.
fn heights_around(map: &HeightMap, corner: [usize; 2], border: usize) -> HeightMap {
    let Heights::U16(words) = map.heights() else { panic!("16-bit heights") };
    // Any format of one channel carries the codes.
    let codes = Image {
        size: map.size(),
        format: ParallaxFormat::default(),
        bits: words.iter().map(|&word| word.into()).collect(),
    };
    let (side, bits) = (SAMPLE + 2 * border, square(&codes, corner, border));
    map_u16(side, side, |x, y| bits[side * y + x] as u16)
}

/// The middle of an oracle's map of heights with one texel around it.
fn without_border<F: Format>(map: Image<F>) -> Image<F> {
    sample(&map, [1, 1])
}

#[test]
fn heights_become_the_same_two_maps_everywhere() {
    let Some(materials) = materials() else { return };
    let words = ParallaxFormat { depth: Depth::Bits16, ..Default::default() };
    let formats = [(UNORM8, ParallaxFormat::default()), (xy(SNORM16), words)];
    for Material { heights, .. } in &materials {
        for (normal, parallax_format) in formats {
            let options = BakeOptions {
                scale: scale("24"),
                normal: Some(normal),
                parallax: Some(parallax_format),
                ..Default::default()
            };
            let mut first: Option<(Image<NormalFormat>, Image<ParallaxFormat>)> = None;
            for Subject { name, baker } in every_baker() {
                let maps = baker.bake(heights, &options).expect("a bake");
                let normals = Image::from(maps.normal.as_ref().expect("a normal map"));
                let parallaxes = Image::from(maps.parallax.as_ref().expect("a parallax map"));
                let (expected_normals, expected_parallaxes) =
                    first.get_or_insert_with(|| (normals.clone(), parallaxes.clone()));
                assert_same(format_args!("{name}, normals"), &normals, expected_normals);
                assert_same(format_args!("{name}, parallaxes"), &parallaxes, expected_parallaxes);
            }
            let (normals, parallaxes) = first.expect("a baker");
            for corner in SAMPLES {
                let around = heights_around(heights, corner, 1);
                let expected =
                    image(&around, &NormalOptions { scale: options.scale, format: normal, ..Default::default() });
                assert_same(format_args!("{corner:?}"), &sample(&normals, corner), &without_border(expected));
                let expected = parallax(&around, &parallax_options("24", parallax_format)).image;
                assert_same(format_args!("{corner:?}"), &sample(&parallaxes, corner), &without_border(expected));
            }
        }
    }
}

#[test]
fn normals_blend_into_the_same_map_everywhere() {
    let Some([tiles, rocks]) = materials() else { return };
    let baked = every_baker()[0]
        .baker
        .normal(&tiles.heights, &NormalOptions { scale: scale("24"), format: xy(UNORM16), ..Default::default() });
    let baked = baked.expect("a bake");
    let cases = [
        (&tiles.normals, &rocks.normals, BlendMethod::add(), UNORM8),
        (&baked, &rocks.normals, weighted("1", "-1/2"), UNORM16),
        (&rocks.normals, &tiles.normals, BlendMethod::Rnm, SNORM16),
        (&rocks.normals, &baked, BlendMethod::Masked, UNORM8),
    ];
    for (base, detail, method, format) in cases {
        let mask = (method == BlendMethod::Masked).then_some(&tiles.heights);
        let options = blend_options(method, format);
        let mut first: Option<Image> = None;
        for Subject { name, baker } in every_baker() {
            let blended = baker.blend(&BlendInputs { base, detail, mask }, &options).expect("a blend");
            let blended = Image::from(&blended);
            let expected = first.get_or_insert_with(|| blended.clone());
            assert_same(format_args!("{name}, {method:?}"), &blended, expected);
        }
        let first = first.expect("a baker");
        for corner in SAMPLES {
            let part = |map: &NormalMap| {
                let Image { size, format, bits } = sample(&Image::from(map), corner);
                normal_map(size.width(), size.height(), format, &bits)
            };
            let [base, detail] = [base, detail].map(part);
            let mask = mask.map(|mask| heights_around(mask, corner, 0));
            let inputs = BlendInputs { mask: mask.as_ref(), ..pair(&base, &detail) };
            let expected = blend(&inputs, &options, UnormZero::Zero).image;
            assert_same(format_args!("{method:?}, {corner:?}"), &sample(&first, corner), &expected);
        }
    }
}

#[test]
fn shipped_normals_become_the_same_parallax_map_everywhere() {
    let Some(materials) = materials() else { return };
    for Material { heights, normals } in &materials {
        let format = ParallaxFormat::default();
        let mut first: Option<Image<ParallaxFormat>> = None;
        for Subject { name, baker } in every_baker() {
            let baked = baker.parallax_with_normals(heights, normals, format, Precision::Exact).expect("a bake");
            let baked = Image::from(&baked);
            let expected = first.get_or_insert_with(|| baked.clone());
            assert_same(name, &baked, expected);
        }
        let first = first.expect("a baker");
        for corner in SAMPLES {
            let Image { size, format: of_normals, bits } = sample(&Image::from(normals), corner);
            let normals = normal_map(size.width(), size.height(), of_normals, &bits);
            let expected = parallax_with_normals(&heights_around(heights, corner, 0), &normals, format).image;
            assert_same(format_args!("{corner:?}"), &sample(&first, corner), &expected);
        }
    }
}
