//! What is wrong with a normal map, in words and numbers.

use super::banding::{Banding, BandingTest};
use super::census::{Census, Misreading, Tally, Texel};
use super::green::{Green, GreenTest};
use super::read::{Components, for_each_band};
use super::seams::{Seam, SeamTest, Seams};
use crate::error::Result;
use crate::io::{NormalFile, NormalReadOptions, open_normals};
use crate::map::{Convention, NormalFormat, Size};
use crate::names::named;
use crate::stream::{Monitor, NormalSource};
use std::fmt;
use std::path::Path;

/// What is expected of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CheckOptions {
    /// The map is repeated: a seam is a fault. Otherwise it is a note, since not every map is made to tile.
    pub tiles: bool,
}

/// What a check of a normal map found.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// Width and height.
    pub size: Size,
    /// What its codes mean, as they were read.
    pub format: NormalFormat,
    /// The texels that are no proper normals.
    pub census: Census,
    /// Which way green points.
    pub green: Green,
    /// The steps at the edges.
    pub seams: Seams,
    /// The steps of 8 bits.
    pub banding: Banding,
    /// What is wrong or worth knowing, faults first.
    pub list: Vec<Finding>,
}

/// One thing that is wrong with a map, or worth knowing.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What kind of thing.
    pub problem: Problem,
    /// How bad it is.
    pub severity: Severity,
    /// How many texels it concerns, where texels can be counted.
    pub texels: Option<u64>,
    /// Their share of the map, from 0 to 1.
    pub share: Option<f64>,
    /// How far it goes, in the measure of [`Problem`].
    pub worst: Option<f64>,
    /// Where: the worst texel if there is a worst, else the first.
    pub at: Option<Texel>,
    /// What is the matter.
    pub what: String,
    /// What to do about it.
    pub remedy: String,
}

/// What can be the matter with a normal map, and what its `worst` measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Problem {
    /// Floats that are NaN, infinite or beyond 65536.
    NoDirection,
    /// (0, 0, 0).
    ZeroVector,
    /// The map seems to be read as what it is not: [`Misreading`].
    Misread,
    /// Lengths that no rounding can give; the length farthest from 1.
    NonUnit,
    /// Lengths that are off by little: rounded otherwise than to the nearest code; the length farthest from 1.
    Rounding,
    /// z below zero.
    BelowZero,
    /// z of zero.
    AtZero,
    /// Green seems to point the other way; how many times more curl the slopes have as they were read.
    Green,
    /// The file says that it holds sRGB colours.
    Srgb,
    /// Something else about the file, from its reader.
    File,
    /// The edges do not fit; how many times the greatest step inside.
    Seam,
    /// A fine format with nothing but 8-bit values.
    EightBit,
    /// A slope that shows the steps of its codes; their share of all changes.
    Banding,
}

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// It makes the map wrong.
    Fault,
    /// It may be as it should.
    Note,
}

named! {
    Problem "problem" {
        NoDirection = "no-direction", ZeroVector = "zero-vector", Misread = "misread", NonUnit = "non-unit",
        Rounding = "rounding", BelowZero = "below-zero", AtZero = "at-zero", Green = "green", Srgb = "srgb",
        File = "file", Seam = "seam", EightBit = "eight-bit", Banding = "banding"
    }
    Severity "severity" { Fault = "fault", Note = "note" }
}

/// Checks a normal map in one pass over its rows.
///
/// ```
/// use texbake::inspect::{CheckOptions, Problem, check};
/// use texbake::stream::Monitor;
/// use texbake::{Codes, NormalFormat, NormalMap, Size};
///
/// let codes = Codes::U8(vec![128, 128, 255, 128, 128, 100]);
/// let map = NormalMap::new(Size::new(2, 1)?, NormalFormat::default(), codes)?;
/// let findings = check(map.into_rows(), &CheckOptions::default(), &Monitor::default())?;
/// // 2 x 100 - 255 is -55 of 255.
/// assert_eq!(findings.list[0].problem, Problem::NonUnit);
/// assert_eq!(findings.list[1].problem, Problem::BelowZero);
/// # Ok::<(), texbake::Error>(())
/// ```
///
/// # Errors
/// What the source reports; [`crate::Error::Cancelled`] if `monitor` says so; [`crate::Error::Threads`].
pub fn check(source: Box<dyn NormalSource>, options: &CheckOptions, monitor: &Monitor) -> Result<Findings> {
    let (size, format) = (source.size(), source.format());
    let mut census = Census::new(size, format);
    let mut banding = BandingTest::new(format);
    let (mut green, mut seams) = (GreenTest::new(size), SeamTest::new(size));
    let mut row = Components::new(size, format);
    for_each_band(vec![source], monitor, |_, rows, layers| {
        census.add_rows(layers[0]);
        let row_codes = layers[0].len() / rows;
        for first in (0..layers[0].len()).step_by(row_codes) {
            let codes = layers[0].slice(first..first + row_codes);
            banding.add_row(codes, format.channels.count());
            row.read(codes);
            green.add_row(&row);
            seams.add_row(&row);
        }
        Ok(())
    })?;
    let (green, seams, banding) = (green.result(format.convention), seams.result(), banding.result());
    let mut findings = Findings { size, format, census, green, seams, banding, list: Vec::new() };
    findings.judge(options);
    Ok(findings)
}

/// Checks a normal map file: as [`check`], and what the file says of itself.
///
/// # Errors
/// As [`open_normals`] and [`check`].
pub fn check_file(
    path: &Path,
    read: &NormalReadOptions,
    options: &CheckOptions,
    monitor: &Monitor,
) -> Result<Findings> {
    monitor.check()?;
    let NormalFile { rows, warnings, srgb } = open_normals(path, read)?;
    let mut findings = check(rows, options, monitor)?;
    let faults = srgb.into_iter().map(|warning| (warning, Problem::Srgb, Severity::Fault));
    let notes = warnings.into_iter().map(|warning| (warning, Problem::File, Severity::Note));
    for (warning, problem, severity) in faults.chain(notes) {
        // Warnings say what to do behind a semicolon.
        let (what, remedy) = warning.split_once("; ").unwrap_or((&warning, "see how it was exported"));
        findings.add(Finding { what: what.into(), remedy: remedy.into(), ..Finding::new(problem, severity) });
    }
    Ok(findings)
}

impl Finding {
    fn new(problem: Problem, severity: Severity) -> Self {
        let (what, remedy) = (String::new(), String::new());
        Self { problem, severity, texels: None, share: None, worst: None, at: None, what, remedy }
    }
}

impl Findings {
    /// Whether anything is wrong; notes are not.
    pub fn has_faults(&self) -> bool {
        self.list.iter().any(|finding| finding.severity == Severity::Fault)
    }

    /// The finding of a problem, if there is one.
    pub fn of(&self, problem: Problem) -> Option<&Finding> {
        self.list.iter().find(|finding| finding.problem == problem)
    }

    /// Takes over what no repair can mend, though the repaired map, of which these are the findings, no longer shows it:
    /// the 8 bits of the map that it was made of.
    pub fn add_unmendable(&mut self, input: &Self) {
        for problem in [Problem::EightBit, Problem::Banding] {
            if let (Some(finding), None) = (input.of(problem), self.of(problem)) {
                let what = format!("{}, which cannot be mended (found in the input)", finding.what);
                self.add(Finding { what, ..finding.clone() });
            }
        }
    }

    fn add(&mut self, finding: Finding) {
        self.list.push(finding);
        self.list.sort_by_key(|finding| finding.severity);
    }

    fn judge(&mut self, options: &CheckOptions) {
        self.judge_texels();
        self.judge_green();
        self.judge_banding();
        let severity = if options.tiles { Severity::Fault } else { Severity::Note };
        for (seam, name) in [(self.seams.columns, "columns"), (self.seams.rows, "rows")] {
            if let Some(seam) = seam.filter(Seam::shows) {
                self.add(seam_finding(&seam, name, severity));
            }
        }
    }

    fn judge_texels(&mut self) {
        let Census { no_direction, zero_vectors, below_zero, at_zero, .. } = self.census;
        let repair = |mends: &str| format!("texbake check --repair {mends}");
        let flat = || repair("makes them flat");
        self.judge_tally(Problem::NoDirection, no_direction, "of NaN, infinity or more than 65536", flat());
        self.judge_tally(Problem::ZeroVector, zero_vectors, "of (0, 0, 0)", flat());
        if let Some(misreading) = self.census.misreading() {
            let (what, remedy) = (misreading.to_string(), misreading.remedy().into());
            self.add(Finding { what, remedy, ..Finding::new(Problem::Misread, Severity::Fault) });
        }
        self.judge_lengths();
        let raise = repair("raises z to the least above zero");
        let raise = format!("if the map is in tangent space at all, {raise}");
        self.judge_tally(Problem::BelowZero, below_zero, "of z below zero, pointing into the surface", raise);
        let steep = "blends take z as the least above zero; bake with a lower --scale if that was not meant".into();
        self.judge_tally(Problem::AtZero, at_zero, "of z zero, as steep as the encoding can tell", steep);
    }

    fn judge_lengths(&mut self) {
        let Census { non_unit, rounding, worst_length, worst_rounding, .. } = self.census;
        let what = "of a length that rounding a unit vector cannot give";
        let remedy = "texbake check --repair gives them their length".into();
        self.judge_tally(Problem::NonUnit, non_unit, what, remedy);
        self.tell_worst(Problem::NonUnit, worst_length);
        let what = "of a length slightly off, as of codes that were rounded otherwise than to the nearest";
        let remedy = if self.census.seems_biased() {
            "if 128 was written for zero and 255 for 1, read it with --encoding biased; else harmless"
        } else {
            "harmless; texbake check --repair rounds them to the nearest"
        };
        self.judge_tally(Problem::Rounding, rounding, what, remedy.into());
        self.tell_worst(Problem::Rounding, worst_rounding);
    }

    fn tell_worst(&mut self, problem: Problem, worst: Option<(f64, Texel)>) {
        let finding = self.list.iter_mut().find(|finding| finding.problem == problem);
        if let (Some(finding), Some((length, at))) = (finding, worst) {
            finding.what += &format!(", worst {} at {at}", Length(length));
            (finding.worst, finding.at) = (Some(length), Some(at));
        }
    }

    /// Adds a finding if there is any texel.
    fn judge_tally(&mut self, problem: Problem, tally: Tally, what: &str, remedy: String) {
        let Tally { count, first: Some(first) } = tally else { return };
        let share = count as f64 / self.census.texels as f64;
        let is_note = matches!(problem, Problem::AtZero | Problem::Rounding);
        let severity = if is_note { Severity::Note } else { Severity::Fault };
        let texels = if count == 1 { "texel" } else { "texels" };
        let what = format!("{count} {texels} ({}) {what}, first at {first}", Percent(share));
        let (texels, share, at) = (Some(count), Some(share), Some(first));
        self.add(Finding { texels, share, at, what, remedy, ..Finding::new(problem, severity) });
    }

    fn judge_green(&mut self) {
        if !self.green.seems_wrong() {
            return;
        }
        let ratio = self.green.ratio();
        let (read_as, other, points) = match self.green.read_as {
            Convention::Gl => (Convention::Gl, Convention::Dx, "down"),
            Convention::Dx => (Convention::Dx, Convention::Gl, "up"),
        };
        let times = if ratio < 1e6 { format!("{ratio:.1} times less curl") } else { "no curl".into() };
        self.add(Finding {
            worst: Some(ratio),
            what: format!(
                "green (or red) seems to point the other way, green {points} ({other}) and not as {read_as} says: read \
                 so, slopes have {times}"
            ),
            remedy: format!(
                "read it with --convention {other}; texbake check --repair --convention {other} --flip-green turns \
                 green around; if it is red, export the map again"
            ),
            ..Finding::new(Problem::Green, Severity::Fault)
        });
    }

    fn judge_banding(&mut self) {
        if !self.banding.shows() {
            return;
        }
        let depth = self.format.depth;
        self.add(match self.banding {
            Banding::Fine { .. } => Finding {
                what: format!("every code is one of 8 bits, widened to {depth}: the file is larger, and no finer"),
                remedy: format!("bake it again with --bits {depth}, or keep it in 8 bits"),
                ..Finding::new(Problem::EightBit, Severity::Fault)
            },
            Banding::Coarse { changes, terraces } => {
                let share = terraces as f64 / changes as f64;
                Finding {
                    worst: Some(share),
                    what: format!(
                        "slopes are too gentle for 8 bits: {} of the changes between neighbours are single codes \
                         between plateaus, which shows as bands",
                        Percent(share)
                    ),
                    remedy: "bake it again with --bits 16".into(),
                    ..Finding::new(Problem::Banding, Severity::Fault)
                }
            }
        });
    }
}

fn seam_finding(seam: &Seam, name: &str, severity: Severity) -> Finding {
    let [a, b] = seam.between;
    let ratio = seam.step / seam.greatest;
    let step =
        format_args!("a mean step of {:.3}, {:.3} between neighbours inside", seam.step, seam.typical).to_string();
    let is_edge_itself = b == 0;
    let (what, remedy) = if is_edge_itself {
        (format!("{name} {a} and {b} do not fit where the map is repeated: {step}"), "make the heights tile")
    } else {
        (
            format!("{name} {a} and {b}, at the edge, do not fit: {step}"),
            "bake heights that tile with --edge wrap, and others with clamp",
        )
    };
    Finding {
        worst: Some(ratio),
        at: Some(seam.worst),
        what: format!("{what}, worst at {}", seam.worst),
        remedy: format!("{remedy}, if the map shall be repeated"),
        ..Finding::new(Problem::Seam, severity)
    }
}

/// What speaks for it.
impl fmt::Display for Misreading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TwoChannels => "the third channel is no z, but the same or not above zero everywhere",
            Self::UnormFloats => "all values lie between 0 and 1, as if stored as unorm",
        })
    }
}

impl Misreading {
    /// The way to read it.
    pub fn remedy(self) -> &'static str {
        match self {
            Self::TwoChannels => "read it with --channels xy",
            Self::UnormFloats => "read it with --encoding unorm",
        }
    }
}

/// A length, as what it is off by where it is nearly 1.
struct Length(f64);

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 - 1.0 {
            off if off.abs() >= 0.01 => write!(f, "{:.4}", self.0),
            off if off < 0.0 => write!(f, "1 - {:.2e}", -off),
            off => write!(f, "1 + {off:.2e}"),
        }
    }
}

/// A share as a percentage of two digits.
struct Percent(f64);

impl fmt::Display for Percent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = 100.0 * self.0;
        if percent > 0.0 && percent < 0.001 {
            return write!(f, "less than 0.001%");
        }
        let digits = (1.0 - percent.max(0.001).log10().floor()).clamp(0.0, 4.0) as usize;
        write!(f, "{percent:.digits$}%")
    }
}

impl fmt::Display for Texel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column {}, row {}", self.x, self.y)
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}; {}", self.problem, self.what, self.remedy)
    }
}
