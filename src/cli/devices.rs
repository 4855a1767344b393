//! `texbake devices`: what could run bakes.

use super::args::DevicesArguments;
use super::exit::{Exit, Failure};
use super::print::{device_table, put};
use serde_json::json;

pub fn devices(arguments: &DevicesArguments) -> Result<Exit, Failure> {
    let devices = texbake::devices();
    if !arguments.json {
        put(device_table(&devices));
        return Ok(Exit::Success);
    }
    let list = devices.iter().map(|device| {
        json!({
            "name": device.name,
            "api": device.api,
            "kind": device.kind,
            "driver": device.driver,
            "self_test": device.self_test.as_ref().map_or_else(String::as_str, |()| "passed"),
            "passed": device.self_test.is_ok(),
            "picked": device.picked,
            "reason": device.reason,
        })
    });
    put(format_args!("{:#}", json!(list.collect::<Vec<_>>())));
    Ok(Exit::Success)
}
