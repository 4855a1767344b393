//! Where the ray to the eye meets the relief.

/// The offset to the first point of the relief that the ray from the eye meets: by `steps` equal steps from the greatest
/// height down, then by `bisections` of the step in which it was passed.
///
/// The surface is at the height h - 1/2 above the plane that is textured, in units of the scale, h being what `height`
/// gives for texture coordinates, in [0, 1]. `uv` is where the ray meets the plane; `v` points to the eye, in tangent
/// space, its x and y along growing u and v, of any length, with z above zero; `scale` is the height of h = 1 in texture
/// coordinates, for each axis; below zero heights are depths. Steps that are longer than a bump is wide may miss it.
///
/// This is what the other offsets approximate, at the cost of `steps` + `bisections` lookups.
///
/// ```
/// use texbake::shading::relief_offset;
///
/// // A plateau at h = 3/4 is met a quarter of the scale above the plane.
/// let [x, _] = relief_offset(|_| 0.75, [0.5, 0.5], [1.0, 0.0, 1.0], [0.04; 2], 64, 20);
/// assert!((x - 0.01).abs() < 1e-7);
/// ```
pub fn relief_offset(
    height: impl Fn([f32; 2]) -> f32,
    uv: [f32; 2],
    [vx, vy, vz]: [f32; 3],
    scale: [f32; 2],
    steps: u32,
    bisections: u32,
) -> [f32; 2] {
    let side = if scale[0] < 0.0 { -1.0 } else { 1.0 };
    let slant = [vx / vz * (side * scale[0]), vy / vz * (side * scale[1])];
    let is_below = |z: f32| side * (height([uv[0] + slant[0] * z, uv[1] + slant[1] * z]) - 0.5) >= z;
    let (mut above, mut below) = (0.5, 0.5);
    for i in 1..=steps {
        below = 0.5 - i as f32 / steps as f32;
        if is_below(below) {
            break;
        }
        above = below;
    }
    for _ in 0..bisections {
        let middle = 0.5 * (above + below);
        *(if is_below(middle) { &mut below } else { &mut above }) = middle;
    }
    slant.map(|part| part * (0.5 * (above + below)))
}
