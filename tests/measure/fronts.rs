//! Pareto fronts of points that are written out.

use texbake::measure::{Front, Statistic, pareto_front};

#[test]
fn points_that_are_beaten_are_left_out() {
    // Cost and error; what beats each of the others stands beside it.
    let points = [
        (4.0, 1.0), // on the front
        (1.0, 9.0), // on the front
        (4.0, 2.0), // 0: as cheap, more right
        (2.0, 9.0), // 1: cheaper, as right
        (2.0, 5.0), // on the front
        (2.0, 5.0), // 4: the same, and earlier
        (9.0, 1.0), // 0: cheaper, as right
        (3.0, 7.0), // 4: both
    ];
    assert_eq!(pareto_front(&points), [1, 4, 0]);
    assert_eq!(pareto_front(&[]), [0usize; 0]);
    assert_eq!(pareto_front(&[(1.0, 0.0), (1.0, 0.0)]), [0]);
}

fn front(candidates: &[(&str, f64, f64)]) -> Front {
    let candidates = candidates.iter().map(|&(name, cost, error)| (name.to_owned(), cost, error));
    Front::new("storage", Statistic::Percentile99, ["bytes per texel", "degrees"], candidates)
}

#[test]
fn steps_say_what_they_buy_and_cost() {
    let storage = front(&[
        ("unorm 8 xyz", 3.0, 0.3),
        ("unorm 8 xy", 2.0, 0.36),
        ("dear", 5.0, 0.5),
        ("snorm 16 xy", 4.0, 0.0012),
        ("truth", 12.0, 0.0),
    ]);
    assert_eq!(
        storage.lines(),
        [
            "unorm 8 xy is the cheapest: 2 bytes per texel, 0.36 degrees",
            "from unorm 8 xy to unorm 8 xyz: +1 byte per texel buys 1.2 times less error, 0.3 instead of 0.36 degrees",
            "from unorm 8 xyz to snorm 16 xy: +1 byte per texel buys 250 times less error, 0.0012 instead of 0.3 degrees",
            "from snorm 16 xy to truth: +8 bytes per texel buys the rest of the error, 0 instead of 0.0012 degrees",
        ]
    );
    let best: Vec<_> = storage.best().iter().map(|it| it.name.as_str()).collect();
    assert_eq!(best, ["unorm 8 xy", "unorm 8 xyz", "snorm 16 xy", "truth"]);
    assert_eq!(storage.steps[1].times_less_error.map(f64::round), Some(250.0));
    assert_eq!((storage.steps[2].extra_cost, storage.steps[2].times_less_error), (8.0, None));
}

#[test]
fn gains_that_are_noise_are_no_steps() {
    // 4 % less, then 4 % less again, which together are worth a step.
    let times = front(&[("a", 1.0, 100.0), ("b", 2.0, 96.0), ("c", 3.0, 92.0), ("d", 4.0, 91.9)]);
    let best: Vec<_> = times.best().iter().map(|it| it.name.as_str()).collect();
    assert_eq!(best, ["a", "c"]);
}

#[test]
fn costs_that_are_noise_are_no_steps() {
    // 4 % more for a tenth of the error: a clock cannot tell the costs from each other.
    let times = front(&[("a", 1.0, 100.0), ("b", 10.0, 50.0), ("c", 10.4, 5.0), ("d", 11.0, 4.0)]);
    let best: Vec<_> = times.best().iter().map(|it| it.name.as_str()).collect();
    assert_eq!(best, ["a", "c", "d"]);
    assert!(times.steps.iter().all(|step| step.extra_cost > 0.5));
}
