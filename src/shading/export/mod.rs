//! The shader library for engines that do not read WGSL.

mod arguments;
mod linkage;
mod translate;

use super::{LIBRARY, ShaderFile};
use crate::error::Result;
use crate::io::replace::replace_file;
use crate::names::named;
use std::path::{Path, PathBuf};

/// A language that the shader library is exported in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ShaderLanguage {
    /// As it is: WebGPU, wgpu, Bevy.
    #[default]
    Wgsl,
    /// GLSL 3.30 and later, with and without Vulkan, and GLSL ES 3.00: OpenGL, WebGL 2, Godot.
    Glsl,
    /// Shader model 5.0 and later: Direct3D, Unity, Unreal.
    Hlsl,
    /// The Metal Shading Language, 1.2 and later.
    Msl,
    /// Modules of SPIR-V 1.0 whose functions a linker finds by their names.
    Spirv,
}

named! {
    ShaderLanguage "lang" { Wgsl = "wgsl", Glsl = "glsl", Hlsl = "hlsl", Msl = "msl", Spirv = "spirv" }
}

impl ShaderLanguage {
    /// How the names of its files end.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Glsl => "glsl",
            Self::Hlsl => "hlsl",
            Self::Msl => "metal",
            Self::Spirv => "spv",
        }
    }

    /// What a user of the files should know besides their header.
    fn notes(self) -> &'static str {
        match self {
            Self::Wgsl | Self::Spirv => "",
            Self::Glsl => {
                "// For any GLSL from 3.30, GLSL ES from 3.00. A texture and its sampler are one sampler2D (of Vulkan's\n\
                 // GLSL: sampler2D(texture, sampler)). Functions with derivatives are for fragment shaders: in others\n\
                 // define TEXBAKE_NO_DERIVATIVES before this file is included.\n"
            }
            Self::Hlsl => {
                "// For shader model 5.0 and later. The vectors of a frame are the rows of the matrix, frame[0] to frame[2]:\n\
                 // mul(m, frame) is what columns are multiplied by elsewhere.\n"
            }
            Self::Msl => "// For the Metal Shading Language from 1.2.\n",
        }
    }
}

impl ShaderFile {
    /// The name of the file in a language: `relief_offset.glsl`.
    pub fn file_name(&self, language: ShaderLanguage) -> String {
        format!("{}.{}", self.name, language.extension())
    }

    /// The file in a language: an include with a comment that says what it is, or a module of SPIR-V.
    ///
    /// Functions keep their names, and the order and the names of their arguments; of a texture and a sampler GLSL makes
    /// one. GLSL, HLSL and MSL have guards: a file may be included twice, and all of them in one shader.
    pub fn in_language(&self, language: ShaderLanguage) -> Vec<u8> {
        let text = match language {
            ShaderLanguage::Wgsl => format!("{}//\n{}", self.title(language), self.wgsl),
            ShaderLanguage::Glsl => self.include(language, &translate::glsl(self.wgsl)),
            ShaderLanguage::Hlsl => self.include(language, &translate::hlsl(self.wgsl)),
            ShaderLanguage::Msl => self.include(language, &translate::msl(self.wgsl)),
            ShaderLanguage::Spirv => return linkage::spirv(self, &self.title(language)),
        };
        text.into_bytes()
    }

    /// What the file is.
    fn title(&self, language: ShaderLanguage) -> String {
        let (file, version) = (self.file_name(language), env!("CARGO_PKG_VERSION"));
        match language {
            ShaderLanguage::Wgsl => format!("// {file}, of the shader library of texbake {version}.\n"),
            _ => format!("// {file}, of the shader library of texbake {version}; translated from WGSL.\n"),
        }
    }

    fn include(&self, language: ShaderLanguage, functions: &str) -> String {
        let guard = format!("TEXBAKE_{}", self.name.to_uppercase());
        let (title, notes, header) = (self.title(language), language.notes(), self.header());
        format!("{title}{notes}//\n{header}\n\n#ifndef {guard}\n#define {guard}\n\n{}\n\n#endif\n", functions.trim())
    }
}

/// Writes the whole library into a folder, which is made, and gives the paths: each file appears when it is complete.
///
/// # Errors
/// [`crate::Error::File`] if there is something else than a file under one of the names; [`crate::Error::Io`].
pub fn export(folder: &Path, language: ShaderLanguage) -> Result<Vec<PathBuf>> {
    let write = |file: &ShaderFile| {
        let path = folder.join(file.file_name(language));
        replace_file(&path, &file.in_language(language))?;
        Ok(path)
    };
    LIBRARY.iter().map(write).collect()
}
