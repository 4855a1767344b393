//! `fast` against `exact`, on meshes without slivers.
//!
//! Native WGSL divides within 2.5 ULP and takes square roots within that of an inverse root, 2 ULP and a division;
//! sums and products may take either neighbour, and operations may be fused. So each rounding of the oracle's bound is
//! at most five of u = 2^-24 instead of one, and ten in a unit vector: ten times the bound of `exact`. MikkTSpace's
//! angles are off by 2^-11 in WGSL's acos at worst, and so is the weight of each triangle.

use super::{METHODS, as_to_v};
use crate::oracle::{TangentFormula, real_tangents};
use crate::support::{Subject, angle, corners, cube, cylinder, direction, every_baker, hills, plane, torus, uneven};
use texbake::{Precision, TangentMethod, TangentOptions};

#[test]
fn fast_is_near_exact_on_every_baker() {
    for mesh in [plane(5, 4), torus(24, 16), cylinder(20, 3), hills(16, 16, 41), uneven(12, 9), cube()] {
        for method in METHODS {
            for Subject { name, baker } in every_baker() {
                let with = |precision| {
                    let options = TangentOptions { precision, ..as_to_v(method) };
                    corners(&mesh, &baker.tangents(&mesh, &options).unwrap_or_else(|error| panic!("{name}: {error}")))
                };
                let (exact, fast) = (with(Precision::Exact), with(Precision::Fast));
                let normals: Vec<_> = exact.iter().map(|corner| corner.normal).collect();
                let bounds: Vec<f64> = match method {
                    TangentMethod::Mikktspace => vec![2f64.powi(-11); exact.len()],
                    TangentMethod::Lengyel => bounds(&mesh, &normals, TangentFormula::Lengyel),
                    TangentMethod::Hegde => bounds(&mesh, &normals, TangentFormula::Hegde),
                };
                assert!(!exact.is_empty() && exact.len() == fast.len());
                for ((exact, fast), bound) in exact.iter().zip(&fast).zip(bounds) {
                    let off = angle(direction(exact.tangent), direction(fast.tangent));
                    assert!(off <= bound, "{name}, {method}: {fast:?} is off by {off:e}, above {bound:e}");
                    assert_eq!((exact.tangent[3], exact.source), (fast.tangent[3], fast.source), "{name}, {method}");
                }
            }
        }
    }
}

fn bounds(mesh: &texbake::Mesh, normals: &[[f32; 3]], formula: TangentFormula) -> Vec<f64> {
    // Once for `exact`, ten times for `fast`.
    real_tangents(mesh, normals, formula, false).iter().map(|tangent| 11.0 * tangent.bound).collect()
}
