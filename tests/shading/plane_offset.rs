//! Parallax by the plane of a texel (FGED2 eq. 7.50), limited.
//!
//! The bound, with u = 2^-24 and the order of operations of `src/shading/plane_offset.rs`. An operation is off by u of
//! its result on the CPU; on a device + - and * by 2 u (either neighbour, fused or not), / by 5 u (2.5 ULP), and sqrt,
//! which is 1/inverseSqrt, by 4 u + 5 u.
//!
//! - `along` is off by one product.
//! - n . v by three products and two sums, at most three roundings of each of its terms, so by 3 of the sum S of their
//!   magnitudes. That is 3 S/rise of the greater of both, `rise`, and nothing where the other one is clearly greater.
//! - Its length over the limit: a product of `along`, squared, and a sum are 4 roundings, their root is off by half of
//!   that, and by a root and a division more: 4 u, or 18 u.
//! - A quotient and a product more.

use crate::support::Random;
use texbake::shading::plane_offset;

const U: f64 = 1.0 / (1 << 24) as f64;

/// How far operations are off, in u.
#[derive(Debug, Clone, Copy)]
pub struct Roundings {
    /// + - *
    plain: f64,
    division: f64,
    root: f64,
}

const CPU: Roundings = Roundings { plain: 1.0, division: 1.0, root: 1.0 };
#[cfg(feature = "gpu")]
const DEVICE: Roundings = Roundings { plain: 2.0, division: 5.0, root: 9.0 };

/// What a function is called with.
#[derive(Debug, Clone, Copy)]
pub struct View {
    pub n: [f32; 3],
    pub h: f32,
    pub v: [f32; 3],
    pub limit: f32,
}

impl View {
    /// The arguments in their order.
    #[cfg(feature = "gpu")]
    pub fn arguments(&self) -> [f32; 8] {
        let Self { n: [nx, ny, nz], h, v: [vx, vy, vz], limit } = *self;
        [nx, ny, nz, h, vx, vy, vz, limit]
    }

    /// The oracle: where the ray from the origin along v meets the plane n . p = n_z h, if it does within the limit.
    pub fn offset(&self) -> [f64; 2] {
        let [n, v] = [self.n, self.v].map(|vector| vector.map(f64::from));
        let (h, limit) = (f64::from(self.h), f64::from(self.limit));
        let dot = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
        let across = v[0].hypot(v[1]);
        if across == 0.0 {
            return [0.0; 2];
        }
        let length = n[2] * h / dot * across;
        let is_met = dot > 0.0 && length.abs() <= limit * h.abs();
        let length = if is_met { length } else { limit * h };
        [length * v[0] / across, length * v[1] / across]
    }

    /// By how many u of itself each part of the answer may be off.
    fn bound(&self, Roundings { plain, division, root }: Roundings) -> f64 {
        let [n, v] = [self.n, self.v].map(|vector| vector.map(f64::from));
        let terms = [0, 1, 2].map(|axis| n[axis] * v[axis]);
        let (dot, sum) = (terms.iter().sum::<f64>(), terms.iter().map(|term| term.abs()).sum::<f64>());
        let limited = n[2] * v[0].hypot(v[1]) / f64::from(self.limit);
        let of_dot = 3.0 * plain * sum;
        let of_limited = (2.0 * plain + root + division) * limited;
        let is_clear = dot + U * of_dot < limited - U * of_limited;
        let of_rise = if is_clear { of_limited } else { of_dot.max(of_limited) };
        // Second-order terms.
        1.01 * (plain + of_rise / dot.max(limited) + division + plain)
    }
}

/// Views of texels that lean up to 75 degrees, from everywhere: straight above, near the texel's plane on either side,
/// and from below.
fn views() -> Vec<View> {
    let mut random = Random::new(0x750);
    let mut real = move || random.below(1 << 20) as f64 / f64::from(1 << 19) - 1.0;
    let mut views = Vec::new();
    while views.len() < 20_000 {
        let turn = std::f64::consts::PI * real();
        let lean = 1.3 * real();
        let n = [lean.sin() * turn.cos(), lean.sin() * turn.sin(), lean.cos()].map(|part| part as f32);
        let mut v = [real(), real(), real()];
        if views.len() % 2 == 0 {
            // Near the plane: v without its part along n, but for little.
            let [nx, ny, nz] = n.map(f64::from);
            let rest = (nx * v[0] + ny * v[1] + nz * v[2]) - real() * 2f64.powi(-(views.len() as i32 / 2 % 30));
            v = [v[0] - rest * nx, v[1] - rest * ny, v[2] - rest * nz];
        }
        let length = 2f64.powi((30.0 * real()) as i32);
        let v = v.map(|part| (part * length) as f32);
        // No part that a device may flush.
        if v[..2].iter().all(|part| f64::from(part.abs()) > 1e-4 * length) {
            let h = (real() + 1.5) as f32;
            let h = if views.len() % 3 == 0 { -h } else { h };
            views.push(View { n, h, v, limit: [1.0, 0.5, 3.0][views.len() % 3] });
        }
    }
    views
}

#[test]
fn the_twin_is_within_its_bound_of_f64() {
    let (mut met, mut limited, mut below) = (0, 0, 0);
    for view in views() {
        let View { n, h, v, limit } = view;
        let (got, exact) = (plane_offset(n, h, v, limit), view.offset());
        for (got, exact) in got.into_iter().zip(exact) {
            let error = (f64::from(got) - exact).abs();
            assert!(error <= U * view.bound(CPU) * exact.abs(), "{view:?}: got {got}, exactly {exact}");
        }
        let length = exact[0].hypot(exact[1]) / f64::from(h.abs() * limit);
        assert!(length < 1.0 + 1e-12);
        let dot: f64 = n.iter().zip(v).map(|(n, v)| f64::from(*n) * f64::from(v)).sum();
        *(if dot <= 0.0 {
            &mut below
        } else if length > 1.0 - 1e-12 {
            &mut limited
        } else {
            &mut met
        }) += 1;
    }
    assert!(met > 2_000 && limited > 2_000 && below > 2_000, "{met} {limited} {below}");
}

/// Without a limit p = (offset, z) is on the texel's plane, n . p = n_z h (eq. 7.49).
#[test]
fn unlimited_offsets_are_on_the_plane() {
    let mut seen = 0;
    for View { n, h, v, .. } in views() {
        let [[nx, ny, nz], v, h] = [n.map(f64::from), v.map(f64::from), [f64::from(h); 3]];
        if nx * v[0] + ny * v[1] + nz * v[2] < 0.1 * v[0].hypot(v[1]).hypot(v[2]) {
            continue;
        }
        let [x, y] = plane_offset(n, h[0] as f32, v.map(|part| part as f32), 1e6).map(f64::from);
        let z = x / v[0] * v[2];
        // v is at most ten times as long as n . v: ten roundings of twelve.
        let off = (nx * x + ny * y + nz * z - nz * h[0]).abs();
        assert!(off < 12.0 * 10.0 * 10.0 * U * h[0].abs(), "{n:?}, {v:?}: {off:e}");
        seen += 1;
    }
    assert!(seen > 4_000, "{seen}");
}

/// As the eye goes through the plane of the texel the offset does not jump.
#[test]
fn offsets_are_continuous_through_the_plane() {
    let n = [0.6, 0.0, 0.8];
    let mut last = None::<[f32; 2]>;
    for step in -1000..=1000 {
        // v turns from the plane by a thousandth of a radian at a time.
        let angle = f64::from(step) * 1e-3;
        let (sin, cos) = angle.sin_cos();
        let v = [-0.8 * cos + 0.6 * sin, 0.1, 0.6 * cos + 0.8 * sin].map(|part| part as f32);
        let offset = plane_offset(n, 0.5, v, 1.0);
        if let Some(last) = last {
            let jump = (offset[0] - last[0]).hypot(offset[1] - last[1]);
            assert!(jump < 0.01, "{step}: {last:?} to {offset:?}");
        }
        last = Some(offset);
    }
}

#[cfg(feature = "gpu")]
pub const FUNCTION: crate::support::ShaderFunction<'static> = crate::support::ShaderFunction {
    wgsl: include_str!("../../kernels/shading/plane_offset.wgsl"),
    call: "plane_offset(vec3(a[0], a[1], a[2]), a[3], vec3(a[4], a[5], a[6]), a[7])",
    texture: None,
};

/// Arguments and exact results.
#[cfg(feature = "gpu")]
fn calls(views: impl Iterator<Item = View>) -> Vec<crate::support::Call<8, 2>> {
    let call = |view: View| crate::support::Call {
        arguments: view.arguments(),
        expected: view.offset().map(|part| part as f32),
        bounds: [0.0; 2],
    };
    views.map(call).collect()
}

/// An f32 is at least u of itself from the next one, and the nearest to the exact answer is half of one off.
#[cfg(feature = "gpu")]
#[test]
fn every_device_is_within_its_bound_of_f64() {
    let mut seen = 0;
    for bound in [32.0, 64.0, 128.0, 256.0] {
        let is_within = |view: &View| (bound / 2.0..bound).contains(&view.bound(DEVICE));
        let calls = calls(views().into_iter().filter(is_within));
        if !calls.is_empty() {
            FUNCTION.assert_on_every_device(&calls, bound as u32 + 1);
        }
        seen += calls.len();
    }
    assert!(seen > 19_000, "{seen}");
}

/// Another formula is seen: v_xy without n_z, no limit, another sign.
#[cfg(feature = "gpu")]
#[test]
fn another_formula_on_a_device_is_noticed() {
    let calls = calls(views().into_iter().take(500));
    for (from, to) in [("n.z * v.xy", "v.xy"), ("dot(along, along)) / limit", "0.0)"), ("h * (", "-h * (")] {
        assert!(FUNCTION.wgsl.contains(from), "{from}");
        let text = FUNCTION.wgsl.replacen(from, to, 1);
        let changed = crate::support::ShaderFunction { wgsl: &text, ..FUNCTION };
        let comparisons = changed.on_every_device(&calls, 257);
        assert!(comparisons.iter().all(|(_, comparison)| comparison.differing > 0), "{from}");
    }
}
