//! Draws the README's picture of tangents: a ring whose texture is mirrored half way round, lit through a normal map,
//! then its tangents as colours, then their signs.
//!
//!     cargo run --release --example make_tangents_picture

use std::error::Error;
use std::f32::consts::TAU;
use std::fs::File;
use std::io::BufWriter;
use texbake::{Baker, CodesRef, HeightMap, Mesh, NormalMap, NormalOptions, Scale, TangentOptions};

const SIDE: usize = 200;
/// Rows above and below the ring that are left away.
const MARGIN: usize = 21;
const GAP: usize = 8;
/// Each pixel is this many samples wide and high.
const SAMPLES: usize = 3;
const LIGHT: [f32; 3] = [-0.45, 0.6, 0.66];

/// A vertex as the rasteriser interpolates it.
type Attributes = [f32; 12];

fn main() -> Result<(), Box<dyn Error>> {
    let baker = Baker::auto();
    let bricks = HeightMap::read("examples/textures/walls/bricks_height.png")?;
    let bricks = baker.normal(&bricks, &NormalOptions { scale: Scale::texels(24), ..Default::default() })?;
    let ring = ring(192, 96)?;
    let made = baker.tangents(&ring, &TangentOptions::default())?;

    let normals = ring.normals().ok_or("it has normals")?;
    let vertex = |(vertex, source): (usize, u32)| {
        let source = source as usize;
        let (p, n, t, uv) =
            (ring.positions()[source], normals[source], made.tangents[vertex], ring.texcoords()[source]);
        [tilted(p).as_slice(), &tilted(n), &tilted([t[0], t[1], t[2]]), &t[3..], &uv].concat().try_into()
    };
    let vertices: Result<Vec<Attributes>, _> = made.sources().enumerate().map(vertex).collect();
    let vertices = vertices.map_err(|_| "twelve numbers for each vertex")?;
    let triangles = made.triangles.as_deref().unwrap_or(ring.triangles());

    let lit = rasterised(&vertices, triangles, |n, t, sign, uv| {
        let bitangent = times(sign, cross(n, t));
        let m = texel(&bricks, uv);
        let n = unit(add(add(times(m[0], t), times(m[1], bitangent)), times(m[2], n)));
        [0.92, 0.82, 0.72].map(|colour| colour * (0.18 + 0.82 * dot(n, unit(LIGHT)).max(0.0)))
    });
    let tangents = rasterised(&vertices, triangles, |_, t, _, _| t.map(|part| 0.5 + 0.5 * part));
    let signs = rasterised(&vertices, triangles, |n, _, sign, _| {
        let colour = if sign > 0.0 { [0.25, 0.6, 0.95] } else { [0.98, 0.6, 0.2] };
        colour.map(|part| part * (0.35 + 0.65 * dot(n, unit(LIGHT)).max(0.0)))
    });
    draw("docs/tangents.png", &[lit, tangents, signs])
}

/// A torus around z of `around` by `across` squares; u runs forth over one half and back over the other.
fn ring(around: u32, across: u32) -> texbake::Result<Mesh> {
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

/// Seen from above and in front: turned around x, so that the eye looks along -z.
fn tilted([x, y, z]: [f32; 3]) -> [f32; 3] {
    let (sin, cos) = (-50f32.to_radians()).sin_cos();
    [x, cos * y - sin * z, sin * y + cos * z]
}

/// RGB rows of a square in which `colour` gives each sample its colour: from normal, tangent, sign and texture
/// coordinate.
fn rasterised(
    vertices: &[Attributes],
    triangles: &[[u32; 3]],
    colour: impl Fn([f32; 3], [f32; 3], f32, [f32; 2]) -> [f32; 3],
) -> Vec<u8> {
    let side = SIDE * SAMPLES;
    let (mut depths, mut samples) = (vec![f32::MIN; side * side], vec![[1.0; 3]; side * side]);
    let at = |value: f32| (value / 3.0 + 0.5) * side as f32;
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| &vertices[vertex as usize]);
        let [p, q, r] = [a, b, c].map(|vertex| [at(vertex[0]), at(-vertex[1])]);
        let area =
            |p: [f32; 2], q: [f32; 2], r: [f32; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let whole = area(p, q, r);
        // Counterclockwise with y up is clockwise with y down.
        if whole >= 0.0 {
            continue;
        }
        let range = |axis: usize| {
            let values = [p[axis], q[axis], r[axis]];
            let least = values.into_iter().fold(f32::MAX, f32::min).max(0.0);
            let greatest = values.into_iter().fold(f32::MIN, f32::max).min(side as f32 - 1.0);
            least as usize..=greatest as usize
        };
        for y in range(1) {
            for x in range(0) {
                let s = [x as f32 + 0.5, y as f32 + 0.5];
                let weights = [area(s, q, r) / whole, area(p, s, r) / whole, area(p, q, s) / whole];
                let mixed: Attributes =
                    std::array::from_fn(|i| weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i]);
                let depth = &mut depths[y * side + x];
                if weights.iter().all(|&weight| weight >= 0.0) && mixed[2] > *depth {
                    *depth = mixed[2];
                    let [_, _, _, nx, ny, nz, tx, ty, tz, sign, u, v] = mixed;
                    samples[y * side + x] = colour(unit([nx, ny, nz]), unit([tx, ty, tz]), sign, [u, v]);
                }
            }
        }
    }
    let pixel = |i: usize| {
        let (x, y) = (i % SIDE * SAMPLES, i / SIDE * SAMPLES);
        let of_pixel = (0..SAMPLES * SAMPLES).map(|s| samples[(y + s / SAMPLES) * side + x + s % SAMPLES]);
        let mean = times(1.0 / (SAMPLES * SAMPLES) as f32, of_pixel.fold([0.0; 3], add));
        // Steps of five: hardly seen, and the file becomes half as large.
        mean.map(|part| (part.clamp(0.0, 1.0) * 51.0 + 0.5) as u8 * 5)
    };
    (0..SIDE * SIDE).flat_map(pixel).collect()
}

/// The nearest normal of a map of 8-bit codes that repeats; the first row is v = 0.
fn texel(map: &NormalMap, [u, v]: [f32; 2]) -> [f32; 3] {
    let CodesRef::U8(codes) = map.codes() else { unreachable!("8 bits are the default") };
    let (width, height) = (map.size().width(), map.size().height());
    let at = |value: f32, count: usize| ((value.rem_euclid(1.0) * count as f32) as usize).min(count - 1);
    let first = 3 * (at(v, height) * width + at(u, width));
    [0, 1, 2].map(|channel| (f32::from(codes[first + channel]) - 127.5) / 127.5)
}

/// Writes squares of RGB rows side by side, without their margins.
fn draw(path: &str, squares: &[Vec<u8>]) -> Result<(), Box<dyn Error>> {
    let (width, height) = (squares.len() * (SIDE + GAP) - GAP, SIDE - 2 * MARGIN);
    let mut picture = vec![255; 3 * width * height];
    for (index, square) in squares.iter().enumerate() {
        for (row, pixels) in square.chunks(3 * SIDE).skip(MARGIN).take(height).enumerate() {
            picture[3 * (row * width + index * (SIDE + GAP))..][..3 * SIDE].copy_from_slice(pixels);
        }
    }
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.write_header()?.write_image_data(&picture)?;
    Ok(())
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn add(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn times(factor: f32, v: [f32; 3]) -> [f32; 3] {
    v.map(|part| factor * part)
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    times(1.0 / dot(v, v).sqrt(), v)
}
