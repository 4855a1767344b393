//! Heights that a program computes, as a 16-bit map with green down, and the same map from every backend.
//!
//!     cargo run --release --example 02_own_heights

use texbake::{Baker, CodesRef, Convention, Depth, Grid, HeightMap, NormalFormat, NormalOptions, Scale, devices};

fn main() -> texbake::Result<()> {
    // Ripples around the centre, in texels: no scale is needed.
    let ripples = Grid::from_fn(256, 256, |x, y| {
        let distance = (x as f32 - 127.5).hypot(y as f32 - 127.5);
        4.0 * (distance * 0.25).cos()
    })?;
    let heights = HeightMap::try_from(ripples)?;
    let options = NormalOptions {
        scale: Scale::texels(1),
        format: NormalFormat { depth: Depth::Bits16, convention: Convention::Dx, ..Default::default() },
        ..Default::default()
    };
    let normals = Baker::cpu().normal(&heights, &options)?;
    let CodesRef::U16(codes) = normals.codes() else { unreachable!("16 bits were asked for") };
    println!("the texel at the left of the centre row is {:?}", &codes[128 * 256 * 3..][..3]);

    for device in devices().iter().filter(|device| device.api != "cpu" && device.self_test.is_ok()) {
        let name = format!("{}:{}", device.api, device.name);
        let same = Baker::gpu(Some(&name))?.normal(&heights, &options)? == normals;
        println!("{name}: {}", if same { "the same bytes" } else { "other bytes: a bug" });
    }
    Ok(())
}
