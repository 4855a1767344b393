//! The figures as pictures, SVG and PNG.

mod axis;
mod canvas;
mod chart;
mod labels;

use super::markdown::capital;
use super::{Figures, Front, Statistic};
use crate::error::Result;
use axis::{Axis, Spacing};
use canvas::Picture;
use chart::{Chart, Series};

/// A picture of some figures.
pub(super) struct Plot {
    /// Name of its files.
    pub name: &'static str,
    pub title: String,
    pub svg: String,
    pub png: Vec<u8>,
}

/// The names of fronts, or how they begin if they go on after a space, by which error, the names of their plots, and how their costs are spaced. Those of times
/// on GPUs, of which there may be any number, have none.
const FRONTS: [(&str, Statistic, &str, Spacing); 9] = [
    ("storage of normal maps", Statistic::Percentile99, "storage", Spacing::Linear),
    ("storage of parallax maps", Statistic::Percentile99, "parallax-storage", Spacing::Linear),
    ("time of bakes", Statistic::Percentile99, "bake-time", Spacing::Log),
    ("time of bakes of parallax maps", Statistic::Percentile99, "parallax-bake-time", Spacing::Log),
    ("time of blends", Statistic::Percentile99, "blend-time", Spacing::Log),
    ("fetches of parallax, ", Statistic::Percentile99, "parallax-fetches", Spacing::LogFromZero),
    ("time of parallax, ", Statistic::Percentile99, "parallax-time", Spacing::Log),
    ("fetches of parallax, ", Statistic::Mean, "parallax-fetches-mean", Spacing::LogFromZero),
    ("time of parallax, ", Statistic::Mean, "parallax-time-mean", Spacing::Log),
];

/// The names of the plots over elevations and over steps.
const LINES: [(&str, &str, Statistic); 2] = [
    ("parallax-elevations", "parallax-steps", Statistic::Percentile99),
    ("parallax-elevations-mean", "parallax-steps-mean", Statistic::Mean),
];

/// The methods whose lines are drawn over the elevation.
const METHODS: [&str; 8] =
    ["none", "welsh", "limited", "plane, limit 1", "plane, limit 3", "steps 1", "steps 4", "relief 16+5"];

/// The names of all files.
pub(super) fn plot_files() -> impl Iterator<Item = String> {
    let names = FRONTS.map(|(_, _, name, _)| name).into_iter().chain(LINES.into_iter().flat_map(|(a, b, _)| [a, b]));
    names.flat_map(|name| ["svg", "png"].map(|extension| format!("{name}.{extension}")))
}

/// All pictures of a measurement.
pub(super) fn plots(figures: &Figures) -> Result<Vec<Plot>> {
    let of = |(begins, by, name, spacing): (&str, Statistic, &'static str, Spacing)| {
        // A name that ends with a comma goes on.
        let is_it =
            |it: &&Front| it.by == by && (it.name == begins || begins.ends_with(' ') && it.name.starts_with(begins));
        figures.fronts.iter().find(is_it).map(|front| (front, name, spacing))
    };
    let fronts = FRONTS.into_iter().filter_map(of).map(|(front, name, spacing)| {
        let points = |are_best: bool| {
            let chosen = front.candidates.iter().filter(move |it| it.is_on_front == are_best && it.error.is_finite());
            chosen.map(|it| (it.name.clone(), it.cost, it.error)).collect::<Vec<_>>()
        };
        let mut best = points(true);
        best.sort_by(|a, b| a.1.total_cmp(&b.1));
        let chart = Chart {
            title: front.title(),
            x: Axis::new(front.cost_unit, spacing, front.candidates.iter().map(|it| it.cost)),
            y: Axis::new(
                format!("error in {}", front.error_unit),
                Spacing::Log,
                front.candidates.iter().map(|it| it.error),
            ),
            lines: Vec::new(),
            others: points(false).into_iter().map(|(_, cost, error)| (cost, error)).collect(),
            front: best,
        };
        plot(name, &chart)
    });
    let lines = LINES.into_iter().flat_map(|(over_elevations, over_steps, by)| {
        [plot(over_elevations, &elevations(figures, by)), plot(over_steps, &steps(figures, by))]
    });
    fronts.chain(lines).collect()
}

impl Front {
    /// What its plot shows.
    fn title(&self) -> String {
        format!("{}: {}", capital(&self.name), self.by)
    }
}

fn plot(name: &'static str, chart: &Chart) -> Result<Plot> {
    let Picture { svg, png } = canvas::picture(name, |canvas| chart.draw(canvas))?;
    Ok(Plot { name, title: chart.title.clone(), svg, png })
}

/// How wrong some methods are, over the elevation.
fn elevations(figures: &Figures, by: Statistic) -> Chart {
    let line = |method: &str| {
        let of_method = figures.offsets.iter().filter(|figure| figure.method == method);
        let points = of_method.map(|figure| (figure.elevation_degrees, by.of(&figure.error_texels))).collect();
        Series { name: method.into(), points }
    };
    let title = format!("Offsets of parallax: {by}");
    lines(title, ("elevation in degrees", Spacing::Linear), METHODS.map(line).into())
}

/// What more steps bring, for each elevation.
fn steps(figures: &Figures, by: Statistic) -> Chart {
    let mut elevations: Vec<f64> = figures.offsets.iter().map(|figure| figure.elevation_degrees).collect();
    elevations.dedup();
    let line = |elevation: &f64| {
        let seen = figures.offsets.iter().filter(|figure| figure.elevation_degrees == *elevation);
        let step = |figure: &super::OffsetFigure| {
            let k: f64 = figure.method.strip_prefix("steps ")?.parse().ok()?;
            Some((k, by.of(&figure.error_texels)))
        };
        Series { name: format!("{elevation} degrees"), points: seen.filter_map(step).collect() }
    };
    let title = format!("Offsets of parallax in k steps: {by}");
    lines(title, ("steps k", Spacing::Linear), elevations.iter().map(line).collect())
}

fn lines(title: String, (x, spacing): (&str, Spacing), lines: Vec<Series>) -> Chart {
    let points = || lines.iter().flat_map(|series| &series.points);
    let x = Axis::new(x, spacing, points().map(|point| point.0));
    let y = Axis::new("error in texels", Spacing::Log, points().map(|point| point.1));
    Chart { title, x, y, lines, others: Vec::new(), front: Vec::new() }
}
