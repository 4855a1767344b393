//! A mesh that wears a material.

use super::look::Look;
use super::raster::{Canvas, Corner, Viewpoint};
use crate::error::{Error, Result};
use crate::io::Placement;
use crate::material::{Material, ParallaxMethod};
use crate::mesh::Mesh;
use crate::ops::tangents::Tangents;
use crate::shading::{Frame, green_turned, pixel_frame, to_object, to_tangent};
use crate::split_mix::SplitMix;
use crate::vector::{add, cross, dot, normalized, sub, times};

/// A mesh with normals and tangents of glTF's convention: the bitangent w (n x t) points against growing v, as green does.
#[derive(Debug, Clone, PartialEq)]
pub struct Worn {
    /// Of each vertex: normal, tangent, handedness, texture coordinates.
    vertices: Vec<Corner<9>>,
    triangles: Vec<[u32; 3]>,
}

/// How a mesh is painted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Paint {
    /// Lit, with the normal map, at texture coordinates that a method has moved.
    Lit(ParallaxMethod),
    /// Grey, with lines along some of the normals (blue), tangents (red) and bitangents (green).
    Vectors,
    /// Blue where the texture is as it is, orange where it is mirrored.
    Handedness,
    /// x, y and z of the tangent as red, green and blue.
    Tangents,
}

/// Normals, tangents and bitangents of about so many vertices are drawn, at most.
const DRAWN: usize = 500;
/// A line's length, as a share of the picture's height.
const LINE: f32 = 0.045;
const GREY: [f32; 3] = [0.35, 0.35, 0.36];
const RED: [f32; 3] = [0.85, 0.04, 0.03];
const GREEN: [f32; 3] = [0.03, 0.5, 0.06];
const BLUE: [f32; 3] = [0.03, 0.12, 0.9];
const ORANGE: [f32; 3] = [0.95, 0.32, 0.03];

impl Worn {
    /// A mesh with the tangents that were computed for it, in the convention `gl`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the tangents are of another mesh.
    pub fn of_tangents(mesh: &Mesh, made: &Tangents) -> Result<Self> {
        // Fails unless both belong together.
        made.bitangents(mesh)?;
        let own = mesh.normals().unwrap_or_default();
        let vertex = |(i, source): (usize, u32)| {
            let source = source as usize;
            let n = made.normals.as_ref().map_or_else(|| own[source], |normals| normals[i]);
            corner(mesh, source, n, made.tangents[i])
        };
        let vertices = made.sources().enumerate().map(vertex).collect();
        let triangles = made.triangles.as_deref().unwrap_or(mesh.triangles()).to_vec();
        Ok(Self { vertices, triangles })
    }

    /// A mesh with tangents of its own.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it has no normals, or there is not a tangent for each vertex.
    pub fn with_tangents(mesh: &Mesh, tangents: &[[f32; 4]]) -> Result<Self> {
        let normals =
            mesh.normals().ok_or_else(|| Error::parameter("mesh", "one without normals", "one that has them"))?;
        if tangents.len() != normals.len() {
            let range = format!("{}, one for each vertex", normals.len());
            return Err(Error::parameter("number of tangents", tangents.len(), range));
        }
        let vertices = (0..normals.len()).map(|i| corner(mesh, i, normals[i], tangents[i])).collect();
        Ok(Self { vertices, triangles: mesh.triangles().to_vec() })
    }

    /// The mesh where a node of a scene puts it: normals by the inverse transpose, tangents as its edges; handedness and
    /// triangles turn over in a mirror.
    pub fn placed(&self, placement: &Placement) -> Self {
        let [x, y, z, origin] = *placement;
        let moved = |[a, b, c]: [f32; 3]| add(add(times(a, x), times(b, y)), times(c, z));
        let side = if dot(cross(x, y), z) < 0.0 { -1.0 } else { 1.0 };
        let [across_x, across_y, across_z] = [cross(y, z), cross(z, x), cross(x, y)].map(|axis| times(side, axis));
        let turned = |[a, b, c]: [f32; 3]| add(add(times(a, across_x), times(b, across_y)), times(c, across_z));
        let vertex = |vertex: &Corner<9>| {
            let [nx, ny, nz, tx, ty, tz, w, u, v] = vertex.attributes;
            let [nx, ny, nz] = normalized(turned([nx, ny, nz]));
            let [tx, ty, tz] = normalized(moved([tx, ty, tz]));
            let attributes = [nx, ny, nz, tx, ty, tz, side * w, u, v];
            Corner { position: add(moved(vertex.position), origin), attributes }
        };
        let triangle = |[a, b, c]: &[u32; 3]| if side < 0.0 { [*a, *c, *b] } else { [*a, *b, *c] };
        Self {
            vertices: self.vertices.iter().map(vertex).collect(),
            triangles: self.triangles.iter().map(triangle).collect(),
        }
    }

    /// Bytes that it takes in memory.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&self.vertices[..]) + size_of_val(&self.triangles[..])) as u64
    }

    /// Where its vertices are.
    pub fn positions(&self) -> impl Iterator<Item = [f32; 3]> {
        self.vertices.iter().map(|vertex| vertex.position)
    }

    /// Paints it on a canvas that is seen from `viewpoint`.
    pub fn paint(&self, canvas: &mut Canvas, viewpoint: &Viewpoint, material: &Material, look: &Look, paint: Paint) {
        let light = viewpoint.to_space(look.light.direction());
        for triangle in &self.triangles {
            let corners = triangle.map(|vertex| &self.vertices[vertex as usize]);
            canvas.triangle(corners, |position, attributes| {
                let pixel = Pixel::of(attributes, normalized(sub(viewpoint.eye, position)));
                let (colour, normal) = match paint {
                    Paint::Lit(method) => pixel.of_maps(material, look, method),
                    Paint::Vectors => (GREY, pixel.frame[2]),
                    Paint::Handedness if pixel.sign > 0.0 => (BLUE.map(|part| 0.1 + 0.6 * part), pixel.frame[2]),
                    Paint::Handedness => (ORANGE, pixel.frame[2]),
                    Paint::Tangents => return pixel.frame[0].map(|part| 0.5 + 0.5 * part),
                };
                look.lit(colour, normal, light, pixel.eye)
            });
        }
        if paint == Paint::Vectors {
            self.draw_vectors(canvas, viewpoint);
        }
    }

    fn draw_vectors(&self, canvas: &mut Canvas, viewpoint: &Viewpoint) {
        // At random: every tenth vertex, say, of a grid would stand in stripes.
        let mut random = SplitMix(0);
        let mut is_drawn = || self.vertices.len() <= DRAWN || random.bits() as usize % self.vertices.len() < DRAWN;
        for vertex in self.vertices.iter().filter(|_| is_drawn()) {
            let from_eye = sub(vertex.position, viewpoint.eye);
            let distance = dot(viewpoint.axes[2], from_eye);
            let Pixel { frame: [t, b, n], .. } = Pixel::of(vertex.attributes, [0.0; 3]);
            for (axis, colour) in [(t, RED), (b, GREEN), (n, BLUE)] {
                let end = add(vertex.position, times(2.0 * LINE * viewpoint.field * distance, axis));
                canvas.line(vertex.position, end, 4, colour);
            }
        }
    }
}

fn corner(mesh: &Mesh, source: usize, n: [f32; 3], [x, y, z, w]: [f32; 4]) -> Corner<9> {
    let [u, v] = mesh.texcoords()[source];
    Corner { position: mesh.positions()[source], attributes: [n[0], n[1], n[2], x, y, z, w, u, v] }
}

/// What a mesh is at a sample.
struct Pixel {
    /// Tangent, bitangent and normal.
    frame: Frame,
    sign: f32,
    uv: [f32; 2],
    /// Towards the eye, of length one.
    eye: [f32; 3],
}

impl Pixel {
    fn of([nx, ny, nz, tx, ty, tz, w, u, v]: [f32; 9], eye: [f32; 3]) -> Self {
        // The sign is the same at the three corners; interpolation may leave it a rounding off.
        let sign = if w < 0.0 { -1.0 } else { 1.0 };
        Self { frame: pixel_frame([nx, ny, nz], [tx, ty, tz], sign), sign, uv: [u, v], eye }
    }

    /// Its colour, and its normal in the mesh's space.
    fn of_maps(&self, material: &Material, look: &Look, method: ParallaxMethod) -> ([f32; 3], [f32; 3]) {
        // Texture space has y along growing v, against the bitangent.
        let eye = green_turned(to_tangent(self.frame, self.eye));
        let [x, y] = if eye[2] > 0.0 { material.offset(method, self.uv, eye) } else { [0.0; 2] };
        let uv = [self.uv[0] + x, self.uv[1] + y];
        let colour = look.colour(material.heights().sample(uv)[0]);
        (colour, normalized(to_object(self.frame, green_turned(material.normal(uv)))))
    }
}
