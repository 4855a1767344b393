//! Textures on GPUs: bytes in, and what a fragment shader sees of each texel.
//!
//! A fragment shader, since SwiftShader decodes blocks where something is drawn and never where a compute shader is
//! dispatched (`Renderer::draw` calls `DescriptorSet::PrepareForSampling`, `ComputeProgram::run` does not).

use super::made::{Kind, Level};
use crate::support::{Gpu, extent, gpus};
use texbake::Size;
use texbake::gpu::wgpu::{self, TextureFormat as Format, TextureUsages};

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

/// Devices with the formats of all kinds that they have.
pub fn devices() -> Vec<(&'static str, Gpu)> {
    gpus(wgpu::Features::TEXTURE_COMPRESSION_BC | wgpu::Features::TEXTURE_FORMAT_16BIT_NORM)
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

/// Whether a device has the format of this kind.
pub fn has(gpu: &Gpu, kind: &Kind) -> bool {
    gpu.device.features().contains(format(kind).required_features())
}

/// The texels of each level, as a shader sees them; NaN where none was drawn.
pub fn load(gpu: &Gpu, kind: &Kind, levels: &[Level], bytes: &[Vec<u8>]) -> Vec<Vec<[f32; 4]>> {
    let texture = upload(gpu, kind, levels, bytes);
    // Not every format is filtered.
    let sample_type = wgpu::TextureSampleType::Float { filterable: false };
    let view_dimension = wgpu::TextureViewDimension::D2;
    let source = wgpu::BindGroupLayoutEntry {
        binding: 0,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false },
        count: None,
    };
    let pipeline = gpu.pipeline(LOAD.into(), Some(&[source]), DRAWN);
    let nan = f64::from(f32::NAN.to_bits());
    let nothing = wgpu::Color { r: nan, g: nan, b: nan, a: nan };
    let load = |(at, level)| {
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: at as u32,
            mip_level_count: Some(1),
            ..Default::default()
        });
        let drawn = gpu.texture(size(level), 1, DRAWN, TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC);
        gpu.draw(&pipeline, [wgpu::BindingResource::TextureView(&view)], &drawn, nothing);
        let bytes = gpu.read_texture(&drawn, 16);
        let floats: Vec<f32> = bytes.chunks_exact(4).map(|word| f32::from_le_bytes(word.try_into().unwrap())).collect();
        floats.chunks_exact(4).map(|texel| texel.try_into().unwrap()).collect()
    };
    levels.iter().enumerate().map(load).collect()
}

fn upload(gpu: &Gpu, kind: &Kind, levels: &[Level], bytes: &[Vec<u8>]) -> wgpu::Texture {
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
    let texture = gpu.texture(size(&levels[0]), levels.len(), format(kind), usage);
    let side = if kind.blocks.is_some() { 4 } else { 1 };
    for (at, (level, bytes)) in levels.iter().zip(bytes).enumerate() {
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(kind.sizes(level).1 as u32),
            rows_per_image: Some(level.height.div_ceil(side) as u32),
        };
        let whole = Size::new(level.width.next_multiple_of(side), level.height.next_multiple_of(side)).unwrap();
        let target = wgpu::TexelCopyTextureInfo { mip_level: at as u32, ..texture.as_image_copy() };
        gpu.queue.write_texture(target, bytes, layout, extent(whole));
    }
    texture
}

fn size(level: &Level) -> Size {
    Size::new(level.width, level.height).unwrap()
}
