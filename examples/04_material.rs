//! The normal map and the parallax map of a material in one pass, and a detail blended over the normal map.
//!
//!     cargo run --release --example 04_material

use texbake::{
    BakeOptions, Baker, BlendInputs, BlendMethod, BlendOptions, Encoding, Grid, HeightMap, NormalFormat, NormalOptions,
    ParallaxFormat, Scale,
};

fn main() -> texbake::Result<()> {
    let baker = Baker::auto();
    let bricks = HeightMap::read("examples/textures/walls/bricks_height.png")?;
    let options = BakeOptions {
        scale: Scale::texels(24),
        normal: Some(NormalFormat::default()),
        // A PNG has no signed numbers: 128 is zero.
        parallax: Some(ParallaxFormat { encoding: Encoding::Biased, ..Default::default() }),
        ..Default::default()
    };
    let maps = baker.bake(&bricks, &options)?;

    // Fine grain, repeated over the bricks at half its strength.
    let grain = HeightMap::from(Grid::from_fn(64, 64, |x, y| ((x * 73) ^ (y * 151)) as u8 % 32)?);
    let grain = baker.normal(&grain, &NormalOptions { scale: Scale::texels(4), ..Default::default() })?;
    let (Some(normals), Some(parallax)) = (maps.normal, maps.parallax) else { unreachable!("both were asked for") };
    let method = BlendMethod::Weighted { base: 1.into(), detail: "1/2".parse()? };
    let inputs = BlendInputs { base: &normals, detail: &grain, mask: None };
    let blended = baker.blend(&inputs, &BlendOptions { method, tile: true, ..Default::default() })?;

    blended.write("bricks_normal.png")?;
    parallax.write("bricks_parallax.png")?;
    println!("{} texels on {}", blended.size(), baker.name());
    Ok(())
}
