//! The buffers of one band on its way through a device.

use super::operation::PARAMS_BYTES;
use wgpu::{Buffer, BufferDescriptor, BufferUsages};

/// The buffers of one band in flight.
pub(super) struct Slot {
    pub params: Buffer,
    pub upload: Buffer,
    pub inputs: Buffer,
    pub outputs: Buffer,
    pub download: Buffer,
}

impl Slot {
    pub fn new(device: &wgpu::Device, input_bytes: u64, output_bytes: u64) -> Self {
        let buffer = |label, size, usage, mapped_at_creation| {
            device.create_buffer(&BufferDescriptor { label: Some(label), size, usage, mapped_at_creation })
        };
        Self {
            params: buffer("params", PARAMS_BYTES as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST, false),
            upload: buffer("upload", input_bytes, BufferUsages::MAP_WRITE | BufferUsages::COPY_SRC, true),
            inputs: buffer("inputs", input_bytes, BufferUsages::STORAGE | BufferUsages::COPY_DST, false),
            outputs: buffer("outputs", output_bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC, false),
            download: buffer("download", output_bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST, false),
        }
    }

    pub fn holds(&self, input_bytes: u64, output_bytes: u64) -> bool {
        self.inputs.size() >= input_bytes && self.outputs.size() >= output_bytes
    }
}
