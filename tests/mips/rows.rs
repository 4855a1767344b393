//! Levels while rows are read and written: the bytes of maps in memory, whatever the bands and their order.

use super::assert_levels;
use crate::stream::MemorySource;
use crate::support::{EDGES, Image, Random, UNORM16, every_baker, map_f32, map_u8, map_u16, options};
use std::sync::{Arc, Mutex};
use texbake::stream::{HeightRows, LevelSink, MapOut, Monitor, RowSink};
use texbake::{
    BakeOptions, Baker, CodesRef, Edge, Edges, HeightMap, Maps, NormalMap, NormalOptions, ParallaxFormat, Result,
    RoughnessMethod, RoughnessOptions, Size,
};

/// The bytes of each level, and how many times each was written.
type Written = Arc<Mutex<Vec<(Vec<u8>, Vec<u8>)>>>;

fn room(size: Size, texel_bytes: usize) -> Written {
    let level = |size: Size| (vec![0; size.texels() * texel_bytes], vec![0; size.texels() * texel_bytes]);
    Arc::new(Mutex::new(size.levels().map(level).collect()))
}

/// A sink of the largest level, and of the others.
struct Sink {
    written: Written,
    widths: Vec<usize>,
    texel_bytes: usize,
    first_row_last: bool,
}

impl Sink {
    fn put(&self, level: usize, first: usize, rows: CodesRef<'_>) {
        let (bytes, times) = &mut self.written.lock().expect("no panic")[level];
        let first = first * self.widths[level] * self.texel_bytes;
        let place = first..first + rows.bytes().len();
        bytes[place.clone()].copy_from_slice(rows.bytes());
        times[place].iter_mut().for_each(|times| *times += 1);
    }
}

impl RowSink for Sink {
    fn held_bytes(&self, _: usize) -> u64 {
        0
    }

    fn takes_first_row_last(&self) -> bool {
        self.first_row_last
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        self.put(0, first, rows);
        Ok(())
    }

    fn complete(&mut self) -> Result<()> {
        assert_eq!(Arc::strong_count(&self.written), 2, "the levels are complete before the file is");
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        Ok(())
    }
}

struct Levels(Sink);

impl LevelSink for Levels {
    fn write(&mut self, level: usize, first: usize, rows: CodesRef<'_>) -> Result<()> {
        assert!(level > 0 && !rows.bytes().is_empty(), "rows of a smaller level");
        self.0.put(level, first, rows);
        Ok(())
    }
}

/// A normal and a roughness map, with levels or without, from rows.
fn bake(
    baker: &Baker,
    map: &HeightMap,
    options: &BakeOptions,
    first_row_last: bool,
    has_levels: bool,
) -> Result<[Written; 3]> {
    let size = map.size();
    let written = [room(size, 6), room(size, 1), room(size, 1)];
    let open = || Ok(Box::new(MemorySource::new(map.clone())) as HeightRows);
    let create = |size: Size| {
        let widths: Vec<usize> = size.levels().map(|size| size.width()).collect();
        let sink = |written: &Written, texel_bytes| {
            let sink = || Sink { written: written.clone(), widths: widths.clone(), texel_bytes, first_row_last };
            let levels = has_levels.then(|| Box::new(Levels(sink())) as Box<dyn LevelSink>);
            MapOut { rows: Box::new(sink()), levels }
        };
        let [normal, parallax, roughness] = &written;
        Ok(Maps {
            normal: Some(sink(normal, 6)),
            parallax: options.parallax.map(|_| sink(parallax, 1)),
            roughness: options.roughness.map(|_| sink(roughness, 1)),
        })
    };
    baker.bake_rows(&open, &create, options, &Monitor::default())?;
    Ok(written)
}

fn bytes<'a>(levels: impl Iterator<Item = CodesRef<'a>>) -> Vec<Vec<u8>> {
    levels.map(|codes| codes.bytes().to_vec()).collect()
}

fn assert_written(what: &str, written: &Written, expected: Vec<Vec<u8>>) {
    let written = written.lock().expect("no panic");
    assert_eq!(written.len(), expected.len(), "{what}");
    for (level, ((bytes, times), expected)) in written.iter().zip(expected).enumerate() {
        assert!(times.iter().all(|times| *times == 1), "{what}, level {level}: {times:?}");
        assert!(*bytes == expected, "{what}, level {level}");
    }
}

#[test]
fn rows_give_the_levels_of_maps() {
    let mut random = Random::new(91);
    for (turn, height) in [1, 2, 3, 5, 33, 100, 300].into_iter().enumerate() {
        let maps = [
            map_u8(19, height, |_, _| random.bits() as u8),
            map_u16(64, height, |_, _| random.bits() as u16),
            map_f32(37, height, |_, _| random.below(999) as f32 / 999.0),
        ];
        for (map, edge) in maps.iter().zip(EDGES.into_iter().cycle().skip(turn)) {
            let roughness = RoughnessOptions {
                method: [RoughnessMethod::Lean, RoughnessMethod::Toksvig][turn % 2],
                base: "0.25".parse().expect("a number"),
                ..Default::default()
            };
            let options = BakeOptions {
                edges: Edges { x: Edge::Wrap, y: edge },
                parallax: Some(ParallaxFormat::default()),
                roughness: Some(roughness),
                ..options("24", UNORM16).into()
            };
            let expected = Baker::reference().bake_levels(map, &options).expect("levels");
            for subject in every_baker() {
                for first_row_last in [false, true] {
                    let what = format!("{}, {height} rows of {}, {edge}", subject.name, map.height_type());
                    let [normal, parallax, rough] =
                        bake(&subject.baker, map, &options, first_row_last, true).expect("a bake");
                    assert_written(&what, &normal, bytes(expected.normal.iter().flatten().map(|it| it.codes())));
                    assert_written(&what, &parallax, bytes(expected.parallax.iter().flatten().map(|it| it.codes())));
                    assert_written(&what, &rough, bytes(expected.roughness.iter().flatten().map(|it| it.codes())));
                }
            }
        }
    }
}

/// A strip has 2^17 texels: here a map has several, and rows of levels that two strips share.
#[test]
fn strips_and_threads_do_not_change_a_byte() {
    let mut random = Random::new(92);
    let map = map_f32(601, 700, |_, _| random.below(999) as f32 / 999.0);
    let options: NormalOptions = options("24", UNORM16);
    let expected: Vec<Image> = Baker::cpu_threads(1)
        .expect("a thread")
        .normal_levels(&map, &options)
        .expect("levels")
        .iter()
        .map(Image::from)
        .collect();
    for threads in [2, 3] {
        let baker = Baker::cpu_threads(threads).expect("threads");
        assert_levels("threads", &baker.normal_levels(&map, &options).expect("levels"), &expected);
    }
    let [normal, ..] = bake(&Baker::cpu(), &map, &options.into(), true, true).expect("a bake");
    let levels = Baker::cpu().normal_levels(&map, &options).expect("levels");
    assert_levels("all threads", &levels, &expected);
    assert_written("rows", &normal, bytes(levels.iter().map(NormalMap::codes)));
}

#[test]
fn a_sink_without_levels_gets_none_and_no_roughness() {
    let map = map_u8(8, 8, |x, y| (x * y) as u8);
    let plain = BakeOptions::from(options("24", UNORM16));
    let [normal, ..] = bake(&Baker::cpu(), &map, &plain, false, false).expect("a bake");
    let written = normal.lock().expect("no panic");
    assert!(written[0].1.iter().all(|times| *times == 1) && written[1].1.iter().all(|times| *times == 0));
    let rough = BakeOptions { roughness: Some(RoughnessOptions::default()), ..plain };
    let error = bake(&Baker::cpu(), &map, &rough, false, false).expect_err("a flat roughness map").to_string();
    assert_eq!(error, "roughness is a map without mip levels: it must be a .ktx2 or .dds file with mips");
}
