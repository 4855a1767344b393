//! What arithmetic can mend: lengths, z at or below zero, texels without direction, and green.

use super::census::{Census, Counted};
use crate::baker::{Baker, Ran};
use crate::error::Result;
use crate::exact::CodeRounding;
use crate::map::{CodesMut, NormalFormat, Size};
use crate::ops::blend::{BlendInputs, BlendMethod, BlendOptions};
use crate::stream::{Monitor, NormalRows, NormalSource, RowsOut};
use half::f16;
use std::cell::RefCell;
use std::sync::{Arc, Mutex, PoisonError};

/// How a repair ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// Where it ran.
    pub ran: Ran,
    /// Texels of NaN, infinity or more than 65536, which are (0, 0, 1) now.
    pub flattened: u64,
    /// Texels of (0, 0, 0), which are (0, 0, 1) now.
    pub zero_vectors: u64,
}

/// Mends a normal map: the rows from `open` go into rows for `create`, in `format`.
///
/// - Every normal gets the length 1, correctly rounded for maps of integers: the map is blended with a flat one, with
///   the weights 1 and 0 ([`BlendMethod::Weighted`]).
/// - z at or below zero becomes the least above zero before that, and so a zero vector (0, 0, 1). A normal so steep
///   may be rounded to z of zero again.
/// - A texel of floats without direction becomes (0, 0, 1).
/// - Green is turned around if the convention of `format` is not that of the rows.
///
/// # Errors
/// As [`Baker::blend_rows`].
pub fn repair(
    baker: &Baker,
    open: &dyn Fn() -> Result<NormalRows>,
    create: &dyn Fn(Size) -> Result<RowsOut>,
    format: NormalFormat,
    monitor: &Monitor,
) -> Result<Repaired> {
    // Of the last try: rows of one that failed are counted again.
    let last_census: RefCell<Option<Arc<Mutex<Census>>>> = RefCell::default();
    let open = || {
        let (source, census) = Counted::new(open()?);
        last_census.replace(Some(census));
        let detail: NormalRows = Box::new(Flat { size: source.size(), format: source.format() });
        let base: NormalRows = Box::new(Flattened(source));
        Ok(BlendInputs { base, detail, mask: None })
    };
    let method = BlendMethod::Weighted { base: 1.into(), detail: 0.into() };
    let options = BlendOptions { method, format, ..BlendOptions::default() };
    let ran = baker.blend_rows(&open, create, &options, monitor)?.ran;
    let census = last_census.take();
    let [flattened, zero_vectors] = census.map_or([0; 2], |census| {
        let census = census.lock().unwrap_or_else(PoisonError::into_inner);
        [census.no_direction.count, census.zero_vectors.count]
    });
    Ok(Repaired { ran, flattened, zero_vectors })
}

const FLAT_F16: [f16; 3] = [f16::ZERO, f16::ZERO, f16::ONE];
const FLAT_F32: [f32; 3] = [0.0, 0.0, 1.0];

/// (0, 0, 1) everywhere.
struct Flat {
    size: Size,
    format: NormalFormat,
}

impl NormalSource for Flat {
    fn size(&self) -> Size {
        self.size
    }

    fn format(&self) -> NormalFormat {
        self.format
    }

    fn read(&mut self, rows: CodesMut<'_>) -> Result<()> {
        let channels = self.format.channels.count();
        match rows {
            CodesMut::U8(codes) => fill(codes, channels, self.integers().map(|code| code as u8)),
            CodesMut::U16(codes) => fill(codes, channels, self.integers().map(|code| code as u16)),
            CodesMut::F16(codes) => fill(codes, channels, FLAT_F16),
            CodesMut::F32(codes) => fill(codes, channels, FLAT_F32),
        }
        Ok(())
    }

    fn held_bytes(&self) -> u64 {
        0
    }
}

impl Flat {
    /// The integer codes of (0, 0, 1).
    fn integers(&self) -> [u32; 3] {
        CodeRounding::new(self.format.texel()).map_or([0; 3], |rounding| [0, 0, 1].map(|a| rounding.code(a, 1)))
    }
}

fn fill<T: Copy>(codes: &mut [T], channels: usize, texel: [T; 3]) {
    codes.chunks_exact_mut(channels).for_each(|codes| codes.copy_from_slice(&texel[..channels]));
}

/// A map whose texels without direction are (0, 0, 1).
struct Flattened(Counted);

impl NormalSource for Flattened {
    fn size(&self) -> Size {
        self.0.size()
    }

    fn format(&self) -> NormalFormat {
        self.0.format()
    }

    fn read(&mut self, mut rows: CodesMut<'_>) -> Result<()> {
        let all = 0..rows.len();
        self.0.read(rows.slice(all))?;
        let channels = self.format().channels.count();
        match rows {
            CodesMut::U8(_) | CodesMut::U16(_) => {}
            CodesMut::F16(codes) => flatten(codes, channels, FLAT_F16, |code| code.to_f32()),
            CodesMut::F32(codes) => flatten(codes, channels, FLAT_F32, |code| code),
        }
        Ok(())
    }

    fn held_bytes(&self) -> u64 {
        self.0.held_bytes()
    }
}

/// Makes texels without direction flat.
fn flatten<T: Copy>(codes: &mut [T], channels: usize, flat: [T; 3], float: impl Fn(T) -> f32) {
    for texel in codes.chunks_exact_mut(channels) {
        // NaN compares as not within.
        if !texel.iter().all(|code| float(*code).abs() <= NormalFormat::GREATEST_COMPONENT) {
            texel.copy_from_slice(&flat[..channels]);
        }
    }
}
