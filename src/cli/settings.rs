//! How one file is baked: the options that the command line and `texbake.toml` share.
//!
//! A key of the settings file is an option of the command line without its dashes, and is read by the same code.

use super::values::{ByteSize, Extent, choice, value};
use clap::{Args, ValueEnum};
use std::path::Path;
use texbake::io::{Channel, ColorSpace, RawLayout, ReadOptions};
use texbake::{
    Baker, Channels, Convention, Depth, Edges, Encoding, Error, Filter, Grid, HeightMap, NormalFormat, NormalOptions,
    Precision, Rational, Result, Scale,
};

/// What was set; `None` leaves it to the next source, and at last to the default.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct Settings {
    /// Height of white (the code 255 or 65535, or the float 1) in widths of one texel: 24, 0.35, 7/3; negative for
    /// depth maps [default: 1,
    /// nearly flat; most tiling textures take 8 to 50]
    #[arg(long, value_name = "NUMBER", value_parser = value::<Rational>, allow_hyphen_values = true)]
    #[arg(help_heading = SLOPE, conflicts_with_all = ["size", "depth"])]
    pub scale: Option<Rational>,

    /// Width and height that the map covers, as 2.0x2.0; instead of --scale, with --depth
    #[arg(long, value_name = "WxH", value_parser = value::<Extent>, help_heading = SLOPE)]
    pub size: Option<Extent>,

    /// Height of white in the unit of --size: 65535 for 16-bit elevation in metres, 1 for floats in metres
    #[arg(long, value_name = "NUMBER", value_parser = value::<Rational>, allow_hyphen_values = true)]
    #[arg(help_heading = SLOPE)]
    pub depth: Option<Rational>,

    /// Slope stencil [default: central]
    #[arg(long, value_parser = choice::<Filter>(Filter::NAMES), help_heading = SLOPE)]
    pub filter: Option<Filter>,

    /// Beyond the borders: wrap, clamp or mirror; two for x and y: wrap,clamp [default: wrap]
    #[arg(long, value_name = "MODE", value_parser = value::<Edges>, help_heading = SLOPE)]
    pub edge: Option<Edges>,

    /// exact: the same bytes everywhere, correctly rounded; fast: native floats [default: exact]
    #[arg(long, value_parser = choice::<Precision>(Precision::NAMES), help_heading = SLOPE)]
    pub precision: Option<Precision>,

    /// How a component becomes a code [default: unorm; float with float bits and in EXR files]
    #[arg(long, value_parser = choice::<Encoding>(Encoding::NAMES), help_heading = OUTPUT)]
    pub encoding: Option<Encoding>,

    /// Bits of a code; f is for float [default: 8 in PNG, 16 in TIFF, 32f in EXR files]
    #[arg(long, value_parser = choice::<Depth>(Depth::NAMES), help_heading = OUTPUT)]
    pub bits: Option<Depth>,

    /// Components; z can be rebuilt from xy [default: xyz]
    #[arg(long, value_parser = choice::<Channels>(Channels::NAMES), help_heading = OUTPUT)]
    pub channels: Option<Channels>,

    /// Green up (gl: glTF, Blender, Unity) or down (dx: DirectX, Unreal) [default: gl]
    #[arg(long, value_parser = choice::<Convention>(Convention::NAMES), help_heading = OUTPUT)]
    pub convention: Option<Convention>,

    /// Channel that holds the heights: r, g, b, a, luma, or the name of an EXR channel; needed if they differ
    #[arg(long, value_name = "CHANNEL", help_heading = INPUT)]
    pub channel: Option<Channel>,

    /// srgb undoes a wrong conversion of the heights; data is not converted otherwise [default: linear]
    #[arg(long, value_name = "SPACE", value_parser = choice::<ColorSpace>(ColorSpace::NAMES), help_heading = INPUT)]
    pub color_space: Option<ColorSpace>,

    /// Layout of a file without header: 1025x1025:u16le; types u8, u16le, u16be, f32le, f32be
    #[arg(long, value_name = "WxH:TYPE", value_parser = value::<RawLayout>, help_heading = INPUT)]
    pub raw: Option<RawLayout>,

    /// Most memory that decoding one file may take: 512M, 4G [default: 4G]
    #[arg(long, value_name = "BYTES", value_parser = value::<ByteSize>, help_heading = INPUT)]
    pub max_bytes: Option<ByteSize>,

    /// auto: a real GPU, else the CPU; gpu: the best GPU, software too, or an error; reference: plain code on one
    /// thread [default: auto]
    #[arg(long, value_enum, help_heading = DEVICE)]
    pub backend: Option<Backend>,

    /// GPU whose description contains NAME, as in `texbake devices`; vulkan:NAME names the API too; implies gpu
    #[arg(long, value_name = "NAME", help_heading = DEVICE)]
    pub adapter: Option<String>,
}

const SLOPE: &str = "Heights to normals";
const OUTPUT: &str = "Normal map";
const INPUT: &str = "Height map";
const DEVICE: &str = "Where it runs";

/// What may be asked to bake.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Backend {
    Auto,
    Cpu,
    Gpu,
    Reference,
}

impl Settings {
    /// These settings, and those of `weaker` where these say nothing.
    ///
    /// What excludes each other counts as one: a scale here leaves no size from there.
    pub fn or(self, weaker: &Self) -> Self {
        let weaker = weaker.clone();
        let physical = self.size.is_some() || self.depth.is_some();
        let goes_with = |encoding: Encoding, bits: Depth| (encoding == Encoding::Float) == bits.is_float();
        let encoding = weaker.encoding.filter(|encoding| self.bits.is_none_or(|bits| goes_with(*encoding, bits)));
        let bits = weaker.bits.filter(|bits| self.encoding.is_none_or(|encoding| goes_with(encoding, *bits)));
        Self {
            size: self.size.or(weaker.size.filter(|_| self.scale.is_none())),
            depth: self.depth.or(weaker.depth.filter(|_| self.scale.is_none())),
            scale: self.scale.or(weaker.scale.filter(|_| !physical)),
            filter: self.filter.or(weaker.filter),
            edge: self.edge.or(weaker.edge),
            precision: self.precision.or(weaker.precision),
            encoding: self.encoding.or(encoding),
            bits: self.bits.or(bits),
            channels: self.channels.or(weaker.channels),
            convention: self.convention.or(weaker.convention),
            channel: self.channel.or(weaker.channel),
            color_space: self.color_space.or(weaker.color_space),
            raw: self.raw.or(weaker.raw),
            max_bytes: self.max_bytes.or(weaker.max_bytes),
            adapter: self.adapter.or(weaker.adapter.filter(|_| self.backend.is_none_or(|it| it == Backend::Gpu))),
            backend: self.backend.or(weaker.backend),
        }
    }

    /// How the input is read.
    pub fn read(&self) -> ReadOptions {
        let default = ReadOptions::default();
        ReadOptions {
            channel: self.channel.clone(),
            color_space: self.color_space.unwrap_or_default(),
            raw: self.raw,
            max_bytes: self.max_bytes.map_or(default.max_bytes, |ByteSize(bytes)| bytes),
        }
    }

    /// What is baked into the file `output`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options out of range or at odds; what the extension of `output` has to say.
    pub fn normal(&self, output: &Path) -> Result<NormalOptions> {
        let options = NormalOptions {
            scale: self.scale()?,
            filter: self.filter.unwrap_or_default(),
            edges: self.edge.unwrap_or_default(),
            format: self.format(output)?,
            precision: self.precision.unwrap_or_default(),
        };
        // A map of one texel shows what is wrong for every map before any file is opened.
        let texel = HeightMap::from(Grid::new(1, 1, vec![0u8])?);
        Baker::reference().normal(&texel, &options).map(|_| options)
    }

    fn scale(&self) -> Result<Scale> {
        match (self.scale, self.size, self.depth) {
            (Some(scale), ..) => Ok(Scale::texels(scale)),
            (None, None, None) => Ok(Scale::default()),
            (None, Some(Extent([width, height])), Some(depth)) => Ok(Scale::physical(width, height, depth)),
            (None, Some(_), None) => Err(wrong("depth", "missing", "given with --size, in the same unit")),
            (None, None, Some(_)) => Err(wrong("size", "missing", "given with --depth, in the same unit")),
        }
    }

    /// The file's usual format where nothing else was set; float bits mean the encoding float.
    fn format(&self, output: &Path) -> Result<NormalFormat> {
        let usual = texbake::io::default_format(output)?;
        let (encoding, depth) = match (self.encoding, self.bits) {
            (Some(encoding), Some(bits)) => (encoding, bits),
            (Some(Encoding::Float), None) if !usual.1.is_float() => (Encoding::Float, Depth::Float32),
            (Some(encoding), None) if encoding != Encoding::Float && usual.1.is_float() => (encoding, Depth::Bits16),
            (Some(encoding), None) => (encoding, usual.1),
            (None, Some(bits)) if bits.is_float() => (Encoding::Float, bits),
            (None, Some(bits)) => (Encoding::Unorm, bits),
            (None, None) => usual,
        };
        let channels = self.channels.unwrap_or_default();
        Ok(NormalFormat { encoding, depth, channels, convention: self.convention.unwrap_or_default() })
    }

    /// What shall bake, by which bakers are told apart.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an adapter of something else than a GPU.
    pub fn device(&self) -> Result<(Backend, Option<String>)> {
        match (self.backend, &self.adapter) {
            (None | Some(Backend::Gpu), Some(adapter)) => Ok((Backend::Gpu, Some(adapter.clone()))),
            (_, Some(adapter)) => Err(wrong("adapter", adapter, "left out, or used with --backend gpu")),
            (backend, None) => Ok((backend.unwrap_or(Backend::Auto), None)),
        }
    }
}

/// Opens what [`Settings::device`] says.
pub fn open_baker((backend, adapter): &(Backend, Option<String>)) -> Result<Baker> {
    match backend {
        Backend::Auto => Ok(Baker::auto()),
        Backend::Cpu => Ok(Baker::cpu()),
        Backend::Gpu => Baker::gpu(adapter.as_deref()),
        Backend::Reference => Ok(Baker::reference()),
    }
}

fn wrong(parameter: &'static str, value: &str, range: &str) -> Error {
    Error::Parameter { parameter, value: value.into(), range: range.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(change: impl FnOnce(&mut Settings)) -> Settings {
        let mut settings = Settings::default();
        change(&mut settings);
        settings
    }

    #[test]
    fn a_scale_takes_the_place_of_a_physical_size_and_back() {
        let texels = set(|s| s.scale = Some(24.into()));
        let physical = set(|s| (s.size, s.depth) = (Some(Extent([2.into(), 1.into()])), Some(3.into())));
        assert_eq!(texels.clone().or(&physical), texels);
        assert_eq!(physical.clone().or(&texels), physical);
        let deeper = set(|s| s.depth = Some(5.into()));
        let merged = deeper.or(&physical);
        assert_eq!(merged.scale().unwrap(), Scale::physical(2.into(), 1.into(), 5.into()));
    }

    #[test]
    fn bits_and_encodings_that_do_not_go_together_replace_each_other() {
        let weaker = set(|s| (s.encoding, s.bits) = (Some(Encoding::Snorm), Some(Depth::Bits8)));
        let floats = set(|s| s.bits = Some(Depth::Float16)).or(&weaker);
        assert_eq!((floats.encoding, floats.bits), (None, Some(Depth::Float16)));
        let finer = set(|s| s.bits = Some(Depth::Bits16)).or(&weaker);
        assert_eq!((finer.encoding, finer.bits), (Some(Encoding::Snorm), Some(Depth::Bits16)));
        let float = set(|s| s.encoding = Some(Encoding::Float)).or(&weaker);
        assert_eq!((float.encoding, float.bits), (Some(Encoding::Float), None));
    }

    #[test]
    fn a_backend_leaves_the_adapter_of_another() {
        let weaker = set(|s| s.adapter = Some("llvmpipe".into()));
        assert_eq!(set(|s| s.backend = Some(Backend::Cpu)).or(&weaker).device().unwrap(), (Backend::Cpu, None));
        let gpu = (Backend::Gpu, Some("llvmpipe".to_owned()));
        assert_eq!(Settings::default().or(&weaker).device().unwrap(), gpu);
        assert_eq!(set(|s| s.backend = Some(Backend::Gpu)).or(&weaker).device().unwrap(), gpu);
        assert!(set(|s| s.backend = Some(Backend::Cpu)).or(&Settings::default()).device().is_ok());
    }
}
