//! Parallax by the plane of a texel (FGED2 eq. 7.50) as the eye comes near the plane.
//!
//! The flat texel's n is (0, 0, 1), the tilted one's (3, 0, 4)/5: its plane holds the directions (4, y, -3).

use texbake::shading::plane_offset;

const FLAT: [f32; 3] = [0.0, 0.0, 1.0];
const TILTED: [f32; 3] = [0.6, 0.0, 0.8];

/// The twin is within a few roundings of the expected offset, and every device within those that WGSL leaves it: see
/// tests/shading/plane_offset.rs.
pub fn assert_offset(n: [f32; 3], h: f32, v: [f32; 3], limit: f32, expected: [f32; 2]) {
    let got = plane_offset(n, h, v, limit);
    let bound = 4.0 * f32::EPSILON * expected[0].abs().max(expected[1].abs());
    let is_near = got.iter().zip(expected).all(|(got, expected)| (got - expected).abs() <= bound);
    assert!(is_near, "n {n:?}, h {h}, v {v:?}, limit {limit}: got {got:?}, expected {expected:?}");
    #[cfg(feature = "gpu")]
    {
        let view = crate::shading::plane_offset::View { n, h, v, limit };
        let call = crate::support::Call { arguments: view.arguments(), expected, bounds: [0.0; 2] };
        crate::shading::plane_offset::FUNCTION.assert_on_every_device(&[call], 32);
    }
}

#[test]
fn eye_straight_above() {
    assert_offset(FLAT, 0.5, [0.0, 0.0, 1.0], 1.0, [0.0, 0.0]);
    // Along the normal of a tilted texel: n_z h v_xy = 0.8 * 0.5 * 0.6.
    assert_offset(TILTED, 0.5, TILTED, 1.0, [0.24, 0.0]);
}

#[test]
fn eye_at_45_degrees() {
    // tan is 1: eq. 7.50 and the limit of 1 meet.
    for h in [0.5, -0.5] {
        assert_offset(FLAT, h, [3.0, 4.0, 5.0], 1.0, [0.6 * h, 0.8 * h]);
        assert_offset(FLAT, h, [3.0, 4.0, 5.000_01], 1.0, [0.6 * h * 0.999_998, 0.8 * h * 0.999_998]);
        assert_offset(FLAT, h, [3.0, 4.0, 4.999_99], 1.0, [0.6 * h, 0.8 * h]);
    }
}

#[test]
fn eye_just_above_the_plane() {
    for rise in [1e-3, 1e-20, f32::from_bits(1)] {
        assert_offset(FLAT, 0.5, [3.0, 4.0, rise], 1.0, [0.3, 0.4]);
        assert_offset(FLAT, 0.5, [3.0, 4.0, rise], 3.0, [0.9, 1.2]);
    }
}

#[test]
fn eye_in_the_plane() {
    // n . v = 0.
    assert_offset(FLAT, 0.5, [3.0, 4.0, 0.0], 1.0, [0.3, 0.4]);
    assert_offset(FLAT, 0.5, [3.0, 4.0, -0.0], 1.0, [0.3, 0.4]);
    assert_offset(TILTED, 0.5, [-4.0, 0.0, 3.0], 1.0, [-0.5, 0.0]);
}

#[test]
fn eye_below_the_plane() {
    // n . v = -0.6: eq. 7.50 would point the other way, (0.667, 0).
    assert_offset(TILTED, 0.5, [-1.0, 0.0, 0.0], 1.0, [-0.5, 0.0]);
    assert_offset(FLAT, 0.5, [3.0, 4.0, -5.0], 1.0, [0.3, 0.4]);
}

#[test]
fn eye_straight_below() {
    assert_offset(FLAT, 0.5, [0.0, 0.0, -1.0], 1.0, [0.0, 0.0]);
    assert_offset(FLAT, 0.5, [0.0, 0.0, 0.0], 1.0, [0.0, 0.0]);
    assert_offset([1.0, 0.0, 0.0], 0.5, [-1.0, 0.0, 1.0], 1.0, [0.0, 0.0]);
}

/// The offset does not depend on the length of v.
#[test]
fn view_vectors_of_any_length() {
    for length in [2f32.powi(-40), 1.0, 2f32.powi(40)] {
        assert_offset(TILTED, 0.25, [length, length, 4.0 * length], 1.0, [0.2 / 3.8, 0.2 / 3.8]);
        assert_offset(FLAT, 0.5, [3.0 * length, 4.0 * length, length], 1.0, [0.3, 0.4]);
    }
}

/// Nothing is as long as nothing, or shorter.
#[test]
fn limit_at_or_below_zero() {
    for limit in [0.0, -0.0, -f32::from_bits(1), -1.0, f32::MIN] {
        for v in [[3.0, 4.0, 1.0], [3.0, 4.0, 0.0], [0.0, 0.0, 1.0]] {
            assert_offset(FLAT, 0.5, v, limit, [0.0, 0.0]);
        }
    }
}

#[test]
fn limits_at_their_ends() {
    let (least, greatest) = (2f32.powi(-40), 2f32.powi(40));
    assert_offset(FLAT, 0.5, [3.0, 4.0, 5.0], least, [0.3 * least, 0.4 * least]);
    assert_offset(FLAT, 0.5, [3.0, 4.0, 0.0], greatest, [0.3 * greatest, 0.4 * greatest]);
    assert_offset(FLAT, 0.5, [3.0, 4.0, 1.0], greatest, [1.5, 2.0]);
}
