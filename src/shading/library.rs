//! The texts of the shader library.

/// A file of the shader library: functions of one concept, in WGSL, without bindings.
///
/// ```
/// use texbake::shading::LIBRARY;
///
/// let welsh = LIBRARY.iter().find(|file| file.name == "welsh_offset").expect("it is there");
/// assert_eq!(welsh.functions().collect::<Vec<_>>(), ["welsh_offset", "limited_offset"]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShaderFile {
    /// The concept.
    pub name: &'static str,
    /// The text: a comment that says what the functions take and give, then the functions.
    pub wgsl: &'static str,
}

impl ShaderFile {
    /// The names of the functions, in their order.
    pub fn functions(&self) -> impl Iterator<Item = &'static str> {
        self.wgsl.lines().filter_map(|line| Some(line.strip_prefix("fn ")?.split_once('(')?.0))
    }

    /// The comment at the top, without its end.
    #[cfg(feature = "cli")]
    pub(super) fn header(&self) -> &'static str {
        self.wgsl.split_once("\n\n").map_or("", |(header, _)| header)
    }
}

macro_rules! files {
    ($($name:literal),*) => {
        [$(ShaderFile { name: $name, wgsl: include_str!(concat!("../../kernels/shading/", $name, ".wgsl")) }),*]
    };
}

/// All files of the shader library. They may stand in one module in any order: no name is used twice.
pub const LIBRARY: [ShaderFile; 8] = files![
    "decode_normal",
    "tangent_frame",
    "cotangent_frame",
    "lighting",
    "welsh_offset",
    "plane_offset",
    "stepped_offset",
    "relief_offset"
];
