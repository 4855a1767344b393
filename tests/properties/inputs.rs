//! Any input: sizes, heights, texels, options.

use half::f16;
use proptest::collection::vec;
use proptest::prelude::*;
use texbake::{
    BakeOptions, Channels, Codes, Convention, Depth, Edge, Edges, Encoding, Error, Filter, Grid, HeightMap,
    NormalFormat, NormalMap, ParallaxFormat, Precision, Rational, Scale, Size,
};

/// Heights as a program gives them: not all are a map.
#[derive(Debug, Clone, PartialEq)]
pub enum Heights {
    U8(Vec<u8>),
    U16(Vec<u16>),
    F32(Vec<f32>),
}

/// Width, height and heights.
#[derive(Debug, Clone, PartialEq)]
pub struct Terrain {
    pub width: usize,
    pub height: usize,
    pub heights: Heights,
}

impl Terrain {
    pub fn map(&self) -> Result<HeightMap, Error> {
        let Self { width, height, .. } = *self;
        Ok(match &self.heights {
            Heights::U8(heights) => Grid::new(width, height, heights.clone())?.into(),
            Heights::U16(heights) => Grid::new(width, height, heights.clone())?.into(),
            Heights::F32(heights) => Grid::new(width, height, heights.clone())?.try_into()?,
        })
    }

    /// The heights of other texels: that in column x, row y is the one at `from(x, y)`.
    pub fn rearranged(&self, width: usize, height: usize, from: impl Fn(usize, usize) -> [usize; 2]) -> Self {
        let index = |i: usize| {
            let [x, y] = from(i % width, i / width);
            y * self.width + x
        };
        let indices = 0..width * height;
        let heights = match &self.heights {
            Heights::U8(heights) => Heights::U8(indices.map(|i| heights[index(i)]).collect()),
            Heights::U16(heights) => Heights::U16(indices.map(|i| heights[index(i)]).collect()),
            Heights::F32(heights) => Heights::F32(indices.map(|i| heights[index(i)]).collect()),
        };
        Self { width, height, heights }
    }
}

/// Mostly small, for smaller is more of them; 1 is as likely as any.
pub fn side() -> impl Strategy<Value = usize> {
    prop_oneof![2 => 1..=3usize, 3 => 1..=12usize, 1 => 1..=40usize]
}

/// Any float, those that are no number too, and the ends and joints of what is decided for floats.
pub fn any_float() -> BoxedStrategy<f32> {
    prop_oneof![8 => finite_float(), 1 => any::<u32>().prop_map(f32::from_bits)].boxed()
}

/// Any finite float.
pub fn finite_float() -> BoxedStrategy<f32> {
    let landmarks = [0.0, -0.0, 1.0, -1.0, 0.5, f32::MAX, f32::MIN, f32::MIN_POSITIVE, f32::from_bits(1)];
    let powers = [-149, -126, -100, -91, -90, -60, -40, -26, -25, -24, -1, 16, 60, 64, 94, 127];
    let of_power = (prop::sample::select(powers.to_vec()), -1..=1i32, any::<bool>()).prop_map(|(power, step, sign)| {
        let value = f32::from_bits(((2f64.powi(power) as f32).to_bits() as i32 + step) as u32);
        if sign { -value } else { value }
    });
    let of_bits = any::<u32>().prop_map(|bits| {
        let value = f32::from_bits(bits);
        if value.is_finite() { value } else { 0.0 }
    });
    prop_oneof![
        4 => (0..=255u8).prop_map(|code| f32::from(code) / 255.0),
        2 => prop::sample::select(landmarks.to_vec()),
        1 => of_power,
        1 => of_bits,
    ]
    .boxed()
}

pub fn terrain(float: impl Strategy<Value = f32> + Clone + 'static) -> impl Strategy<Value = Terrain> {
    (side(), side()).prop_flat_map(move |(width, height)| {
        let texels = width * height;
        let heights = prop_oneof![
            vec(prop_oneof![any::<u8>(), prop::sample::select(vec![0u8, 255])], texels).prop_map(Heights::U8),
            vec(prop_oneof![any::<u16>(), prop::sample::select(vec![0u16, 65_535])], texels).prop_map(Heights::U16),
            vec(float.clone(), texels).prop_map(Heights::F32),
        ];
        heights.prop_map(move |heights| Terrain { width, height, heights })
    })
}

pub fn edge() -> impl Strategy<Value = Edge> {
    prop::sample::select(vec![Edge::Wrap, Edge::Clamp, Edge::Mirror])
}

pub fn edges() -> impl Strategy<Value = Edges> {
    (edge(), edge()).prop_map(|(x, y)| Edges { x, y })
}

pub fn filter() -> impl Strategy<Value = Filter> {
    prop::sample::select(vec![Filter::Central, Filter::Sobel, Filter::Scharr, Filter::Prewitt])
}

/// Any number that there is, mostly a short one.
pub fn rational() -> BoxedStrategy<Rational> {
    let landmarks =
        ["0", "1", "-1", "24", "1e6", "1e-6", "16777215", "-16777215", "1/16777215", "16777216", "65535", "-65536"];
    let long = |limit: i64| (-limit..=limit, 1..=limit).prop_map(|(n, d)| Rational::new(n, d).expect("a number"));
    prop_oneof![
        4 => long(99),
        2 => prop::sample::select(landmarks.to_vec()).prop_map(|text| text.parse().expect("a number")),
        1 => long(1 << 25),
        1 => long(999_999_999_999_999_999),
    ]
    .boxed()
}

pub fn scale() -> impl Strategy<Value = Scale> {
    prop_oneof![
        4 => rational().prop_map(Scale::Texels),
        1 => (rational(), rational(), rational()).prop_map(|(width, height, depth)| Scale::physical(width, height, depth)),
    ]
}

fn encoding() -> impl Strategy<Value = Encoding> {
    prop::sample::select(vec![Encoding::Unorm, Encoding::Snorm, Encoding::Biased, Encoding::Float])
}

fn depth() -> impl Strategy<Value = Depth> {
    prop::sample::select(vec![Depth::Bits8, Depth::Bits16, Depth::Float16, Depth::Float32])
}

/// An encoding at a depth that it has.
fn matching() -> impl Strategy<Value = (Encoding, Depth)> {
    (encoding(), any::<bool>()).prop_map(|(encoding, deep)| match (encoding, deep) {
        (Encoding::Float, false) => (encoding, Depth::Float16),
        (Encoding::Float, true) => (encoding, Depth::Float32),
        (_, false) => (encoding, Depth::Bits8),
        (_, true) => (encoding, Depth::Bits16),
    })
}

/// What can be stored, and now and then what cannot.
fn code() -> impl Strategy<Value = (Encoding, Depth)> {
    prop_oneof![15 => matching(), 1 => (encoding(), depth())]
}

fn normal_of(code: impl Strategy<Value = (Encoding, Depth)>) -> impl Strategy<Value = NormalFormat> {
    let channels = prop::sample::select(vec![Channels::Xyz, Channels::Xy]);
    let convention = prop::sample::select(vec![Convention::Gl, Convention::Dx]);
    (code, channels, convention).prop_map(|((encoding, depth), channels, convention)| NormalFormat {
        encoding,
        depth,
        channels,
        convention,
    })
}

pub fn any_normal_format() -> impl Strategy<Value = NormalFormat> {
    normal_of(code())
}

/// A format that there is.
pub fn normal_format() -> impl Strategy<Value = NormalFormat> {
    normal_of(matching())
}

pub fn any_parallax_format() -> impl Strategy<Value = ParallaxFormat> {
    code().prop_map(|(encoding, depth)| ParallaxFormat { encoding, depth })
}

/// Whether a depth goes with an encoding.
pub fn is_stored(encoding: Encoding, depth: Depth) -> bool {
    (encoding == Encoding::Float) == depth.is_float()
}

pub fn bake_options() -> impl Strategy<Value = BakeOptions> {
    let maps = (prop::option::weighted(0.8, any_normal_format()), prop::option::of(any_parallax_format()));
    (scale(), filter(), edges(), maps).prop_map(|(scale, filter, edges, (normal, parallax))| BakeOptions {
        scale,
        filter,
        edges,
        normal,
        parallax,
        roughness: None,
        precision: Precision::Exact,
    })
}

/// Any bits as a map of this size: in every fourth one floats may be no direction.
pub fn normal_map(width: usize, height: usize, format: NormalFormat) -> impl Strategy<Value = NormalMap> {
    let size = Size::new(width, height).expect("a size");
    let count = width * height * format.channels.count();
    let float = prop_oneof![
        6 => -1.0..=1.0f32,
        2 => finite_float().prop_map(|value| value.clamp(-65_536.0, 65_536.0)),
    ]
    .boxed();
    let codes = match format.depth {
        Depth::Bits8 => {
            let landmarks = prop::sample::select(vec![0u8, 1, 127, 128, 129, 255]);
            vec(prop_oneof![any::<u8>(), landmarks], count).prop_map(Codes::U8).boxed()
        }
        Depth::Bits16 => {
            let landmarks = prop::sample::select(vec![0u16, 1, 32_767, 32_768, 32_769, 65_535]);
            vec(prop_oneof![any::<u16>(), landmarks], count).prop_map(Codes::U16).boxed()
        }
        Depth::Float16 => {
            // 65504 is the greatest.
            let half = float.prop_map(|value| f16::from_f32(value.clamp(-65_504.0, 65_504.0)));
            prop_oneof![3 => vec(half, count), 1 => vec(any::<u16>().prop_map(f16::from_bits), count)]
                .prop_map(Codes::F16)
                .boxed()
        }
        Depth::Float32 => {
            prop_oneof![3 => vec(float, count), 1 => vec(any_float(), count)].prop_map(Codes::F32).boxed()
        }
    };
    codes.prop_map(move |codes| NormalMap::new(size, format, codes).expect("a map"))
}
