//! What is verified, of all that there is.

use super::cases::{Case, Extent, cases};
use crate::error::{Error, Result};

/// What is verified.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// What all inputs are made from.
    pub seed: u64,
    /// Besides every kernel on every kind of input: every filter under every edge mode and convention, and every pair of
    /// formats that are blended. A hundred and eighty thousand cases instead of fifteen hundred.
    pub full: bool,
    /// Only cases that have all these words: `normal map, u8|u16, wrap`.
    pub only: Option<String>,
}

impl Default for Options {
    fn default() -> Self {
        Self { seed: 1, full: false, only: None }
    }
}

impl Options {
    /// The same of a quick run.
    #[cfg(feature = "gpu")]
    pub(super) fn quick(&self) -> Self {
        Self { full: false, ..self.clone() }
    }

    /// The cases that these options mean.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is none.
    pub(crate) fn cases(&self) -> Result<Vec<Case>> {
        let cases = cases(if self.full { Extent::Full } else { Extent::Quick });
        match &self.only {
            None => Ok(cases),
            Some(only) => cases_with(only, cases),
        }
    }
}

/// The cases that have all of some words. A word is a part of a case's name between commas, or some whole words of one;
/// where the first finds cases, the second is not looked for.
fn cases_with(only: &str, cases: Vec<Case>) -> Result<Vec<Case>> {
    let only = only.to_lowercase();
    let wanted: Vec<Vec<&str>> = only.split(',').map(|word| word.split('|').map(str::trim).collect()).collect();
    let is_part = |name: &str, word: &str| name.split(", ").any(|part| part == word);
    let is_in_part =
        |name: &str, word: &str| name.split(", ").any(|part| format!(" {part} ").contains(&format!(" {word} ")));
    for matches in [&is_part as &dyn Fn(&str, &str) -> bool, &is_in_part] {
        let has = |case: &Case, either: &Vec<&str>| either.iter().any(|word| matches(&case.name, word));
        if cases.iter().any(|case| wanted.iter().all(|either| has(case, either))) {
            return Ok(cases.into_iter().filter(|case| wanted.iter().all(|either| has(case, either))).collect());
        }
    }
    let is_known = |word: &&str| cases.iter().any(|case| is_in_part(&case.name, word));
    let unknown: Vec<&str> = wanted.concat().into_iter().filter(|word| !is_known(word)).collect();
    let example = "such as normal map, exact, u16, wrap, random";
    let range = match unknown[..] {
        [] => format!("words that some case has together, {example}"),
        _ => format!("words of a case's name with commas between them, {example}; no case has {}", unknown.join(", ")),
    };
    Err(Error::parameter("only", only, range))
}
