//! Tangents of meshes. The triangle of most rows has corners at (0, 0), (1, 0) and (0, 1), u to the right and v down:
//! its tangent is (1, 0, 0), its sign 1.

use super::{assert_refused, same};
use crate::support::{Subject, assert_each, changed, every_baker, flat_mesh, mesh, without_normals};
use texbake::{Mesh, Result, TangentMethod, TangentOptions, TangentReport};

const MIKKTSPACE: TangentMethod = TangentMethod::Mikktspace;
const LENGYEL: TangentMethod = TangentMethod::Lengyel;
const HEGDE: TangentMethod = TangentMethod::Hegde;
const METHODS: [TangentMethod; 3] = [MIKKTSPACE, LENGYEL, HEGDE];

const RIGHT: [f32; 4] = [1.0, 0.0, 0.0, 1.0];

/// A corner: a position in the plane z = 0, and a texture coordinate.
type Point = ([f32; 2], [f32; 2]);

const CORNERS: [Point; 3] = [([0.0, 0.0], [0.0, 1.0]), ([1.0, 0.0], [1.0, 1.0]), ([0.0, 1.0], [0.0, 0.0])];

fn triangle(corners: [Point; 3]) -> Mesh {
    flat_mesh(&corners, vec![[0, 1, 2]])
}

/// Every baker gives a mesh these tangents, those of its own vertices first, and finds this in it.
pub fn assert_tangents(mesh: &Mesh, method: TangentMethod, tangents: &[[f32; 4]], found: TangentReport) {
    assert_tangents_with(mesh, &TangentOptions { method, ..Default::default() }, tangents, found);
}

fn assert_tangents_with(mesh: &Mesh, options: &TangentOptions, tangents: &[[f32; 4]], found: TangentReport) {
    let report = TangentReport { triangles: mesh.triangles().len(), vertices: mesh.positions().len(), ..found };
    let bits = |tangents: &[[f32; 4]]| -> Vec<[u32; 4]> { tangents.iter().map(|t| t.map(f32::to_bits)).collect() };
    assert_each(every_baker().iter(), |Subject { name, baker }| {
        let what = format!("{name}, {}", options.method);
        let made = baker.tangents(mesh, options).map_err(|error| format!("{what}: {error}"))?;
        same(&what, &made.tangents.as_slice(), &tangents)?;
        same(&what, &bits(&made.tangents), &bits(tangents))?;
        same(&what, &made.report, &report)
    });
}

fn nothing() -> TangentReport {
    TangentReport::default()
}

/// Where no direction is left, the axis furthest from n, here x.
#[test]
fn triangle_without_area_in_space() {
    let up = [0.0, 1.0, 0.0, 1.0];
    let along_y = triangle([CORNERS[0], ([0.0, 1.0], [1.0, 1.0]), ([0.0, 2.0], [0.0, 0.0])]);
    let found = TangentReport { without_area: 1, jumps: 1, ..nothing() };
    // e1 is along y, so t is.
    assert_tangents(&along_y, LENGYEL, &[up; 3], found);
    // No face, no direction.
    assert_tangents(&along_y, HEGDE, &[RIGHT; 3], TangentReport { undirected: 3, ..found });
    // The angles are 0, pi and 0: only the second corner's weight is not zero.
    assert_tangents(&along_y, MIKKTSPACE, &[RIGHT, up, RIGHT], TangentReport { undirected: 2, ..found });
    let point = triangle([CORNERS[0], ([0.0, 0.0], [1.0, 1.0]), ([0.0, 0.0], [0.0, 0.0])]);
    for method in METHODS {
        assert_tangents(&point, method, &[RIGHT; 3], TangentReport { undirected: 3, ..found });
    }
}

/// det = 0.
#[test]
fn triangle_without_area_in_the_texture() {
    let along_u = [[0.0, 0.0], [0.25, 0.0], [0.125, 0.0]];
    let across = [[0.0, 0.0], [0.25, 0.25], [0.375, 0.375]];
    let point = [[0.5, 0.5]; 3];
    for texcoords in [along_u, across, point] {
        let mesh = triangle([0, 1, 2].map(|i| (CORNERS[i].0, texcoords[i])));
        for method in METHODS {
            let found = TangentReport { without_texture_area: 1, undirected: 3, ..nothing() };
            assert_tangents(&mesh, method, &[RIGHT; 3], found);
        }
    }
}

#[test]
fn texture_differences_below_2_to_the_minus_40() {
    for (exponent, counts) in [(-40, true), (-41, false)] {
        // The greatest coordinate is 1; those of the triangle begin at 0.
        let little = 2f32.powi(exponent);
        let corners = [([0.0, 0.0], [0.0, little]), ([1.0, 0.0], [little, little]), ([0.0, 1.0], [0.0, 0.0])];
        let far = ([5.0, 5.0], [1.0, 1.0]);
        let mesh = flat_mesh(&[corners[0], corners[1], corners[2], far], vec![[0, 1, 2]]);
        for method in METHODS {
            let undirected = if counts || method == MIKKTSPACE { 0 } else { 3 };
            let without_texture_area = usize::from(!counts);
            let found = TangentReport { unused: 1, undirected, without_texture_area, ..nothing() };
            assert_tangents(&mesh, method, &[RIGHT; 4], found);
        }
    }
}

#[test]
fn mirrored_triangle() {
    let mesh = triangle(CORNERS.map(|(position, [u, v])| (position, [1.0 - u, v])));
    for method in METHODS {
        assert_tangents(&mesh, method, &[[-1.0, 0.0, 0.0, -1.0]; 3], TangentReport { jumps: 1, ..nothing() });
    }
}

#[test]
fn mapping_upside_down() {
    let mesh = triangle(CORNERS.map(|(position, [u, v])| (position, [u, 1.0 - v])));
    for method in METHODS {
        assert_tangents(&mesh, method, &[[1.0, 0.0, 0.0, -1.0]; 3], TangentReport { jumps: 1, ..nothing() });
    }
}

/// Two triangles at one vertex, the second turned by half a turn, its texture not: t and -t.
#[test]
fn tangents_that_cancel() {
    let turned = CORNERS.map(|([x, y], texcoord)| ([-x, -y], texcoord));
    let points = [CORNERS[0], CORNERS[1], CORNERS[2], turned[1], turned[2]];
    let mesh = flat_mesh(&points, vec![[0, 1, 2], [0, 3, 4]]);
    let left = [-1.0, 0.0, 0.0, 1.0];
    for method in [LENGYEL, HEGDE] {
        let found = TangentReport { undirected: 1, jumps: 2, ..nothing() };
        assert_tangents(&mesh, method, &[RIGHT, RIGHT, RIGHT, left, left], found);
    }
    // They share no edge: each keeps its own, at a copy of the vertex.
    let found = TangentReport { copies: 1, jumps: 2, ..nothing() };
    assert_tangents(&mesh, MIKKTSPACE, &[RIGHT, RIGHT, RIGHT, left, left, left], found);
}

/// Triangles of both handednesses at one vertex: its copy is the second's.
#[test]
fn vertex_between_mirrored_halves() {
    let points = [CORNERS[0], CORNERS[1], CORNERS[2], ([-1.0, 0.0], [1.0, 1.0])];
    let mesh = flat_mesh(&points, vec![[0, 1, 2], [0, 2, 3]]);
    let left = [-1.0, 0.0, 0.0, -1.0];
    for method in [LENGYEL, MIKKTSPACE] {
        let found = TangentReport { mirrored: 2, copies: 2, jumps: 2, ..nothing() };
        assert_tangents(&mesh, method, &[RIGHT, RIGHT, RIGHT, left, left, left], found);
    }
}

/// A normal along t leaves nothing of it: any axis at a right angle will do.
#[test]
fn normal_along_the_tangent() {
    let mesh = changed(&triangle(CORNERS), |p| p, |_| [1.0, 0.0, 0.0], |uv| uv);
    for method in METHODS {
        let found = TangentReport { undirected: 3, jumps: 1, ..nothing() };
        assert_tangents(&mesh, method, &[[0.0, 1.0, 0.0, 1.0]; 3], found);
    }
}

#[test]
fn coordinates_of_1e20() {
    assert_of_any_size(1e20);
}

#[test]
fn coordinates_of_1e_minus_20() {
    assert_of_any_size(1e-20);
}

#[test]
fn coordinates_of_f32_max() {
    assert_of_any_size(f32::MAX);
}

#[test]
fn subnormal_coordinates() {
    assert_of_any_size(1e-40);
    let least = f32::from_bits(1);
    let mesh = changed(&triangle(CORNERS), |p| p.map(|x| x * least), |n| n, |uv| uv);
    for method in METHODS {
        assert_tangents(&mesh, method, &[RIGHT; 3], TangentReport { jumps: 1, ..nothing() });
    }
    // Below 2^-146 in the texture, where the greatest power of two leaves less than 2^-20.
    let mesh = changed(&triangle(CORNERS), |p| p, |n| n, |uv| uv.map(|u| u * least));
    for method in METHODS {
        let undirected = if method == MIKKTSPACE { 0 } else { 3 };
        let found = TangentReport { without_texture_area: 1, undirected, ..nothing() };
        assert_tangents(&mesh, method, &[RIGHT; 3], found);
    }
}

/// Positions, texture coordinates and both at `size`: the tangents of the triangle at 1.
fn assert_of_any_size(size: f32) {
    let jumps = |texture: f32| usize::from(texture > 0.5 && texture <= 1.0);
    for (space, texture) in [(size, 1.0), (1.0, size), (size, size)] {
        let mesh = changed(&triangle(CORNERS), |p| p.map(|x| x * space), |n| n, |uv| uv.map(|u| u * texture));
        for method in METHODS {
            assert_tangents(&mesh, method, &[RIGHT; 3], TangentReport { jumps: jumps(texture), ..nothing() });
        }
    }
}

#[test]
fn index_out_of_range() {
    for (wrong, named) in [(3, "3"), (u32::MAX, "4294967295")] {
        let [positions, texcoords] = [vec![[0.0; 3]; 3], vec![[1.0; 3]; 3]];
        let texcoords: Vec<[f32; 2]> = texcoords.iter().map(|&[u, v, _]: &[f32; 3]| [u, v]).collect();
        assert_mesh_refused(
            || Mesh::new(positions.clone(), texcoords.clone(), vec![[0, 1, 2], [2, wrong, 1]]),
            &format!("index is {named} (triangle 1: [2, {named}, 1]): it must be below 3, the number of vertices"),
        );
    }
}

/// No baker is given what is no mesh.
fn assert_mesh_refused(mesh: impl Fn() -> Result<Mesh>, message: &str) {
    assert_refused(|baker| baker.tangents(&mesh()?, &TangentOptions::default()), message);
}

#[test]
fn coordinate_that_is_nan_or_infinite() {
    for (value, shown) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        let told = |attribute: &str, value: String| {
            format!(
                "the {attribute} of vertex 2 is {value}: it must be finite numbers; repair the mesh where it was made"
            )
        };
        let vectors = vec![[0.0; 3], [1.0; 3], [0.0, value, 0.0]];
        let pairs = vec![[0.0; 2], [1.0; 2], [value, 0.0]];
        let (ones, uvs) = (vec![[1.0; 3]; 3], vec![[1.0; 2]; 3]);
        let new = |positions: &Vec<[f32; 3]>, texcoords: &Vec<[f32; 2]>| {
            Mesh::new(positions.clone(), texcoords.clone(), vec![[0, 1, 2]])
        };
        assert_mesh_refused(|| new(&vectors, &uvs), &told("position", format!("[0.0, {shown}, 0.0]")));
        assert_mesh_refused(|| new(&ones, &pairs), &told("texture coordinate", format!("[{shown}, 0.0]")));
        let with_normals = || new(&ones, &uvs)?.with_normals(vectors.clone());
        assert_mesh_refused(with_normals, &told("normal", format!("[0.0, {shown}, 0.0]")));
    }
}

/// (0, 0, 0) becomes the normal of the triangles at that position; where they have no area, (0, 0, 1).
#[test]
fn normal_of_zero() {
    for zero in [[0.0; 3], [0.0, -0.0, 0.0]] {
        let mesh = changed(&triangle(CORNERS), |p| p, |_| zero, |uv| uv);
        for method in METHODS {
            let found = TangentReport { normals_made: 3, jumps: 1, ..nothing() };
            assert_tangents(&mesh, method, &[RIGHT; 3], found);
        }
        let point = changed(&mesh, |_| [1.0; 3], |n| n, |uv| uv);
        for method in METHODS {
            let found = TangentReport { normals_made: 3, without_area: 1, undirected: 3, jumps: 1, ..nothing() };
            assert_tangents(&point, method, &[RIGHT; 3], found);
        }
    }
}

#[test]
fn mesh_normals_of_any_length() {
    for length in [f32::MAX, 1e-30, f32::from_bits(1), 1.02] {
        let mesh = changed(&triangle(CORNERS), |p| p, |_| [0.0, 0.0, length], |uv| uv);
        for method in METHODS {
            let found = TangentReport { normals_normalised: 3, jumps: 1, ..nothing() };
            assert_tangents(&mesh, method, &[RIGHT; 3], found);
        }
    }
}

/// By 1 % at most: they count as unit vectors.
#[test]
fn mesh_normals_slightly_off_unit() {
    for length in [0.9905, 1.0095] {
        let mesh = changed(&triangle(CORNERS), |p| p, |_| [0.0, 0.0, length], |uv| uv);
        for method in METHODS {
            assert_tangents(&mesh, method, &[RIGHT; 3], TangentReport { jumps: 1, ..nothing() });
        }
    }
}

/// u runs from 0.75 to 1, which is stored as 0: at its word it falls.
#[test]
fn u_that_jumps() {
    let mesh = triangle([([0.0, 0.0], [0.75, 0.5]), ([1.0, 0.0], [0.0, 0.5]), ([0.0, 1.0], [0.75, 0.0])]);
    for method in METHODS {
        let found = TangentReport { jumps: 1, ..nothing() };
        assert_tangents(&mesh, method, &[[-1.0, 0.0, 0.0, -1.0]; 3], found);
        let unwrap = TangentOptions { method, unwrap: true, ..Default::default() };
        assert_tangents_with(&mesh, &unwrap, &[RIGHT; 3], found);
    }
}

#[test]
fn no_normals() {
    let mesh = without_normals(&triangle(CORNERS));
    for method in METHODS {
        assert_tangents(&mesh, method, &[RIGHT; 3], TangentReport { normals_made: 3, jumps: 1, ..nothing() });
    }
}

/// The axis that is furthest from n, projected: x for z, y for x.
#[test]
fn vertices_without_triangles() {
    let normals = vec![[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    let mesh = mesh(vec![[1.0; 3]; 3], normals, vec![[0.5; 2]; 3], vec![]);
    for method in METHODS {
        let tangents = [RIGHT, [0.0, 1.0, 0.0, 1.0], RIGHT];
        assert_tangents(&mesh, method, &tangents, TangentReport { unused: 3, ..nothing() });
    }
}

#[test]
fn no_vertices() {
    for method in METHODS {
        assert_tangents(&flat_mesh(&[], vec![]), method, &[], nothing());
    }
}

#[test]
fn weld_angle_beyond_a_right_angle() {
    for (degrees, shown) in [(-0.5, "-0.5"), (90.5, "90.5"), (f32::NAN, "NaN"), (f32::INFINITY, "inf")] {
        let options = TangentOptions { weld_seams: Some(degrees), ..Default::default() };
        let message = format!("weld-seams is {shown}: it must be from 0 to 90 degrees");
        assert_refused(|baker| baker.tangents(&triangle(CORNERS), &options), &message);
    }
}
