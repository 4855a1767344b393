//! Damaged files of every format: an answer or a reason, never a panic.

use super::samples::{height_maps, normal_maps, raw_maps};
use super::support::{Folder, Noise};
use std::panic::RefUnwindSafe;
use std::path::{Path, PathBuf};
use texbake::io::{NormalReadOptions, ReadOptions};
use texbake::{Error, HeightMap, NormalMap};

/// Variants of a file: bytes replaced, mostly in its first part, where sizes and offsets stand; cut; grown.
fn variant(whole: &[u8], noise: &mut Noise) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let edits = 1 + noise.next() % 4;
    for _ in 0..edits {
        let reach = if noise.next().is_multiple_of(3) { bytes.len() } else { bytes.len().min(400) };
        let at = noise.next() as usize % reach;
        bytes[at] = match noise.next() % 4 {
            0 => 0,
            1 => 0xff,
            2 => bytes[at] ^ 1 << (noise.next() % 8),
            _ => noise.next() as u8,
        };
    }
    if noise.next().is_multiple_of(8) {
        bytes.truncate(noise.next() as usize % bytes.len());
    }
    bytes
}

/// Variants per file; more are tried with TEXBAKE_DAMAGE=n.
pub fn variants() -> u32 {
    std::env::var("TEXBAKE_DAMAGE").ok().and_then(|count| count.parse().ok()).unwrap_or(1000)
}

/// Small enough that a file that claims more is refused, not tried.
pub const MAX_BYTES: u64 = 64 << 20;

#[test]
fn damaged_height_maps_never_panic() {
    let folder = Folder::new();
    let options = ReadOptions { max_bytes: MAX_BYTES, channel: Some("r".parse().unwrap()), ..Default::default() };
    assert_no_panic(&height_maps(&folder), |path| HeightMap::read_with(path, &options).map(|_| ()));
}

#[test]
fn damaged_normal_maps_never_panic() {
    let folder = Folder::new();
    let options = NormalReadOptions { max_bytes: MAX_BYTES, ..Default::default() };
    assert_no_panic(&normal_maps(&folder), |path| NormalMap::read_with(path, &options).map(|_| ()));
}

/// Reads variants of each file.
pub fn assert_no_panic(samples: &[PathBuf], read_file: impl Fn(&Path) -> Result<(), Error> + RefUnwindSafe) {
    for path in samples {
        let whole = std::fs::read(path).unwrap();
        read_file(path).expect("undamaged, the file reads");
        let mut noise = Noise(whole.len() as u64);
        let (mut read, mut refused) = (0, 0);
        for _ in 0..variants() {
            let bytes = variant(&whole, &mut noise);
            // A file that is cut and written again goes to the disk at once; a new one does not.
            std::fs::remove_file(path).unwrap();
            std::fs::write(path, &bytes).unwrap();
            let result = std::panic::catch_unwind(|| read_file(path));
            match result {
                Ok(Ok(())) => read += 1,
                Ok(Err(error)) => {
                    assert!(!error.to_string().is_empty());
                    refused += 1;
                }
                Err(_) => {
                    let kept = std::env::temp_dir().join(path.file_name().unwrap());
                    std::fs::write(&kept, &bytes).unwrap();
                    panic!("{} panicked; the file is {}", path.display(), kept.display());
                }
            }
        }
        assert!(refused > 0, "{}: {read} variants read, none was refused", path.display());
    }
}
