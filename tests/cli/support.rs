//! Folders of height maps, the program, and what it must produce.

use std::path::{Path, PathBuf};
#[cfg(target_os = "linux")]
use std::process::{Child, Stdio};
use std::process::{Command, Output};
#[cfg(target_os = "linux")]
use std::time::Duration;
use tempfile::TempDir;
use texbake::{Baker, Codes, CodesRef, Grid, HeightMap, NormalMap, NormalOptions, ParallaxOptions};

/// A folder for one test, in which the program runs.
pub struct Folder(TempDir);

/// The file in which `bake` remembers what it baked.
pub const RECORD: &str = ".texbake-baked";

/// How a run of the program ended.
pub struct Run {
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Folder {
    pub fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A file with these bytes; its folders are made.
    pub fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// An 8-bit grey PNG, and the same map in memory.
    pub fn grey8(&self, name: &str, width: usize, height: usize, code: impl Fn(usize, usize) -> u8) -> HeightMap {
        let grid = Grid::from_fn(width, height, code).unwrap();
        self.file(name, png(width, height, png::ColorType::Grayscale, png::BitDepth::Eight, grid.texels()));
        grid.into()
    }

    /// A 16-bit grey PNG, and the same map in memory.
    pub fn grey16(&self, name: &str, width: usize, height: usize, code: impl Fn(usize, usize) -> u16) -> HeightMap {
        let grid = Grid::from_fn(width, height, code).unwrap();
        let bytes: Vec<u8> = grid.texels().iter().flat_map(|code| code.to_be_bytes()).collect();
        self.file(name, png(width, height, png::ColorType::Grayscale, png::BitDepth::Sixteen, &bytes));
        grid.into()
    }

    /// Runs the program in this folder.
    pub fn run(&self, arguments: &[&str]) -> Run {
        self.command(arguments).output().unwrap().into()
    }

    /// The program, to be run in this folder.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_texbake"));
        command.args(arguments).current_dir(self.0.path());
        // Mesa's Vulkan layer complains on stderr where there is none.
        command.env("XDG_RUNTIME_DIR", self.0.path());
        command
    }

    /// The paths of all files below a folder of this one, with `/`, sorted; none if there is no such folder. What
    /// `bake` remembers is left out.
    pub fn files(&self, folder: &str) -> Vec<String> {
        let root = self.path(folder);
        let mut files = Vec::new();
        let mut folders = vec![root.clone()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).into_iter().flatten() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else if !path.ends_with(RECORD) {
                    let below = path.strip_prefix(&root).unwrap();
                    files.push(below.to_str().unwrap().replace('\\', "/"));
                }
            }
        }
        files.sort();
        files
    }

    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(self.path(name)).unwrap()).unwrap()
    }

    /// Fails unless the PNG `name` holds what the reference bakes from `map`.
    pub fn assert_baked(&self, name: &str, map: &HeightMap, options: &NormalOptions) {
        let expected = Baker::reference().normal(map, options).unwrap();
        let (width, height, codes) = read_png(&self.path(name));
        assert_eq!((width, height), (map.size().width(), map.size().height()), "{name}");
        assert!(codes.as_ref() == expected.codes(), "{name}: other codes than the reference's");
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self {
            status: output.status.code().expect("it ends by itself"),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }
}

impl Run {
    /// Fails unless it ended with this status.
    #[track_caller]
    pub fn ends(self, status: i32) -> Self {
        assert_eq!(self.status, status, "stdout: {}\nstderr: {}", self.stdout, self.stderr);
        self
    }

    /// The only line on stderr that holds `part`.
    #[track_caller]
    pub fn line(&self, part: &str) -> &str {
        let lines: Vec<_> = self.stderr.lines().filter(|line| line.contains(part)).collect();
        let [line] = lines[..] else { panic!("not one line with {part:?} in: {}", self.stderr) };
        line
    }

    /// Fails unless one line on stderr holds `name` and all `parts`.
    #[track_caller]
    pub fn says(&self, name: &str, parts: &[&str]) {
        let line = self.line(name);
        for part in parts {
            assert!(line.contains(part), "{part:?} is not in: {line}");
        }
    }
}

/// The most memory that a run on the CPU holds, which must succeed.
#[cfg(target_os = "linux")]
pub fn peak_of(mut command: Command) -> u64 {
    let quiet = command.args(["--backend", "cpu", "-q"]).stderr(Stdio::inherit());
    let peak = peak_bytes(&mut quiet.spawn().unwrap());
    assert!(peak > 1 << 20, "{peak} bytes are no program's");
    peak
}

/// The most memory that a child was seen to hold, which must succeed: its own record, read until it ends. The record of
/// those that wait for it, ru_maxrss, would count what this process held when it started the child; what is missed here
/// is the last millisecond, in which rows are freed.
#[cfg(target_os = "linux")]
pub fn peak_bytes(child: &mut Child) -> u64 {
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kibibytes = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok());
        peak = peak.max(kibibytes.unwrap_or(0) << 10);
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success());
    peak
}

/// The program, to be run in `folder` with no more than this address space: its code, its threads' stacks and its
/// allocator's arena, and what it allocates.
#[cfg(target_os = "linux")]
pub fn limited(folder: &Path, kibibytes: u64, arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit -v {kibibytes} && exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_texbake")]);
    command.args(arguments).current_dir(folder);
    // Each thread's arena would reserve 64 MiB of addresses, and each thread of a machine with many cores a stack.
    command.env("MALLOC_ARENA_MAX", "1").env("RAYON_NUM_THREADS", "2");
    command
}

/// The bytes of a PNG; 16-bit samples have the most significant byte first.
pub fn png(width: usize, height: usize, colour: png::ColorType, depth: png::BitDepth, samples: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(samples).unwrap();
    bytes
}

/// Width, height and codes of a PNG without palette.
pub fn read_png(path: &Path) -> (usize, usize, Codes) {
    let file = std::fs::File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    reader.finish().unwrap();
    let codes = match info.bit_depth {
        png::BitDepth::Sixteen => Codes::U16(bytes.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect()),
        _ => Codes::U8(bytes),
    };
    (info.width as usize, info.height as usize, codes)
}

/// An RGB PNG that holds the codes of a map of three components, written by the format's own crate.
pub fn write_normals(folder: &Folder, name: &str, map: &NormalMap) {
    let (depth, samples) = match map.codes() {
        CodesRef::U8(codes) => (png::BitDepth::Eight, codes.to_vec()),
        CodesRef::U16(codes) => (png::BitDepth::Sixteen, codes.iter().flat_map(|code| code.to_be_bytes()).collect()),
        _ => unreachable!("a PNG holds integers"),
    };
    let size = map.size();
    folder.file(name, png(size.width(), size.height(), png::ColorType::Rgb, depth, &samples));
}

/// Fails unless the PNG `name` holds the parallax map that the reference bakes from `map`.
pub fn assert_parallax(folder: &Folder, name: &str, map: &HeightMap, options: &ParallaxOptions) {
    let expected = Baker::reference().parallax(map, options).unwrap();
    let (width, height, codes) = read_png(&folder.path(name));
    assert_eq!((width, height), (map.size().width(), map.size().height()), "{name}");
    assert!(codes.as_ref() == expected.codes(), "{name}: other codes than the reference's");
}

/// A bumpy 8-bit map.
pub fn bumps8(x: usize, y: usize) -> u8 {
    (x * x * 3 + y * 29 + (x * y) / 2) as u8
}

/// A bumpy 16-bit map.
pub fn bumps16(x: usize, y: usize) -> u16 {
    (x * x * 211 + y * 7919 + x * y * 13) as u16
}

/// 8-bit codes of a 1 x 1 map: flat, whatever its height.
pub fn flat() -> CodesRef<'static> {
    CodesRef::U8(&[128, 128, 255])
}
