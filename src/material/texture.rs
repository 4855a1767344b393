//! A map as a texture unit samples it.

use crate::map::{
    Channels, CodesRef, Convention, Depth, Edge, Edges, Encoding, HeightMap, Heights, NormalMap, ParallaxMap, Size,
    TexelFormat,
};
use crate::shading::{decode_biased_8_bit, decode_biased_16_bit, decode_snorm, decode_unorm, green_turned, rebuild_z};

/// Texels of `N` components, decoded.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture<const N: usize> {
    size: Size,
    edges: Edges,
    texels: Vec<[f32; N]>,
}

impl<const N: usize> Texture<N> {
    /// Width and height in texels.
    pub fn size(&self) -> Size {
        self.size
    }

    /// What is beyond the border.
    pub fn edges(&self) -> Edges {
        self.edges
    }

    /// The texels, row by row from the top.
    pub fn texels(&self) -> &[[f32; N]] {
        &self.texels
    }

    /// The texel in column x, row y; beyond the border as the edges say.
    pub fn texel(&self, x: i64, y: i64) -> [f32; N] {
        let [width, height] = [self.size.width(), self.size.height()];
        let column = beyond(self.edges.x, x, width as i64) as usize;
        self.texels[beyond(self.edges.y, y, height as i64) as usize * width + column]
    }

    /// The value at texture coordinates, linear between the centres of texels, which are at (i + 1/2) / r; beyond the
    /// border as the edges say.
    pub fn sample(&self, [u, v]: [f32; 2]) -> [f32; N] {
        let ([left, right], across) = between(u, self.size.width(), self.edges.x);
        let ([above, below], down) = between(v, self.size.height(), self.edges.y);
        let texel = |x: usize, y: usize| self.texels[y * self.size.width() + x];
        let (nw, ne, sw, se) = (texel(left, above), texel(right, above), texel(left, below), texel(right, below));
        std::array::from_fn(|i| {
            let (top, bottom) = (mix(nw[i], ne[i], across), mix(sw[i], se[i], across));
            mix(top, bottom, down)
        })
    }
}

fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// The texels on either side of a coordinate, and how far it is from the first towards the second.
fn between(coordinate: f32, count: usize, edge: Edge) -> ([usize; 2], f32) {
    let at = coordinate * count as f32 - 0.5;
    let first = at.floor();
    let texel = |i: i64| beyond(edge, i, count as i64) as usize;
    // `as` saturates, so that what is no coordinate is still some texel.
    let i = first as i64;
    ([texel(i), texel(i.saturating_add(1))], at - first)
}

/// The texel that stands for texel `i` of an axis of `n`, however far outside.
fn beyond(edge: Edge, i: i64, n: i64) -> i64 {
    match edge {
        Edge::Wrap => i.rem_euclid(n),
        Edge::Clamp => i.clamp(0, n - 1),
        Edge::Mirror if n == 1 => 0,
        Edge::Mirror => {
            let i = i.rem_euclid(2 * (n - 1));
            i.min(2 * (n - 1) - i)
        }
    }
}

impl Texture<1> {
    /// Heights; floats below 0 and above 1 count as 0 and 1, as for a parallax map.
    pub fn of_heights(map: &HeightMap, edges: Edges) -> Self {
        let texels = match map.heights() {
            Heights::U8(codes) => codes.iter().map(|&code| [f32::from(code) / 255.0]).collect(),
            Heights::U16(codes) => codes.iter().map(|&code| [f32::from(code) / 65_535.0]).collect(),
            Heights::F32(heights) => heights.iter().map(|&height| [height.clamp(0.0, 1.0)]).collect(),
        };
        Self { size: map.size(), edges, texels }
    }

    /// The values of a parallax map, n_z (2h - 1).
    pub fn of_parallax(map: &ParallaxMap, edges: Edges) -> Self {
        let format = map.format().texel();
        let texel = |i: usize| [decoded(format, [0; 3].map(|_| sample(format, map.codes(), i)))[0]];
        Self { size: map.size(), edges, texels: (0..map.size().texels()).map(texel).collect() }
    }
}

impl Texture<3> {
    /// The normals of a map as a shader decodes them, y along growing v; of any length.
    pub fn of_normals(map: &NormalMap, edges: Edges) -> Self {
        let (format, codes) = (map.format(), map.codes());
        let at = |i: usize| sample(format.texel(), codes, i);
        let texel = |i: usize| {
            let m = match format.channels {
                Channels::Xyz => decoded(format.texel(), [at(3 * i), at(3 * i + 1), at(3 * i + 2)]),
                Channels::Xy => {
                    let [x, y, _] = decoded(format.texel(), [at(2 * i), at(2 * i + 1), 0.0]);
                    rebuild_z([x, y])
                }
            };
            if format.convention == Convention::Gl { green_turned(m) } else { m }
        };
        Self { size: map.size(), edges, texels: (0..map.size().texels()).map(texel).collect() }
    }
}

/// What a texture unit makes of a code: [0, 1] for unsigned channels, [-1, 1] for signed ones, floats as they are.
fn sample(format: TexelFormat, codes: CodesRef<'_>, at: usize) -> f32 {
    let is_signed = format.encoding == Encoding::Snorm;
    match codes {
        CodesRef::U8(codes) if is_signed => f32::from(codes[at] as i8) / 127.0,
        CodesRef::U16(codes) if is_signed => f32::from(codes[at] as i16) / 32_767.0,
        CodesRef::U8(codes) => f32::from(codes[at]) / 255.0,
        CodesRef::U16(codes) => f32::from(codes[at]) / 65_535.0,
        CodesRef::F16(codes) => codes[at].to_f32(),
        CodesRef::F32(codes) => codes[at],
    }
}

fn decoded(format: TexelFormat, samples: [f32; 3]) -> [f32; 3] {
    match (format.encoding, format.depth) {
        (Encoding::Unorm, _) => decode_unorm(samples),
        (Encoding::Snorm, _) => decode_snorm(samples),
        (Encoding::Biased, Depth::Bits8) => decode_biased_8_bit(samples),
        (Encoding::Biased, _) => decode_biased_16_bit(samples),
        (Encoding::Float, _) => samples,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Grid;

    #[test]
    fn samples_lie_between_the_centres_of_texels() {
        let map = HeightMap::try_from(Grid::new(2, 2, vec![0.0f32, 1.0, 0.5, 0.25]).unwrap()).unwrap();
        for (edge, uv, expected) in [
            (Edge::Wrap, [0.25, 0.25], 0.0),
            (Edge::Wrap, [0.5, 0.25], 0.5),
            (Edge::Wrap, [0.5, 0.5], 0.4375),
            (Edge::Wrap, [0.0, 0.25], 0.5),
            (Edge::Wrap, [7.25, -2.75], 0.0),
            (Edge::Clamp, [0.0, 0.25], 0.0),
            (Edge::Clamp, [9.0, 9.0], 0.25),
            (Edge::Mirror, [1.25, 0.25], 0.0),
        ] {
            assert_eq!(Texture::of_heights(&map, Edges::both(edge)).sample(uv), [expected], "{edge} {uv:?}");
        }
    }
}
