//! Tangents for meshes.

mod against_f64;
mod closed_forms;
mod fast;
mod laws;
mod mikktspace;
mod output;
mod problems;
mod real_models;
mod refusals;
mod seams;

use crate::support::{Subject, corner_tangents, every_baker, result_differences};
use std::sync::OnceLock;
use texbake::{Baker, Convention, Mesh, TangentMethod, TangentOptions, TangentReport, Tangents};

pub const METHODS: [TangentMethod; 3] = [TangentMethod::Mikktspace, TangentMethod::Lengyel, TangentMethod::Hegde];
/// The methods that sum over a vertex, and leave one tangent for each handedness.
pub const SUMS: [TangentMethod; 2] = [TangentMethod::Lengyel, TangentMethod::Hegde];

/// A method, all else default.
fn by(method: TangentMethod) -> TangentOptions {
    TangentOptions { method, ..Default::default() }
}

/// w as to growing v: the sign of det(t, b, n).
fn as_to_v(method: TangentMethod) -> TangentOptions {
    TangentOptions { method, convention: Convention::Dx, ..Default::default() }
}

/// The CPU's bakers that have threads of their own.
fn of_few_threads() -> &'static [Subject] {
    static BAKERS: OnceLock<Vec<Subject>> = OnceLock::new();
    BAKERS.get_or_init(|| {
        [("1 thread", 1), ("2 threads", 2), ("7 threads", 7)]
            .map(|(name, threads)| Subject { name, baker: Baker::cpu_threads(threads).expect("threads") })
            .into()
    })
}

/// The tangents of a mesh, the same from every baker.
fn tangents(mesh: &Mesh, options: &TangentOptions) -> Tangents {
    tangents_of(every_baker().iter().chain(of_few_threads()), mesh, options)
}

/// The tangents of a mesh, the same from the reference and from these bakers.
fn tangents_of<'a>(bakers: impl Iterator<Item = &'a Subject>, mesh: &Mesh, options: &TangentOptions) -> Tangents {
    let expected = Baker::reference().tangents(mesh, options).unwrap_or_else(|error| panic!("{options:?}: {error}"));
    for Subject { name, baker } in bakers {
        let got = baker.tangents(mesh, options).unwrap_or_else(|error| panic!("{name}, {options:?}: {error}"));
        result_differences(mesh, &got, &expected).unwrap_or_else(|report| panic!("{name}, {options:?}: {report}"));
    }
    expected
}

/// The report of a mesh in which nothing is to be told but its size, and how many triangles span more than half the
/// texture along u, and no more than all.
fn nothing_found(mesh: &Mesh) -> TangentReport {
    let (triangles, vertices) = (mesh.triangles().len(), mesh.positions().len());
    let span = |triangle: &[u32; 3]| {
        let u = triangle.map(|vertex| f64::from(mesh.texcoords()[vertex as usize][0]));
        u.into_iter().fold(f64::MIN, f64::max) - u.into_iter().fold(f64::MAX, f64::min)
    };
    let jumps = mesh.triangles().iter().map(span).filter(|span| *span > 0.5 && *span <= 1.0).count();
    TangentReport { triangles, vertices, jumps, ..Default::default() }
}

/// The tangents of all corners in one: fails unless they are equal to within `bound` in each component.
fn assert_all(mesh: &Mesh, made: &Tangents, expected: [f64; 4], bound: f64) {
    let all = corner_tangents(mesh, made);
    assert!(!all.is_empty());
    for (corner, tangent) in all.iter().enumerate() {
        let is_near = tangent.iter().zip(expected).all(|(&got, expected)| (f64::from(got) - expected).abs() <= bound);
        assert!(is_near, "triangle {}, corner {}: got {tangent:?}, expected {expected:?}", corner / 3, corner % 3);
    }
}
