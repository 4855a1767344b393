//! A device that fails while a folder is baked.

use super::lost::Told;
use super::{SIZE, lavapipe};
use crate::Baker;
use crate::backend::gpu::kernel::BAKE_INTEGERS;
use crate::backend::gpu::{Gpu, Untested};
use crate::backend::{Backend, RowBytes};
use crate::batch::{Event, Job, Outcome, Report, run};
use crate::error::Result;
use crate::io::{RawKind, RawLayout, ReadOptions, WriteOptions};
use crate::map::{Maps, Size};
use crate::ops::bake::{BakeOptions, BakePlan};
use crate::ops::blend::BlendPlan;
use crate::ops::parallax::ParallaxPlan;
use crate::ops::tangents::TangentPlan;
use crate::stream::{CodeSink, HeightBands, LayerBands, Monitor};
use std::num::NonZeroU32;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Duration;
use tempfile::TempDir;

const FILES: usize = 6;

/// A GPU that takes bands of eight rows, and is struck before this band of this bake.
struct Struck {
    gpu: Arc<Untested>,
    bakes: AtomicUsize,
    at: (usize, usize),
}

impl Backend for Struck {
    fn kind(&self) -> &'static str {
        self.gpu.kind()
    }

    fn device(&self) -> String {
        self.gpu.device()
    }

    fn band_rows(&self, _: RowBytes) -> usize {
        8
    }

    fn bake(&self, plan: &BakePlan, bands: &mut dyn HeightBands, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        let bake = self.bakes.fetch_add(1, Relaxed);
        let before = |band| {
            if (bake, band) == self.at {
                self.gpu.device.device.destroy();
            }
        };
        self.gpu.bake(plan, &mut Told { bands, count: 0, before }, sinks)
    }

    fn blend(&self, plan: &BlendPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        self.gpu.blend(plan, bands, sink)
    }

    fn parallax(&self, plan: &ParallaxPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        self.gpu.parallax(plan, bands, sink)
    }

    fn tangents(&self, plan: &TangentPlan<'_>, out: &mut [[f32; 4]]) -> Result<()> {
        self.gpu.tangents(plan, out)
    }
}

/// A folder of height maps, and what the CPU bakes from each.
struct Folder {
    folder: TempDir,
    expected: Vec<Vec<u8>>,
}

impl Folder {
    fn new() -> Self {
        let mut this = Self { folder: TempDir::new().unwrap(), expected: Vec::new() };
        for file in 0..FILES {
            let heights: Vec<u8> =
                (0..SIZE[0] * SIZE[1]).map(|texel| (texel * texel / 7 + 31 * file * texel) as u8).collect();
            std::fs::write(this.folder.path().join(format!("{file}.raw")), heights).unwrap();
        }
        let jobs = this.jobs("expected", Baker::reference());
        assert!(run(&jobs, 1, &Monitor::default(), &|_| ()).iter().all(|outcome| outcome.result.is_ok()));
        this.expected = (0..FILES).map(|file| this.baked("expected", file).unwrap()).collect();
        this
    }

    fn jobs(&self, out: &str, baker: Baker) -> Vec<Job> {
        let raw = Some(RawLayout { size: Size::new(SIZE[0], SIZE[1]).unwrap(), kind: RawKind::U8 });
        let baker = Arc::new(baker);
        let job = |file| Job {
            input: self.folder.path().join(format!("{file}.raw")),
            outputs: Maps {
                normal: Some(self.folder.path().join(out).join(format!("{file}.tif"))),
                parallax: None,
                roughness: None,
            },
            normals: None,
            neighbours: None,
            read: ReadOptions { raw, ..Default::default() },
            options: BakeOptions::default(),
            write: WriteOptions::default(),
            baker: baker.clone(),
        };
        (0..FILES).map(job).collect()
    }

    fn baked(&self, out: &str, file: usize) -> Option<Vec<u8>> {
        std::fs::read(self.folder.path().join(out).join(format!("{file}.tif"))).ok()
    }

    /// Bakes all files into `out`, and tells of each whether and why the CPU took over, or why it failed. Files that
    /// are there must be whole and right, and nothing else may be.
    fn bake(&self, out: &str, at_once: usize, baker: Baker, watch: &(dyn Fn(Event<'_>) + Sync)) -> Vec<Fate> {
        let jobs = self.jobs(out, baker);
        let outcomes = run(&jobs, at_once, &Monitor::default(), watch);
        let report = Report::new(&jobs, &outcomes, Duration::ZERO, &[], None, NonZeroU32::MIN);
        let left: Vec<_> = std::fs::read_dir(self.folder.path().join(out)).into_iter().flatten().collect();
        assert_eq!(left.len(), outcomes.iter().filter(|outcome| outcome.result.is_ok()).count(), "{left:?}");
        let tell = |(file, outcome): (usize, &Outcome)| match &outcome.result {
            Ok(baked) => {
                assert!(self.baked(out, file).as_ref() == Some(&self.expected[file]), "file {file}");
                let reported = &report.files[file].run;
                assert_eq!(reported.fallback, baked.ran.fallback);
                assert_eq!(reported.backend, Some(if reported.fallback.is_some() { "cpu" } else { "gpu" }));
                Ok(reported.fallback.clone())
            }
            Err(error) => {
                assert!(report.files[file].run.error.as_ref().unwrap().ends_with(&error.to_string()));
                Err(error.to_string())
            }
        };
        outcomes.iter().enumerate().map(tell).collect()
    }
}

/// Why the CPU took over, if it did, or why there is no map.
type Fate = Result<Option<String>, String>;

/// A device in a baker, and the baker.
fn struck(at: (usize, usize), falls_back: bool) -> Option<(Arc<Untested>, Baker)> {
    let gpu = Arc::new(Untested { device: lavapipe()? });
    let struck = Struck { gpu: gpu.clone(), bakes: AtomicUsize::new(0), at };
    Some((gpu, Baker::prepared(Arc::new(struck), falls_back)))
}

fn tells_of_a_loss(reason: &str) -> bool {
    reason.starts_with("vulkan:llvmpipe") && reason.contains("the device was lost")
}

#[test]
fn a_device_lost_in_the_middle_of_a_batch_leaves_the_rest_to_the_cpu() {
    let folder = Folder::new();
    for (file, band) in [(0, 0), (2, 0), (2, 3), (3, 5), (FILES - 1, 4)] {
        let Some((_gpu, baker)) = struck((file, band), true) else { return };
        let told = folder.bake("out", 1, baker, &|_| ());
        for (index, told) in told.iter().enumerate() {
            let fallback = told.as_ref().expect("a map");
            assert_eq!(fallback.is_some(), index >= file, "file {index}, lost at {file}: {fallback:?}");
            assert!(fallback.as_deref().is_none_or(tells_of_a_loss), "{fallback:?}");
        }
    }
}

#[test]
fn a_device_lost_between_files_leaves_the_rest_to_the_cpu() {
    let folder = Folder::new();
    let never = (usize::MAX, 0);
    let Some((gpu, baker)) = struck(never, true) else { return };
    let told = folder.bake("out", 1, baker, &|event| {
        if matches!(event, Event::Ended { job: 2, .. }) {
            gpu.device.device.destroy();
        }
    });
    let by_the_cpu: Vec<bool> = told.iter().map(|told| told.as_ref().expect("a map").is_some()).collect();
    assert_eq!(by_the_cpu, [false, false, false, true, true, true]);
    assert!(told.iter().flatten().flatten().all(|reason| tells_of_a_loss(reason)), "{told:?}");
}

#[test]
fn a_device_lost_under_many_bakes_at_once_leaves_them_to_the_cpu() {
    let folder = Folder::new();
    for at in [(1, 2), (3, 4)] {
        let Some((_gpu, baker)) = struck(at, true) else { return };
        let told = folder.bake("out", 3, baker, &|_| ());
        let reasons: Vec<&String> = told.iter().filter_map(|told| told.as_ref().expect("a map").as_ref()).collect();
        assert!(!reasons.is_empty() && reasons.iter().all(|reason| tells_of_a_loss(reason)), "{reasons:?}");
    }
}

#[test]
fn a_device_lost_without_a_fallback_leaves_no_file_from_then_on() {
    let folder = Folder::new();
    for (file, band) in [(0, 0), (2, 3), (FILES - 1, 5)] {
        let Some((_gpu, baker)) = struck((file, band), false) else { return };
        let out = format!("out {file}");
        let told = folder.bake(&out, 1, baker, &|_| ());
        for (index, told) in told.iter().enumerate() {
            match told {
                Ok(fallback) => assert!(index < file && fallback.is_none(), "file {index}, lost at {file}"),
                Err(error) => assert!(index >= file && tells_of_a_loss(error), "file {index}, lost at {file}: {error}"),
            }
        }
    }
}

/// Lavapipe with a kernel that computes wrong bytes.
fn sabotaged() -> Option<Untested> {
    let device = lavapipe()?;
    let text = BAKE_INTEGERS.text();
    let from = "let south = heights_at(";
    assert!(text.contains(from));
    device.substitute(BAKE_INTEGERS, &text.replacen(from, "let south = middle; _ = heights_at(", 1));
    Some(Untested { device })
}

#[test]
fn a_device_that_fails_its_self_test_is_not_opened() {
    let Some(untested) = sabotaged() else { return };
    let error = Gpu::tested(untested).map(drop).unwrap_err().to_string();
    assert!(error.contains("it fails the self-test: bake: wrong"), "{error}");
    let auto = Baker::or_cpu(Err(error.clone()));
    assert!(auto.name().starts_with("cpu, ") && auto.reason() == error, "{}", auto.reason());
}

#[test]
fn a_kernel_that_fails_its_self_test_bakes_no_file() {
    let folder = Folder::new();
    let fails = |reason: &str| reason.contains("it fails the self-test: bake: wrong unorm codes of 8 bits");
    for falls_back in [true, false] {
        let Some(untested) = sabotaged() else { return };
        let out = format!("out {falls_back}");
        let baker = Baker::prepared(Arc::new(Gpu { untested }), falls_back);
        for told in folder.bake(&out, 1, baker, &|_| ()) {
            match told {
                Ok(fallback) => assert!(falls_back && fallback.as_deref().is_some_and(fails), "{fallback:?}"),
                Err(error) => assert!(!falls_back && fails(&error), "{error}"),
            }
        }
    }
}

#[test]
fn the_comparison_of_files_sees_a_wrong_one() {
    let mut folder = Folder::new();
    folder.expected[3][200] ^= 1;
    let baked = std::panic::catch_unwind(|| folder.bake("out", 1, Baker::cpu(), &|_| ()));
    assert!(baked.is_err(), "file 3 is not what was expected");
}
