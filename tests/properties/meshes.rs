//! Any mesh: the same tangents everywhere, each a unit vector with a sign; or no mesh, and why.

use super::inputs::{any_float, finite_float};
use super::{CASES, FEW, agreed, holds, on_the_cpu};
use crate::support::{Subject, every_baker, result_differences};
use proptest::collection::vec;
use proptest::prelude::*;
use texbake::{Baker, Convention, Error, Mesh, MissingNormals, TangentMethod, TangentOptions, Tangents};

/// What a program gives for a mesh: not all of them are one.
#[derive(Debug, Clone)]
struct Parts {
    positions: Vec<[f32; 3]>,
    texcoords: Vec<[f32; 2]>,
    normals: Option<Vec<[f32; 3]>>,
    triangles: Vec<[u32; 3]>,
}

impl Parts {
    fn mesh(&self) -> Result<Mesh, Error> {
        let mesh = Mesh::new(self.positions.clone(), self.texcoords.clone(), self.triangles.clone())?;
        match &self.normals {
            Some(normals) => mesh.with_normals(normals.clone()),
            None => Ok(mesh),
        }
    }

    fn is_one(&self) -> bool {
        let finite = |vectors: &[f32]| vectors.iter().all(|part| part.is_finite());
        let normals = self.normals.as_deref().unwrap_or_default();
        let in_range = |index: &u32| (*index as usize) < self.positions.len();
        finite(self.positions.as_flattened())
            && finite(self.texcoords.as_flattened())
            && finite(normals.as_flattened())
            && self.triangles.as_flattened().iter().all(in_range)
    }
}

/// Meshes of few vertices whose parts often coincide. `float` gives what no grid has; strays are indices of no vertex.
fn parts(float: BoxedStrategy<f32>, strays: bool) -> impl Strategy<Value = Parts> {
    let part = prop_oneof![
        6 => (-2..=2i8).prop_map(f32::from),
        1 => (0..=8u8).prop_map(|eighth| f32::from(eighth) / 8.0),
        1 => float,
    ]
    .boxed();
    let normals = {
        let axis = prop::sample::select(vec![[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.6, 0.0, 0.8], [0.0; 3]]);
        let part = part.clone();
        move |count| {
            let any = [part.clone(), part.clone(), part.clone()];
            prop::option::weighted(0.7, vec(prop_oneof![3 => axis.clone(), 1 => any], count))
        }
    };
    (0..12usize, 0..24usize)
        .prop_flat_map(move |(vertices, triangles)| {
            let beyond = if strays { vec![vertices as u32, u32::MAX] } else { vec![0] };
            let index = prop_oneof![99 => 0..(vertices as u32).max(1), 1 => prop::sample::select(beyond)].boxed();
            let triangles = if vertices == 0 && !strays { 0 } else { triangles };
            let positions = vec([part.clone(), part.clone(), part.clone()], vertices);
            let texcoords = vec([part.clone(), part.clone()], vertices);
            let triangles = vec([index.clone(), index.clone(), index], triangles);
            (positions, texcoords, normals(vertices), triangles)
        })
        .prop_map(|(positions, texcoords, normals, triangles)| Parts { positions, texcoords, normals, triangles })
}

fn options() -> impl Strategy<Value = TangentOptions> {
    let method = prop::sample::select(vec![TangentMethod::Mikktspace, TangentMethod::Lengyel, TangentMethod::Hegde]);
    let normals = prop::sample::select(vec![MissingNormals::Flat, MissingNormals::Smooth]);
    let convention = prop::sample::select(vec![Convention::Gl, Convention::Dx]);
    let weld = prop::option::weighted(0.3, prop_oneof![9 => 0.0..=90.0f32, 1 => any_float()]);
    (method, normals, convention, weld, any::<bool>()).prop_map(
        |(method, missing_normals, convention, weld_seams, unwrap)| TangentOptions {
            method,
            convention,
            missing_normals,
            unwrap,
            weld_seams,
            ..Default::default()
        },
    )
}

fn assert_tangents_of(mesh: &Mesh, made: &Tangents) {
    assert_eq!(made.tangents.len(), mesh.positions().len() + made.copies.len());
    for &[x, y, z, w] in &made.tangents {
        let square: f64 = [x, y, z].iter().map(|&part| f64::from(part).powi(2)).sum();
        assert!((square - 1.0).abs() < 1e-6 && w.abs() == 1.0, "{:?}", [x, y, z, w]);
    }
    let triangles = made.triangles.as_deref().unwrap_or(mesh.triangles());
    assert!(triangles.as_flattened().iter().all(|&vertex| (vertex as usize) < made.tangents.len()));
}

fn tangents_agree(bakers: &[Subject], parts: &Parts, options: &TangentOptions) -> Result<(), Error> {
    let same = |got: &(Mesh, Tangents), expected: &(Mesh, Tangents)| result_differences(&got.0, &got.1, &expected.1);
    let run = |baker: &Baker| {
        let mesh = parts.mesh()?;
        let made = baker.tangents(&mesh, options)?;
        Ok((mesh, made))
    };
    agreed(bakers, run, same).map(|(mesh, made)| assert_tangents_of(&mesh, &made))
}

#[test]
fn tangents_are_the_same_everywhere_or_refused() {
    holds(CASES, (parts(any_float(), true), options()), |(parts, options)| {
        let welds = options.weld_seams.is_none_or(|degrees| (0.0..=90.0).contains(&degrees));
        match tangents_agree(on_the_cpu(), &parts, &options) {
            Ok(()) => assert!(parts.is_one() && welds),
            Err(Error::Parameter { parameter: "weld-seams", .. }) => assert!(!welds),
            Err(Error::Parameter { parameter: "index", .. } | Error::Vertex { .. }) => assert!(!parts.is_one()),
            Err(other) => panic!("{other}"),
        }
    });
}

#[test]
fn gpus_give_the_same_tangents() {
    let options = options().prop_map(|options| TangentOptions { weld_seams: None, ..options });
    holds(4 * FEW, (parts(finite_float(), false), options), |(parts, options)| {
        tangents_agree(every_baker(), &parts, &options).expect("tangents");
    });
}
