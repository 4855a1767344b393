//! The kernels as they are compiled, for whoever wants to look at them: to measure, to read, to run elsewhere.

use super::kernel::Kernel;
use super::operation::{Operation, TEXELS_PER_INVOCATION};
use super::tangents::{frame_words, kernels_of};
use crate::error::Result;
use crate::exact::{Rational, Scale};
use crate::map::{Channels, Depth, Encoding, HeightType, NormalFormat, ParallaxFormat, Size, TexelFormat};
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, BakePlan};
use crate::ops::blend::{BlendMethod, BlendOptions, BlendPlan};
use crate::ops::parallax::ParallaxPlan;
use crate::ops::tangents::TangentMethod;

/// One kernel as it is compiled: its text, and the values of its overrides.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelVariant {
    /// What it computes from what, and in which precision: `bake u16 to 8-bit unorm xyz, exact`.
    pub name: String,
    /// The text, in WGSL. It binds `params` (uniform), `inputs` (read) and `outputs` (read and write), 0 to 2 of group 0.
    pub wgsl: String,
    /// The compute entry point of the text.
    pub entry_point: &'static str,
    /// The value of each override of the text; a bool is 0 or 1.
    pub constants: Vec<(&'static str, f64)>,
    /// What there is one result of: `texel`, `triangle` or `fan` (the corners that share a tangent).
    pub item: &'static str,
    /// Items that one invocation computes.
    pub items_per_invocation: u32,
    /// Bytes that a GPU fetches from memory for each item if its caches lose nothing.
    pub bytes_read: f64,
    /// Bytes that it writes for each item.
    pub bytes_written: f64,
}

/// Every kernel, each with the constants of some plans that differ in what is computed.
///
/// What a plan compiles to can depend on its numbers: integers are as short as the scale and the weights allow. The
/// names say which scale or weights were taken where two variants differ in that alone. Fans count as those of a large
/// closed mesh: six corners, two triangles for each fan.
///
/// ```
/// let kernels = texbake::gpu::kernels()?;
/// let kernel = kernels.iter().find(|kernel| kernel.name == "bake u16 to 8-bit unorm xyz, exact").unwrap();
/// assert_eq!((kernel.item, kernel.bytes_read, kernel.bytes_written), ("texel", 2.0, 3.0));
/// assert!(kernel.wgsl.contains("fn bake("));
/// # Ok::<(), texbake::Error>(())
/// ```
///
/// # Errors
/// None that a caller can cause: what the plans of these variants report.
pub fn kernels() -> Result<Vec<KernelVariant>> {
    let mut kernels = bakes()?;
    kernels.extend(blends()?);
    kernels.extend(parallaxes()?);
    kernels.extend(tangents());
    Ok(kernels)
}

/// A multiple of what an invocation computes.
const SIZE: (usize, usize) = (64, 64);

const UNORM8: NormalFormat = normals(Encoding::Unorm, Depth::Bits8);
const UNORM16: NormalFormat = normals(Encoding::Unorm, Depth::Bits16);
const FLOAT16: NormalFormat = normals(Encoding::Float, Depth::Float16);
const FLOAT32: NormalFormat = normals(Encoding::Float, Depth::Float32);
const SNORM8: ParallaxFormat = ParallaxFormat { encoding: Encoding::Snorm, depth: Depth::Bits8 };
const SNORM16: ParallaxFormat = ParallaxFormat { encoding: Encoding::Snorm, depth: Depth::Bits16 };
const PARALLAX16F: ParallaxFormat = ParallaxFormat { encoding: Encoding::Float, depth: Depth::Float16 };

const fn normals(encoding: Encoding, depth: Depth) -> NormalFormat {
    NormalFormat { encoding, depth, channels: Channels::Xyz, convention: crate::map::Convention::Gl }
}

const fn xy(format: NormalFormat) -> NormalFormat {
    NormalFormat { channels: Channels::Xy, ..format }
}

fn bakes() -> Result<Vec<KernelVariant>> {
    use HeightType::{F32, U8, U16};
    use Precision::{Exact, Fast};
    let mut kernels = Vec::new();
    let mut add = |heights, normal: Option<NormalFormat>, parallax: Option<ParallaxFormat>, precision, scale: Scale| {
        let options = BakeOptions { normal, parallax, precision, scale, ..Default::default() };
        let plan = BakePlan::new(&options, Size::new(SIZE.0, SIZE.1)?, heights)?;
        let outputs: Vec<String> =
            [normal.map(|format| named_normals(&format)), parallax.map(named_parallax)].into_iter().flatten().collect();
        let scale = if scale == usual() { String::new() } else { format!(", scale {}", plan.scale) };
        let name = format!("bake {heights} to {}{scale}, {precision}", outputs.join(" and "));
        kernels.push(of_texels(name, &plan, heights.bytes()));
        Result::Ok(())
    };
    for heights in [U8, U16, F32] {
        for format in [UNORM8, UNORM16, FLOAT16, FLOAT32] {
            add(heights, Some(format), None, Exact, usual())?;
        }
        add(heights, Some(xy(UNORM8)), None, Exact, usual())?;
        add(heights, Some(UNORM8), Some(SNORM8), Exact, usual())?;
        add(heights, None, Some(SNORM8), Exact, usual())?;
    }
    // Of this height the sums take more bits.
    let high = Scale::texels(Rational::new(16_777_213, 9_699_691)?);
    for heights in [U8, U16] {
        for format in [UNORM8, UNORM16] {
            add(heights, Some(format), None, Exact, high)?;
        }
    }
    add(U16, Some(UNORM16), Some(SNORM16), Exact, usual())?;
    add(U16, Some(UNORM8), Some(PARALLAX16F), Exact, usual())?;
    for heights in [U8, U16, F32] {
        add(heights, Some(UNORM8), None, Fast, usual())?;
        add(heights, Some(UNORM16), None, Fast, usual())?;
        add(heights, Some(FLOAT32), None, Fast, usual())?;
        add(heights, Some(UNORM8), Some(SNORM8), Fast, usual())?;
    }
    Ok(kernels)
}

/// A scale that materials have.
fn usual() -> Scale {
    Scale::texels(24)
}

fn blends() -> Result<Vec<KernelVariant>> {
    use BlendMethod::{Linear, Masked, Overlay, Rnm, Udn, Weighted, Whiteout};
    use HeightType::{U8, U16};
    use Precision::{Exact, Fast};
    let mut kernels = Vec::new();
    let mut add = |method, [base, detail, format]: [NormalFormat; 3], mask: Option<HeightType>, precision| {
        let options = BlendOptions { method, format, precision, ..Default::default() };
        let plan = BlendPlan::new(&options, Size::new(SIZE.0, SIZE.1)?, [base, detail], mask)?;
        let masked = mask.map_or(String::new(), |mask| format!(" by {mask}"));
        let inputs = format!("{} and {}{masked}", named_normals(&base), named_normals(&detail));
        let how = named_method(method);
        let name = format!("blend {inputs} to {}, {how}, {precision}", named_normals(&format));
        kernels.push(of_texels(name, &plan, arriving_bytes(&plan)));
        Result::Ok(())
    };
    let weighted = Weighted { base: Rational::new(1000, 333)?, detail: Rational::new(-7, 333)? };
    for format in [UNORM8, UNORM16] {
        for method in [BlendMethod::add(), weighted, Linear, Overlay, Udn, Whiteout, Rnm] {
            add(method, [format; 3], None, Exact)?;
        }
        add(Masked, [format; 3], Some(U8), Exact)?;
        add(Masked, [format; 3], Some(U16), Exact)?;
        add(BlendMethod::add(), [xy(format); 3], None, Exact)?;
        add(BlendMethod::add(), [format, format, FLOAT32], None, Exact)?;
    }
    for method in [BlendMethod::add(), Linear, Overlay, Udn, Whiteout, Rnm] {
        add(method, [FLOAT32; 3], None, Exact)?;
    }
    add(Masked, [FLOAT32; 3], Some(U16), Exact)?;
    add(BlendMethod::add(), [FLOAT16, UNORM8, UNORM8], None, Exact)?;
    add(BlendMethod::add(), [UNORM8; 3], None, Fast)?;
    add(Masked, [UNORM8; 3], Some(U8), Fast)?;
    add(Rnm, [UNORM16; 3], None, Fast)?;
    add(BlendMethod::add(), [FLOAT32; 3], None, Fast)?;
    Ok(kernels)
}

fn parallaxes() -> Result<Vec<KernelVariant>> {
    use HeightType::{F32, U8, U16};
    use Precision::{Exact, Fast};
    let cases = [
        (U8, UNORM8, SNORM8, Exact),
        (U16, UNORM8, SNORM8, Exact),
        (U16, xy(UNORM8), SNORM8, Exact),
        (U16, UNORM8, SNORM16, Exact),
        (U16, UNORM16, SNORM8, Exact),
        (U16, UNORM16, SNORM16, Exact),
        (U16, UNORM16, PARALLAX16F, Exact),
        (F32, UNORM8, SNORM8, Exact),
        (F32, FLOAT32, SNORM16, Exact),
        (F32, xy(FLOAT32), PARALLAX16F, Exact),
        (U16, UNORM8, SNORM8, Fast),
        (F32, FLOAT32, SNORM16, Fast),
    ];
    let kernel = |(heights, input, format, precision)| {
        let plan = ParallaxPlan::new(Size::new(SIZE.0, SIZE.1)?, heights, input, format, precision)?;
        let to = named_parallax(format);
        let name = format!("parallax {heights} and {} to {to}, {precision}", named_normals(&input));
        Ok(of_texels(name, &plan, arriving_bytes(&plan)))
    };
    cases.into_iter().map(kernel).collect()
}

/// A triangle's frame, and a fan's tangent.
fn tangents() -> Vec<KernelVariant> {
    use TangentMethod::{Hegde, Lengyel, Mikktspace};
    let mut variants: Vec<KernelVariant> = Vec::new();
    for precision in [Precision::Exact, Precision::Fast] {
        for method in [Lengyel, Hegde, Mikktspace] {
            let [frames, tangents] = kernels_of(method, precision);
            let frame = 4 * frame_words(method) as u32;
            // Half a vertex's position, four texture differences, three indices.
            let read = 6 + 16 + 12;
            variants.push(of_mesh(frames, format!("frames, {method}, {precision}"), "triangle", read, frame));
            // A fan's normal, the beginning of its corners, six corners, two frames; for angles two triangles, a position.
            let corners = if method == Mikktspace { 24 + 12 } else { 0 };
            let read = 12 + 4 + 24 + 2 * frame + corners;
            let name = match method {
                // The same kernel for both.
                Hegde => continue,
                Lengyel => format!("tangents, {Lengyel} and {Hegde}, {precision}"),
                Mikktspace => format!("tangents, {Mikktspace}, {precision}"),
            };
            variants.push(of_mesh(tangents, name, "fan", read, 16));
        }
    }
    variants
}

/// The kernel of an operation that fetches so many bytes for a texel.
fn of_texels(name: String, operation: &impl Operation, bytes_read: usize) -> KernelVariant {
    let written: usize = operation.outputs().iter().map(TexelFormat::bytes).sum();
    let bytes = [bytes_read as f64, written as f64];
    variant(operation.kernel(), name, "texel", TEXELS_PER_INVOCATION as u32, bytes)
}

/// A kernel of one item for each invocation.
fn of_mesh(kernel: Kernel, name: String, item: &'static str, read: u32, written: u32) -> KernelVariant {
    variant(kernel, name, item, 1, [read, written].map(f64::from))
}

fn variant(
    Kernel { source, constants }: Kernel,
    name: String,
    item: &'static str,
    items_per_invocation: u32,
    [bytes_read, bytes_written]: [f64; 2],
) -> KernelVariant {
    KernelVariant {
        name,
        wgsl: source.text(),
        entry_point: source.entry_point,
        constants: constants.into_iter().map(|(name, value)| (name, value.into())).collect(),
        item,
        items_per_invocation,
        bytes_read,
        bytes_written,
    }
}

/// Bytes of a texel of all layers, which lie in memory once.
fn arriving_bytes(operation: &impl Operation) -> usize {
    operation.inputs().iter().sum::<usize>() / operation.width()
}

fn named_normals(format: &NormalFormat) -> String {
    format!("{} {}", named_codes(format.texel()), format.channels)
}

fn named_parallax(format: ParallaxFormat) -> String {
    format!("{} parallax", named_codes(format.texel()))
}

/// `8-bit unorm`, or `16-bit float`.
fn named_codes(format: TexelFormat) -> String {
    format!("{}-bit {}", 8 * format.depth.bytes(), format.encoding)
}

fn named_method(method: BlendMethod) -> String {
    match method {
        BlendMethod::Weighted { base, detail } if method == BlendMethod::add() => format!("add {base} {detail}"),
        BlendMethod::Weighted { base, detail } => format!("weighted {base} {detail}"),
        BlendMethod::Masked => "masked".into(),
        BlendMethod::Linear => "linear".into(),
        BlendMethod::Overlay => "overlay".into(),
        BlendMethod::Udn => "udn".into(),
        BlendMethod::Whiteout => "whiteout".into(),
        BlendMethod::Rnm => "rnm".into(),
    }
}
