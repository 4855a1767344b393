//! SPIR-V that a linker joins with a shader's own.

use super::translate::parsed;
use crate::shading::ShaderFile;
use naga::back::spv::{self, DebugInfo, SourceLanguage, WriterFlags};
use rspirv::binary::Assemble;
use rspirv::dr::{self, Instruction, Operand};
use rspirv::spirv::{Capability, Decoration, LinkageType, Op};

/// A module whose functions are exported under their names (`LinkageAttributes`), and which holds its WGSL.
pub(super) fn spirv(file: &ShaderFile, title: &str) -> Vec<u8> {
    let (module, info) = parsed(file.wgsl);
    let source = format!("{title}//\n{}", file.wgsl);
    let file_name = format!("{}.wgsl", file.name);
    let options = spv::Options {
        lang_version: (1, 0),
        flags: WriterFlags::DEBUG,
        force_loop_bounding: false,
        debug_info: Some(DebugInfo { source_code: &source, file_name: &file_name, language: SourceLanguage::WGSL }),
        ..Default::default()
    };
    let words = spv::write_vec(&module, &info, &options, None).expect("the library has nothing that SPIR-V has not");
    let mut module = dr::load_words(words).expect("naga writes SPIR-V");
    export_functions(&mut module);
    bytemuck::cast_slice(&module.assemble()).to_vec()
}

fn export_functions(module: &mut dr::Module) {
    let linkage = Instruction::new(Op::Capability, None, None, vec![Operand::Capability(Capability::Linkage)]);
    module.capabilities.push(linkage);
    let ids: Vec<_> = module.functions.iter().filter_map(|function| function.def.as_ref()?.result_id).collect();
    // OpName id "name".
    let named = module.debug_names.iter().filter_map(|instruction| match &instruction.operands[..] {
        [id @ Operand::IdRef(word), Operand::LiteralString(name)] if ids.contains(word) => {
            Some((id.clone(), name.clone()))
        }
        _ => None,
    });
    let exports = named.map(|(id, name)| {
        let linkage = Operand::LinkageType(LinkageType::Export);
        let operands =
            vec![id, Operand::Decoration(Decoration::LinkageAttributes), Operand::LiteralString(name), linkage];
        Instruction::new(Op::Decorate, None, None, operands)
    });
    module.annotations.extend(exports);
}
