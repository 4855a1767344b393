//! Tangents for a mesh of the program's own: a ring whose texture is mirrored half way round.
//!
//!     cargo run --release --example 05_tangents

use std::f32::consts::TAU;
use std::time::Instant;
use texbake::{Baker, CornerAdjacency, Mesh, TangentMethod, TangentOptions};

fn main() -> texbake::Result<()> {
    let baker = Baker::auto();
    let ring = ring(512, 128, 0.0)?;

    // MikkTSpace, as glTF and every engine expect it. A vertex where the halves meet needs two tangents: it is split.
    let made = baker.tangents(&ring, &TangentOptions::default())?;
    let positions: Vec<_> = made.sources().map(|source| ring.positions()[source as usize]).collect();
    let triangles = made.triangles.as_deref().unwrap_or(ring.triangles());
    println!("{} tangents for {} positions and {} triangles", made.tangents.len(), positions.len(), triangles.len());
    println!("{} of {} vertices lie between mirrored halves", made.report.mirrored, made.report.vertices);

    // A mesh that moves keeps its triangles: what meets at its vertices is found once.
    let adjacency = CornerAdjacency::of(&ring);
    let options = TangentOptions { method: TangentMethod::Lengyel, ..TangentOptions::default() };
    let start = Instant::now();
    for frame in 0..10 {
        let moved = self::ring(512, 128, 0.1 * frame as f32)?;
        baker.tangents_with(&moved, Some(&adjacency), &options)?;
    }
    println!("10 frames in {:.1} ms on {}", start.elapsed().as_secs_f64() * 1e3, baker.name());
    Ok(())
}

/// A torus around z of `around` by `across` squares, whose tube is as thick as `swell` makes it.
fn ring(around: u32, across: u32, swell: f32) -> texbake::Result<Mesh> {
    let (mut positions, mut normals, mut texcoords) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..around {
        let (sin, cos) = (TAU * i as f32 / around as f32).sin_cos();
        // Forth over one half and back over the other, so that no seam is needed.
        let u = 8.0 * (2 * i).min(2 * (around - i)) as f32 / around as f32;
        for j in 0..=across {
            let (height, outwards) = (TAU * j as f32 / across as f32).sin_cos();
            let (tube, radius) = (0.4 + 0.1 * swell, 1.0 + (0.4 + 0.1 * swell) * outwards);
            positions.push([radius * cos, radius * sin, tube * height]);
            normals.push([outwards * cos, outwards * sin, height]);
            texcoords.push([u, 4.0 - 4.0 * j as f32 / across as f32]);
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
