//! Mip levels, and the roughness that stands for what they lose.

use crate::cli::values::{choice, value};
use clap::Args;
use std::path::Path;
use texbake::io::{WriteOptions, check_parallax_with};
use texbake::{
    Depth, Encoding, Error, ParallaxFormat, Rational, Result, RoughnessFormat, RoughnessMethod, RoughnessOptions,
};

/// Whether there are mip levels.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct Mips {
    /// Write all mip levels down to one texel into .ktx2 and .dds files: slopes are averaged and not normals, and the
    /// normal and code of each mean slope are exact [default: false]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[arg(help_heading = HEADING)]
    pub mips: Option<bool>,
}

/// What was set of a roughness map.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct Roughness {
    /// How the roughness of a level grows: lean by the variance of the slopes that it averages, toksvig by how short
    /// their mean normal is [default: lean]
    #[arg(long, value_name = "METHOD", value_parser = choice::<RoughnessMethod>(RoughnessMethod::NAMES))]
    #[arg(help_heading = HEADING)]
    pub roughness_method: Option<RoughnessMethod>,

    /// Roughness of the surface itself, from 0 to 1, as in glTF and Unreal: its square is GGX's alpha [default: 0]
    #[arg(long, value_name = "NUMBER", value_parser = value::<Rational>, help_heading = HEADING)]
    pub base_roughness: Option<Rational>,

    /// Bits of a code of a roughness map: 8 or 16 [default: 8]
    #[arg(long, value_name = "BITS", value_parser = choice::<Depth>(&["8", "16"]), help_heading = HEADING)]
    pub roughness_bits: Option<Depth>,
}

const HEADING: &str = "Mip levels";

impl Mips {
    /// These settings, and those of `weaker` where these say nothing.
    pub fn or(self, weaker: &Self) -> Self {
        Self { mips: self.mips.or(weaker.mips) }
    }

    /// These settings without levels that the file `output` cannot hold.
    pub fn held_by(&self, output: &Path) -> Self {
        let plain = ParallaxFormat { encoding: Encoding::Unorm, depth: Depth::Bits8 };
        let holds = |mips: &bool| {
            let options = WriteOptions { mips: *mips, ..WriteOptions::default() };
            check_parallax_with(output, plain, &options).is_ok()
        };
        Self { mips: self.mips.filter(holds) }
    }

    /// How a map becomes a file, with the levels that were asked for.
    pub fn write(&self, file: WriteOptions) -> WriteOptions {
        WriteOptions { mips: self.mips.unwrap_or(false), ..file }
    }
}

impl Roughness {
    /// These settings, and those of `weaker` where these say nothing.
    pub fn or(self, weaker: &Self) -> Self {
        Self {
            roughness_method: self.roughness_method.or(weaker.roughness_method),
            base_roughness: self.base_roughness.or(weaker.base_roughness),
            roughness_bits: self.roughness_bits.or(weaker.roughness_bits),
        }
    }

    /// Fails if something is set and there is no roughness map.
    ///
    /// # Errors
    /// [`Error::Parameter`]
    pub fn check_effect(&self, has_roughness: bool) -> Result<()> {
        let set = [
            ("roughness-method", self.roughness_method.map(|method| method.to_string())),
            ("base-roughness", self.base_roughness.map(|base| base.to_string())),
            ("roughness-bits", self.roughness_bits.map(|bits| bits.to_string())),
        ];
        match set.into_iter().find_map(|(parameter, value)| Some((parameter, value?))) {
            Some((parameter, value)) if !has_roughness => {
                Err(Error::Parameter { parameter, value, range: "left out where there is no roughness map".into() })
            }
            _ => Ok(()),
        }
    }

    /// The roughness map that is asked for.
    pub fn options(&self) -> RoughnessOptions {
        let usual = RoughnessOptions::default();
        RoughnessOptions {
            method: self.roughness_method.unwrap_or(usual.method),
            base: self.base_roughness.unwrap_or(usual.base),
            format: RoughnessFormat { depth: self.roughness_bits.unwrap_or(usual.format.depth) },
        }
    }
}
