//! Files on GPUs: every level of every kind is uploaded as it stands in the file, and each texel is loaded by a shader.
//!
//! What a device's float is off by: nothing for floats; for normalised codes c of at most 16 bits the roundings of c / L
//! to f32, of which ten steps of 2^-24 would be 1/25 of a code: 1/20 is allowed. Of BC4 and BC5 blocks the interpolation's
//! precision is the device's own: half a step of the block's range over 7, and a code beside it, since lavapipe
//! interpolates in whole numbers, besides the same roundings. What BC7 blocks decode to is defined to the bit.

use super::made::{KINDS, Kind, Level, Made, bc7};
use super::parsed::by_specification;
use crate::io::support::Folder;
use crate::support::every_baker;
use texbake::Codes;
use texbake::Encoding::{Float, Snorm};
use texbake::gpu::wgpu::{self, TextureFormat as Format};

const LOAD: &str = "
@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var<storage, read_write> texels: array<vec4<f32>>;
@compute @workgroup_size(8, 8) fn load(@builtin(global_invocation_id) at: vec3<u32>) {
    let size = textureDimensions(source);
    if (at.x < size.x && at.y < size.y) {
        texels[at.y * size.x + at.x] = textureLoad(source, vec2<i32>(at.xy), 0);
    }
}";

struct Gpu {
    name: &'static str,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// Devices of the same names as the bakers', with what they have of these formats.
fn gpus() -> Vec<Gpu> {
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
    fn has(&self, kind: &Kind) -> bool {
        self.device.features().contains(format(kind).required_features())
    }

    /// The texels of each level, as a shader sees them.
    fn load(&self, kind: &Kind, levels: &[Level], bytes: &[Vec<u8>]) -> Vec<Vec<[f32; 4]>> {
        let extent = |level: &Level| wgpu::Extent3d {
            width: level.width as u32,
            height: level.height as u32,
            depth_or_array_layers: 1,
        };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent(&levels[0]),
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: format(kind),
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let side = if kind.blocks.is_some() { 4 } else { 1 };
        for (at, (level, bytes)) in levels.iter().zip(bytes).enumerate() {
            let (_, row) = kind.sizes(level);
            let rows = level.height.div_ceil(side);
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row as u32),
                rows_per_image: Some(rows as u32),
            };
            let whole = wgpu::Extent3d {
                width: level.width.next_multiple_of(side) as u32,
                height: level.height.next_multiple_of(side) as u32,
                depth_or_array_layers: 1,
            };
            let target = wgpu::TexelCopyTextureInfo { mip_level: at as u32, ..texture.as_image_copy() };
            self.queue.write_texture(target, bytes, layout, whole);
        }
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(LOAD.into()),
        });
        let float = wgpu::TextureSampleType::Float { filterable: false };
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        };
        let texels_type = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: false },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let texture_type = wgpu::BindingType::Texture {
            sample_type: float,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let group_layout = self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[entry(0, texture_type), entry(1, texels_type)],
        });
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            bind_group_layouts: &[Some(&group_layout)],
            ..Default::default()
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&layout),
            module: &module,
            entry_point: Some("load"),
            compilation_options: Default::default(),
            cache: None,
        });
        let load = |at: usize, level: &Level| {
            let size = (level.width * level.height * 16) as u64;
            let buffer = |usage| {
                let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
                self.device.create_buffer(&descriptor)
            };
            let texels =
                buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST);
            let read = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
            self.queue.write_buffer(&texels, 0, &vec![0xff; size as usize]);
            let view = texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level: at as u32,
                mip_level_count: Some(1),
                ..Default::default()
            });
            let bindings = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &group_layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                    wgpu::BindGroupEntry { binding: 1, resource: texels.as_entire_binding() },
                ],
            });
            let mut encoder = self.device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            pass.dispatch_workgroups(level.width.div_ceil(8) as u32, level.height.div_ceil(8) as u32, 1);
            drop(pass);
            encoder.copy_buffer_to_buffer(&texels, 0, &read, 0, size);
            self.queue.submit([encoder.finish()]);
            read.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
            self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
            let bytes = read.get_mapped_range(..).expect("mapped").to_vec();
            let floats = bytes.chunks_exact(4).map(|word| f32::from_le_bytes(word.try_into().unwrap()));
            floats.collect::<Vec<_>>().chunks_exact(4).map(|texel| texel.try_into().unwrap()).collect()
        };
        levels.iter().enumerate().map(|(at, level)| load(at, level)).collect()
    }
}

/// A code as a number, and the code of 1.
fn number(kind: &Kind, codes: &Codes, at: usize) -> (f64, f64) {
    let signed = kind.encoding == Snorm;
    match codes {
        Codes::U8(codes) if signed => ((codes[at] as i8).into(), 127.0),
        Codes::U8(codes) => (codes[at].into(), 255.0),
        Codes::U16(codes) if signed => ((codes[at] as i16).into(), 32767.0),
        Codes::U16(codes) => (codes[at].into(), 65535.0),
        Codes::F16(codes) => (codes[at].to_f64(), 1.0),
        Codes::F32(codes) => (codes[at].into(), 1.0),
    }
}

/// The greatest error of the components that the file keeps, in codes, less what their blocks allow.
fn excess(kind: &Kind, level: &Level, texels: &[[f32; 4]]) -> f64 {
    let kept = match kind.vulkan {
        139 | 140 => 1,
        141 | 142 => 2,
        _ => kind.channels,
    };
    let code =
        |x: usize, y: usize, channel| number(kind, &level.codes, (y * level.width + x) * kind.channels + channel);
    let mut greatest = f64::MIN;
    for y in 0..level.height {
        for x in 0..level.width {
            for (channel, value) in texels[y * level.width + x].iter().enumerate().take(kept) {
                let (expected, one) = code(x, y, channel);
                let error = (f64::from(*value) * one - expected).abs();
                let allowed = match (kind.blocks, kind.encoding) {
                    (Some(_), _) => {
                        let block = (y / 4 * 4..(y / 4 * 4 + 4).min(level.height))
                            .flat_map(|y| (x / 4 * 4..(x / 4 * 4 + 4).min(level.width)).map(move |x| (x, y)));
                        let codes: Vec<f64> = block.map(|(x, y)| code(x, y, channel).0).collect();
                        let range = codes.iter().fold(f64::MIN, |a, b| a.max(*b))
                            - codes.iter().fold(f64::MAX, |a, b| a.min(*b));
                        range / 14.0 + 1.0 + 1.0 / 20.0
                    }
                    (None, Float) => 0.0,
                    _ => 1.0 / 20.0,
                };
                greatest = greatest.max(error - allowed);
            }
        }
    }
    greatest
}

#[test]
fn every_device_samples_what_was_written() {
    let folder = Folder::new();
    let mut with_blocks = 0;
    for gpu in gpus() {
        for kind in KINDS.iter().filter(|kind| gpu.has(kind)) {
            // Their largest level has whole blocks, which WebGPU asks for; the smaller ones do not.
            for (size, container) in [((64, 64), "ktx2"), ((20, 12), "dds"), ((4, 36), "ktx2")] {
                let made = Made::new(&folder, *kind, size, true, container);
                let bytes = by_specification(&made.bytes(), &made).unwrap();
                let loaded = gpu.load(kind, &made.levels, &bytes);
                for ((level, texels), blocks) in made.levels.iter().zip(&loaded).zip(&bytes) {
                    if kind.vulkan == 145 {
                        let codes: Vec<u8> = texels.iter().flatten().map(|v| (v * 255.0).round() as u8).collect();
                        assert!(codes == bc7(blocks, level), "{}: {}", gpu.name, made.path.display());
                        continue;
                    }
                    let excess = excess(kind, level, texels);
                    assert!(excess <= 0.0, "{}: {}: {excess} too much", gpu.name, made.path.display());
                }
                with_blocks += usize::from(kind.blocks.is_some());
                // The comparison is awake.
                let mut other = loaded[0].clone();
                other[7][0] += 0.5;
                assert!(kind.vulkan == 145 || excess(kind, &made.levels[0], &other) > 0.0);
            }
        }
        println!("{}: {} kinds", gpu.name, KINDS.iter().filter(|kind| gpu.has(kind)).count());
    }
    let required = std::env::var("TEXBAKE_REQUIRE_GPU").is_ok_and(|value| value == "1");
    assert!(!required || with_blocks > 0, "no device has blocks");
}
