//! What is wrong with a normal map, in words and numbers.

use super::banding::{Banding, BandingTest};
use super::census::{Census, Tally, Texel};
use super::green::{Green, GreenTest};
use super::read::{Components, for_each_band};
use super::seams::{Seam, SeamTest, Seams};
use crate::error::Result;
use crate::io::{NormalFile, NormalReadOptions, open_normals};
use crate::map::{Convention, NormalFormat, Size};
use crate::names::named;
use crate::stream::NormalSource;
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
    /// Lengths that rounding cannot give; the length farthest from 1.
    NonUnit,
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
        NoDirection = "no-direction", ZeroVector = "zero-vector", NonUnit = "non-unit", BelowZero = "below-zero",
        AtZero = "at-zero", Green = "green", Srgb = "srgb", File = "file", Seam = "seam", EightBit = "eight-bit",
        Banding = "banding"
    }
    Severity "severity" { Fault = "fault", Note = "note" }
}

/// Checks a normal map in one pass over its rows.
///
/// ```
/// use texbake::inspect::{CheckOptions, Problem, check};
/// use texbake::{Codes, NormalFormat, NormalMap, Size};
///
/// let codes = Codes::U8(vec![128, 128, 255, 128, 128, 100]);
/// let map = NormalMap::new(Size::new(2, 1)?, NormalFormat::default(), codes)?;
/// let findings = check(map.into_rows(), &CheckOptions::default())?;
/// // 2 x 100 - 255 is -55 of 255.
/// assert_eq!(findings.list[0].problem, Problem::NonUnit);
/// assert_eq!(findings.list[1].problem, Problem::BelowZero);
/// # Ok::<(), texbake::Error>(())
/// ```
///
/// # Errors
/// What the source reports; [`crate::Error::Threads`].
pub fn check(source: Box<dyn NormalSource>, options: &CheckOptions) -> Result<Findings> {
    let (size, format) = (source.size(), source.format());
    let mut census = Census::new(size, format);
    let mut banding = BandingTest::new(format);
    let (mut green, mut seams) = (GreenTest::new(size), SeamTest::new(size));
    let mut row = Components::new(size, format);
    for_each_band(vec![source], |_, rows, layers| {
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
pub fn check_file(path: &Path, read: &NormalReadOptions, options: &CheckOptions) -> Result<Findings> {
    let NormalFile { rows, warnings, says_srgb } = open_normals(path, read)?;
    let mut findings = check(rows, options)?;
    for warning in warnings {
        let is_srgb = says_srgb && warning.contains("sRGB");
        let (problem, severity) =
            if is_srgb { (Problem::Srgb, Severity::Fault) } else { (Problem::File, Severity::Note) };
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
        let Census { no_direction, zero_vectors, non_unit, below_zero, at_zero, worst_length, .. } = self.census;
        let repair = |mends: &str| format!("texbake check --repair {mends}");
        let flat = || repair("makes them flat");
        self.judge_tally(Problem::NoDirection, no_direction, "of NaN, infinity or more than 65536", flat());
        self.judge_tally(Problem::ZeroVector, zero_vectors, "of (0, 0, 0)", flat());
        let lengths = "of a length that rounding a unit vector cannot give";
        if let Some(finding) = self.judge_tally(Problem::NonUnit, non_unit, lengths, repair("gives them their length"))
            && let Some((length, at)) = worst_length
        {
            finding.what += &format!(", worst {length:.4} at {at}");
            (finding.worst, finding.at) = (Some(length), Some(at));
        }
        let raise = repair("raises z to the least above zero");
        let raise = format!("if the map is in tangent space at all, {raise}");
        self.judge_tally(Problem::BelowZero, below_zero, "of z below zero, pointing into the surface", raise);
        let steep = "blends take z as the least above zero; bake with a lower --scale if that was not meant".into();
        self.judge_tally(Problem::AtZero, at_zero, "of z zero, as steep as the encoding can tell", steep);
    }

    /// Adds a finding if there is any texel.
    fn judge_tally(&mut self, problem: Problem, tally: Tally, what: &str, remedy: String) -> Option<&mut Finding> {
        let Tally { count, first } = tally;
        let first = first?;
        let share = count as f64 / self.census.texels as f64;
        let severity = if problem == Problem::AtZero { Severity::Note } else { Severity::Fault };
        let texels = if count == 1 { "texel" } else { "texels" };
        let what = format!("{count} {texels} ({}) {what}, first at {first}", Percent(share));
        let (texels, share, at) = (Some(count), Some(share), Some(first));
        self.add(Finding { texels, share, at, what, remedy, ..Finding::new(problem, severity) });
        self.list.iter_mut().find(|finding| finding.problem == problem)
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
                "green seems to point {points} ({other}), not as {read_as} says: read so, slopes have {times}"
            ),
            remedy: format!(
                "read it with --convention {other}; texbake check --repair --convention {other} --flip-green turns it \
                 around"
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
