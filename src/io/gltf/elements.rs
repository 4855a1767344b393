//! The elements of accessors: dense bytes of any of glTF's layouts, and numbers out of them.

use super::document::{Document, index, range};
use crate::error::Result;
use gltf_json::Accessor;
use gltf_json::accessor::sparse::Sparse;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;

/// How many times the bytes of its positions a mesh and its tangents take, at most, while they are computed.
const UNPACKED: u64 = 32;

/// The elements of an accessor without gaps, sparse ones in place.
#[derive(Debug)]
pub(super) struct Elements {
    pub bytes: Vec<u8>,
    pub count: usize,
    /// Bytes of one element.
    pub size: usize,
    components: usize,
    component: ComponentType,
    is_normalized: bool,
}

impl Elements {
    /// How many elements an accessor claims to have.
    pub fn count(document: &Document, accessor: usize) -> Result<usize> {
        let claimed = document.object("accessors", accessor)?;
        index(claimed, "count").ok_or_else(|| document.damaged(format!("accessors[{accessor}] has no count")))
    }

    pub fn read(document: &Document, accessor: usize) -> Result<Self> {
        let damaged = |reason: &str| document.damaged(format!("accessors[{accessor}] {reason}"));
        let read: Accessor = document.typed("accessors", accessor)?;
        let (Checked::Valid(component), Checked::Valid(type_)) = (read.component_type, read.type_) else {
            return Err(damaged("has a type or a component type that glTF 2.0 does not have"));
        };
        let component = component.0;
        let size = element_size(type_, component);
        // Without a view no byte stands for what is claimed, and a mesh with its tangents takes many times as much.
        let limit = if read.buffer_view.is_none() { document.max_bytes / UNPACKED } else { u64::MAX };
        let bytes = read.count.0.checked_mul(size as u64).filter(|&bytes| bytes <= limit);
        let (Some(bytes), Ok(count)) = (bytes, usize::try_from(read.count.0)) else {
            if let Some(view) = &read.buffer_view {
                return Err(damaged(&format!("reaches beyond bufferViews[{}]", view.value())));
            }
            let reason = format!("accessors[{accessor}] claims {} elements of {size} bytes", read.count.0);
            let limit = format!("the limit is {limit} bytes, a part of --max-bytes: raise it");
            return Err(document.error(reason, limit));
        };

        let mut elements = Vec::new();
        match read.buffer_view {
            None => elements.resize(bytes as usize, 0),
            Some(view) => {
                let offset = read.byte_offset.map_or(0, |offset| offset.0);
                let (view_bytes, stride) = document.view(view.value())?;
                let strided = (offset, stride.unwrap_or(size));
                gather(view_bytes, strided, size, count, &mut elements)
                    .ok_or_else(|| damaged(&format!("reaches beyond bufferViews[{}]", view.value())))?;
            }
        }
        if let Some(sparse) = &read.sparse {
            replace(document, sparse, size, &mut elements)?
                .ok_or_else(|| damaged("has sparse elements out of range"))?;
        }
        let (components, is_normalized) = (type_.multiplicity(), read.normalized);
        Ok(Self { bytes: elements, count, size, components, component, is_normalized })
    }

    /// Vectors of N floats: f32 as they are, integers as they are or normalised (glTF 2.0, section 3.11). `None` if
    /// they have more or fewer components, or are 32-bit integers.
    pub fn floats<const N: usize>(&self) -> Option<Vec<[f32; N]>> {
        if self.components != N {
            return None;
        }
        // A signed integer's least value is -1 as well as its negated greatest.
        let signed = |value: f32, greatest: f32| if self.is_normalized { (value / greatest).max(-1.0) } else { value };
        let unsigned = |value: f32, greatest: f32| if self.is_normalized { value / greatest } else { value };
        match self.component {
            ComponentType::F32 => Some(self.vectors(|&bytes| f32::from_le_bytes(bytes))),
            ComponentType::I8 => Some(self.vectors(|&bytes| signed(i8::from_le_bytes(bytes).into(), 127.0))),
            ComponentType::U8 => Some(self.vectors(|&bytes| unsigned(u8::from_le_bytes(bytes).into(), 255.0))),
            ComponentType::I16 => Some(self.vectors(|&bytes| signed(i16::from_le_bytes(bytes).into(), 32767.0))),
            ComponentType::U16 => Some(self.vectors(|&bytes| unsigned(u16::from_le_bytes(bytes).into(), 65535.0))),
            ComponentType::U32 => None,
        }
    }

    fn vectors<const N: usize, const BYTES: usize>(&self, number: impl Fn(&[u8; BYTES]) -> f32) -> Vec<[f32; N]> {
        let (numbers, _) = self.bytes.as_chunks::<BYTES>();
        let (vectors, _) = numbers.as_chunks::<N>();
        vectors.iter().map(|vector| std::array::from_fn(|i| number(&vector[i]))).collect()
    }

    /// Indices of vertices; `None` if they are not single unsigned integers.
    pub fn indices(&self) -> Option<Vec<u32>> {
        match (self.components, self.component) {
            (1, ComponentType::U8) => Some(self.bytes.iter().map(|&byte| byte.into()).collect()),
            (1, ComponentType::U16) => {
                Some(self.bytes.as_chunks().0.iter().map(|&bytes| u16::from_le_bytes(bytes).into()).collect())
            }
            (1, ComponentType::U32) => {
                Some(self.bytes.as_chunks().0.iter().map(|&bytes| u32::from_le_bytes(bytes)).collect())
            }
            _ => None,
        }
    }
}

/// Bytes of one element. Columns of matrices begin at multiples of four (glTF 2.0, section 3.6.2.4).
fn element_size(type_: Type, component: ComponentType) -> usize {
    let size = component.size();
    let columns = |count: usize| count * (count * size).next_multiple_of(4);
    match type_ {
        Type::Mat2 => columns(2),
        Type::Mat3 => columns(3),
        Type::Mat4 => columns(4),
        Type::Scalar | Type::Vec2 | Type::Vec3 | Type::Vec4 => type_.multiplicity() * size,
    }
}

/// `count` elements of `size` bytes that begin at an offset and a stride apart; `None` if they are not all there.
fn gather(
    bytes: &[u8],
    (offset, stride): (u64, usize),
    size: usize,
    count: usize,
    elements: &mut Vec<u8>,
) -> Option<()> {
    if count == 0 {
        return Some(());
    }
    let length = (count as u64 - 1).checked_mul(stride as u64)?.checked_add(size as u64)?;
    let bytes = bytes.get(range(offset, length)?)?;
    if stride < size {
        return None;
    }
    elements.reserve_exact(count * size);
    if stride == size {
        elements.extend_from_slice(bytes);
    } else {
        bytes.chunks(stride).for_each(|chunk| elements.extend_from_slice(&chunk[..size]));
    }
    Some(())
}

/// Puts sparse elements in their places; `None` if one is out of range.
fn replace(document: &Document, sparse: &Sparse, size: usize, elements: &mut [u8]) -> Result<Option<()>> {
    let (index_bytes, _) = document.view(sparse.indices.buffer_view.value())?;
    let (value_bytes, _) = document.view(sparse.values.buffer_view.value())?;
    let Checked::Valid(component) = sparse.indices.component_type else { return Ok(None) };
    let index_size = component.0.size();
    let mut put = || {
        let count = usize::try_from(sparse.count.0).ok()?;
        let part = |offset: u64, size: usize| range(offset, sparse.count.0.checked_mul(size as u64)?);
        let indices = index_bytes.get(part(sparse.indices.byte_offset.0, index_size)?)?;
        let values = value_bytes.get(part(sparse.values.byte_offset.0, size)?)?;
        for i in 0..count {
            let mut word = [0; 4];
            word[..index_size].copy_from_slice(&indices[i * index_size..][..index_size]);
            let at = (u32::from_le_bytes(word) as usize).checked_mul(size)?;
            elements.get_mut(at..at.checked_add(size)?)?.copy_from_slice(&values[i * size..][..size]);
        }
        Some(())
    };
    Ok(put())
}
