//! Pixels of a mesh in perspective, with what a fragment shader knows of each.

use super::real::{cross, dot, normalized, sum};
use crate::mesh::Mesh;
use crate::ops::tangents::Tangents;
use crate::split_mix::SplitMix;

/// What a fragment shader knows of a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pixel {
    /// The triangle.
    pub triangle: usize,
    /// How much of each of its corners.
    pub shares: [f64; 3],
    /// Interpolated, not normalised.
    pub normal: [f32; 3],
    /// MikkTSpace's, interpolated, not normalised, with its sign.
    pub tangent: ([f32; 3], f32),
    /// The same with the sign in the lowest bit.
    pub packed_tangent: ([f32; 3], f32),
    /// Differences of the position to the pixels on the right and below, on the triangle's plane.
    pub dp: [[f32; 3]; 2],
    /// Differences of the texture coordinates.
    pub duv: [[f32; 2]; 2],
    pub texcoord: [f32; 2],
}

/// A field of view of 60 degrees over 1080 rows.
const PIXEL: f64 = 2.0 * 0.577_350_269_189_625_8 / 1080.0;

/// `count` pixels at most, spread at random over the triangles of a mesh that its eye sees the front of; the eye stands
/// two and a half radii away, 26 degrees above the mesh's x-y plane. What hides what is not looked at.
pub(super) fn pixels(mesh: &Mesh, tangents: &Tangents, count: usize, seed: u64) -> Vec<Pixel> {
    let mut random = SplitMix(seed);
    let triangles = tangents.triangles.as_deref().unwrap_or(mesh.triangles());
    if triangles.is_empty() {
        return Vec::new();
    }
    let eye = eye(mesh);
    let seen = Seen { mesh, tangents, packed: tangents.with_sign_in_lowest_bit() };
    let tries = 20 * count;
    let pixel = |_| {
        let triangle = ((random.unit() * triangles.len() as f64) as usize).min(triangles.len() - 1);
        let (root, share) = (random.unit().sqrt(), random.unit());
        let shares = [1.0 - root, root * (1.0 - share), root * share];
        seen.pixel(triangle, triangles[triangle], shares, eye)
    };
    (0..tries).filter_map(pixel).take(count).collect()
}

/// Where a mesh is seen from.
fn eye(mesh: &Mesh) -> [f64; 3] {
    let positions = mesh.positions();
    let least = |axis: usize| positions.iter().map(|p| f64::from(p[axis])).fold(f64::INFINITY, f64::min);
    let most = |axis: usize| positions.iter().map(|p| f64::from(p[axis])).fold(f64::NEG_INFINITY, f64::max);
    let (low, high) = ([0, 1, 2].map(least), [0, 1, 2].map(most));
    let centre = sum([(0.5, low), (0.5, high)]);
    let across = sum([(1.0, high), (-1.0, low)]);
    let radius = dot(across, across).sqrt() / 2.0;
    sum([(1.0, centre), (2.5 * radius, normalized([0.3, -0.85, 0.45]))])
}

/// A mesh with its tangents.
struct Seen<'a> {
    mesh: &'a Mesh,
    tangents: &'a Tangents,
    packed: Vec<[f32; 3]>,
}

impl Seen<'_> {
    /// A point of a triangle, if it is seen.
    fn pixel(&self, triangle: usize, corners: [u32; 3], shares: [f64; 3], eye: [f64; 3]) -> Option<Pixel> {
        let vertices = corners.map(|corner| corner as usize);
        let own = vertices.map(|vertex| self.own(vertex));
        let positions = own.map(|vertex| self.mesh.positions()[vertex].map(f64::from));
        let texcoords = own.map(|vertex| self.mesh.texcoords()[vertex].map(f64::from));
        let mix = |of: [[f64; 3]; 3]| sum([(shares[0], of[0]), (shares[1], of[1]), (shares[2], of[2])]);
        let edges = [1, 2].map(|corner| sum([(1.0, positions[corner]), (-1.0, positions[0])]));
        let face = cross(edges[0], edges[1]);
        let (point, area) = (mix(positions), dot(face, face));
        let view = sum([(1.0, eye), (-1.0, point)]);
        // Edge-on, the next pixel is on another triangle.
        if dot(face, view) <= 0.05 * (area * dot(view, view)).sqrt() {
            return None;
        }
        let dp = neighbours(view, face);
        let across = [cross(edges[1], face), cross(face, edges[0])].map(|axis| axis.map(|part| part / area));
        let grown = |axis: usize| {
            let by = |corner: usize| texcoords[corner][axis] - texcoords[0][axis];
            let gradient = sum([(by(1), across[0]), (by(2), across[1])]);
            dp.map(|dp| dot(gradient, dp))
        };
        let (du, dv) = (grown(0), grown(1));
        let has_area = du[0] * dv[1] - du[1] * dv[0] != 0.0;
        let floats = |of: [[f32; 3]; 3]| mix(of.map(|v| v.map(f64::from))).map(|part| part as f32);
        let normals = self.tangents.normals.as_deref().or(self.mesh.normals())?;
        let sign = self.tangents.tangents[vertices[0]][3];
        let texcoord = [0, 1].map(|axis| (0..3).map(|i| shares[i] * texcoords[i][axis]).sum::<f64>() as f32);
        let normal_of = |vertex: usize| normals.get(vertex).copied().unwrap_or(normals[self.own(vertex)]);
        has_area.then(|| Pixel {
            triangle,
            shares,
            normal: floats(vertices.map(normal_of)),
            tangent: (floats(vertices.map(|vertex| self.xyz(vertex))), sign),
            packed_tangent: (floats(vertices.map(|vertex| self.packed[vertex])), sign),
            dp: dp.map(|dp| dp.map(|part| part as f32)),
            duv: [0, 1].map(|i| [du[i] as f32, dv[i] as f32]),
            texcoord,
        })
    }

    /// The mesh's vertex that a vertex with tangents is, or is a copy of.
    fn own(&self, vertex: usize) -> usize {
        let vertices = self.mesh.positions().len();
        if vertex < vertices { vertex } else { self.tangents.copies[vertex - vertices] as usize }
    }

    fn xyz(&self, vertex: usize) -> [f32; 3] {
        let [x, y, z, _] = self.tangents.tangents[vertex];
        [x, y, z]
    }
}

/// From a point to where the rays of the pixels on its right and below meet its plane. `view` points to the eye.
fn neighbours(view: [f64; 3], face: [f64; 3]) -> [[f64; 3]; 2] {
    let ray = view.map(|part| -part);
    let right = normalized(cross(ray, [0.0, 0.0, 1.0]));
    let down = normalized(cross(ray, right));
    let step = PIXEL * dot(view, view).sqrt();
    [right, down].map(|axis| {
        let next = sum([(1.0, ray), (step, axis)]);
        let reach = dot(ray, face) / dot(next, face);
        sum([(reach, next), (-1.0, ray)])
    })
}
