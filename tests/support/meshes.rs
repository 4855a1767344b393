//! Generated meshes, with and without problems.

use super::Random;
use std::f64::consts::TAU;
use texbake::Mesh;

/// What a surface has at a point.
pub struct Point {
    pub position: [f64; 3],
    pub normal: [f64; 3],
    pub texcoord: [f64; 2],
}

/// A grid of `columns` x `rows` squares over a and b from 0 to 1, two triangles each, counterclockwise where a, b and
/// the normal are right-handed.
pub fn grid(columns: u32, rows: u32, point: impl Fn(f64, f64) -> Point) -> Mesh {
    let at = |column: u32, row: u32| point(f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows));
    let points = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (column, row)));
    let points = points.map(|(column, row)| at(column, row)).collect();
    let index = |column, row| row * (columns + 1) + column;
    let squares = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let triangles = squares.flat_map(|(i, j)| {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    mesh_of_points(points, triangles.collect())
}

pub fn mesh_of_points(points: Vec<Point>, triangles: Vec<[u32; 3]>) -> Mesh {
    let positions = points.iter().map(|point| point.position.map(|part| part as f32)).collect();
    let normals = points.iter().map(|point| point.normal.map(|part| part as f32)).collect();
    let texcoords = points.iter().map(|point| point.texcoord.map(|part| part as f32)).collect();
    mesh(positions, normals, texcoords, triangles)
}

pub fn mesh(
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    texcoords: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
) -> Mesh {
    Mesh::new(positions, texcoords, triangles).expect("a mesh").with_normals(normals).expect("normals")
}

/// Vertices in the plane z = 0 with normals along z.
pub fn flat_mesh(points: &[([f32; 2], [f32; 2])], triangles: Vec<[u32; 3]>) -> Mesh {
    let positions = points.iter().map(|&([x, y], _)| [x, y, 0.0]).collect();
    let texcoords = points.iter().map(|&(_, texcoord)| texcoord).collect();
    mesh(positions, vec![[0.0, 0.0, 1.0]; points.len()], texcoords, triangles)
}

/// A mesh with each of its parts changed by a function.
pub fn changed(
    mesh: &Mesh,
    position: impl Fn([f32; 3]) -> [f32; 3],
    normal: impl Fn([f32; 3]) -> [f32; 3],
    texcoord: impl Fn([f32; 2]) -> [f32; 2],
) -> Mesh {
    let positions = mesh.positions().iter().map(|&p| position(p)).collect();
    let texcoords = mesh.texcoords().iter().map(|&uv| texcoord(uv)).collect();
    let changed = Mesh::new(positions, texcoords, mesh.triangles().to_vec()).expect("a mesh");
    let Some(normals) = mesh.normals() else { return changed };
    changed.with_normals(normals.iter().map(|&n| normal(n)).collect()).expect("normals")
}

pub fn without_normals(mesh: &Mesh) -> Mesh {
    Mesh::new(mesh.positions().to_vec(), mesh.texcoords().to_vec(), mesh.triangles().to_vec()).expect("a mesh")
}

/// The unit square in the plane z = 0; u grows along x, v against y, as the rows of an image do.
pub fn plane(columns: u32, rows: u32) -> Mesh {
    grid(columns, rows, |a, b| Point { position: [a, b, 0.0], normal: [0.0, 0.0, 1.0], texcoord: [a, 1.0 - b] })
}

/// Outer radius 1, inner radius 0.4, with vertices of its own at the seams; its texture is repeated 3 times around.
pub fn torus(around: u32, across: u32) -> Mesh {
    grid(around, across, |a, b| {
        let ((sa, ca), (sb, cb)) = ((TAU * a).sin_cos(), (TAU * b).sin_cos());
        let radius = 0.7 + 0.3 * cb;
        Point {
            position: [radius * ca, radius * sa, 0.3 * sb],
            normal: [cb * ca, cb * sa, sb],
            texcoord: [3.0 * a, 1.0 - b],
        }
    })
}

/// The unit sphere between the latitudes of plus and minus `degrees`; 90 has poles, whose triangles have no area.
pub fn sphere(around: u32, rows: u32, degrees: f64) -> Mesh {
    grid(around, rows, |a, b| {
        let (sin, cos) = (degrees.to_radians() * (2.0 * b - 1.0)).sin_cos();
        let (sa, ca) = (TAU * a).sin_cos();
        let position = [cos * ca, cos * sa, sin];
        Point { position, normal: position, texcoord: [a, 1.0 - b] }
    })
}

/// Radius 1, height 1, with vertices of its own at the seam.
pub fn cylinder(around: u32, rows: u32) -> Mesh {
    grid(around, rows, |a, b| {
        let (sin, cos) = (TAU * a).sin_cos();
        Point { position: [cos, sin, b], normal: [cos, sin, 0.0], texcoord: [a, 1.0 - b] }
    })
}

/// The same without vertices of its own at the seam: u runs from (around - 1) / around back to 0 across triangles.
pub fn cylinder_with_a_jump(around: u32, rows: u32) -> Mesh {
    let proper = cylinder(around, rows);
    let row_of = |vertex: u32| vertex / (around + 1);
    let shared = |vertex: u32| row_of(vertex) * around + (vertex % (around + 1)) % around;
    let is_kept = |vertex: &usize| vertex % (around as usize + 1) < around as usize;
    let kept: Vec<usize> = (0..proper.positions().len()).filter(is_kept).collect();
    mesh(
        kept.iter().map(|&vertex| proper.positions()[vertex]).collect(),
        kept.iter().map(|&vertex| proper.normals().expect("normals")[vertex]).collect(),
        kept.iter().map(|&vertex| proper.texcoords()[vertex]).collect(),
        proper.triangles().iter().map(|triangle| triangle.map(shared)).collect(),
    )
}

/// A smooth hilly field over the unit square.
pub fn hills(columns: u32, rows: u32, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let waves: Vec<[f64; 4]> = (0..5)
        .map(|_| {
            let mut part =
                |from: f64, to: f64| from + (to - from) * (random.below(1 << 20) as f64 / f64::from(1 << 20));
            [part(-9.0, 9.0), part(-9.0, 9.0), part(0.0, TAU), part(0.01, 0.05)]
        })
        .collect();
    grid(columns, rows, |a, b| {
        let (mut z, mut dx, mut dy) = (0.0, 0.0, 0.0);
        for [p, q, phase, height] in &waves {
            let (sin, cos) = (p * a + q * b + phase).sin_cos();
            (z, dx, dy) = (z + height * sin, dx + height * p * cos, dy + height * q * cos);
        }
        let length = (dx * dx + dy * dy + 1.0).sqrt();
        // A mapping that is bent a little.
        let texcoord = [a + 0.1 * (3.0 * b).sin(), 1.0 - b + 0.07 * (4.0 * a).cos()];
        Point { position: [a, b, z], normal: [-dx / length, -dy / length, 1.0 / length], texcoord }
    })
}

/// A plane whose mapping is mirrored at x = 1/2: u grows up to there, and falls again, over shared vertices.
pub fn mirrored_halves(columns: u32, rows: u32) -> Mesh {
    assert_eq!(columns % 2, 0, "the mirror goes through vertices");
    grid(columns, rows, |a, b| {
        let u = if a <= 0.5 { 2.0 * a } else { 2.0 - 2.0 * a };
        Point { position: [a, b, 0.1 * a * b], normal: [0.0, 0.0, 1.0], texcoord: [u, 1.0 - b] }
    })
}

/// A plane whose texture is ever denser: u = a^3, v = 1 - b^2.
pub fn uneven(columns: u32, rows: u32) -> Mesh {
    grid(columns, rows, |a, b| Point {
        position: [a, b, 0.2 * a * a],
        normal: unit64([-0.4 * a, 0.0, 1.0]),
        texcoord: [a * a * a, 1.0 - b * b],
    })
}

/// Triangles around vertex 0 in the plane z = 0, with the same piece of the texture on each: around the middle the
/// tangents cancel.
pub fn pole(triangles: u32) -> Mesh {
    let mut points = vec![([0.0, 0.0], [0.0, 0.5])];
    for step in 0..triangles {
        for (step, v) in [(step, 0.75), (step + 1, 0.25)] {
            let (sin, cos) = (TAU * f64::from(step) / f64::from(triangles)).sin_cos();
            points.push(([cos as f32, sin as f32], [0.25, v]));
        }
    }
    flat_mesh(&points, (0..triangles).map(|step| [0, 1 + 2 * step, 2 + 2 * step]).collect())
}

/// Triangles around vertex 0, in the plane z = 0, mapped without distortion.
fn fan(triangles: u32) -> Mesh {
    let mut points = vec![([0.0, 0.0], [0.5, 0.5])];
    for step in 0..triangles {
        let (sin, cos) = (TAU * f64::from(step) / f64::from(triangles)).sin_cos();
        points.push(([cos as f32, sin as f32], [(0.5 + 0.5 * cos) as f32, (0.5 - 0.5 * sin) as f32]));
    }
    flat_mesh(&points, (0..triangles).map(|step| [0, 1 + step, 1 + (step + 1) % triangles]).collect())
}

/// Triangles around vertex 0, in the plane z = 0, mapped without distortion, which wind around it so often that each
/// spans nearly a sixth of a turn: no slivers, however many there are.
pub fn star(triangles: u32) -> Mesh {
    let is_coprime = |step: &u32| !(2..=*step).any(|n| triangles.is_multiple_of(n) && step.is_multiple_of(n));
    let step = (1..=triangles / 6).rev().find(is_coprime).expect("1 is");
    let point = |at: u32| 1 + (u64::from(at) * u64::from(step) % u64::from(triangles)) as u32;
    let fan = fan(triangles);
    let normals = fan.normals().expect("normals").to_vec();
    let triangles = (0..triangles).map(|at| [0, point(at), point(at + 1)]).collect();
    mesh(fan.positions().to_vec(), normals, fan.texcoords().to_vec(), triangles)
}

/// A cube with vertices of their own for each face, and the whole texture on each.
pub fn cube() -> Mesh {
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let first = points.len() as u32;
            for [s, t] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
                (position[axis], position[(axis + 1) % 3], position[(axis + 2) % 3]) = (side, side * s, t);
                normal[axis] = side;
                points.push(Point { position, normal, texcoord: [(s + 1.0) / 2.0, (1.0 - t) / 2.0] });
            }
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    mesh_of_points(points, triangles)
}

/// Triangles between random vertices out of few, with random everything, and duplicates among all of it.
pub fn soup(vertices: u32, triangles: u32, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let mut part = |steps: u64| random.below(steps) as f64 / (steps - 1) as f64;
    let points = (0..vertices)
        .map(|_| Point {
            position: [part(5), part(5), part(5)],
            normal: unit64([part(3) - 0.5, part(3) - 0.4, part(3) + 0.1]),
            texcoord: [part(5), part(5)],
        })
        .collect();
    let triangles = (0..triangles).map(|_| [0; 3].map(|_| random.below(u64::from(vertices)) as u32)).collect();
    mesh_of_points(points, triangles)
}

fn unit64(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|part| part * part).sum::<f64>().sqrt();
    v.map(|part| part / length)
}

/// A triangle at each problem: vertices 4 to 12 of a plane of 2 x 2 squares are followed by those of a triangle
/// without length, one along a line, two without area in texture, and a vertex that none uses.
pub fn degenerate_triangles() -> Mesh {
    let plane = plane(2, 2);
    let mut positions = plane.positions().to_vec();
    let mut texcoords = plane.texcoords().to_vec();
    let mut triangles = plane.triangles().to_vec();
    let mut push = |points: [([f32; 3], [f32; 2]); 3]| {
        let first = positions.len() as u32;
        for (position, texcoord) in points {
            positions.push(position);
            texcoords.push(texcoord);
        }
        triangles.push([first, first + 1, first + 2]);
    };
    // In space a point, and a line.
    push([([2.0, 0.0, 0.0], [0.0, 0.0]), ([2.0, 0.0, 0.0], [1.0, 0.0]), ([2.0, 0.0, 0.0], [0.0, 1.0])]);
    push([([2.0, 1.0, 0.0], [0.0, 0.0]), ([2.5, 1.0, 0.0], [1.0, 0.0]), ([3.0, 1.0, 0.0], [0.0, 1.0])]);
    // In texture a point, and a line.
    push([([2.0, 2.0, 0.0], [0.5, 0.5]), ([3.0, 2.0, 0.0], [0.5, 0.5]), ([2.0, 3.0, 0.0], [0.5, 0.5])]);
    push([([2.0, 4.0, 0.0], [0.0, 0.5]), ([3.0, 4.0, 0.0], [0.5, 0.5]), ([2.0, 5.0, 0.0], [1.0, 0.5])]);
    positions.push([9.0, 9.0, 0.0]);
    texcoords.push([0.25, 0.75]);
    let normals = vec![[0.0, 0.0, 1.0]; positions.len()];
    mesh(positions, normals, texcoords, triangles)
}

/// Meshes of every kind by name, small enough for every baker.
pub fn every_mesh() -> Vec<(&'static str, Mesh)> {
    let id2 = |uv: [f32; 2]| uv;
    let id3 = |v: [f32; 3]| v;
    let scaled = |factor: f32| move |v: [f32; 3]| v.map(|part| factor * part);
    let hills_32 = hills(32, 32, 5);
    let double_sided = {
        let one = hills(6, 6, 6);
        let back = one.triangles().iter().map(|&[a, b, c]| [a, c, b]);
        let triangles = one.triangles().iter().copied().chain(back).collect();
        let normals = one.normals().expect("normals").to_vec();
        mesh(one.positions().to_vec(), normals, one.texcoords().to_vec(), triangles)
    };
    let sheared = changed(&hills(9, 7, 2), id3, id3, |[u, v]| [3.0 * u + 2.0 * v, 0.5 * v]);
    vec![
        ("plane", plane(4, 3)),
        ("stretched plane", changed(&plane(5, 5), |[x, y, z]| [1000.0 * x, 0.001 * y, z], id3, id2)),
        ("sheared hills", sheared),
        ("torus", torus(24, 16)),
        ("fine torus", torus(61, 47)),
        ("band of a sphere", sphere(24, 12, 70.0)),
        ("sphere with poles", sphere(20, 11, 90.0)),
        ("cylinder", cylinder(20, 3)),
        ("cylinder with a jump", cylinder_with_a_jump(20, 3)),
        ("hills", hills_32.clone()),
        ("mirrored halves", mirrored_halves(8, 5)),
        ("upside down", changed(&hills(8, 8, 3), id3, id3, |[u, v]| [u, 1.0 - v])),
        ("uneven density", uneven(12, 9)),
        ("pole", pole(16)),
        ("fan of 1000", fan(1000)),
        ("cube", cube()),
        ("without normals", without_normals(&hills(7, 7, 4))),
        ("a third of the normals zero", some_normals_zero(&hills(7, 7, 8))),
        ("normals of length 3", changed(&hills(7, 7, 4), id3, |n| n.map(|part| 3.0 * part), id2)),
        ("degenerate triangles", degenerate_triangles()),
        ("soup", soup(40, 300, 11)),
        ("dense soup", soup(9, 200, 12)),
        ("sparse soup", soup(900, 300, 13)),
        ("double-sided", double_sided),
        ("hills of 1e20", changed(&hills_32, scaled(1e20), id3, |uv| uv.map(|part| 1e20 * part))),
        ("hills of 1e-20", changed(&hills_32, scaled(1e-20), id3, |uv| uv.map(|part| 1e-20 * part))),
        (
            "one triangle",
            flat_mesh(&[([0.0, 0.0], [0.1, 0.9]), ([1.0, 0.1], [0.9, 0.8]), ([0.2, 1.0], [0.2, 0.3])], vec![[0, 1, 2]]),
        ),
        ("vertices without triangles", flat_mesh(&[([0.0, 0.0], [0.0, 0.0]); 3], Vec::new())),
        ("nothing", flat_mesh(&[], Vec::new())),
    ]
}

fn some_normals_zero(mesh: &Mesh) -> Mesh {
    let normals = mesh.normals().expect("normals").iter().enumerate();
    let normals = normals.map(|(vertex, &n)| if vertex % 3 == 0 { [0.0; 3] } else { n }).collect();
    without_normals(mesh).with_normals(normals).expect("normals")
}
