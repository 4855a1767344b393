//! SPIR-V that a linker joins with a shader's own.

use super::translate::parsed;
use crate::shading::ShaderFile;
use naga::back::spv::{self, DebugInfo, SourceLanguage, WriterFlags};
use rspirv::binary::Assemble;
use rspirv::dr::{self, Instruction, Operand};
use rspirv::spirv::{Decoration, LinkageType, Op};

/// A module whose functions are exported under their names (`LinkageAttributes`), and which holds its WGSL. naga declares
/// the capability, as of every module without entry points.
pub(super) fn spirv(file: &ShaderFile, title: &str) -> Vec<u8> {
    let source = format!("{title}//\n{}", file.wgsl);
    let (module, info) = parsed(&source);
    let file_name = format!("{}.wgsl", file.name);
    let options = spv::Options {
        lang_version: (1, 0),
        flags: WriterFlags::DEBUG,
        force_loop_bounding: false,
        // Older tools stop at the number of WGSL.
        debug_info: Some(DebugInfo { source_code: &source, file_name: &file_name, language: SourceLanguage::Unknown }),
        ..Default::default()
    };
    let words = spv::write_vec(&module, &info, &options, None).expect("the library has nothing that SPIR-V has not");
    let mut module = dr::load_words(words).expect("naga writes SPIR-V");
    remove_lines(&mut module);
    export_functions(&mut module);
    bytemuck::cast_slice(&module.assemble()).to_vec()
}

/// Without the lines of instructions: some linkers do not renumber what they refer to.
fn remove_lines(module: &mut dr::Module) {
    for block in module.functions.iter_mut().flat_map(|function| &mut function.blocks) {
        block.instructions.retain(|instruction| instruction.class.opcode != Op::Line);
    }
}

fn export_functions(module: &mut dr::Module) {
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
