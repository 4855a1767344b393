//! The kernels held against the host by naga's reflection, and sabotage that must be caught.

use super::input::Input;
use super::kernel::{ALL, BAKE_FLOAT_HEIGHTS, BAKE_FLOATS, BAKE_INTEGERS, Kernel, KernelSource};
use super::operation::{Operation, PARAMS_BYTES, WORKGROUP};
use super::output::Output;
use super::{Device, Gpu, Untested, bake, blend, layer_tests, parallax, self_test, tangent_tests, tangents};
use crate::exact::Scale;
use crate::map::{Depth, Encoding, HeightType, NormalFormat, ParallaxFormat, Size};
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, BakePlan};
use crate::shading::LIBRARY;
use naga::{AddressSpace, ScalarKind, StorageAccess, TypeInner};
use std::collections::BTreeSet;
use std::mem::offset_of;

/// Name, offset and kind of a word of the parameters; `normal.place` is in a struct of its own.
type Word = (String, u32, ScalarKind);

/// What the host has for a parameter.
trait Field {
    fn words(name: &str, offset: u32) -> Vec<Word>;
}

impl Field for u32 {
    fn words(name: &str, offset: u32) -> Vec<Word> {
        vec![(name.into(), offset, ScalarKind::Uint)]
    }
}

impl Field for i32 {
    fn words(name: &str, offset: u32) -> Vec<Word> {
        vec![(name.into(), offset, ScalarKind::Sint)]
    }
}

/// The words of some of a host struct's fields, which `check_params` finds to be all.
macro_rules! words {
    ($struct:ty: $($field:ident)*) => {{
        fn words_of<T: Field>(_: impl Fn($struct) -> T, name: &str, offset: usize) -> Vec<Word> {
            T::words(name, offset as u32)
        }
        [$(words_of(|it: $struct| it.$field, stringify!($field), offset_of!($struct, $field))),*].concat()
    }};
}

impl Field for Output {
    fn words(name: &str, offset: u32) -> Vec<Word> {
        let words = words! {
            Output: place row_words code_m code_c code_least code_greatest code_offset code_mask
        };
        words.into_iter().map(|(word, at, kind)| (format!("{name}.{word}"), offset + at, kind)).collect()
    }
}

impl Field for Input {
    fn words(name: &str, offset: u32) -> Vec<Word> {
        let words = words! {
            Input: place row_words flip factor centre greatest over_greatest green
        };
        words.into_iter().map(|(word, at, kind)| (format!("{name}.{word}"), offset + at, kind)).collect()
    }
}

/// The host's parameters of a kernel, and their bytes.
fn host_params(entry_point: &str) -> (Vec<Word>, usize) {
    match entry_point {
        "bake" => (
            words! {
                bake::Params: width rows above body below row_words west_of_first east_of_last marks nonce
                    px py z_low z_high z_over_m kx ky doubt reserved alpha normal parallax
            },
            size_of::<bake::Params>(),
        ),
        "blend" => (
            words! { blend::Params: width rows marks nonce a b q doubt base detail mask normal },
            size_of::<blend::Params>(),
        ),
        "parallax" => (
            words! {
                parallax::Params: width rows marks nonce doubt reserved_1 reserved_2 reserved_3 heights normals parallax
            },
            size_of::<parallax::Params>(),
        ),
        "frames" | "tangents" => (
            words! {
                tangents::Params: first end nonce positions edges triangles normals offsets corners frames tangents
                    longest_row
            },
            size_of::<tangents::Params>(),
        ),
        other => panic!("the host knows no parameters of {other}"),
    }
}

/// Everything that the host takes for granted about a kernel's text.
fn check(text: &str, entry_point: &str) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    validator().validate(&module).map_err(|error| error.emit_to_string(text))?;

    let [entry] = &module.entry_points[..] else { return Err("not one entry point".into()) };
    if entry.name != entry_point || entry.workgroup_size != [WORKGROUP as u32, 1, 1] {
        return Err(format!("entry point {} with workgroups of {:?}", entry.name, entry.workgroup_size));
    }
    if module.types.iter().any(|(_, ty)| matches!(ty.inner, TypeInner::Atomic(_))) {
        return Err("an atomic".into());
    }
    check_bindings(&module)?;
    check_params(&module, entry_point)
}

/// A file of the shader library is a module of its own: functions alone, for any shader to call.
fn check_pure(text: &str) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    validator().validate(&module).map_err(|error| error.emit_to_string(text))?;
    if module.functions.is_empty() || !module.entry_points.is_empty() || !module.global_variables.is_empty() {
        return Err("not functions alone".into());
    }
    Ok(())
}

fn validator() -> naga::valid::Validator {
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
}

fn check_bindings(module: &naga::Module) -> Result<(), String> {
    let read_write = StorageAccess::LOAD | StorageAccess::STORE;
    let wanted = [
        ("params", AddressSpace::Uniform),
        ("inputs", AddressSpace::Storage { access: StorageAccess::LOAD }),
        ("outputs", AddressSpace::Storage { access: read_write }),
    ];
    let found: Vec<_> = module.global_variables.iter().map(|(_, variable)| variable).collect();
    if found.len() != wanted.len() {
        return Err(format!("{} module variables", found.len()));
    }
    for (binding, (name, space)) in wanted.iter().enumerate() {
        let matches = found.iter().any(|variable| {
            let at = variable.binding.as_ref().map(|at| (at.group, at.binding));
            variable.name.as_deref() == Some(name) && variable.space == *space && at == Some((0, binding as u32))
        });
        if !matches {
            return Err(format!("binding {binding} is not {name}, {space:?}"));
        }
    }
    Ok(())
}

fn check_params(module: &naga::Module, entry_point: &str) -> Result<(), String> {
    let params = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Params")).ok_or("no Params")?.0;
    let kernel = kernel_words(module, params, "", 0);
    let (host, bytes) = host_params(entry_point);
    if kernel != host || module.types[params].inner.size(module.to_ctx()) as usize != bytes || bytes > PARAMS_BYTES {
        return Err(format!("parameters differ: {kernel:?}"));
    }
    Ok(())
}

/// The words of a kernel's struct, with those of the structs in it.
fn kernel_words(module: &naga::Module, ty: naga::Handle<naga::Type>, name: &str, offset: u32) -> Vec<Word> {
    match module.types[ty].inner {
        TypeInner::Scalar(scalar) if scalar.width == 4 => vec![(name.into(), offset, scalar.kind)],
        TypeInner::Struct { ref members, .. } => members
            .iter()
            .flat_map(|member| {
                let own = member.name.as_deref().unwrap_or_default();
                let name = if name.is_empty() { own.into() } else { format!("{name}.{own}") };
                kernel_words(module, member.ty, &name, offset + member.offset)
            })
            .collect(),
        ref other => panic!("a parameter is {other:?}"),
    }
}

#[test]
fn kernels_and_host_agree() {
    for source in ALL {
        check(&source.text(), source.entry_point).unwrap_or_else(|error| panic!("{}: {error}", source.name));
    }
}

#[test]
fn a_kernel_that_differs_from_the_host_is_noticed() {
    let text = ALL[0].text();
    for (what, from, to) in [
        ("two parameters exchanged", "px: i32,", "py_: i32,"),
        ("a parameter of another kind", "rows: u32, ", "rows: i32, "),
        ("a parameter less", "    parallax: Output,\n", ""),
        ("a parameter of an output less", "    code_offset: i32, ", "    //"),
        ("another workgroup", "@workgroup_size(64", "@workgroup_size(32"),
        ("another binding", "@binding(1)", "@binding(3)"),
        ("codes that cannot be written", "storage, read_write", "storage, read"),
        ("an atomic", "const TEXELS", "var<workgroup> total: atomic<u32>;\nconst TEXELS"),
    ] {
        assert!(text.contains(from), "{what}: the kernel has no {from:?}");
        assert!(check(&text.replacen(from, to, 1), ALL[0].entry_point).is_err(), "{what}");
    }
}

#[test]
fn every_file_under_kernels_is_registered() {
    let mut texts: Vec<String> = ALL.iter().map(KernelSource::text).collect();
    texts.push(crate::measure::OFFSET_TIME.into());
    #[cfg(feature = "cli")]
    texts.push(crate::preview::gpu::WGSL.into());
    let mut files = 0;
    let mut folders = vec![std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/kernels"))];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            if path.parent().is_some_and(|folder| folder.ends_with("shading")) {
                check_pure(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                let is_listed =
                    LIBRARY.iter().any(|file| path.ends_with(format!("{}.wgsl", file.name)) && file.wgsl == text);
                assert!(is_listed, "{} is not in the library's list", path.display());
                continue;
            }
            assert!(texts.iter().any(|registered| registered.contains(&text)), "{} is in no kernel", path.display());
            files += 1;
        }
    }
    assert!(files >= ALL.len(), "{files} files");
}

/// A plan for a small map of heights.
fn plan(
    heights: HeightType,
    normal: Option<(Encoding, Depth)>,
    parallax: Option<(Encoding, Depth)>,
    precision: Precision,
) -> BakePlan {
    let normal = normal.map(|(encoding, depth)| NormalFormat { encoding, depth, ..Default::default() });
    let parallax = parallax.map(|(encoding, depth)| ParallaxFormat { encoding, depth });
    let options = BakeOptions { normal, parallax, precision, scale: Scale::texels(3), ..Default::default() };
    BakePlan::new(&options, Size::new(5, 5).unwrap(), heights).unwrap()
}

const UNORM8: Option<(Encoding, Depth)> = Some((Encoding::Unorm, Depth::Bits8));
const SNORM16: Option<(Encoding, Depth)> = Some((Encoding::Snorm, Depth::Bits16));
const HALF: Option<(Encoding, Depth)> = Some((Encoding::Float, Depth::Float16));

#[test]
fn constants_are_overrides_of_their_kernel() {
    let mut kernels = layer_tests::kernels();
    kernels.extend(tangent_tests::kernels());
    for heights in [HeightType::U8, HeightType::U16, HeightType::F32] {
        for (normal, parallax) in [(UNORM8, None), (HALF, None), (None, HALF), (UNORM8, SNORM16), (HALF, UNORM8)] {
            for precision in [Precision::Exact, Precision::Fast] {
                kernels.push(plan(heights, normal, parallax, precision).kernel());
            }
        }
    }
    let mut seen = BTreeSet::new();
    for Kernel { source, constants } in kernels {
        let module = naga::front::wgsl::parse_str(&source.text()).unwrap();
        let overrides: BTreeSet<_> = module.overrides.iter().filter_map(|(_, o)| o.name.clone()).collect();
        let constants: BTreeSet<_> = constants.iter().map(|(name, _)| name.to_string()).collect();
        assert_eq!(constants, overrides, "{}", source.name);
        seen.insert(source.name);
    }
    assert_eq!(seen.len(), ALL.len(), "{seen:?}");
}

#[test]
fn a_device_that_computes_wrong_bytes_fails_its_self_test() {
    let Ok(adapter) = super::adapters::select(Some("vulkan:llvmpipe")) else {
        assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none(), "no lavapipe");
        return eprintln!("skipped: no lavapipe");
    };
    for (source, from, to) in [
        (BAKE_INTEGERS, "let ma = u32(output.code_m) * a", "let ma = u32(output.code_m + 1) * a"),
        (BAKE_INTEGERS, "times96(aa, u32(output.code_m)", "times96(aa, u32(output.code_m + 1)"),
        (BAKE_FLOATS, "let inexact = u32(", "let inexact = 0u * u32("),
        (BAKE_FLOAT_HEIGHTS, "(n + 3u +", "(n + 4u +"),
    ] {
        let text = source.text();
        assert!(text.contains(from), "{}: no {from:?}", source.name);
        let device = Device::open(&adapter).unwrap();
        device.substitute(source, &text.replacen(from, to, 1));
        let error = self_test::run(&device).expect_err(source.name).to_string();
        assert!(error.contains("fails the self-test"), "{}: {error}", source.name);
    }
}

#[test]
fn a_kernel_that_computes_wrong_bytes_is_refused_before_its_first_job() {
    let Ok(adapter) = super::adapters::select(Some("vulkan:llvmpipe")) else {
        assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none(), "no lavapipe");
        return eprintln!("skipped: no lavapipe");
    };
    let exact = |heights, normal, parallax| plan(heights, normal, parallax, Precision::Exact);
    for (plan, from, to) in [
        (exact(HeightType::U8, UNORM8, None), "(output.code_offset - 128)", "(output.code_offset - 127)"),
        (exact(HeightType::U16, SNORM16, None), "let rest = vec4<f32>(t) * root.rest", "let rest = vec4<f32>(t) * 0.0"),
        (exact(HeightType::U16, SNORM16, None), "whole_x, scale, root)", "whole_y, scale, root)"),
        (exact(HeightType::U8, UNORM8, UNORM8), "let a = params.z_over_m * ", "let a = 1u + params.z_over_m * "),
        (exact(HeightType::U16, None, SNORM16), "product(params.z_over_m, ", "product(params.z_over_m + 1u, "),
        (
            exact(HeightType::U8, UNORM8, HALF),
            "nearest_float(PARALLAX_BITS, negative",
            "nearest_float(PARALLAX_BITS, !negative",
        ),
        (exact(HeightType::U16, UNORM8, SNORM16), "nearest_code96(params.parallax, ", "nearest_code96(params.normal, "),
        (
            exact(HeightType::U8, UNORM8, SNORM16),
            "1u, PARALLAX_BITS), four.parallaxes",
            "1u, NORMAL_BITS), four.parallaxes",
        ),
        (exact(HeightType::F32, UNORM8, UNORM8), "min(height, ONE)", "height"),
        (exact(HeightType::F32, None, HALF), "(height & SIGN) != 0u", "false"),
    ] {
        let kernel = plan.kernel();
        let text = kernel.source.text();
        assert!(text.contains(from), "{}: no {from:?}", kernel.source.name);
        self_test::accept_bake(&Device::open(&adapter).unwrap(), &plan).unwrap();
        let device = Device::open(&adapter).unwrap();
        device.substitute(kernel.source, &text.replacen(from, to, 1));
        let gpu = Gpu { untested: Untested { device } };
        let error = gpu.accept_bake(&plan).expect_err(from).to_string();
        assert!(error.contains("fails the self-test: bake: wrong"), "{from}: {error}");
        assert!(!gpu.untested.device.is_tested(&kernel), "{from}");
    }
}
