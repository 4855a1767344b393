//! What was chosen, why, and what was not.

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

/// A number with three digits that tell something: `1234`, `12.3`, `0.287`, `0.00012`.
pub(super) fn short(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return number.abs().to_string();
    }
    let before_the_point = number.abs().log10().floor() as i32 + 1;
    let decimals = (3 - before_the_point).clamp(0, 12) as usize;
    let text = format!("{number:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').into(),
        false => text,
    }
}

/// What a texel covers: `2 pixels`, `2 x 0.5 pixels`.
pub(super) fn sides([x, y]: [f64; 2]) -> String {
    if short(x) == short(y) { pixels(x) } else { format!("{} x {} pixels", short(x), short(y)) }
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
    let text = short(number);
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
    fn numbers_have_three_digits() {
        let numbers = [0.0, 1.0, 12_345.6, 12.34, 0.28712, 0.000_123_4, 1e-9].map(short);
        assert_eq!(numbers, ["0", "1", "12346", "12.3", "0.287", "0.000123", "0.000000001"]);
        assert_eq!([f64::INFINITY, f64::NAN].map(short), ["inf", "NaN"]);
        assert_eq!([degrees(1.0), degrees(0.5), pixels(2.0)], ["1 degree", "0.5 degrees", "2 pixels"]);
    }
}
