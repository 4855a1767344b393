//! Tiles of one map, baked with the tiles beside them: each is the cut of the whole map's bake, byte for byte.

use super::files::{KINDS, Kind};
use crate::support::{FILTERS, Random, every_edges, map_f32, map_u8, map_u16, options, scale};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use texbake::batch::{Job, TileFolders, TileTemplate, run};
use texbake::io::{NormalReadOptions, ReadOptions, WriteOptions, default_format, default_parallax_format};
use texbake::stream::Monitor;
use texbake::{
    BakeOptions, Baker, CodesRef, Edge, Edges, Encoding, Filter, Grid, HeightMap, HeightType, Heights, Maps,
    NormalFormat, NormalMap, ParallaxFormat, Rational, RoughnessOptions, Scale,
};

/// Tiles beside each other, and below each other.
const TILES: [usize; 2] = [3, 2];

/// Texels of a tile, which are odd and no multiple of a strip, a block or a file's tile.
const TILE: [usize; 2] = [19, 23];

/// A map and its tiles in files; where they share texels, the tiles are as large, and the map is smaller.
struct Mosaic {
    folder: TempDir,
    whole: HeightMap,
    overlap: usize,
    kind: Kind,
}

/// The texels `columns` x `rows` of a map.
fn cut(map: &HeightMap, [left, top]: [usize; 2], [width, height]: [usize; 2]) -> HeightMap {
    let all = map.size().width();
    let place = |x: usize, y: usize| (top + y) * all + left + x;
    match map.heights() {
        Heights::U8(heights) => map_u8(width, height, |x, y| heights[place(x, y)]),
        Heights::U16(heights) => map_u16(width, height, |x, y| heights[place(x, y)]),
        Heights::F32(heights) => map_f32(width, height, |x, y| heights[place(x, y)]),
    }
}

/// The texels of a map of codes, as bytes.
fn cut_codes(codes: CodesRef<'_>, whole: [usize; 2], [left, top]: [usize; 2], [width, height]: [usize; 2]) -> Vec<u8> {
    let texel = codes.bytes().len() / (whole[0] * whole[1]);
    let row = |y: usize| ((top + y) * whole[0] + left) * texel;
    (0..height).flat_map(|y| codes.bytes()[row(y)..][..width * texel].to_vec()).collect()
}

impl Mosaic {
    fn new(height_type: HeightType, kind: Kind, overlap: usize) -> Self {
        let [width, height] = [0, 1].map(|axis| TILES[axis] * (TILE[axis] - overlap) + overlap);
        let mut random = Random::new(7);
        let whole = match height_type {
            HeightType::U8 => map_u8(width, height, |_, _| random.bits() as u8),
            HeightType::U16 => map_u16(width, height, |_, _| random.bits() as u16),
            HeightType::F32 => map_f32(width, height, |_, _| random.below(1000) as f32 / 999.0),
        };
        let mosaic = Self { folder: tempfile::tempdir().unwrap(), whole, overlap, kind };
        for place in places() {
            kind.write(&mosaic.tile(place), &cut(&mosaic.whole, mosaic.corner(place), TILE));
        }
        mosaic
    }

    /// The first texel of a tile.
    fn corner(&self, place: [usize; 2]) -> [usize; 2] {
        [0, 1].map(|axis| place[axis] * (TILE[axis] - self.overlap))
    }

    fn template(&self) -> TileTemplate {
        format!("tile_{{x}}_{{y}}.{}", self.kind.extension()).parse().unwrap()
    }

    /// Numbers begin below zero, and have zeros in front.
    fn tile(&self, [x, y]: [usize; 2]) -> PathBuf {
        self.folder.path().join(format!("tile_{}_{:03}.{}", x as i64 - 1, y + 9, self.kind.extension()))
    }

    fn output(&self, [x, y]: [usize; 2], map: &str, extension: &str) -> PathBuf {
        self.folder.path().join(format!("baked_{x}_{y}_{map}.{extension}"))
    }

    fn read(&self) -> ReadOptions {
        self.kind.read(&cut(&self.whole, [0, 0], TILE))
    }

    fn job(&self, place: [usize; 2], options: &BakeOptions, read: &ReadOptions, extension: &str) -> Job {
        let around = TileFolders::default().around(&self.tile(place), &self.template(), self.overlap, options);
        let output = |map| self.output(place, map, extension);
        Job {
            input: self.tile(place),
            outputs: Maps {
                normal: options.normal.map(|_| output("normal")),
                parallax: options.parallax.map(|_| output("parallax")),
                roughness: None,
            },
            normals: None,
            neighbours: Some(around.unwrap()),
            read: read.clone(),
            options: *options,
            write: WriteOptions::default(),
            baker: Arc::new(Baker::cpu()),
        }
    }

    /// Bakes every tile.
    fn bake(&self, options: &BakeOptions, read: &ReadOptions, extension: &str) {
        let jobs: Vec<Job> = places().map(|place| self.job(place, options, read, extension)).collect();
        for (job, outcome) in jobs.iter().zip(run(&jobs, 2, &Monitor::default(), &|_| ())) {
            let baked = outcome.result.unwrap_or_else(|error| panic!("{}: {error}", job.input.display()));
            assert_eq!([baked.size.width(), baked.size.height()], TILE.map(|side| side / shrink(read)));
        }
    }

    /// Fails unless every tile is the cut of `expected`.
    fn assert_cut(&self, expected: &texbake::BakedMaps, extension: &str, by: usize, what: &str) {
        let whole = [self.whole.size().width() / by, self.whole.size().height() / by];
        for place in places() {
            let (corner, tile) = (self.corner(place).map(|first| first / by), TILE.map(|side| side / by));
            if let Some(normal) = &expected.normal {
                let found = normals(&self.output(place, "normal", extension), normal.format().encoding);
                let expected = cut_codes(normal.codes(), whole, corner, tile);
                assert!(found.codes().bytes() == expected, "normals of tile {place:?}: {what}");
            }
            if let Some(parallax) = &expected.parallax {
                let found = HeightMap::read(self.output(place, "parallax", extension)).unwrap();
                let found: &[u8] = match found.heights() {
                    Heights::U8(codes) => codes,
                    Heights::U16(codes) => bytemuck::cast_slice(codes),
                    Heights::F32(codes) => bytemuck::cast_slice(codes),
                };
                assert!(
                    found == cut_codes(parallax.codes(), whole, corner, tile),
                    "parallax of tile {place:?}: {what}"
                );
            }
        }
    }
}

fn places() -> impl Iterator<Item = [usize; 2]> {
    (0..TILES[1]).flat_map(|y| (0..TILES[0]).map(move |x| [x, y]))
}

fn shrink(read: &ReadOptions) -> usize {
    read.shrink.get() as usize
}

fn normals(path: &Path, encoding: Encoding) -> NormalMap {
    let read = NormalReadOptions { encoding: Some(encoding), ..Default::default() };
    NormalMap::read_with(path, &read).unwrap().0
}

/// Both maps, as files of this extension hold them.
fn both(extension: &str) -> BakeOptions {
    let path = format!("map.{extension}");
    let (encoding, depth) = default_format(Path::new(&path)).unwrap();
    let parallax = default_parallax_format(Path::new(&path)).unwrap();
    // Signed heights would be read with an offset.
    let of_parallax = if parallax.encoding == Encoding::Snorm { Encoding::Biased } else { parallax.encoding };
    BakeOptions {
        scale: scale("9/4"),
        normal: Some(NormalFormat { encoding, depth, ..NormalFormat::default() }),
        parallax: Some(ParallaxFormat { encoding: of_parallax, ..parallax }),
        ..Default::default()
    }
}

fn normal_only() -> BakeOptions {
    options("12", NormalFormat::default()).into()
}

#[test]
fn every_edge_filter_type_and_file() {
    let mut extensions = ["png", "tif", "exr"].into_iter().cycle();
    let mut overlaps = [0, 1, 4].into_iter().cycle();
    for height_type in [HeightType::U8, HeightType::U16, HeightType::F32] {
        let kinds = KINDS.into_iter().filter(|kind| kind.holds(height_type));
        let mosaics: Vec<Mosaic> = kinds.map(|kind| Mosaic::new(height_type, kind, overlaps.next().unwrap())).collect();
        let every_way = every_edges().flat_map(|edges| FILTERS.map(|filter| (edges, filter)));
        for ((edges, filter), mosaic) in every_way.zip(mosaics.iter().cycle()) {
            let extension = extensions.next().unwrap();
            let options = BakeOptions { edges, filter, ..both(extension) };
            mosaic.bake(&options, &mosaic.read(), extension);
            let expected = Baker::cpu().bake(&mosaic.whole, &options).unwrap();
            let what = format!("{:?}, {height_type}, {edges}, {filter}, overlap {}", mosaic.kind, mosaic.overlap);
            mosaic.assert_cut(&expected, extension, 1, &what);
        }
    }
}

/// What a tile covers is given, not what the map does.
#[test]
fn physical_sizes_are_those_of_a_tile() {
    let mosaic = Mosaic::new(HeightType::U16, Kind::TiffStrips, 1);
    let number = |text: &str| text.parse::<Rational>().unwrap();
    let options = |size: [Rational; 2]| {
        let scale = Scale::physical(size[0], size[1], number("0.7"));
        BakeOptions { scale, edges: Edges { x: Edge::Clamp, y: Edge::Mirror }, filter: Filter::Sobel, ..normal_only() }
    };
    mosaic.bake(&options([number("1.9"), number("4.6")]), &mosaic.read(), "png");
    // 0.1 and 0.2 for a texel.
    let size = mosaic.whole.size();
    let whole = [size.width() as i64, 2 * size.height() as i64].map(|tenths| Rational::new(tenths, 10).unwrap());
    let expected = Baker::cpu().bake(&mosaic.whole, &options(whole)).unwrap();
    mosaic.assert_cut(&expected, "png", 1, "physical");
}

#[test]
fn tiles_are_reduced_before_they_are_put_beside_each_other() {
    let mosaic = Mosaic::new(HeightType::U16, Kind::Png, 0);
    // 19 x 23 has no factor: cut other tiles from the same map.
    let read = ReadOptions { shrink: NonZeroU32::new(19).unwrap(), ..mosaic.read() };
    let job = mosaic.job([0, 0], &normal_only(), &read, "png");
    let outcome = &run(&[job], 1, &Monitor::default(), &|_| ())[0];
    let error = outcome.result.as_ref().unwrap_err().to_string();
    assert!(error.starts_with("shrink is 19: it must be a divisor of both sides"), "{error}");

    let (whole, options) = (&mosaic.whole, normal_only());
    let read = ReadOptions { shrink: NonZeroU32::new(4).unwrap(), ..Default::default() };
    let template = "{x}_{y}.png".parse().unwrap();
    for overlap in [0, 4, 8] {
        let folder = tempfile::tempdir().unwrap();
        let (names, step) = ([0, 1].map(|x| folder.path().join(format!("{x}_0.png"))), 24 - overlap);
        let tiles = [0, 1].map(|x| cut(whole, [step * x, 0], [24, 20]));
        names.iter().zip(&tiles).for_each(|(name, tile)| Kind::Png.write(name, tile));
        let strip = folder.path().join("both.png");
        Kind::Png.write(&strip, &cut(whole, [0, 0], [step + 24, 20]));
        let (reduced, _) = HeightMap::read_with(&strip, &read).unwrap();
        let expected = BakeOptions { scale: scale("3"), ..options };
        let expected = Baker::cpu().bake(&reduced, &expected).unwrap().normal.unwrap();
        for (x, name) in names.iter().enumerate() {
            let around = |shared| TileFolders::default().around(name, &template, shared, &options).unwrap();
            let (input, normal) = (name.clone(), folder.path().join(format!("n_{x}.png")));
            let job = |shared| Job {
                input: input.clone(),
                outputs: Maps { normal: Some(normal.clone()), parallax: None, roughness: None },
                neighbours: Some(around(shared)),
                read: read.clone(),
                ..mosaic.job([0, 0], &options, &read, "png")
            };
            let outcome = run(&[job(overlap)], 1, &Monitor::default(), &|_| ()).remove(0);
            outcome.result.unwrap();
            assert_eq!(outcome.warnings, [""; 0], "overlap {overlap}");
            let expected = cut_codes(expected.codes(), [(step + 24) / 4, 5], [step / 4 * x, 0], [6, 5]);
            assert!(normals(&normal, Encoding::Unorm).codes().bytes() == expected, "tile {x}, overlap {overlap}");

            let parts = run(&[job(overlap + 2)], 1, &Monitor::default(), &|_| ()).remove(0);
            let told = format!("overlap is {}: it must be a multiple of shrink, which is 4", overlap + 2);
            assert!(parts.result.unwrap_err().to_string().starts_with(&told), "{told}");
        }
    }
}

#[test]
fn levels_and_other_edges_are_not_for_tiles() {
    let mosaic = Mosaic::new(HeightType::U8, Kind::Png, 0);
    let (read, options, write) = (mosaic.read(), normal_only(), WriteOptions::default());
    let neighbours = mosaic.job([1, 0], &options, &read, "png").neighbours.unwrap();
    let check = |options: &BakeOptions, write: &WriteOptions| neighbours.check(&read, options, write);
    check(&options, &write).unwrap();
    let clamped = BakeOptions { edges: Edges::both(Edge::Clamp), ..options };
    let rough = BakeOptions { roughness: Some(RoughnessOptions::default()), ..options };
    for (wrong, told) in [
        (check(&options, &WriteOptions { mips: true, ..write }), "mips is on: it must be left out"),
        (check(&rough, &write), "roughness is on: it must be left out"),
        (check(&clamped, &write), "edge is clamp: it must be wrap, as for its neighbours"),
    ] {
        let error = wrong.unwrap_err().to_string();
        assert!(error.starts_with(told), "{error}");
    }
}

/// Where a tile is missing, the border of the map is.
#[test]
fn a_hole_has_the_borders_of_a_map() {
    let mosaic = Mosaic::new(HeightType::U8, Kind::Png, 0);
    std::fs::remove_file(mosaic.tile([1, 0])).unwrap();
    for edge in [Edge::Clamp, Edge::Mirror] {
        let options = BakeOptions { edges: Edges::both(edge), ..normal_only() };
        // Left of the hole: below it is its own neighbour, to the right there is nothing.
        let job = mosaic.job([0, 0], &options, &mosaic.read(), "png");
        run(&[job], 1, &Monitor::default(), &|_| ()).remove(0).result.unwrap();
        let column = cut(&mosaic.whole, [0, 0], [TILE[0], 2 * TILE[1]]);
        let expected = Baker::cpu().bake(&column, &options).unwrap().normal.unwrap();
        let expected = cut_codes(expected.codes(), [TILE[0], 2 * TILE[1]], [0, 0], TILE);
        let found = normals(&mosaic.output([0, 0], "normal", "png"), Encoding::Unorm);
        assert!(found.codes().bytes() == expected, "{edge}");
    }
    // A map that wraps goes on at the far side of its row of tiles: to the left the last tile is there, to the right the
    // first one, which is the tile itself.
    let options = normal_only();
    let job = mosaic.job([0, 0], &options, &mosaic.read(), "png");
    run(&[job], 1, &Monitor::default(), &|_| ()).remove(0).result.unwrap();
    let Heights::U8(all) = mosaic.whole.heights() else { unreachable!() };
    let width = mosaic.whole.size().width();
    let joined =
        map_u8(3 * TILE[0], 2 * TILE[1], |x, y| all[y * width + [2, 0, 0][x / TILE[0]] * TILE[0] + x % TILE[0]]);
    let expected = Baker::cpu().bake(&joined, &options).unwrap().normal.unwrap();
    let expected = cut_codes(expected.codes(), [3 * TILE[0], 2 * TILE[1]], [TILE[0], 0], TILE);
    assert!(normals(&mosaic.output([0, 0], "normal", "png"), Encoding::Unorm).codes().bytes() == expected, "wrap");
}

/// The comparison sees every tile around the one in the middle: with any two of them swapped, it fails.
#[test]
fn neighbours_that_are_swapped_are_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random::new(3);
    let tiles: Vec<HeightMap> = (0..9).map(|_| map_u8(9, 9, |_, _| random.bits() as u8)).collect();
    let options = BakeOptions { filter: Filter::Sobel, ..normal_only() };
    let bake = |order: [usize; 9]| {
        let name = |index: usize| folder.path().join(format!("{}_{}.png", index % 3, index / 3));
        (0..9).for_each(|index| Kind::Png.write(&name(index), &tiles[order[index]]));
        let template: TileTemplate = "{x}_{y}.png".parse().unwrap();
        let output = folder.path().join("n.png");
        let job = Job {
            input: name(4),
            outputs: Maps { normal: Some(output.clone()), parallax: None, roughness: None },
            normals: None,
            neighbours: Some(TileFolders::default().around(&name(4), &template, 0, &options).unwrap()),
            read: ReadOptions::default(),
            options,
            write: WriteOptions::default(),
            baker: Arc::new(Baker::cpu()),
        };
        assert_eq!(job.files().inputs.len(), 9, "the tile and eight others");
        run(&[job], 1, &Monitor::default(), &|_| ()).remove(0).result.unwrap();
        normals(&output, Encoding::Unorm).codes().bytes().to_vec()
    };
    let right = bake([0, 1, 2, 3, 4, 5, 6, 7, 8]);
    for (first, second) in (0..9).flat_map(|first| (0..first).map(move |second| (first, second))) {
        if first == 4 || second == 4 {
            continue;
        }
        let mut order = [0, 1, 2, 3, 4, 5, 6, 7, 8];
        order.swap(first, second);
        assert!(bake(order) != right, "{first} and {second} are swapped, and nothing changed");
    }
}

#[test]
fn tiles_that_do_not_fit_are_named() {
    let mosaic = Mosaic::new(HeightType::U8, Kind::Png, 0);
    let bake = |place| {
        let job = mosaic.job(place, &normal_only(), &mosaic.read(), "png");
        run(&[job], 1, &Monitor::default(), &|_| ()).remove(0).result.unwrap_err().to_string()
    };
    Kind::Png.write(&mosaic.tile([1, 0]), &Grid::from_fn(19, 22, |_, _| 7u8).unwrap().into());
    let error = bake([0, 0]);
    let words = ["tile_0_009.png: it is 19 x 22 of u8, and its neighbour ", "tile_-1_009.png is 19 x 23 of u8"];
    assert!(words.iter().all(|words| error.contains(words)), "{error}");
    Kind::Png.write(&mosaic.tile([1, 0]), &Grid::from_fn(19, 23, |_, _| 7u16).unwrap().into());
    assert!(bake([0, 0]).contains("tile_0_009.png: it is 19 x 23 of u16, and its neighbour "));
    assert!(!mosaic.output([0, 0], "normal", "png").exists());

    std::fs::write(mosaic.tile([1, 0]), "no picture").unwrap();
    assert!(bake([0, 0]).contains("tile_0_009.png"));

    let wide = Mosaic { overlap: 18, ..mosaic };
    let job = wide.job([2, 1], &normal_only(), &wide.read(), "png");
    let error = run(&[job], 1, &Monitor::default(), &|_| ()).remove(0).result.unwrap_err().to_string();
    assert!(error.starts_with("overlap is 18: it must be at least 2 less than the sides of the tiles"), "{error}");
}

#[test]
fn a_height_that_is_no_number_is_named_with_its_tile() {
    let mosaic = Mosaic::new(HeightType::F32, Kind::Raw, 0);
    let path = mosaic.tile([1, 0]);
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[4 * 19 * 3..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    std::fs::write(&path, bytes).unwrap();
    let job = mosaic.job([0, 0], &normal_only(), &mosaic.read(), "png");
    let error = run(&[job], 1, &Monitor::default(), &|_| ()).remove(0).result.unwrap_err().to_string();
    assert!(error.contains("tile_0_009.raw: the height at column 0, row 3 is NaN; "), "{error}");
}

#[test]
fn names_and_templates() {
    for template in ["{x}", "{x}{y}", "{x}_{y}_{x}", "a/{x}_{y}", "{x}_{y}2", "{x}0_{y}", "{x}_{z}", ""] {
        let error = template.parse::<TileTemplate>().unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("neighbours is {template}: it must be a file name in which {{x}} and {{y}} "))
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let around = |name: &str, template: &str| {
        let template = template.parse::<TileTemplate>().unwrap();
        TileFolders::default().around(&path(name), &template, 0, &BakeOptions::default())
    };
    let map = HeightMap::from(Grid::from_fn(3, 3, |x, y| (x * y) as u8).unwrap());
    for name in ["y007x-3.png", "y008x-3.png", "y7x-2.png", "y7x-5.png", "y7xa.png", "y7x1.tif"] {
        Kind::Png.write(&path(name), &map);
    }
    let found = around("y007x-3.png", "y{y}x{x}.png").unwrap();
    let names: Vec<_> =
        found.files().iter().map(|file| file.file_name().unwrap().to_str().unwrap().to_owned()).collect();
    // Below; to the right; to the left the last one of its row, which is the one to the right; above the last one of
    // its column, which is the one below.
    assert_eq!(names, ["y008x-3.png", "y7x-2.png"]);
    let error = around("y7xa.png", "y{y}x{x}.png").unwrap_err().to_string();
    assert!(error.contains("y7xa.png: its name is not y{y}x{x}.png with numbers for {x} and {y}"), "{error}");
    Kind::Png.write(&path("y7x-3.png"), &map);
    let error = around("y7x-3.png", "y{y}x{x}.png").unwrap_err().to_string();
    assert!(error.contains("it is the same tile as ") && error.contains("column -3, row 7"), "{error}");
}
