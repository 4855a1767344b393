//! What was chosen, why, and what was not.

use crate::measure::digits;

/// A choice of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// What it is about: `maps`, `resolution`, `normal map`, `precision`, `parallax`, `parallax map`, `tangent space`.
    pub topic: &'static str,
    /// What was chosen.
    pub choice: String,
    /// Why, with what was measured.
    pub reason: String,
    /// Times that were measured. A settings file leaves them out: the next plan measures others.
    pub times: Option<String>,
    /// What was cheaper or near, and why it was not taken.
    pub rejected: Vec<Rejected>,
}

/// What was not chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Rejected {
    /// The alternative.
    pub what: String,
    /// Why not, with what was measured.
    pub why: String,
}

impl Decision {
    pub(super) fn new(topic: &'static str, choice: impl ToString, reason: impl Into<String>) -> Self {
        Self { topic, choice: choice.to_string(), reason: reason.into(), times: None, rejected: Vec::new() }
    }

    pub(super) fn taking(self, times: String) -> Self {
        Self { times: Some(times), ..self }
    }

    pub(super) fn without(self, rejected: Vec<Rejected>) -> Self {
        Self { rejected, ..self }
    }
}

impl Rejected {
    pub(super) fn new(what: impl ToString, why: impl Into<String>) -> Self {
        Self { what: what.to_string(), why: why.into() }
    }
}

/// What a texel covers: `2 pixels`, `2 x 0.5 pixels`.
pub(super) fn sides([x, y]: [f64; 2]) -> String {
    if digits(x) == digits(y) { pixels(x) } else { format!("{} x {} pixels", digits(x), digits(y)) }
}

/// `1 degree`, `0.3 degrees`.
pub(super) fn degrees(number: f64) -> String {
    counted(number, "degree")
}

/// `1 pixel`, `0.3 pixels`.
pub(super) fn pixels(number: f64) -> String {
    counted(number, "pixel")
}

pub(super) fn counted(number: f64, unit: &str) -> String {
    let text = digits(number);
    let plural = if text == "1" { "" } else { "s" };
    format!("{text} {unit}{plural}")
}

/// Columns of a line.
const COLUMNS: usize = 100;

/// Lines of text, of which the first and the others begin differently.
pub(super) fn wrapped(text: &str, [first, other]: [&str; 2]) -> String {
    let mut lines = vec![String::from(first)];
    for word in text.split(' ') {
        let line = lines.last_mut().unwrap_or_else(|| unreachable!("there is the first line"));
        let begins = line == first || line == other;
        if begins {
            *line += word;
        } else if line.chars().count() + 1 + word.chars().count() <= COLUMNS {
            *line += &format!(" {word}");
        } else {
            lines.push(format!("{other}{word}"));
        }
    }
    lines.iter().map(|line| format!("{line}\n")).collect()
}

/// `1 byte per texel`, `2 bytes per texel`.
pub(super) fn bytes_per_texel(bytes: f64) -> String {
    format!("{} per texel", counted(bytes, "byte"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_counted() {
        assert_eq!([degrees(1.0), degrees(0.5), pixels(2.0)], ["1 degree", "0.5 degrees", "2 pixels"]);
        assert_eq!([sides([0.5, 0.5]), sides([2.0, 0.5])], ["0.5 pixels", "2 x 0.5 pixels"]);
    }
}
