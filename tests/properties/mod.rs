//! Laws that hold for any input, over the public API: proptest makes the inputs, and makes failing ones small.
//!
//! The same inputs in every run; `PROPTEST_CASES=25600` makes a hundred times as many, `PROPTEST_RNG_SEED=7` others. A
//! failure prints its smallest input and the seed. Inputs that once failed stand as plain tests beside the law.

mod bakes;
mod blends;
mod inputs;
mod meshes;
mod symmetries;
mod text;

use crate::support::Subject;
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngSeed, TestError, TestRunner};
use std::sync::OnceLock;
use texbake::{Baker, Error};

/// Inputs of a law unless `PROPTEST_CASES` says otherwise: then these are the share of that number in 256.
const CASES: u32 = 256;
/// Inputs of a law that runs on GPUs too.
const FEW: u32 = 16;

/// A law, which panics where it does not hold, holds for all inputs.
fn holds<S: Strategy>(cases: u32, inputs: S, law: impl Fn(S::Value)) {
    let asked = Config::default();
    let seed = match asked.rng_seed {
        RngSeed::Fixed(seed) => seed,
        RngSeed::Random => 5,
    };
    let cases = (u64::from(asked.cases) * u64::from(cases) / 256).max(1) as u32;
    // Local files of failures would make runs differ.
    let config =
        Config { cases, max_shrink_iters: 20_000, rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..asked };
    println!("{cases} inputs, PROPTEST_RNG_SEED={seed}");
    let run = TestRunner::new(config).run(&inputs, |input| {
        law(input);
        Ok(())
    });
    match run {
        Ok(()) => (),
        Err(TestError::Fail(reason, input)) => panic!("PROPTEST_RNG_SEED={seed}: {reason}\nsmallest input: {input:?}"),
        Err(TestError::Abort(reason)) => panic!("PROPTEST_RNG_SEED={seed}: no inputs: {reason}"),
    }
}

/// The CPU's bakers: the reference first.
fn on_the_cpu() -> &'static [Subject] {
    static BAKERS: OnceLock<Vec<Subject>> = OnceLock::new();
    BAKERS.get_or_init(|| {
        let three = Baker::cpu_threads(3).expect("threads");
        vec![
            Subject { name: "reference", baker: Baker::reference() },
            Subject { name: "cpu", baker: Baker::cpu() },
            Subject { name: "3 threads", baker: three },
        ]
    })
}

/// An error says what was wrong: a parameter's message begins with its name.
fn assert_names_its_cause(error: &Error) {
    let message = error.to_string();
    match error {
        Error::Parameter { parameter, range, .. } => {
            assert!(!parameter.is_empty() && !range.is_empty(), "{message:?}");
            assert!(message.starts_with(&format!("{parameter} is ")), "{message:?}");
        }
        Error::NotFinite { x, y, .. } => {
            assert!(message.starts_with(&format!("the height at column {x}, row {y} is ")), "{message:?}");
        }
        Error::NoDirection { x, y, .. } => {
            assert!(message.starts_with(&format!("the normal at column {x}, row {y} ")), "{message:?}");
        }
        Error::Vertex { attribute, vertex, .. } => {
            assert!(message.starts_with(&format!("the {attribute} of vertex {vertex} is ")), "{message:?}");
        }
        other => panic!("an error of another kind: {other:?}"),
    }
}

/// One answer of all bakers, or one refusal.
fn agreed<T>(
    bakers: &[Subject],
    run: impl Fn(&Baker) -> Result<T, Error>,
    same: impl Fn(&T, &T) -> Result<(), String>,
) -> Result<T, Error> {
    let expected = run(&bakers[0].baker);
    for Subject { name, baker } in &bakers[1..] {
        match (run(baker), &expected) {
            (Ok(got), Ok(expected)) => same(&got, expected).unwrap_or_else(|report| panic!("{name}: {report}")),
            (Err(got), Err(expected)) => assert_eq!(got.to_string(), expected.to_string(), "{name}"),
            (got, expected) => panic!("{name}: {:?}, the reference: {:?}", got.err(), expected.as_ref().err()),
        }
    }
    expected.inspect_err(assert_names_its_cause)
}

/// A law that does not hold is reported, with its smallest input and the seed.
#[test]
fn a_law_that_does_not_hold_fails() {
    let failing = || holds(CASES, 0u32..1000, |number| assert!(number < 17, "{number} is too much"));
    let panic = std::panic::catch_unwind(failing).expect_err("no law");
    let report = panic.downcast_ref::<String>().expect("a message");
    assert!(report.contains("smallest input: 17") && report.contains("PROPTEST_RNG_SEED="), "{report}");
}

/// Bakers that answer differently, or of which one refuses, do not agree.
#[test]
fn answers_that_differ_are_noticed() {
    let by_name = |baker: &Baker| Ok(baker.name());
    let equal = |got: &String, expected: &String| if got == expected { Ok(()) } else { Err(got.clone()) };
    let refused = |baker: &Baker| if baker.name().contains("3 threads") { Err(Error::Cancelled) } else { Ok(()) };
    let caught = |run: &dyn Fn()| std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).is_err();
    assert!(caught(&|| drop(agreed(on_the_cpu(), by_name, equal))));
    assert!(caught(&|| drop(agreed(on_the_cpu(), refused, |(), ()| Ok(())))));
    assert!(!caught(&|| drop(agreed(&on_the_cpu()[..1], by_name, equal))));
}
