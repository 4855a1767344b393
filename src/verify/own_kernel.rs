//! Another crate's own kernel beside its twin on the CPU.

use super::shrink::{Try, shrink, simpler_integers};
use super::subject::Subject;
pub use crate::backend::gpu::Binding;
use crate::error::{Error, Result};
use serde::Serialize;
use std::ops::{ControlFlow, Range};

/// A compute kernel in WGSL, and what a binding is to it.
///
/// ```
/// use texbake::verify::{Binding, OwnKernel, Subject, Tolerance, Work};
///
/// let kernel = OwnKernel {
///     wgsl: "
/// @group(0) @binding(0) var<storage, read> a: array<u32>;
/// @group(0) @binding(1) var<storage, read_write> doubled: array<u32>;
/// @compute @workgroup_size(64)
/// fn double(@builtin(global_invocation_id) id: vec3<u32>) {
///     if (id.x < arrayLength(&a)) { doubled[id.x] = 2u * a[id.x]; }
/// }",
///     entry_point: "double",
///     constants: &[],
///     bindings: &[Binding::Read, Binding::ReadWrite],
/// };
/// // Outputs hold what cannot be an answer, so that a word that is not written is noticed.
/// let work = Work { buffers: vec![(0..100).collect(), vec![0xdead_beef; 100]], workgroups: [2, 1, 1] };
/// let twin = |work: &Work| vec![work.buffers[0].iter().map(|a| 2 * a).collect()];
/// // A machine without any adapter proves nothing.
/// let Ok(subject) = Subject::adapter(None) else { return Ok(()) };
/// let comparison = subject.compare(&kernel, &twin, &work, Tolerance::Bits)?;
/// assert!(comparison.passed(), "{comparison:?}");
/// # Ok::<(), texbake::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnKernel<'a> {
    /// The text.
    pub wgsl: &'a str,
    /// The compute entry point.
    pub entry_point: &'a str,
    /// The values of its overrides.
    pub constants: &'a [(&'a str, f64)],
    /// The bindings of group 0, in order; all hold words of 32 bits, or none.
    pub bindings: &'a [Binding],
}

/// What a kernel is run on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Work {
    /// The words of each binding, before the kernel runs.
    pub buffers: Vec<Vec<u32>>,
    /// Workgroups along x, y and z.
    pub workgroups: [u32; 3],
}

/// When two words agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tolerance {
    /// Their bits are the same.
    Bits,
    /// As f32 they are at most so many floats apart; NaN agrees with NaN alone.
    Floats(u32),
}

/// How a kernel and its twin agree.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct KernelComparison {
    /// Words that were compared.
    pub values: u64,
    /// Those that do not agree.
    pub differing: u64,
    /// The most that two words are apart, in floats; of bits 0 or 1.
    pub largest: u32,
    /// The first difference, with the simplest inputs that show it.
    pub mismatch: Option<WordMismatch>,
}

/// A word on which a kernel and its twin do not agree.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WordMismatch {
    /// The words of each binding: many of them zero, if that still shows the difference.
    pub buffers: Vec<Vec<u32>>,
    /// The binding of the word.
    pub binding: usize,
    /// Its place in the buffer.
    pub word: usize,
    /// The kernel's answer.
    pub kernel: u32,
    /// The twin's.
    pub twin: u32,
}

impl KernelComparison {
    /// Whether words were compared, and all agree.
    pub fn passed(&self) -> bool {
        self.values > 0 && self.differing == 0
    }
}

impl Subject {
    /// Runs a kernel and its twin on the same words and compares the buffers that the kernel may write, word by word;
    /// of a difference the simplest inputs that show it are searched.
    ///
    /// The twin gives the words of each [`Binding::ReadWrite`] buffer, in their order, after the work is done. Buffers
    /// keep their lengths while inputs are simplified; a twin that knows no answer for simpler ones gives no buffers.
    /// Uniforms and textures stay as they are.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is not a buffer for each binding, a texture has not a word for each texel, or the
    /// twin gives other buffers than the kernel may write; [`Error::Device`] if the kernel does not compile, does not
    /// fit its bindings, or the device does not filter what a texture holds ([`Binding::Sampler`]), or fails; or this is
    /// no GPU.
    pub fn compare(
        &self,
        kernel: &OwnKernel<'_>,
        twin: &dyn Fn(&Work) -> Vec<Vec<u32>>,
        work: &Work,
        tolerance: Tolerance,
    ) -> Result<KernelComparison> {
        let Some(gpu) = self.gpu() else {
            return Err(Error::device(self.name(), "it runs no WGSL; compare on an adapter"));
        };
        let pipeline = gpu.compile(kernel.wgsl, kernel.entry_point, kernel.constants)?;
        let both = |work: &Work| -> Result<[Vec<Vec<u32>>; 2]> {
            let buffers: Vec<_> = kernel.bindings.iter().copied().zip(work.buffers.iter().map(Vec::as_slice)).collect();
            Ok([pipeline.run(&buffers, work.workgroups)?, twin(work)])
        };
        if work.buffers.len() != kernel.bindings.len() {
            let range = format!("{}, one for each binding", kernel.bindings.len());
            return Err(Error::parameter("buffers", work.buffers.len(), range));
        }
        let [got, expected] = both(work)?;
        let lengths = |buffers: &[Vec<u32>]| buffers.iter().map(Vec::len).collect::<Vec<_>>();
        if lengths(&got) != lengths(&expected) {
            let range = format!("{:?}, those of the buffers that the kernel may write", lengths(&got));
            return Err(Error::parameter("lengths of the twin's buffers", format!("{:?}", lengths(&expected)), range));
        }
        let mut comparison = KernelComparison { values: 0, differing: 0, largest: 0, mismatch: None };
        for (&got, &expected) in got.iter().flatten().zip(expected.iter().flatten()) {
            let distance = tolerance.distance(got, expected);
            comparison.values += 1;
            comparison.differing += u64::from(distance > tolerance.most());
            comparison.largest = comparison.largest.max(distance);
        }
        let first = |work: &Work| {
            let [got, expected] = both(work).ok()?;
            (lengths(&got) == lengths(&expected)).then(|| tolerance.first_difference(&got, &expected))?
        };
        if let Some(found) = tolerance.first_difference(&got, &expected) {
            let (work, found) =
                shrink((work.clone(), found), |work, _, try_| simpler(work, kernel.bindings, try_), first);
            comparison.mismatch = Some(found.describe(work, kernel.bindings));
        }
        Ok(comparison)
    }
}

/// A word that differs: in which of the written buffers, where, and both answers.
#[derive(Debug, Clone, Copy)]
struct Found {
    written: usize,
    word: usize,
    kernel: u32,
    twin: u32,
}

impl Found {
    fn describe(self, work: Work, bindings: &[Binding]) -> WordMismatch {
        let mut written = (0..bindings.len()).filter(|&binding| bindings[binding] == Binding::ReadWrite);
        let binding = written.nth(self.written).unwrap_or_default();
        let Self { word, kernel, twin, .. } = self;
        WordMismatch { buffers: work.buffers, binding, word, kernel, twin }
    }
}

impl Tolerance {
    fn most(self) -> u32 {
        match self {
            Self::Bits => 0,
            Self::Floats(most) => most,
        }
    }

    fn distance(self, a: u32, b: u32) -> u32 {
        match self {
            Self::Bits => u32::from(a != b),
            Self::Floats(_) => match [a, b].map(|bits| f32::from_bits(bits).is_nan()) {
                [true, true] => 0,
                [false, false] => in_order(a).abs_diff(in_order(b)),
                _ => u32::MAX,
            },
        }
    }

    fn first_difference(self, got: &[Vec<u32>], expected: &[Vec<u32>]) -> Option<Found> {
        got.iter().zip(expected).enumerate().find_map(|(written, (got, expected))| {
            let pairs = got.iter().zip(expected).enumerate();
            pairs.into_iter().find_map(|(word, (&kernel, &twin))| {
                (self.distance(kernel, twin) > self.most()).then_some(Found { written, word, kernel, twin })
            })
        })
    }
}

/// Numbers in the order of the floats whose bits they are; both zeros are one.
fn in_order(bits: u32) -> i32 {
    let magnitude = (bits & 0x7fff_ffff) as i32;
    if bits >> 31 == 1 { -magnitude } else { magnitude }
}

/// Tries work with simpler words in a buffer that the kernel reads: a block of zeros, then one simpler word.
fn simpler(work: &Work, bindings: &[Binding], try_: Try<'_, Work>) -> ControlFlow<()> {
    for buffer in (0..bindings.len()).filter(|&buffer| bindings[buffer] == Binding::Read) {
        let words = &work.buffers[buffer];
        let mut with = |range: Range<usize>, value: u32| {
            let mut candidate = work.clone();
            candidate.buffers[buffer][range].fill(value);
            try_(candidate)
        };
        // All of them, a half, a quarter, and so on.
        let mut block = words.len();
        while block > 0 {
            for first in (0..words.len()).step_by(block) {
                let range = first..words.len().min(first + block);
                if words[range.clone()].iter().any(|&word| word != 0) {
                    with(range, 0)?;
                }
            }
            block /= 2;
        }
        for (at, &word) in words.iter().enumerate() {
            for value in simpler_integers(word).skip(1) {
                with(at..at + 1, value)?;
            }
        }
    }
    ControlFlow::Continue(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_counted_across_zero() {
        let apart = |a: f32, b: f32| Tolerance::Floats(0).distance(a.to_bits(), b.to_bits());
        assert_eq!(apart(0.0, -0.0), 0);
        assert_eq!(apart(1.0, 1.0 + f32::EPSILON), 1);
        assert_eq!(apart(f32::from_bits(1), -f32::from_bits(1)), 2);
        assert_eq!(apart(f32::NAN, 1.0), u32::MAX);
        assert_eq!(Tolerance::Bits.distance(0, 1 << 31), 1);
    }
}
