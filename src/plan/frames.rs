//! Tangents at the vertices, or a cotangent frame at each pixel.

use super::decision::{Decision, Rejected, degrees};
use super::prediction::TangentSpace;
use super::subject::Subject;
use crate::baker::Baker;
use crate::error::{Error, Result};
use crate::inspect::angle;
use crate::io::Model;
use crate::map::{Convention, NormalMap};
use crate::material::Texture;
use crate::measure::{Errors, digits, median_time};
use crate::mesh::Mesh;
use crate::ops::tangents::{TangentOptions, Tangents};
use crate::shading::{cotangent_frame, perturbed_normal, pixel_frame};
use crate::vector::{normalized, sub};
use std::hint::black_box;
use std::path::Path;

/// What 4 floats take at each vertex.
const BYTES_PER_VERTEX: u32 = 16;

/// Points of a triangle that are looked at: shares of its corners.
const POINTS: [[f32; 3]; 4] = [[1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0], [0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]];

/// A cotangent frame where it shows the normals that tangents show, within what `error` of the normal map leaves of the
/// tolerance: it costs no bytes.
pub(super) fn choose(
    subject: &Subject<'_>,
    error: f64,
    normals: Option<&NormalMap>,
) -> Result<(TangentSpace, Decision)> {
    let choice = |space: TangentSpace, reason: String| (space, Decision::new("tangent space", space, reason));
    let Some(normals) = normals else {
        return Ok(choice(TangentSpace::None, "there is no normal map to turn".into()));
    };
    let Some(model) = &subject.material.model else {
        let reason = format!(
            "no tangents, {BYTES_PER_VERTEX} bytes per vertex less; both are the same on flat surfaces that are mapped \
             evenly, and the scene names no model to measure others"
        );
        return Ok(choice(TangentSpace::CotangentFrame, reason));
    };
    let texture = Texture::of_normals(normals, subject.facts().edges);
    let pixels = pixels_of(model)?;
    if pixels.is_empty() {
        let remedy = "give its triangles texture coordinates, or leave model out";
        return Err(Error::file(model, "no triangle has an area in space and in the texture", remedy));
    }
    let errors = Errors::of(pixels.iter().map(|pixel| pixel.difference(&texture)).collect());
    let nanoseconds = |shade: fn(&Pixel, &Texture<3>) -> [f32; 3]| {
        let time = median_time(5, || pixels.iter().for_each(|pixel| _ = black_box(shade(black_box(pixel), &texture))));
        digits(time.as_secs_f64() * 1e9 / pixels.len() as f64)
    };
    let measured = format!(
        "normals of {} differ by {} at most, {} in the mean, in {} pixels",
        model.display(),
        degrees(errors.largest),
        digits(errors.mean),
        pixels.len(),
    );
    let times = format!(
        "{} ns per pixel on one thread of the CPU, with tangents {}",
        nanoseconds(Pixel::with_cotangent_frame),
        nanoseconds(Pixel::with_tangent),
    );
    // What a pixel shows is off by both at most.
    let left = subject.tolerance().normal - error;
    let (taken, mut decision) = match errors.largest <= left {
        true => choice(
            TangentSpace::CotangentFrame,
            format!(
                "no tangents, {BYTES_PER_VERTEX} bytes per vertex less: {measured}, of {} that the map leaves",
                digits(left)
            ),
        ),
        false => {
            choice(TangentSpace::Tangents, format!("{BYTES_PER_VERTEX} bytes per vertex, which normals need here"))
        }
    };
    decision.rejected = vec![match taken {
        TangentSpace::Tangents => {
            Rejected::new(TangentSpace::CotangentFrame, format!("{measured}; the map leaves {}", degrees(left)))
        }
        _ => Rejected::new(TangentSpace::Tangents, format!("{BYTES_PER_VERTEX} bytes per vertex")),
    }];
    Ok((taken, decision.taking(times)))
}

/// A point of a triangle.
struct Pixel {
    texcoord: [f32; 2],
    normal: [f32; 3],
    tangent: ([f32; 3], f32),
    /// Two edges: any two directions on a triangle give the same frame.
    dp: [[f32; 3]; 2],
    duv: [[f32; 2]; 2],
}

impl Pixel {
    fn with_tangent(&self, texture: &Texture<3>) -> [f32; 3] {
        let (t, w) = self.tangent;
        perturbed_normal(pixel_frame(self.normal, t, w), normalized(texture.sample(self.texcoord)))
    }

    fn with_cotangent_frame(&self, texture: &Texture<3>) -> [f32; 3] {
        let frame = cotangent_frame(normalized(self.normal), self.dp, self.duv);
        perturbed_normal(frame, normalized(texture.sample(self.texcoord)))
    }

    /// The angle in degrees between the two.
    fn difference(&self, texture: &Texture<3>) -> f32 {
        let [a, b] = [self.with_tangent(texture), self.with_cotangent_frame(texture)].map(|n| n.map(f64::from));
        angle::degrees(a, b) as f32
    }
}

/// Points of all triangles of a model that have an area in space and in the texture.
fn pixels_of(model: &Path) -> Result<Vec<Pixel>> {
    let model = Model::read(model)?;
    let mut pixels = Vec::new();
    for primitive in 0..model.primitives().len() {
        let mesh = model.mesh(primitive)?;
        // Textures are sampled with y along growing v.
        let options = TangentOptions { convention: Convention::Dx, ..TangentOptions::default() };
        let tangents = Baker::cpu().tangents(&mesh, &options)?;
        pixels.extend(pixels_of_mesh(&mesh, &tangents));
    }
    Ok(pixels)
}

fn pixels_of_mesh(mesh: &Mesh, tangents: &Tangents) -> Vec<Pixel> {
    let sources: Vec<usize> = tangents.sources().map(|source| source as usize).collect();
    let triangles = tangents.triangles.as_deref().unwrap_or(mesh.triangles());
    let normal = |vertex: usize| match &tangents.normals {
        Some(normals) => normals[vertex],
        None => mesh.normals().map_or([0.0; 3], |normals| normals[sources[vertex]]),
    };
    let pixel = |corners: [usize; 3], shares: [f32; 3]| {
        let [p, q, r] = corners.map(|corner| mesh.positions()[sources[corner]]);
        let uvs = corners.map(|corner| mesh.texcoords()[sources[corner]]);
        let duv = [1, 2].map(|i| [uvs[i][0] - uvs[0][0], uvs[i][1] - uvs[0][1]]);
        let tangent = corners.map(|corner| tangents.tangents[corner]);
        let dp = [sub(q, p), sub(r, p)];
        let [cross_x, cross_y, cross_z] = crate::vector::cross(dp[0], dp[1]);
        let has_area = [cross_x, cross_y, cross_z] != [0.0; 3] && duv[0][0] * duv[1][1] != duv[0][1] * duv[1][0];
        has_area.then(|| Pixel {
            texcoord: mix(shares, uvs),
            normal: mix(shares, corners.map(normal)),
            tangent: (mix(shares, tangent.map(|[x, y, z, _]| [x, y, z])), tangent[0][3]),
            dp,
            duv,
        })
    };
    let corners = triangles.iter().map(|triangle| triangle.map(|corner| corner as usize));
    corners.flat_map(|corners| POINTS.map(|shares| pixel(corners, shares))).flatten().collect()
}

fn mix<const N: usize>(shares: [f32; 3], [a, b, c]: [[f32; N]; 3]) -> [f32; N] {
    std::array::from_fn(|i| shares[0] * a[i] + shares[1] * b[i] + shares[2] * c[i])
}
