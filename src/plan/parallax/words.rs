//! What is said of a parallax method that was chosen.

use super::search::{Search, Tried};
use super::{MapChoice, ParallaxChoice, describe};
use crate::material::ParallaxMethod;
use crate::measure::digits;
use crate::plan::decision::{Decision, Rejected, bytes_per_texel, counted, pixels};
use crate::plan::method::reads;

impl Search<'_> {
    /// A method that was tried and is taken; `coarser` are maps that were not.
    pub(super) fn choice(&self, tried: Tried, coarser: Vec<Rejected>) -> ParallaxChoice {
        let decision = Decision::new("parallax", tried.method, self.reason(&tried)).without(self.rejected());
        let mut decisions = vec![Decision { times: self.times(&tried), ..decision }];
        if tried.method != ParallaxMethod::None {
            decisions.push(self.map_decision(&tried, coarser));
        }
        let error = self.error(&tried);
        let Tried { method, map, bytes, milliseconds, .. } = tried;
        ParallaxChoice { method, map, error, milliseconds, bytes, decisions }
    }

    fn reason(&self, tried: &Tried) -> String {
        let tolerance = self.subject.tolerance();
        let (error, words, allowed) =
            (pixels(self.error(tried)), tolerance.parallax_of.words(), digits(tolerance.parallax));
        let sides = self.sides.words();
        match tried.method {
            ParallaxMethod::None => format!("offsets are {error} {words}, of {allowed} allowed, in {sides}"),
            method => format!(
                "off by {error} {words}, of {allowed} allowed, in {sides}; {} of {}",
                counted(method.fetches().into(), "lookup"),
                reads(method),
            ),
        }
    }

    fn times(&self, tried: &Tried) -> Option<String> {
        let (takes, bound) = tried.milliseconds.zip(self.subject.tolerance().milliseconds)?;
        let (takes, bound) = (digits(takes), digits(bound));
        Some(format!("a screen full of it takes {takes} ms on all threads of this CPU, of {bound} allowed"))
    }

    fn map_decision(&self, tried: &Tried, coarser: Vec<Rejected>) -> Decision {
        let Some(MapChoice { format, error }) = tried.map else {
            let method = tried.method;
            let reason = format!("{method} reads {}, {}", reads(method), bytes_per_texel(tried.bytes));
            return Decision::new("parallax map", "none", reason);
        };
        let tolerance = self.subject.tolerance();
        let reason = format!(
            "with it offsets are off by {} {}, of {} allowed; its values, from -1 to 1, by {}",
            pixels(self.error(tried)),
            tolerance.parallax_of.words(),
            digits(tolerance.parallax),
            digits(error),
        );
        Decision::new("parallax map", describe(format), reason).without(coarser)
    }

    /// Each kind of method that was tried, at its best.
    fn rejected(&self) -> Vec<Rejected> {
        ["none", "limited", "welsh", "plane", "steps", "relief"]
            .into_iter()
            .filter_map(|kind| self.of_kind(kind))
            .collect()
    }

    fn of_kind(&self, kind: &str) -> Option<Rejected> {
        let is_it = |tried: &&Tried| tried.method.to_string().starts_with(kind);
        let tried: Vec<&Tried> = self.tried.iter().filter(is_it).collect();
        let best = tried.iter().min_by(|a, b| self.error(a).total_cmp(&self.error(b)))?;
        let what = match &tried[..] {
            [one] => one.method.to_string(),
            [first, last] => format!("{} and {}", first.method, last.method),
            [first, .., last] => format!("{} to {}", first.method, last.method),
            [] => return None,
        };
        let at = if tried.len() > 1 { format!(", with {}", best.method) } else { String::new() };
        let time = best.milliseconds.map(|ms| format!(", {} ms", digits(ms))).unwrap_or_default();
        let left = self.bytes_left();
        let bytes = match best.bytes > left {
            true => format!("; it reads {}, of {} left", bytes_per_texel(best.bytes), digits(left)),
            false => String::new(),
        };
        Some(Rejected::new(what, format!("off by up to {}{at}{time}{bytes}", pixels(self.error(best)))))
    }
}
