//! Draws the README's picture of tangents: a ring whose texture is mirrored half way round, lit through a normal map,
//! then its tangents as colours, then their signs.
//!
//!     cargo run --release --example make_tangents_picture

use std::f32::consts::TAU;
use std::ops::Range;
use texbake::material::{Material, ParallaxMethod};
use texbake::preview::{Canvas, Look, Paint, Picture, Viewpoint, Worn};
use texbake::{BakeOptions, Baker, HeightMap, Mesh, Result, Scale, TangentOptions};

const SIDE: usize = 200;
/// The rows that the ring fills.
const ROWS: Range<usize> = 30..186;
const GAP: usize = 8;
/// Each pixel is this many samples wide and high.
const SAMPLES: usize = 3;
/// Enough for so few colours, and a third of the bytes.
const COLOURS: usize = 200;

fn main() -> Result<()> {
    let baker = Baker::auto();
    let heights = HeightMap::read("examples/textures/walls/bricks_height.png")?;
    let options = BakeOptions { scale: Scale::texels(24), ..Default::default() };
    let bricks = Material::bake(&baker, &heights, &options)?;
    let mesh = ring(192, 96)?;
    let ring = Worn::of_tangents(&mesh, &baker.tangents(&mesh, &TangentOptions::default())?)?;

    let (sin, cos) = 50f32.to_radians().sin_cos();
    let viewpoint = Viewpoint::around(mesh.positions(), [0.0, -sin, cos], [0.0, 1.0, 0.0]);
    let mut picture = Picture::filled([3 * (SIDE + GAP) - GAP, ROWS.len()], [255; 3])?;
    for (i, paint) in [Paint::Lit(ParallaxMethod::None), Paint::Tangents, Paint::Handedness].into_iter().enumerate() {
        let mut canvas = Canvas::new(SIDE * SAMPLES, viewpoint, [1.0; 3]);
        ring.paint(&mut canvas, &viewpoint, &bricks, &Look::default(), paint);
        let square = Picture::of_samples(canvas.colours(), SIDE * SAMPLES, SAMPLES)?;
        picture.paste(&square.rows(ROWS)?, [i * (SIDE + GAP), 0]);
    }
    picture.write_in_colours("docs/tangents.png", COLOURS)
}

/// A torus around z of `around` by `across` squares; u runs forth over one half and back over the other.
fn ring(around: u32, across: u32) -> Result<Mesh> {
    let (mut positions, mut normals, mut texcoords) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..around {
        let (sin, cos) = (TAU * (i as f32 / around as f32 + 0.125)).sin_cos();
        let u = 2.0 * (2 * i).min(2 * (around - i)) as f32 / around as f32;
        for j in 0..=across {
            let (height, outwards) = (TAU * j as f32 / across as f32).sin_cos();
            let radius = 1.0 + 0.45 * outwards;
            positions.push([radius * cos, radius * sin, 0.45 * height]);
            normals.push([outwards * cos, outwards * sin, height]);
            texcoords.push([u, 1.0 - j as f32 / across as f32]);
        }
    }
    let corner = |i: u32, j: u32| i % around * (across + 1) + j;
    let square = |i, j| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..around).flat_map(|i| (0..across).flat_map(move |j| square(i, j))).collect();
    Mesh::new(positions, texcoords, triangles)?.with_normals(normals)
}
