//! The known-answer test of the tangents' kernels: a small mesh of awkward triangles.

use super::device::Device;
use super::self_test::scrambled;
use super::tangents::{Limits, kernels, run};
use crate::error::Result;
use crate::mesh::{CornerAdjacency, Mesh};
use crate::ops::Precision;
use crate::ops::tangents::{Fans, Surface, TangentPlan, tangents_of_fans};
use std::borrow::Cow;

/// Before a plan's first run: a small mesh by its own kernels, once for each pair.
pub(super) fn accept(device: &Device, plan: &TangentPlan<'_>) -> Result<()> {
    let kernels = kernels(plan);
    if plan.precision == Precision::Fast || kernels.iter().all(|kernel| device.is_tested(kernel)) {
        return Ok(());
    }
    let (mesh, normals) = noise(200, 1)?;
    let corners = Cow::Owned(CornerAdjacency::of(&mesh));
    let surface = Surface::new(&mesh, &normals, false);
    let plan = TangentPlan { surface: &surface, fans: &Fans { corners, owners: None }, ..*plan };
    compare(device, &plan, Limits::of(device))?;
    kernels.into_iter().for_each(|kernel| device.set_tested(kernel));
    Ok(())
}

/// Fails unless the device computes the specification's tangents.
pub(super) fn compare(device: &Device, plan: &TangentPlan<'_>, limits: Limits) -> Result<()> {
    let mut got = vec![[f32::NAN; 4]; plan.fans.count()];
    let mut expected = vec![[f32::INFINITY; 4]; plan.fans.count()];
    run(device, plan, limits, &mut got)?;
    tangents_of_fans(plan, &mut expected);
    let bits = |tangent: &[f32; 4]| tangent.map(f32::to_bits);
    let differ = got.iter().zip(&expected).position(|(got, expected)| bits(got) != bits(expected));
    differ.map_or(Ok(()), |fan| {
        let (got, expected) = (got[fan], expected[fan]);
        let method = plan.method;
        let reason = format!("it fails the self-test: tangents: {method:?}: {got:?} instead of {expected:?}");
        Err(device.error(reason))
    })
}

/// A mesh of `vertices` vertices and twice as many triangles without order, and normals for it.
///
/// Positions and texture coordinates have any exponent below 2, or are small integers (right angles, no area), or
/// any number from -1 to 1, or lie close to 1 (thin triangles); x is tiny for half of the vertices. One triangle of 16
/// has a vertex twice. After them come [`CORNER_CASES`].
pub(super) fn noise(vertices: u32, seed: u32) -> Result<(Mesh, Vec<[f32; 3]>)> {
    let bits = |kind: u32, index: u32| scrambled(scrambled(seed * 16 + kind).wrapping_add(index));
    // From -1 to 1.
    let real = |bits: u32| (bits >> 8) as f32 / 8_388_608.0 - 1.0;
    let coordinate = |vertex: u32, bits: u32| match vertex % 4 {
        0 => f32::from_bits(bits & 0xbfff_ffff),
        1 => (bits % 5) as f32 * 0.5 - 1.0,
        2 => real(bits),
        _ => 1.0 + real(bits) / 4096.0,
    };
    let axes = |kind: u32, vertex: u32| [0, 1, 2].map(|axis| bits(kind, 3 * vertex + axis));
    let positions = (0..vertices).map(|vertex| {
        let [x, y, z] = axes(0, vertex);
        // A tangent of such an x has a subnormal one.
        let x = if vertex / 32 % 2 == 1 { f32::from_bits(x & 0x80ff_ffff) } else { coordinate(vertex, x) };
        [x, coordinate(vertex, y), coordinate(vertex, z)]
    });
    let texcoords = (0..vertices).map(|vertex| {
        let [u, v, kind] = axes(1, vertex);
        [coordinate(kind, u), coordinate(kind, v)]
    });
    let normals = (0..vertices).map(|vertex| {
        let [x, y, z] = axes(2, vertex);
        match vertex % 8 {
            0 => [0.0, -1.0, 0.0],
            1 | 3 | 5 => [f32::from_bits(x & 0x81ff_ffff), 1.0, -0.0],
            _ => [x, y, z].map(real),
        }
    });
    let triangles = (0..2 * vertices).map(|triangle| {
        let first = triangle / 2;
        let [a, b, _] = axes(3, triangle);
        [first, (first + 1 + a % 12) % vertices, (first + if triangle % 16 == 0 { 0 } else { 1 + b % 12 }) % vertices]
    });
    let positions: Vec<[f32; 3]> = positions.chain(CORNER_CASES.map(|(position, ..)| position)).collect();
    let texcoords: Vec<[f32; 2]> = texcoords.chain(CORNER_CASES.map(|(_, texcoord, _)| texcoord)).collect();
    let normals: Vec<[f32; 3]> = normals.chain(CORNER_CASES.map(|(.., normal)| normal)).collect();
    let cases = CORNERS_OF_CASES.map(|triangle| triangle.map(|vertex| vertices + vertex));
    Ok((Mesh::new(positions, texcoords, triangles.chain(cases).collect())?, normals))
}

/// What noise does not hit: position, texture coordinate and normal of vertices.
const CORNER_CASES: [([f32; 3], [f32; 2], [f32; 3]); 13] = [
    // Tangents that nearly cancel.
    ([0.0; 3], [0.0; 2], [0.0, 0.0, 1.0]),
    // One nearly along the normal.
    ([1.0, 0.0, 0.0], [0.5, 0.0], [1.0, 1.0 / 262_144.0, 0.0]),
    ([0.0, 1.0, 0.0], [0.0, 0.5], [0.0, 0.0, 1.0]),
    ([-1.0, 1.0 / 1_048_576.0, 0.0], [0.5, 0.0], [0.0, 0.0, 1.0]),
    // Angles of zero: the cosine computed is more than 1 for the first two.
    ([0.0; 3], [0.0; 2], [0.0, 0.0, 1.0]),
    ([0.05, 0.3, 0.0], [0.5, 0.0], [0.0, 0.0, 1.0]),
    ([0.025, 0.15, 0.0], [0.0, 0.5], [0.0, 0.0, 1.0]),
    ([0.0; 3], [0.0; 2], [0.0, 0.0, 1.0]),
    ([0.1, 0.15, 0.0], [0.5, 0.0], [0.0, 0.0, 1.0]),
    ([0.05, 0.075, 0.0], [0.0, 0.5], [0.0, 0.0, 1.0]),
    ([0.0; 3], [0.0; 2], [0.0, 0.0, 1.0]),
    ([0.7, 0.9, 0.0], [0.5, 0.0], [0.0, 0.0, 1.0]),
    ([0.35, 0.45, 0.0], [0.0, 0.5], [0.0, 0.0, 1.0]),
];
const CORNERS_OF_CASES: [[u32; 3]; 5] = [[0, 1, 2], [0, 3, 2], [4, 5, 6], [7, 8, 9], [10, 11, 12]];
