//! Whether what was baked is what was predicted.

use super::decision::{degrees, pixels};
use super::parallax::{Sides, material};
use super::prediction::{MapPrediction, NormalPrediction, Prediction};
use super::scene::Facts;
use super::subject::Reduced;
use crate::error::Result;
use crate::io::{NormalReadOptions, ParallaxReadOptions};
use crate::map::{
    Channels, CodeMap, Codes, CodesRef, Depth, HeightMap, MapFormat, Maps, NormalFormat, NormalMap, ParallaxFormat,
    ParallaxMap, Size,
};
use crate::material::{ParallaxMethod, Texture};
use crate::measure::digits;
use crate::ops::Precision;
use crate::stream::Monitor;
use std::path::{Path, PathBuf};

/// What was found of one height map's maps.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// What was measured beside what was predicted, in words.
    pub measured: Vec<String>,
    /// The predictions that do not hold, in words with the names of the files.
    pub broken: Vec<String>,
}

/// What an error may differ by from the predicted one: the directions to the eye are made with sine and cosine, which other
/// systems round another way, so that an offset differs by a few times 2^-24 of itself.
const MARGIN: f64 = 1e-6;

impl Prediction {
    /// Measures the `maps` of the height map `input` again, against what the scene says of it.
    ///
    /// # Errors
    /// What reading `input` reports; [`crate::Error::Cancelled`]. A map that cannot be read is a broken prediction.
    pub fn check(&self, input: &Path, maps: &Maps<PathBuf>, monitor: &Monitor) -> Result<Checked> {
        let facts = self.material.facts()?;
        let (heights, _) = HeightMap::read_with(input, &facts.read)?;
        let reduced = Reduced::read(input, &facts, &heights, self.shrink)?;
        let mut checking = Checking {
            prediction: self,
            heights: &heights,
            reduced,
            facts,
            monitor,
            measured: Vec::new(),
            broken: Vec::new(),
        };
        checking.tolerances();
        let normals = checking.normals(maps.normal.as_deref())?;
        checking.parallax(maps.parallax.as_deref(), normals)?;
        let Checking { measured, broken, .. } = checking;
        Ok(Checked { measured, broken })
    }

    /// The most that an error may be: the predicted one, and of a fast bake, whose bytes may be others elsewhere, what
    /// the scene allows.
    fn most(&self, predicted: f64, tolerance: f64) -> f64 {
        match self.precision {
            Precision::Exact => predicted * (1.0 + MARGIN),
            Precision::Fast => tolerance,
        }
    }
}

struct Checking<'a> {
    prediction: &'a Prediction,
    heights: &'a HeightMap,
    reduced: Reduced<'a>,
    facts: Facts,
    monitor: &'a Monitor,
    measured: Vec<String>,
    broken: Vec<String>,
}

/// How a file stores a map: the bits of a code, and the components of a normal.
type Stored = (Depth, Option<Channels>);

impl Checking<'_> {
    /// Checks that no prediction is beyond what the scene allows: no plan writes such a one.
    fn tolerances(&mut self) {
        let Prediction { file, normal, parallax, .. } = self.prediction;
        let predictions =
            [("degrees", normal.degrees, normal.tolerance), ("pixels", parallax.pixels, parallax.tolerance)];
        for (unit, predicted, tolerance) in predictions {
            let is_within = predicted <= tolerance;
            if !is_within {
                let [predicted, tolerance] = [predicted, tolerance].map(digits);
                let line = format!("{file}: {predicted} {unit} are predicted, and the scene allows {tolerance}");
                self.broken.push(line);
            }
        }
    }

    /// Checks the normal map, or that there is none, and returns what was read.
    fn normals(&mut self, path: Option<&Path>) -> Result<Option<NormalMap>> {
        let NormalPrediction { map, degrees: predicted, tolerance } = &self.prediction.normal;
        let most = self.prediction.most(*predicted, *tolerance);
        let Some((path, map)) = self.is_there("normal", path, map.as_ref()) else {
            if map.is_none() {
                let largest = self.reduced.visible.leanings().largest;
                let what = format!("{}: without a normal map, normals are off by", self.prediction.file);
                self.compare(&what, "at most", largest, most, [largest, *predicted].map(degrees));
            }
            return Ok(None);
        };
        let format = map.normals(self.facts.convention);
        let read = NormalReadOptions {
            encoding: Some(format.encoding),
            channels: Some(format.channels),
            convention: format.convention,
            ..NormalReadOptions::default()
        };
        let found = |(baked, _): (NormalMap, _)| found(path, &baked, format.depth).map(|found| (baked, found));
        let Some(baked) = self.as_planned(path, map, NormalMap::read_with(path, &read).and_then(found)) else {
            return Ok(None);
        };
        let largest = self.reduced.visible.errors(&Texture::of_normals(&baked, self.facts.edges)).largest;
        let what = format!("{}: normals are off by", path.display());
        self.compare(&what, "at most", largest, most, [largest, *predicted].map(degrees));
        Ok(Some(baked))
    }

    /// What was read, if it is the map that was predicted, of the reduced height map.
    fn as_planned<F: MapFormat>(
        &mut self,
        path: &Path,
        map: &MapPrediction,
        read: Result<(CodeMap<F>, Stored)>,
    ) -> Option<CodeMap<F>> {
        match read {
            Ok((baked, found)) => {
                let size = baked.size();
                let is_planned = self.is_as_predicted(path, map, size, found) && self.is_reduced(path, size);
                is_planned.then_some(baked)
            }
            Err(error) => {
                self.broken.push(error.to_string());
                None
            }
        }
    }

    /// Whether a map of this size is of the reduced height map.
    fn is_reduced(&mut self, path: &Path, size: Size) -> bool {
        let planned = self.reduced.heights.size();
        if size != planned {
            self.broken
                .push(format!("{}: it is {size}, and the plan reduces its height map to {planned}", path.display()));
        }
        size == planned
    }

    /// Checks the parallax map, or that there is none, and what the shader makes of it or of the height map.
    fn parallax(&mut self, path: Option<&Path>, normals: Option<NormalMap>) -> Result<()> {
        let predicted = &self.prediction.parallax;
        let baked = match (self.is_there("parallax", path, predicted.map.as_ref()), &predicted.map) {
            (Some((path, map)), _) => match self.parallax_map(path, map)? {
                Some(baked) => baked,
                None => return Ok(()),
            },
            (None, Some(_)) => return Ok(()),
            // No method that was planned reads it.
            (None, None) => ParallaxMap::new(Size::new(1, 1)?, ParallaxFormat::default(), Codes::U8(vec![0]))?,
        };
        let normals = match normals {
            Some(normals) => normals,
            // A method that looks at normals has had its map checked.
            None => NormalMap::new(Size::new(1, 1)?, NormalFormat::default(), Codes::U8(vec![128, 128, 255]))?,
        };
        let options = self.facts.bake();
        let material = material(self.heights, &normals, &baked, &options)?;
        let sides = Sides::new(self.heights, &options, &material, self.prediction.seen, self.monitor)?;
        let error = predicted.of.errors(sides.errors(&material, predicted.method, predicted.of, self.monitor)?);
        let name = path.filter(|_| predicted.map.is_some()).map(|path| path.display().to_string());
        let name = name.unwrap_or_else(|| self.prediction.file.clone());
        let what = match predicted.method {
            ParallaxMethod::None => format!("{name}: without parallax, offsets are"),
            method => format!("{name}: offsets by {method} are off by"),
        };
        let most = self.prediction.most(predicted.pixels, predicted.tolerance);
        self.compare(&what, predicted.of.words(), error, most, [error, predicted.pixels].map(pixels));
        Ok(())
    }

    /// Checks the parallax map texel by texel, and returns it if it is of the planned size.
    fn parallax_map(&mut self, path: &Path, map: &MapPrediction) -> Result<Option<ParallaxMap>> {
        let read = read_parallax(path, map.parallax()).map(|(baked, depth)| (baked, (depth, None)));
        let Some(baked) = self.as_planned(path, map, read) else { return Ok(None) };
        let (error, predicted) = (self.reduced.parallax_error(&baked)?, self.prediction.parallax.value.unwrap_or(0.0));
        let most = match self.prediction.precision {
            Precision::Exact => predicted * (1.0 + MARGIN),
            // A code more or less than the exact one, which is off by half of one.
            Precision::Fast => 3.0 * predicted,
        };
        let what = format!("{}: its values, from -1 to 1, are off by", path.display());
        self.compare(&what, "at most", error, most, [error, predicted].map(digits));
        Ok(Some(baked))
    }

    fn compare(&mut self, what: &str, words: &str, error: f64, most: f64, [measured, predicted]: [String; 2]) {
        let line = format!("{what} {measured} {words}, {predicted} predicted");
        if error <= most { self.measured.push(line) } else { self.broken.push(line) }
    }

    /// The map's path and prediction, if there is a map that was predicted.
    fn is_there<'p>(
        &mut self,
        kind: &str,
        path: Option<&'p Path>,
        map: Option<&'p MapPrediction>,
    ) -> Option<(&'p Path, &'p MapPrediction)> {
        match (path, map) {
            (Some(path), Some(map)) => return Some((path, map)),
            (Some(path), None) => {
                self.broken.push(format!("{}: no {kind} map was planned, and one is baked", path.display()));
            }
            (None, Some(_)) => {
                self.broken.push(format!("{}: a {kind} map was planned, and none is baked", self.prediction.file));
            }
            (None, None) => {}
        }
        None
    }

    /// Whether extension, size, depth and components are those that were predicted, and with them the bytes.
    fn is_as_predicted(&mut self, path: &Path, map: &MapPrediction, size: Size, (depth, channels): Stored) -> bool {
        let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        let count = channels.map_or(1, Channels::count);
        let bytes = size.texels() * count * depth.bytes();
        let is_same = extension == map.format
            && [size.width(), size.height()] == map.texels
            && depth == map.bits
            && channels == map.channels
            && bytes == map.bytes;
        let components = |channels: Option<Channels>| channels.map(|it| format!(" {it}")).unwrap_or_default();
        let line = format!(
            "{}: {extension} of {size}, {depth} bits{}, {} bytes; predicted {} of {} x {}, {} bits{}, {} bytes",
            path.display(),
            components(channels),
            digits(bytes as f64),
            map.format,
            map.texels[0],
            map.texels[1],
            map.bits,
            components(map.channels),
            digits(map.bytes as f64),
        );
        if is_same {
            self.measured.push(line)
        } else {
            self.broken.push(line)
        }
        is_same
    }
}

/// The depth and components of a normal map file: a PNG of x and y has three channels, the third of zeros.
fn found(path: &Path, read: &NormalMap, predicted: Depth) -> Result<Stored> {
    let (depth, mut channels) = (stored_depth(read.codes(), predicted), read.format().channels);
    if path.extension().is_some_and(|extension| extension == "png") && channels == Channels::Xy {
        let whole = NormalReadOptions { encoding: Some(read.format().encoding), ..NormalReadOptions::default() };
        let (whole, _) = NormalMap::read_with(path, &whole)?;
        let is_zero = |i: usize| match whole.codes() {
            CodesRef::U8(codes) => codes[i] == 0,
            CodesRef::U16(codes) => codes[i] == 0,
            _ => false,
        };
        if !(0..whole.size().texels()).all(|texel| is_zero(3 * texel + 2)) {
            channels = Channels::Xyz;
        }
    }
    Ok((depth, Some(channels)))
}

/// How codes are stored: half floats are read as floats.
fn stored_depth(codes: CodesRef<'_>, predicted: Depth) -> Depth {
    let is_half = |code: &f32| half::f16::from_f32(*code).to_f32() == *code;
    match codes {
        CodesRef::F32(codes) if predicted == Depth::Float16 && codes.iter().all(is_half) => predicted,
        codes => codes.depth(),
    }
}

/// Reads a parallax map of this format, and tells how its codes are stored.
fn read_parallax(path: &Path, format: ParallaxFormat) -> Result<(ParallaxMap, Depth)> {
    let read = ParallaxReadOptions { encoding: Some(format.encoding), ..ParallaxReadOptions::default() };
    let (map, _) = ParallaxMap::read_with(path, &read)?;
    let depth = stored_depth(map.codes(), format.depth);
    Ok((map, depth))
}
