//! A count of the texels of a normal map that are no proper normals.

use crate::error::Result;
use crate::exact::CodeReading;
use crate::map::{Channels, CodesMut, CodesRef, Depth, Encoding, NormalFormat, Size};
use crate::stream::{Monitor, NormalSource};
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
    /// A length so far from 1 that no rounding gives it: more than [`Census::rounding`].
    pub non_unit: Tally,
    /// The length of [`Census::non_unit`] farthest from 1, and the first texel that has it.
    pub worst_length: Option<(f64, Texel)>,
    /// A length that rounding a unit vector to the nearest code cannot give, and coarser rounding can.
    ///
    /// To the nearest: if each component is off by at most h, the length is off by at most the root of the sum of h^2 (triangle
    /// inequality). h is half a step: 1/L for unorm, and 2/L where a component reads as zero, since all of [0, 2/L)
    /// is stored there; 1/(2L) for snorm and biased; relative to the length, 2^-10 for half floats, and floats that
    /// are halves exactly, and 2^-20 for floats, which is twice and sixteen times the rounding of a component, for
    /// arithmetic that truncates or takes a device's square root. Of a map of two channels only a length above 1
    /// counts.
    ///
    /// Coarser: up to three steps of the encoding, root 3 of them in each component. One step is what truncation,
    /// 255.999 for 255 and biased codes read as unorm lose; dither of a step either way and the rounding of it make
    /// 1.5. Three steps are 2.4 % for 8 bits. Of floats 2^-9: four steps of a half float, for an approximate root.
    pub rounding: Tally,
    /// The length of [`Census::rounding`] farthest from 1, and the first texel that has it.
    pub worst_rounding: Option<(f64, Texel)>,
    /// Floats that are NaN, infinite or beyond 65536: [`crate::Error::NoDirection`].
    pub no_direction: Tally,
    /// Texels of another length than 1 that would have it in the other encoding: of unorm codes those that are too
    /// short, if they were biased; of floats v, if they meant 2v - 1.
    fits_other: u64,
    /// Float components between 0 and 1.
    from_0_to_1: u64,
    blue: Blue,
}

/// A way in which a map seems to be misread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Misreading {
    /// Three channels of which the third is no z: it nowhere rises above zero, or is the same everywhere while x and y
    /// are not, and lengths are not 1.
    TwoChannels,
    /// Floats v between 0 and 1 that mean 2v - 1.
    UnormFloats,
}

/// Whether the third component is the same everywhere, and whether the others are.
#[derive(Debug, Clone, PartialEq, Default)]
struct Blue {
    /// The first texel.
    first: Option<[f64; 3]>,
    /// Some texel has another third component.
    varies: bool,
    /// Some texel has another first or second one; not looked at once the third varies.
    others_vary: bool,
}

/// How a texel is read and judged.
#[derive(Debug, Clone, PartialEq)]
struct Rule {
    size: Size,
    format: NormalFormat,
    codes: Option<CodeReading>,
    /// The range of the squared length over L of integers, by the number of components that read as zero.
    squares: [[f64; 2]; 4],
    /// How far from 1 a length may be that was rounded otherwise.
    coarse: f64,
}

/// What is odd about a texel.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Oddity {
    NoDirection,
    ZeroVector,
    /// z below zero, z of zero, and the length if it is not 1; whether it would be in the other encoding.
    Other {
        below_zero: bool,
        at_zero: bool,
        length: Option<f64>,
        fits_other: bool,
    },
}

/// Half floats: rounding of a component is 2^-11 at most.
const HALF_BOUND: f64 = 1.0 / 1024.0;
/// Floats: rounding of a component is 2^-24 at most.
const FLOAT_BOUND: f64 = 1.0 / 1_048_576.0;
/// Steps of integers by which a length may be off.
const COARSE_STEPS: f64 = 3.0;
/// Floats that are rounded otherwise: four steps of a half below 1.
const COARSE_FLOATS: f64 = 1.0 / 512.0;
/// Floats that were 8-bit unorm codes before: three steps of those.
const COARSE_UNORM: f64 = COARSE_STEPS * 2.0 / 255.0;

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
        let [below_zero, at_zero, zero_vectors, non_unit, rounding, no_direction] = [none; 6];
        Self {
            rule,
            next_row: 0,
            texels: 0,
            below_zero,
            at_zero,
            zero_vectors,
            non_unit,
            worst_length: None,
            rounding,
            worst_rounding: None,
            no_direction,
            fits_other: 0,
            from_0_to_1: 0,
            blue: Blue::default(),
        }
    }

    /// Of all rows of a map.
    ///
    /// # Errors
    /// What the source reports.
    pub fn of(source: Box<dyn NormalSource>) -> Result<Self> {
        let mut census = Self::new(source.size(), source.format());
        super::read::for_each_band(vec![source], &Monitor::default(), |_, _, layers| {
            census.add_rows(layers[0]);
            Ok(())
        })?;
        Ok(census)
    }

    /// Texels whose z the rule raises to the least above zero wherever normals are blended.
    pub fn raised(&self) -> u64 {
        self.below_zero.count + self.at_zero.count + self.zero_vectors.count
    }

    /// How the map seems to be misread, once all rows were looked at.
    pub fn misreading(&self) -> Option<Misreading> {
        let format = self.rule.format;
        if format.channels != Channels::Xyz || self.texels == 0 {
            return None;
        }
        let off = self.non_unit.count + self.rounding.count;
        let codes = 3 * self.texels;
        if self.from_0_to_1 == codes && 2 * off > self.texels && self.mostly_fits_other() {
            return Some(Misreading::UnormFloats);
        }
        // Slopes beyond what the encoding can tell have z of zero by right, and length 1.
        let is_steep = self.at_zero.count == self.texels && self.non_unit.count == 0;
        let never_rises = self.raised() == self.texels && !is_steep;
        let is_filled = !self.blue.varies && self.blue.others_vary && self.non_unit.count > 0;
        (never_rises || is_filled).then_some(Misreading::TwoChannels)
    }

    /// Whether codes read as unorm seem to be biased ones: most that are off are too short, and not so if read so.
    pub fn seems_biased(&self) -> bool {
        self.rule.format.encoding == Encoding::Unorm && self.fits_other > 0 && self.mostly_fits_other()
    }

    fn mostly_fits_other(&self) -> bool {
        10 * self.fits_other >= 9 * (self.non_unit.count + self.rounding.count)
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
            Channels::Xyz => {
                self.blue.add(codes, |code| f64::from(Into::<u32>::into(code)));
                self.add(codes.chunks_exact(3), width, |rule, texel| {
                    let [x, y, z] = [component(texel[0]), component(texel[1]), component(texel[2])];
                    rule.of_integers(x, y, Some(z))
                })
            }
            Channels::Xy => self.add(codes.chunks_exact(2), width, |rule, texel| {
                rule.of_integers(component(texel[0]), component(texel[1]), None)
            }),
        }
    }

    fn add_floats<T: Copy>(&mut self, codes: &[T], width: usize, float: impl Fn(T) -> f32) {
        match self.rule.format.channels {
            Channels::Xyz => {
                self.blue.add(codes, |code| float(code).into());
                self.from_0_to_1 += codes.iter().filter(|code| (0.0..=1.0).contains(&float(**code))).count() as u64;
                self.add(codes.chunks_exact(3), width, |rule, texel| {
                    rule.of_floats(float(texel[0]), float(texel[1]), Some(float(texel[2])))
                })
            }
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
            Oddity::Other { below_zero, at_zero, length, fits_other } => {
                if below_zero {
                    self.below_zero.add(texel);
                }
                if at_zero {
                    self.at_zero.add(texel);
                }
                self.fits_other += u64::from(fits_other);
                if let Some(length) = length {
                    let off = |length: f64| (length - 1.0).abs();
                    let (tally, worst) = if off(length) <= self.rule.coarse {
                        (&mut self.rounding, &mut self.worst_rounding)
                    } else {
                        (&mut self.non_unit, &mut self.worst_length)
                    };
                    tally.add(texel);
                    if worst.is_none_or(|(worst, _)| off(length) > off(worst)) {
                        *worst = Some((length, texel));
                    }
                }
            }
        }
    }
}

impl Blue {
    /// Looks at texels of three codes; few of them, as soon as the third varies.
    fn add<T: Copy>(&mut self, codes: &[T], number: impl Fn(T) -> f64) {
        let mut texels = codes.chunks_exact(3).map(|texel| [number(texel[0]), number(texel[1]), number(texel[2])]);
        if self.varies {
            return;
        }
        let Some([x, y, z]) = self.first.or_else(|| texels.next()) else { return };
        self.first = Some([x, y, z]);
        for texel in texels {
            self.others_vary |= texel[0] != x || texel[1] != y;
            if texel[2] != z {
                self.varies = true;
                return;
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
        let step = |reading: CodeReading| f64::from(reading.factor) / f64::from(reading.greatest);
        // A hair more: lengths are rounded roots.
        let coarse = (1.0 + 1e-9) * codes.map_or(COARSE_FLOATS, |reading| COARSE_STEPS * step(reading));
        Self { size, format, codes, squares, coarse }
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
        let fits_other = (sum as f64) < least && z.is_some_and(|z| self.is_unit_if_biased([x, y, z]));
        let (below_zero, at_zero) = (stored < 0, stored == 0);
        Some(Oddity::Other { below_zero, at_zero, length: (!is_unit).then(length), fits_other })
    }

    #[inline(always)]
    fn of_floats(&self, x: f32, y: f32, z: Option<f32>) -> Option<Oddity> {
        let is_within = |component: f32| component.abs() <= NormalFormat::GREATEST_COMPONENT;
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
        let fits_other = !is_unit && z.is_some_and(|z| is_unit_if_unorm([x, y, z]));
        Some(Oddity::Other { below_zero, at_zero, length: (!is_unit).then(|| sum.sqrt()), fits_other })
    }

    /// Whether unorm codes have the length 1 if they are biased ones, rounded to the nearest.
    fn is_unit_if_biased(&self, components: [i32; 3]) -> bool {
        let Some(CodeReading { factor: 2, greatest, .. }) = self.codes else { return false };
        // u = 2c - L, so c - (L + 1)/2 is (u - 1)/2, and zero where u was read as zero.
        let square = |u: i32| if u == 0 { 0 } else { i64::from((u - 1) / 2).pow(2) };
        let length = (components.map(square).iter().sum::<i64>() as f64).sqrt();
        (length - f64::from(greatest / 2)).abs() <= 0.75f64.sqrt()
    }
}

/// Whether floats between 0 and 1 have the length 1 as 2v - 1.
fn is_unit_if_unorm(stored: [f32; 3]) -> bool {
    let square = |v: f32| (2.0 * f64::from(v) - 1.0).powi(2);
    let length = stored.map(square).iter().sum::<f64>().sqrt();
    stored.iter().all(|v| (0.0..=1.0).contains(v)) && (length - 1.0).abs() <= COARSE_UNORM
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

    fn held_bytes(&self) -> u64 {
        self.source.held_bytes()
    }
}
