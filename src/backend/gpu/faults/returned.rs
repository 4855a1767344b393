//! What comes back from a device is not what it should have computed.

use super::{Job, bakers, jobs, with_buffers_of};
use crate::backend::gpu::device::{Device, Spoil};
use crate::backend::gpu::kernel::BAKE_INTEGERS;
use crate::backend::gpu::lock::lock;
use std::sync::{Arc, Mutex};

/// A device whose buffers are so small that each job takes several of them.
fn device() -> Option<Device> {
    with_buffers_of(4096)
}

/// Jobs on a device that spoils what it returns: told, and left to the CPU.
fn assert_noticed(job: &Job, how: &str, spoil: impl Fn() -> Spoil) {
    let expected = job.expected();
    for falls_back in [true, false] {
        let Some(device) = device() else { return };
        let (gpu, relieved, alone) = bakers(device);
        *lock(&gpu.device.spoil) = Some(spoil());
        if falls_back {
            assert!((job.run)(&relieved).unwrap() == expected, "{how}: {}", job.name);
        } else {
            let error = (job.run)(&alone).map(drop).expect_err(how).to_string();
            assert!(error.contains("came back without having been computed"), "{how}: {}: {error}", job.name);
        }
    }
}

/// Bytes of another buffer, as many as this one has.
fn of_length(mut bytes: Vec<u8>, length: usize) -> Vec<u8> {
    bytes.resize(length, 0);
    bytes
}

#[test]
fn zeros_are_noticed() {
    for job in jobs() {
        assert_noticed(&job, "zeros", || Box::new(|bytes| bytes.fill(0)));
    }
}

#[test]
fn set_bits_are_noticed() {
    for job in jobs() {
        assert_noticed(&job, "ones", || Box::new(|bytes| bytes.fill(0xff)));
    }
}

#[test]
fn what_came_back_before_is_noticed() {
    for job in jobs() {
        assert_noticed(&job, "the part before", || {
            let mut before: Option<Vec<u8>> = None;
            Box::new(move |bytes| {
                let now = bytes.clone();
                if let Some(before) = before.replace(now) {
                    *bytes = of_length(before, bytes.len());
                }
            })
        });
    }
}

#[test]
fn what_an_earlier_job_left_is_noticed() {
    for job in jobs() {
        let Some(device) = device() else { return };
        let (gpu, relieved, alone) = bakers(device);
        let kept = Arc::new(Mutex::new(Vec::new()));
        let keep = kept.clone();
        *lock(&gpu.device.spoil) = Some(Box::new(move |bytes| lock(&keep).push(bytes.clone())));
        let honest = (job.run)(&alone).unwrap();
        assert!(honest == job.expected(), "{}: nothing is spoiled", job.name);
        assert!(lock(&kept).len() > 1, "{}: one part", job.name);

        let mut earlier = std::mem::take(&mut *lock(&kept)).into_iter();
        *lock(&gpu.device.spoil) = Some(Box::new(move |bytes| {
            *bytes = of_length(earlier.next().expect("as many parts"), bytes.len());
        }));
        assert!((job.run)(&relieved).unwrap() == honest, "{}", job.name);
        let error = (job.run)(&alone).unwrap_err().to_string();
        assert!(error.contains("came back without having been computed"), "{}: {error}", job.name);
    }
}

#[test]
fn rows_that_a_kernel_left_out_are_noticed() {
    let job = &jobs()[0];
    for (what, from, to, row) in [
        ("no row", "if (MARKED && ", "if (false && MARKED && ", 0),
        ("all but one row", "if (MARKED && ", "if (row != 5u && MARKED && ", 5),
        ("a mark of another dispatch", "= params.nonce;", "= params.nonce - 2u;", 0),
    ] {
        let Some(device) = device() else { return };
        let text = BAKE_INTEGERS.text();
        assert!(text.contains(from), "{what}");
        device.substitute(BAKE_INTEGERS, &text.replacen(from, to, 1));
        let (_gpu, _, alone) = bakers(device);
        let error = (job.run)(&alone).expect_err(what).to_string();
        assert!(error.ends_with(&format!(": row {row} of a band came back without having been computed")), "{error}");
    }
}
