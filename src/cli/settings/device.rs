//! Where it runs.

use clap::{Args, ValueEnum};
use texbake::{Baker, Error, Result};

/// What was set of the device.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct Device {
    /// auto: a real GPU, else the CPU; gpu: the best GPU, software too, or an error; reference: plain code on one
    /// thread [default: auto]
    #[arg(long, value_enum, help_heading = HEADING)]
    pub backend: Option<Backend>,

    /// GPU whose description contains NAME, as in `texbake devices`; vulkan:NAME names the API too; implies gpu
    #[arg(long, value_name = "NAME", help_heading = HEADING)]
    pub adapter: Option<String>,
}

const HEADING: &str = "Where it runs";

/// What may be asked to bake.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Backend {
    Auto,
    Cpu,
    Gpu,
    Reference,
}

/// A backend and its adapter, by which bakers are told apart.
pub type Place = (Backend, Option<String>);

impl Device {
    /// These settings, and those of `weaker` where these say nothing.
    pub fn or(self, weaker: Self) -> Self {
        Self {
            adapter: self.adapter.or(weaker.adapter.filter(|_| self.backend.is_none_or(|it| it == Backend::Gpu))),
            backend: self.backend.or(weaker.backend),
        }
    }

    /// What shall bake.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an adapter of something else than a GPU.
    pub fn place(&self) -> Result<Place> {
        match (self.backend, &self.adapter) {
            (None | Some(Backend::Gpu), Some(adapter)) => Ok((Backend::Gpu, Some(adapter.clone()))),
            (_, Some(adapter)) => {
                let range = "left out, or used with --backend gpu".into();
                Err(Error::Parameter { parameter: "adapter", value: adapter.clone(), range })
            }
            (backend, None) => Ok((backend.unwrap_or(Backend::Auto), None)),
        }
    }
}

/// Opens what [`Device::place`] says.
pub fn open_baker((backend, adapter): &Place) -> Result<Baker> {
    match backend {
        Backend::Auto => Ok(Baker::auto()),
        Backend::Cpu => Ok(Baker::cpu()),
        Backend::Gpu => Baker::gpu(adapter.as_deref()),
        Backend::Reference => Ok(Baker::reference()),
    }
}
