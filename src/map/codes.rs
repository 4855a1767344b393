//! Codes of a map in their storage type.

use super::Depth;
use half::f16;

/// Codes in rows; snorm codes stand as the two's complement of their bits.
#[derive(Debug, Clone, PartialEq)]
pub enum Codes {
    /// 8-bit integers.
    U8(Vec<u8>),
    /// 16-bit integers.
    U16(Vec<u16>),
    /// Half floats.
    F16(Vec<f16>),
    /// Floats.
    F32(Vec<f32>),
}

/// Codes in rows, borrowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CodesRef<'a> {
    /// 8-bit integers.
    U8(&'a [u8]),
    /// 16-bit integers.
    U16(&'a [u16]),
    /// Half floats.
    F16(&'a [f16]),
    /// Floats.
    F32(&'a [f32]),
}

/// Room for codes in rows.
#[derive(Debug)]
pub enum CodesMut<'a> {
    /// 8-bit integers.
    U8(&'a mut [u8]),
    /// 16-bit integers.
    U16(&'a mut [u16]),
    /// Half floats.
    F16(&'a mut [f16]),
    /// Floats.
    F32(&'a mut [f32]),
}

impl Codes {
    /// Room for `count` codes, all zero.
    pub fn zeroed(depth: Depth, count: usize) -> Self {
        match depth {
            Depth::Bits8 => Self::U8(vec![0; count]),
            Depth::Bits16 => Self::U16(vec![0; count]),
            Depth::Float16 => Self::F16(vec![f16::ZERO; count]),
            Depth::Float32 => Self::F32(vec![0.0; count]),
        }
    }

    /// The codes, to read.
    pub fn as_ref(&self) -> CodesRef<'_> {
        match self {
            Self::U8(codes) => CodesRef::U8(codes),
            Self::U16(codes) => CodesRef::U16(codes),
            Self::F16(codes) => CodesRef::F16(codes),
            Self::F32(codes) => CodesRef::F32(codes),
        }
    }

    /// The codes, to write.
    pub fn as_mut(&mut self) -> CodesMut<'_> {
        match self {
            Self::U8(codes) => CodesMut::U8(codes),
            Self::U16(codes) => CodesMut::U16(codes),
            Self::F16(codes) => CodesMut::F16(codes),
            Self::F32(codes) => CodesMut::F32(codes),
        }
    }
}

impl<'a> CodesRef<'a> {
    /// Number of codes.
    #[allow(clippy::len_without_is_empty, reason = "a map is never empty")]
    pub fn len(&self) -> usize {
        match self {
            Self::U8(codes) => codes.len(),
            Self::U16(codes) => codes.len(),
            Self::F16(codes) => codes.len(),
            Self::F32(codes) => codes.len(),
        }
    }

    /// How a code is stored.
    pub fn depth(&self) -> Depth {
        match self {
            Self::U8(_) => Depth::Bits8,
            Self::U16(_) => Depth::Bits16,
            Self::F16(_) => Depth::Float16,
            Self::F32(_) => Depth::Float32,
        }
    }

    /// The codes `range`.
    pub fn slice(&self, range: std::ops::Range<usize>) -> CodesRef<'a> {
        match self {
            Self::U8(codes) => CodesRef::U8(&codes[range]),
            Self::U16(codes) => CodesRef::U16(&codes[range]),
            Self::F16(codes) => CodesRef::F16(&codes[range]),
            Self::F32(codes) => CodesRef::F32(&codes[range]),
        }
    }

    /// The codes as bytes in this machine's order.
    pub fn bytes(&self) -> &'a [u8] {
        match self {
            Self::U8(codes) => codes,
            Self::U16(codes) => bytemuck::cast_slice(codes),
            Self::F16(codes) => bytemuck::cast_slice(codes),
            Self::F32(codes) => bytemuck::cast_slice(codes),
        }
    }
}

impl CodesMut<'_> {
    /// The codes, to read.
    pub fn as_ref(&self) -> CodesRef<'_> {
        match self {
            Self::U8(codes) => CodesRef::U8(codes),
            Self::U16(codes) => CodesRef::U16(codes),
            Self::F16(codes) => CodesRef::F16(codes),
            Self::F32(codes) => CodesRef::F32(codes),
        }
    }

    /// Number of codes.
    #[allow(clippy::len_without_is_empty, reason = "a map is never empty")]
    pub fn len(&self) -> usize {
        self.as_ref().len()
    }

    /// How a code is stored.
    pub fn depth(&self) -> Depth {
        self.as_ref().depth()
    }

    /// The codes `range`, to write.
    pub fn slice(&mut self, range: std::ops::Range<usize>) -> CodesMut<'_> {
        match self {
            Self::U8(codes) => CodesMut::U8(&mut codes[range]),
            Self::U16(codes) => CodesMut::U16(&mut codes[range]),
            Self::F16(codes) => CodesMut::F16(&mut codes[range]),
            Self::F32(codes) => CodesMut::F32(&mut codes[range]),
        }
    }

    /// The codes in pieces of `count`, to fill at the same time; the last piece may be shorter.
    pub fn chunks(&mut self, count: usize) -> Vec<CodesMut<'_>> {
        self.slice(0..self.len()).into_chunks(count)
    }

    /// The same pieces for as long as the room itself lasts.
    pub(crate) fn into_chunks(self, count: usize) -> Vec<Self> {
        match self {
            Self::U8(codes) => codes.chunks_mut(count).map(Self::U8).collect(),
            Self::U16(codes) => codes.chunks_mut(count).map(Self::U16).collect(),
            Self::F16(codes) => codes.chunks_mut(count).map(Self::F16).collect(),
            Self::F32(codes) => codes.chunks_mut(count).map(Self::F32).collect(),
        }
    }

    /// The codes as bytes in this machine's order.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        match self {
            Self::U8(codes) => codes,
            Self::U16(codes) => bytemuck::cast_slice_mut(codes),
            Self::F16(codes) => bytemuck::cast_slice_mut(codes),
            Self::F32(codes) => bytemuck::cast_slice_mut(codes),
        }
    }
}
