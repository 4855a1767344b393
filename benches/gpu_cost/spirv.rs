//! From a kernel to SPIR-V, as wgpu's Vulkan backend translates it (wgpu-hal 30, vulkan/adapter.rs and device.rs) on a
//! driver with robustBufferAccess2 and shaderIntegerDotProduct, such as RADV.

use naga::back::spv;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{ResourceBinding, ShaderStage};
use texbake::gpu::KernelVariant;

/// The words of a kernel's module.
pub fn of(kernel: &KernelVariant) -> Result<Vec<u32>, String> {
    let text = kernel.wgsl.as_str();
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| error.emit_to_string(text))?;
    let constants = kernel.constants.iter().map(|&(name, value)| (name.into(), value)).collect();
    let entry = Some((ShaderStage::Compute, kernel.entry_point));
    let (module, info) = naga::back::pipeline_constants::process_overrides(&module, &info, entry, &constants)
        .map_err(|error| error.to_string())?;
    let pipeline = spv::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: kernel.entry_point.into() };
    spv::write_vec(&module, &info, &options(), Some(&pipeline)).map_err(|error| error.to_string())
}

/// With wgpu's checks on, as they are for every kernel.
fn options() -> spv::Options<'static> {
    use spv::Capability;
    let binding = |binding| {
        let at = ResourceBinding { group: 0, binding };
        (at, spv::BindingInfo { descriptor_set: 0, binding, binding_array_size: None })
    };
    let capabilities = [
        Capability::Shader,
        Capability::Matrix,
        Capability::Sampled1D,
        Capability::Image1D,
        Capability::ImageQuery,
        Capability::DerivativeControl,
        Capability::StorageImageExtendedFormats,
        Capability::DotProductInputAllKHR,
        Capability::DotProductInput4x8BitKHR,
        Capability::DotProductInput4x8BitPackedKHR,
        Capability::DotProductKHR,
        Capability::Int8,
    ];
    spv::Options {
        // Of Vulkan 1.3.
        lang_version: (1, 6),
        flags: spv::WriterFlags::LABEL_VARYINGS | spv::WriterFlags::FORCE_POINT_SIZE,
        capabilities: Some(capabilities.into_iter().collect()),
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Restrict,
            // The driver's robustBufferAccess2 does that.
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: BoundsCheckPolicy::Unchecked,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::Native,
        force_loop_bounding: true,
        emit_int_div_checks: true,
        binding_map: (0..3).map(binding).collect(),
        ..Default::default()
    }
}

/// The same module with a hint on every loop that it be unrolled (SPIR-V's Loop Control): a driver unrolls those of
/// known turns, however large.
pub fn unrolled(words: &[u32]) -> Vec<u32> {
    const HEADER_WORDS: usize = 5;
    const LOOP_MERGE: u32 = 246;
    const UNROLL: u32 = 1;
    let mut words = words.to_vec();
    let mut at = HEADER_WORDS;
    while let Some(&first) = words.get(at) {
        if first & 0xffff == LOOP_MERGE {
            words[at + 3] = UNROLL;
        }
        // An instruction has at least the word that says its length.
        at += (first >> 16).max(1) as usize;
    }
    words
}
