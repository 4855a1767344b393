//! A height map file to a normal map file.
//!
//!     cargo run --release --example 01_bake

use texbake::{Baker, HeightMap, NormalOptions, Scale};

fn main() -> texbake::Result<()> {
    let baker = Baker::auto();
    let heights = HeightMap::read("examples/textures/walls/bricks_height.png")?;
    let options = NormalOptions { scale: Scale::texels(24), ..Default::default() };
    let normals = baker.normal(&heights, &options)?;
    normals.write("bricks_normal.png")?;
    println!("{} texels on {} ({})", normals.size(), baker.name(), baker.reason());
    Ok(())
}
