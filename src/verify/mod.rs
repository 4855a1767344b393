//! Proof that a device computes what it should: every kernel against its CPU twin, on this machine.
//!
//! ```
//! use texbake::stream::Monitor;
//! use texbake::verify::{Options, Subject};
//!
//! let options = Options { only: Some("normal map, u8".into()), ..Default::default() };
//! let report = Subject::cpu().verify(&options, &Monitor::default(), &mut |_| ())?;
//! assert!(report.passed(), "{report:?}");
//! # Ok::<(), texbake::Error>(())
//! ```

mod agreement;
mod answer;
mod bounds;
mod cases;
mod chance;
#[cfg(feature = "gpu")]
mod html;
mod job;
mod mismatch;
mod options;
mod oracle;
#[cfg(feature = "gpu")]
mod own_kernel;
#[cfg(feature = "gpu")]
mod page;
mod report;
mod sabotage;
mod shrink;
mod subject;

pub use agreement::{Agreement, Bound, Errors};
#[cfg(feature = "gpu")]
pub use html::Page;
pub use options::Options;
#[cfg(feature = "gpu")]
pub use own_kernel::{Binding, KernelComparison, OwnKernel, Tolerance, WordMismatch, Work};
pub use report::{Comparison, DeviceReport, Mismatch, OracleAnswer, Report, Stored};
pub use subject::{Progress, Subject};
