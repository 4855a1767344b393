//! The first stage over maps of codes: texels become planes of what they mean.

use super::f16_bits::f32_of_f16;
use super::plane::{BLOCK, Plane, padded, texel};
use crate::exact::CodeReading;
use crate::map::{Channels, CodesRef};
use crate::ops::{LayerReading, float_of_integers};
use half::f16;
use std::ops::Range;

/// The normals of integer codes over L.
pub(super) fn integers(
    layer: &LayerReading,
    reading: &CodeReading,
    codes: CodesRef<'_>,
    texels: Range<usize>,
    normals: &mut [Plane<i32>; 3],
) {
    let codes = slice(codes, layer.channels, texels);
    match (codes, layer.channels) {
        (CodesRef::U8(codes), Channels::Xyz) => integer_planes::<u8, 3>(layer, reading, codes, normals),
        (CodesRef::U8(codes), Channels::Xy) => integer_planes::<u8, 2>(layer, reading, codes, normals),
        (CodesRef::U16(codes), Channels::Xyz) => integer_planes::<u16, 3>(layer, reading, codes, normals),
        (CodesRef::U16(codes), Channels::Xy) => integer_planes::<u16, 2>(layer, reading, codes, normals),
        (CodesRef::F16(_) | CodesRef::F32(_), _) => unreachable!("floats have no integer components"),
    }
}

/// The normals of any codes in written floats; `integers` is scratch.
pub(super) fn floats(
    layer: &LayerReading,
    codes: CodesRef<'_>,
    texels: Range<usize>,
    integers: &mut [Plane<i32>; 3],
    normals: &mut [Plane<f32>; 3],
) {
    if let Some(reading) = &layer.codes {
        let count = texels.len();
        self::integers(layer, reading, codes, texels, integers);
        return floats_of_integers(reading, integers, normals, padded(count));
    }
    let codes = slice(codes, layer.channels, texels);
    match (codes, layer.channels) {
        (CodesRef::F16(codes), Channels::Xyz) => float_planes::<f16, 3>(layer, codes, normals),
        (CodesRef::F16(codes), Channels::Xy) => float_planes::<f16, 2>(layer, codes, normals),
        (CodesRef::F32(codes), Channels::Xyz) => float_planes::<f32, 3>(layer, codes, normals),
        (CodesRef::F32(codes), Channels::Xy) => float_planes::<f32, 2>(layer, codes, normals),
        (CodesRef::U8(_) | CodesRef::U16(_), _) => unreachable!("the format says floats"),
    }
}

fn slice(codes: CodesRef<'_>, channels: Channels, texels: Range<usize>) -> CodesRef<'_> {
    codes.slice(texels.start * channels.count()..texels.end * channels.count())
}

/// The integers of a map of one channel: heights, or a mask.
pub(super) fn scalars(codes: CodesRef<'_>, texels: Range<usize>, plane: &mut Plane<i32>) {
    match codes.slice(texels) {
        CodesRef::U8(codes) => scalar_plane(codes, plane),
        CodesRef::U16(codes) => scalar_plane(codes, plane),
        CodesRef::F16(_) | CodesRef::F32(_) => unreachable!("the plan says integers"),
    }
}

vectorised! {
    fn integer_planes<C: Copy + Into<u32>, const N: usize>(
        layer: &LayerReading,
        reading: &CodeReading,
        codes: &[C],
        [x, y, z]: &mut [Plane<i32>; 3],
    ) {
        let layer = of_channels::<N>(layer);
        for (i, texel) in codes.as_chunks::<N>().0.iter().enumerate().take(BLOCK) {
            let component = |channel: usize| reading.component(texel[channel].into());
            [x[i], y[i], z[i]] = layer.integer_vector(reading, component);
        }
    }
}

vectorised! {
    fn float_planes<C: Float, const N: usize>(
        layer: &LayerReading,
        codes: &[C],
        [x, y, z]: &mut [Plane<f32>; 3],
    ) {
        let layer = of_channels::<N>(layer);
        for (i, texel) in codes.as_chunks::<N>().0.iter().enumerate().take(BLOCK) {
            [x[i], y[i], z[i]] = layer.float_vector(|channel: usize| texel[channel].value());
        }
    }
}

vectorised! {
    fn floats_of_integers(
        reading: &CodeReading,
        integers: &[Plane<i32>; 3],
        [x, y, z]: &mut [Plane<f32>; 3],
        count: usize,
    ) {
        for i in 0..count.min(BLOCK) {
            [x[i], y[i], z[i]] = float_of_integers(reading, texel(integers, i));
        }
    }
}

vectorised! {
    fn scalar_plane<C: Copy + Into<i32>>(codes: &[C], plane: &mut Plane<i32>) {
        for (value, code) in plane.iter_mut().zip(codes) {
            *value = (*code).into();
        }
    }
}

/// The same layer with its channels as a constant, so that a loop does not look at them.
#[inline(always)]
fn of_channels<const N: usize>(layer: &LayerReading) -> LayerReading {
    LayerReading { channels: if N == 3 { Channels::Xyz } else { Channels::Xy }, ..*layer }
}

/// A stored float.
trait Float: Copy {
    fn value(self) -> f32;
}

impl Float for f16 {
    #[inline(always)]
    fn value(self) -> f32 {
        f32_of_f16(self)
    }
}

impl Float for f32 {
    #[inline(always)]
    fn value(self) -> f32 {
        self
    }
}
