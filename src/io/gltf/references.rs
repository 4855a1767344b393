//! How often accessors and buffer views are used.

use super::document::index;
use serde_json::Value;
use std::collections::BTreeSet;

/// Extensions whose numbers are no indices of accessors or buffer views.
const WITHOUT_INDICES: [&str; 6] =
    ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_xmp", "MSFT_"];

/// Of a document that is being changed.
pub(super) struct References {
    pub accessors: Uses,
    pub views: Uses,
}

/// How often each object of an array is used, and which ones are not any more.
#[derive(Default)]
pub(super) struct Uses {
    counts: Vec<usize>,
    free: BTreeSet<usize>,
}

impl References {
    pub fn of(json: &Value) -> Self {
        let mut this = Self { accessors: Uses::of(&json["accessors"]), views: Uses::of(&json["bufferViews"]) };
        for primitive in items(json, "meshes").flat_map(|mesh| items(mesh, "primitives")) {
            let targets = items(primitive, "targets").chain([&primitive["attributes"]]);
            let vectors = targets.filter_map(Value::as_object).flat_map(|attributes| attributes.values());
            let indices = vectors.chain([&primitive["indices"]]);
            indices.for_each(|accessor| this.accessors.hold(accessor));
        }
        for sampler in items(json, "animations").flat_map(|animation| items(animation, "samplers")) {
            this.accessors.hold(&sampler["input"]);
            this.accessors.hold(&sampler["output"]);
        }
        items(json, "skins").for_each(|skin| this.accessors.hold(&skin["inverseBindMatrices"]));
        items(json, "images").for_each(|image| this.views.hold(&image["bufferView"]));
        items(json, "accessors").flat_map(views_of).for_each(|view| this.views.hold(&view.into()));
        this.hold_extensions(json);
        this
    }

    /// Extensions refer by fields of any name: each of their numbers counts as an index.
    fn hold_extensions(&mut self, value: &Value) {
        match value {
            Value::Array(items) => items.iter().for_each(|item| self.hold_extensions(item)),
            Value::Object(fields) => {
                for (_, item) in fields.iter().filter(|(name, _)| *name != "extensions" && *name != "extras") {
                    self.hold_extensions(item);
                }
                for (name, extension) in fields.get("extensions").and_then(Value::as_object).into_iter().flatten() {
                    if !WITHOUT_INDICES.iter().any(|prefix| name.starts_with(prefix)) {
                        self.hold_numbers(extension);
                    }
                }
            }
            _ => {}
        }
    }

    fn hold_numbers(&mut self, value: &Value) {
        match value {
            Value::Array(items) => items.iter().for_each(|item| self.hold_numbers(item)),
            Value::Object(fields) => fields.values().for_each(|item| self.hold_numbers(item)),
            number => {
                self.accessors.hold(number);
                self.views.hold(number);
            }
        }
    }

    /// One use more of a new accessor.
    pub fn hold(&mut self, accessor: usize) {
        self.accessors.hold(&accessor.into());
    }

    /// One use less of an accessor of the document `json`.
    pub fn release(&mut self, accessor: usize, json: &Value) {
        if self.accessors.release(accessor) {
            for view in views_of(&json["accessors"][accessor]) {
                self.views.release(view);
            }
        }
    }
}

impl Uses {
    fn of(list: &Value) -> Self {
        Self { counts: vec![0; list.as_array().map_or(0, Vec::len)], free: BTreeSet::new() }
    }

    fn hold(&mut self, index: &Value) {
        let index = index.as_u64().and_then(|index| usize::try_from(index).ok());
        if let Some(count) = index.and_then(|index| self.counts.get_mut(index)) {
            *count += 1;
        }
    }

    /// Whether that was the last use.
    fn release(&mut self, index: usize) -> bool {
        let Some(count) = self.counts.get_mut(index) else { return false };
        *count = count.saturating_sub(1);
        *count == 0 && self.free.insert(index)
    }

    /// A place for a new object: the one that is asked for if it is free, or any free one, or a new one.
    pub fn place(&mut self, wanted: Option<usize>) -> usize {
        let free = wanted.filter(|wanted| self.free.contains(wanted)).or_else(|| self.free.first().copied());
        if let Some(free) = free {
            self.free.remove(&free);
            return free;
        }
        self.counts.push(0);
        self.counts.len() - 1
    }
}

/// The buffer views of an accessor.
fn views_of(accessor: &Value) -> impl Iterator<Item = usize> {
    let sparse = &accessor["sparse"];
    [accessor, &sparse["indices"], &sparse["values"]].into_iter().filter_map(|part| index(part, "bufferView"))
}

fn items<'a>(object: &'a Value, field: &str) -> impl Iterator<Item = &'a Value> {
    object[field].as_array().into_iter().flatten()
}
