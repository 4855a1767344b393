//! One wrong number in any row of docs/extremes.md: each comparison of the extremes catches it.

use super::failure;
use crate::extremes::{assert_normals, assert_parallax, assert_refused, blend, normal, shading, tangents};
use crate::support::{FLOAT32, SNORM8, blend_options, flat_mesh, map_u8, options, parallax_formats, parallax_options};
use texbake::{BlendMethod, Error, TangentMethod, TangentReport};

#[test]
fn a_wrong_number_of_a_bake_is_caught() {
    let map = map_u8(2, 1, |x, _| [0, 255][x]);
    let right = [0.0, 0.0, 127.0].repeat(2);
    assert_normals(&map, &options("1", SNORM8), &right);
    for index in 0..6 {
        let mut wrong = right.clone();
        wrong[index] -= 1.0;
        let report = failure(|| assert_normals(&map, &options("1", SNORM8), &wrong));
        assert!(report.starts_with("reference, u8 heights") && report.contains("1 of 6 codes differ"), "{report}");
    }
    failure(|| normal::assert_texel(&map, "1", SNORM8, [1, 0], [0.0, 1.0, 127.0]));
    // The sign of zero.
    failure(|| assert_normals(&map, &options("1", FLOAT32), &[0.0, -0.0, 1.0].repeat(2)));
    let snorm = parallax_formats()[2];
    assert_parallax(&map, &parallax_options("1", snorm), &[-127.0, 127.0]);
    failure(|| assert_parallax(&map, &parallax_options("1", snorm), &[-127.0, 126.0]));
    failure(|| assert_parallax(&map, &parallax_options("1", snorm), &[-127.0]));
}

#[test]
fn a_wrong_number_of_a_blend_is_caught() {
    let flat = (SNORM8, &[0, 0, 127][..]);
    let add = blend_options(BlendMethod::add(), SNORM8);
    blend::assert_blend([flat; 2], &add, None, &[0.0, 0.0, 127.0]);
    for wrong in [[1.0, 0.0, 127.0], [0.0, 0.0, 126.0], [0.0, 0.0, 0.0]] {
        failure(|| blend::assert_blend([flat; 2], &add, None, &wrong));
    }
}

#[test]
fn a_wrong_number_of_a_mesh_is_caught() {
    let mesh = flat_mesh(&[([0.0; 2], [0.0, 0.5]), ([1.0, 0.0], [0.5, 0.5]), ([0.0, 1.0], [0.0; 2])], vec![[0, 1, 2]]);
    let (right, none) = ([[1.0, 0.0, 0.0, 1.0]; 3], TangentReport::default());
    let lengyel = TangentMethod::Lengyel;
    tangents::assert_tangents(&mesh, lengyel, &right, none);
    for wrong in [[1.0, 0.0, -0.0, 1.0], [1.0, 0.0, 0.0, -1.0], [1.0 - f32::EPSILON, 0.0, 0.0, 1.0]] {
        failure(|| tangents::assert_tangents(&mesh, lengyel, &[right[0], wrong, right[0]], none));
    }
    failure(|| tangents::assert_tangents(&mesh, lengyel, &right[..2], none));
    failure(|| tangents::assert_tangents(&mesh, lengyel, &right, TangentReport { undirected: 1, ..none }));
}

#[test]
fn a_wrong_message_is_caught() {
    let refuse = |_: &_| Err::<(), Error>(Error::Cancelled);
    assert_refused(refuse, "stopped before it was complete; no file was left under its final name");
    failure(|| assert_refused(refuse, "stopped"));
    failure(|| assert_refused(|_| Ok(()), "stopped"));
}

#[test]
fn a_wrong_offset_is_caught() {
    let flat = [0.0, 0.0, 1.0];
    shading::assert_offset(flat, 0.5, [1.0, 0.0, 2.0], 1.0, [0.25, 0.0]);
    for wrong in [[0.250_001, 0.0], [0.25, 1e-6], [-0.25, 0.0]] {
        failure(|| shading::assert_offset(flat, 0.5, [1.0, 0.0, 2.0], 1.0, wrong));
    }
    failure(|| shading::assert_offset([f32::NAN; 3], 0.5, [1.0, 0.0, 2.0], 1.0, [0.25, 0.0]));
}
