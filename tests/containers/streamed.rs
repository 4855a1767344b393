//! What is written while it is baked has the bytes of the file that maps in memory are written to.

use super::made::{CONTAINERS, KINDS, Kind, write_at_once};
use crate::io::support::Folder;
use crate::stream::MemorySource;
use crate::support::{EDGES, Random, map_f32, map_u8, map_u16, scale};
use texbake::io::{WriteOptions, create_normals_with, create_roughness_with};
use texbake::stream::{HeightRows, MapOut, Monitor};
use texbake::{
    BakeOptions, Baker, CodesRef, Edge, Edges, Filter, HeightMap, Maps, NormalFormat, RoughnessOptions, Size,
};

/// Bakes rows into a file of this kind, and compares it with the maps of the same heights in memory.
fn assert_streams(baker: &Baker, folder: &Folder, kind: Kind, container: &str, map: &HeightMap, edges: Edges) {
    let parallax = kind.normal().is_none().then(|| kind.parallax());
    let scale = scale("7/2");
    let options =
        BakeOptions { scale, filter: Filter::Scharr, edges, normal: kind.normal(), parallax, ..Default::default() };
    let levels = Baker::reference().bake_levels(map, &options).unwrap();
    let normal = levels.normal.iter().flatten().map(|level| level.codes());
    let codes: Vec<CodesRef<'_>> = normal.chain(levels.parallax.iter().flatten().map(|level| level.codes())).collect();
    let size = (map.size().width(), map.size().height());
    let [expected, streamed] = ["expected", "streamed"].map(|name| folder.path(&format!("{name}.{container}")));
    for mips in [false, true] {
        write_at_once(kind.create(&expected, size, mips).unwrap(), &codes[..if mips { codes.len() } else { 1 }]);
        let open = || Ok(Box::new(MemorySource::new(map.clone())) as HeightRows);
        let create = |_: Size| {
            let file = kind.create(&streamed, size, mips)?;
            let none = Maps::<MapOut>::default();
            Ok(if parallax.is_some() {
                Maps { parallax: Some(file), ..none }
            } else {
                Maps { normal: Some(file), ..none }
            })
        };
        baker.bake_rows(&open, &create, &options, &Monitor::default()).unwrap();
        let [expected, streamed] = [&expected, &streamed].map(|path| std::fs::read(path).unwrap());
        assert!(streamed == expected, "{} in {container}, {edges}, mips {mips}", kind.name());
    }
}

/// Three bands of the reference, the last of which is short, as are the last blocks.
#[test]
fn every_kind_and_edge() {
    let (folder, mut random) = (Folder::new(), Random::new(76));
    let maps = [
        map_u8(13, 139, |_, _| random.bits() as u8),
        map_u16(13, 139, |_, _| random.bits() as u16),
        map_f32(13, 139, |_, _| random.below(1000) as f32 / 999.0),
    ];
    // Every type of heights meets every pair of edges.
    let columns_and_maps = EDGES.into_iter().flat_map(|x| maps.iter().map(move |map| (x, map)));
    let mut columns_and_maps = columns_and_maps.flat_map(|pair| [pair; 3]).cycle();
    for kind in KINDS {
        for container in CONTAINERS {
            for y in EDGES {
                let (x, map) = columns_and_maps.next().unwrap();
                assert_streams(&Baker::reference(), &folder, kind, container, map, Edges { x, y });
            }
        }
    }
}

/// A single texel has all mip levels, and loses nothing: its roughness is the base, 255/2 rounded.
#[test]
fn a_single_texel() {
    let folder = Folder::new();
    let [normal, rough] = ["n.dds", "r.dds"].map(|name| folder.path(name));
    let base = "0.5".parse().unwrap();
    let roughness = RoughnessOptions { base, ..Default::default() };
    let options = BakeOptions { roughness: Some(roughness), ..Default::default() };
    let write = WriteOptions { mips: true, ..Default::default() };
    let create = |size: Size| {
        let normal = Some(create_normals_with(&normal, size, NormalFormat::default(), &write)?);
        let roughness = Some(create_roughness_with(&rough, size, roughness.format, &write)?);
        Ok(Maps { normal, parallax: None, roughness })
    };
    let open = || Ok(Box::new(MemorySource::new(map_u8(1, 1, |_, _| 99))) as HeightRows);
    Baker::cpu().bake_rows(&open, &create, &options, &Monitor::default()).unwrap();
    assert_eq!(
        [normal, rough].map(|path| std::fs::read(path).unwrap()[148..].to_vec()),
        [vec![128, 128, 255, 255], vec![128],]
    );
}

/// Maps of several bands and strips, on all threads.
#[test]
fn many_bands() {
    let (folder, mut random) = (Folder::new(), Random::new(77));
    let map = map_u16(1030, 601, |x, y| (40 * x + 70 * y) as u16 ^ (random.bits() as u16 & 1023));
    // Texels of four codes, BC4, BC5 and BC7.
    for (at, kind) in [2, 18, 22, 25].into_iter().enumerate() {
        let edges = Edges { x: Edge::Clamp, y: [Edge::Wrap, Edge::Mirror][at % 2] };
        assert_streams(&Baker::cpu(), &folder, KINDS[kind], CONTAINERS[at % 2], &map, edges);
    }
}
