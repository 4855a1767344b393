//! Every baker that this machine and this build have.

use super::{Format, Image, differences};
use std::sync::OnceLock;
use texbake::{
    Baker, BlendInputs, BlendOptions, CodeMap, HeightMap, NormalMap, NormalOptions, ParallaxFormat, ParallaxOptions,
    Precision,
};

/// A baker under test.
pub struct Subject {
    pub name: &'static str,
    pub baker: Baker,
}

struct Bakers {
    found: Vec<Subject>,
    /// Devices that should have been there, and why they are not.
    missing: Vec<String>,
}

/// All bakers, opened once per process; each test runs its body once for each of them.
///
/// A software GPU that is missing is printed; with `TEXBAKE_REQUIRE_GPU=1` it fails the test.
pub fn every_baker() -> &'static [Subject] {
    static BAKERS: OnceLock<Bakers> = OnceLock::new();
    let Bakers { found, missing } = BAKERS.get_or_init(open);
    for reason in missing {
        println!("not tested: {reason}");
    }
    let required = std::env::var("TEXBAKE_REQUIRE_GPU").is_ok_and(|value| value == "1");
    assert!(missing.is_empty() || !required, "TEXBAKE_REQUIRE_GPU=1, but {}", missing.join("; "));
    found
}

/// The CPU's bakers, and the GPUs' if they are wanted: a device compiles a kernel for each mix of formats and methods,
/// so it sees a part of the many that differ in parameters alone.
pub fn bakers(with_gpus: bool) -> impl Iterator<Item = &'static Subject> {
    every_baker().iter().filter(move |Subject { name, .. }| with_gpus || ["reference", "cpu"].contains(name))
}

#[cfg_attr(not(feature = "gpu"), expect(unused_mut, reason = "only GPUs are added, and only they can be missing"))]
fn open() -> Bakers {
    let mut found =
        vec![Subject { name: "reference", baker: Baker::reference() }, Subject { name: "cpu", baker: Baker::cpu() }];
    let mut missing = Vec::new();
    #[cfg(feature = "gpu")]
    for name in ["vulkan:llvmpipe", "gl:llvmpipe", "vulkan:swiftshader"] {
        match Baker::gpu(Some(name)) {
            Ok(baker) => found.push(Subject { name, baker }),
            Err(error) => missing.push(format!("{name}: {error}")),
        }
    }
    Bakers { found, missing }
}

/// Fails with what `check` says of each baker that fails it: one does not hide the others.
pub fn assert_each(
    bakers: impl Iterator<Item = &'static Subject>,
    check: impl Fn(&'static Subject) -> Result<(), String>,
) {
    let failures: Vec<String> = bakers.filter_map(|subject| check(subject).err()).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A map that a baker made, or failed to make, beside the expected one.
fn same<F: Format>(what: &str, made: texbake::Result<CodeMap<F>>, expected: &Image<F>) -> Result<(), String> {
    let made = made.map_err(|error| format!("{what}: {error}"))?;
    differences(&Image::from(&made), expected).map_err(|report| format!("{what}: {report}"))
}

/// Every baker makes exactly the expected codes of a height map.
pub fn assert_every_baker(map: &HeightMap, options: &NormalOptions, expected: &Image) {
    assert_each(every_baker().iter(), |Subject { name, baker }| {
        let what = format!("{name}, {} heights, {options:?}", map.height_type());
        same(&what, baker.normal(map, options), expected)
    });
}

/// Every baker blends two maps into exactly the expected codes.
pub fn assert_every_blend(inputs: &BlendInputs<&NormalMap, &HeightMap>, options: &BlendOptions, expected: &Image) {
    assert_blends(every_baker().iter(), inputs, options, expected);
}

/// These bakers blend two maps into exactly the expected codes.
pub fn assert_blends(
    bakers: impl Iterator<Item = &'static Subject>,
    inputs: &BlendInputs<&NormalMap, &HeightMap>,
    options: &BlendOptions,
    expected: &Image,
) {
    let formats = [inputs.base.format(), inputs.detail.format()];
    assert_each(bakers, |Subject { name, baker }| {
        same(&format!("{name}, {formats:?}, {options:?}"), baker.blend(inputs, options), expected)
    });
}

/// Every baker makes exactly the expected parallax map of a height map.
pub fn assert_every_parallax(map: &HeightMap, options: &ParallaxOptions, expected: &Image<ParallaxFormat>) {
    assert_each(every_baker().iter(), |Subject { name, baker }| {
        let what = format!("{name}, {} heights, {options:?}", map.height_type());
        same(&what, baker.parallax(map, options), expected)
    });
}

/// Every baker makes exactly the expected parallax map of a height map and a normal map.
pub fn assert_every_parallax_with_normals(map: &HeightMap, normals: &NormalMap, expected: &Image<ParallaxFormat>) {
    assert_each(every_baker().iter(), |Subject { name, baker }| {
        let what = format!("{name}, {} heights, {:?}, {:?}", map.height_type(), normals.format(), expected.format);
        let baked = baker.parallax_with_normals(map, normals, expected.format, Precision::Exact);
        same(&what, baked, expected)
    });
}
