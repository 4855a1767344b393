//! Whether the driver's unit is what the header of this bench says: kernels that differ by a known number of instructions.

use crate::part::Part;
use crate::radv::Radv;
use crate::spirv;
use texbake::gpu::KernelVariant;

/// Instructions by which the two kernels of a pair differ.
const MORE: u64 = 512;

/// Fails unless [`MORE`] instructions of either kind cost what the part says.
pub fn check(radv: &Radv, part: &Part) -> Result<(), String> {
    for (what, step, cycles) in [
        ("f32 products", "x = x * y;", part.full_rate),
        ("u32 products", "x = bitcast<f32>(bitcast<u32>(x) * bitcast<u32>(x));", part.product),
    ] {
        let [short, long] = [MORE, 2 * MORE].map(|steps| {
            let words = spirv::of(&chain(step, steps as usize))?;
            let statistics = radv.compile(&words, "chain", false)?;
            let number = |name: &str| statistics.get(name).copied().ok_or_else(|| format!("no {name}"));
            Ok::<_, String>([number("Instructions")?, number("Inverse Throughput")?])
        });
        let ([instructions, throughput], [more_instructions, more_throughput]) = (short?, long?);
        let found = [more_instructions - instructions, more_throughput - throughput];
        // A long kernel has a few instructions more, which wait.
        if !(MORE..MORE + 8).contains(&found[0]) || found[1] != MORE * cycles {
            return Err(format!(
                "{MORE} more {what} are {} more instructions and {} more of the driver's unit, not {}: \
                 the unit is another than thought",
                found[0],
                found[1],
                MORE * cycles
            ));
        }
    }
    Ok(())
}

/// A kernel that does one thing so many times, each with the result of the one before.
fn chain(step: &str, steps: usize) -> KernelVariant {
    let wgsl = format!(
        "@group(0) @binding(1) var<storage, read> inputs: array<f32>;
         @group(0) @binding(2) var<storage, read_write> outputs: array<f32>;
         @compute @workgroup_size(64, 1, 1)
         fn chain(@builtin(global_invocation_id) id: vec3<u32>) {{
             var x = inputs[id.x];
             let y = inputs[id.y];
             {}
             outputs[id.x] = x;
         }}",
        step.repeat(steps)
    );
    KernelVariant {
        name: "chain".into(),
        wgsl,
        entry_point: "chain",
        constants: Vec::new(),
        item: "invocation",
        items_per_invocation: 1,
        bytes_read: 8.0,
        bytes_written: 4.0,
    }
}
