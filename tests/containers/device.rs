//! Textures on GPUs: bytes in, and what a fragment shader sees of each texel.
//!
//! A fragment shader, since SwiftShader decodes blocks where something is drawn and never where a compute shader is
//! dispatched (`Renderer::draw` calls `DescriptorSet::PrepareForSampling`, `ComputeProgram::run` does not).

use super::made::{Kind, Level};
use crate::support::every_baker;
use texbake::gpu::wgpu::{self, TextureFormat as Format};

const LOAD: &str = "
@group(0) @binding(0) var source: texture_2d<f32>;
@vertex fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(corner & 1u) * 4.0 - 1.0, f32(corner & 2u) * 2.0 - 1.0, 0.0, 1.0);
}
@fragment fn load(@builtin(position) at: vec4<f32>) -> @location(0) vec4<u32> {
    return bitcast<vec4<u32>>(textureLoad(source, vec2<i32>(at.xy), 0));
}";

/// What is drawn into: the bits of floats, which OpenGL draws where it draws no floats.
const DRAWN: Format = Format::Rgba32Uint;

/// A device, by the name of its baker.
pub struct Gpu {
    pub name: &'static str,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// Devices of the same names as the bakers', with what they have of these formats.
pub fn gpus() -> Vec<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let names = every_baker().iter().filter_map(|subject| Some((subject.name, subject.name.split_once(':')?)));
    let open = |(name, (api, adapter)): (&'static str, (&str, &str))| {
        let backends = if api == "gl" { wgpu::Backends::GL } else { wgpu::Backends::VULKAN };
        let adapters = pollster::block_on(instance.enumerate_adapters(backends));
        let adapter = adapters.into_iter().find(|it| it.get_info().name.to_lowercase().contains(adapter)).unwrap();
        let wanted = wgpu::Features::TEXTURE_COMPRESSION_BC | wgpu::Features::TEXTURE_FORMAT_16BIT_NORM;
        let descriptor = wgpu::DeviceDescriptor {
            required_features: wanted & adapter.features(),
            required_limits: wgpu::Limits::downlevel_defaults(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        Gpu { name, device, queue }
    };
    names.map(open).collect()
}

fn format(kind: &Kind) -> Format {
    match kind.vulkan {
        9 => Format::R8Unorm,
        16 => Format::Rg8Unorm,
        37 => Format::Rgba8Unorm,
        10 => Format::R8Snorm,
        17 => Format::Rg8Snorm,
        38 => Format::Rgba8Snorm,
        70 => Format::R16Unorm,
        77 => Format::Rg16Unorm,
        91 => Format::Rgba16Unorm,
        71 => Format::R16Snorm,
        78 => Format::Rg16Snorm,
        92 => Format::Rgba16Snorm,
        76 => Format::R16Float,
        83 => Format::Rg16Float,
        97 => Format::Rgba16Float,
        100 => Format::R32Float,
        103 => Format::Rg32Float,
        109 => Format::Rgba32Float,
        139 => Format::Bc4RUnorm,
        140 => Format::Bc4RSnorm,
        141 => Format::Bc5RgUnorm,
        142 => Format::Bc5RgSnorm,
        145 => Format::Bc7RgbaUnorm,
        other => panic!("format {other}"),
    }
}

impl Gpu {
    /// Whether it has the format of this kind.
    pub fn has(&self, kind: &Kind) -> bool {
        self.device.features().contains(format(kind).required_features())
    }

    /// The texels of each level, as a shader sees them; NaN where none was drawn.
    pub fn load(&self, kind: &Kind, levels: &[Level], bytes: &[Vec<u8>]) -> Vec<Vec<[f32; 4]>> {
        let texture = self.upload(kind, levels, bytes);
        let pipeline = self.pipeline();
        let load = |(at, level)| {
            let view = texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level: at as u32,
                mip_level_count: Some(1),
                ..Default::default()
            });
            self.draw(&pipeline, &view, level)
        };
        levels.iter().enumerate().map(load).collect()
    }

    fn upload(&self, kind: &Kind, levels: &[Level], bytes: &[Vec<u8>]) -> wgpu::Texture {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            mip_level_count: levels.len() as u32,
            ..descriptor(&levels[0], format(kind), wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST)
        });
        let side = if kind.blocks.is_some() { 4 } else { 1 };
        for (at, (level, bytes)) in levels.iter().zip(bytes).enumerate() {
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(kind.sizes(level).1 as u32),
                rows_per_image: Some(level.height.div_ceil(side) as u32),
            };
            let whole = extent(level.width.next_multiple_of(side), level.height.next_multiple_of(side));
            let target = wgpu::TexelCopyTextureInfo { mip_level: at as u32, ..texture.as_image_copy() };
            self.queue.write_texture(target, bytes, layout, whole);
        }
        texture
    }

    fn pipeline(&self) -> wgpu::RenderPipeline {
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(LOAD.into()),
        });
        let source = wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let group =
            self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &[source] });
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            bind_group_layouts: &[Some(&group)],
            ..Default::default()
        });
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("cover"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("load"),
                compilation_options: Default::default(),
                targets: &[Some(DRAWN.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    fn draw(&self, pipeline: &wgpu::RenderPipeline, source: &wgpu::TextureView, level: &Level) -> Vec<[f32; 4]> {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let drawn = self.device.create_texture(&descriptor(level, DRAWN, usage));
        let row_bytes = 16 * level.width;
        let stride = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let read = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: (stride * level.height) as u64,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(source) }],
        });
        let nan = f64::from(f32::NAN.to_bits());
        let nothing = wgpu::Color { r: nan, g: nan, b: nan, a: nan };
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &drawn.create_view(&Default::default()),
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
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride as u32), rows_per_image: None };
        let into = wgpu::TexelCopyBufferInfo { buffer: &read, layout };
        encoder.copy_texture_to_buffer(drawn.as_image_copy(), into, drawn.size());
        self.queue.submit([encoder.finish()]);
        read.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
        let bytes = read.get_mapped_range(..).expect("mapped").to_vec();
        let rows = bytes.chunks_exact(stride).flat_map(|row| row[..row_bytes].chunks_exact(4));
        let floats: Vec<f32> = rows.map(|word| f32::from_le_bytes(word.try_into().unwrap())).collect();
        floats.chunks_exact(4).map(|texel| texel.try_into().unwrap()).collect()
    }
}

fn extent(width: usize, height: usize) -> wgpu::Extent3d {
    wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 }
}

/// A texture of this level alone.
fn descriptor(level: &Level, format: Format, usage: wgpu::TextureUsages) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: None,
        size: extent(level.width, level.height),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    }
}
