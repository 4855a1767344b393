//! Settings: texbake.toml.

#![no_main]
#![allow(dead_code, reason = "of the program, only the reader of settings is used here")]

use cli::config::Config;
use std::path::{Path, PathBuf};
use texbake::Error;

// The program's own module, whose reader of settings the library does not have.
#[path = "../../src/cli/mod.rs"]
mod cli;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let path = texbake_fuzz::file("texbake.toml", data);
    let inputs = ["wall.png", "a/dem_1.tif", "a/b/c_height_2k.exr", ""].map(PathBuf::from);
    match Config::find(Some(&path), &[]) {
        Ok(Some(config)) => {
            assert!(config.unused(&[]).count() >= config.unused(&inputs).count(), "more files use more globs");
            for input in &inputs {
                let settings = |path: &Path| format!("{:?}", config.settings(path));
                assert_eq!(settings(input), settings(input));
            }
        }
        Ok(None) => panic!("a settings file that is named is read"),
        Err(error) => {
            texbake_fuzz::explained::assert_explained(&path, &error);
            if let Error::File { path, .. } = &error {
                let place = path.display().to_string();
                let line: usize = place.rsplit(':').next().and_then(|line| line.parse().ok()).expect("a line");
                assert!(line <= data.iter().filter(|byte| **byte == b'\n').count() + 1, "{place}");
            }
        }
    }
});
