//! How two normal maps differ.

use super::angle::{self, has_direction};
use super::census::Texel;
use super::read::for_each_band;
use crate::error::{Error, Result};
use crate::exact::CodeReading;
use crate::map::{Channels, CodesRef, NormalFormat, Size};
use crate::stream::{Monitor, NormalSource};
use rayon::prelude::*;

/// The differences between two normal maps of one size.
///
/// The angle of a texel is atan2(|a x b|, a . b) in degrees, in f64, of both normals as they are stored: whatever
/// their length, z of two channels as sqrt(1 - x^2 - y^2), green as the first map has it; it is kept as f32. NaN,
/// infinities and zero vectors have no direction and so no angle, but the same texel in the same format has angle 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Width and height of both.
    pub size: Size,
    /// What the codes of either mean.
    pub formats: [NormalFormat; 2],
    /// Differences of codes, if the formats are equal.
    pub codes: Option<CodeDifference>,
    /// The largest angle in degrees, and the first texel that has it; `None` if no texel has an angle.
    pub largest: Option<(f32, Texel)>,
    /// Mean of the angles in degrees.
    pub mean: f64,
    /// The angle in degrees that 99 of 100 texels do not exceed.
    ///
    /// Its rank is exact, ceil(0.99 n) of n angles in their order; its value is cut to 12 bits behind the leading one,
    /// so it is too small by 1/4096 of itself at most.
    pub percentile_99: f32,
    /// Texels that differ: in a code if the formats are equal, else by an angle above zero or by having none.
    pub differing: u64,
    /// Texels whose angle is above the tolerance.
    pub above_tolerance: u64,
    /// Texels without an angle, since one map has no direction there, or both have not. NaN is equal to nothing.
    pub no_angle: u64,
}

/// Differences of the codes of two maps of one format: of integers in codes, of floats in components.
#[derive(Debug, Clone, PartialEq)]
pub struct CodeDifference {
    /// The largest of each channel.
    pub largest: Vec<f64>,
    /// The mean of each channel.
    pub mean: Vec<f64>,
}

impl CodeDifference {
    /// The largest of all channels.
    pub fn largest_of_all(&self) -> f64 {
        self.largest.iter().copied().fold(0.0, f64::max)
    }

    /// The mean over all channels.
    pub fn mean_of_all(&self) -> f64 {
        self.mean.iter().sum::<f64>() / self.mean.len() as f64
    }
}

impl Difference {
    /// Compares two maps, row by row, and counts the angles above `tolerance` degrees.
    ///
    /// ```
    /// use texbake::inspect::Difference;
    /// use texbake::stream::Monitor;
    /// use texbake::{Codes, NormalFormat, NormalMap, Size};
    ///
    /// let map = |codes| NormalMap::new(Size::new(1, 1)?, NormalFormat::default(), Codes::U8(codes));
    /// let (flat, slope) = (map(vec![128, 128, 255])?, map(vec![218, 128, 218])?);
    /// let difference = Difference::between(flat.into_rows(), slope.into_rows(), 10.0, &Monitor::default())?;
    /// assert_eq!(difference.largest.map(|(degrees, _)| degrees), Some(45.0));
    /// assert_eq!(difference.above_tolerance, 1);
    /// # Ok::<(), texbake::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if the sizes differ; what the sources report; [`Error::Cancelled`] if `monitor` says so;
    /// [`Error::Threads`].
    pub fn between(
        a: Box<dyn NormalSource>,
        b: Box<dyn NormalSource>,
        tolerance: f64,
        monitor: &Monitor,
    ) -> Result<Self> {
        let (size, formats) = (a.size(), [a.format(), b.format()]);
        let mut sums = Sums::new(size, formats, tolerance);
        for_each_pair_of_rows([a, b], monitor, |row, pair, angles| {
            sums.add(row, pair, angles);
            Ok(())
        })?;
        Ok(sums.result())
    }

    /// Whether the maps differ by more than a tolerance in degrees. With a tolerance of 0 maps of one format must have
    /// the same codes; otherwise only angles count, and a texel without an angle is beyond any.
    pub fn exceeds(&self, tolerance: f64) -> bool {
        let is_beyond = self.largest.is_some_and(|(degrees, _)| f64::from(degrees) > tolerance);
        is_beyond || self.no_angle > 0 || tolerance <= 0.0 && self.differing > 0
    }
}

/// A texel's two normals have no angle between them.
pub(super) const NO_ANGLE: f32 = f32::NAN;

/// Gives `look` each row of two maps, and the angles between their normals in degrees, [`NO_ANGLE`] where there is
/// none.
///
/// # Errors
/// [`Error::Parameter`] if the sizes differ; what the sources and `look` report; [`Error::Cancelled`];
/// [`Error::Threads`].
pub(super) fn for_each_pair_of_rows(
    [a, b]: [Box<dyn NormalSource>; 2],
    monitor: &Monitor,
    mut look: impl FnMut(usize, [CodesRef<'_>; 2], &[f32]) -> Result<()>,
) -> Result<()> {
    let size = a.size();
    if b.size() != size {
        return Err(Error::parameter("size of the second map", b.size(), format!("{size}, as the first map's")));
    }
    let formats = [a.format(), b.format()];
    let directions = formats.map(Directions::new);
    let turns = if formats[0].convention == formats[1].convention { 1.0 } else { -1.0 };
    let is_same_format = formats[0] == formats[1];
    let mut angles = Vec::new();
    for_each_band(vec![a, b], monitor, |first_row, rows, layers| {
        let row_of = |layer: usize, row: usize| {
            let row_codes = layers[layer].len() / rows;
            layers[layer].slice(row * row_codes..(row + 1) * row_codes)
        };
        angles.resize(rows * size.width(), 0.0);
        angles.par_chunks_exact_mut(size.width()).enumerate().for_each(|(row, angles)| {
            let [a, b] = [row_of(0, row), row_of(1, row)];
            for (texel, angle) in angles.iter_mut().enumerate() {
                let [from, [x, y, z]] = [directions[0].of(a, texel), directions[1].of(b, texel)];
                let to = [x, turns * y, z];
                *angle = if is_same_format && from == to { 0.0 } else { degrees(from, to) };
            }
        });
        let mut all = angles.chunks_exact(size.width()).enumerate();
        all.try_for_each(|(row, angles)| look(first_row + row, [row_of(0, row), row_of(1, row)], angles))
    })
}

/// How texels become directions of any length.
struct Directions {
    channels: Channels,
    codes: Option<CodeReading>,
}

impl Directions {
    fn new(format: NormalFormat) -> Self {
        Self { channels: format.channels, codes: CodeReading::new(format.texel()) }
    }

    #[inline(always)]
    fn of(&self, codes: CodesRef<'_>, texel: usize) -> [f64; 3] {
        let at = texel * self.channels.count();
        // Integers over L: exact, and as long as they are wanted.
        let component = |channel: usize| match (codes, &self.codes) {
            (CodesRef::U8(codes), Some(reading)) => reading.component(codes[at + channel].into()).into(),
            (CodesRef::U16(codes), Some(reading)) => reading.component(codes[at + channel].into()).into(),
            (CodesRef::F16(codes), _) => codes[at + channel].to_f64(),
            (CodesRef::F32(codes), _) => codes[at + channel].into(),
            _ => f64::NAN,
        };
        let unit = self.codes.map_or(1.0, |reading| reading.greatest.into());
        let [x, y] = [component(0), component(1)];
        let z = match self.channels {
            Channels::Xyz => component(2),
            // NaN stays NaN, which max would lose.
            Channels::Xy if (unit * unit - x * x - y * y) < 0.0 => 0.0,
            Channels::Xy => (unit * unit - x * x - y * y).sqrt(),
        };
        [x, y, z]
    }
}

/// The angle between two vectors, if both have a direction.
fn degrees(a: [f64; 3], b: [f64; 3]) -> f32 {
    if has_direction(a) && has_direction(b) { angle::degrees(a, b) as f32 } else { NO_ANGLE }
}

/// Sums over the rows.
struct Sums {
    size: Size,
    formats: [NormalFormat; 2],
    largest: Option<(f32, Texel)>,
    sum: f64,
    histogram: Histogram,
    differing: u64,
    tolerance: f64,
    above_tolerance: u64,
    no_angle: u64,
    codes: Option<CodeSums>,
}

/// Of codes, by channel.
struct CodeSums {
    reading: Option<CodeReading>,
    largest: Vec<f64>,
    sum: Vec<f64>,
}

impl Sums {
    fn new(size: Size, formats: [NormalFormat; 2], tolerance: f64) -> Self {
        let channels = formats[0].channels.count();
        let codes = || CodeSums {
            reading: CodeReading::new(formats[0].texel()),
            largest: vec![0.0; channels],
            sum: vec![0.0; channels],
        };
        Self {
            size,
            formats,
            largest: None,
            sum: 0.0,
            histogram: Histogram::new(),
            differing: 0,
            tolerance,
            above_tolerance: 0,
            no_angle: 0,
            codes: (formats[0] == formats[1]).then(codes),
        }
    }

    fn add(&mut self, y: usize, [a, b]: [CodesRef<'_>; 2], angles: &[f32]) {
        let mut of_row = 0.0;
        for (x, angle) in angles.iter().enumerate() {
            let codes_differ = self.codes.as_mut().map(|codes| codes.add(a, b, x));
            if angle.is_nan() {
                self.no_angle += 1;
            } else {
                of_row += f64::from(*angle);
                self.histogram.add(*angle);
                self.above_tolerance += u64::from(f64::from(*angle) > self.tolerance);
                if self.largest.is_none_or(|(largest, _)| *angle > largest) {
                    self.largest = Some((*angle, Texel { x, y }));
                }
            }
            self.differing += u64::from(codes_differ.unwrap_or(angle.is_nan() || *angle > 0.0));
        }
        self.sum += of_row;
    }

    fn result(self) -> Difference {
        let texels = self.size.texels() as f64;
        let codes = self.codes.map(|codes| CodeDifference {
            largest: codes.largest,
            mean: codes.sum.iter().map(|sum| sum / texels).collect(),
        });
        let angles = self.size.texels() as u64 - self.no_angle;
        Difference {
            size: self.size,
            formats: self.formats,
            codes,
            largest: self.largest,
            mean: if angles == 0 { 0.0 } else { self.sum / angles as f64 },
            percentile_99: self.histogram.percentile(99),
            differing: self.differing,
            above_tolerance: self.above_tolerance,
            no_angle: self.no_angle,
        }
    }
}

impl CodeSums {
    /// Adds a texel; whether a code differs.
    fn add(&mut self, a: CodesRef<'_>, b: CodesRef<'_>, texel: usize) -> bool {
        let channels = self.largest.len();
        let mut differs = false;
        for channel in 0..channels {
            let at = texel * channels + channel;
            let [a, b] = [a, b].map(|codes| self.number(codes, at));
            differs |= a != b;
            // NaN differs by no number.
            let difference = (a - b).abs();
            if difference > 0.0 {
                self.largest[channel] = self.largest[channel].max(difference);
                self.sum[channel] += difference;
            }
        }
        differs
    }

    /// A code as a number; those of snorm with their sign.
    fn number(&self, codes: CodesRef<'_>, at: usize) -> f64 {
        let flip = self.reading.map_or(0, |reading| reading.flip);
        match codes {
            CodesRef::U8(codes) => (u32::from(codes[at]) ^ flip).into(),
            CodesRef::U16(codes) => (u32::from(codes[at]) ^ flip).into(),
            CodesRef::F16(codes) => codes[at].to_f64(),
            CodesRef::F32(codes) => codes[at].into(),
        }
    }
}

/// Angles up to 180 degrees, counted by the leading bits of their f32: the exponent, and 12 bits of the fraction.
struct Histogram(Vec<u64>);

/// The bits of the fraction that are cut off.
const CUT: u32 = 23 - 12;

impl Histogram {
    fn new() -> Self {
        Self(vec![0; (180f32.to_bits() >> CUT) as usize + 1])
    }

    fn add(&mut self, angle: f32) {
        let last = self.0.len() - 1;
        self.0[last.min((angle.to_bits() >> CUT) as usize)] += 1;
    }

    /// The angle of rank ceil(percent n / 100), cut to the bits that are counted; 0 if there is none.
    fn percentile(&self, percent: u64) -> f32 {
        let total: u64 = self.0.iter().sum();
        let rank = (total * percent).div_ceil(100).max(1);
        let mut below = 0;
        let is_reached = |count: &u64| {
            below += count;
            below >= rank
        };
        self.0.iter().position(is_reached).map_or(0.0, |bucket| f32::from_bits((bucket as u32) << CUT))
    }
}
