//! What `tests/run.sh` fetches and git does not hold.

use std::path::PathBuf;

/// The folder that TEXBAKE_name is set to. Without one that is printed; with TEXBAKE_REQUIRE_name=1 it fails the test.
pub fn fetched(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(format!("TEXBAKE_{name}")).filter(|folder| !folder.is_empty());
    if folder.is_none() {
        println!("not tested: TEXBAKE_{name} names no folder");
        let required = std::env::var(format!("TEXBAKE_REQUIRE_{name}")).is_ok_and(|value| value == "1");
        assert!(!required, "TEXBAKE_REQUIRE_{name}=1, but TEXBAKE_{name} names no folder");
    }
    folder.map(PathBuf::from)
}
