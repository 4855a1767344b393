//! Which parallax method at run time, and which map for it.

use super::decision::{Decision, Rejected, bytes_a_texel, pixels, short};
use super::method::reads;
use super::subject::{Reduced, Subject};
use super::unmet::Unmet;
use super::view::Seen;
use crate::baker::Baker;
use crate::error::Result;
use crate::io::check_parallax_format;
use crate::map::{Depth, Encoding, HeightMap, NormalFormat, NormalMap, ParallaxFormat, ParallaxMap};
use crate::material::{Material, ParallaxMethod, Texture};
use crate::measure::Views;
use crate::ops::Precision;
use crate::ops::bake::BakeOptions;
use crate::stream::Monitor;
use std::path::Path;

/// A parallax method that keeps within its tolerance, with its map if it reads one.
#[derive(Debug, Clone)]
pub(super) struct ParallaxChoice {
    pub method: ParallaxMethod,
    pub format: Option<ParallaxFormat>,
    /// The largest error in pixels.
    pub error: f64,
    /// Bytes of what the method reads, the normal map aside, over texels of the height map.
    pub bytes: f64,
    pub decisions: Vec<Decision>,
}

/// Pixels from which a material is looked at, each from its own side, and what they are made from. A check looks from
/// the same ones.
const PIXELS: usize = 8192;
const SEED: u64 = 1;

/// Steps k of FGED2 listing 7.9 that are tried.
const MOST_STEPS: u32 = 16;

/// Halvings of a step of relief intersection: a 32nd of it.
const BISECTIONS: u32 = 5;

/// Runs of which a time is the median.
const RUNS: usize = 5;

/// The formats that files of this extension hold, cheapest first; of those that cost the same, one with a code for zero.
pub(super) fn formats(extension: &str) -> Vec<ParallaxFormat> {
    let file = Path::new("map").with_extension(extension);
    let encodings = [Encoding::Snorm, Encoding::Biased, Encoding::Unorm, Encoding::Float];
    let depths = [Depth::Bits8, Depth::Bits16, Depth::Float16, Depth::Float32];
    let all = encodings.into_iter().flat_map(|encoding| depths.map(|depth| ParallaxFormat { encoding, depth }));
    let mut formats: Vec<_> = all.filter(|format| check_parallax_format(&file, *format).is_ok()).collect();
    formats.sort_by_key(|format| format.depth.bytes());
    formats.dedup_by_key(|format| format.depth);
    formats
}

/// The largest offset that can be seen at the shallowest angle a, in pixels: |2h - 1| s/2 cot a texels of the greatest
/// |2h - 1|, the offset of relief as high as it gets.
pub(super) fn largest_offset(heights: &HeightMap, options: &BakeOptions, seen: Seen) -> Result<f64> {
    let scale = options.scale.resolve(heights.size())?;
    let texels = f64::from(scale.x.abs().max(scale.y.abs())) / f64::from(scale.q);
    let heights = Texture::of_heights(heights, options.edges);
    let highest = heights.texels().iter().map(|[h]| f64::from(2.0 * h - 1.0).abs()).fold(0.0, f64::max);
    // Straight from above the tangent is no exact infinity.
    let cotangent = if seen.angle == 90.0 { 0.0 } else { 1.0 / seen.angle.to_radians().tan() };
    Ok(highest * texels / 2.0 * cotangent * seen.pixels_per_texel)
}

/// No parallax, which is right where nothing moves by more than the tolerance.
pub(super) fn none(subject: &Subject<'_>, offset: f64) -> Option<ParallaxChoice> {
    let tolerance = subject.tolerance().parallax;
    let reason = format!(
        "the largest offset, seen at {} degrees, is {}, of {} allowed",
        short(subject.seen.angle),
        pixels(offset),
        short(tolerance)
    );
    let decisions = vec![Decision::new("parallax", "none", reason)];
    let method = ParallaxMethod::None;
    (offset <= tolerance).then_some(ParallaxChoice { method, format: None, error: offset, bytes: 0.0, decisions })
}

/// The method of the fewest lookups that keeps within the tolerances; of those, the one of the fewest bytes.
pub(super) fn choose(
    subject: &Subject<'_>,
    reduced: &Reduced<'_>,
    normals: Option<NormalFormat>,
    offset: f64,
    bytes_left: f64,
) -> Result<Result<ParallaxChoice, Unmet>> {
    let mut search = Search::new(subject, reduced, normals, bytes_left)?;
    for method in search.candidates() {
        subject.monitor.check()?;
        if let Some(choice) = search.attempt(method, offset)? {
            return Ok(Ok(choice));
        }
    }
    Ok(Err(search.unmet()))
}

/// What was tried.
struct Search<'a> {
    subject: &'a Subject<'a>,
    reduced: &'a Reduced<'a>,
    normals: NormalMap,
    has_normals: bool,
    bytes_left: f64,
    formats: Vec<ParallaxFormat>,
    /// The material with the finest parallax map.
    finest: Material,
    views: Views,
    truth_method: ParallaxMethod,
    truth: Vec<[f32; 2]>,
    tried: Vec<Tried>,
}

struct Tried {
    method: ParallaxMethod,
    error: f64,
    bytes: f64,
    milliseconds: Option<f64>,
}

impl<'a> Search<'a> {
    fn new(
        subject: &'a Subject<'a>,
        reduced: &'a Reduced<'a>,
        normals: Option<NormalFormat>,
        bytes_left: f64,
    ) -> Result<Self> {
        let formats = formats(&subject.material.format);
        let finest = formats.last().copied().unwrap_or_default();
        let has_normals = normals.is_some();
        let normals = super::normals::bake(subject.baker, reduced, normals.unwrap_or_default(), Precision::Exact)?;
        let parallax = bake(subject.baker, reduced, finest, Precision::Exact)?;
        let finest = material(&subject.heights, &normals, &parallax, &subject.facts().bake())?;
        let (views, truth) = views(&finest, subject.seen.angle, subject.monitor)?;
        let (truth_method, tried) = (truth_method(&finest, subject.seen.angle)?, Vec::new());
        Ok(Self {
            subject,
            reduced,
            normals,
            has_normals,
            bytes_left,
            formats,
            finest,
            views,
            truth_method,
            truth,
            tried,
        })
    }

    /// The methods, fewest lookups first.
    fn candidates(&self) -> Vec<ParallaxMethod> {
        let mut methods = vec![ParallaxMethod::Limited, ParallaxMethod::Welsh];
        if self.has_normals {
            methods.extend([1.0, 3.0].map(|limit| ParallaxMethod::Plane { limit }));
        }
        methods.extend((1..=MOST_STEPS).map(ParallaxMethod::steps));
        let truth = self.truth_method;
        let halvings = (2..).map(|power| 1u32 << power).take_while(|steps| *steps < self.march());
        let relief = |steps| ParallaxMethod::Relief { steps, bisections: BISECTIONS };
        methods.extend(halvings.map(relief).chain([relief(self.march()), truth]));
        methods.sort_by(|a, b| {
            let cost = |method: &ParallaxMethod| (method.fetches(), self.bytes(*method, self.formats[0].depth));
            let ((a, a_bytes), (b, b_bytes)) = (cost(a), cost(b));
            a.cmp(&b).then(a_bytes.total_cmp(&b_bytes))
        });
        methods
    }

    /// Steps of what is right.
    fn march(&self) -> u32 {
        match self.truth_method {
            ParallaxMethod::Relief { steps, .. } => steps,
            _ => 1,
        }
    }

    /// Bytes over texels of the height map of what a method reads, the normal map aside.
    fn bytes(&self, method: ParallaxMethod, depth: Depth) -> f64 {
        match method {
            ParallaxMethod::None => 0.0,
            ParallaxMethod::Steps { .. } => depth.bytes() as f64 * self.reduced.share(),
            _ => self.subject.heights.height_type().bytes() as f64,
        }
    }

    fn error(&self, material: &Material, method: ParallaxMethod) -> Result<f64> {
        let errors = self.views.errors(material, method, &self.truth, material.texels(), self.subject.monitor)?;
        Ok(self.subject.tolerance().parallax_of.errors(errors) * self.subject.seen.pixels_per_texel)
    }

    /// The choice of this method, if it keeps within the tolerances.
    fn attempt(&mut self, method: ParallaxMethod, offset: f64) -> Result<Option<ParallaxChoice>> {
        let tolerance = self.subject.tolerance();
        let error = self.error(&self.finest, method)?;
        let milliseconds = tolerance.milliseconds.map(|_| self.milliseconds(method));
        let bytes = self.bytes(method, self.formats[0].depth);
        let is_slow = milliseconds.zip(tolerance.milliseconds).is_some_and(|(takes, bound)| takes > bound);
        if error > tolerance.parallax || is_slow || bytes > self.bytes_left {
            self.tried.push(Tried { method, error, bytes, milliseconds });
            return Ok(None);
        }
        if !matches!(method, ParallaxMethod::Steps { .. }) {
            return Ok(Some(self.choice(method, None, error, bytes, milliseconds, offset, Vec::new())));
        }
        let mut coarser = Vec::new();
        for format in self.formats.clone() {
            let map = bake(self.subject.baker, self.reduced, format, Precision::Exact)?;
            let material = material(&self.subject.heights, &self.normals, &map, &self.subject.facts().bake())?;
            let (error, bytes) = (self.error(&material, method)?, self.bytes(method, format.depth));
            if error <= tolerance.parallax && bytes <= self.bytes_left {
                return Ok(Some(self.choice(method, Some(format), error, bytes, milliseconds, offset, coarser)));
            }
            coarser.push(Rejected::new(describe(format), format!("off by up to {}", pixels(error))));
        }
        self.tried.push(Tried { method, error, bytes, milliseconds });
        Ok(None)
    }

    /// Milliseconds that a screen full of pixels takes on all threads of this machine.
    fn milliseconds(&self, method: ParallaxMethod) -> f64 {
        let threads = std::thread::available_parallelism().map_or(1, usize::from) as f64;
        let screen = self.subject.material.view.resolution.map_or(0.0, |[width, height]| width * height);
        self.views.nanoseconds(&self.finest, method, RUNS) * screen / 1e6 / threads
    }

    #[expect(clippy::too_many_arguments, reason = "what was measured of one method, told in one place")]
    fn choice(
        &self,
        method: ParallaxMethod,
        format: Option<ParallaxFormat>,
        error: f64,
        bytes: f64,
        milliseconds: Option<f64>,
        offset: f64,
        coarser: Vec<Rejected>,
    ) -> ParallaxChoice {
        let tolerance = self.subject.tolerance();
        let mut reason = format!(
            "off by {} {}, of {} allowed, in {PIXELS} pixels seen at {} degrees; {} lookups of {}",
            pixels(error),
            tolerance.parallax_of.words(),
            short(tolerance.parallax),
            short(self.subject.seen.angle),
            method.fetches(),
            reads(method),
        );
        if let Some((takes, bound)) = milliseconds.zip(tolerance.milliseconds) {
            reason += &format!(
                "; a screen full of it takes {} ms on the CPU's threads here, of {} allowed",
                short(takes),
                short(bound)
            );
        }
        let mut rejected = vec![Rejected::new("none", format!("the largest offset is {}", pixels(offset)))];
        rejected.extend(self.rejected());
        let mut decisions = vec![Decision::new("parallax", method, reason).without(rejected)];
        decisions.push(match format {
            Some(format) => {
                let (words, allowed) = (tolerance.parallax_of.words(), short(tolerance.parallax));
                let reason = format!("off by {} {words}, of {allowed} allowed", pixels(error));
                Decision::new("parallax map", describe(format), reason).without(coarser)
            }
            None => {
                let reason = format!("{method} reads {}, {}", reads(method), bytes_a_texel(bytes));
                Decision::new("parallax map", "none", reason)
            }
        });
        ParallaxChoice { method, format, error, bytes, decisions }
    }

    /// Each kind of method that was tried, at its best.
    fn rejected(&self) -> Vec<Rejected> {
        let of_kind = |kind: &str| {
            let is_it = |tried: &&Tried| tried.method.to_string().starts_with(kind);
            let tried: Vec<&Tried> = self.tried.iter().filter(is_it).collect();
            let best = tried.iter().min_by(|a, b| a.error.total_cmp(&b.error))?;
            let what = match &tried[..] {
                [one] => one.method.to_string(),
                [first, .., last] => format!("{} to {}", first.method, last.method),
                [] => return None,
            };
            let at = if tried.len() > 1 { format!(", with {}", best.method) } else { String::new() };
            let cost = best.milliseconds.map(|ms| format!(", {} ms", short(ms))).unwrap_or_default();
            let bytes = match best.bytes > self.bytes_left {
                true => match bytes_a_texel(self.bytes_left) {
                    one if one.starts_with("1 byte ") => format!(", and {one} is left"),
                    more => format!(", and {more} are left"),
                },
                false => String::new(),
            };
            Some(Rejected::new(what, format!("off by up to {}{at}{cost}{bytes}", pixels(best.error))))
        };
        ["limited", "welsh", "plane", "steps", "relief"].into_iter().filter_map(of_kind).collect()
    }

    /// Which tolerance rules all methods out.
    fn unmet(&self) -> Unmet {
        let tolerance = self.subject.tolerance();
        let is_right = |tried: &&Tried| tried.error <= tolerance.parallax;
        let fits = |tried: &&Tried| tried.bytes <= self.bytes_left;
        let least = |by: fn(&Tried) -> f64, tried: Vec<&Tried>, name, wanted, unit, more: f64| {
            let best = tried.into_iter().min_by(|a, b| by(a).total_cmp(&by(b)));
            let (value, with) = best.map_or((0.0, String::new()), |best| (by(best) + more, best.method.to_string()));
            Unmet { tolerance: name, wanted, unit, best: value, with }
        };
        let right: Vec<&Tried> = self.tried.iter().filter(is_right).collect();
        let right_and_small: Vec<&Tried> = right.iter().copied().filter(fits).collect();
        match (tolerance.milliseconds, tolerance.bytes_per_texel) {
            (Some(bound), _) if !right_and_small.is_empty() => {
                let time = |tried: &Tried| tried.milliseconds.unwrap_or_default();
                least(time, right_and_small, "milliseconds", bound, "milliseconds", 0.0)
            }
            (_, Some(bound)) if !right.is_empty() => {
                let used = bound - self.bytes_left;
                least(|tried| tried.bytes, right, "bytes-per-texel", bound, "bytes a texel", used)
            }
            _ => least(|tried| tried.error, self.tried.iter().collect(), "parallax", tolerance.parallax, "pixels", 0.0),
        }
    }
}

/// Where a material is looked at from at its shallowest, and what is right there.
pub(super) fn views(material: &Material, angle: f64, monitor: &Monitor) -> Result<(Views, Vec<[f32; 2]>)> {
    let views = Views::at_elevation(angle, PIXELS, SEED);
    let truth = views.offsets(material, truth_method(material, angle)?, monitor)?;
    Ok((views, truth))
}

/// What is right from every side: [`Material::truth`] along the axis that takes more steps. At a silhouette one step more
/// or less would make another offset of it.
fn truth_method(material: &Material, angle: f64) -> Result<ParallaxMethod> {
    let (z, across) = angle.to_radians().sin_cos();
    let (z, across) = (z as f32, across as f32);
    let (x, y) = (material.truth([across, 0.0, z])?, material.truth([0.0, across, z])?);
    Ok(if x.fetches() > y.fetches() { x } else { y })
}

/// The maps of a reduced height map with the whole one, as a scene has them.
pub(super) fn material(
    heights: &HeightMap,
    normals: &NormalMap,
    parallax: &ParallaxMap,
    options: &BakeOptions,
) -> Result<Material> {
    Ok(Material::of_maps(heights, normals, parallax, options.scale.resolve(heights.size())?, options.edges))
}

/// A parallax map of the reduced heights.
pub(super) fn bake(
    baker: &Baker,
    reduced: &Reduced<'_>,
    format: ParallaxFormat,
    precision: Precision,
) -> Result<ParallaxMap> {
    let options = BakeOptions { normal: None, parallax: Some(format), precision, ..reduced.options };
    let maps = baker.bake(&reduced.heights, &options)?;
    Ok(maps.parallax.unwrap_or_else(|| unreachable!("it was asked for")))
}

/// `biased 8, 1 byte a texel`.
pub(super) fn describe(format: ParallaxFormat) -> String {
    format!("{} {}, {}", format.encoding, format.depth, bytes_a_texel(format.depth.bytes() as f64))
}
