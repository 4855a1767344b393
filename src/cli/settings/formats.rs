//! What the codes of an output mean.

use crate::cli::values::choice;
use clap::Args;
use std::path::Path;
use texbake::io::{WriteOptions, check_normals_with, check_parallax_with, default_format, default_parallax_format};
use texbake::{Channels, Convention, Depth, Encoding, NormalFormat, ParallaxFormat, Result};

/// What was set of a normal map.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct NormalOutput {
    /// How a component becomes a code [default: unorm; float with float bits and in EXR files]
    #[arg(long, value_parser = choice::<Encoding>(Encoding::NAMES), help_heading = HEADING)]
    pub encoding: Option<Encoding>,

    /// Bits of a code; f is for float [default: 8 in PNG, KTX2 and DDS, 16 in TIFF, 32f in EXR files]
    #[arg(long, value_parser = choice::<Depth>(Depth::NAMES), help_heading = HEADING)]
    pub bits: Option<Depth>,

    /// Components; z can be rebuilt from xy [default: xyz]
    #[arg(long, value_parser = choice::<Channels>(Channels::NAMES), help_heading = HEADING)]
    pub channels: Option<Channels>,

    /// Green up (gl: glTF, Blender, Unity) or down (dx: DirectX, Unreal) [default: gl]
    #[arg(long, value_parser = choice::<Convention>(Convention::NAMES), help_heading = HEADING)]
    pub convention: Option<Convention>,
}

const HEADING: &str = "Normal map";

/// What was set of a map's codes, whichever map it is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CodeChoice {
    pub encoding: Option<Encoding>,
    pub bits: Option<Depth>,
}

impl NormalOutput {
    /// These settings, and those of `weaker` where these say nothing.
    pub fn or(self, weaker: &Self) -> Self {
        let CodeChoice { encoding, bits } = self.codes().or(weaker.codes());
        let channels = self.channels.or(weaker.channels);
        Self { encoding, bits, channels, convention: self.convention.or(weaker.convention) }
    }

    /// The format of the normal map `output`, which is written as `write` says.
    ///
    /// # Errors
    /// [`texbake::Error::Parameter`] if encoding and bits do not go together, or `output` cannot hold them; what its
    /// extension has to say.
    pub fn format(&self, output: &Path, write: &WriteOptions) -> Result<NormalFormat> {
        let (encoding, depth) = self.codes().resolve(default_format(output)?, Encoding::Unorm);
        let (channels, convention) = (self.channels.unwrap_or_default(), self.convention.unwrap_or_default());
        let format = NormalFormat { encoding, depth, channels, convention };
        check_normals_with(output, format, write).map(|()| format)
    }

    /// These settings without the encoding and bits that the file `output` cannot hold.
    pub fn held_by(&self, output: &Path) -> Self {
        let holds = |codes: CodeChoice| Self { encoding: codes.encoding, bits: codes.bits, ..Self::default() };
        let CodeChoice { encoding, bits } =
            self.codes().filter(|codes| holds(codes).format(output, &WriteOptions::default()).is_ok());
        Self { encoding, bits, ..self.clone() }
    }

    fn codes(&self) -> CodeChoice {
        CodeChoice { encoding: self.encoding, bits: self.bits }
    }
}

impl CodeChoice {
    /// This choice, and that of `weaker` where this says nothing; what does not go together replaces each other.
    pub fn or(self, weaker: Self) -> Self {
        let goes_with = |encoding: Encoding, bits: Depth| (encoding == Encoding::Float) == bits.is_float();
        let encoding = weaker.encoding.filter(|encoding| self.bits.is_none_or(|bits| goes_with(*encoding, bits)));
        let bits = weaker.bits.filter(|bits| self.encoding.is_none_or(|encoding| goes_with(encoding, *bits)));
        Self { encoding: self.encoding.or(encoding), bits: self.bits.or(bits) }
    }

    /// This choice without the encoding and bits that the parallax map file `output` cannot hold.
    pub fn held_by(self, output: &Path) -> Self {
        self.filter(|codes| codes.parallax(output, &WriteOptions::default()).is_ok())
    }

    /// Encoding and bits, each if it alone is possible.
    fn filter(self, possible: impl Fn(Self) -> bool) -> Self {
        Self {
            encoding: self.encoding.filter(|_| possible(Self { bits: None, ..self })),
            bits: self.bits.filter(|_| possible(Self { encoding: None, ..self })),
        }
    }

    /// The format of the parallax map `output`, which is written as `write` says.
    ///
    /// # Errors
    /// As [`NormalOutput::format`].
    pub fn parallax(self, output: &Path, write: &WriteOptions) -> Result<ParallaxFormat> {
        let usual = default_parallax_format(output)?;
        let (encoding, depth) = self.resolve((usual.encoding, usual.depth), Encoding::Snorm);
        let format = ParallaxFormat { encoding, depth };
        check_parallax_with(output, format, write).map(|()| format)
    }

    /// The file's `usual` encoding and bits where nothing else was set; float bits mean the encoding float, and integer
    /// bits in a file of floats the encoding `integer`.
    fn resolve(self, usual: (Encoding, Depth), integer: Encoding) -> (Encoding, Depth) {
        let integer = if usual.0 == Encoding::Float { integer } else { usual.0 };
        match (self.encoding, self.bits) {
            (Some(encoding), Some(bits)) => (encoding, bits),
            (Some(Encoding::Float), None) if !usual.1.is_float() => (Encoding::Float, Depth::Float32),
            (Some(encoding), None) if encoding != Encoding::Float && usual.1.is_float() => (encoding, Depth::Bits16),
            (Some(encoding), None) => (encoding, usual.1),
            (None, Some(bits)) if bits.is_float() => (Encoding::Float, bits),
            (None, Some(bits)) => (integer, bits),
            (None, None) => usual,
        }
    }
}
