//! Which channels of an EXR hold a map, by their names.

use crate::error::{Error, Result};
use crate::io::channel::Channel;
use crate::map::Channels;
use exr::meta::header::Header;
use std::collections::BTreeMap;
use std::path::Path;

/// What is looked for in a file.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Wanted<'a> {
    /// One channel, or red, green and blue.
    Heights(Option<&'a Channel>),
    /// x, y and z, or x and y; `None`: all three if they are there.
    Normals(Option<Channels>),
}

/// Names that say "height", in lower case.
const HEIGHT_NAMES: [&str; 8] = ["y", "z", "height", "h", "displacement", "disp", "depth", "bump"];

/// Names of components; beside X, Y and Z, colours are those of a picture.
const XYZ: [&[&str]; 2] = [&["x", "y", "z"], &["r", "g", "b"]];
const XY: [&[&str]; 2] = [&["x", "y"], &["r", "g"]];

/// The first layer, and the channels in it, that hold what is wanted.
pub(super) fn choose(path: &Path, layers: &[Header], wanted: Wanted<'_>) -> Result<(usize, Vec<usize>)> {
    for (index, layer) in layers.iter().enumerate() {
        let names: Vec<String> = layer.channels.list.iter().map(|channel| channel.name.to_string()).collect();
        let chosen = match wanted {
            Wanted::Heights(channel) => heights_in_layer(&names, channel),
            Wanted::Normals(channels) => normals_in_layer(&names, channels),
        };
        if let Some(channels) = chosen {
            return Ok((index, channels));
        }
    }
    let names: Vec<String> =
        layers.iter().flat_map(|layer| &layer.channels.list).map(|channel| channel.name.to_string()).collect();
    let names = names.join(", ");
    let by_name = ("choose one by its name with", "channel", "NAME");
    let (reason, remedy) = match wanted {
        Wanted::Heights(None) => {
            let reason = format!("it is not clear which of its channels is meant: {names}");
            return Err(Error::unclear(path, reason, by_name));
        }
        Wanted::Heights(Some(channel)) => {
            return Err(Error::unclear(path, format!("it has no channel {channel}, only {names}"), by_name));
        }
        Wanted::Normals(Some(Channels::Xy)) => (
            format!("it is not clear which of its channels hold x and y: {names}"),
            "name them R and G or X and Y, once in the file",
        ),
        Wanted::Normals(_) => (
            format!("it is not clear which of its channels hold the normals: {names}"),
            "name them R, G and B or X, Y and Z, once in the file",
        ),
    };
    Err(Error::file(path, reason, remedy))
}

/// The channels that hold the normals, in the order of their components, if the names are clear.
fn normals_in_layer(names: &[String], channels: Option<Channels>) -> Option<Vec<usize>> {
    let sets = match channels {
        None => [XYZ, XY].concat(),
        Some(Channels::Xyz) => XYZ.to_vec(),
        Some(Channels::Xy) => XY.to_vec(),
    };
    // The first set that there is decides, even if it is there twice: what is left then is not the normals.
    let found = sets.iter().map(|set| sets_in_layer(names, set)).find(|found| !found.is_empty())?;
    let (prefix, indices) = found.first()?;
    (prefix.is_empty() || found.len() == 1).then(|| indices.clone())
}

/// Each prefix ("normal" in "normal.X") with all channels of `set` below it, those without a prefix first.
fn sets_in_layer<'a>(names: &'a [String], set: &[&str]) -> Vec<(&'a str, Vec<usize>)> {
    let mut found = BTreeMap::new();
    for (index, name) in names.iter().enumerate() {
        let (prefix, last) = name.rsplit_once('.').unwrap_or(("", name));
        if let Some(place) = set.iter().position(|part| last.eq_ignore_ascii_case(part)) {
            found.entry(prefix).or_insert_with(|| vec![None; set.len()])[place].get_or_insert(index);
        }
    }
    let whole = |(prefix, places): (_, Vec<Option<usize>>)| Some((prefix, places.into_iter().collect::<Option<_>>()?));
    found.into_iter().filter_map(whole).collect()
}

/// The channels that hold the heights, if the names are clear.
fn heights_in_layer(names: &[String], channel: Option<&Channel>) -> Option<Vec<usize>> {
    let named = |name: &str| names.iter().position(|candidate| candidate == name);
    let is_alpha = |name: &str| name == "A" || name.ends_with(".A");
    let colours: Vec<usize> = (0..names.len()).filter(|index| !is_alpha(&names[*index])).collect();
    let rgb = || Some(vec![named("R")?, named("G")?, named("B")?]);
    let only = || (colours.len() == 1).then(|| colours.clone());
    let one = |name: &str| named(name).map(|index| vec![index]);
    match channel {
        Some(Channel::Named(name)) => one(name),
        Some(Channel::A) => one("A"),
        Some(Channel::R) => one("R").or_else(only),
        Some(Channel::G) => one("G").or_else(only),
        Some(Channel::B) => one("B").or_else(only),
        Some(Channel::Luma) => rgb().or_else(only),
        None => only().or_else(|| rgb().filter(|_| colours.len() == 3)).or_else(|| {
            let last_part = |name: &str| name.rsplit('.').next().unwrap_or(name).to_ascii_lowercase();
            let says_height = |index: &&usize| HEIGHT_NAMES.contains(&last_part(&names[**index]).as_str());
            let heights: Vec<usize> = colours.iter().filter(says_height).copied().collect();
            // Beside colours, Z and Y are not the heights of a texture but the depths of a picture.
            (heights.len() == 1 && rgb().is_none()).then_some(heights)
        }),
    }
}
