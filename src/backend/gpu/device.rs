//! An open device: its compiled kernels, its buffers, and what went wrong on it.

use super::adapters::describe;
use super::kernel::{Kernel, KernelSource};
use super::slot::Slot;
use crate::error::{Error, Result};
use std::any::Any;
use std::collections::{HashMap, HashSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindingResource, ComputePipeline,
    ComputePipelineDescriptor, DeviceDescriptor, ErrorFilter, PipelineCompilationOptions, PipelineLayoutDescriptor,
    ShaderModule, ShaderModuleDescriptor, ShaderSource,
};

/// A device that bakes.
pub(crate) struct Device {
    pub name: String,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub(super) layout: BindGroupLayout,
    modules: Mutex<HashMap<KernelSource, ShaderModule>>,
    pipelines: Mutex<HashMap<Kernel, ComputePipeline>>,
    idle: Mutex<Vec<Slot>>,
    next_nonce: AtomicU32,
    /// Kernels whose bytes were compared with the reference's.
    tested: Mutex<HashSet<Kernel>>,
    /// Why the device cannot be used any more.
    lost: Arc<OnceLock<String>>,
}

impl Device {
    /// Opens an adapter.
    ///
    /// # Errors
    /// [`Error::Device`] if the driver refuses.
    pub fn open(adapter: &wgpu::Adapter) -> Result<Self> {
        let name = describe(&adapter.get_info());
        // What every WebGPU device has, and the buffer sizes of this one.
        let own = adapter.limits();
        let limits = wgpu::Limits {
            max_buffer_size: own.max_buffer_size,
            max_storage_buffer_binding_size: own.max_storage_buffer_binding_size,
            ..wgpu::Limits::downlevel_defaults().using_resolution(own)
        };
        let descriptor = DeviceDescriptor { label: Some("texbake"), required_limits: limits, ..Default::default() };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = opened.map_err(|error| Error::device(&name, error))?;
        let this = Self::new(name, device, queue);
        this.watch();
        Ok(this)
    }

    /// Wraps a device that somebody else opened; its error handlers stay theirs.
    pub fn new(name: String, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let layout = bind_group_layout(&device);
        Self {
            name,
            device,
            queue,
            layout,
            modules: Mutex::default(),
            pipelines: Mutex::default(),
            idle: Mutex::default(),
            next_nonce: AtomicU32::new(1),
            tested: Mutex::default(),
            lost: Arc::default(),
        }
    }

    /// Without handlers, wgpu panics on errors that nobody asks for and keeps silent about a lost device.
    fn watch(&self) {
        let lost = self.lost.clone();
        self.device.on_uncaptured_error(Arc::new(move |error| {
            let _ = lost.set(error.to_string());
        }));
        let lost = self.lost.clone();
        self.device.set_device_lost_callback(move |reason, message| {
            let _ = lost.set(format!("the device was lost: {reason:?} {message}").trim_end().into());
        });
    }

    /// Fails if the device was lost, now or during an earlier job.
    pub fn check(&self) -> Result<()> {
        match self.lost.get() {
            None => Ok(()),
            Some(reason) => Err(self.error(reason)),
        }
    }

    /// Gives the device up: every later job is spared the wait for it.
    pub fn give_up(&self, reason: impl ToString) -> Error {
        // The first reason is the cause of the others.
        let _ = self.lost.set(reason.to_string());
        self.error(self.lost.get().map_or("it was lost", String::as_str))
    }

    /// Runs calls into wgpu, and returns whatever is wrong with them as an error: what it would report elsewhere, to
    /// whom it may concern, and its panics, which a lost device can cause (gfx-rs/wgpu: poll).
    pub fn guarded<T>(&self, work: impl FnOnce() -> Result<T>) -> Result<T> {
        self.check()?;
        let scopes = [ErrorFilter::Internal, ErrorFilter::OutOfMemory, ErrorFilter::Validation]
            .map(|filter| self.device.push_error_scope(filter));
        let result = catch_unwind(AssertUnwindSafe(work));
        // Scopes end in the opposite order.
        let reported: Vec<_> = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop())).collect();
        let failure = match (result, reported.first()) {
            (Ok(Ok(value)), None) => return Ok(value),
            (Err(panic), _) => self.give_up(format_args!("wgpu failed: {}", panic_text(panic.as_ref()))),
            (_, Some(error)) => self.error(error),
            (Ok(Err(error)), None) => error,
        };
        // That a device is lost is the cause of whatever else is wrong, and is told at a poll only.
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(Duration::from_secs(1)) };
        let _ = catch_unwind(AssertUnwindSafe(|| self.device.poll(wait)));
        Err(self.check().err().unwrap_or(failure))
    }

    /// Whether a kernel has passed its test; the caller tests it otherwise.
    pub fn is_tested(&self, kernel: &Kernel) -> bool {
        lock(&self.tested).contains(kernel)
    }

    /// Remembers that a kernel has passed its test.
    pub fn set_tested(&self, kernel: Kernel) {
        lock(&self.tested).insert(kernel);
    }

    /// An error on this device.
    pub fn error(&self, reason: impl ToString) -> Error {
        Error::device(&self.name, reason)
    }

    /// The compiled kernel; compiled once per device and choice of constants.
    pub fn pipeline(&self, kernel: &Kernel) -> ComputePipeline {
        lock(&self.pipelines).entry(kernel.clone()).or_insert_with(|| self.compile(kernel)).clone()
    }

    /// Runs another text in place of a kernel's own.
    #[cfg(test)]
    pub fn substitute(&self, source: KernelSource, text: &str) {
        let source_text = ShaderSource::Wgsl(text.into());
        let module =
            self.device.create_shader_module(ShaderModuleDescriptor { label: Some(source.name), source: source_text });
        lock(&self.modules).insert(source, module);
    }

    fn compile(&self, kernel: &Kernel) -> ComputePipeline {
        let source = kernel.source;
        let module = lock(&self.modules)
            .entry(source)
            .or_insert_with(|| {
                let text = ShaderSource::Wgsl(source.text().into());
                self.device.create_shader_module(ShaderModuleDescriptor { label: Some(source.name), source: text })
            })
            .clone();
        let layout = self.device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some(source.name),
            bind_group_layouts: &[Some(&self.layout)],
            ..Default::default()
        });
        let constants: Vec<_> = kernel.constants.iter().map(|&(name, value)| (name, f64::from(value))).collect();
        self.device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(source.name),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(source.entry_point),
            compilation_options: PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        })
    }

    /// Parameters, inputs and outputs, as every kernel binds them.
    pub fn bind(
        &self,
        params: BindingResource<'_>,
        inputs: BindingResource<'_>,
        outputs: BindingResource<'_>,
    ) -> BindGroup {
        let entry = |binding, resource| BindGroupEntry { binding, resource };
        self.device.create_bind_group(&BindGroupDescriptor {
            label: Some("texbake"),
            layout: &self.layout,
            entries: &[entry(0, params), entry(1, inputs), entry(2, outputs)],
        })
    }

    /// A new uniform buffer with these bytes.
    pub fn uniform(&self, bytes: &[u8]) -> wgpu::Buffer {
        use wgpu::util::{BufferInitDescriptor, DeviceExt};
        let usage = wgpu::BufferUsages::UNIFORM;
        self.device.create_buffer_init(&BufferInitDescriptor { label: Some("params"), contents: bytes, usage })
    }

    /// A slot of earlier jobs that holds this many bytes of inputs and outputs, or a new one.
    pub fn slot(&self, input_bytes: u64, output_bytes: u64) -> Slot {
        let mut idle = lock(&self.idle);
        match idle.iter().position(|slot| slot.holds(input_bytes, output_bytes)) {
            Some(index) => idle.swap_remove(index),
            None => {
                // A slot that is too small would never be used again by a set of equal maps.
                idle.pop();
                drop(idle);
                Slot::new(&self.device, input_bytes, output_bytes)
            }
        }
    }

    /// What marks the rows of a dispatch: another odd number for each of 2^31, so that neither a slot's earlier
    /// content nor a cleared word passes for it.
    pub fn fresh_nonce(&self) -> u32 {
        self.next_nonce.fetch_add(2, Ordering::Relaxed)
    }

    /// Keeps a slot for the next job.
    pub fn keep(&self, slot: Slot) {
        lock(&self.idle).push(slot);
    }

    /// The most bytes that one binding may have.
    pub fn greatest_binding(&self) -> usize {
        let limits = self.device.limits();
        limits.max_buffer_size.min(limits.max_storage_buffer_binding_size).min(i32::MAX as u64) as usize
    }
}

fn bind_group_layout(device: &wgpu::Device) -> BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("texbake"),
        entries: &[
            entry(0, wgpu::BufferBindingType::Uniform),
            entry(1, wgpu::BufferBindingType::Storage { read_only: true }),
            entry(2, wgpu::BufferBindingType::Storage { read_only: false }),
        ],
    })
}

/// The message of a panic.
pub(super) fn panic_text(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no reason given")
}

/// Locks; a thread that panicked while it held the lock left a cache entry out at worst.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
