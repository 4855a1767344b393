//! The buffers of one band on its way through a device.

use super::normal::Params;
use wgpu::{Buffer, BufferDescriptor, BufferUsages};

/// The buffers of one band in flight.
pub(super) struct Slot {
    pub params: Buffer,
    pub upload: Buffer,
    pub heights: Buffer,
    pub codes: Buffer,
    pub download: Buffer,
}

impl Slot {
    pub fn new(device: &wgpu::Device, heights_bytes: u64, codes_bytes: u64) -> Self {
        let buffer = |label, size, usage, mapped_at_creation| {
            device.create_buffer(&BufferDescriptor { label: Some(label), size, usage, mapped_at_creation })
        };
        let params_bytes = size_of::<Params>() as u64;
        Self {
            params: buffer("params", params_bytes, BufferUsages::UNIFORM | BufferUsages::COPY_DST, false),
            upload: buffer("upload", heights_bytes, BufferUsages::MAP_WRITE | BufferUsages::COPY_SRC, true),
            heights: buffer("heights", heights_bytes, BufferUsages::STORAGE | BufferUsages::COPY_DST, false),
            codes: buffer("codes", codes_bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC, false),
            download: buffer("download", codes_bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST, false),
        }
    }

    pub fn holds(&self, heights_bytes: u64, codes_bytes: u64) -> bool {
        self.heights.size() >= heights_bytes && self.codes.size() >= codes_bytes
    }
}
