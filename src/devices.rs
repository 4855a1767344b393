//! What could run bakes on this machine.

use crate::baker::Baker;

/// A device that could run bakes.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// Name of the adapter, or `cpu`.
    pub name: String,
    /// `vulkan`, `gl`, `metal`, `dx12` or `cpu`.
    pub api: String,
    /// `discrete gpu`, `integrated gpu`, `virtual gpu`, `software` or `cpu`.
    pub kind: String,
    /// The driver and its version.
    pub driver: String,
    /// Whether the known-answer test passed; the reason if not.
    pub self_test: std::result::Result<(), String>,
    /// Whether `auto` picks this device.
    pub picked: bool,
    /// Why, or why not.
    pub reason: String,
}

/// Everything that could run bakes on this machine, in the order in which `auto` would choose.
///
/// Each GPU is opened and tested, which takes a second or two where it is software.
pub fn devices() -> Vec<Device> {
    let mut devices = Vec::new();
    #[cfg(feature = "gpu")]
    devices.extend(crate::backend::gpu::devices());
    let gpu_picked = devices.iter().any(|device: &Device| device.picked);
    devices.push(Device {
        name: Baker::cpu().name(),
        api: "cpu".into(),
        kind: "cpu".into(),
        driver: String::new(),
        self_test: Ok(()),
        picked: !gpu_picked,
        reason: if gpu_picked { "takes over when the GPU fails" } else { "there is no real GPU that works" }.into(),
    });
    devices
}
