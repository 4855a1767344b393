//! The angles between fast and exact tangents.

use super::angle;
use std::f64::consts::TAU;
use texbake::io::{Model, ModelReadOptions};
use texbake::{Baker, Mesh, Precision, Result, TangentMethod, TangentOptions, Tangents};

const METHODS: [TangentMethod; 3] = [TangentMethod::Mikktspace, TangentMethod::Lengyel, TangentMethod::Hegde];

/// A row for each mesh and method.
pub fn print(bakers: &[Baker]) -> Result<()> {
    println!(
        "{:<34} {:<18} {:<11} {:>8} {:>7} {:>6} {:>9} {:>9} {:>9}",
        "backend", "meshes", "method", "corners", "copies", "signs", "mean", "99.9 %", "most"
    );
    println!("{:<34} {:<18} {:<11} {:>8} {:>14} {:>29}", "", "", "", "", "that differ", "angle, degrees");
    let subjects = subjects()?;
    for baker in bakers {
        let backend = baker.name().chars().take(34).collect::<String>();
        for (name, meshes) in &subjects {
            for method in METHODS {
                let mut found = Found::default();
                meshes.iter().try_for_each(|mesh| found.add(baker, mesh, method))?;
                let Found { copies, signs, mut angles } = found;
                angles.sort_by(f64::total_cmp);
                let mean = angles.iter().sum::<f64>() / angles.len() as f64;
                let at = |share: f64| angles[((angles.len() - 1) as f64 * share) as usize];
                println!(
                    "{backend:<34} {name:<18} {:<11} {:>8} {copies:>7} {signs:>6} {mean:>9.1e} {:>9.1e} {:>9.1e}",
                    method.to_string(),
                    angles.len(),
                    at(0.999),
                    at(1.0)
                );
            }
        }
    }
    Ok(())
}

/// What differs between fast and exact tangents.
#[derive(Default)]
struct Found {
    /// How many more or fewer copies of vertices there are: corners share one whose tangents have the same bits.
    copies: usize,
    /// Corners with another sign.
    signs: usize,
    /// Of each corner, in degrees.
    angles: Vec<f64>,
}

impl Found {
    fn add(&mut self, baker: &Baker, mesh: &Mesh, method: TangentMethod) -> Result<()> {
        let with = |precision| {
            let options = TangentOptions { method, precision, ..TangentOptions::default() };
            baker.tangents(mesh, &options)
        };
        let (exact, fast): (Tangents, Tangents) = (with(Precision::Exact)?, with(Precision::Fast)?);
        self.copies += exact.copies.len().abs_diff(fast.copies.len());
        for (exact, fast) in corners(mesh, &exact).zip(corners(mesh, &fast)) {
            self.signs += usize::from(exact[3] != fast[3]);
            self.angles.push(angle(&exact[..3], &fast[..3]));
        }
        Ok(())
    }
}

/// The tangent of each corner.
fn corners<'a>(mesh: &'a Mesh, made: &'a Tangents) -> impl Iterator<Item = [f64; 4]> + 'a {
    let triangles = made.triangles.as_deref().unwrap_or(mesh.triangles());
    triangles.as_flattened().iter().map(|&vertex| made.tangents[vertex as usize].map(f64::from))
}

/// Meshes by name, those of real models together.
fn subjects() -> Result<Vec<(String, Vec<Mesh>)>> {
    let mut subjects = vec![
        ("torus".to_string(), vec![torus()?]),
        ("sphere with poles".to_string(), vec![sphere()?]),
        ("heightfield".to_string(), vec![heightfield()?]),
    ];
    let real = real_meshes()?;
    match real.is_empty() {
        true => println!("left out: TEXBAKE_MODELS names no folder of models"),
        false => subjects.push((format!("{} real meshes", real.len()), real)),
    }
    Ok(subjects)
}

/// All different meshes with texture coordinates in the .glb and .obj files that TEXBAKE_MODELS has.
fn real_meshes() -> Result<Vec<Mesh>> {
    let folder = std::env::var_os("TEXBAKE_MODELS").filter(|folder| !folder.is_empty());
    let files = folder.into_iter().flat_map(|folder| std::fs::read_dir(folder).into_iter().flatten());
    let mut paths: Vec<_> = files.filter_map(|file| Some(file.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "glb" || extension == "obj"));
    paths.sort();
    let mut meshes = Vec::new();
    for path in paths {
        let model = Model::read_with(path, &ModelReadOptions { all: true, ..ModelReadOptions::default() })?;
        for primitive in 0..model.primitives().len() {
            let mesh = model.mesh(primitive)?;
            if !meshes.contains(&mesh) {
                meshes.push(mesh);
            }
        }
    }
    Ok(meshes)
}

fn torus() -> Result<Mesh> {
    grid([200, 100], |a, b| {
        let ((sa, ca), (sb, cb)) = ((TAU * a).sin_cos(), (TAU * b).sin_cos());
        let radius = 0.7 + 0.3 * cb;
        ([radius * ca, radius * sa, 0.3 * sb], [cb * ca, cb * sa, sb], [3.0 * a, 1.0 - b])
    })
}

fn sphere() -> Result<Mesh> {
    grid([200, 100], |a, b| {
        let ((sa, ca), (sb, cb)) = ((TAU * a).sin_cos(), (TAU / 2.0 * (b - 0.5)).sin_cos());
        let point = [cb * ca, cb * sa, sb];
        (point, point, [a, 1.0 - b])
    })
}

fn heightfield() -> Result<Mesh> {
    grid([200, 200], |a, b| {
        let (p, q) = (40.0 * a + 9.0 * b, 31.0 * b - 7.0 * a);
        let z = 0.02 * (p.sin() + q.cos());
        let (dx, dy) = (0.02 * (40.0 * p.cos() + 7.0 * q.sin()), 0.02 * (9.0 * p.cos() - 31.0 * q.sin()));
        let length = (dx * dx + dy * dy + 1.0).sqrt();
        ([a, b, z], [-dx / length, -dy / length, 1.0 / length], [a, 1.0 - b])
    })
}

/// Two triangles for each of the squares between points of parameters from 0 to 1: position, normal, coordinates.
fn grid([columns, rows]: [u32; 2], point: impl Fn(f64, f64) -> ([f64; 3], [f64; 3], [f64; 2])) -> Result<Mesh> {
    let (mut positions, mut normals, mut texcoords, mut triangles) = (vec![], vec![], vec![], vec![]);
    for row in 0..=rows {
        for column in 0..=columns {
            let at = point(f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows));
            positions.push(at.0.map(|part| part as f32));
            normals.push(at.1.map(|part| part as f32));
            texcoords.push(at.2.map(|part| part as f32));
            if column < columns && row < rows {
                let corner = row * (columns + 1) + column;
                let [b, c, d] = [corner + 1, corner + columns + 2, corner + columns + 1];
                triangles.extend([[corner, b, c], [corner, c, d]]);
            }
        }
    }
    Mesh::new(positions, texcoords, triangles)?.with_normals(normals)
}
