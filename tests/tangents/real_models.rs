//! Real models: seams, slivers, duplicates and mirrored halves as artists leave them, and a scan.
//!
//! They are controllers from npm and the Stanford bunny, which `tests/run.sh` fetches; TEXBAKE_MODELS names their
//! folder. Without them these tests print so and pass; with TEXBAKE_REQUIRE_MODELS=1 they fail.

use super::against_f64::compare_with;
use super::mikktspace::assert_bevys_corners;
use super::{METHODS, SUMS, as_to_v, tangents_of};
use crate::support::{bakers, corners, fetched};
use std::f32::consts::{PI, TAU};
use texbake::io::{Model, ModelReadOptions};
use texbake::{Mesh, MissingNormals, TangentMethod, TangentOptions};

/// GPUs in software see meshes of at most so many triangles.
const FEW: usize = 3500;

/// All different meshes with texture coordinates; the bunny twice, with flat coordinates and with spherical ones.
fn meshes() -> Option<Vec<(String, Mesh)>> {
    let folder = fetched("MODELS")?;
    let mut paths: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "glb" || extension == "obj"));
    paths.sort();
    let mut meshes: Vec<(String, Mesh)> = Vec::new();
    for path in paths {
        let model = Model::read_with(&path, &ModelReadOptions { all: true, ..Default::default() }).unwrap();
        let file = path.file_stem().unwrap().to_string_lossy();
        for (number, primitive) in model.primitives().iter().enumerate() {
            let mesh = model.mesh(number).unwrap();
            if meshes.iter().all(|(_, other)| *other != mesh) {
                meshes.push((format!("{file}, {}", primitive.name), mesh));
            }
        }
    }
    let (name, bunny) = meshes.iter().find(|(name, _)| name.starts_with("bunny")).expect("the bunny");
    let spherical = (format!("{name}, spherical"), spherical(bunny));
    meshes.push(spherical);
    let triangles: usize = meshes.iter().map(|(_, mesh)| mesh.triangles().len()).sum();
    println!("{} different meshes, {triangles} triangles", meshes.len());
    assert!(meshes.len() >= 100 && triangles > 100_000, "{} meshes, {triangles} triangles", meshes.len());
    Some(meshes)
}

/// Longitude and latitude around the middle as texture coordinates, which jump where the longitude does.
fn spherical(mesh: &Mesh) -> Mesh {
    let sum = |axis: usize| mesh.positions().iter().map(|position| position[axis]).sum::<f32>();
    let middle = [0, 1, 2].map(|axis| sum(axis) / mesh.positions().len() as f32);
    let texcoord = |p: &[f32; 3]| {
        let [x, y, z] = [0, 1, 2].map(|axis| p[axis] - middle[axis]);
        [0.5 + x.atan2(z) / TAU, 0.5 - y.atan2(x.hypot(z)) / PI]
    };
    let texcoords = mesh.positions().iter().map(texcoord).collect();
    Mesh::new(mesh.positions().to_vec(), texcoords, mesh.triangles().to_vec()).unwrap()
}

/// Default options, and smooth normals where there are none.
fn options(mesh: &Mesh, method: TangentMethod) -> Vec<TangentOptions> {
    let smooth = TangentOptions { missing_normals: MissingNormals::Smooth, ..as_to_v(method) };
    let is_missing = mesh.normals().is_none();
    [as_to_v(method)].into_iter().chain(is_missing.then_some(smooth)).collect()
}

#[test]
fn mikktspace_has_the_references_bytes() {
    let Some(meshes) = meshes() else { return };
    let (mut directed, mut all) = (0, 0);
    for (name, mesh) in &meshes {
        for options in options(mesh, TangentMethod::Mikktspace) {
            let made = tangents_of(bakers(mesh.triangles().len() <= FEW), mesh, &options);
            directed += assert_bevys_corners(name, mesh, &corners(mesh, &made));
            all += 3 * mesh.triangles().len();
        }
    }
    println!("{directed} of {all} corners have a direction");
    assert!(directed * 100 > all * 99, "{directed} of {all}");
}

#[test]
fn sums_are_within_the_rounding_of_f32() {
    let Some(meshes) = meshes() else { return };
    for method in SUMS {
        let (mut directed, mut handed, mut all) = (0, 0, 0);
        for (name, mesh) in &meshes {
            for options in options(mesh, method) {
                let made = tangents_of(bakers(mesh.triangles().len() <= FEW), mesh, &options);
                let [d, _, h] = compare_with(name, mesh, &options, &made);
                (directed, handed, all) = (directed + d, handed + h, all + 3 * mesh.triangles().len());
            }
        }
        println!("{method}: {directed} of {all} corners are proven, {handed} with their handedness");
        assert!(handed * 100 > all * 99, "{method}: {directed} and {handed} of {all}");
    }
}

/// Those that the tests above keep from the GPUs.
#[test]
fn devices_agree_on_the_largest() {
    let Some(mut meshes) = meshes() else { return };
    meshes.sort_by_key(|(_, mesh)| std::cmp::Reverse(mesh.triangles().len()));
    for (name, mesh) in &meshes[..4] {
        assert!(mesh.triangles().len() > FEW, "{name}");
        for method in METHODS {
            tangents_of(bakers(true), mesh, &as_to_v(method));
        }
    }
}
