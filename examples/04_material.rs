//! A material from two height maps: the bricks' normal and parallax maps in one pass, and cloth blended over the bricks.
//!
//!     cargo run --release --example 04_material

use texbake::{
    BakeOptions, Baker, BlendInputs, BlendOptions, Depth, Encoding, HeightMap, NormalFormat, NormalOptions,
    ParallaxFormat, Scale,
};

fn main() -> texbake::Result<()> {
    let baker = Baker::auto();
    let bricks = HeightMap::read("examples/textures/walls/bricks_height.png")?;
    let cloth = HeightMap::read("examples/textures/cloth/weave_h.png")?;

    // PNG has no signed numbers: biased codes, 128 for zero.
    let parallax = ParallaxFormat { encoding: Encoding::Biased, depth: Depth::Bits8 };
    let normal = NormalFormat::default();
    let (normal, parallax) = (Some(normal), Some(parallax));
    let options = BakeOptions { scale: Scale::texels(24), normal, parallax, ..Default::default() };
    let maps = baker.bake(&bricks, &options)?;
    let base = maps.normal.expect("it was asked for");
    let detail = baker.normal(&cloth, &NormalOptions { scale: Scale::texels(6), ..Default::default() })?;

    // The normal map of the sum of both height maps; the smaller map repeats.
    let inputs = BlendInputs { base: &base, detail: &detail, mask: None };
    let both = baker.blend(&inputs, &BlendOptions { tile: true, ..Default::default() })?;

    base.write("bricks_normal.png")?;
    maps.parallax.expect("it was asked for").write("bricks_parallax.png")?;
    both.write("bricks_and_cloth_normal.png")?;
    println!("{} texels on {}", both.size(), baker.name());
    Ok(())
}
