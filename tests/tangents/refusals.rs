//! What is no mesh, and options out of range: written messages.

use super::by;
use crate::support::plane;
use texbake::{Baker, CornerAdjacency, Error, Mesh, TangentMethod, TangentOptions};

const POSITIONS: [[f32; 3]; 3] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
const TEXCOORDS: [[f32; 2]; 3] = [[0.0; 2], [1.0, 0.0], [0.0, 1.0]];

fn message(result: Result<Mesh, Error>) -> String {
    result.expect_err("no mesh").to_string()
}

#[test]
fn indices_out_of_range_are_named() {
    for (triangles, text) in [
        (vec![[0, 1, 2], [2, 3, 1]], "index is 3 (triangle 1: [2, 3, 1]): it must be below 3, the number of vertices"),
        (
            vec![[0, 1, u32::MAX]],
            "index is 4294967295 (triangle 0: [0, 1, 4294967295]): it must be below 3, the number of vertices",
        ),
    ] {
        assert_eq!(message(Mesh::new(POSITIONS.into(), TEXCOORDS.into(), triangles)), text);
    }
    let text = "index is 0 (triangle 0: [0, 0, 0]): it must be below 0, the number of vertices";
    assert_eq!(message(Mesh::new(vec![], vec![], vec![[0; 3]])), text);
}

#[test]
fn numbers_that_are_not_finite_are_named_with_their_vertex() {
    for (bad, shown) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        let mut positions = POSITIONS;
        positions[2][1] = bad;
        let error = Mesh::new(positions.into(), TEXCOORDS.into(), vec![]).expect_err("no mesh");
        assert!(matches!(error, Error::Vertex { attribute: "position", vertex: 2, .. }), "{error:?}");
        let told = |attribute: &str, vertex: usize, value: String| {
            format!(
                "the {attribute} of vertex {vertex} is {value}: it must be finite numbers; repair the mesh where it was made"
            )
        };
        assert_eq!(error.to_string(), told("position", 2, format!("[0.0, {shown}, 0.0]")));

        let mut texcoords = TEXCOORDS;
        texcoords[1][0] = bad;
        let error = message(Mesh::new(POSITIONS.into(), texcoords.into(), vec![[0, 1, 2]]));
        assert_eq!(error, told("texture coordinate", 1, format!("[{shown}, 0.0]")));

        let mut normals = vec![[0.0, 0.0, 1.0]; 3];
        normals[0][2] = bad;
        let mesh = Mesh::new(POSITIONS.into(), TEXCOORDS.into(), vec![[0, 1, 2]]).expect("a mesh");
        assert_eq!(message(mesh.with_normals(normals)), told("normal", 0, format!("[0.0, 0.0, {shown}]")));
    }
}

#[test]
fn attributes_are_as_many_as_positions() {
    let text = "number of texture coordinates is 2: it must be 3, one for each position";
    assert_eq!(message(Mesh::new(POSITIONS.into(), TEXCOORDS[..2].into(), vec![])), text);
    let mesh = Mesh::new(POSITIONS.into(), TEXCOORDS.into(), vec![]).expect("a mesh");
    let text = "number of normals is 4: it must be 3, one for each position";
    assert_eq!(message(mesh.with_normals(vec![[0.0, 0.0, 1.0]; 4])), text);
}

#[test]
fn options_out_of_range_are_refused() {
    let mesh = plane(1, 1);
    for (degrees, text) in [
        (-0.5, "weld-seams is -0.5: it must be from 0 to 90 degrees"),
        (90.5, "weld-seams is 90.5: it must be from 0 to 90 degrees"),
        (f32::NAN, "weld-seams is NaN: it must be from 0 to 90 degrees"),
    ] {
        let options = TangentOptions { weld_seams: Some(degrees), ..Default::default() };
        assert_eq!(Baker::cpu().tangents(&mesh, &options).expect_err("out of range").to_string(), text);
    }
}

#[test]
fn an_adjacency_of_another_mesh_is_refused() {
    let (mesh, other) = (plane(2, 2), CornerAdjacency::of(&plane(3, 2)));
    let error = Baker::cpu().tangents_with(&mesh, Some(&other), &by(TangentMethod::Lengyel));
    assert_eq!(
        error.expect_err("another mesh").to_string(),
        "adjacency is of 12 vertices and 36 corners: it must be of 9 vertices and 24 corners"
    );
    // The mesh's own changes nothing.
    let own = CornerAdjacency::of(&mesh);
    for method in super::METHODS {
        let (_, with) = Baker::cpu().tangents_with(&mesh, Some(&own), &by(method)).expect("tangents");
        assert_eq!(with, Baker::cpu().tangents(&mesh, &by(method)).expect("tangents"));
    }
}
