//! Shots on a GPU: the host of `kernels/preview.wgsl`.

use super::shot::{Samples, Shot, Surface};
use crate::backend::gpu::{Binding, Gpu, OwnPipeline};
use crate::error::Result;
use crate::map::{Edge, Edges, Size};
use crate::material::{ParallaxMethod, Texture};
use crate::stream::Monitor;
use half::f16;
use std::ops::Range;

/// The kernel, and those of the shader library that it calls.
pub(crate) const WGSL: &str = concat!(
    include_str!("../../kernels/preview.wgsl"),
    include_str!("../../kernels/shared/parallax_method.wgsl"),
    include_str!("../../kernels/shading/welsh_offset.wgsl"),
    include_str!("../../kernels/shading/plane_offset.wgsl"),
    include_str!("../../kernels/shading/stepped_offset.wgsl"),
    include_str!("../../kernels/shading/relief_offset.wgsl"),
    include_str!("../../kernels/shading/lighting.wgsl"),
);

/// Invocations along each side of a workgroup.
const GROUP: u32 = 8;
/// Lookups in one dispatch, at most: drivers lose patience after seconds, and software is slow.
const LOOKUPS: u64 = 1 << 26;
/// Words for each sample: a colour and an offset.
const WORDS: usize = 5;

/// Whether the device's sampler does what a shot's maps need: it repeats and clamps, and maps that mirror are unfolded,
/// which maps of several sizes are not alike.
pub(super) fn can_take(shot: &Shot<'_>) -> bool {
    let material = shot.material;
    let edges = material.heights().edges();
    let sizes = [material.normals().size(), material.parallax().size()];
    ![edges.x, edges.y].contains(&Edge::Mirror) || sizes == [material.size(); 2]
}

/// Texels along an axis of a map on the device: one that mirrors goes forth and back between its borders, which are not
/// repeated, and then repeats.
fn unfolded(edge: Edge, texels: usize) -> usize {
    if edge == Edge::Mirror { (2 * texels - 2).max(1) } else { texels }
}

/// Takes a shot.
///
/// # Errors
/// [`crate::Error::Device`] if the device fails; [`crate::Error::Cancelled`].
pub(super) fn take(gpu: &Gpu, shot: &Shot<'_>, wgsl: &str, monitor: &Monitor) -> Result<Samples> {
    let pipeline = gpu.untested().compile(wgsl, "preview", &[])?;
    let maps = Maps::of(shot, gpu.untested().filters_floats())?;
    let [across, down] = shot.count;
    let method = shot.method()?;
    let lookups = u64::from(method.fetches().saturating_add(7)) * u64::from(across);
    let rows = (LOOKUPS / lookups).clamp(1, u64::from(down)) as u32;
    let mut words = Vec::new();
    for first in (0..down).step_by(rows as usize) {
        monitor.check()?;
        words.extend(maps.samples(&pipeline, shot, method, first..down.min(first + rows))?);
    }
    let (samples, _) = words.as_chunks::<WORDS>();
    let split = |words: &[u32; WORDS]| {
        let [red, green, blue, x, y] = words.map(f32::from_bits);
        ([red, green, blue], [x, y])
    };
    let (colours, offsets) = samples.iter().map(split).unzip();
    Ok(Samples { colours, offsets })
}

/// A material's textures as words, one channel each: heights, parallax, and the normals' three.
struct Maps([(Binding, Vec<u32>); 5]);

impl Maps {
    /// The maps of a shot; rounded to halves if the device filters nothing finer.
    fn of(shot: &Shot<'_>, filters_floats: bool) -> Result<Self> {
        fn words<const N: usize>(
            map: &Texture<N>,
            channel: usize,
            filters_floats: bool,
        ) -> Result<(Binding, Vec<u32>)> {
            let (edges, [width, height]) = (map.edges(), [map.size().width(), map.size().height()]);
            let size = Size::new(unfolded(edges.x, width), unfolded(edges.y, height))?;
            let place = |i: usize, texels: usize| if i < texels { i } else { 2 * texels - 2 - i };
            let word = |i: usize| {
                let (x, y) = (place(i % size.width(), width), place(i / size.width(), height));
                let value = map.texels()[y * width + x][channel];
                if filters_floats { value.to_bits() } else { f16::from_f32(value).to_f32().to_bits() }
            };
            Ok((Binding::Texture(size), (0..size.texels()).map(word).collect()))
        }
        let material = shot.material;
        let normals = |channel| words(material.normals(), channel, filters_floats);
        Ok(Self([
            words(material.heights(), 0, filters_floats)?,
            words(material.parallax(), 0, filters_floats)?,
            normals(0)?,
            normals(1)?,
            normals(2)?,
        ]))
    }

    /// The words of some rows of samples.
    fn samples(
        &self,
        pipeline: &OwnPipeline<'_>,
        shot: &Shot<'_>,
        method: ParallaxMethod,
        rows: Range<u32>,
    ) -> Result<Vec<u32>> {
        let across = shot.count[0];
        let params = params(shot, method, rows.start);
        let rows = rows.len() as u32;
        // A NaN is no colour.
        let poison = vec![f32::NAN.to_bits(); WORDS * across as usize * rows as usize];
        let [heights, parallax, x, y, z] = self.0.each_ref().map(|(binding, words)| (*binding, words.as_slice()));
        let buffers = [
            (Binding::Uniform, params.as_slice()),
            heights,
            parallax,
            x,
            y,
            z,
            (Binding::Sampler(sampled(shot.material.heights().edges())), &[]),
            (Binding::ReadWrite, &poison),
        ];
        let written = pipeline.run(&buffers, [across.div_ceil(GROUP), rows.div_ceil(GROUP), 1])?;
        Ok(written.into_iter().flatten().collect())
    }
}

/// The edges of maps that are unfolded.
fn sampled(edges: Edges) -> Edges {
    let sampled = |edge| if edge == Edge::Mirror { Edge::Wrap } else { edge };
    Edges { x: sampled(edges.x), y: sampled(edges.y) }
}

/// The words of the kernel's parameters, in their order.
fn params(shot: &Shot<'_>, method: ParallaxMethod, first_row: u32) -> Vec<u32> {
    let (rays, look, material) = (shot.rays(), shot.look, shot.material);
    let vectors = [rays.eye, rays.ahead, rays.right, rays.down, look.light.direction(), look.low, look.high];
    let mut words: Vec<u32> = vectors.iter().flat_map(|&[x, y, z]| [x, y, z, 0.0]).map(f32::to_bits).collect();
    let (edges, size) = (material.heights().edges(), material.size());
    let share = |edge, texels: usize| texels as f32 / unfolded(edge, texels) as f32;
    let share = [share(edges.x, size.width()), share(edges.y, size.height())];
    let on_device = |offset: [f32; 2]| [0, 1].map(|axis| offset[axis] * share[axis]);
    let scales = [on_device(material.scale_in_uv()), on_device(material.step(method))];
    words.extend(scales.into_iter().flatten().map(f32::to_bits));
    words.extend([shot.count[0], shot.count[1], first_row, u32::from(shot.surface == Surface::Flat)]);
    words.extend(method.words());
    words.extend([look.ambient, look.highlight, look.shininess, rays.proportion].map(f32::to_bits));
    words.extend([share[0], share[1], 0.0, 0.0].map(f32::to_bits));
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Grid, HeightMap};
    use crate::material::Material;
    use crate::ops::bake::BakeOptions;
    use crate::preview::{Camera, Look};
    use crate::{Baker, Scale};
    use naga::{ScalarKind, TypeInner};

    /// The kinds of the words of the kernel's parameters, in their order; gaps between members are none.
    fn kinds(module: &naga::Module) -> Vec<ScalarKind> {
        let (params, _) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Params")).unwrap();
        kinds_of(module, params)
    }

    fn kinds_of(module: &naga::Module, ty: naga::Handle<naga::Type>) -> Vec<ScalarKind> {
        match &module.types[ty].inner {
            TypeInner::Scalar(scalar) => vec![scalar.kind],
            TypeInner::Vector { size, scalar } => vec![scalar.kind; *size as usize],
            TypeInner::Struct { members, span } => {
                let mut kinds = Vec::new();
                for member in members {
                    assert_eq!(member.offset as usize, 4 * kinds.len(), "{:?}", member.name);
                    kinds.extend(kinds_of(module, member.ty));
                }
                assert_eq!(*span as usize, 4 * kinds.len());
                kinds
            }
            other => panic!("{other:?}"),
        }
    }

    /// Parameters are told apart by their values: floats are none that an integer of a picture is.
    #[test]
    fn the_kernels_parameters_are_the_hosts() {
        let module = naga::front::wgsl::parse_str(WGSL).unwrap();
        let mut validator =
            naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
        validator.validate(&module).unwrap();
        assert!(!module.types.iter().any(|(_, ty)| matches!(ty.inner, TypeInner::Atomic(_))));
        assert_eq!(
            (&*module.entry_points[0].name, module.entry_points[0].workgroup_size),
            ("preview", [GROUP, GROUP, 1])
        );

        let heights = HeightMap::from(Grid::from_fn(8, 8, |x, y| (x * y) as u8).unwrap());
        let options = BakeOptions { scale: Scale::texels(3), ..Default::default() };
        let material = Material::bake(&Baker::cpu(), &heights, &options).unwrap();
        let camera = Camera { elevation: 30.0, width: 0.5 };
        let method = ParallaxMethod::Plane { limit: 3.0 };
        let surface = Surface::Mapped(method);
        let shot = Shot { material: &material, surface, camera, look: Look::default(), count: [20, 10] };
        let is_float = |word: &u32| *word == 0 || f32::from_bits(*word).is_normal();
        for (i, (word, kind)) in params(&shot, method, 5).iter().zip(kinds(&module)).enumerate() {
            let fits = match kind {
                ScalarKind::Float => is_float(word),
                _ => *word < 1 << 20,
            };
            assert!(fits, "word {i} is {word:#x}, a {kind:?}");
        }
        assert_eq!(params(&shot, method, 5).len(), kinds(&module).len());
    }
}
