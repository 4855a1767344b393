//! How heights become slopes.

use crate::cli::values::{Extent, choice, value};
use clap::Args;
use texbake::{Edges, Error, Filter, Precision, Rational, Result, Scale};

/// What was set of the slopes, and how they are computed.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct Slope {
    /// Height of white (the code 255 or 65535, or the float 1) in widths of one texel: 24, 0.35, 7/3; negative for
    /// depth maps [default: 1, nearly flat; most tiling textures take 8 to 50]
    #[arg(long, value_name = "NUMBER", value_parser = value::<Rational>, allow_hyphen_values = true)]
    #[arg(help_heading = HEADING, conflicts_with_all = ["size", "depth"])]
    pub scale: Option<Rational>,

    /// Width and height that the map covers, as 2.0x2.0; instead of --scale, with --depth
    #[arg(long, value_name = "WxH", value_parser = value::<Extent>, help_heading = HEADING)]
    pub size: Option<Extent>,

    /// Height of white in the unit of --size: 65535 for 16-bit elevation in metres, 1 for floats in metres
    #[arg(long, value_name = "NUMBER", value_parser = value::<Rational>, allow_hyphen_values = true)]
    #[arg(help_heading = HEADING)]
    pub depth: Option<Rational>,

    /// Slope stencil [default: central]
    #[arg(long, value_parser = choice::<Filter>(Filter::NAMES), help_heading = HEADING)]
    pub filter: Option<Filter>,

    /// Beyond the borders: wrap, clamp or mirror; two for x and y: wrap,clamp [default: wrap]
    #[arg(long, value_name = "MODE", value_parser = value::<Edges>, help_heading = HEADING)]
    pub edge: Option<Edges>,

    /// exact: the same bytes everywhere, and correctly rounded for 8- and 16-bit maps; floats are computed as IEEE f32 in
    /// a fixed order. fast: native floats [default: exact]
    #[arg(long, value_parser = choice::<Precision>(Precision::NAMES), help_heading = HEADING)]
    pub precision: Option<Precision>,
}

const HEADING: &str = "Heights to normals";

impl Slope {
    /// These settings, and those of `weaker` where these say nothing; a scale here leaves no size from there.
    pub fn or(self, weaker: &Self) -> Self {
        let physical = self.size.is_some() || self.depth.is_some();
        Self {
            size: self.size.or(weaker.size.filter(|_| self.scale.is_none())),
            depth: self.depth.or(weaker.depth.filter(|_| self.scale.is_none())),
            scale: self.scale.or(weaker.scale.filter(|_| !physical)),
            filter: self.filter.or(weaker.filter),
            edge: self.edge.or(weaker.edge),
            precision: self.precision.or(weaker.precision),
        }
    }

    /// How high h = 1 is.
    ///
    /// # Errors
    /// [`Error::Parameter`] for half a physical scale.
    pub fn scale(&self) -> Result<Scale> {
        let missing =
            |parameter, range: &str| Err(Error::Parameter { parameter, value: "missing".into(), range: range.into() });
        match (self.scale, self.size, self.depth) {
            (Some(scale), ..) => Ok(Scale::texels(scale)),
            (None, None, None) => Ok(Scale::default()),
            (None, Some(Extent([width, height])), Some(depth)) => Ok(Scale::physical(width, height, depth)),
            (None, Some(_), None) => missing("depth", "given with --size, in the same unit"),
            (None, None, Some(_)) => missing("size", "given with --depth, in the same unit"),
        }
    }
}
