//! The kernels held against the host by naga's reflection, and sabotage that must be caught.

use super::kernel::{ALL, KernelSource};
use super::normal::{NormalKernel, Params, WORKGROUP};
use super::{Gpu, self_test};
use crate::exact::Scale;
use crate::map::{Channels, Convention, Depth, Encoding, HeightType, NormalFormat, Size};
use crate::ops::Precision;
use crate::ops::bake::{BakePlan, NormalOptions};
use naga::{AddressSpace, ScalarKind, StorageAccess, TypeInner};
use std::collections::BTreeSet;
use std::mem::offset_of;

/// Name, offset and kind of each of the host's parameters.
fn host_params() -> Vec<(String, u32, ScalarKind)> {
    fn kind_of<T: 'static>(_: impl Fn(&Params) -> T) -> ScalarKind {
        match std::any::type_name::<T>() {
            "u32" => ScalarKind::Uint,
            "i32" => ScalarKind::Sint,
            other => panic!("no kernel has a parameter of type {other}"),
        }
    }
    macro_rules! fields {
        ($($field:ident)*) => {
            vec![$((
                stringify!($field).to_string(),
                offset_of!(Params, $field) as u32,
                kind_of(|params: &Params| params.$field),
            )),*]
        };
    }
    fields! {
        width rows above body below row_words west_of_first east_of_last codes codes_row_words marks nonce
        px py z_low z_high kx ky centre outer alpha
        code_m code_c code_least code_greatest code_offset code_mask reserved
    }
}

/// Everything that the host takes for granted about a kernel's text.
fn check(text: &str, entry_point: &str) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    validator.validate(&module).map_err(|error| error.emit_to_string(text))?;

    let [entry] = &module.entry_points[..] else { return Err("not one entry point".into()) };
    if entry.name != entry_point || entry.workgroup_size != [WORKGROUP as u32, 1, 1] {
        return Err(format!("entry point {} with workgroups of {:?}", entry.name, entry.workgroup_size));
    }
    if module.types.iter().any(|(_, ty)| matches!(ty.inner, TypeInner::Atomic(_))) {
        return Err("an atomic".into());
    }
    check_bindings(&module)?;
    check_params(&module)
}

fn check_bindings(module: &naga::Module) -> Result<(), String> {
    let read_write = StorageAccess::LOAD | StorageAccess::STORE;
    let wanted = [
        ("params", AddressSpace::Uniform),
        ("heights", AddressSpace::Storage { access: StorageAccess::LOAD }),
        ("codes", AddressSpace::Storage { access: read_write }),
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

fn check_params(module: &naga::Module) -> Result<(), String> {
    let params = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Params")).ok_or("no Params")?.1;
    let TypeInner::Struct { members, span } = &params.inner else { return Err("Params is no struct".into()) };
    let kernel: Vec<_> = members
        .iter()
        .map(|member| match module.types[member.ty].inner {
            TypeInner::Scalar(scalar) if scalar.width == 4 => {
                (member.name.clone().unwrap_or_default(), member.offset, scalar.kind)
            }
            ref other => panic!("a parameter is {other:?}"),
        })
        .collect();
    if kernel != host_params() || *span as usize != size_of::<Params>() {
        return Err(format!("parameters differ: {kernel:?}"));
    }
    Ok(())
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
        ("a parameter less", "    reserved: u32,\n", ""),
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
    let texts: Vec<String> = ALL.iter().map(KernelSource::text).collect();
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
            assert!(texts.iter().any(|registered| registered.contains(&text)), "{} is in no kernel", path.display());
            files += 1;
        }
    }
    assert!(files >= ALL.len(), "{files} files");
}

#[test]
fn constants_are_overrides_of_their_kernel() {
    let mut seen = BTreeSet::new();
    for depth in [HeightType::U8, HeightType::U16, HeightType::F32] {
        for (encoding, code_depth) in [(Encoding::Unorm, Depth::Bits8), (Encoding::Float, Depth::Float16)] {
            for precision in [Precision::Exact, Precision::Fast] {
                let format =
                    NormalFormat { encoding, depth: code_depth, channels: Channels::Xyz, convention: Convention::Gl };
                let options = NormalOptions { format, precision, scale: Scale::texels(3), ..Default::default() };
                let plan = BakePlan::new(&options.into(), Size::new(5, 5).unwrap(), depth).unwrap();
                let kernel = NormalKernel::new(&plan, 3, true);
                let module = naga::front::wgsl::parse_str(&kernel.source.text()).unwrap();
                let overrides: BTreeSet<_> = module.overrides.iter().filter_map(|(_, o)| o.name.clone()).collect();
                let constants: BTreeSet<_> = kernel.constants().iter().map(|(name, _)| name.to_string()).collect();
                assert_eq!(constants, overrides, "{}", kernel.source.name);
                seen.insert(kernel.source.name);
            }
        }
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
        (ALL[0], "let ma = u32(params.code_m) * a", "let ma = u32(params.code_m + 1) * a"),
        (ALL[0], "u32(params.code_m) * u32(params.code_m)", "u32(params.code_m) * u32(params.code_m + 1)"),
        (ALL[1], "let inexact = u32(", "let inexact = 0u * u32("),
        (ALL[2], "((n >> 3u) & 1u) > 4u", "((n >> 3u) & 1u) > 5u"),
    ] {
        let text = source.text();
        assert!(text.contains(from), "{}: no {from:?}", source.name);
        let gpu = Gpu { device: super::Device::open(&adapter).unwrap() };
        gpu.device.substitute(source, &text.replacen(from, to, 1));
        let error = self_test::run(&gpu.device).expect_err(source.name).to_string();
        assert!(error.contains("fails the self-test"), "{}: {error}", source.name);
    }
}
