//! A constant changed in each kernel is noticed by every comparison, on every device, and shrunk to a few texels.

use super::{only, subjects, verified};
use texbake::verify::{Options, Subject};

#[test]
fn every_comparison_notices_a_changed_constant() {
    for subject in subjects() {
        let report = verified(&subject.sabotaged(), &Options::default());
        assert!(!report.passed());
        assert_eq!(report.failure, None, "{}: differences are no failure of the device", report.device);
        for comparison in &report.comparisons {
            let what = format!("{}: {}, {}", report.device, comparison.operation, comparison.precision);
            assert!(!comparison.passed(), "{what} passes though it is sabotaged");
            let mismatch = comparison.mismatch.as_ref().unwrap_or_else(|| panic!("{what} shows no mismatch"));
            assert_ne!(mismatch.device, mismatch.specification, "{what}: {mismatch:#?}");
            assert!(!mismatch.input.contains("too many"), "{what}: {mismatch:#?}");
            assert!(mismatch.device.is_some() && mismatch.specification.is_some(), "{what}: {mismatch:#?}");
        }
    }
}

#[test]
fn a_mismatch_is_shrunk_and_says_how_to_repeat_it() {
    for subject in subjects() {
        let subject = subject.sabotaged();
        let report = verified(&subject, &only("normal map, exact, u16, unorm 8 xyz gl|unorm 8 xyz dx, random"));
        let mismatch = report.comparisons[0].mismatch.as_ref().unwrap_or_else(|| panic!("{report:#?}"));
        // Three rows of heights at most, below the line that says of what scale they are.
        let rows = mismatch.input.lines().count() - 2;
        assert!((1..=3).contains(&rows), "{}", mismatch.input);
        // The CPU that is asked besides is an honest one.
        assert_eq!(mismatch.cpu, mismatch.specification, "{mismatch:#?}");
        // The specification's code is the oracle's.
        let oracle = mismatch.oracle.as_ref().unwrap();
        assert_eq!(oracle.bits, mismatch.specification.map(|stored| stored.bits), "{mismatch:#?}");
        // The named case alone fails in the same way.
        assert!(mismatch.command.starts_with("texbake verify --"), "{}", mismatch.command);
        assert!(mismatch.command.ends_with(&format!("--sabotage --only {:?}", mismatch.case)), "{}", mismatch.command);
        let again = verified(&subject, &only(&mismatch.case));
        assert_eq!(again.comparisons[0].cases, 1);
        assert_eq!(again.comparisons[0].mismatch.as_ref(), Some(mismatch));
    }
}

#[test]
fn an_honest_device_agrees_where_the_sabotaged_one_does_not() {
    let case = only("normal map, exact, u16, unorm 8 xyz gl|unorm 8 xyz dx");
    assert!(verified(&Subject::cpu(), &case).passed());
    assert!(!verified(&Subject::cpu().sabotaged(), &case).passed());
    // Kernels that were compiled before are no excuse.
    for subject in subjects() {
        assert!(verified(&subject, &case).passed());
        assert!(!verified(&subject.sabotaged(), &case).passed());
    }
}
