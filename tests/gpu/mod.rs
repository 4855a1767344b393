//! Bakes on a device of the host's: the same bytes from buffers and textures, in the host's own encoder.

use crate::support::{FORMATS, Gpu, Image, Random, every_baker, extent, map_f32, map_u8, map_u16, options};
use std::sync::OnceLock;
use texbake::gpu::{CodeTarget, HeightSource, Hosted, wgpu};
use texbake::{
    Baker, Channels, CodesRef, Depth, Edge, Edges, Encoding, HeightMap, HeightType, NormalFormat, NormalMap,
    NormalOptions, Size,
};
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

/// Lavapipe, opened as a host program would; `None` where it is not installed.
fn host() -> Option<&'static Gpu> {
    static HOST: OnceLock<Option<Gpu>> = OnceLock::new();
    HOST.get_or_init(|| open_host(wgpu::Limits::default())).as_ref()
}

/// Another one, with these limits.
fn open_host(limits: wgpu::Limits) -> Option<Gpu> {
    let host = Gpu::open("vulkan:llvmpipe", wgpu::Features::TEXTURE_FORMAT_16BIT_NORM, limits);
    if host.is_none() {
        println!("not tested: no lavapipe to host a bake");
        assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none_or(|value| value != "1"), "no lavapipe");
    }
    host
}

/// Writes rows of `row` bytes, each padded to `pitch`.
fn write(host: &Gpu, buffer: &wgpu::Buffer, bytes: &[u8], row: usize, pitch: usize) {
    let mut padded = Vec::new();
    for row in bytes.chunks(row) {
        padded.extend_from_slice(row);
        padded.resize(padded.len().next_multiple_of(pitch), 0xa5);
    }
    host.queue.write_buffer(buffer, 0, &padded);
}

fn height_bytes(map: &HeightMap) -> Vec<u8> {
    match map.heights() {
        texbake::Heights::U8(heights) => heights.to_vec(),
        texbake::Heights::U16(heights) => heights.iter().flat_map(|height| height.to_ne_bytes()).collect(),
        texbake::Heights::F32(heights) => heights.iter().flat_map(|height| height.to_ne_bytes()).collect(),
    }
}

/// One map of each depth; the width leaves every padding unfilled.
fn maps() -> [HeightMap; 3] {
    let mut random = Random::new(21);
    [
        map_u8(61, 23, |_, _| random.bits() as u8),
        map_u16(62, 19, |_, _| random.bits() as u16),
        map_f32(63, 17, |_, _| random.bits() as u16 as f32 / 9.0),
    ]
}

fn code_bytes(map: &NormalMap) -> &[u8] {
    match map.codes() {
        CodesRef::U8(codes) => codes,
        codes => codes.bytes(),
    }
}

/// The rows that a host gets in a buffer, without padding.
fn baked(host: &Gpu, hosted: &Hosted, map: &HeightMap, options: &NormalOptions) -> Vec<u8> {
    let bake = hosted.normal(map.size(), map.height_type(), options).unwrap();
    let size = map.size();
    let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
    let heights = host.buffer(bake.heights_row_bytes() * size.height(), usage);
    let codes = host.buffer(bake.codes_row_bytes() * size.height(), usage);
    write(host, &heights, &height_bytes(map), size.width() * map.height_type().bytes(), bake.heights_row_bytes());

    let mut encoder = host.device.create_command_encoder(&Default::default());
    bake.encode(&mut encoder, HeightSource::Buffer(heights.slice(..)), CodeTarget::Buffer(codes.slice(..))).unwrap();
    host.queue.submit([encoder.finish()]);
    let row = size.width() * options.format.channels.count() * options.format.depth.bytes();
    host.read(&codes).chunks(bake.codes_row_bytes()).flat_map(|padded| padded[..row].to_vec()).collect()
}

#[test]
fn buffers_get_the_reference_bytes() {
    let Some(host) = host() else { return };
    let hosted = Hosted::new(&host.device, &host.queue).unwrap();
    let edges = Edges { x: Edge::Mirror, y: Edge::Wrap };
    for map in maps() {
        for format in FORMATS {
            for channels in [Channels::Xyz, Channels::Xy] {
                let options = NormalOptions { edges, ..options("7/3", NormalFormat { channels, ..format }) };
                let expected = Baker::reference().normal(&map, &options).unwrap();
                let rows = baked(host, &hosted, &map, &options);
                assert!(rows == code_bytes(&expected), "{} heights, {options:?}", map.height_type());
            }
        }
    }
}

#[test]
fn a_device_of_few_workgroups_gets_the_reference_bytes() {
    // A map of 23 rows takes eight dispatches.
    let limits = wgpu::Limits { max_compute_workgroups_per_dimension: 3, ..Default::default() };
    let Some(host) = open_host(limits) else { return };
    let hosted = Hosted::new(&host.device, &host.queue).unwrap();
    for map in maps() {
        for edges in [Edges { x: Edge::Mirror, y: Edge::Wrap }, Edges::both(Edge::Clamp)] {
            let options = NormalOptions { edges, ..options("7/3", NormalFormat::default()) };
            let expected = Baker::reference().normal(&map, &options).unwrap();
            assert!(baked(&host, &hosted, &map, &options) == code_bytes(&expected), "{edges:?}");
        }
    }
    let wide = hosted.normal(Size::new(769, 1).unwrap(), HeightType::U8, &NormalOptions::default());
    let error = wide.err().expect("four workgroups").to_string();
    assert!(error.ends_with("rows of 769 texels are too wide for it: 4 workgroups where 3 are allowed"), "{error}");
}

#[test]
fn textures_get_the_reference_codes_and_an_opaque_alpha() {
    let Some(host) = host() else { return };
    let hosted = Hosted::new(&host.device, &host.queue).unwrap();
    let sources = [TextureFormat::R8Unorm, TextureFormat::R16Unorm, TextureFormat::R32Float];
    for (map, source) in maps().into_iter().zip(sources) {
        for (encoding, depth, target, alpha) in [
            (Encoding::Unorm, Depth::Bits8, TextureFormat::Rgba8Unorm, vec![255]),
            (Encoding::Snorm, Depth::Bits8, TextureFormat::Rgba8Snorm, vec![127]),
            (Encoding::Biased, Depth::Bits8, TextureFormat::Rgba8Uint, vec![255]),
            (Encoding::Unorm, Depth::Bits16, TextureFormat::Rgba16Unorm, vec![255, 255]),
            (Encoding::Float, Depth::Float16, TextureFormat::Rgba16Float, vec![0, 0x3c]),
            (Encoding::Float, Depth::Float32, TextureFormat::Rgba32Float, 1f32.to_le_bytes().to_vec()),
        ] {
            let format = NormalFormat { encoding, depth, ..Default::default() };
            let options = NormalOptions { edges: Edges::both(Edge::Clamp), ..options("24", format) };
            let size = map.size();
            let heights = host.texture(size, 1, source, TextureUsages::COPY_SRC | TextureUsages::COPY_DST);
            let row = (size.width() * map.height_type().bytes()) as u32;
            let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
            host.queue.write_texture(heights.as_image_copy(), &height_bytes(&map), layout, extent(size));
            let codes = host.texture(size, 1, target, TextureUsages::COPY_SRC | TextureUsages::COPY_DST);

            let bake = hosted.normal(size, map.height_type(), &options).unwrap();
            let mut encoder = host.device.create_command_encoder(&Default::default());
            bake.encode(&mut encoder, HeightSource::Texture(&heights), CodeTarget::Texture(&codes)).unwrap();
            host.queue.submit([encoder.finish()]);

            let expected = Baker::reference().normal(&map, &options).unwrap();
            let texels = code_bytes(&expected).chunks(3 * depth.bytes());
            let with_alpha: Vec<u8> = texels.flat_map(|texel| [texel, &alpha].concat()).collect();
            let baked = host.read_texture(&codes, 4 * depth.bytes());
            assert!(baked == with_alpha, "{} heights to {target:?}", map.height_type());
        }
    }
}

#[test]
fn resources_that_do_not_fit_are_errors_that_say_so() {
    let Some(host) = host() else { return };
    let hosted = Hosted::new(&host.device, &host.queue).unwrap();
    let size = Size::new(8, 8).unwrap();
    let bake = hosted.normal(size, HeightType::U16, &NormalOptions::default()).unwrap();
    let storage = |bytes| host.buffer(bytes, BufferUsages::STORAGE);
    let texture = |format, usage| host.texture(size, 1, format, usage);
    let (good, small) = (storage(1024), storage(64));
    let copies = TextureUsages::COPY_SRC | TextureUsages::COPY_DST;
    let srgb = texture(TextureFormat::Rgba8UnormSrgb, copies);
    let unusable = texture(TextureFormat::Rgba8Unorm, TextureUsages::TEXTURE_BINDING);
    let wide = host.texture(Size::new(9, 8).unwrap(), 1, TextureFormat::R16Unorm, copies);
    let unbound = host.buffer(1024, BufferUsages::COPY_DST);
    for (heights, codes, message) in [
        (
            HeightSource::Buffer(small.slice(..)),
            CodeTarget::Buffer(good.slice(..)),
            "heights buffer is 64 bytes: it must be at least 128 bytes",
        ),
        (
            HeightSource::Buffer(good.slice(..)),
            CodeTarget::Buffer(small.slice(..)),
            "codes buffer is 64 bytes: it must be at least 192 bytes",
        ),
        (
            HeightSource::Texture(&wide),
            CodeTarget::Buffer(good.slice(..)),
            "heights texture is 9 x 8 x 1: it must be 8 x 8 x 1 texels",
        ),
        (
            HeightSource::Buffer(good.slice(..)),
            CodeTarget::Texture(&srgb),
            "codes texture is Rgba8UnormSrgb: it must be Rgba8Unorm or Rgba8Uint",
        ),
        (HeightSource::Buffer(good.slice(..)), CodeTarget::Texture(&unusable), "usable as"),
        (HeightSource::Buffer(unbound.slice(..)), CodeTarget::Buffer(good.slice(..)), "STORAGE"),
    ] {
        let mut encoder = host.device.create_command_encoder(&Default::default());
        let error = bake.encode(&mut encoder, heights, codes).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
        let scope = host.device.push_error_scope(wgpu::ErrorFilter::Validation);
        encoder.finish();
        let left = pollster::block_on(scope.pop());
        assert!(left.is_none(), "the encoder is as it was: {left:?}");
    }
}

#[test]
fn an_adapter_that_is_not_there_is_an_error_that_names_what_is() {
    let error = Baker::gpu(Some("voodoo")).err().expect("no such adapter").to_string();
    assert!(error.starts_with("adapter \"voodoo\": "), "{error}");
}

#[test]
fn fast_is_within_one_code_of_exact() {
    let maps = maps();
    for subject in every_baker() {
        for map in &maps {
            for format in FORMATS.into_iter().filter(|format| format.encoding != Encoding::Float) {
                let exact = options("24", format);
                let fast = NormalOptions { precision: texbake::Precision::Fast, ..exact };
                let [a, b] = [&exact, &fast].map(|options| Image::from(&subject.baker.normal(map, options).unwrap()));
                let off = (0..a.bits.len()).map(|i| (a.number(i) - b.number(i)).abs());
                let worst = off.fold(0.0, f64::max);
                assert!(worst <= 1.0, "{}, {} heights, {format:?}: {worst} codes", subject.name, map.height_type());
            }
        }
    }
}
