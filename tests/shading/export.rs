//! The exported library, by other compilers: glslang for GLSL and HLSL, the Khronos SPIR-V tools for modules.
//!
//! No compiler of Metal is at hand: of MSL the signatures are held against the WGSL, and no more.

use std::path::Path;
use std::process::Command;
use tempfile::TempDir;
use texbake::shading::{LIBRARY, ShaderFile, ShaderLanguage, export};

/// Whether the tools are there; with `TEXBAKE_REQUIRE_SHADER_TOOLS=1` they must be.
fn has_tools() -> bool {
    let tools = ["glslangValidator", "spirv-val", "spirv-as", "spirv-link", "spirv-dis"];
    let missing: Vec<_> =
        tools.into_iter().filter(|tool| Command::new(tool).arg("--version").output().is_err()).collect();
    let required = std::env::var("TEXBAKE_REQUIRE_SHADER_TOOLS").is_ok_and(|value| value == "1");
    assert!(missing.is_empty() || !required, "TEXBAKE_REQUIRE_SHADER_TOOLS=1, but there is no {}", missing.join(", "));
    if !missing.is_empty() {
        println!("not tested: no {}", missing.join(", "));
    }
    missing.is_empty()
}

/// What a tool says of files in a folder, if they are right for it.
fn run(folder: &Path, tool: &str, arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(tool).args(arguments).current_dir(folder).output().unwrap();
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    if output.status.success() { Ok(text) } else { Err(text) }
}

fn text_in(file: &ShaderFile, language: ShaderLanguage) -> String {
    String::from_utf8(file.in_language(language)).unwrap()
}

/// A call of each function in GLSL; in HLSL with a texture and a sampler in place of a sampler2D.
const CALLS: [(&str, &[&str]); 8] = [
    (
        "decode_normal",
        &[
            "decode_unorm(p)",
            "decode_snorm(p)",
            "decode_biased_8_bit(p)",
            "decode_biased_16_bit(p)",
            "rebuild_z(uv)",
            "green_turned(p)",
        ],
    ),
    (
        "tangent_frame",
        &["vertex_frame(p, p, 1.0)[1]", "pixel_frame(p, p, 1.0)[1]", "to_tangent(m, p)", "to_object(m, p)"],
    ),
    (
        "cotangent_frame",
        &[
            "cotangent_frame(p, p, p, uv, uv)[0]",
            "pixel_cotangent_frame(p, p, uv)[1]",
            "without_perspective(p, p, p, uv, uv)[0]",
            "gradients(p, p, uv, uv)[1]",
            "perturbed_normal(m, p)",
        ],
    ),
    ("lighting", &["VEC3(diffuse(p, p))", "two_lights(p, p, p, p, p, p)", "VEC3(blinn_phong(p, p, p, 8.0))"]),
    ("welsh_offset", &["VEC3(welsh_offset(0.5, uv, uv, p).x)", "VEC3(limited_offset(0.5, uv, uv, p).y)"]),
    ("plane_offset", &["VEC3(plane_offset(p, 0.5, p, 1.0).x)"]),
    ("stepped_offset", &["VEC3(step_scale(uv, uv, 4u, 1.0).x)", "VEC3(stepped_offset(MAP, 0.0, uv, uv, p, uv, 4u).y)"]),
    ("relief_offset", &["VEC3(relief_offset(MAP, 0.0, uv, p, uv, 64u, 8u).x)"]),
];

/// The sum of calls of every function of these files.
fn sum_of_calls(files: &[ShaderFile], language: ShaderLanguage) -> String {
    let calls = files.iter().flat_map(|file| CALLS.iter().find(|(name, _)| *name == file.name).unwrap().1);
    let sum = calls.copied().collect::<Vec<_>>().join(" + ");
    match language {
        ShaderLanguage::Hlsl => sum.replace("MAP", "map, map_sampler").replace("VEC3(", "splat("),
        _ => sum.replace("MAP", "map").replace("VEC3", "vec3"),
    }
}

/// A fragment shader that includes the files and calls their functions.
fn glsl_shader(version: &str, texts: &[String], sum: &str) -> String {
    let (before, layout) = match version {
        "450" => ("", ["layout(location = 0) ", "layout(location = 1) ", "layout(binding = 0) "]),
        _ => ("precision highp float;\nprecision highp int;\n", ["", "", ""]),
    };
    let [p, uv, map] = layout;
    format!(
        "#version {version}\n{before}{p}in vec3 p;\n{uv}in vec2 uv;\n{map}uniform sampler2D map;\n{}out vec4 colour;\n{}
void main() {{
    mat3 m = mat3(p, p, p);
    colour = vec4({sum}, 1.0);
}}\n",
        layout[0],
        texts.concat()
    )
}

/// Compiles it, for Vulkan where the version is 450.
fn compile_glsl(version: &str, texts: &[String], sum: &str) -> Result<(), String> {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("shader.frag"), glsl_shader(version, texts, sum)).unwrap();
    if version != "450" {
        return run(folder.path(), "glslangValidator", &["shader.frag"]).map(drop);
    }
    run(folder.path(), "glslangValidator", &["-V", "shader.frag", "-o", "shader.spv"])?;
    run(folder.path(), "spirv-val", &["--target-env", "vulkan1.0", "shader.spv"]).map(drop)
}

fn hlsl_shader(texts: &[String], sum: &str) -> String {
    format!(
        "{}
Texture2D<float4> map;
SamplerState map_sampler;
float3 splat(float x) {{ return float3(x, x, x); }}
float4 main(float3 p : P, float2 uv : UV) : SV_Target {{
    float3x3 m = float3x3(p, p, p);
    return float4({sum}, 1.0);
}}\n",
        texts.concat()
    )
}

fn compile_hlsl(texts: &[String], sum: &str) -> Result<(), String> {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("shader.hlsl"), hlsl_shader(texts, sum)).unwrap();
    run(folder.path(), "glslangValidator", &["-D", "-V", "-S", "frag", "-e", "main", "shader.hlsl", "-o", "o.spv"])
        .map(drop)
}

const GLSL_VERSIONS: [&str; 3] = ["330 core", "450", "300 es"];

#[test]
fn glsl_compiles_and_is_called() {
    if !has_tools() {
        return;
    }
    let glsl = ShaderLanguage::Glsl;
    for version in GLSL_VERSIONS {
        for file in LIBRARY {
            let sum = sum_of_calls(&[file], glsl);
            compile_glsl(version, &[text_in(&file, glsl)], &sum)
                .unwrap_or_else(|error| panic!("{}, {version}: {error}", file.name));
        }
        // All together, and each twice.
        let texts: Vec<_> = LIBRARY.iter().chain(&LIBRARY).map(|file| text_in(file, glsl)).collect();
        compile_glsl(version, &texts, &sum_of_calls(&LIBRARY, glsl)).unwrap();
    }
    // Where there are no derivatives.
    let folder = TempDir::new().unwrap();
    let all = LIBRARY.iter().map(|file| text_in(file, glsl)).collect::<String>();
    for (stage, is_right) in [("#define TEXBAKE_NO_DERIVATIVES\n", true), ("", false)] {
        std::fs::write(folder.path().join("a.vert"), format!("#version 330 core\n{stage}{all}\nvoid main() {{}}\n"))
            .unwrap();
        assert_eq!(run(folder.path(), "glslangValidator", &["a.vert"]).is_ok(), is_right, "{stage:?}");
    }
}

#[test]
fn hlsl_compiles_and_is_called() {
    if !has_tools() {
        return;
    }
    let hlsl = ShaderLanguage::Hlsl;
    for file in LIBRARY {
        let sum = sum_of_calls(&[file], hlsl);
        compile_hlsl(&[text_in(&file, hlsl)], &sum).unwrap_or_else(|error| panic!("{}: {error}", file.name));
    }
    let texts: Vec<_> = LIBRARY.iter().chain(&LIBRARY).map(|file| text_in(file, hlsl)).collect();
    compile_hlsl(&texts, &sum_of_calls(&LIBRARY, hlsl)).unwrap();
}

/// A type that is not there, a parenthesis less, a function that is called by another name.
#[test]
fn compilers_notice_what_is_broken() {
    if !has_tools() {
        return;
    }
    let file = LIBRARY.iter().find(|file| file.name == "relief_offset").unwrap();
    for (language, from, to) in [
        (ShaderLanguage::Glsl, "vec2 slant", "vec7 slant"),
        (ShaderLanguage::Glsl, "relief_offset(sampler2D", "relief_offset_(sampler2D"),
        (ShaderLanguage::Glsl, "return (slant", "return slant"),
        (ShaderLanguage::Hlsl, "float2 slant", "float7 slant"),
        (ShaderLanguage::Hlsl, "relief_offset(Texture2D", "relief_offset_(Texture2D"),
    ] {
        let text = text_in(file, language);
        assert!(text.contains(from), "{from:?}");
        let (texts, sum) = ([text.replacen(from, to, 1)], sum_of_calls(&[*file], language));
        let compiled = match language {
            ShaderLanguage::Hlsl => compile_hlsl(&texts, &sum),
            _ => compile_glsl("450", &texts, &sum),
        };
        assert!(compiled.is_err(), "{from:?}");
    }
}

/// A compute module that imports welsh_offset(0.75, (1, 2), (0, 0), (x, 0, 1)) by name.
const IMPORTER: &str = r#"
OpCapability Shader
OpCapability Linkage
OpMemoryModel Logical GLSL450
OpEntryPoint GLCompute %main "main"
OpExecutionMode %main LocalSize 1 1 1
OpDecorate %imported LinkageAttributes "welsh_offset" Import
%void = OpTypeVoid
%float = OpTypeFloat 32
%v2 = OpTypeVector %float 2
%v3 = OpTypeVector %float 3
%offset = OpTypeFunction %v2 %float %v2 %v2 %v3
%entry = OpTypeFunction %void
%h = OpConstant %float 0.75
%scale = OpConstantComposite %v2 %h %h
%eye = OpConstantComposite %v3 %h %h %h
%imported = OpFunction %v2 None %offset
%a = OpFunctionParameter %float
%b = OpFunctionParameter %v2
%c = OpFunctionParameter %v2
%d = OpFunctionParameter %v3
OpFunctionEnd
%main = OpFunction %void None %entry
%label = OpLabel
%result = OpFunctionCall %v2 %imported %h %scale %scale %eye
OpReturn
OpFunctionEnd
"#;

#[test]
fn spirv_is_valid_and_links_by_name() {
    if !has_tools() {
        return;
    }
    let folder = TempDir::new().unwrap();
    let paths = export(folder.path(), ShaderLanguage::Spirv).unwrap();
    let names: Vec<&str> = paths.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
    for (name, file) in names.iter().zip(LIBRARY) {
        run(folder.path(), "spirv-val", &[name]).unwrap_or_else(|error| panic!("{name}: {error}"));
        let text = run(folder.path(), "spirv-dis", &[name]).unwrap();
        for function in file.functions() {
            let export = format!("LinkageAttributes \"{function}\" Export");
            assert!(text.contains(&export), "{name} does not export {function}");
        }
        // The source goes with it, and its first lines say what it is.
        assert!(text.contains(&format!("of the shader library of texbake {}", env!("CARGO_PKG_VERSION"))));
    }
    let all = [&["--create-library", "-o", "all.spv"][..], &names].concat();
    run(folder.path(), "spirv-link", &all).unwrap();
    run(folder.path(), "spirv-val", &["all.spv"]).unwrap();

    std::fs::write(folder.path().join("main.spvasm"), IMPORTER).unwrap();
    run(folder.path(), "spirv-as", &["--target-env", "spv1.0", "main.spvasm", "-o", "main.spv"]).unwrap();
    run(folder.path(), "spirv-link", &["main.spv", "welsh_offset.spv", "-o", "linked.spv"]).unwrap();
    run(folder.path(), "spirv-val", &["--target-env", "vulkan1.0", "linked.spv"]).unwrap();
    // Sabotage: the name that is imported is in no other file; and a module that is cut off is none.
    assert!(run(folder.path(), "spirv-link", &["main.spv", "lighting.spv", "-o", "no.spv"]).is_err());
    let bytes = std::fs::read(folder.path().join("welsh_offset.spv")).unwrap();
    std::fs::write(folder.path().join("cut.spv"), &bytes[..bytes.len() - 4]).unwrap();
    assert!(run(folder.path(), "spirv-val", &["cut.spv"]).is_err());
}

/// In every text language: the function once, by its name, and its arguments by theirs unless they are keywords.
#[test]
fn names_survive_translation() {
    let arguments = |text: &str, function: &str| -> Vec<String> {
        let head = format!("{function}(");
        let starts: Vec<_> = text.match_indices(&head).map(|(at, _)| at).collect();
        // Of calls and declarations the first is the declaration.
        let rest = &text[starts.first().unwrap_or_else(|| panic!("no {function}")) + head.len()..];
        let list = rest.split(')').next().unwrap();
        list.split(',').filter_map(|one| one.split_whitespace().last().map(str::to_owned)).collect()
    };
    for file in LIBRARY {
        for function in file.functions() {
            let wgsl = file.wgsl.split(&format!("fn {function}(")).nth(1).unwrap().split("->").next().unwrap();
            let wgsl: Vec<&str> = wgsl.split(':').map(|part| part.rsplit([',', ' ', '\n']).next().unwrap()).collect();
            let names: Vec<&str> = wgsl[..wgsl.len() - 1].to_vec();
            for language in [ShaderLanguage::Glsl, ShaderLanguage::Hlsl, ShaderLanguage::Msl] {
                let text = text_in(&file, language);
                let text = text.replace("<float, metal::access::sample>", "");
                let body = text.split("#define").nth(1).unwrap();
                let mut wanted = names.clone();
                if language == ShaderLanguage::Glsl {
                    wanted.retain(|name| *name != "map_sampler");
                }
                assert_eq!(arguments(body, function), wanted, "{} in {language}", function);
            }
        }
    }
}

/// Each file says what it is, of which version, and its source; in characters that every compiler reads.
#[test]
fn headers_stay_with_the_text() {
    let sources = ["7.44", "7.45", "Schueler", "Hegde", "Welsh", "7.50", "7.52", "by bisection"];
    for (file, source) in LIBRARY.iter().zip(sources) {
        for language in [ShaderLanguage::Glsl, ShaderLanguage::Hlsl, ShaderLanguage::Msl] {
            let text = text_in(file, language);
            let version = env!("CARGO_PKG_VERSION");
            let first = format!("// {}, of the shader library of texbake {version};", file.file_name(language));
            assert!(text.starts_with(&first) && text.is_ascii(), "{}", file.name);
            assert!(text.contains(source), "{}: no {source}", file.name);
            assert!(!text.contains("void main") && !text.contains("#version") && !text.contains("ZeroValue"));
        }
        let wgsl = text_in(file, ShaderLanguage::Wgsl);
        assert!(
            // Some compilers read ASCII alone, comments too.
            wgsl.is_ascii()
                && wgsl.ends_with(file.wgsl)
                && wgsl.starts_with(&format!("// {}.wgsl, of the shader library", file.name))
        );
        naga::front::wgsl::parse_str(&wgsl).unwrap();
    }
    let all: String = LIBRARY.iter().map(|file| text_in(file, ShaderLanguage::Wgsl)).collect();
    naga::front::wgsl::parse_str(&all).expect("all of them are one module");
}
