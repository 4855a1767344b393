//! The options on which the bytes of a job's outputs depend.

use crate::baker::Ran;
use crate::batch::{Job, MapKind, Neighbours};
use crate::io::{NormalReadOptions, ReadOptions, WriteOptions, is_compressed};
use crate::map::{NormalFormat, ParallaxFormat, RoughnessFormat};
use crate::mips::RoughnessOptions;
use crate::ops::Precision;
use crate::ops::bake::BakeOptions;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Display;

/// Options by their names on the command line, with their values in its words: those of the report decide over nothing.
/// What belongs to a map or a file that the job does not have is not there.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct Key(pub BTreeMap<String, String>);

/// An option that is not given.
pub(super) const NONE: &str = "none";

impl Key {
    /// The options of `job`, which ran, or will run. Structs of options are taken apart by all their fields, so that a new
    /// option does not compile before somebody decides here whether it changes bytes.
    pub fn of(job: &Job, ran: Option<&Ran>) -> Self {
        // Which files there are stands beside the key.
        let Job { input: _, outputs, normals, neighbours, read, options, write, baker } = job;
        let BakeOptions { scale, filter, edges, normal, parallax, roughness, precision } = options;
        let mut key = Self::default();
        key.set("scale", scale);
        key.set("precision", precision);
        if *precision == Precision::Fast {
            key.set("device", baker.fast_device(ran));
        }
        key.set_reading(read);
        key.set_writing(write, outputs.iter().any(|output| is_compressed(output)));
        match normals {
            Some(normals) => key.set_normals(&normals.read),
            None => {
                key.set("filter", filter);
                key.set("edge", edges);
                key.set("normals", NONE);
            }
        }
        key.set_neighbours(neighbours.as_ref());
        key.set_maps(normal.as_ref(), parallax.as_ref(), roughness.as_ref());
        key
    }

    fn set_reading(&mut self, read: &ReadOptions) {
        // A limit changes no byte.
        let ReadOptions { channel, color_space, raw, shrink, max_bytes: _ } = read;
        self.set_option("channel", channel.as_ref());
        self.set("color-space", color_space);
        self.set_option("raw", raw.as_ref());
        self.set("shrink", shrink);
    }

    fn set_writing(&mut self, write: &WriteOptions, is_compressed: bool) {
        let WriteOptions { compression, mips, blocks } = write;
        if is_compressed {
            self.set("compression", compression);
        }
        self.set("mips", mips);
        self.set_option("block-compression", blocks.as_ref());
    }

    /// How a given normal map is read.
    fn set_normals(&mut self, read: &NormalReadOptions) {
        let NormalReadOptions { encoding, channels, convention, max_bytes: _ } = read;
        let found = |text: Option<String>| text.unwrap_or_else(|| "found".into());
        let [encoding, channels] = [encoding.map(|it| it.to_string()), channels.map(|it| it.to_string())].map(found);
        self.set("normals", format_args!("{encoding} {channels} {convention}"));
    }

    /// The tiles by their places around the job's own.
    fn set_neighbours(&mut self, neighbours: Option<&Neighbours>) {
        self.set("neighbours", if neighbours.is_some() { "on" } else { "off" });
        let Some(neighbours) = neighbours else { return };
        // The edge modes are those of the job.
        for (side, reach) in neighbours.halo().sides() {
            self.set(&format!("neighbour-{side}"), reach);
        }
    }

    fn set_maps(
        &mut self,
        normal: Option<&NormalFormat>,
        parallax: Option<&ParallaxFormat>,
        roughness: Option<&RoughnessOptions>,
    ) {
        let mut maps = Vec::new();
        if let Some(NormalFormat { encoding, depth, channels, convention }) = normal {
            maps.push(MapKind::Normal.to_string());
            self.set("encoding", encoding);
            self.set("bits", depth);
            self.set("channels", channels);
            self.set("convention", convention);
        }
        if let Some(ParallaxFormat { encoding, depth }) = parallax {
            maps.push(MapKind::Parallax.to_string());
            self.set("parallax-encoding", encoding);
            self.set("parallax-bits", depth);
        }
        if let Some(RoughnessOptions { method, base, format: RoughnessFormat { depth } }) = roughness {
            maps.push(MapKind::Roughness.to_string());
            self.set("roughness-method", method);
            self.set("base-roughness", base);
            self.set("roughness-bits", depth);
        }
        self.set("maps", maps.join(","));
    }

    fn set_option(&mut self, name: &str, value: Option<impl Display>) {
        match value {
            Some(value) => self.set(name, value),
            None => self.set(name, NONE),
        }
    }

    fn set(&mut self, name: &str, value: impl Display) {
        self.0.insert(name.into(), value.to_string());
    }
}
