//! Devices of the tests' own, opened as a host program would, and what it takes to draw on them and to read them.

use super::every_baker;
use texbake::Size;
use texbake::gpu::wgpu::{self, BufferUsages, TextureUsages};

/// A device.
#[derive(Clone)]
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

/// Devices of the same names as the bakers', with what they have of these features.
pub fn gpus(features: wgpu::Features) -> Vec<(&'static str, Gpu)> {
    let names = every_baker().iter().map(|subject| subject.name).filter(|name| name.contains(':'));
    let open = |name| (name, Gpu::open(name, features, wgpu::Limits::downlevel_defaults()).expect("it was there"));
    names.map(open).collect()
}

impl Gpu {
    /// The device `api:adapter`, `None` if there is none, with what it has of these features.
    pub fn open(name: &str, features: wgpu::Features, required_limits: wgpu::Limits) -> Option<Self> {
        let (api, adapter) = name.split_once(':')?;
        let backends = if api == "gl" { wgpu::Backends::GL } else { wgpu::Backends::VULKAN };
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapters = pollster::block_on(instance.enumerate_adapters(backends));
        let adapter = adapters.into_iter().find(|it| it.get_info().name.to_lowercase().contains(adapter))?;
        let required_features = features & adapter.features();
        let descriptor = wgpu::DeviceDescriptor { required_features, required_limits, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).ok()?;
        Some(Self { device, queue })
    }

    pub fn buffer(&self, bytes: usize, usage: BufferUsages) -> wgpu::Buffer {
        let size = bytes as u64;
        self.device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    }

    /// A texture with `levels` mip levels.
    pub fn texture(
        &self,
        size: Size,
        levels: usize,
        format: wgpu::TextureFormat,
        usage: TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent(size),
            mip_level_count: levels as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// The bytes of a buffer.
    pub fn read(&self, buffer: &wgpu::Buffer) -> Vec<u8> {
        let copy = self.buffer(buffer.size() as usize, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
        copy.get_mapped_range(..).expect("mapped").to_vec()
    }

    /// The rows of a texture of one level, without padding.
    pub fn read_texture(&self, texture: &wgpu::Texture, texel_bytes: usize) -> Vec<u8> {
        let wgpu::Extent3d { width, height, .. } = texture.size();
        let row = width as usize * texel_bytes;
        let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let buffer = self.buffer(pitch * height as usize, BufferUsages::COPY_DST | BufferUsages::COPY_SRC);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch as u32), rows_per_image: None };
        let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
        self.queue.submit([encoder.finish()]);
        self.read(&buffer).chunks(pitch).flat_map(|padded| padded[..row].to_vec()).collect()
    }

    /// The one vertex and the one fragment function of `source`, for targets of `format`; bindings of group 0 are laid
    /// out as `entries` say, or as the functions use them.
    pub fn pipeline(
        &self,
        source: String,
        entries: Option<&[wgpu::BindGroupLayoutEntry]>,
        format: wgpu::TextureFormat,
    ) -> wgpu::RenderPipeline {
        let source = wgpu::ShaderSource::Wgsl(source.into());
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let layout = entries.map(|entries| {
            let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries };
            let group = self.device.create_bind_group_layout(&descriptor);
            let bind_group_layouts = &[Some(&group)];
            let descriptor = wgpu::PipelineLayoutDescriptor { bind_group_layouts, ..Default::default() };
            self.device.create_pipeline_layout(&descriptor)
        });
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: layout.as_ref(),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    /// Draws three vertices into `target`, which holds `nothing` elsewhere; bindings are those of group 0, from 0 on.
    pub fn draw<'a>(
        &self,
        pipeline: &wgpu::RenderPipeline,
        bindings: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
        target: &wgpu::Texture,
        nothing: wgpu::Color,
    ) {
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let entries: Vec<_> = (0..).zip(bindings).map(entry).collect();
        let layout = &pipeline.get_bind_group_layout(0);
        let group =
            self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.create_view(&Default::default()),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(nothing), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        self.queue.submit([encoder.finish()]);
    }
}

/// All of a texture of this size.
pub fn extent(size: Size) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size.width() as u32, height: size.height() as u32, depth_or_array_layers: 1 }
}
