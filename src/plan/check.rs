//! Whether what was baked is what was predicted.

use super::decision::{degrees, pixels, short};
use super::method::method;
use super::parallax::{largest_offset, material, views};
use super::prediction::{MapPrediction, NormalPrediction, Prediction};
use super::scene::Facts;
use super::visible::VisibleNormals;
use crate::error::{Error, Result};
use crate::io::{NormalReadOptions, ReadOptions};
use crate::map::{
    Channels, CodeMap, Codes, CodesRef, Depth, Encoding, HeightMap, Heights, Maps, NormalFormat, NormalMap,
    ParallaxFormat, ParallaxMap, Size,
};
use crate::material::{ParallaxMethod, Texture};
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

/// What a number may differ by from the predicted one: sine and cosine are not the same to the last bit everywhere.
const MARGIN: f64 = 1e-3;

impl Prediction {
    /// Measures the `maps` of the height map `input` again, against what the scene says of it.
    ///
    /// # Errors
    /// What reading `input` reports. A map that cannot be read is a broken prediction.
    pub fn check(&self, input: &Path, maps: &Maps<PathBuf>) -> Result<Checked> {
        let facts = self.material.facts()?;
        let (heights, _) = HeightMap::read_with(input, &facts.read)?;
        let mut checking =
            Checking { facts, heights: &heights, prediction: self, measured: Vec::new(), broken: Vec::new() };
        let normals = checking.normals(maps.normal.as_deref())?;
        checking.parallax(maps.parallax.as_deref(), normals)?;
        let Checking { measured, broken, .. } = checking;
        Ok(Checked { measured, broken })
    }

    /// The most that an error may be: the predicted one, and of a fast bake, whose bytes may be others elsewhere, what
    /// the scene allows.
    fn most(&self, predicted: f64, tolerance: f64) -> f64 {
        let most = if self.precision == "fast" { tolerance } else { predicted };
        most * (1.0 + MARGIN)
    }
}

struct Checking<'a> {
    facts: Facts,
    heights: &'a HeightMap,
    prediction: &'a Prediction,
    measured: Vec<String>,
    broken: Vec<String>,
}

impl Checking<'_> {
    /// Checks the normal map, or that there is none, and returns what was read.
    fn normals(&mut self, path: Option<&Path>) -> Result<Option<NormalMap>> {
        let NormalPrediction { map, degrees: predicted, tolerance } = &self.prediction.normal;
        let most = self.prediction.most(*predicted, *tolerance);
        let visible = VisibleNormals::new(self.heights, &self.facts.bake(), self.prediction.shrink)?;
        let Some((path, map)) = self.is_there("normal", path, map.as_ref()) else {
            if map.is_none() {
                let largest = visible.leanings().largest;
                let what = format!("{}: without a normal map, normals are off by", self.prediction.file);
                self.compare(&what, "at most", largest, most, [largest, *predicted].map(degrees));
            }
            return Ok(None);
        };
        let format = map.normals(self.facts.convention)?;
        let read = NormalReadOptions {
            encoding: Some(format.encoding),
            channels: Some(format.channels),
            convention: format.convention,
            ..NormalReadOptions::default()
        };
        let found = |(baked, _): (NormalMap, _)| Ok((found(path, &baked, format.depth)?, baked));
        let baked = match NormalMap::read_with(path, &read).and_then(found) {
            Ok((found, baked)) if self.is_as_predicted(path, map, baked.size(), found) => baked,
            Ok(_) => return Ok(None),
            Err(error) => {
                self.broken.push(error.to_string());
                return Ok(None);
            }
        };
        if visible.size() != baked.size() {
            let line =
                format!("{}: it is {}, and the plan reduces it to {}", path.display(), baked.size(), visible.size());
            self.broken.push(line);
            return Ok(None);
        }
        let largest = visible.errors(&Texture::of_normals(&baked, self.facts.edges)).largest;
        let what = format!("{}: normals are off by", path.display());
        self.compare(&what, "at most", largest, most, [largest, *predicted].map(degrees));
        Ok(Some(baked))
    }

    /// Checks the parallax map, or that there is none, and what the shader makes of it or of the height map.
    fn parallax(&mut self, path: Option<&Path>, normals: Option<NormalMap>) -> Result<()> {
        let predicted = &self.prediction.parallax;
        let there = self.is_there("parallax", path, predicted.map.as_ref());
        let method = method(&predicted.method)?;
        let baked = match (there, &predicted.map) {
            (Some((path, map)), _) => match read_parallax(path, map.parallax()?) {
                Ok((baked, depth)) if self.is_as_predicted(path, map, baked.size(), (depth, None)) => baked,
                Ok(_) => return Ok(()),
                Err(error) => {
                    self.broken.push(error.to_string());
                    return Ok(());
                }
            },
            (None, Some(_)) => return Ok(()),
            (None, None) => ParallaxMap::new(Size::new(1, 1)?, ParallaxFormat::default(), Codes::U8(vec![0]))?,
        };
        let name = path.filter(|_| predicted.map.is_some()).map(|path| path.display().to_string());
        let name = name.unwrap_or_else(|| self.prediction.file.clone());
        let (seen, options) = (self.prediction.seen, self.facts.bake());
        let most = self.prediction.most(predicted.pixels, predicted.tolerance);
        if method == ParallaxMethod::None {
            let largest = largest_offset(self.heights, &options, seen)?;
            let numbers = [largest, predicted.pixels].map(pixels);
            self.compare(&format!("{name}: without parallax, offsets are"), "at most", largest, most, numbers);
            return Ok(());
        }
        let normals = match normals {
            Some(normals) => normals,
            // A method that looks at normals has had its map checked.
            None => NormalMap::new(Size::new(1, 1)?, NormalFormat::default(), Codes::U8(vec![128, 128, 255]))?,
        };
        let material = material(self.heights, &normals, &baked, &options)?;
        let monitor = Monitor::default();
        let (views, truth) = views(&material, seen.angle, &monitor)?;
        let errors = views.errors(&material, method, &truth, material.texels(), &monitor)?;
        let error = predicted.of.errors(errors) * seen.pixels_per_texel;
        let what = format!("{name}: offsets by {} are off by", predicted.method);
        self.compare(&what, predicted.of.words(), error, most, [error, predicted.pixels].map(pixels));
        Ok(())
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
    fn is_as_predicted(
        &mut self,
        path: &Path,
        map: &MapPrediction,
        size: Size,
        (depth, channels): (Depth, Option<Channels>),
    ) -> bool {
        let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        let count = channels.map_or(1, Channels::count);
        let bytes = size.texels() * count * depth.bytes();
        let is_same = extension == map.format
            && [size.width(), size.height()] == map.texels
            && depth.to_string() == map.bits
            && channels.map(|channels| channels.to_string()) == map.channels
            && bytes == map.bytes;
        let components = |channels: Option<String>| channels.map(|it| format!(" {it}")).unwrap_or_default();
        let line = format!(
            "{}: {extension} of {size}, {depth} bits{}, {} bytes; predicted {} of {} x {}, {} bits{}, {} bytes",
            path.display(),
            components(channels.map(|it| it.to_string())),
            short(bytes as f64),
            map.format,
            map.texels[0],
            map.texels[1],
            map.bits,
            components(map.channels.clone()),
            short(map.bytes as f64),
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
fn found(path: &Path, read: &NormalMap, predicted: Depth) -> Result<(Depth, Option<Channels>)> {
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
    let (map, _) = HeightMap::read_with(path, &ReadOptions::default())?;
    // A signed file is read as v + 2^(b-1).
    let is_signed = format.encoding == Encoding::Snorm;
    let codes = match map.heights() {
        Heights::U8(codes) => Codes::U8(codes.iter().map(|code| if is_signed { code ^ 0x80 } else { *code }).collect()),
        Heights::U16(codes) => {
            Codes::U16(codes.iter().map(|code| if is_signed { code ^ 0x8000 } else { *code }).collect())
        }
        Heights::F32(codes) => Codes::F32(codes.to_vec()),
    };
    let depth = stored_depth(codes.as_ref(), format.depth);
    let stored = ParallaxFormat { depth: codes.as_ref().depth(), ..format };
    let map = CodeMap::new(map.size(), stored, codes).map_err(|error| {
        Error::file(path, format!("it holds no {} {} codes: {error}", format.encoding, format.depth), "bake it again")
    })?;
    Ok((map, depth))
}
