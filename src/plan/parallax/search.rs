//! The search for a parallax method: fewest lookups first.

use super::sides::Sides;
use super::{MapChoice, ParallaxChoice, bake, describe, formats, material};
use crate::error::Result;
use crate::map::{Depth, NormalMap, ParallaxFormat};
use crate::material::{Material, ParallaxMethod};
use crate::measure::Errors;
use crate::ops::Precision;
use crate::plan::decision::{Rejected, pixels};
use crate::plan::normals::{self, NormalChoice};
use crate::plan::prediction::ErrorOf;
use crate::plan::subject::{Reduced, Subject};
use crate::plan::unmet::Unmet;

/// Steps k of FGED2 listing 7.9 that are tried.
const MOST_STEPS: u32 = 16;

/// Halvings of a step of relief intersection: a 32nd of it.
const BISECTIONS: u32 = 5;

/// The method of the fewest lookups that keeps within the tolerances; of those, the one of the fewest bytes.
pub(in crate::plan) fn choose(
    subject: &Subject<'_>,
    reduced: &Reduced<'_>,
    normals: &NormalChoice,
) -> Result<Result<ParallaxChoice, Unmet>> {
    let mut search = Search::new(subject, reduced, normals)?;
    for method in search.candidates()? {
        if let Some(choice) = search.attempt(method)? {
            return Ok(Ok(choice));
        }
    }
    Ok(Err(search.unmet()))
}

/// What was tried.
pub(super) struct Search<'a> {
    pub subject: &'a Subject<'a>,
    reduced: &'a Reduced<'a>,
    pub normals: &'a NormalChoice,
    normal_map: NormalMap,
    formats: Vec<ParallaxFormat>,
    /// The material with the finest parallax map.
    finest: Material,
    pub sides: Sides,
    pub tried: Vec<Tried>,
}

/// A method as it was measured.
pub(super) struct Tried {
    pub method: ParallaxMethod,
    pub map: Option<MapChoice>,
    pub errors: Errors,
    /// Bytes of what it reads over texels of the height map, the normal map aside.
    pub bytes: f64,
    pub milliseconds: Option<f64>,
}

impl<'a> Search<'a> {
    fn new(subject: &'a Subject<'a>, reduced: &'a Reduced<'a>, normals: &'a NormalChoice) -> Result<Self> {
        let formats = formats(&subject.material.format);
        let finest = formats.last().copied().unwrap_or_default();
        let normal_map = normals::bake(subject.baker, reduced, normals.format.unwrap_or_default(), Precision::Exact)?;
        let parallax = bake(subject.baker, reduced, finest, Precision::Exact)?;
        let options = subject.facts().bake();
        let finest = material(&subject.heights, &normal_map, &parallax, &options)?;
        let sides = Sides::new(&subject.heights, &options, &finest, subject.seen, subject.monitor)?;
        Ok(Self { subject, reduced, normals, normal_map, formats, finest, sides, tried: Vec::new() })
    }

    /// The methods, fewest lookups first, none at all before all.
    fn candidates(&self) -> Result<Vec<ParallaxMethod>> {
        let mut methods = vec![ParallaxMethod::None, ParallaxMethod::Limited, ParallaxMethod::Welsh];
        if self.normals.format.is_some() {
            methods.extend([1.0, 3.0].map(|limit| ParallaxMethod::Plane { limit }));
        }
        methods.extend((1..=MOST_STEPS).map(ParallaxMethod::steps));
        // The truth's steps are of a quarter of a texel: on to a sixteenth.
        let most = match self.finest.truth_at(self.subject.seen.angle)? {
            ParallaxMethod::Relief { steps, .. } => 4 * steps,
            method => method.fetches(),
        };
        let halvings = (2..).map(|power| 1u32 << power).take_while(|steps| *steps < most);
        let relief = |steps| ParallaxMethod::Relief { steps, bisections: BISECTIONS };
        methods.extend(halvings.chain([most]).map(relief));
        let cost = |method: &ParallaxMethod| (method.fetches(), self.bytes(*method, self.formats[0].depth));
        methods.sort_by(|a, b| {
            let ((a, a_bytes), (b, b_bytes)) = (cost(a), cost(b));
            a.cmp(&b).then(a_bytes.total_cmp(&b_bytes))
        });
        Ok(methods)
    }

    /// Bytes over texels of the height map of what a method reads, the normal map aside.
    fn bytes(&self, method: ParallaxMethod, depth: Depth) -> f64 {
        match method {
            ParallaxMethod::None => 0.0,
            ParallaxMethod::Steps { .. } => depth.bytes() as f64 * self.reduced.share(),
            _ => self.subject.heights.height_type().bytes() as f64,
        }
    }

    /// The choice of this method, if it keeps within the tolerances.
    fn attempt(&mut self, method: ParallaxMethod) -> Result<Option<ParallaxChoice>> {
        let at_best = Tried {
            method,
            map: None,
            errors: self.errors(&self.finest, method)?,
            bytes: self.bytes(method, self.formats[0].depth),
            milliseconds: self.milliseconds(method),
        };
        let mut coarser = Vec::new();
        if !self.is_fit(&at_best) {
            self.tried.push(at_best);
            return Ok(None);
        }
        if !matches!(method, ParallaxMethod::Steps { .. }) {
            return Ok(Some(self.choice(at_best, coarser)));
        }
        for format in self.formats.clone() {
            let map = bake(self.subject.baker, self.reduced, format, Precision::Exact)?;
            let material = material(&self.subject.heights, &self.normal_map, &map, &self.subject.facts().bake())?;
            let tried = Tried {
                map: Some(MapChoice { format, error: self.reduced.parallax_error(&map)? }),
                errors: self.errors(&material, method)?,
                bytes: self.bytes(method, format.depth),
                ..at_best
            };
            if self.is_fit(&tried) {
                return Ok(Some(self.choice(tried, coarser)));
            }
            coarser.push(Rejected::new(describe(format), format!("off by up to {}", pixels(self.error(&tried)))));
        }
        self.tried.push(at_best);
        Ok(None)
    }

    fn errors(&self, material: &Material, method: ParallaxMethod) -> Result<Errors> {
        self.sides.errors(material, method, self.subject.tolerance().parallax_of, self.subject.monitor)
    }

    /// The error that counts.
    pub fn error(&self, tried: &Tried) -> f64 {
        self.subject.tolerance().parallax_of.errors(tried.errors)
    }

    /// What a screen full of it takes, if that is bounded.
    fn milliseconds(&self, method: ParallaxMethod) -> Option<f64> {
        let [width, height] = self.subject.material.view.resolution?;
        self.subject.tolerance().milliseconds?;
        Some(self.sides.milliseconds(&self.finest, method, width * height))
    }

    /// Bytes per texel of the height map that are left beside the normal map.
    pub fn bytes_left(&self) -> f64 {
        self.subject.tolerance().bytes_per_texel.map_or(f64::INFINITY, |bound| bound - self.normals.bytes)
    }

    fn is_fit(&self, tried: &Tried) -> bool {
        self.is_right(tried) && self.is_fast(tried) && self.is_small(tried)
    }

    fn is_right(&self, tried: &Tried) -> bool {
        self.error(tried) <= self.subject.tolerance().parallax
    }

    fn is_fast(&self, tried: &Tried) -> bool {
        let bound = self.subject.tolerance().milliseconds;
        tried.milliseconds.zip(bound).is_none_or(|(takes, bound)| takes <= bound)
    }

    fn is_small(&self, tried: &Tried) -> bool {
        tried.bytes <= self.bytes_left()
    }

    /// Which tolerance rules all methods out: the bytes or the time of one that is right, else the error.
    fn unmet(&self) -> Unmet {
        let tolerance = self.subject.tolerance();
        let least = |by: &dyn Fn(&Tried) -> f64, of: &dyn Fn(&Tried) -> bool| {
            let tried = self.tried.iter().filter(|tried| of(tried));
            let best = tried.min_by(|a, b| by(a).total_cmp(&by(b)))?;
            Some((by(best), self.with(best)))
        };
        let of_bytes = |is_it: &dyn Fn(&Tried) -> bool| {
            let (best, with) = least(&|tried| tried.bytes + self.normals.bytes, is_it)?;
            Some(Unmet::bytes(tolerance.bytes_per_texel?, best, with))
        };
        let of_time = || {
            let time = |tried: &Tried| tried.milliseconds.unwrap_or_default();
            let (best, with) = least(&time, &|tried| self.is_right(tried) && self.is_small(tried))?;
            Some(Unmet::milliseconds(tolerance.milliseconds?, best, with))
        };
        let small = of_bytes(&|tried| self.is_right(tried) && self.is_fast(tried));
        small.or_else(of_time).or_else(|| of_bytes(&|tried| self.is_right(tried))).unwrap_or_else(|| {
            let (best, with) = least(&|tried| self.error(tried), &|_| true).unwrap_or_default();
            let most = match tolerance.parallax_of {
                ErrorOf::All => least(&|tried| tried.errors.percentile_99, &|_| true).map(|(best, _)| best),
                ErrorOf::Most => None,
            };
            Unmet::parallax(tolerance.parallax, tolerance.parallax_of, best, with, most)
        })
    }

    /// A method beside the normal map, in words.
    fn with(&self, tried: &Tried) -> String {
        let normals = match self.normals.format {
            Some(format) => normals::describe(format),
            None => "no normal map".into(),
        };
        match tried.method {
            ParallaxMethod::None => normals,
            method => format!("{method} beside {normals}"),
        }
    }
}
