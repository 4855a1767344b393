//! Mesa's RADV as a compiler: a device that is not there, and what it says of a pipeline
//! (VK_KHR_pipeline_executable_properties).
#![expect(unsafe_code, reason = "raw Vulkan: wgpu opens no device without hardware and passes no statistics on")]

use ash::vk;
use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char};
use std::path::PathBuf;

/// An open device without hardware. The process ends with it, so nothing is destroyed.
pub struct Radv {
    device: ash::Device,
    executables: ash::khr::pipeline_executable_properties::Device,
    layout: vk::PipelineLayout,
    /// `Mesa 22.3.6`, without what a distribution adds.
    pub driver: String,
    /// What the driver calls the part.
    pub name: String,
    // The library stays loaded.
    _entry: ash::Entry,
}

impl Radv {
    /// Opens the one device that the environment leaves.
    pub fn open() -> Result<Self, String> {
        // SAFETY: the loader is the system's; every call below follows the specification: structures outlive the call,
        // handles are those of this instance and device.
        unsafe { Self::open_unchecked() }
    }

    unsafe fn open_unchecked() -> Result<Self, String> {
        let entry = unsafe { ash::Entry::load() }.map_err(|error| format!("no Vulkan loader: {error}"))?;
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
        let info = vk::InstanceCreateInfo::default().application_info(&application);
        let instance = unsafe { entry.create_instance(&info, None) }.map_err(failed("vkCreateInstance"))?;
        let found = unsafe { instance.enumerate_physical_devices() }.map_err(failed("vkEnumeratePhysicalDevices"))?;
        let &[physical] = found.as_slice() else { return Err(format!("{} devices instead of one", found.len())) };

        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
        unsafe { instance.get_physical_device_properties2(physical, &mut properties) };
        let name = text(&properties.properties.device_name);
        if driver.driver_id != vk::DriverId::MESA_RADV {
            return Err(format!("{name} is no device of RADV"));
        }
        let version: Vec<String> = text(&driver.driver_info).split(' ').take(2).map(String::from).collect();

        let queue = [vk::DeviceQueueCreateInfo::default().queue_family_index(0).queue_priorities(&[1.0])];
        let extensions =
            [ash::khr::pipeline_executable_properties::NAME.as_ptr(), ash::ext::robustness2::NAME.as_ptr()];
        let mut statistics =
            vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
        // What wgpu asks for, as far as it changes how a kernel is compiled.
        let mut robustness = vk::PhysicalDeviceRobustness2FeaturesEXT::default().robust_buffer_access2(true);
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default().shader_int8(true);
        let mut vulkan13 = vk::PhysicalDeviceVulkan13Features::default().shader_integer_dot_product(true);
        let features = vk::PhysicalDeviceFeatures::default().robust_buffer_access(true);
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queue)
            .enabled_extension_names(&extensions)
            .enabled_features(&features)
            .push_next(&mut statistics)
            .push_next(&mut robustness)
            .push_next(&mut vulkan12)
            .push_next(&mut vulkan13);
        let device = unsafe { instance.create_device(physical, &info, None) }.map_err(failed("vkCreateDevice"))?;
        let layout = unsafe { layout(&device) }?;
        let executables = ash::khr::pipeline_executable_properties::Device::new(&instance, &device);
        Ok(Self { device, executables, layout, driver: version.join(" "), name, _entry: entry })
    }

    /// Compiles a module, and returns the driver's statistics by their names; with `listing`, prints the instructions.
    pub fn compile(&self, spirv: &[u32], entry_point: &str, listing: bool) -> Result<BTreeMap<String, u64>, String> {
        // SAFETY: as in `open`; naga validated the module.
        unsafe { self.compile_unchecked(spirv, entry_point, listing) }
    }

    unsafe fn compile_unchecked(
        &self,
        spirv: &[u32],
        entry_point: &str,
        listing: bool,
    ) -> Result<BTreeMap<String, u64>, String> {
        let device = &self.device;
        let info = vk::ShaderModuleCreateInfo::default().code(spirv);
        let module = unsafe { device.create_shader_module(&info, None) }.map_err(failed("vkCreateShaderModule"))?;
        let entry_point = CString::new(entry_point).map_err(|error| error.to_string())?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(&entry_point);
        let mut flags = vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR;
        if listing {
            flags |= vk::PipelineCreateFlags::CAPTURE_INTERNAL_REPRESENTATIONS_KHR;
        }
        let info = vk::ComputePipelineCreateInfo::default().flags(flags).stage(stage).layout(self.layout);
        let created = unsafe { device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None) };
        let pipeline = created.map_err(|(_, error)| failed("vkCreateComputePipelines")(error))?[0];
        let info = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline);
        let statistics = unsafe { self.executables.get_pipeline_executable_statistics(&info) }
            .map_err(failed("vkGetPipelineExecutableStatisticsKHR"))?;
        if listing {
            unsafe { self.print_listing(&info) }?;
        }
        unsafe {
            device.destroy_pipeline(pipeline, None);
            device.destroy_shader_module(module, None);
        }
        let value = |statistic: &vk::PipelineExecutableStatisticKHR<'_>| {
            // SAFETY: RADV's statistics are 64-bit integers, which `format` says.
            let value = unsafe { statistic.value.u64 };
            let is_integer = statistic.format == vk::PipelineExecutableStatisticFormatKHR::UINT64;
            (text(&statistic.name), if is_integer { value } else { 0 })
        };
        Ok(statistics.iter().map(value).collect())
    }

    unsafe fn print_listing(&self, info: &vk::PipelineExecutableInfoKHR<'_>) -> Result<(), String> {
        let failed = failed("vkGetPipelineExecutableInternalRepresentationsKHR");
        // ash's wrapper asks for no data: the sizes first, then the texts.
        let mut listings =
            unsafe { self.executables.get_pipeline_executable_internal_representations(info) }.map_err(failed)?;
        let mut texts: Vec<Vec<u8>> = listings.iter().map(|listing| vec![0; listing.data_size]).collect();
        for (listing, text) in listings.iter_mut().zip(&mut texts) {
            listing.p_data = text.as_mut_ptr().cast();
        }
        let mut count = listings.len() as u32;
        let get = self.executables.fp().get_pipeline_executable_internal_representations_khr;
        unsafe { get(self.device.handle(), info, &mut count, listings.as_mut_ptr()) }
            .result()
            .map_err(self::failed("vkGetPipelineExecutableInternalRepresentationsKHR"))?;
        for (listing, bytes) in listings.iter().zip(&texts) {
            println!("== {}\n{}", text(&listing.name), String::from_utf8_lossy(bytes).trim_end_matches('\0'));
        }
        Ok(())
    }
}

/// The three buffers of every kernel, as wgpu binds them.
unsafe fn layout(device: &ash::Device) -> Result<vk::PipelineLayout, String> {
    let buffer = |binding, kind| {
        vk::DescriptorSetLayoutBinding::default()
            .binding(binding)
            .descriptor_type(kind)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
    };
    let bindings = [
        buffer(0, vk::DescriptorType::UNIFORM_BUFFER),
        buffer(1, vk::DescriptorType::STORAGE_BUFFER),
        buffer(2, vk::DescriptorType::STORAGE_BUFFER),
    ];
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
    let set = unsafe { device.create_descriptor_set_layout(&info, None) };
    let sets = [set.map_err(failed("vkCreateDescriptorSetLayout"))?];
    let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
    unsafe { device.create_pipeline_layout(&info, None) }.map_err(failed("vkCreatePipelineLayout"))
}

fn failed(call: &'static str) -> impl Fn(vk::Result) -> String {
    move |error| format!("{call}: {error}")
}

/// A driver's text, which ends with a zero.
fn text(chars: &[c_char]) -> String {
    let bytes: Vec<u8> = chars.iter().map(|&char| char as u8).collect();
    CStr::from_bytes_until_nul(&bytes).map_or(String::new(), |text| text.to_string_lossy().into_owned())
}

/// The loader's file of RADV, where distributions put it.
pub fn driver_file() -> Result<PathBuf, String> {
    let folders = ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"];
    let is_radv = |path: &PathBuf| {
        path.file_name()
            .and_then(|name| name.to_str())
            .is_some_and(|name| name.starts_with("radeon_icd") && name.ends_with(".json") && !name.contains("i686"))
    };
    let files = folders.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten();
    let found = files.filter_map(|file| file.ok().map(|file| file.path())).find(is_radv);
    found.ok_or_else(|| {
        format!(
            "Mesa's RADV (Debian: mesa-vulkan-drivers) is not installed: no radeon_icd*.json in {}",
            folders.join(", ")
        )
    })
}
