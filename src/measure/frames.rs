//! Normal mapping with precomputed tangents and without: what each costs, and how far they are from each other.

use super::Errors;
use super::maps::timed;
use super::real::{normalized, sum};
use super::seen::{Pixel, pixels};
use super::steps::Steps;
use super::surfaces::SURFACES;
use crate::baker::Baker;
use crate::error::Result;
use crate::inspect::angle::degrees;
use crate::map::Convention;
use crate::material::Material;
use crate::mesh::Mesh;
use crate::ops::tangents::TangentOptions;
use crate::shading::{cotangent_frame, perturbed_normal, pixel_frame, without_perspective};
use crate::vector;
use serde::Serialize;
use std::hint::black_box;

/// A way to tangent space on one mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrameFigure {
    /// The mesh, or the primitive of a model.
    pub mesh: String,
    /// `tangents`, `tangents, sign in a bit`, `cotangent frame` or `without perspective`.
    pub frame: &'static str,
    /// Bytes that each vertex has for it.
    pub bytes_per_vertex: u32,
    /// Angles to the perturbed normals with interpolated MikkTSpace tangents.
    pub to_tangents_degrees: Errors,
    /// Angles to those of the surface itself, with the gradients of u and v in double precision; of models nobody knows.
    pub to_surface_degrees: Option<Errors>,
    /// Time on one thread of the CPU, by the functions of [`crate::shading`]: the median.
    pub nanoseconds_per_pixel: f64,
    /// Pixels that were looked at.
    pub pixels: usize,
}

/// How a pixel perturbs its normal by the map's normal.
type Perturb = fn(&Pixel, [f32; 3]) -> [f32; 3];

/// The ways, with bytes per vertex.
const FRAMES: [(&str, u32, Perturb); 4] = [
    ("tangents", 16, |pixel, m| with_tangent(pixel.normal, pixel.tangent, m)),
    ("tangents, sign in a bit", 12, |pixel, m| with_tangent(pixel.normal, pixel.packed_tangent, m)),
    ("cotangent frame", 0, |pixel, m| {
        perturbed_normal(cotangent_frame(vector::normalized(pixel.normal), pixel.dp, pixel.duv), m)
    }),
    ("without perspective", 0, |pixel, m| {
        perturbed_normal(without_perspective(vector::normalized(pixel.normal), pixel.dp, pixel.duv), m)
    }),
];

fn with_tangent(n: [f32; 3], (t, w): ([f32; 3], f32), m: [f32; 3]) -> [f32; 3] {
    perturbed_normal(pixel_frame(n, t, w), m)
}

/// How much is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub pixels: usize,
    pub seed: u64,
    pub runs: usize,
}

/// Every way on the generated surfaces, then on the meshes of models; a mesh that shows nothing has no figures.
pub(super) fn frame_figures(
    material: &Material,
    models: &[(String, Mesh)],
    extent: Extent,
    steps: &mut Steps<'_>,
) -> Result<Vec<FrameFigure>> {
    let mut figures = Vec::new();
    for surface in SURFACES {
        steps.next(&format!("tangent space, {}", surface.name))?;
        let (mesh, parameters) = surface.mesh()?;
        let truth = |pixel: &Pixel, m: [f32; 3]| {
            let corners = mesh.triangles()[pixel.triangle].map(|vertex| parameters[vertex as usize]);
            let parameter = |axis: usize| (0..3).map(|i| pixel.shares[i] * corners[i][axis]).sum();
            let [t, b, n] = (surface.at)(parameter(0), parameter(1)).frame();
            normalized(sum([(m[0].into(), t), (m[1].into(), b), (m[2].into(), n)]))
        };
        figures.extend(of_mesh(surface.name, &mesh, material, Some(&truth), extent)?);
    }
    for (name, mesh) in models {
        steps.next(&format!("tangent space, {name}"))?;
        figures.extend(of_mesh(name, mesh, material, None, extent)?);
    }
    Ok(figures)
}

/// What the perturbed normal of a pixel is on the surface itself.
type Truth<'a> = &'a dyn Fn(&Pixel, [f32; 3]) -> [f64; 3];

fn of_mesh(
    name: &str,
    mesh: &Mesh,
    material: &Material,
    truth: Option<Truth<'_>>,
    Extent { pixels: count, seed, runs }: Extent,
) -> Result<Vec<FrameFigure>> {
    // Materials have y along growing v: green down.
    let options = TangentOptions { convention: Convention::Dx, ..TangentOptions::default() };
    let tangents = Baker::cpu().tangents(mesh, &options)?;
    let seen = pixels(mesh, &tangents, count, seed);
    let seen: Vec<(Pixel, [f32; 3])> = seen.into_iter().map(|pixel| (pixel, material.normal(pixel.texcoord))).collect();
    if seen.is_empty() {
        return Ok(Vec::new());
    }
    let angles = |frame: Perturb, to: &dyn Fn(&Pixel, [f32; 3]) -> [f64; 3]| {
        let angle = |(pixel, m): &(Pixel, [f32; 3])| degrees(to(pixel, *m), frame(pixel, *m).map(f64::from)) as f32;
        Errors::of(seen.iter().map(angle).collect())
    };
    let (_, _, with_tangents) = FRAMES[0];
    let figure = |(frame, bytes_per_vertex, perturb): (&'static str, u32, Perturb)| {
        let time = timed(runs, || {
            seen.iter().for_each(|(pixel, m)| _ = black_box(perturb(black_box(pixel), *m)));
            Ok(())
        })?;
        Ok(FrameFigure {
            mesh: name.into(),
            frame,
            bytes_per_vertex,
            to_tangents_degrees: angles(perturb, &|pixel, m| with_tangents(pixel, m).map(f64::from)),
            to_surface_degrees: truth.map(|truth| angles(perturb, truth)),
            nanoseconds_per_pixel: time.as_secs_f64() * 1e9 / seen.len() as f64,
            pixels: seen.len(),
        })
    };
    FRAMES.into_iter().map(figure).collect()
}
