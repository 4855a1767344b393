//! The adapters of this machine, and which of them a user means.

use crate::error::{Error, Result};
use wgpu::{Adapter, AdapterInfo, Backends, DeviceType, Instance, InstanceDescriptor};

/// All adapters that can run compute kernels, the best first: discrete, integrated, virtual, then software ones.
pub(super) fn all() -> Vec<Adapter> {
    of(Backends::PRIMARY | Backends::GL)
}

/// The adapters that `auto` considers. OpenGL is left to those who name it: its drivers print to the console when they
/// are only asked what there is, and a GPU that has nothing newer is rarely faster than the CPU.
pub(super) fn primary() -> Vec<Adapter> {
    of(Backends::PRIMARY)
}

/// Whether this machine can have a real GPU. On Linux the driver of one has a node in /dev; where there is none, asking
/// for adapters would load drivers of software alone, which takes fifty milliseconds and as many megabytes. Drivers that
/// the user names to Vulkan's loader are asked in any case.
pub(super) fn can_be_real() -> bool {
    #[cfg(target_os = "linux")]
    {
        const NAMED_DRIVERS: [&str; 3] = ["VK_DRIVER_FILES", "VK_ADD_DRIVER_FILES", "VK_ICD_FILENAMES"];
        // Mesa's and most others; NVIDIA's; Windows' below Linux; those of phones and boards.
        const NODES: [(&str, &str); 6] = [
            ("/dev/dri", "renderD"),
            ("/dev", "nvidia"),
            ("/dev", "dxg"),
            ("/dev", "kgsl"),
            ("/dev", "mali"),
            ("/dev", "pvr"),
        ];
        let is_there = |(folder, prefix): &(&str, &str)| {
            let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
            entries.into_iter().any(|entry| entry.file_name().as_encoded_bytes().starts_with(prefix.as_bytes()))
        };
        NAMED_DRIVERS.iter().any(|name| std::env::var_os(name).is_some()) || NODES.iter().any(is_there)
    }
    #[cfg(not(target_os = "linux"))]
    true
}

fn of(backends: Backends) -> Vec<Adapter> {
    let descriptor = InstanceDescriptor { backends, ..InstanceDescriptor::new_without_display_handle() };
    let mut adapters = pollster::block_on(Instance::new(descriptor).enumerate_adapters(backends));
    adapters
        .retain(|adapter| adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS));
    adapters.sort_by_key(|adapter| preference(&adapter.get_info()));
    adapters
}

/// All adapters that a selector means, or all.
pub(super) fn meant(selector: Option<&str>) -> Vec<Adapter> {
    let mut adapters = all();
    adapters.retain(|adapter| selector.is_none_or(|selector| is_meant(&adapter.get_info(), selector)));
    adapters
}

/// The first adapter that a selector means: a part of its description, after `api:` if it names one.
///
/// # Errors
/// [`Error::Device`] names the adapters that there are.
pub(super) fn select(selector: Option<&str>) -> Result<Adapter> {
    meant(selector).into_iter().next().ok_or_else(|| {
        let asked_for = selector.map_or("gpu".into(), |selector| format!("adapter {selector:?}"));
        let names: Vec<String> = all().iter().map(|adapter| describe(&adapter.get_info())).collect();
        match names.len() {
            0 => Error::device(asked_for, "this machine has no adapter that runs compute kernels; use --backend cpu"),
            _ => Error::device(asked_for, format_args!("there is none; there are: {}", names.join("; "))),
        }
    })
}

/// Whether an adapter is a real GPU and not software that imitates one.
pub(super) fn is_real(info: &AdapterInfo) -> bool {
    matches!(info.device_type, DeviceType::DiscreteGpu | DeviceType::IntegratedGpu | DeviceType::VirtualGpu)
}

/// Whether `auto` would take an adapter.
pub(super) fn is_candidate(info: &AdapterInfo) -> bool {
    is_real(info) && info.backend != wgpu::Backend::Gl
}

/// `vulkan:llvmpipe (LLVM 15.0.6, 256 bits)`.
pub(super) fn describe(info: &AdapterInfo) -> String {
    format!("{}:{}", api(info), info.name)
}

/// The API as a user names it.
pub(super) fn api(info: &AdapterInfo) -> &'static str {
    match info.backend {
        wgpu::Backend::Vulkan => "vulkan",
        wgpu::Backend::Metal => "metal",
        wgpu::Backend::Dx12 => "dx12",
        wgpu::Backend::Gl => "gl",
        wgpu::Backend::BrowserWebGpu => "webgpu",
        wgpu::Backend::Noop => "noop",
    }
}

/// What kind of device an adapter is, in words.
pub(super) fn kind(info: &AdapterInfo) -> &'static str {
    match info.device_type {
        DeviceType::DiscreteGpu => "discrete gpu",
        DeviceType::IntegratedGpu => "integrated gpu",
        DeviceType::VirtualGpu => "virtual gpu",
        DeviceType::Cpu => "software",
        DeviceType::Other => "unknown",
    }
}

fn is_meant(info: &AdapterInfo, selector: &str) -> bool {
    let selector = selector.to_lowercase();
    let (wanted_api, name) = match selector.split_once(':') {
        Some((wanted, name)) if ["vulkan", "metal", "dx12", "gl"].contains(&wanted) => (Some(wanted), name),
        _ => (None, selector.as_str()),
    };
    let description = format!("{} {} {}", info.name, info.driver, info.driver_info).to_lowercase();
    wanted_api.is_none_or(|wanted| wanted == api(info)) && description.contains(name)
}

fn preference(info: &AdapterInfo) -> (u8, u8) {
    let kind = match info.device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    };
    (kind, u8::from(info.backend == wgpu::Backend::Gl))
}
