//! Tangents corner by corner: the one comparison that every test of tangents uses.

use std::fmt::{Display, Write};
use texbake::{Mesh, Tangents};

/// What a mesh's corner ended up with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// The vertex of the mesh that the corner's vertex is, or is a copy of.
    pub source: u32,
    pub tangent: [f32; 4],
    pub normal: [f32; 3],
}

/// Every corner of a mesh, in order.
pub fn corners(mesh: &Mesh, made: &Tangents) -> Vec<Corner> {
    let triangles = made.triangles.as_deref().unwrap_or(mesh.triangles());
    let sources: Vec<u32> = made.sources().collect();
    let corner = |&vertex: &u32| {
        let source = sources[vertex as usize];
        let normal = match (&made.normals, mesh.normals()) {
            (Some(normals), _) => normals[vertex as usize],
            (None, given) => given.expect("normals were given or made")[source as usize],
        };
        Corner { source, tangent: made.tangents[vertex as usize], normal }
    };
    triangles.as_flattened().iter().map(corner).collect()
}

/// The tangents of corners.
pub fn corner_tangents(mesh: &Mesh, made: &Tangents) -> Vec<[f32; 4]> {
    corners(mesh, made).iter().map(|corner| corner.tangent).collect()
}

const SHOWN: usize = 8;

/// The first corners whose tangents' bits differ, in words; nothing compared is a difference too.
pub fn tangent_differences(got: &[[f32; 4]], expected: &[[f32; 4]]) -> Result<(), String> {
    if got.len() != expected.len() || expected.is_empty() || !expected.len().is_multiple_of(3) {
        return Err(format!("{} corners were compared with {}", got.len(), expected.len()));
    }
    let bits = |tangent: [f32; 4]| tangent.map(f32::to_bits);
    let differ: Vec<usize> = (0..got.len()).filter(|&corner| bits(got[corner]) != bits(expected[corner])).collect();
    if differ.is_empty() {
        return Ok(());
    }
    let mut report = format!("{} of {} corners differ", differ.len(), got.len());
    for &corner in differ.iter().take(SHOWN) {
        let (triangle, at) = (corner / 3, corner % 3);
        let [got, expected] = [got[corner], expected[corner]];
        write!(report, "\n  triangle {triangle}, corner {at}: got {got:?} ({:x?}), ", bits(got))
            .and_then(|()| write!(report, "expected {expected:?} ({:x?})", bits(expected)))
            .expect("a string takes text");
    }
    Err(report)
}

/// Fails the test with the first corners whose tangents differ.
pub fn assert_same_tangents(what: impl Display, got: &[[f32; 4]], expected: &[[f32; 4]]) {
    if let Err(report) = tangent_differences(got, expected) {
        panic!("{what}: {report}");
    }
}

/// Everything of two results is the same, bit by bit: tangents, normals, copies, triangles and report.
pub fn result_differences(mesh: &Mesh, got: &Tangents, expected: &Tangents) -> Result<(), String> {
    let words =
        |vectors: &[[f32; 3]]| -> Vec<u32> { vectors.as_flattened().iter().map(|part| part.to_bits()).collect() };
    let normals = |made: &Tangents| made.normals.as_deref().map(words);
    if got.copies != expected.copies {
        return Err(format!("copies: got {:?}, expected {:?}", got.copies, expected.copies));
    }
    if got.triangles != expected.triangles {
        return Err("other triangles".to_owned());
    }
    if normals(got) != normals(expected) {
        return Err("other normals".to_owned());
    }
    if got.report != expected.report {
        return Err(format!("report: got {:?}, expected {:?}", got.report, expected.report));
    }
    if !mesh.triangles().is_empty() {
        tangent_differences(&corner_tangents(mesh, got), &corner_tangents(mesh, expected))?;
    }
    let bits =
        |made: &Tangents| -> Vec<u32> { made.tangents.as_flattened().iter().map(|part| part.to_bits()).collect() };
    if bits(got) != bits(expected) {
        return Err("other tangents of vertices without triangles".to_owned());
    }
    Ok(())
}

/// The angle between two vectors of any length, in radians.
pub fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let length = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    length(cross).atan2(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
}

/// The direction of a tangent.
pub fn direction(tangent: [f32; 4]) -> [f64; 3] {
    [tangent[0], tangent[1], tangent[2]].map(f64::from)
}
