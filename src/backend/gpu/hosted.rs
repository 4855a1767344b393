//! Bakes inside somebody else's program: its device, its buffers and textures, its command encoder.

use super::bake;
use super::device::Device;
use super::kernel::Kernel;
use super::operation::{Operation, Places, Rows, row_bytes};
use super::transfer::dispatch;
use super::{Gpu, Untested};
use crate::error::{Error, Result};
use crate::map::{Channels, Depth, Encoding, HeightType, NormalFormat, Size};
use crate::ops::bake::{BakePlan, NormalOptions};
use std::num::NonZero;
use wgpu::{
    BindGroup, BindingResource, Buffer, BufferBinding, BufferDescriptor, BufferSlice, BufferUsages, CommandEncoder,
    ComputePipeline, Extent3d, TexelCopyBufferInfo, TexelCopyBufferLayout, Texture, TextureFormat, TextureUsages,
};

/// texbake on a wgpu device that the caller owns.
///
/// Nothing is read back and nothing is submitted after [`Hosted::normal`]: a bake is recorded into the caller's encoder,
/// all of it, so how long the device is busy with it at once is up to the caller.
///
/// ```no_run
/// use texbake::gpu::{CodeTarget, HeightSource, Hosted, wgpu};
/// use texbake::{HeightType, NormalOptions, Scale, Size};
///
/// # fn frame(device: &wgpu::Device, queue: &wgpu::Queue, height: &wgpu::Texture, normal: &wgpu::Texture)
/// # -> texbake::Result<()> {
/// let texbake = Hosted::new(device, queue)?;
/// let options = NormalOptions { scale: Scale::texels(24), ..Default::default() };
/// let bake = texbake.normal(Size::new(1024, 1024)?, HeightType::U16, &options)?;
///
/// let mut encoder = device.create_command_encoder(&Default::default());
/// bake.encode(&mut encoder, HeightSource::Texture(height), CodeTarget::Texture(normal))?;
/// queue.submit([encoder.finish()]);
/// # Ok(())
/// # }
/// ```
pub struct Hosted {
    gpu: Gpu,
}

/// Where the heights of a hosted bake lie.
#[derive(Debug, Clone, Copy)]
pub enum HeightSource<'a> {
    /// Part of a buffer with usage `STORAGE`: rows of [`NormalBake::heights_row_bytes`] bytes. It begins at a multiple
    /// of the device's `min_storage_buffer_offset_alignment`.
    Buffer(BufferSlice<'a>),
    /// A texture with usage `COPY_SRC` of the bake's size: `R8Unorm` or `R8Uint`, `R16Unorm` or `R16Uint`, `R32Float`.
    Texture(&'a Texture),
}

/// Where the codes of a hosted bake go.
#[derive(Debug, Clone, Copy)]
pub enum CodeTarget<'a> {
    /// Part of a buffer with usage `STORAGE`: rows of [`NormalBake::codes_row_bytes`] bytes. It begins at a multiple
    /// of the device's `min_storage_buffer_offset_alignment`.
    Buffer(BufferSlice<'a>),
    /// A texture with usage `COPY_DST` of the bake's size, whose format stores the codes as they are: two channels
    /// for xy, four for xyz (the fourth becomes 1), unorm, uint, snorm, sint or float of the codes' depth, never sRGB.
    Texture(&'a Texture),
}

/// A bake on a hosted device, ready to be recorded any number of times.
pub struct NormalBake<'a> {
    device: &'a Device,
    plan: BakePlan,
    format: NormalFormat,
}

/// Rows of a texture copy begin at multiples of this.
const COPY_ROW_BYTES: usize = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize;

impl Hosted {
    /// Takes a device and its queue and runs the self-test on them.
    ///
    /// # Errors
    /// [`Error::Device`] if the device computes other bytes than the CPU, or cannot run the kernels.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        let gpu = Gpu::tested(Untested::hosted(device, queue))?;
        Ok(Self { gpu })
    }

    /// Resolves the options for maps of one size and height type, and compiles the kernels.
    ///
    /// Heights in a buffer or texture are not checked: the codes around a float height that is NaN or infinite mean
    /// nothing.
    ///
    /// # Errors
    /// [`Error::Parameter`] if an option is out of range; [`Error::Device`] if the device has no room for such a map
    /// in one binding.
    pub fn normal(&self, size: Size, height_type: HeightType, options: &NormalOptions) -> Result<NormalBake<'_>> {
        let device = &self.gpu.untested.device;
        let plan = BakePlan::new(&(*options).into(), size, height_type)?;
        let bake = NormalBake { device, plan, format: options.format };
        let rows =
            [bake.heights_row_bytes(), bake.codes_row_bytes()].map(|bytes| bytes.next_multiple_of(COPY_ROW_BYTES));
        let greatest = device.greatest_binding();
        if rows.iter().any(|bytes| bytes.saturating_mul(size.height()) > greatest) {
            let reason =
                format!("a map of {size} texels exceeds its bindings of {greatest} bytes; request higher limits");
            return Err(device.error(reason));
        }
        self.gpu.accept_bake(&bake.plan)?;
        device.guarded(|| {
            for codes_per_texel in [bake.format.channels.count(), texture_channels(bake.format)] {
                device.pipeline(&bake.kernel(codes_per_texel));
            }
            Ok(())
        })?;
        Ok(bake)
    }
}

impl NormalBake<'_> {
    /// Bytes from one row of heights to the next in a buffer: four texels make whole words.
    pub fn heights_row_bytes(&self) -> usize {
        row_bytes(self.plan.size.width(), self.plan.height_type.bytes())
    }

    /// Bytes from one row of codes to the next in a buffer: four texels make whole words.
    pub fn codes_row_bytes(&self) -> usize {
        self.row_bytes_of_codes(self.format.channels.count())
    }

    /// Records the bake. The map is complete when the encoder's commands have run.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a buffer is too small, or a texture has another size or a format that does not hold
    /// the heights or the codes; [`Error::Device`] if wgpu refuses a resource, for a missing usage or for want of memory
    /// say: nothing is recorded then, and the encoder is as it was.
    pub fn encode(&self, encoder: &mut CommandEncoder, heights: HeightSource<'_>, codes: CodeTarget<'_>) -> Result<()> {
        self.check(heights, codes)?;
        // What may be refused comes first: an encoder with a command that was refused is lost to its owner.
        let recording = self.device.guarded(|| Ok(self.prepare(heights, codes)))?;
        self.device.guarded(|| {
            self.record(encoder, &recording, heights, codes);
            Ok(())
        })
    }

    fn prepare(&self, heights: HeightSource<'_>, codes: CodeTarget<'_>) -> Recording {
        let heights = match heights {
            HeightSource::Buffer(slice) => BufferRows::of(slice, self.heights_row_bytes()),
            HeightSource::Texture(_) => self.scratch("heights", self.heights_row_bytes()),
        };
        let (codes_per_texel, codes) = match codes {
            CodeTarget::Buffer(slice) => (self.format.channels.count(), BufferRows::of(slice, self.codes_row_bytes())),
            CodeTarget::Texture(_) => {
                let codes_per_texel = texture_channels(self.format);
                (codes_per_texel, self.scratch("codes", self.row_bytes_of_codes(codes_per_texel)))
            }
        };
        let pipeline = self.device.pipeline(&self.kernel(codes_per_texel));
        let dispatches = self.dispatches(&heights, &codes);
        Recording { heights, codes, pipeline, dispatches }
    }

    fn record(
        &self,
        encoder: &mut CommandEncoder,
        Recording { heights: rows_of_heights, codes: rows_of_codes, pipeline, dispatches }: &Recording,
        heights: HeightSource<'_>,
        codes: CodeTarget<'_>,
    ) {
        let size = self.plan.size;
        if let HeightSource::Texture(texture) = heights {
            encoder.copy_texture_to_buffer(texture.as_image_copy(), rows_of_heights.layout(), extent(size));
        }
        for (bindings, rows) in dispatches {
            dispatch(encoder, pipeline, bindings, size.width(), *rows);
        }
        if let CodeTarget::Texture(texture) = codes {
            encoder.copy_buffer_to_texture(rows_of_codes.layout(), texture.as_image_copy(), extent(size));
        }
    }

    fn check(&self, heights: HeightSource<'_>, codes: CodeTarget<'_>) -> Result<()> {
        let plan = &self.plan;
        match heights {
            HeightSource::Buffer(slice) => {
                check_length("heights buffer", slice, self.heights_row_bytes() * plan.size.height())?
            }
            HeightSource::Texture(texture) => {
                check_size("heights texture", texture, plan.size)?;
                check_format("heights texture", texture, heights_formats(plan.height_type), TextureUsages::COPY_SRC)?;
            }
        }
        match codes {
            CodeTarget::Buffer(slice) => {
                check_length("codes buffer", slice, self.codes_row_bytes() * plan.size.height())
            }
            CodeTarget::Texture(texture) => {
                check_size("codes texture", texture, plan.size)?;
                check_format("codes texture", texture, codes_formats(self.format), TextureUsages::COPY_DST)
            }
        }
    }

    fn kernel(&self, codes_per_texel: usize) -> Kernel {
        bake::kernel(&self.plan, codes_per_texel, false)
    }

    fn row_bytes_of_codes(&self, codes_per_texel: usize) -> usize {
        row_bytes(self.plan.size.width(), codes_per_texel * self.format.depth.bytes())
    }

    /// A buffer for the bake's rows, to be copied from or to a texture; it lives as long as the recorded commands.
    fn scratch(&self, label: &str, row_bytes: usize) -> BufferRows {
        let row_bytes = row_bytes.next_multiple_of(COPY_ROW_BYTES);
        let buffer = self.device.device.create_buffer(&BufferDescriptor {
            label: Some(label),
            size: (row_bytes * self.plan.size.height()) as u64,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        BufferRows { buffer, offset: 0, row_bytes }
    }

    /// The kernel over all rows, in as many dispatches as their number needs: each with its bindings and its rows.
    fn dispatches(&self, heights: &BufferRows, codes: &BufferRows) -> Vec<(BindGroup, usize)> {
        let Self { device, plan, .. } = self;
        let height = plan.size.height();
        let place = |rows: &BufferRows, row: usize| {
            let words = rows.row_bytes / 4;
            Rows { place: (row * words) as u32, words: words as u32 }
        };
        let heights_at = |row: isize| place(heights, plan.edges.y.resolve(row, height));
        let greatest_dispatch = device.greatest_dispatch();
        let part = |first: usize| {
            let rows = greatest_dispatch.min(height - first);
            let [above, body, below] = [first as isize - 1, first as isize, (first + rows) as isize];
            let places = Places {
                rows: rows as u32,
                inputs: vec![heights_at(above), heights_at(body), heights_at(below)],
                outputs: vec![place(codes, first)],
                ..Places::default()
            };
            let uniform = device.uniform(&plan.params(&places));
            (device.bind(uniform.as_entire_binding(), heights.binding(height), codes.binding(height)), rows)
        };
        (0..height).step_by(greatest_dispatch).map(part).collect()
    }
}

/// What a bake needs on the device to be recorded.
struct Recording {
    heights: BufferRows,
    codes: BufferRows,
    pipeline: ComputePipeline,
    dispatches: Vec<(BindGroup, usize)>,
}

/// Rows in a buffer from an offset on.
struct BufferRows {
    buffer: Buffer,
    offset: u64,
    row_bytes: usize,
}

impl BufferRows {
    fn of(slice: BufferSlice<'_>, row_bytes: usize) -> Self {
        Self { buffer: slice.buffer().clone(), offset: slice.offset(), row_bytes }
    }

    /// The first `count` rows, for a kernel.
    fn binding(&self, count: usize) -> BindingResource<'_> {
        let size = NonZero::new((count * self.row_bytes) as u64);
        BindingResource::Buffer(BufferBinding { buffer: &self.buffer, offset: self.offset, size })
    }

    /// The rows, for a copy.
    fn layout(&self) -> TexelCopyBufferInfo<'_> {
        let bytes_per_row = Some(self.row_bytes as u32);
        let layout = TexelCopyBufferLayout { offset: self.offset, bytes_per_row, rows_per_image: None };
        TexelCopyBufferInfo { buffer: &self.buffer, layout }
    }
}

/// Channels of a texture that holds a format: there are no textures of three.
fn texture_channels(format: NormalFormat) -> usize {
    match format.channels {
        Channels::Xy => 2,
        Channels::Xyz => 4,
    }
}

fn heights_formats(height_type: HeightType) -> &'static [TextureFormat] {
    match height_type {
        HeightType::U8 => &[TextureFormat::R8Unorm, TextureFormat::R8Uint],
        HeightType::U16 => &[TextureFormat::R16Unorm, TextureFormat::R16Uint],
        HeightType::F32 => &[TextureFormat::R32Float],
    }
}

fn codes_formats(format: NormalFormat) -> &'static [TextureFormat] {
    use TextureFormat as T;
    match (format.channels, format.depth, format.encoding == Encoding::Snorm) {
        (Channels::Xy, Depth::Bits8, false) => &[T::Rg8Unorm, T::Rg8Uint],
        (Channels::Xy, Depth::Bits8, true) => &[T::Rg8Snorm, T::Rg8Sint],
        (Channels::Xy, Depth::Bits16, false) => &[T::Rg16Unorm, T::Rg16Uint],
        (Channels::Xy, Depth::Bits16, true) => &[T::Rg16Snorm, T::Rg16Sint],
        (Channels::Xy, Depth::Float16, _) => &[T::Rg16Float],
        (Channels::Xy, Depth::Float32, _) => &[T::Rg32Float],
        (Channels::Xyz, Depth::Bits8, false) => &[T::Rgba8Unorm, T::Rgba8Uint],
        (Channels::Xyz, Depth::Bits8, true) => &[T::Rgba8Snorm, T::Rgba8Sint],
        (Channels::Xyz, Depth::Bits16, false) => &[T::Rgba16Unorm, T::Rgba16Uint],
        (Channels::Xyz, Depth::Bits16, true) => &[T::Rgba16Snorm, T::Rgba16Sint],
        (Channels::Xyz, Depth::Float16, _) => &[T::Rgba16Float],
        (Channels::Xyz, Depth::Float32, _) => &[T::Rgba32Float],
    }
}

fn check_length(parameter: &'static str, slice: BufferSlice<'_>, bytes: usize) -> Result<()> {
    if slice.size() < bytes as u64 {
        return Err(Error::parameter(
            parameter,
            format_args!("{} bytes", slice.size()),
            format!("at least {bytes} bytes"),
        ));
    }
    Ok(())
}

fn check_size(parameter: &'static str, texture: &Texture, size: Size) -> Result<()> {
    let found = texture.size();
    if found != extent(size) {
        let given = format!("{} x {} x {}", found.width, found.height, found.depth_or_array_layers);
        return Err(Error::parameter(parameter, given, format!("{size} x 1 texels")));
    }
    Ok(())
}

fn check_format(
    parameter: &'static str,
    texture: &Texture,
    formats: &[TextureFormat],
    usage: TextureUsages,
) -> Result<()> {
    if !formats.contains(&texture.format()) {
        let range = formats.iter().map(|format| format!("{format:?}")).collect::<Vec<_>>().join(" or ");
        return Err(Error::parameter(parameter, format_args!("{:?}", texture.format()), range));
    }
    if !texture.usage().contains(usage) {
        return Err(Error::parameter(parameter, format_args!("{:?}", texture.usage()), format!("usable as {usage:?}")));
    }
    Ok(())
}

fn extent(size: Size) -> Extent3d {
    Extent3d { width: size.width() as u32, height: size.height() as u32, depth_or_array_layers: 1 }
}
