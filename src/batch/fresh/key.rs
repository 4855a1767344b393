//! The options on which the bytes of a job's outputs depend.

use crate::baker::Ran;
use crate::batch::{Job, Options};
use crate::io::{NormalReadOptions, is_compressed};
use crate::ops::Precision;
use serde_json::Value;
use std::collections::BTreeMap;
use std::num::NonZeroU32;

/// Options by name, as the report has them.
pub(super) type Key = BTreeMap<String, String>;

/// What changes no byte: a limit, and a number that goes into reports alone.
const WITHOUT_EFFECT: [&str; 2] = ["max_bytes", "iterations"];

/// The options of `job`, which ran, or will run: every field of [`Options`], so that none can be forgotten, but what no
/// output follows; what its other inputs are read by, and the device where `fast` lets it decide over bytes.
pub(super) fn of(job: &Job, ran: Option<&Ran>) -> Key {
    let text = |value: Value| match value {
        Value::Null => None,
        Value::String(text) => Some(text),
        other => Some(other.to_string()),
    };
    let Ok(Value::Object(options)) = serde_json::to_value(Options::new(job, NonZeroU32::MIN)) else {
        unreachable!("options are a JSON object")
    };
    let is_compressed = job.outputs.iter().any(|output| is_compressed(output));
    let has_effect = |name: &str| !WITHOUT_EFFECT.contains(&name) && (is_compressed || name != "compression");
    let options = options.into_iter().filter(|(name, _)| has_effect(name));
    let mut key: Key = options.filter_map(|(name, value)| Some((name, text(value)?))).collect();
    if let Some(normals) = &job.normals {
        let NormalReadOptions { encoding, channels, convention, max_bytes: _ } = &normals.read;
        let found = |text: Option<String>| text.unwrap_or_else(|| "found".into());
        let [encoding, channels] = [encoding.map(|it| it.to_string()), channels.map(|it| it.to_string())].map(found);
        key.insert("normals".into(), format!("{encoding} {channels} {convention}"));
    }
    if job.options.precision == Precision::Fast {
        key.insert("device".into(), job.baker.fast_device(ran));
    }
    key
}
