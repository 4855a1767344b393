//! A bake inside a program that has a wgpu device of its own: from its texture to its texture, in its encoder.
//!
//!     cargo run --release --example 03_hosted

use texbake::gpu::{CodeTarget, HeightSource, Hosted, wgpu};
use texbake::{Edge, Edges, HeightType, NormalOptions, Scale, Size};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;

    let size = Size::new(512, 512)?;
    let texture = |format, usage| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 512, height: 512, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    };
    // The host would draw into the first and sample the second.
    let heights =
        texture(wgpu::TextureFormat::R32Float, wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::RENDER_ATTACHMENT);
    let normals =
        texture(wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING);

    let texbake = Hosted::new(&device, &queue)?;
    let options = NormalOptions { scale: Scale::texels(24), edges: Edges::both(Edge::Clamp), ..Default::default() };
    let bake = texbake.normal(size, HeightType::F32, &options)?;

    let mut encoder = device.create_command_encoder(&Default::default());
    bake.encode(&mut encoder, HeightSource::Texture(&heights), CodeTarget::Texture(&normals))?;
    queue.submit([encoder.finish()]);
    println!("recorded and submitted a bake of {size} texels on {}", adapter.get_info().name);
    Ok(())
}
