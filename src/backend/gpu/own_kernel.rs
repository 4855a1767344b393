//! A kernel of somebody else's on a device.

use super::device::Device;
use super::transfer::Mapping;
use crate::error::Result;
use std::borrow::Cow;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{BufferUsages, ComputePipelineDescriptor, MapMode, PipelineCompilationOptions};

/// What a binding is to a kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Binding {
    /// `var<uniform>`.
    Uniform,
    /// `var<storage, read>`.
    Read,
    /// `var<storage, read_write>`.
    ReadWrite,
}

/// A compiled kernel.
pub(crate) struct OwnPipeline<'a> {
    device: &'a Device,
    pipeline: wgpu::ComputePipeline,
}

impl<'a> OwnPipeline<'a> {
    /// Compiles a kernel.
    ///
    /// # Errors
    /// [`crate::Error::Device`] with what the compiler says.
    pub(super) fn new(device: &'a Device, wgsl: &str, entry_point: &str, constants: &[(&str, f64)]) -> Result<Self> {
        let pipeline = device.guarded(|| {
            let source = wgpu::ShaderSource::Wgsl(Cow::Borrowed(wgsl));
            let module =
                device.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(entry_point), source });
            Ok(device.device.create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: None,
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: PipelineCompilationOptions { constants, ..Default::default() },
                cache: None,
            }))
        })?;
        Ok(Self { device, pipeline })
    }

    /// Runs it on buffers of words, bound in their order in group 0, and gives the words of those that it may write.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if the buffers do not fit the kernel, or the device fails.
    pub fn run(&self, buffers: &[(Binding, &[u32])], workgroups: [u32; 3]) -> Result<Vec<Vec<u32>>> {
        let device = &self.device.device;
        let (downloads, submission) = self.device.guarded(|| {
            let upload = |&(binding, words): &(Binding, &[u32])| {
                let usage = match binding {
                    Binding::Uniform => BufferUsages::UNIFORM,
                    Binding::Read => BufferUsages::STORAGE,
                    Binding::ReadWrite => BufferUsages::STORAGE | BufferUsages::COPY_SRC,
                };
                let contents = bytemuck::cast_slice(words);
                device.create_buffer_init(&BufferInitDescriptor { label: Some("words"), contents, usage })
            };
            let uploaded: Vec<wgpu::Buffer> = buffers.iter().map(upload).collect();
            let entries: Vec<_> = uploaded
                .iter()
                .zip(0..)
                .map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
                .collect();
            let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("own kernel"),
                layout: &self.pipeline.get_bind_group_layout(0),
                entries: &entries,
            });
            let mut encoder = device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            let [x, y, z] = workgroups;
            pass.dispatch_workgroups(x, y, z);
            drop(pass);
            let mut downloads = Vec::new();
            for (buffer, _) in uploaded.iter().zip(buffers).filter(|(_, (binding, _))| *binding == Binding::ReadWrite) {
                let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
                let size = buffer.size();
                let descriptor =
                    wgpu::BufferDescriptor { label: Some("download"), size, usage, mapped_at_creation: false };
                let download = device.create_buffer(&descriptor);
                encoder.copy_buffer_to_buffer(buffer, 0, &download, 0, size);
                downloads.push(download);
            }
            Ok((downloads, self.device.submit(None, encoder.finish())))
        })?;
        self.device.guarded(|| {
            let wanted = downloads.iter().map(|download| (download, MapMode::Read));
            Mapping::of_buffers(wanted, submission).wait(self.device)?;
            let words = |download: &wgpu::Buffer| {
                let view = download.get_mapped_range(..).map_err(|error| self.device.error(error))?;
                Ok(bytemuck::cast_slice(&view).to_vec())
            };
            downloads.iter().map(words).collect()
        })
    }
}
