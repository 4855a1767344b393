//! The file that remembers what was baked into a folder.
//!
//! A header, then a JSON object a line; a later line about an output takes the place of an earlier one. A bake that is
//! complete adds its line in one write, so that a kill costs the line that was being written and no other. Processes
//! that bake into the same folder take turns by the file's lock.

use super::line::Line;
use crate::error::{Error, Result};
use crate::io::file_state::is_at;
use crate::io::replace::Replacement;
use std::collections::{BTreeMap, HashMap};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The record of a folder.
pub(super) struct Record {
    folder: PathBuf,
    path: PathBuf,
    lines: Lines,
}

/// What a record's file holds.
#[derive(Default)]
struct Lines {
    /// By the name of the output.
    by_output: HashMap<String, Arc<Line>>,
    /// Lines that can be read, those that later ones replaced included.
    read: usize,
    /// Lines that cannot.
    unreadable: usize,
    /// Why the file is no record that this version could add to.
    foreign: Option<&'static str>,
}

/// The name of the file in its folder.
pub(super) const NAME: &str = ".texbake-baked";

/// The first line. Another layout of the others has another number.
const HEADER: &str = "{\"texbake\":\"what was baked into this folder, and from what\",\"format\":1}\n";

/// The most bytes of a record: a hundred thousand textures. What is larger is something else.
const MOST_BYTES: u64 = 256 << 20;

impl Record {
    /// Reads the record of `folder`, with a warning about what cannot be read.
    pub fn read(folder: &Path) -> (Self, Option<String>) {
        let path = folder.join(NAME);
        let (lines, warning) = match read_locked(&path) {
            Ok(bytes) => {
                let lines = Lines::parse(&bytes);
                let warning = lines.warning();
                (lines, warning)
            }
            Err(error) if error.kind() == ErrorKind::NotFound => Default::default(),
            Err(error) => (Lines::default(), Some(error.to_string())),
        };
        let warning = warning.map(|reason| format!("{}: {reason}: what it was about is baked again", path.display()));
        (Self { folder: folder.into(), path, lines }, warning)
    }

    /// The name by which lines call an output: parts that are no Unicode are escaped.
    pub fn name(&self, output: &Path) -> String {
        let below = output.strip_prefix(&self.folder).unwrap_or(output);
        let part = |part: std::path::Component<'_>| {
            let quoted = format!("{:?}", part.as_os_str());
            quoted.trim_matches('"').to_owned()
        };
        below.components().map(part).collect::<Vec<_>>().join("/")
    }

    /// Whether there is an output of this name; of one with escapes nobody knows.
    fn has(&self, name: &str) -> bool {
        let is_there = |path: &Path| path.try_exists().unwrap_or(true);
        name.contains('\\') || is_there(&self.folder.join(name)) || is_there(name.as_ref())
    }

    /// How an output was baked.
    pub fn line(&self, output: &Path) -> Option<Arc<Line>> {
        self.lines.by_output.get(&self.name(output)).cloned()
    }

    /// Rewrites the file if most of it is of no use, or if nothing can be added to it.
    ///
    /// # Errors
    /// [`Error::File`] if it is read-only or no file; [`Error::Io`].
    pub fn tidy(&self) -> Result<()> {
        if !self.is_wasteful(&self.lines) {
            return Ok(());
        }
        // Nobody adds to it meanwhile; those who wait find another file then.
        let mut locked = self.lock().map_err(Error::io(&self.path))?;
        let lines = Lines::parse(&read_whole(&mut locked).map_err(Error::io(&self.path))?);
        if !self.is_wasteful(&lines) {
            return Ok(());
        }
        let file = Replacement::create(&self.path)?;
        let text = HEADER.to_owned() + &text(self.live(&lines).into_values().map(Arc::as_ref));
        file.output()?.write_all(text.as_bytes()).map_err(Error::io(&self.path))?;
        file.commit()
    }

    /// Each line that says something about an output that is there, by the first such name.
    fn live<'l>(&self, lines: &'l Lines) -> BTreeMap<&'l str, &'l Arc<Line>> {
        let is_first = |(name, line): &(&String, &Arc<Line>)| {
            let mut names = line.outputs.iter().map(|output| &output.name);
            let says = |name: &String| Arc::ptr_eq(&lines.by_output[name], line) && self.has(name);
            names.find(|name| says(name)) == Some(*name)
        };
        lines.by_output.iter().filter(is_first).map(|(name, line)| (name.as_str(), line)).collect()
    }

    fn is_wasteful(&self, lines: &Lines) -> bool {
        let all = lines.read + lines.unreadable;
        lines.foreign.is_some() || all > 2 * self.live(lines).len()
    }

    /// Adds lines.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written.
    pub fn add(&self, lines: &[Line]) -> Result<()> {
        if lines.is_empty() {
            return Ok(());
        }
        self.add_text(&text(lines)).map_err(Error::io(&self.path))
    }

    fn add_text(&self, text: &str) -> io::Result<()> {
        let mut file = self.lock()?;
        let end = end_of_lines(&mut file)?;
        if end > 0 && !has_header(&mut file)? {
            return Err(io::Error::other("another program replaced it"));
        }
        // What a killed process left of its line goes.
        file.set_len(end)?;
        let header = if end == 0 { HEADER } else { "" };
        file.write_all((header.to_owned() + text).as_bytes())
    }

    /// The file, made if there is none, to read and to add to; locked until it is closed.
    fn lock(&self) -> io::Result<File> {
        loop {
            check_kind(&self.path)?;
            let file = File::options().read(true).append(true).create(true).open(&self.path)?;
            // A file system without locks is used by one process at a time.
            let _ = file.lock();
            if is_at(&file, &self.path) {
                return Ok(file);
            }
        }
    }
}

impl Lines {
    fn parse(bytes: &[u8]) -> Self {
        let mut lines = Self::default();
        let Some(text) = bytes.strip_prefix(HEADER.as_bytes()) else {
            lines.foreign = foreign(bytes);
            return lines;
        };
        for line in text.split_inclusive(|byte| *byte == b'\n') {
            match serde_json::from_slice::<Line>(line) {
                // A kill came in between.
                _ if !line.ends_with(b"\n") => {}
                Ok(line) => lines.insert(line),
                Err(_) => lines.unreadable += 1,
            }
        }
        lines
    }

    fn insert(&mut self, line: Line) {
        self.read += 1;
        let line = Arc::new(line);
        self.by_output.extend(line.outputs.iter().map(|output| (output.name.clone(), line.clone())));
    }

    fn warning(&self) -> Option<String> {
        match (self.foreign, self.unreadable) {
            (Some(reason), _) => Some(reason.into()),
            (None, 0) => None,
            (None, 1) => Some("a line of it cannot be read".into()),
            (None, lines) => Some(format!("{lines} lines of it cannot be read")),
        }
    }
}

/// Why a file without the header is no record; `None` for one whose header was being written.
fn foreign(bytes: &[u8]) -> Option<&'static str> {
    #[derive(serde::Deserialize)]
    struct Other {
        #[serde(rename = "texbake")]
        _texbake: String,
        #[serde(rename = "format")]
        _format: u32,
    }
    let first = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default();
    match serde_json::from_slice::<Other>(first) {
        _ if HEADER.as_bytes().starts_with(bytes) => None,
        Ok(_) => Some("it is of another version of texbake"),
        Err(_) => Some("it is no record of texbake"),
    }
}

/// Lines as they stand in the file.
fn text<L: std::borrow::Borrow<Line>>(lines: impl IntoIterator<Item = L>) -> String {
    let line = |line: L| serde_json::to_string(line.borrow()).map(|line| line + "\n").unwrap_or_default();
    lines.into_iter().map(line).collect()
}

/// A pipe is not waited for, and a device is left alone.
fn check_kind(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(there) if !there.is_file() => Err(io::Error::other("it is no file")),
        _ => Ok(()),
    }
}

/// The bytes of the file at `path`, while nobody writes them.
fn read_locked(path: &Path) -> io::Result<Vec<u8>> {
    check_kind(path)?;
    let mut file = File::open(path)?;
    let _ = file.lock_shared();
    read_whole(&mut file)
}

fn read_whole(file: &mut File) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    // What is too long is no record, whatever it begins with.
    if bytes.len() as u64 > MOST_BYTES { Ok(b"too long".into()) } else { Ok(bytes) }
}

fn has_header(file: &mut File) -> io::Result<bool> {
    let mut start = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.take(HEADER.len() as u64).read_to_end(&mut start)?;
    Ok(start == HEADER.as_bytes())
}

/// Where the last whole line ends.
fn end_of_lines(file: &mut File) -> io::Result<u64> {
    let length = file.seek(SeekFrom::End(0))?;
    let mut last = [b'\n'];
    if length > 0 {
        file.seek(SeekFrom::End(-1))?;
        file.read_exact(&mut last)?;
    }
    if last == *b"\n" {
        return Ok(length);
    }
    file.seek(SeekFrom::Start(0))?;
    let bytes = read_whole(file)?;
    Ok(bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last as u64 + 1))
}
