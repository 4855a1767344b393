//! Verification itself: it passes where all is well, notices sabotage, shrinks what fails, and says how to repeat it.

#[cfg(feature = "gpu")]
mod browser;
#[cfg(feature = "cli")]
mod command;
#[cfg(feature = "gpu")]
mod own_kernel;
mod sabotage;

use crate::support::every_baker;
use texbake::stream::Monitor;
use texbake::verify::{DeviceReport, Options, Subject};

/// The CPU, and the software GPUs that the other tests use.
fn subjects() -> Vec<Subject> {
    #[cfg_attr(not(feature = "gpu"), expect(unused_mut, reason = "only GPUs are added"))]
    let mut subjects = vec![Subject::cpu()];
    #[cfg(feature = "gpu")]
    for subject in every_baker().iter().filter(|subject| subject.name.contains(':')) {
        subjects.push(Subject::adapter(Some(subject.name)).unwrap());
    }
    subjects
}

fn verified(subject: &Subject, options: &Options) -> DeviceReport {
    subject.verify(options, &Monitor::default(), &mut |_| ()).unwrap()
}

/// Cases of some words.
fn only(words: &str) -> Options {
    Options { only: Some(words.into()), ..Default::default() }
}

/// Comparisons of a quick run, with their cases: what was counted by hand from the lists of choices.
const COMPARISONS: [(&str, &str, u64); 14] = [
    // Three height types, sixteen or eight formats, four or three kinds.
    ("normal map", "exact", 192),
    ("parallax map", "exact", 96),
    ("both in one pass", "exact", 192),
    ("normal map", "fast", 144),
    ("parallax map", "fast", 72),
    ("both in one pass", "fast", 144),
    ("parallax map of given normals", "exact", 144),
    ("parallax map of given normals", "fast", 96),
    // Thirteen methods with five or six formats each, but for the greatest weights in fast; three or two kinds.
    ("blend", "exact", 210),
    ("blend", "fast", 130),
    // Four or two kinds of meshes, four of each.
    ("tangents of mikktspace", "exact", 16),
    ("tangents of lengyel", "exact", 16),
    ("tangents of hegde", "exact", 16),
    ("tangents of mikktspace", "fast", 8),
];

#[test]
fn every_device_agrees_in_every_comparison() {
    for subject in subjects() {
        let report = verified(&subject, &Options::default());
        assert!(report.passed(), "{report:#?}");
        for (operation, precision, cases) in COMPARISONS {
            let found = report.comparisons.iter().find(|it| it.operation == operation && it.precision == precision);
            let found = found.unwrap_or_else(|| panic!("{}: {operation}, {precision}", report.device));
            assert_eq!((found.cases, found.failed_cases), (cases, 0), "{}: {operation}, {precision}", report.device);
            assert!(found.agreement.values > 300 * cases, "{found:?}");
            assert_eq!(found.bound.is_some(), precision == "fast", "{found:?}");
        }
        assert_eq!(report.comparisons.len(), COMPARISONS.len() + 2, "with Lengyel's and Hegde's tangents, fast");
    }
}

#[test]
fn the_specification_is_judged_in_whole_numbers() {
    let report = verified(&Subject::cpu(), &only("exact"));
    for operation in ["normal map", "parallax map", "both in one pass", "parallax map of given normals", "blend"] {
        let found = report.comparisons.iter().find(|it| it.operation == operation).unwrap();
        assert!(found.agreement.judged > 1000, "{operation}: {} codes judged", found.agreement.judged);
    }
}

#[test]
fn other_seeds_give_other_inputs() {
    let of = |seed| {
        let options = Options { seed, ..only("normal map, fast, u16") };
        verified(&Subject::cpu(), &options).comparisons[0].agreement
    };
    assert_eq!(of(1), of(1));
    assert_ne!(of(1).degrees, of(2).degrees);
}

#[test]
fn a_stopped_verification_is_an_error() {
    let monitor = Monitor::default();
    let error = Subject::cpu().verify(&Options::default(), &monitor, &mut |progress| {
        if progress.done == 3 {
            monitor.cancel();
        }
    });
    assert!(matches!(error, Err(texbake::Error::Cancelled)));
}
