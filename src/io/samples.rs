//! What a decoder gives: interleaved samples, row by row.

use crate::error::Result;
use crate::map::{HeightType, Heights, HeightsMut, Size};

/// The samples of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    /// Texels.
    pub size: Size,
    /// Type of a sample.
    pub depth: HeightType,
    /// Samples per texel that are colours or data.
    pub colours: usize,
    /// Whether one more sample follows them.
    pub alpha: bool,
}

/// Rows of interleaved samples, read from the top.
pub(super) trait SampleRows: Send {
    /// What a row holds.
    fn layout(&self) -> Layout;

    /// Reads the next rows: as many as `rows` has room for, never more than are left.
    fn read(&mut self, rows: HeightsMut<'_>) -> Result<()>;

    /// Goes on with row `row`.
    fn seek(&mut self, row: usize) -> Result<()>;

    /// Whether the last row is reached without decoding those before it.
    fn last_row_is_near(&self) -> bool;

    /// Bytes that are held at most while rows are read.
    fn held_bytes(&self) -> u64;
}

/// An opened file and what its header says.
pub(super) struct Opened {
    /// The rows.
    pub samples: Box<dyn SampleRows>,
    /// The channel of a file that names its channels was found while it was opened.
    pub channel_found: bool,
    /// Whether its integers are signed: a sample v stands as v + 2^(b-1).
    pub signed: bool,
    /// Whether its compression changes samples.
    pub lossy: bool,
    /// What stands for "no data".
    pub no_data: Option<NoData>,
    /// Whether the file says that its codes are sRGB.
    pub says_srgb: bool,
    /// What else looks wrong.
    pub warnings: Vec<String>,
}

/// The value that stands for "no data": as a height, and as the file writes it.
pub(super) struct NoData {
    pub height: f32,
    pub text: String,
}

/// Samples in memory.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Samples {
    U8(Vec<u8>),
    U16(Vec<u16>),
    F32(Vec<f32>),
}

/// A file that is decoded whole when its first row is asked for: one that waits for its turn holds nothing.
pub(super) struct DecodedWhole {
    layout: Layout,
    /// Bytes that the decoder holds besides the samples.
    beside: u64,
    decode: Box<dyn FnMut() -> Result<Samples> + Send>,
    samples: Option<Samples>,
    next_row: usize,
}

impl Layout {
    /// Samples per texel.
    pub fn per_texel(&self) -> usize {
        self.colours + usize::from(self.alpha)
    }

    /// Samples in a row.
    pub fn per_row(&self) -> usize {
        self.size.width() * self.per_texel()
    }

    /// Bytes of a row of samples.
    pub fn row_bytes(&self) -> usize {
        self.per_row() * self.depth.bytes()
    }
}

impl Opened {
    /// A file with nothing special about it.
    pub fn new(samples: impl SampleRows + 'static) -> Self {
        let samples = Box::new(samples);
        Self {
            samples,
            channel_found: false,
            signed: false,
            lossy: false,
            no_data: None,
            says_srgb: false,
            warnings: Vec::new(),
        }
    }
}

impl Samples {
    pub fn zeroed(depth: HeightType, count: usize) -> Self {
        match depth {
            HeightType::U8 => Self::U8(vec![0; count]),
            HeightType::U16 => Self::U16(vec![0; count]),
            HeightType::F32 => Self::F32(vec![0.0; count]),
        }
    }

    /// Bytes of all samples.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::U8(samples) => samples.len() as u64,
            Self::U16(samples) => 2 * samples.len() as u64,
            Self::F32(samples) => 4 * samples.len() as u64,
        }
    }

    pub fn as_ref(&self) -> Heights<'_> {
        match self {
            Self::U8(samples) => Heights::U8(samples),
            Self::U16(samples) => Heights::U16(samples),
            Self::F32(samples) => Heights::F32(samples),
        }
    }

    pub fn as_mut(&mut self) -> HeightsMut<'_> {
        match self {
            Self::U8(samples) => HeightsMut::U8(samples),
            Self::U16(samples) => HeightsMut::U16(samples),
            Self::F32(samples) => HeightsMut::F32(samples),
        }
    }
}

impl DecodedWhole {
    /// The samples of `layout` that `decode` gives; it holds `beside` more bytes.
    pub fn new(layout: Layout, beside: u64, decode: impl FnMut() -> Result<Samples> + Send + 'static) -> Self {
        Self { layout, beside, decode: Box::new(decode), samples: None, next_row: 0 }
    }
}

impl SampleRows for DecodedWhole {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        let samples = match self.samples.take() {
            Some(samples) => samples,
            None => (self.decode)()?,
        };
        let (count, from) = (len(&rows), self.next_row * self.layout.per_row());
        copy(part(samples.as_ref(), from..from + count), &mut rows);
        self.samples = Some(samples);
        self.next_row += count / self.layout.per_row();
        Ok(())
    }

    fn seek(&mut self, row: usize) -> Result<()> {
        self.next_row = row;
        Ok(())
    }

    fn last_row_is_near(&self) -> bool {
        true
    }

    fn held_bytes(&self) -> u64 {
        (self.layout.row_bytes() * self.layout.size.height()) as u64 + self.beside
    }
}

/// Number of samples.
pub(super) fn len(samples: &HeightsMut<'_>) -> usize {
    match samples {
        HeightsMut::U8(samples) => samples.len(),
        HeightsMut::U16(samples) => samples.len(),
        HeightsMut::F32(samples) => samples.len(),
    }
}

/// The samples `range`.
pub(super) fn part(samples: Heights<'_>, range: std::ops::Range<usize>) -> Heights<'_> {
    match samples {
        Heights::U8(samples) => Heights::U8(&samples[range]),
        Heights::U16(samples) => Heights::U16(&samples[range]),
        Heights::F32(samples) => Heights::F32(&samples[range]),
    }
}

/// The samples `range`, to write.
pub(super) fn part_mut<'a>(samples: &'a mut HeightsMut<'_>, range: std::ops::Range<usize>) -> HeightsMut<'a> {
    match samples {
        HeightsMut::U8(samples) => HeightsMut::U8(&mut samples[range]),
        HeightsMut::U16(samples) => HeightsMut::U16(&mut samples[range]),
        HeightsMut::F32(samples) => HeightsMut::F32(&mut samples[range]),
    }
}

/// Copies samples of the same type and number.
pub(super) fn copy(from: Heights<'_>, to: &mut HeightsMut<'_>) {
    match (from, to) {
        (Heights::U8(from), HeightsMut::U8(to)) => to.copy_from_slice(from),
        (Heights::U16(from), HeightsMut::U16(to)) => to.copy_from_slice(from),
        (Heights::F32(from), HeightsMut::F32(to)) => to.copy_from_slice(from),
        _ => unreachable!("rows are asked for in the file's own type"),
    }
}

/// Samples as bytes in this machine's order.
pub(super) fn bytes_mut<'a>(samples: &'a mut HeightsMut<'_>) -> &'a mut [u8] {
    match samples {
        HeightsMut::U8(samples) => samples,
        HeightsMut::U16(samples) => bytemuck::cast_slice_mut(samples),
        HeightsMut::F32(samples) => bytemuck::cast_slice_mut(samples),
    }
}
