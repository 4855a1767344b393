//! Compute alone: maps in memory to codes in memory, beside a copy that moves as many bytes.
//!
//! ```text
//! cargo bench --bench compute                    # all, some minutes, with a table at the end
//! cargo bench --bench compute -- 4096/u16        # what has this in its name
//! cargo bench --bench compute -- "1024/(bake|blend)" --quick
//! ```
//!
//! Codes go to memory that is allocated before and touched by the warm-up, but for parallax maps of given normals.
//! RAYON_NUM_THREADS sets the number of threads.

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput};
use rayon::prelude::*;
use std::cell::{LazyCell, RefCell};
use std::hint::black_box;
use std::time::{Duration, Instant};
use texbake::{
    BakeOptions, Baker, BlendInputs, BlendMethod, BlendOptions, Codes, CodesMut, Depth, Grid, HeightMap, HeightType,
    Maps, NormalFormat, NormalMap, NormalOptions, ParallaxFormat, Precision, Rational, Result, Scale,
};

const SIDES: [usize; 3] = [1024, 4096, 8192];
const HEIGHTS: [HeightType; 3] = [HeightType::U8, HeightType::U16, HeightType::F32];
const OUTPUTS: [Depth; 2] = [Depth::Bits8, Depth::Bits16];

/// What would take longer for one map is left out.
const PATIENCE_SECONDS: f64 = 1.5;

/// What is measured.
struct Subject {
    name: String,
    baker: Baker,
    precision: Precision,
    /// Seconds that a texel takes, for each of HEIGHTS.
    seconds_per_texel: [f64; HEIGHTS.len()],
}

/// The reference, and the CPU and every GPU of this machine in both precisions.
fn subjects() -> Vec<Subject> {
    let mut subjects = vec![Subject::new("reference", Baker::reference(), Precision::Exact)];
    for precision in [Precision::Exact, Precision::Fast] {
        subjects.push(Subject::new("cpu", Baker::cpu(), precision));
        for device in texbake::devices().iter().filter(|device| device.api != "cpu") {
            let name = format!("{}:{}", device.api, device.name);
            match Baker::gpu(Some(&name)) {
                Ok(baker) => subjects.push(Subject::new(&name, baker, precision)),
                Err(error) => println!("left out: {error}"),
            }
        }
    }
    subjects
}

impl Subject {
    fn new(name: &str, baker: Baker, precision: Precision) -> Self {
        let short = name.split(" (").next().unwrap_or(name);
        let seconds_per_texel =
            HEIGHTS.map(|heights| try_out(&baker, precision, heights).expect("a small map is baked"));
        Self { name: format!("{short} {precision}"), baker, precision, seconds_per_texel }
    }

    fn seconds(&self, texels: usize, heights: HeightType) -> f64 {
        let index = HEIGHTS.iter().position(|known| *known == heights).expect("one of the measured types");
        self.seconds_per_texel[index] * texels as f64
    }
}

/// Seconds that a texel takes once everything is compiled.
fn try_out(baker: &Baker, precision: Precision, heights: HeightType) -> Result<f64> {
    let map = terrain(512, heights)?;
    let options = NormalOptions { precision, ..NormalOptions::default() };
    baker.normal(&map, &options)?;
    let start = Instant::now();
    baker.normal(&map, &options)?;
    Ok(start.elapsed().as_secs_f64() / map.size().texels() as f64)
}

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(15)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(1000))
        .without_plots()
        .configure_from_args();
    let table = Table::default();
    let subjects = subjects();
    for Subject { name, baker, .. } in &subjects {
        println!("{name}: {}", baker.name());
    }
    for side in SIDES {
        for heights in HEIGHTS {
            // Made by the first bench that runs.
            let map = LazyCell::new(|| terrain(side, heights).expect("its size is above zero"));
            for output in OUTPUTS {
                bench_map(&mut criterion, &table, &subjects, (side, heights), &map, output);
            }
        }
    }
    bench_jobs(&mut criterion, &table, &subjects);
    criterion.final_summary();
    table.print();
}

/// One map to one depth, by the copy and by every baker in turn.
fn bench_map<F: FnOnce() -> HeightMap>(
    criterion: &mut Criterion,
    table: &Table,
    subjects: &[Subject],
    (side, heights): (usize, HeightType),
    map: &LazyCell<HeightMap, F>,
    output: Depth,
) {
    let texels = side * side;
    let format = NormalFormat { depth: output, ..NormalFormat::default() };
    let bytes = texels * (heights.bytes() + format.channels.count() * output.bytes());
    let case = format!("{side}/{heights}/rgb{output}");
    let mut codes = Codes::zeroed(output, texels * format.channels.count());
    let patient = subjects.iter().filter(|subject| subject.seconds(texels, heights) <= PATIENCE_SECONDS);
    bench_case(criterion, table, (&case, texels, bytes), patient, &mut |Subject { baker, precision, .. }| {
        let options =
            NormalOptions { scale: Scale::texels(24), format, precision: *precision, ..NormalOptions::default() };
        baker.normal_into(black_box(map), &options, codes.as_mut()).expect("the options are in range");
    });
}

/// One case by the copy and by subjects in turn.
fn bench_case<'a>(
    criterion: &mut Criterion,
    table: &Table,
    (case, texels, bytes): (&str, usize, usize),
    subjects: impl Iterator<Item = &'a Subject>,
    run: &mut dyn FnMut(&Subject),
) {
    let mut group = criterion.benchmark_group(case);
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::ElementsAndBytes { elements: texels as u64, bytes: bytes as u64 });
    let mut bench = |name: &str, run: &mut dyn FnMut()| {
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter_custom(|runs| {
                let start = Instant::now();
                (0..runs).for_each(|_| run());
                let elapsed = start.elapsed();
                table.add(case, name, texels, bytes, elapsed.as_secs_f64() / runs as f64);
                elapsed
            });
        });
    };
    let source = vec![1u8; bytes / 2];
    let mut target = vec![2u8; bytes / 2];
    bench("copy", &mut || copy(&source, black_box(&mut target)));
    subjects.for_each(|subject| bench(&subject.name, &mut || run(subject)));
}

/// A material: what blends and bakes of several maps read.
struct Material {
    heights: HeightMap,
    mask: HeightMap,
    normals8: [NormalMap; 2],
    normals16: [NormalMap; 2],
    room: RefCell<Room>,
}

/// Memory that is allocated before, and touched by the warm-up.
struct Room {
    rgb8: Vec<u8>,
    rgb16: Vec<u16>,
    grey8: Vec<u8>,
}

impl Material {
    fn new(side: usize) -> Result<Self> {
        let heights = terrain(side, HeightType::U16)?;
        let normals = |depth| -> Result<[NormalMap; 2]> {
            let format = NormalFormat { depth, ..NormalFormat::default() };
            let bake = |scale| {
                let options = NormalOptions { scale: Scale::texels(scale), format, ..NormalOptions::default() };
                Baker::cpu().normal(&heights, &options)
            };
            Ok([bake(24)?, bake(7)?])
        };
        let [normals8, normals16] = [normals(Depth::Bits8)?, normals(Depth::Bits16)?];
        let texels = side * side;
        let room = Room { rgb8: vec![0; 3 * texels], rgb16: vec![0; 3 * texels], grey8: vec![0; texels] };
        Ok(Self { mask: terrain(side, HeightType::U8)?, heights, normals8, normals16, room: room.into() })
    }
}

/// A job on a material.
struct Job {
    name: &'static str,
    /// Bytes of a texel, read and written.
    texel_bytes: usize,
    run: fn(&Subject, &Material) -> Result<()>,
}

/// Weights that make the exact products of 16-bit maps wide.
fn weights() -> Result<BlendMethod> {
    Ok(BlendMethod::Weighted { base: Rational::new(1000, 333)?, detail: Rational::new(-7, 333)? })
}

const JOBS: [Job; 7] = [
    Job {
        name: "blend/add/rgb8",
        texel_bytes: 9,
        run: |subject, material| subject.blend8(material, BlendMethod::add()),
    },
    Job {
        name: "blend/weighted/rgb16",
        texel_bytes: 18,
        run: |subject, material| {
            let [base, detail] = material.normals16.each_ref();
            let codes = &mut material.room.borrow_mut().rgb16;
            subject.blend(BlendInputs { base, detail, mask: None }, weights()?, CodesMut::U16(codes))
        },
    },
    Job {
        name: "blend/masked/rgb8",
        texel_bytes: 10,
        run: |subject, material| subject.blend8(material, BlendMethod::Masked),
    },
    Job { name: "bake/normal/u16", texel_bytes: 5, run: |subject, material| subject.bake(material, [true, false]) },
    Job { name: "bake/parallax/u16", texel_bytes: 3, run: |subject, material| subject.bake(material, [false, true]) },
    Job { name: "bake/both/u16", texel_bytes: 6, run: |subject, material| subject.bake(material, [true, true]) },
    Job {
        name: "bake/parallax of normals/u16",
        texel_bytes: 6,
        run: |Subject { baker, precision, .. }, Material { heights, normals8, .. }| {
            let format = ParallaxFormat::default();
            black_box(baker.parallax_with_normals(heights, &normals8[0], format, *precision)?);
            Ok(())
        },
    },
];

impl Subject {
    fn blend8(&self, material: &Material, method: BlendMethod) -> Result<()> {
        let [base, detail] = &material.normals8;
        let mask = (method == BlendMethod::Masked).then_some(&material.mask);
        let codes = &mut material.room.borrow_mut().rgb8;
        self.blend(BlendInputs { base, detail, mask }, method, CodesMut::U8(codes))
    }

    fn blend(
        &self,
        inputs: BlendInputs<&NormalMap, &HeightMap>,
        method: BlendMethod,
        codes: CodesMut<'_>,
    ) -> Result<()> {
        let format = NormalFormat { depth: codes.depth(), ..NormalFormat::default() };
        let options = BlendOptions { method, format, precision: self.precision, ..BlendOptions::default() };
        black_box(self.baker.blend_into(&inputs, &options, codes)?);
        Ok(())
    }

    fn bake(&self, material: &Material, [normal, parallax]: [bool; 2]) -> Result<()> {
        let options = BakeOptions {
            scale: Scale::texels(24),
            normal: normal.then(NormalFormat::default),
            parallax: parallax.then(ParallaxFormat::default),
            precision: self.precision,
            ..BakeOptions::default()
        };
        let Room { rgb8, grey8, .. } = &mut *material.room.borrow_mut();
        let maps = Maps {
            normal: normal.then_some(CodesMut::U8(rgb8)),
            parallax: parallax.then_some(CodesMut::U8(grey8)),
            roughness: None,
        };
        black_box(self.baker.bake_into(&material.heights, &options, maps)?);
        Ok(())
    }
}

/// Blends and bakes of several maps, on maps of each of the first two sides.
fn bench_jobs(criterion: &mut Criterion, table: &Table, subjects: &[Subject]) {
    const SMALL: usize = 512;
    let small = Material::new(SMALL).expect("its size is above zero");
    let materials = [0, 1].map(|i| LazyCell::new(move || Material::new(SIDES[i]).expect("its size is above zero")));
    for Job { name, texel_bytes, run } in JOBS {
        let run = |subject: &Subject, material: &Material| run(subject, material).expect("the options are in range");
        // Seconds that a texel takes once everything is compiled.
        let try_out = |subject: &Subject| {
            run(subject, &small);
            let start = Instant::now();
            run(subject, &small);
            start.elapsed().as_secs_f64() / (SMALL * SMALL) as f64
        };
        let seconds: Vec<f64> = subjects.iter().map(try_out).collect();
        for (side, material) in SIDES.into_iter().zip(&materials) {
            let texels = side * side;
            let patient = subjects.iter().zip(&seconds);
            let patient = patient.filter(|(_, seconds)| **seconds * texels as f64 <= PATIENCE_SECONDS).map(|(s, _)| s);
            let case = format!("{side}/{name}");
            bench_case(criterion, table, (&case, texels, texels * texel_bytes), patient, &mut |subject| {
                run(subject, material);
            });
        }
    }
}

/// Reads and writes as many bytes as a bake, on as many threads.
fn copy(source: &[u8], target: &mut [u8]) {
    const PIECE: usize = 1 << 18;
    target.par_chunks_mut(PIECE).zip(source.par_chunks(PIECE)).for_each(|(target, source)| {
        target.copy_from_slice(source);
    });
}

/// Hills with fine noise: slopes of all directions, few of them alike.
fn terrain(side: usize, height_type: HeightType) -> Result<HeightMap> {
    let height = |x: usize, y: usize| {
        let hills = (x as f32 * 0.013).sin() * (y as f32 * 0.017).cos();
        let hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
        let noise = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d) >> 16;
        0.5 + 0.4 * hills + noise as f32 / 65536.0 * 0.05
    };
    Ok(match height_type {
        HeightType::U8 => Grid::from_fn(side, side, |x, y| (height(x, y) * 255.0) as u8)?.into(),
        HeightType::U16 => Grid::from_fn(side, side, |x, y| (height(x, y) * 65535.0) as u16)?.into(),
        HeightType::F32 => Grid::from_fn(side, side, height)?.try_into()?,
    })
}

/// Seconds of every run, by case and name, in the order in which they came.
#[derive(Default)]
struct Table {
    rows: RefCell<Vec<Row>>,
}

struct Row {
    case: String,
    name: String,
    texels: usize,
    bytes: usize,
    seconds: Vec<f64>,
}

impl Table {
    fn add(&self, case: &str, name: &str, texels: usize, bytes: usize, seconds: f64) {
        let mut rows = self.rows.borrow_mut();
        match rows.iter_mut().find(|row| row.case == case && row.name == name) {
            Some(row) => row.seconds.push(seconds),
            None => rows.push(Row { case: case.into(), name: name.into(), texels, bytes, seconds: vec![seconds] }),
        }
    }

    fn print(&self) {
        println!("\n{:<33} {:<36} {:>9} {:>10} {:>7}", "case", "what", "ms", "Mtexel/s", "GB/s");
        for row in self.rows.borrow_mut().iter_mut() {
            row.seconds.sort_by(f64::total_cmp);
            let median = row.seconds[row.seconds.len() / 2];
            let [mtexels, gigabytes] = [row.texels as f64 / median / 1e6, row.bytes as f64 / median / 1e9];
            println!("{:<33} {:<36} {:>9.2} {mtexels:>10.1} {gigabytes:>7.2}", row.case, row.name, median * 1e3);
        }
    }
}
