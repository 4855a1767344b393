//! The kept figures: what every kernel cost when somebody last looked, so that a dearer one shows in review.

use crate::cost::Cost;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Costs by part and kernel.
pub type Costs = BTreeMap<(String, String), Cost>;

/// Costs, and the driver that they are of.
#[derive(Debug, Default, PartialEq)]
pub struct Figures {
    /// `Mesa 22.3.6`.
    pub driver: String,
    pub costs: Costs,
}

const DRIVER: &str = "driver\t";

impl Figures {
    /// The kept ones.
    pub fn kept() -> Result<Self, String> {
        let text = std::fs::read_to_string(path()).map_err(|error| format!("{}: {error}", path().display()))?;
        Self::parse(&text).ok_or_else(|| format!("{} is damaged; --keep writes it anew", path().display()))
    }

    /// Keeps these.
    pub fn keep(&self) -> Result<(), String> {
        std::fs::write(path(), self.text()).map_err(|error| format!("{}: {error}", path().display()))
    }

    fn text(&self) -> String {
        let mut text = format!("{DRIVER}{}\npart\tkernel\t{}\n", self.driver, Cost::COLUMNS.join("\t"));
        for ((part, kernel), cost) in &self.costs {
            text += &format!("{part}\t{kernel}\t{}\n", cost.line());
        }
        text
    }

    fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        let driver = lines.next()?.strip_prefix(DRIVER)?.to_string();
        lines.next()?;
        let costs = lines.map(parse_line).collect::<Option<_>>()?;
        Some(Self { driver, costs })
    }

    /// What is new, dearer or cheaper here than in the `kept` ones, and whether anything is new or dearer.
    pub fn compare(&self, kept: &Self) -> (Vec<String>, bool) {
        let mut lines = Vec::new();
        let mut fails = false;
        for ((part, kernel), cost) in &self.costs {
            let key = (part.clone(), kernel.clone());
            let Some(before) = kept.costs.get(&key) else {
                lines.push(format!("new: {part}, {kernel}"));
                fails = true;
                continue;
            };
            let (now, then) = (cost.throughput, before.throughput);
            if now != then {
                let what = if now > then { "dearer" } else { "cheaper" };
                let percent = 100.0 * (now as f64 / then as f64 - 1.0);
                lines.push(format!("{what}: {part}, {kernel}: {then} to {now} cycles, {percent:+.1} %"));
            }
            fails |= now > then;
        }
        (lines, fails)
    }
}

/// `part`, `kernel` and the numbers, separated by tabs.
pub fn parse_line(line: &str) -> Option<((String, String), Cost)> {
    let (part, rest) = line.split_once('\t')?;
    let (kernel, numbers) = rest.split_once('\t')?;
    Some(((part.into(), kernel.into()), Cost::parse(numbers)?))
}

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("benches/gpu_cost/figures.tsv")
}
