//! A kernel of somebody else's on a device.

use super::device::Device;
use super::transfer::Mapping;
use crate::error::{Error, Result};
use crate::map::{Edge, Edges, Size};
use half::f16;
use std::borrow::Cow;
use wgpu::util::{BufferInitDescriptor, DeviceExt, TextureDataOrder};
use wgpu::{
    BindingResource, BufferUsages, ComputePipelineDescriptor, MapMode, PipelineCompilationOptions, TextureFormat,
    TextureUsages,
};

/// What a binding is to a kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Binding {
    /// `var<uniform>`.
    Uniform,
    /// `var<storage, read>`.
    Read,
    /// `var<storage, read_write>`.
    ReadWrite,
    /// `texture_2d<f32>` of one level and one channel, which reads as r: a word is the f32 of a texel, row by row.
    Texture(Size),
    /// `sampler`: linear between texels, and beyond the borders as the edges say, which wrap or clamp: the mirror of a
    /// sampler repeats the border texel, and that of [`Edge`] does not. It has no words.
    ///
    /// Where the device does not filter textures of f32, or wgpu does not know that it does (on desktop OpenGL), a kernel
    /// with a sampler has textures of f16, and their texels must be such: no value is changed.
    Sampler(Edges),
}

impl Binding {
    /// Fails if it cannot hold so many words.
    pub(crate) fn check_words(self, words: usize) -> Result<()> {
        match self {
            Self::Texture(size) if words != size.texels() => {
                let range = format!("{}, the texels of {size}", size.texels());
                Err(Error::parameter("words of a texture", words, range))
            }
            Self::Sampler(_) if words > 0 => Err(Error::parameter("words of a sampler", words, "0")),
            Self::Sampler(edges) if [edges.x, edges.y].contains(&Edge::Mirror) => {
                Err(Error::parameter("edges of a sampler", edges, "wrap or clamp, for each axis"))
            }
            _ => Ok(()),
        }
    }
}

/// What stands for a binding's words on the device.
enum Bound {
    Buffer(wgpu::Buffer),
    Texture(wgpu::TextureView),
    Sampler(wgpu::Sampler),
}

impl Bound {
    fn resource(&self) -> BindingResource<'_> {
        match self {
            Self::Buffer(buffer) => buffer.as_entire_binding(),
            Self::Texture(view) => BindingResource::TextureView(view),
            Self::Sampler(sampler) => BindingResource::Sampler(sampler),
        }
    }
}

/// A compiled kernel.
pub(crate) struct OwnPipeline<'a> {
    device: &'a Device,
    pipeline: wgpu::ComputePipeline,
}

impl<'a> OwnPipeline<'a> {
    /// Compiles a kernel.
    ///
    /// # Errors
    /// [`crate::Error::Device`] with what the compiler says.
    pub(super) fn new(device: &'a Device, wgsl: &str, entry_point: &str, constants: &[(&str, f64)]) -> Result<Self> {
        let pipeline = device.guarded(|| {
            let source = wgpu::ShaderSource::Wgsl(Cow::Borrowed(wgsl));
            let module =
                device.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(entry_point), source });
            Ok(device.device.create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: None,
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: PipelineCompilationOptions { constants, ..Default::default() },
                cache: None,
            }))
        })?;
        Ok(Self { device, pipeline })
    }

    /// Runs it on buffers of words, bound in their order in group 0, and gives the words of those that it may write.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if a texture has not a word for each texel, or a sampler has any, or mirrors;
    /// [`crate::Error::Device`] if the buffers do not fit the kernel, the device does not filter what a texture holds, or
    /// it fails.
    pub fn run(&self, buffers: &[(Binding, &[u32])], workgroups: [u32; 3]) -> Result<Vec<Vec<u32>>> {
        buffers.iter().try_for_each(|(binding, words)| binding.check_words(words.len()))?;
        let is_filtered = buffers.iter().any(|(binding, _)| matches!(binding, Binding::Sampler(_)));
        let device = &self.device.device;
        let (downloads, submission) = self.device.guarded(|| {
            let upload = |&(binding, words): &(Binding, &[u32])| self.upload(binding, words, is_filtered);
            let bound = buffers.iter().map(upload).collect::<Result<Vec<Bound>>>()?;
            let entries: Vec<_> = (0..)
                .zip(&bound)
                .map(|(binding, bound)| wgpu::BindGroupEntry { binding, resource: bound.resource() })
                .collect();
            let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("own kernel"),
                layout: &self.pipeline.get_bind_group_layout(0),
                entries: &entries,
            });
            let mut encoder = device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            let [x, y, z] = workgroups;
            pass.dispatch_workgroups(x, y, z);
            drop(pass);
            let mut downloads = Vec::new();
            for (bound, (binding, _)) in bound.iter().zip(buffers) {
                let (Bound::Buffer(buffer), Binding::ReadWrite) = (bound, binding) else { continue };
                let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
                let size = buffer.size();
                let descriptor =
                    wgpu::BufferDescriptor { label: Some("download"), size, usage, mapped_at_creation: false };
                let download = device.create_buffer(&descriptor);
                encoder.copy_buffer_to_buffer(buffer, 0, &download, 0, size);
                downloads.push(download);
            }
            Ok((downloads, self.device.submit(None, encoder.finish())))
        })?;
        self.device.guarded(|| {
            let wanted = downloads.iter().map(|download| (download, MapMode::Read));
            Mapping::of_buffers(wanted, submission).wait(self.device)?;
            let words = |download: &wgpu::Buffer| {
                let view = download.get_mapped_range(..).map_err(|error| self.device.error(error))?;
                Ok(bytemuck::cast_slice(&view).to_vec())
            };
            downloads.iter().map(words).collect()
        })
    }

    fn upload(&self, binding: Binding, words: &[u32], is_filtered: bool) -> Result<Bound> {
        let device = &self.device.device;
        let usage = match binding {
            Binding::Uniform => BufferUsages::UNIFORM,
            Binding::Read => BufferUsages::STORAGE,
            Binding::ReadWrite => BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            Binding::Texture(size) => return self.texture(size, words, is_filtered).map(Bound::Texture),
            Binding::Sampler(edges) => return Ok(Bound::Sampler(device.create_sampler(&sampler(edges)))),
        };
        let contents = bytemuck::cast_slice(words);
        let buffer = device.create_buffer_init(&BufferInitDescriptor { label: Some("words"), contents, usage });
        Ok(Bound::Buffer(buffer))
    }

    fn texture(&self, size: Size, words: &[u32], is_filtered: bool) -> Result<wgpu::TextureView> {
        let Device { device, queue, .. } = self.device;
        let create = |format, texels: &[u8]| {
            let descriptor = texture(size, format);
            let texture = device.create_texture_with_data(queue, &descriptor, TextureDataOrder::default(), texels);
            Ok(texture.create_view(&Default::default()))
        };
        if !is_filtered || device.features().contains(wgpu::Features::FLOAT32_FILTERABLE) {
            return create(TextureFormat::R32Float, bytemuck::cast_slice(words));
        }
        let half = |word: &u32| Some(f16::from_f32(f32::from_bits(*word))).filter(|it| it.to_f32().to_bits() == *word);
        match words.iter().map(half).collect::<Option<Vec<f16>>>() {
            Some(halves) => create(TextureFormat::R16Float, bytemuck::cast_slice(&halves)),
            None => Err(self.device.error("it filters textures of f16 alone, and a texel is none")),
        }
    }
}

fn sampler(edges: Edges) -> wgpu::SamplerDescriptor<'static> {
    let address = |edge| match edge {
        Edge::Clamp => wgpu::AddressMode::ClampToEdge,
        Edge::Wrap | Edge::Mirror => wgpu::AddressMode::Repeat,
    };
    let filter = wgpu::FilterMode::Linear;
    wgpu::SamplerDescriptor {
        label: Some("linear"),
        address_mode_u: address(edges.x),
        address_mode_v: address(edges.y),
        address_mode_w: wgpu::AddressMode::Repeat,
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter: wgpu::MipmapFilterMode::Nearest,
        lod_min_clamp: 0.0,
        lod_max_clamp: 32.0,
        compare: None,
        anisotropy_clamp: 1,
        border_color: None,
    }
}

fn texture(size: Size, format: TextureFormat) -> wgpu::TextureDescriptor<'static> {
    // A size has at most 2^31 - 1 texels on a side; what is too large for the device is its error.
    let [width, height] = [size.width(), size.height()].map(|texels| texels as u32);
    wgpu::TextureDescriptor {
        label: Some("texels"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    }
}
