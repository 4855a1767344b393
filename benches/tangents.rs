//! Tangents of meshes in memory, beside other implementations of MikkTSpace.
//!
//! ```text
//! cargo bench --bench tangents                        # all, some minutes
//! cargo bench --bench tangents -- 1m/lengyel          # what has this in its name
//! cargo bench --bench tangents -- shuffled/cpu --quick
//! ```
//!
//! The meshes are tori of 10 thousand, 1 million and 4 million triangles, in the order of a grid, and with triangles
//! and vertices shuffled. Whatever is measured for a mesh and a method runs in turn, round after round; the table has
//! medians of seconds, and of the ratios to the first row of the case in the same round. What takes long runs once.
//! RAYON_NUM_THREADS sets the number of threads; bevy_mikktspace and meshopt have one.

#[path = "../tests/support/bevy.rs"]
mod bevy;
#[path = "../src/split_mix.rs"]
mod split_mix;

use split_mix::SplitMix;
use std::cell::LazyCell;
use std::hint::black_box;
use std::time::Instant;
use texbake::{Baker, CornerAdjacency, Mesh, Precision, TangentMethod, TangentOptions};

/// Name, and quads around and along the torus.
const SIZES: [(&str, [u32; 2]); 3] = [("10k", [100, 50]), ("1m", [1000, 500]), ("4m", [2000, 1000])];
const METHODS: [TangentMethod; 3] = [TangentMethod::Lengyel, TangentMethod::Hegde, TangentMethod::Mikktspace];

/// What takes longer is not repeated.
const PATIENCE_SECONDS: f64 = 1.5;

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_quick = arguments.iter().any(|argument| argument == "--quick");
    arguments.retain(|argument| !argument.starts_with("--"));
    let rounds = if is_quick { 5 } else { 21 };
    let is_wanted = |name: &str| arguments.is_empty() || arguments.iter().any(|part| name.contains(part.as_str()));

    let bakers = bakers();
    for (name, baker, _) in bakers.iter().filter(|(_, _, precision)| *precision == Precision::Exact) {
        println!("{name}: {}", baker.name());
    }
    println!("{:<52} {:>10} {:>10} {:>10} {:>8}", "case", "median ms", "least ms", "Mtri/s", "ratio");
    for (size, sides) in SIZES {
        for is_shuffled in [false, true] {
            let order = if is_shuffled { "shuffled" } else { "grid" };
            let torus = LazyCell::new(|| Torus::new(sides, is_shuffled));
            let build = |torus: &Torus| drop(black_box(CornerAdjacency::of(&torus.mesh)));
            let case = |method: &str| format!("{size}/{method}/{order}");
            measure(&case("adjacency"), &torus, vec![Subject::new("cpu", build)], rounds, &is_wanted);
            for method in METHODS {
                measure(&case(&method.to_string()), &torus, subjects(method, &bakers), rounds, &is_wanted);
            }
        }
    }
}

/// The CPU and every GPU of this machine, those in both precisions.
fn bakers() -> Vec<(String, Baker, Precision)> {
    let mut bakers = vec![("cpu".to_string(), Baker::cpu(), Precision::Exact)];
    for device in texbake::devices().iter().filter(|device| device.api != "cpu") {
        let name = format!("{}:{}", device.api, device.name);
        let short = name.split(" (").next().unwrap_or(&name).to_string();
        for precision in [Precision::Exact, Precision::Fast] {
            match Baker::gpu(Some(&name)) {
                Ok(baker) => bakers.push((format!("{short} {precision}"), baker, precision)),
                Err(error) => println!("left out: {error}"),
            }
        }
    }
    bakers
}

/// What is measured.
struct Subject<'a> {
    name: String,
    run: Box<dyn Fn(&Torus) + 'a>,
}

impl<'a> Subject<'a> {
    fn new(name: impl Into<String>, run: impl Fn(&Torus) + 'a) -> Self {
        Self { name: name.into(), run: Box::new(run) }
    }
}

/// All that compute tangents by a method.
fn subjects(method: TangentMethod, bakers: &[(String, Baker, Precision)]) -> Vec<Subject<'_>> {
    let mut subjects = Vec::new();
    for (name, baker, precision) in bakers {
        let options = TangentOptions { method, precision: *precision, ..TangentOptions::default() };
        let run = move |mesh: &Mesh, adjacency: Option<&CornerAdjacency>| {
            black_box(baker.tangents_with(black_box(mesh), adjacency, &options).expect("the options are in range"));
        };
        if method == TangentMethod::Mikktspace {
            subjects.push(Subject::new(name, move |torus| run(&torus.mesh, None)));
        } else {
            subjects.push(Subject::new(name, move |torus| run(&torus.mesh, Some(&torus.adjacency))));
            subjects.push(Subject::new(format!("{name}, adjacency built"), move |torus| run(&torus.mesh, None)));
        }
    }
    if method == TangentMethod::Mikktspace {
        use meshopt::TangentOptions;
        let meshopt = |options: TangentOptions| {
            move |Torus { mesh, .. }: &Torus| {
                let indices = Some(mesh.triangles().as_flattened());
                let normals = mesh.normals().expect("a torus has normals");
                black_box(meshopt::generate_tangents(indices, mesh.positions(), normals, mesh.texcoords(), options));
            }
        };
        subjects.push(Subject::new("meshopt compatible", meshopt(TangentOptions::Compatible)));
        subjects.push(Subject::new("meshopt", meshopt(TangentOptions::None)));
        subjects.push(Subject::new("bevy_mikktspace", |torus| {
            let mesh = &torus.mesh;
            let (normals, indices) = (mesh.normals().expect("a torus has normals"), mesh.triangles().as_flattened());
            let normal = |corner: usize| normals[indices[corner] as usize];
            black_box(bevy::tangents(mesh.positions(), mesh.texcoords(), mesh.triangles(), normal));
        }));
    }
    subjects
}

/// Runs subjects in turn, and prints a row for each.
fn measure<F: FnOnce() -> Torus>(
    case: &str,
    torus: &LazyCell<Torus, F>,
    mut subjects: Vec<Subject<'_>>,
    rounds: usize,
    is_wanted: &dyn Fn(&str) -> bool,
) {
    subjects.retain(|subject| is_wanted(&format!("{case}/{}", subject.name)));
    if subjects.is_empty() {
        return;
    }
    let timed = |subject: &Subject<'_>| {
        let start = Instant::now();
        (subject.run)(torus);
        start.elapsed().as_secs_f64()
    };
    let triangles = torus.mesh.triangles().len();
    let mut seconds: Vec<Vec<f64>> = subjects.iter().map(|subject| vec![timed(subject)]).collect();
    let is_patient: Vec<bool> = seconds.iter().map(|first| first[0] <= PATIENCE_SECONDS).collect();
    // The first run warmed up.
    for (seconds, _) in seconds.iter_mut().zip(&is_patient).filter(|(_, is_patient)| **is_patient) {
        seconds.clear();
    }
    for _ in 0..rounds {
        for (i, subject) in subjects.iter().enumerate().filter(|(i, _)| is_patient[*i]) {
            seconds[i].push(timed(subject));
        }
    }
    for (subject, own) in subjects.iter().zip(&seconds) {
        let ratio = median(own.iter().zip(&seconds[0]).map(|(own, first)| own / first).collect());
        let least = own.iter().copied().fold(f64::INFINITY, f64::min);
        let median = median(own.clone());
        let [speed, median, least] = [triangles as f64 / median / 1e6, 1e3 * median, 1e3 * least];
        let name = format!("{case}/{}", subject.name);
        println!("{name:<52} {median:>10.2} {least:>10.2} {speed:>10.1} {ratio:>8.2}");
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// A mesh, and the adjacency of its corners.
struct Torus {
    mesh: Mesh,
    adjacency: CornerAdjacency,
}

impl Torus {
    /// A torus with a seam of vertices with equal positions in either direction, and a texture of 4 x 2 tiles.
    fn new([around, along]: [u32; 2], is_shuffled: bool) -> Self {
        let (mut positions, mut normals, mut texcoords) = (Vec::new(), Vec::new(), Vec::new());
        for row in 0..=along {
            for column in 0..=around {
                let [u, v] = [column as f32 / around as f32, row as f32 / along as f32];
                let [a, b] = [u * std::f32::consts::TAU, v * std::f32::consts::TAU];
                let normal = [a.cos() * b.cos(), a.sin() * b.cos(), b.sin()];
                positions.push([3.0 * a.cos() + normal[0], 3.0 * a.sin() + normal[1], normal[2]]);
                normals.push(normal);
                texcoords.push([4.0 * u, 2.0 * v]);
            }
        }
        let mut triangles = Vec::new();
        for row in 0..along {
            for column in 0..around {
                let [a, b] = [row * (around + 1) + column, (row + 1) * (around + 1) + column];
                triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
            }
        }
        if is_shuffled {
            let random = &mut SplitMix(1);
            shuffle(random, &mut triangles);
            let mut places: Vec<u32> = (0..positions.len() as u32).collect();
            shuffle(random, &mut places);
            let [old_positions, old_normals] = [positions.clone(), normals.clone()];
            let old_texcoords = texcoords.clone();
            for (old, &new) in places.iter().enumerate() {
                positions[new as usize] = old_positions[old];
                normals[new as usize] = old_normals[old];
                texcoords[new as usize] = old_texcoords[old];
            }
            triangles.iter_mut().flatten().for_each(|vertex| *vertex = places[*vertex as usize]);
        }
        let mesh = Mesh::new(positions, texcoords, triangles).and_then(|mesh| mesh.with_normals(normals));
        let mesh = mesh.expect("a torus is in order");
        Self { adjacency: CornerAdjacency::of(&mesh), mesh }
    }
}

/// Fisher and Yates.
fn shuffle<T>(random: &mut SplitMix, values: &mut [T]) {
    for last in (1..values.len()).rev() {
        values.swap(last, random.below(last as u64 + 1) as usize);
    }
}
