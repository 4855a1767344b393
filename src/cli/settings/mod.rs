//! How one file is baked: the options that commands and `texbake.toml` share.
//!
//! A key of the settings file is an option of the command line without its dashes, and is read by the same code.

mod device;
mod file;
mod formats;
mod input;
mod mips;
mod slope;
mod tiles;

pub use device::{Backend, Device, Place, open_baker};
pub use file::FileOutput;
pub use formats::{CodeChoice, NormalOutput};
pub use input::{HeightInput, max_bytes};
pub use mips::{Mips, Roughness};
pub use slope::Slope;
pub use tiles::Tiles;

use clap::Args;
use texbake::{BakeOptions, Baker, Grid, HeightMap, NormalFormat, ParallaxFormat, Result, RoughnessOptions};

/// What was set; `None` leaves it to the next source, and at last to the default.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct Settings {
    #[command(flatten)]
    pub slope: Slope,

    #[command(flatten)]
    pub normal: NormalOutput,

    #[command(flatten)]
    pub file: FileOutput,

    #[command(flatten)]
    pub mips: Mips,

    #[command(flatten)]
    pub roughness: Roughness,

    #[command(flatten)]
    pub input: HeightInput,

    #[command(flatten)]
    pub tiles: Tiles,

    #[command(flatten)]
    pub device: Device,
}

impl Settings {
    /// These settings, and those of `weaker` where these say nothing.
    ///
    /// What excludes each other counts as one: a scale here leaves no size from there.
    pub fn or(self, weaker: &Self) -> Self {
        Self {
            slope: self.slope.or(&weaker.slope),
            normal: self.normal.or(&weaker.normal),
            file: self.file.or(&weaker.file),
            mips: self.mips.or(&weaker.mips),
            roughness: self.roughness.or(&weaker.roughness),
            input: self.input.or(weaker.input.clone()),
            tiles: self.tiles.or(&weaker.tiles),
            device: self.device.or(weaker.device.clone()),
        }
    }
}

impl Slope {
    /// A bake into maps of these formats.
    ///
    /// # Errors
    /// [`texbake::Error::Parameter`] for options out of range or at odds.
    pub fn bake(
        &self,
        normal: Option<NormalFormat>,
        parallax: Option<ParallaxFormat>,
        roughness: Option<RoughnessOptions>,
    ) -> Result<BakeOptions> {
        let options = BakeOptions {
            scale: self.scale()?,
            filter: self.filter.unwrap_or_default(),
            edges: self.edge.unwrap_or_default(),
            normal,
            parallax,
            roughness,
            precision: self.precision.unwrap_or_default(),
        };
        // A map of one texel shows what is wrong for every map before any file is opened.
        let texel = HeightMap::from(Grid::new(1, 1, vec![0u8])?);
        Baker::reference().bake(&texel, &options).map(|_| options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::values::Extent;
    use texbake::{Depth, Encoding, Scale};

    fn set(change: impl FnOnce(&mut Settings)) -> Settings {
        let mut settings = Settings::default();
        change(&mut settings);
        settings
    }

    #[test]
    fn a_scale_takes_the_place_of_a_physical_size_and_back() {
        let texels = set(|s| s.slope.scale = Some(24.into()));
        let physical = set(|s| (s.slope.size, s.slope.depth) = (Some(Extent([2.into(), 1.into()])), Some(3.into())));
        assert_eq!(texels.clone().or(&physical), texels);
        assert_eq!(physical.clone().or(&texels), physical);
        let deeper = set(|s| s.slope.depth = Some(5.into()));
        let merged = deeper.or(&physical);
        assert_eq!(merged.slope.scale().unwrap(), Scale::physical(2.into(), 1.into(), 5.into()));
    }

    #[test]
    fn bits_and_encodings_that_do_not_go_together_replace_each_other() {
        let weaker = set(|s| (s.normal.encoding, s.normal.bits) = (Some(Encoding::Snorm), Some(Depth::Bits8)));
        let floats = set(|s| s.normal.bits = Some(Depth::Float16)).or(&weaker);
        assert_eq!((floats.normal.encoding, floats.normal.bits), (None, Some(Depth::Float16)));
        let finer = set(|s| s.normal.bits = Some(Depth::Bits16)).or(&weaker);
        assert_eq!((finer.normal.encoding, finer.normal.bits), (Some(Encoding::Snorm), Some(Depth::Bits16)));
        let float = set(|s| s.normal.encoding = Some(Encoding::Float)).or(&weaker);
        assert_eq!((float.normal.encoding, float.normal.bits), (Some(Encoding::Float), None));
    }

    #[test]
    fn a_backend_leaves_the_adapter_of_another() {
        let weaker = set(|s| s.device.adapter = Some("llvmpipe".into()));
        assert_eq!(
            set(|s| s.device.backend = Some(Backend::Cpu)).or(&weaker).device.place().unwrap(),
            (Backend::Cpu, None)
        );
        let gpu = (Backend::Gpu, Some("llvmpipe".to_owned()));
        assert_eq!(Settings::default().or(&weaker).device.place().unwrap(), gpu);
        assert_eq!(set(|s| s.device.backend = Some(Backend::Gpu)).or(&weaker).device.place().unwrap(), gpu);
        assert!(set(|s| s.device.backend = Some(Backend::Cpu)).or(&Settings::default()).device.place().is_ok());
    }
}
