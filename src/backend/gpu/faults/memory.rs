//! A device whose memory is short: it takes less at a time, down to one row, and then the CPU takes over.

use super::{Job, bakers, jobs, lavapipe, lavapipe_below, opened, tangents};
use crate::Baker;
use crate::backend::gpu::bake as device_bake;
use crate::backend::gpu::device::Device;
use crate::backend::gpu::lock::lock;
use crate::backend::gpu::operation::Doubt;
use crate::map::{Edge, Edges, Grid, HeightMap, NormalFormat, NormalMap};
use crate::ops::bake::{BakeOptions, BakePlan, NormalOptions};
use crate::ops::tangents::TangentMethod;
use crate::stream::{MapBands, MapSink};
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use wgpu::{DeviceDescriptor, MemoryBudgetThresholds, MemoryHints};

/// Rows of 100 texels.
fn normal_map(height: usize) -> Job {
    let heights: HeightMap = Grid::from_fn(100, height, |x, y| (x * x / 7 + 29 * y) as u8).unwrap().into();
    let options = NormalOptions { edges: Edges::both(Edge::Clamp), ..Default::default() };
    Job::new("normal map", "bake", move |baker: &Baker| Ok(baker.normal(&heights, &options)?.codes().bytes().to_vec()))
}

/// Bytes of the inputs and outputs of so many rows of it: heights and one row on either side, codes, a mark for each.
fn bytes_of(rows: u64) -> u64 {
    100 * (rows + 2) + 300 * rows + 4 * rows
}

/// Refuses memory for more than so many bytes at once, and tells what was asked for.
fn refuse_above(device: &Device, most: u64) -> Arc<Mutex<Vec<u64>>> {
    let asked = Arc::new(Mutex::new(Vec::new()));
    let ask = asked.clone();
    *lock(&device.refuse) = Some(Box::new(move |bytes| {
        lock(&ask).push(bytes);
        bytes > most
    }));
    asked
}

#[test]
fn a_band_is_halved_until_there_is_room() {
    for (rows, dispatches) in
        [(63, vec![32, 32]), (31, vec![16; 4]), (8, vec![8; 8]), (7, vec![4; 16]), (1, vec![1; 64])]
    {
        let Some(device) = lavapipe() else { return };
        refuse_above(&device, bytes_of(rows));
        let (gpu, _, alone) = bakers(device);
        let job = normal_map(64);
        assert!((job.run)(&alone).unwrap() == job.expected(), "room for {rows} rows");
        let submitted: Vec<usize> = gpu.device.pace.submitted("bake").iter().map(|texels| texels / 100).collect();
        assert_eq!(submitted, dispatches, "room for {rows} rows");
    }
}

#[test]
fn without_room_for_a_row_the_cpu_takes_over() {
    let job = normal_map(64);
    let Some(device) = lavapipe() else { return };
    let asked = refuse_above(&device, 0);
    let (gpu, relieved, alone) = bakers(device);
    let error = (job.run)(&alone).unwrap_err().to_string();
    assert!(error.starts_with("vulkan:llvmpipe") && error.contains("memory"), "{error}");
    assert_eq!(*lock(&asked), [64, 32, 16, 8, 4, 2, 1].map(bytes_of));
    assert!((job.run)(&relieved).unwrap() == job.expected());

    // It is not lost for that: the next job may find memory.
    *lock(&gpu.device.refuse) = None;
    assert!((job.run)(&alone).unwrap() == job.expected());
}

#[test]
fn what_earlier_jobs_hold_is_freed_before_a_row_is_given_up() {
    let Some(device) = lavapipe() else { return };
    refuse_above(&device, bytes_of(1));
    let (gpu, _, alone) = bakers(device);
    (normal_map(3).run)(&alone).unwrap();
    assert!(gpu.device.free_slots(), "slots are kept");
    (normal_map(3).run)(&alone).unwrap();
    let mut refusals = 1;
    *lock(&gpu.device.refuse) = Some(Box::new(move |_| std::mem::replace(&mut refusals, 0) > 0));
    let job = Job::new("one wide row", "bake", |baker: &Baker| {
        let heights: HeightMap = Grid::from_fn(5000, 1, |x, _| (x * x / 7) as u8).unwrap().into();
        Ok(baker.normal(&heights, &NormalOptions::default())?.codes().bytes().to_vec())
    });
    assert!((job.run)(&alone).unwrap() == job.expected());
}

#[test]
fn any_operation_runs_in_little_memory_or_on_the_cpu() {
    for job in jobs() {
        for most in [3000, 0] {
            let Some(device) = lavapipe() else { return };
            refuse_above(&device, most);
            let (gpu, relieved, alone) = bakers(device);
            assert!((job.run)(&relieved).unwrap() == job.expected(), "{}: {most} bytes", job.name);
            let alone = (job.run)(&alone);
            assert_eq!(alone.is_ok(), most > 0, "{}: {:?}", job.name, alone.map(drop));
            assert_eq!(gpu.device.pace.submitted(job.entry_point).len() > 1, most > 0, "{}", job.name);
        }
    }
}

#[test]
fn parts_of_a_mesh_are_halved_until_there_is_room() {
    let job = tangents(TangentMethod::Lengyel);
    let Some(device) = lavapipe() else { return };
    let asked = refuse_above(&device, 6000);
    let (gpu, _, alone) = bakers(device);
    assert!((job.run)(&alone).unwrap() == job.expected());
    let asked = lock(&asked);
    let refused = asked.iter().filter(|bytes| **bytes > 6000).count();
    assert!(refused > 0 && asked.iter().skip(refused).all(|bytes| *bytes <= 6000), "{asked:?}");
    assert!(asked[..refused].windows(2).all(|pair| pair[1] < pair[0]), "{asked:?}");
    assert!(gpu.device.pace.submitted("tangents").len() > 1);
}

/// Drivers that tell no budget (VK_EXT_memory_budget) ignore thresholds, and do the job.
#[test]
fn thresholds_of_a_budget_end_in_an_error_or_in_right_bytes() {
    let (creation, loss) = (|percent| (Some(percent), None), |percent| (None, Some(percent)));
    for (for_resource_creation, for_device_loss) in [creation(0), creation(1), loss(0)] {
        let thresholds = MemoryBudgetThresholds { for_resource_creation, for_device_loss };
        let Some(adapter) = lavapipe_below(thresholds) else { return };
        // Blocks of no more than 8 MiB are taken at once.
        let descriptor = DeviceDescriptor { memory_hints: MemoryHints::MemoryUsage, ..Default::default() };
        let Ok(device) = opened(&adapter, &descriptor) else { continue };
        let (_gpu, relieved, alone) = bakers(device);
        let job = normal_map(20_000);
        match (job.run)(&alone) {
            Ok(bytes) => assert!(bytes == job.expected(), "{thresholds:?}"),
            Err(error) => assert!(error.to_string().contains("memory"), "{thresholds:?}: {error}"),
        }
        assert!((job.run)(&relieved).unwrap() == job.expected(), "{thresholds:?}");
    }
}

/// What lavapipe takes it takes from the process: a process of its own that may not grow, by prlimit of util-linux.
#[cfg(target_os = "linux")]
#[test]
fn memory_that_the_system_refuses_the_driver_is_done_without() {
    const CHILD: &str = "TEXBAKE_TEST_IN_LITTLE_MEMORY";
    if std::env::var_os(CHILD).is_some() {
        return bake_in_little_memory();
    }
    if lavapipe().is_none() {
        return;
    }
    let name = "backend::gpu::faults::memory::memory_that_the_system_refuses_the_driver_is_done_without";
    let mut child = Command::new(std::env::current_exe().unwrap());
    let child = child.args([name, "--exact", "--nocapture"]).env(CHILD, "1").output().unwrap();
    let said = String::from_utf8_lossy(&[child.stdout, child.stderr].concat()).into_owned();
    assert!(child.status.success() && said.contains("1 passed"), "{said}");
}

#[cfg(target_os = "linux")]
fn bake_in_little_memory() {
    let mut device = lavapipe().expect("as the parent has it");
    device.pace.longest = Duration::MAX;
    let heights: HeightMap = Grid::from_fn(4096, 2048, |x, y| (x * x / 7 + 29 * y) as u8).unwrap().into();
    let plan = BakePlan::new(&BakeOptions::default(), heights.size(), heights.height_type()).unwrap();
    let expected = Baker::cpu().normal(&heights, &NormalOptions::default()).unwrap();
    let bake = |device: &Device, map: &mut NormalMap, rows| {
        let mut bands = MapBands::new(&heights, plan.edges.y, rows);
        device_bake::run(device, &plan, Doubt::Near, &mut bands, &mut [&mut MapSink::new(map.codes_mut(), 3 * 4096)])
            .unwrap();
        assert!(*map == expected, "bands of {rows} rows");
    };
    let mut map = NormalMap::zeroed(plan.size, NormalFormat::default());
    // The driver compiles and starts its threads.
    bake(&device, &mut map, 64);
    assert!(device.free_slots());
    map.codes_mut().bytes_mut().fill(0xa5);

    // wgpu has taken one block of 64 MiB, and the next one is larger than what the process may have: there is room for
    // two slots of 682 rows, 21 MiB each, and not for three.
    let before = device.pace.submitted("bake").len();
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap();
    let pages: u64 = pages.split(' ').next().unwrap().parse().unwrap();
    let limit = pages * 4096 + (48 << 20);
    let arguments = ["--pid", &std::process::id().to_string(), &format!("--as={limit}:")].map(String::from);
    if !Command::new("prlimit").args(arguments).status().is_ok_and(|status| status.success()) {
        return println!("not tested: no prlimit");
    }
    bake(&device, &mut map, 682);
    let rows: Vec<usize> = device.pace.submitted("bake")[before..].iter().map(|texels| texels / 4096).collect();
    assert_eq!(rows, [682, 682, 341, 341, 2]);
}
