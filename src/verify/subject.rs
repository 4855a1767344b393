//! What is verified, and how.

use super::agreement::{Agreement, Difference, compare};
use super::answer::Answer;
use super::bounds;
use super::cases::Case;
use super::job::Job;
use super::mismatch::{self, Origin};
use super::options::Options;
use super::report::{Comparison, DeviceReport};
use super::sabotage;
use crate::backend::cpu::Cpu;
#[cfg(feature = "gpu")]
use crate::backend::{Backend, gpu::Untested};
use crate::baker::Baker;
use crate::error::Result;
use crate::ops::Precision;
use crate::stream::Monitor;
use std::sync::Arc;

/// How far verification of a device has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress<'a> {
    /// Cases that are done.
    pub done: usize,
    /// Cases in all.
    pub of: usize,
    /// The next case.
    pub case: &'a str,
}

/// Compiled kernels are dropped after so many cases: drivers hold a megabyte or so for each.
#[cfg(feature = "gpu")]
const CASES_OF_KERNELS: usize = 512;

/// A backend and its device, to be verified.
pub struct Subject {
    baker: Baker,
    #[cfg(feature = "gpu")]
    gpu: Option<Arc<Untested>>,
    sabotaged: bool,
}

impl Subject {
    /// The vectorised CPU.
    pub fn cpu() -> Self {
        Self {
            baker: Baker::cpu(),
            #[cfg(feature = "gpu")]
            gpu: None,
            sabotaged: false,
        }
    }

    /// The adapter that `selector` means, as for [`Baker::gpu`], or the best one; its kernels are not tested before.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if there is none, or it does not open.
    #[cfg(feature = "gpu")]
    pub fn adapter(selector: Option<&str>) -> Result<Self> {
        Ok(Self::on(Untested::open(selector)?))
    }

    /// Every adapter that `selector` means, or every one of this machine, or why it does not open.
    #[cfg(feature = "gpu")]
    pub fn adapters(selector: Option<&str>) -> Vec<Result<Self>> {
        Untested::all(selector).into_iter().map(|gpu| Ok(Self::on(gpu?))).collect()
    }

    /// A device that a program has opened for itself.
    #[cfg(feature = "gpu")]
    pub fn hosted(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self::on(Untested::hosted(device, queue))
    }

    #[cfg(feature = "gpu")]
    fn on(gpu: Untested) -> Self {
        let gpu = Arc::new(gpu);
        Self { baker: Baker::on(gpu.clone()), gpu: Some(gpu), sabotaged: false }
    }

    /// The same with a constant changed in each kernel: every comparison must fail, or verification proves nothing.
    #[must_use]
    pub fn sabotaged(mut self) -> Self {
        self.sabotaged = true;
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu {
            gpu.replace_kernels(sabotage::changed);
            return self;
        }
        self.baker = Baker::on(Arc::new(sabotage::Changed(Cpu::shared())));
        self
    }

    /// The backend and its device.
    pub fn name(&self) -> String {
        self.baker.name()
    }

    /// The GPU, if it is one.
    #[cfg(feature = "gpu")]
    pub(super) fn gpu(&self) -> Option<&Untested> {
        self.gpu.as_deref()
    }

    /// The adapter's name; `None` for the CPU.
    fn adapter_name(&self) -> Option<String> {
        #[cfg(feature = "gpu")]
        return self.gpu.as_ref().map(|gpu| gpu.device());
        #[cfg(not(feature = "gpu"))]
        None
    }

    /// Runs every case that the options mean and compares each answer with the specification's.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if the options mean no case; [`crate::Error::Cancelled`] if the monitor says so. What
    /// the device does wrong is no error, but in the report.
    pub fn verify(
        &self,
        options: &Options,
        monitor: &Monitor,
        watch: &mut dyn FnMut(Progress<'_>),
    ) -> Result<DeviceReport> {
        let cases = options.cases()?;
        let mut report = DeviceReport { device: self.name(), comparisons: Vec::new(), failure: None };
        for (done, case) in cases.iter().enumerate() {
            monitor.check()?;
            watch(Progress { done, of: cases.len(), case: &case.name });
            #[cfg(feature = "gpu")]
            if let Some(gpu) = self.gpu.as_ref().filter(|_| done % CASES_OF_KERNELS == 0) {
                gpu.forget_kernels();
            }
            let job = case.job(options.seed)?;
            match self.check(&job, case.operation) {
                Ok(checked) => self.count(&mut report.comparisons, case, &job, checked, options, monitor),
                Err(error) => {
                    report.failure = Some(format!("{}: {error}", case.name));
                    break;
                }
            }
        }
        Ok(report)
    }

    /// Runs one job here and by the specification.
    fn check(&self, job: &Job, operation: &str) -> Result<(Agreement, Option<Difference>)> {
        let expected = job.with_precision(Precision::Exact).run(&Baker::reference())?;
        let got = job.run(&self.baker)?;
        let bound = job.is_fast().then(|| bounds::fast(operation));
        let (mut agreement, difference) = compare(&expected, &got, bound.as_ref());
        let misjudged = judge(job, &expected, &mut agreement.judged);
        Ok((agreement, difference.or(misjudged)))
    }

    /// Counts a case that ran.
    fn count(
        &self,
        comparisons: &mut Vec<Comparison>,
        case: &Case,
        job: &Job,
        (agreement, difference): (Agreement, Option<Difference>),
        options: &Options,
        monitor: &Monitor,
    ) {
        let precision = case.precision.to_string();
        let is_it = |it: &Comparison| it.operation == case.operation && it.precision == precision;
        let at = comparisons.iter().position(is_it).unwrap_or_else(|| {
            comparisons.push(Comparison {
                operation: case.operation,
                precision: precision.clone(),
                cases: 0,
                failed_cases: 0,
                agreement: Agreement::default(),
                bound: (case.precision == Precision::Fast).then(|| bounds::fast(case.operation)),
                mismatch: None,
            });
            comparisons.len() - 1
        });
        let comparison = &mut comparisons[at];
        comparison.cases += 1;
        comparison.agreement.merge(&agreement);
        if let Some(difference) = difference {
            comparison.failed_cases += 1;
            if comparison.mismatch.is_none() {
                // A device that fails by then, or somebody who stops it, leaves what is found so far.
                let mut goes_on = true;
                let check = |job: &Job| {
                    goes_on = goes_on && !monitor.is_cancelled();
                    let checked = goes_on.then(|| self.check(job, case.operation))?;
                    goes_on = checked.is_ok();
                    checked.ok()?.1
                };
                let found = mismatch::smallest(job.clone(), difference, check);
                let origin = Origin { baker: &self.baker, adapter: self.adapter_name(), is_sabotaged: self.sabotaged };
                comparison.mismatch = Some(found.describe(&origin, case, options));
            }
        }
    }
}

/// Of each map as many codes are judged, spread over it.
const JUDGED: usize = 64;

/// Holds codes of the specification against the formula in whole numbers, where they are promised to be correctly
/// rounded; gives the first that is not.
fn judge(job: &Job, expected: &[Answer], judged: &mut u64) -> Option<Difference> {
    if job.is_fast() || !job.is_correctly_rounded() {
        return None;
    }
    let mut first = None;
    for (map, answer) in expected.iter().enumerate() {
        for step in 0..JUDGED.min(answer.len()) {
            // Steps of a prime above every row: all columns, rows and channels have their turn.
            let index = step * 7919 % answer.len();
            let Some(code) = job.real(map, index).and_then(|real| real.code(answer.format)) else { continue };
            *judged += 1;
            if code != answer.bits(index) {
                first = first.or(Some(Difference { map, index }));
            }
        }
    }
    first
}
