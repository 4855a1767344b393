//! An open device: its compiled kernels, its buffers, and what went wrong on it.

use super::adapters::describe;
use super::kernel::{Kernel, KernelSource};
use super::lock::lock;
use super::pace::{Pace, Submission, Work};
use super::slot::Slot;
use crate::error::{Error, Result};
use std::any::Any;
use std::collections::{HashMap, HashSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::Duration;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindingResource, CommandBuffer, ComputePipeline,
    ComputePipelineDescriptor, DeviceDescriptor, ErrorFilter, PipelineCompilationOptions, PipelineLayoutDescriptor,
    PollError, PollType, ShaderModule, ShaderModuleDescriptor, ShaderSource,
};

/// A device that has not answered for this long will not: drivers reset after two seconds.
const PATIENCE: Duration = Duration::from_secs(60);

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
    pub pace: Pace,
    /// How long it is waited for.
    pub patience: Duration,
    /// Kernels whose bytes were compared with the reference's.
    tested: Mutex<HashSet<Kernel>>,
    /// Why the device cannot be used any more.
    lost: Arc<OnceLock<String>>,
    /// What a test makes of the bytes that come back.
    #[cfg(test)]
    pub spoil: Mutex<Option<Spoil>>,
    /// Whether a test refuses memory for so many bytes.
    #[cfg(test)]
    pub refuse: Mutex<Option<Refuse>>,
}

/// Changes the bytes of a download.
#[cfg(test)]
pub(super) type Spoil = Box<dyn FnMut(&mut Vec<u8>) + Send>;

/// Whether there shall be no memory for so many bytes.
#[cfg(test)]
pub(super) type Refuse = Box<dyn FnMut(u64) -> bool + Send>;

/// Why a device did not do something.
#[derive(Debug)]
pub(super) enum Fault {
    /// There was no memory left: it may do less.
    OutOfMemory(Error),
    Other(Error),
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Other(error)
    }
}

impl Fault {
    /// What is told of it. No `From`: a second one for the public error would leave its users' `?` without a type.
    pub fn into_error(self) -> Error {
        match self {
            Self::OutOfMemory(error) | Self::Other(error) => error,
        }
    }
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
        let descriptor = DeviceDescriptor {
            label: Some("texbake"),
            required_limits: limits,
            // For kernels of others: where the adapter has it.
            required_features: adapter.features() & wgpu::Features::FLOAT32_FILTERABLE,
            ..Default::default()
        };
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
            pace: Pace::default(),
            patience: PATIENCE,
            tested: Mutex::default(),
            lost: Arc::default(),
            #[cfg(test)]
            spoil: Mutex::default(),
            #[cfg(test)]
            refuse: Mutex::default(),
        }
    }

    /// Without handlers, wgpu panics on errors that nobody asks for and keeps silent about a lost device.
    pub fn watch(&self) {
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
        self.attempt(work).map_err(Fault::into_error)
    }

    /// The same; tells whether memory was short.
    pub fn attempt<T>(&self, work: impl FnOnce() -> Result<T>) -> Result<T, Fault> {
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
        let is_out_of_memory = matches!(reported.first(), Some(wgpu::Error::OutOfMemory { .. }));
        // That a device is lost is the cause of whatever else is wrong, and is told at a poll only.
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(Duration::from_secs(1)) };
        let _ = catch_unwind(AssertUnwindSafe(|| self.device.poll(wait)));
        // Another thread's poll may have taken the news, and be about to tell it.
        for _ in 0..if is_out_of_memory { 0 } else { 20 } {
            self.check()?;
            std::thread::sleep(Duration::from_millis(5));
        }
        self.check()?;
        Err(if is_out_of_memory { Fault::OutOfMemory(failure) } else { Fault::Other(failure) })
    }

    /// Submits commands that compute `work`, or only copy.
    pub fn submit(&self, work: Option<Work>, commands: CommandBuffer) -> Submission {
        self.pace.begin(work, || self.queue.submit([commands]))
    }

    /// Waits until a submission is done, and sees when those before it end.
    ///
    /// # Errors
    /// [`Error::Device`] if the device is lost, or does not answer.
    pub fn wait(&self, submission: &Submission) -> Result<()> {
        while let Some(next) = self.pace.next_until(submission) {
            let is_over = self.is_done(&next.submission, Duration::ZERO)?;
            if !is_over {
                self.patiently(&next.submission)?;
            }
            self.pace.end(next, !is_over);
        }
        // Another thread may have taken it over and be waiting still.
        self.patiently(submission)
    }

    fn patiently(&self, submission: &Submission) -> Result<()> {
        match self.is_done(submission, self.patience)? {
            true => Ok(()),
            false => {
                // Whoever drops the last handle waits for the device once more, and for ever.
                std::mem::forget((self.device.clone(), self.queue.clone()));
                Err(self.give_up(format_args!("it has not answered for {:?}", self.patience)))
            }
        }
    }

    /// Whether a submission is done after a time.
    fn is_done(&self, submission: &Submission, timeout: Duration) -> Result<bool> {
        let wait = PollType::Wait { submission_index: Some(submission.index.clone()), timeout: Some(timeout) };
        let polled = self.device.poll(wait);
        self.check()?;
        match polled {
            Ok(_) => Ok(true),
            Err(PollError::Timeout) => Ok(false),
            // Of a device that is lost without having told it yet.
            Err(error @ PollError::WrongSubmissionIndex(..)) => Err(self.error(error)),
        }
    }

    /// What has come back in a slot.
    #[cfg(not(test))]
    pub fn returned(&self, slot: &Slot) -> Result<wgpu::BufferView> {
        slot.download.get_mapped_range(..).map_err(|error| self.error(error))
    }

    /// The same, as a test spoils it.
    #[cfg(test)]
    pub fn returned(&self, slot: &Slot) -> Result<Vec<u8>> {
        let mut bytes = slot.download.get_mapped_range(..).map_err(|error| self.error(error))?.to_vec();
        if let Some(spoil) = lock(&self.spoil).as_mut() {
            spoil(&mut bytes);
        }
        Ok(bytes)
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
    pub fn substitute(&self, source: KernelSource, text: &str) {
        let source_text = ShaderSource::Wgsl(text.into());
        let module =
            self.device.create_shader_module(ShaderModuleDescriptor { label: Some(source.name), source: source_text });
        lock(&self.modules).insert(source, module);
        // What was compiled of its own text, and found to be right, says nothing of this one.
        lock(&self.pipelines).retain(|kernel, _| kernel.source != source);
        lock(&self.tested).retain(|kernel| kernel.source != source);
    }

    /// Drops what was compiled; it is compiled again when it is needed.
    pub fn forget_kernels(&self) {
        lock(&self.pipelines).clear();
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
    ///
    /// # Errors
    /// [`Fault::OutOfMemory`] if there is no room for a new one.
    pub fn slot(&self, input_bytes: u64, output_bytes: u64) -> Result<Slot, Fault> {
        let mut idle = lock(&self.idle);
        match idle.iter().position(|slot| slot.holds(input_bytes, output_bytes)) {
            Some(index) => Ok(idle.swap_remove(index)),
            None => {
                // A slot that is too small would never be used again by a set of equal maps.
                idle.pop();
                drop(idle);
                #[cfg(test)]
                if lock(&self.refuse).as_mut().is_some_and(|refuse| refuse(input_bytes + output_bytes)) {
                    return Err(Fault::OutOfMemory(self.error("no memory, says a test")));
                }
                self.attempt(|| Ok(Slot::new(&self.device, input_bytes, output_bytes)))
            }
        }
    }

    /// Frees the slots that no job uses, and tells whether there were any.
    pub fn free_slots(&self) -> bool {
        !std::mem::take(&mut *lock(&self.idle)).is_empty()
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

    /// The most workgroups of one dispatch in each dimension.
    pub fn greatest_dispatch(&self) -> usize {
        self.device.limits().max_compute_workgroups_per_dimension as usize
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
