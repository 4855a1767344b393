//! The oracle is the port of the reference implementation that engines use; bytes are compared.

#[path = "../../../../tests/support/bevy.rs"]
mod bevy;

use super::Fabric;
use crate::Baker;
use crate::map::Convention;
use crate::mesh::Mesh;
use crate::ops::Precision;
use crate::ops::tangents::{
    Fans, Surface, TangentMethod, TangentOptions, TangentPlan, is_zero, tangents_of_fans, unit,
};
use crate::split_mix::SplitMix;

/// What the oracle gives each corner; `None` where it has no answer.
fn reference(mesh: &Mesh) -> Vec<Option<[f32; 4]>> {
    let normal = |corner: usize| mesh.normals().unwrap()[mesh.triangles().as_flattened()[corner] as usize];
    bevy::tangents(mesh.positions(), mesh.texcoords(), mesh.triangles(), normal)
}

/// Of each corner; `None` where its fan is empty.
fn ours(mesh: &Mesh) -> Vec<Option<[f32; 4]>> {
    let surface = Surface::new(mesh, mesh.normals().unwrap(), false);
    let fans = Fans::of_mikktspace(&surface);
    of_corners(&surface, &fans)
}

fn of_corners(surface: &Surface<'_>, fans: &Fans<'_>) -> Vec<Option<[f32; 4]>> {
    let plan = TangentPlan { method: TangentMethod::Mikktspace, precision: Precision::Exact, surface, fans };
    let mut of_fans = vec![[f32::NAN; 4]; fans.count()];
    tangents_of_fans(&plan, &mut of_fans);
    if let Some(owners) = &fans.owners {
        assert_eq!((owners.vertices.len(), owners.fans.len()), (fans.count(), 3 * surface.triangles.len()));
    }
    let corners = surface.triangles.as_flattened().iter().enumerate().map(|(corner, &vertex)| {
        let fan = fans.owners.as_ref().map_or(vertex, |owners| owners.fans[corner]) as usize;
        let row = fans.corners.row(fan);
        assert!(row.is_sorted());
        assert_eq!(surface.normals[fans.vertex(fan)], surface.normals[vertex as usize]);
        (!row.is_empty()).then_some(of_fans[fan])
    });
    corners.collect()
}

fn bits(tangents: &[Option<[f32; 4]>]) -> Vec<Option<[u32; 4]>> {
    tangents.iter().map(|tangent| tangent.map(|tangent| tangent.map(f32::to_bits))).collect()
}

fn assert_equal(mesh: &Mesh, name: &str) {
    let (expected, found) = (reference(mesh), ours(mesh));
    let differ = |(a, b): (Option<[u32; 4]>, Option<[u32; 4]>)| a != b;
    let differences: Vec<bool> = bits(&expected).into_iter().zip(bits(&found)).map(differ).collect();
    if let Some(corner) = differences.iter().position(|&differs| differs) {
        let count = differences.iter().filter(|&&differs| differs).count();
        panic!("{name}: corner {corner}: {:?}, not {:?}; {count} differ; {mesh:?}", found[corner], expected[corner]);
    }
}

/// Numbers that look random, from a seed.
struct Random(SplitMix);

impl Random {
    fn new(seed: u64) -> Self {
        Self(SplitMix(seed))
    }

    fn below(&mut self, end: usize) -> usize {
        self.0.below(end as u64) as usize
    }

    fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last + 1));
        }
    }
}

type Point = ([f32; 3], [f32; 3], [f32; 2]);

fn mesh(points: &[Point], triangles: Vec<[u32; 3]>) -> Mesh {
    let positions = points.iter().map(|point| point.0).collect();
    let texcoords = points.iter().map(|point| point.2).collect();
    let normals = points.iter().map(|point| point.1).collect();
    Mesh::new(positions, texcoords, triangles).unwrap().with_normals(normals).unwrap()
}

/// (columns + 1) (rows + 1) points of parameters in 0..=1, and two triangles for each cell.
fn sheet(columns: u32, rows: u32, point: impl Fn(f32, f32) -> Point) -> (Vec<Point>, Vec<[u32; 3]>) {
    let mut points = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            points.push(point(column as f32 / columns as f32, row as f32 / rows as f32));
        }
    }
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    (points, triangles)
}

fn grid(columns: u32, rows: u32) -> (Vec<Point>, Vec<[u32; 3]>) {
    sheet(columns, rows, |u, v| {
        let z = 0.1 * (7.0 * u).sin() * (5.0 * v).cos();
        let n = unit([-0.7 * (7.0 * u).cos() * (5.0 * v).cos(), 0.5 * (7.0 * u).sin() * (5.0 * v).sin(), 1.0]);
        ([u, v, z], n, [u + 0.05 * v * v, v])
    })
}

/// The seam's two sides are equal but for u.
fn torus(columns: u32, rows: u32, wraps: bool) -> (Vec<Point>, Vec<[u32; 3]>) {
    sheet(columns, rows, |u, v| {
        let turn = |x: f32| if x == 1.0 { 0.0 } else { x * std::f32::consts::TAU };
        let ((sa, ca), (sb, cb)) = (turn(u).sin_cos(), turn(v).sin_cos());
        let uv = if wraps { [u, v] } else { [turn(u).sin(), turn(v).sin()] };
        ([(2.0 + cb) * ca, (2.0 + cb) * sa, sb], unit([cb * ca, cb * sa, sb]), uv)
    })
}

fn sphere(columns: u32, rows: u32) -> (Vec<Point>, Vec<[u32; 3]>) {
    sheet(columns, rows, |u, v| {
        let (sa, ca) = (u * std::f32::consts::TAU).sin_cos();
        let (sb, cb) = if v == 0.0 || v == 1.0 { (0.0, 1.0 - 2.0 * v) } else { (v * std::f32::consts::PI).sin_cos() };
        let p = [sb * ca, sb * sa, cb];
        (p, unit(p), [u, v])
    })
}

/// A side and two lids; the seam's two sides are equal in all, the texture being mirrored half way round. The lids
/// share the rims' vertices, or have some with normals of their own.
fn closed_cylinder(columns: u32, rows: u32, has_sharp_rims: bool) -> (Vec<Point>, Vec<[u32; 3]>) {
    let around = |u: f32| if u == 1.0 { (0.0, 1.0) } else { (u * std::f32::consts::TAU).sin_cos() };
    let (mut points, mut triangles) = sheet(columns, rows, |u, v| {
        let (sin, cos) = around(u);
        ([cos, sin, v], [cos, sin, 0.0], [(u - 0.5).abs(), v])
    });
    for (row, z) in [(0, 0.0), (rows, 1.0)] {
        let n = [0.0, 0.0, 2.0 * z - 1.0];
        let middle = points.len() as u32;
        points.push(([0.0, 0.0, z], n, [0.25, 0.5]));
        let mut rim: Vec<u32> = (0..=columns).map(|column| row * (columns + 1) + column).collect();
        if has_sharp_rims {
            rim.iter_mut().for_each(|vertex| {
                let (p, _, _) = points[*vertex as usize];
                points.push((p, n, [p[0], p[1]]));
                *vertex = points.len() as u32 - 1;
            });
        }
        let pairs =
            rim.windows(2).map(|pair| if z > 0.0 { [middle, pair[0], pair[1]] } else { [middle, pair[1], pair[0]] });
        triangles.extend(pairs);
    }
    (points, triangles)
}

/// A disc whose texture turns around its centre.
fn hub(spokes: u32) -> (Vec<Point>, Vec<[u32; 3]>) {
    let n = [0.0, 0.0, 1.0];
    let mut points = vec![([0.0; 3], n, [0.5, 0.0])];
    for spoke in 0..spokes {
        let (s, c) = (spoke as f32 / spokes as f32 * std::f32::consts::TAU).sin_cos();
        points.push(([c, s, 0.0], n, [spoke as f32 / spokes as f32, 1.0]));
    }
    let triangles = (0..spokes).map(|spoke| [0, 1 + spoke, 1 + (spoke + 1) % spokes]).collect();
    (points, triangles)
}

/// The two halves of a grid, one mirrored in the texture, and between them triangles without texture area.
fn mirrored(columns: u32, rows: u32, gap: bool) -> (Vec<Point>, Vec<[u32; 3]>) {
    sheet(columns, rows, |u, v| {
        let side = (u - 0.5).abs();
        ([u, v, 0.0], [0.0, 0.0, 1.0], [if gap { (side - 0.2).max(0.0) } else { side }, v])
    })
}

fn unindexed((points, triangles): &(Vec<Point>, Vec<[u32; 3]>)) -> (Vec<Point>, Vec<[u32; 3]>) {
    let corners = triangles.as_flattened().iter().map(|&vertex| points[vertex as usize]).collect();
    (corners, (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

/// Triangles in any order, each beginning at any corner.
fn shuffled((points, triangles): &(Vec<Point>, Vec<[u32; 3]>), seed: u64) -> (Vec<Point>, Vec<[u32; 3]>) {
    let mut random = Random::new(seed);
    let mut triangles = triangles.clone();
    random.shuffle(&mut triangles);
    triangles.iter_mut().for_each(|triangle| triangle.rotate_left(random.below(3)));
    (points.clone(), triangles)
}

/// Triangles between points of a small lattice with few texture coordinates.
fn soup(random: &mut Random, vertices: usize, triangles: usize) -> Mesh {
    let steps = 2 + random.below(3);
    let flat = random.below(2) == 0;
    let normals = 1 + random.below(2);
    let zero = |random: &mut Random, x: usize| if x == 0 && random.below(2) == 0 { -0.0 } else { x as f32 };
    let points: Vec<Point> = (0..vertices)
        .map(|_| {
            let mut at = || random.below(steps);
            let (x, y, z) = (at(), at(), if flat { 0 } else { at() });
            let n = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]][random.below(normals)];
            let p = [zero(random, x), zero(random, y), zero(random, z)];
            // Where positions decide the texture, few vertices are apart.
            let uv = match random.below(4) {
                0 => [random.below(3) as f32, random.below(3) as f32],
                _ => [p[0] + p[2], (p[1] - 1.0) * (p[0] - 1.0)],
            };
            (p, n, uv)
        })
        .collect();
    let triangles = (0..triangles).map(|_| [0, 1, 2].map(|_| random.below(vertices) as u32)).collect();
    mesh(&points, triangles)
}

#[test]
fn surfaces_have_the_reference_s_bytes() {
    let meshes = [
        ("grid", grid(23, 17)),
        ("torus", torus(24, 16, true)),
        ("closed torus", torus(24, 16, false)),
        ("sphere", sphere(32, 16)),
        ("closed cylinder", closed_cylinder(18, 5, false)),
        ("closed cylinder with sharp rims", closed_cylinder(17, 4, true)),
        ("hub", hub(12)),
        ("odd hub", hub(13)),
        ("large hub", hub(100)),
        ("mirrored", mirrored(16, 9, false)),
        ("mirrored with a gap", mirrored(20, 9, true)),
    ];
    for (name, surface) in &meshes {
        let check = |points: &[Point], triangles: Vec<[u32; 3]>, how: &str| {
            assert_equal(&mesh(points, triangles), &format!("{name}, {how}"));
        };
        check(&surface.0, surface.1.clone(), "as it is");
        let (points, triangles) = unindexed(surface);
        check(&points, triangles, "unindexed");
        for seed in 0..20 {
            let (points, triangles) = shuffled(surface, seed);
            check(&points, triangles, "shuffled");
            let (points, triangles) = unindexed(&shuffled(surface, seed));
            check(&points, triangles, "shuffled and unindexed");
        }
    }
}

#[test]
fn thousands_of_small_meshes_have_the_reference_s_bytes() {
    let mut random = Random::new(1);
    let (mut with_last_edges, mut changed_by_them) = (0, 0);
    for number in 0..6000 {
        let (vertices, triangles) = (3 + random.below(10), 1 + random.below(24));
        let mesh = soup(&mut random, vertices, triangles);
        assert_equal(&mesh, &format!("mesh {number}"));

        // Sabotage: edges paired in the order of their triangles, as the reference does all but the last.
        let surface = Surface::new(&mesh, mesh.normals().unwrap(), false);
        let mut fabric = Fabric::welded(&surface);
        if super::LastEdges::of(&fabric).is_some() {
            with_last_edges += 1;
            super::orient_anything(&mut fabric);
            let found = of_corners(&surface, &fabric.into_fans());
            changed_by_them += usize::from(bits(&found) != bits(&ours(&mesh)));
        }
    }
    println!("{with_last_edges} meshes with last edges in an order of their own, {changed_by_them} changed by them");
    assert!(with_last_edges > 500 && changed_by_them > 50, "{with_last_edges} {changed_by_them}");
}

#[test]
fn soups_with_large_rings_have_the_reference_s_bytes() {
    let mut random = Random::new(2);
    for number in 0..300 {
        let vertices = 6 + random.below(30);
        let mesh = soup(&mut random, vertices, 400);
        assert_equal(&mesh, &format!("mesh {number}"));
    }
}

#[test]
fn the_baker_s_tangents_are_the_reference_s() {
    let (points, triangles) = shuffled(&torus(24, 16, true), 7);
    let mesh = mesh(&points, triangles);
    let made = Baker::reference()
        .tangents(&mesh, &TangentOptions { convention: Convention::Dx, ..TangentOptions::default() })
        .unwrap();
    let triangles = made.triangles.as_deref().unwrap_or(mesh.triangles());
    let found: Vec<_> = triangles.as_flattened().iter().map(|&vertex| Some(made.tangents[vertex as usize])).collect();
    assert_eq!(bits(&found), bits(&reference(&mesh)));
    assert_eq!(made.report.undirected, 0);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mut random = Random::new(3);
    let (points, triangles) = shuffled(&unindexed(&sphere(300, 100)), 1);
    let soup = soup(&mut random, 500, 60_000);
    for mesh in [mesh(&points, triangles), soup] {
        let surface = Surface::new(&mesh, mesh.normals().unwrap(), false);
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let fans = pool.install(|| Fans::of_mikktspace(&surface));
            let owners = fans.owners.unwrap();
            (fans.corners.into_owned(), owners.vertices, owners.fans)
        };
        let one = with(1);
        assert!(one.0.rows() > 1);
        assert!([2, 7].into_iter().all(|threads| with(threads) == one));
    }
}

#[test]
fn no_direction_is_left_only_where_the_reference_has_none() {
    // A triangle without texture area alone; one of two equal corners beside it; one that has all.
    let n = [0.0, 0.0, 1.0];
    let points = [
        ([0.0, 0.0, 0.0], n, [0.0, 0.0]),
        ([1.0, 0.0, 0.0], n, [0.0, 0.0]),
        ([0.0, 1.0, 0.0], n, [0.0, 0.0]),
        ([5.0, 0.0, 0.0], n, [0.0, 0.0]),
        ([6.0, 0.0, 0.0], n, [1.0, 0.0]),
        ([5.0, 1.0, 0.0], n, [0.0, 1.0]),
    ];
    let mesh = mesh(&points, vec![[0, 1, 2], [1, 1, 2], [3, 4, 5], [3, 3, 0]]);
    assert_equal(&mesh, "written out");
    let is_directed: Vec<bool> =
        ours(&mesh).iter().map(|tangent| tangent.is_some_and(|[x, y, z, _]| !is_zero([x, y, z]))).collect();
    let (none, all) = ([false; 3], [true; 3]);
    assert_eq!(is_directed, [none, none, all, [true, true, false]].concat());
}

/// The reference finds equal vertices by cells of the mesh's extent, which overflows above 1.7e38: it welds nothing
/// there. Here equal vertices are one at any size.
#[test]
fn vertices_of_any_size_are_welded() {
    let scaled = |points: &[Point], factor: f32| -> Vec<Point> {
        points.iter().map(|&(p, n, uv)| (p.map(|part| factor * part), n, uv)).collect()
    };
    let (points, triangles) = unindexed(&torus(24, 16, true));
    let expected = ours(&mesh(&points, triangles.clone()));
    assert_equal(&mesh(&points, triangles.clone()), "at unit size");
    // The greatest coordinate is near 3.
    for exponent in [126, 100, -100] {
        let far = mesh(&scaled(&points, 2f32.powi(exponent)), triangles.clone());
        assert_eq!(bits(&ours(&far)), bits(&expected), "2^{exponent}");
        let fans = Fans::of_mikktspace(&Surface::new(&far, far.normals().unwrap(), false)).count();
        assert_eq!(fans, 25 * 17, "2^{exponent}");
    }
    let largest = mesh(&scaled(&points, 2f32.powi(126)), triangles);
    assert!(largest.positions().as_flattened().iter().any(|part| *part > 1.7e38));
    assert_ne!(bits(&reference(&largest)), bits(&expected), "the reference does not");
}
