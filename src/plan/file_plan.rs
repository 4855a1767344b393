//! A plan: what is chosen for each height map of a scene, and what is said of it.

use super::choose::{Chosen, choose};
use super::decision::{Decision, degrees, pixels, sides, wrapped};
use super::prediction::{ErrorOf, MapPrediction, MaterialFacts, NormalPrediction, ParallaxPrediction, Prediction};
use super::scene::{Scene, SceneMaterial};
use super::subject::Subject;
use super::unmet::Unmet;
use crate::baker::Baker;
use crate::error::Result;
use crate::map::{Channels, HeightType, Size, TexelFormat};
use crate::stream::Monitor;
use std::path::{Path, PathBuf};

/// What a scene needs of its height maps.
#[derive(Debug)]
pub struct Plan {
    /// The scene file.
    pub scene: PathBuf,
    /// The folder that `bake` is to be given.
    pub folder: PathBuf,
    /// What the names of height maps end in, if the scene says so.
    pub suffixes: Option<Vec<String>>,
    /// The height maps that the scene shows.
    pub files: Vec<FilePlan>,
    /// Those that it does not show, below the folder.
    pub left_out: Vec<PathBuf>,
}

/// What was chosen for a height map, why, and what it comes to.
#[derive(Debug)]
pub struct FilePlan {
    /// The height map below the folder.
    pub file: PathBuf,
    /// Its columns and rows.
    pub size: Size,
    /// How its heights are stored.
    pub height_type: HeightType,
    /// Every choice.
    pub decisions: Vec<Decision>,
    /// The settings of `bake`: names of options and their values.
    pub settings: Vec<(&'static str, String)>,
    /// What `bake --check-plan` will hold it to.
    pub prediction: Prediction,
}

impl Plan {
    /// Measures what the scene's height maps could be baked into, and chooses the cheapest maps that keep within its
    /// tolerances. `watch` is told each file before it is looked at.
    ///
    /// # Errors
    /// [`crate::Error::File`] for the tolerances that cannot be met, with the best that can; what reading reports;
    /// [`crate::Error::Cancelled`] when `monitor` says so.
    pub fn new(scene: &Scene, baker: &Baker, monitor: &Monitor, watch: &mut dyn FnMut(&Path)) -> Result<Self> {
        let (mut files, mut left_out, mut unmet) = (Vec::new(), Vec::new(), Vec::new());
        for (map, material) in scene.files()? {
            monitor.check()?;
            let Some(material) = material else {
                left_out.push(map.relative());
                continue;
            };
            watch(&map.path);
            let subject = Subject::read(&map.path, material, baker, monitor)?;
            match choose(&subject)? {
                Ok(chosen) => files.push(FilePlan::new(map.relative(), &subject, chosen)),
                Err(none) => unmet.push((map.relative(), none)),
            }
        }
        if !unmet.is_empty() {
            return Err(Unmet::error(&scene.path, unmet));
        }
        let (path, folder, suffixes) = (scene.path.clone(), scene.folder.clone(), scene.suffixes.clone());
        Ok(Self { scene: path, folder, suffixes, files, left_out })
    }
}

impl FilePlan {
    fn new(file: PathBuf, subject: &Subject<'_>, chosen: Chosen) -> Self {
        let settings = settings(subject.material, &chosen);
        let prediction = prediction(&file, subject, &chosen);
        let (size, height_type) = (subject.heights.size(), subject.heights.height_type());
        Self { file, size, height_type, decisions: chosen.decisions, settings, prediction }
    }

    /// What is chosen for the file, and why, in lines.
    pub fn explanation(&self) -> String {
        let Prediction { seen, normal, parallax, .. } = &self.prediction;
        let header = format!(
            "{}: {}, {}; a texel covers {} at the nearest view, {} is the shallowest; normals may be off by {}, offsets \
             by {}{}",
            self.file.display(),
            self.size,
            self.height_type,
            sides(seen.pixels_per_texel),
            degrees(seen.angle),
            degrees(normal.tolerance),
            pixels(parallax.tolerance),
            if parallax.of == ErrorOf::Most { " in 99 of 100" } else { "" },
        );
        let mut text = wrapped(&header, ["", "    "]);
        for Decision { topic, choice, reason, times, rejected } in &self.decisions {
            let times = times.iter().map(|times| format!("; {times}")).collect::<String>();
            text += &format!("  {topic}: {choice}\n{}", wrapped(&(reason.clone() + &times), ["      "; 2]));
            for rejected in rejected {
                text += &wrapped(&format!("not {}: {}", rejected.what, rejected.why), ["      ", "        "]);
            }
        }
        text
    }
}

/// What `bake` is told of the file: all of it, so that no other override's value is left.
fn settings(material: &SceneMaterial, chosen: &Chosen) -> Vec<(&'static str, String)> {
    let facts = MaterialFacts::new(&material.facts);
    let mut settings = vec![("maps", chosen.maps().to_owned())];
    if chosen.maps() == "none" {
        return settings;
    }
    settings.extend(facts.settings());
    settings.extend([
        ("shrink", chosen.shrink.to_string()),
        ("precision", chosen.precision.to_string()),
        ("format", material.format.clone()),
    ]);
    if let Some(format) = chosen.normals.format {
        settings.extend([
            ("encoding", format.encoding.to_string()),
            ("bits", format.depth.to_string()),
            ("channels", format.channels.to_string()),
        ]);
    }
    if let Some(format) = chosen.parallax.format() {
        let (encoding, bits) = (format.encoding.to_string(), format.depth.to_string());
        settings.extend([("parallax-encoding", encoding), ("parallax-bits", bits)]);
    }
    settings
}

fn prediction(file: &Path, subject: &Subject<'_>, chosen: &Chosen) -> Prediction {
    let Chosen { shrink, normals, parallax, precision, tangent_space, .. } = chosen;
    let tolerance = subject.tolerance();
    let (size, by) = (subject.heights.size(), *shrink as usize);
    let texels = [size.width() / by, size.height() / by];
    let map = |TexelFormat { encoding, depth, .. }, channels: Option<Channels>| {
        let bytes = texels[0] * texels[1] * channels.map_or(1, Channels::count) * depth.bytes();
        MapPrediction { format: subject.material.format.clone(), texels, encoding, bits: depth, channels, bytes }
    };
    Prediction {
        file: slashed(file),
        shrink: *shrink,
        precision: *precision,
        tangent_space: *tangent_space,
        material: MaterialFacts::new(subject.facts()),
        seen: subject.seen,
        normal: NormalPrediction {
            map: normals.format.map(|format| map(format.texel(), Some(format.channels))),
            degrees: normals.error,
            tolerance: tolerance.normal,
        },
        parallax: ParallaxPrediction {
            map: parallax.format().map(|format| map(format.texel(), None)),
            value: parallax.map.map(|map| map.error),
            method: parallax.method,
            pixels: parallax.error,
            of: tolerance.parallax_of,
            tolerance: tolerance.parallax,
            milliseconds: parallax.milliseconds,
        },
    }
}

/// A path as it is written in settings, whatever the system writes.
pub(super) fn slashed(path: &Path) -> String {
    path.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/")
}
