//! naga's translations, without what only whole shaders need.

use super::arguments::{functions, with_their_names};
use naga::back::{glsl, hlsl, msl};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};

/// What a shader defines that has no derivatives.
const NO_DERIVATIVES: &str = "TEXBAKE_NO_DERIVATIVES";

/// A module, and what naga knows of it. The texts are those of the library, which are tested.
pub(super) fn parsed(wgsl: &str) -> (Module, ModuleInfo) {
    let module = naga::front::wgsl::parse_str(wgsl).expect("the library is WGSL");
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).expect("the library is valid");
    (module, info)
}

pub(super) fn glsl(wgsl: &str) -> String {
    // naga writes the functions that an entry point's stage can call: this one's is any, that one's a fragment shader.
    let anywhere = glsl_with(wgsl, "@fragment fn main() {}");
    let all = glsl_with(wgsl, "@fragment fn main() { _ = dpdx(0.0); }");
    let functions = all.iter().map(|function| match anywhere.contains(function) {
        true => format!("{function}\n"),
        false => format!("#ifndef {NO_DERIVATIVES}\n{function}\n#endif\n"),
    });
    functions.collect::<Vec<_>>().join("\n")
}

/// The functions of a module in GLSL, without that entry point.
fn glsl_with(wgsl: &str, entry_point: &str) -> Vec<String> {
    let (module, info) = parsed(&format!("{wgsl}\n{entry_point}\n"));
    let options = glsl::Options {
        version: glsl::Version::Desktop(330),
        writer_flags: glsl::WriterFlags::empty(),
        ..Default::default()
    };
    let pipeline = glsl::PipelineOptions {
        shader_stage: ShaderStage::Fragment,
        entry_point: module.entry_points[0].name.clone(),
        multiview: None,
    };
    let mut text = String::new();
    glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, Default::default())
        .and_then(|mut writer| writer.write())
        .expect("the library has nothing that GLSL has not");
    let text = with_their_names(&module, &text);
    // The first has the version before it.
    let functions = functions(&text).map(|function| function.trim_start_matches("#version 330 core").trim());
    functions
        .filter(|function| !function.is_empty() && !function.starts_with("void main()"))
        .map(str::to_owned)
        .collect()
}

pub(super) fn hlsl(wgsl: &str) -> String {
    let (module, info) = parsed(wgsl);
    let options = hlsl::Options {
        shader_model: hlsl::ShaderModel::V5_0,
        // There are no bindings, and each loop of the library counts to its end.
        force_loop_bounding: false,
        ..Default::default()
    };
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &Default::default())
        .write(&module, &info, None)
        .expect("the library has nothing that HLSL has not");
    with_their_names(&module, &text)
}

pub(super) fn msl(wgsl: &str) -> String {
    let (module, info) = parsed(wgsl);
    let options = msl::Options { lang_version: (1, 2), force_loop_bounding: false, ..Default::default() };
    let (text, _) = msl::write_string(&module, &info, &options, &Default::default())
        .expect("the library has nothing that MSL has not");
    // The first line says what the notes say.
    let text = text.split_once('\n').map_or("", |(_, rest)| rest);
    with_their_names(&module, text)
}
