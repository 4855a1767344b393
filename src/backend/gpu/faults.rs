//! Faults, really caused: each must end as an error that says what happened, and none with a wrong row.

use super::device::Device;
use super::kernel::BAKE_INTEGERS;
use super::operation::Doubt;
use super::{Untested, adapters, bake as device_bake};
use crate::backend::Backend;
use crate::error::Result;
use crate::map::{Edge, Grid, HeightMap, HeightType, NormalFormat, NormalMap, ParallaxFormat, ParallaxMap, Size};
use crate::ops::bake::{BakeOptions, BakePlan};
use crate::stream::{HeightBand, HeightBands, MapBands, MapSink};

/// Lavapipe; `None` where it is not installed.
fn lavapipe() -> Option<Device> {
    let Ok(adapter) = adapters::select(Some("vulkan:llvmpipe")) else {
        assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none_or(|value| value != "1"), "no lavapipe");
        println!("not tested: no lavapipe");
        return None;
    };
    Some(Device::open(&adapter).unwrap())
}

fn map() -> HeightMap {
    Grid::from_fn(50, 40, |x, y| (x * y % 251) as u8).unwrap().into()
}

fn plan(map: &HeightMap) -> BakePlan {
    let options = BakeOptions { parallax: Some(ParallaxFormat::default()), ..Default::default() };
    BakePlan::new(&options, map.size(), map.height_type()).unwrap()
}

/// Bakes a normal and a parallax map in bands of eight rows; before each band `before` is told which one it is.
fn bake(device: &Device, before: impl FnMut(usize)) -> Result<(NormalMap, ParallaxMap)> {
    struct Told<'a, F> {
        bands: MapBands<'a>,
        count: usize,
        before: F,
    }
    impl<F: FnMut(usize)> HeightBands for Told<'_, F> {
        fn next(&mut self) -> Result<Option<HeightBand<'_>>> {
            (self.before)(self.count);
            self.count += 1;
            self.bands.next()
        }
    }
    let map = map();
    let plan = plan(&map);
    let mut normal = NormalMap::zeroed(plan.size, NormalFormat::default());
    let mut bands = Told { bands: MapBands::new(&map, Edge::Wrap, 8), count: 0, before };
    let mut parallax = ParallaxMap::zeroed(plan.size, ParallaxFormat::default());
    let normal_sink = &mut MapSink::new(normal.codes_mut(), 3 * plan.size.width());
    let parallax_sink = &mut MapSink::new(parallax.codes_mut(), plan.size.width());
    device_bake::run(device, &plan, Doubt::Near, &mut bands, &mut [normal_sink, parallax_sink])?;
    Ok((normal, parallax))
}

#[test]
fn rows_that_were_not_computed_are_noticed() {
    for (what, from, to, row) in [
        ("no row", "if (MARKED && ", "if (false && MARKED && ", 0),
        ("all but one row", "if (MARKED && ", "if (row != 5u && MARKED && ", 5),
        ("a mark of another dispatch", "= params.nonce;", "= params.nonce - 2u;", 0),
    ] {
        let Some(device) = lavapipe() else { return };
        let text = BAKE_INTEGERS.text();
        assert!(text.contains(from), "{what}");
        device.substitute(BAKE_INTEGERS, &text.replacen(from, to, 1));
        let error = bake(&device, |_| ()).expect_err(what).to_string();
        assert!(error.ends_with(&format!(": row {row} of a band came back without having been computed")), "{error}");
    }
}

#[test]
fn a_device_lost_between_bands_is_an_error_then_and_later() {
    for lost_before in [0, 1, 3, 5] {
        let Some(device) = lavapipe() else { return };
        let error = bake(&device, |band| {
            if band == lost_before {
                device.device.destroy();
            }
        });
        let first = error.expect_err("a lost device").to_string();
        assert!(first.starts_with("vulkan:llvmpipe"), "{first}");
        let again = bake(&device, |_| ()).expect_err("still lost").to_string();
        assert!(first.contains("lost") && again.contains("lost"), "before band {lost_before}: {first}; {again}");
    }
}

#[test]
fn rows_too_wide_for_the_device_are_refused() {
    let Some(device) = lavapipe() else { return };
    let gpu = Untested { device };
    let size = Size::new(65_536 * 256, 1).unwrap();
    let plan = BakePlan::new(&BakeOptions::default(), size, HeightType::U8).unwrap();
    struct NoBands;
    impl HeightBands for NoBands {
        fn next(&mut self) -> Result<Option<HeightBand<'_>>> {
            panic!("no band of a refused map is asked for")
        }
    }
    let mut codes = NormalMap::zeroed(Size::new(1, 1).unwrap(), NormalFormat::default());
    let error = gpu.bake(&plan, &mut NoBands, &mut [&mut MapSink::new(codes.codes_mut(), 3)]).unwrap_err().to_string();
    assert!(error.ends_with("rows of 16777216 texels are too wide for it"), "{error}");
}

#[test]
fn what_wgpu_refuses_is_an_error_of_the_call_that_caused_it() {
    let Some(device) = lavapipe() else { return };
    let too_large = wgpu::BufferDescriptor {
        label: None,
        size: 1 << 60,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    };
    let error = device.guarded(|| Ok(device.device.create_buffer(&too_large))).map(drop).unwrap_err().to_string();
    assert!(error.contains("greater than the maximum buffer size"), "{error}");
    assert!(bake(&device, |_| ()).is_ok(), "the next job does not suffer for it");
}
