//! A count of the texels of a normal map that are no proper normals.

use crate::error::Result;
use crate::exact::CodeReading;
use crate::map::{Channels, CodesMut, CodesRef, Depth, NormalFormat, Size};
use crate::ops::GREATEST_COMPONENT;
use crate::stream::NormalSource;
use std::sync::{Arc, Mutex, PoisonError};

/// A place in a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Texel {
    /// Column, from 0 on the left.
    pub x: usize,
    /// Row, from 0 at the top.
    pub y: usize,
}

/// How many texels have a property, and the first of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Number of texels.
    pub count: u64,
    /// The first in reading order; `None` if there is none.
    pub first: Option<Texel>,
}

/// What a pass over the rows of a normal map counts.
///
/// Each texel is judged as it is stored, before the rule that raises z. One without direction counts as nothing else,
/// nor does a zero vector; others may count twice.
#[derive(Debug, Clone, PartialEq)]
pub struct Census {
    rule: Rule,
    next_row: usize,
    /// Texels that were looked at.
    pub texels: u64,
    /// A stored z below zero.
    pub below_zero: Tally,
    /// A stored z of zero: as steep as the encoding can tell.
    pub at_zero: Tally,
    /// (0, 0, 0).
    pub zero_vectors: Tally,
    /// A length that rounding a unit vector to the encoding cannot give.
    ///
    /// If each component is off by at most h, the length is off by at most the root of the sum of h^2 (triangle
    /// inequality). h is half a step: 1/L for unorm, and 2/L where a component reads as zero, since all of [0, 2/L)
    /// is stored there; 1/(2L) for snorm and biased; relative to the length, 2^-10 for half floats, and floats that
    /// are halves exactly, and 2^-20 for floats, which is twice and sixteen times the rounding of a component, for
    /// arithmetic that truncates or takes a device's square root. Of a map of two channels only a length above 1
    /// counts.
    pub non_unit: Tally,
    /// The length of [`Census::non_unit`] farthest from 1, and the first texel that has it.
    pub worst_length: Option<(f64, Texel)>,
    /// Floats that are NaN, infinite or beyond 65536: [`crate::Error::NoDirection`].
    pub no_direction: Tally,
}

/// How a texel is read and judged.
#[derive(Debug, Clone, PartialEq)]
struct Rule {
    size: Size,
    format: NormalFormat,
    codes: Option<CodeReading>,
    /// The range of the squared length over L of integers, by the number of components that read as zero.
    squares: [[f64; 2]; 4],
}

/// What is odd about a texel.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Oddity {
    NoDirection,
    ZeroVector,
    /// z below zero, z of zero, and the length if it is not 1.
    Other {
        below_zero: bool,
        at_zero: bool,
        length: Option<f64>,
    },
}

/// Half floats: rounding of a component is 2^-11 at most.
const HALF_BOUND: f64 = 1.0 / 1024.0;
/// Floats: rounding of a component is 2^-24 at most.
const FLOAT_BOUND: f64 = 1.0 / 1_048_576.0;

impl Tally {
    fn add(&mut self, texel: Texel) {
        self.count += 1;
        self.first.get_or_insert(texel);
    }
}

impl Census {
    /// Of a map whose rows are still to come.
    pub fn new(size: Size, format: NormalFormat) -> Self {
        let none = Tally::default();
        let rule = Rule::new(size, format);
        let [below_zero, at_zero, zero_vectors, non_unit, no_direction] = [none; 5];
        Self {
            rule,
            next_row: 0,
            texels: 0,
            below_zero,
            at_zero,
            zero_vectors,
            non_unit,
            worst_length: None,
            no_direction,
        }
    }

    /// Of all rows of a map.
    ///
    /// # Errors
    /// What the source reports.
    pub fn of(source: Box<dyn NormalSource>) -> Result<Self> {
        let mut census = Self::new(source.size(), source.format());
        super::read::for_each_band(vec![source], |_, _, layers| {
            census.add_rows(layers[0]);
            Ok(())
        })?;
        Ok(census)
    }

    /// Texels whose z the rule raises to the least above zero wherever normals are blended.
    pub fn raised(&self) -> u64 {
        self.below_zero.count + self.at_zero.count + self.zero_vectors.count
    }

    /// Looks at the next whole rows.
    pub fn add_rows(&mut self, rows: CodesRef<'_>) {
        let width = self.rule.size.width();
        let texels = rows.len() / self.rule.format.channels.count();
        match rows {
            CodesRef::U8(codes) => self.add_integers(codes, width),
            CodesRef::U16(codes) => self.add_integers(codes, width),
            CodesRef::F16(codes) => self.add_floats(codes, width, |code| code.to_f32()),
            CodesRef::F32(codes) => self.add_floats(codes, width, |code| code),
        }
        self.next_row += texels / width;
        self.texels += texels as u64;
    }

    fn add_integers<T: Copy + Into<u32>>(&mut self, codes: &[T], width: usize) {
        let Some(reading) = self.rule.codes else { return };
        let component = |code: T| reading.component(code.into());
        match self.rule.format.channels {
            Channels::Xyz => self.add(codes.chunks_exact(3), width, |rule, texel| {
                let [x, y, z] = [component(texel[0]), component(texel[1]), component(texel[2])];
                rule.of_integers(x, y, Some(z))
            }),
            Channels::Xy => self.add(codes.chunks_exact(2), width, |rule, texel| {
                rule.of_integers(component(texel[0]), component(texel[1]), None)
            }),
        }
    }

    fn add_floats<T: Copy>(&mut self, codes: &[T], width: usize, float: impl Fn(T) -> f32) {
        match self.rule.format.channels {
            Channels::Xyz => self.add(codes.chunks_exact(3), width, |rule, texel| {
                rule.of_floats(float(texel[0]), float(texel[1]), Some(float(texel[2])))
            }),
            Channels::Xy => self.add(codes.chunks_exact(2), width, |rule, texel| {
                rule.of_floats(float(texel[0]), float(texel[1]), None)
            }),
        }
    }

    #[inline(always)]
    fn add<T>(&mut self, texels: impl Iterator<Item = T>, width: usize, judge: impl Fn(&Rule, T) -> Option<Oddity>) {
        for (index, texel) in texels.enumerate() {
            if let Some(oddity) = judge(&self.rule, texel) {
                self.count(oddity, Texel { x: index % width, y: self.next_row + index / width });
            }
        }
    }

    #[cold]
    fn count(&mut self, oddity: Oddity, texel: Texel) {
        match oddity {
            Oddity::NoDirection => self.no_direction.add(texel),
            Oddity::ZeroVector => self.zero_vectors.add(texel),
            Oddity::Other { below_zero, at_zero, length } => {
                if below_zero {
                    self.below_zero.add(texel);
                }
                if at_zero {
                    self.at_zero.add(texel);
                }
                if let Some(length) = length {
                    self.non_unit.add(texel);
                    let is_worse = |(worst, _): (f64, Texel)| (length - 1.0).abs() > (worst - 1.0).abs();
                    if self.worst_length.is_none_or(is_worse) {
                        self.worst_length = Some((length, texel));
                    }
                }
            }
        }
    }
}

impl Rule {
    fn new(size: Size, format: NormalFormat) -> Self {
        let codes = CodeReading::new(format.texel());
        let mut squares = [[0.0, f64::INFINITY]; 4];
        if let Some(reading) = codes {
            let components = format.channels.count();
            for (zeros, range) in squares.iter_mut().enumerate().take(components + 1) {
                let bound = integer_bound(&reading, components - zeros, zeros);
                let [least, greatest] = [-bound, bound].map(|off| (f64::from(reading.greatest) + off).max(0.0).powi(2));
                *range = [if format.channels == Channels::Xyz { least } else { 0.0 }, greatest];
            }
        }
        Self { size, format, codes, squares }
    }

    #[inline(always)]
    fn of_integers(&self, x: i32, y: i32, z: Option<i32>) -> Option<Oddity> {
        let square = |u: i32| i64::from(u) * i64::from(u);
        let stored = z.unwrap_or(1);
        let sum = square(x) + square(y) + square(z.unwrap_or(0));
        let zeros = usize::from(x == 0) + usize::from(y == 0) + usize::from(stored == 0);
        let [least, greatest] = self.squares[zeros];
        // Below 2^53, so that the sum is exact.
        let is_unit = (least..=greatest).contains(&(sum as f64));
        if is_unit && stored > 0 {
            return None;
        }
        if zeros == 3 {
            return Some(Oddity::ZeroVector);
        }
        let length = || (sum as f64).sqrt() / self.codes.map_or(1.0, |codes| codes.greatest.into());
        Some(Oddity::Other { below_zero: stored < 0, at_zero: stored == 0, length: (!is_unit).then(length) })
    }

    #[inline(always)]
    fn of_floats(&self, x: f32, y: f32, z: Option<f32>) -> Option<Oddity> {
        let is_within = |component: f32| component.abs() <= GREATEST_COMPONENT;
        if !(is_within(x) && is_within(y) && z.is_none_or(is_within)) {
            return Some(Oddity::NoDirection);
        }
        let square = |component: f32| f64::from(component) * f64::from(component);
        let sum = square(x) + square(y) + z.map_or(0.0, square);
        // The 13 bits that a float has beyond a half.
        let are_halves = (x.to_bits() | y.to_bits() | z.map_or(0, f32::to_bits)) & 0x1fff == 0;
        let bound = if are_halves || self.format.depth == Depth::Float16 { HALF_BOUND } else { FLOAT_BOUND };
        let stored = z.unwrap_or(1.0);
        let is_unit = sum <= (1.0 + bound) * (1.0 + bound) && (z.is_none() || sum >= (1.0 - bound) * (1.0 - bound));
        if is_unit && stored > 0.0 {
            return None;
        }
        if z.is_some() && sum == 0.0 {
            return Some(Oddity::ZeroVector);
        }
        let (below_zero, at_zero) = (stored < 0.0, stored == 0.0);
        Some(Oddity::Other { below_zero, at_zero, length: (!is_unit).then(|| sum.sqrt()) })
    }
}

/// How far, in units of 1/L, rounding may move the length of a vector with so many components beside zero and at it.
fn integer_bound(reading: &CodeReading, beside: usize, zeros: usize) -> f64 {
    let half_step = f64::from(reading.factor) / 2.0;
    // Only unorm has no code for zero itself.
    let at_zero = if reading.factor == 2 { 2.0 } else { half_step };
    (beside as f64 * half_step * half_step + zeros as f64 * at_zero * at_zero).sqrt()
}

/// A normal map that is counted while something else reads it.
pub struct Counted {
    source: Box<dyn NormalSource>,
    census: Arc<Mutex<Census>>,
}

impl Counted {
    /// The map, and what will be known of it once its rows have been read.
    pub fn new(source: Box<dyn NormalSource>) -> (Self, Arc<Mutex<Census>>) {
        let census = Arc::new(Mutex::new(Census::new(source.size(), source.format())));
        (Self { source, census: census.clone() }, census)
    }
}

impl NormalSource for Counted {
    fn size(&self) -> Size {
        self.source.size()
    }

    fn format(&self) -> NormalFormat {
        self.source.format()
    }

    fn read(&mut self, mut rows: CodesMut<'_>) -> Result<()> {
        let all = 0..rows.len();
        self.source.read(rows.slice(all))?;
        self.census.lock().unwrap_or_else(PoisonError::into_inner).add_rows(rows.as_ref());
        Ok(())
    }
}
