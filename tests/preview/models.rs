//! Meshes that wear a material.

use super::{heights, material, plain};
use std::f32::consts::TAU;
use texbake::material::ParallaxMethod;
use texbake::preview::{Canvas, Look, ModelSheetOptions, Paint, Viewpoint, Worn, model_sheet};
use texbake::stream::Monitor;
use texbake::{Baker, Convention, Mesh, TangentOptions};

const SIDE: usize = 120;
const LIT: Paint = Paint::Lit(ParallaxMethod::None);

/// A square that faces z, u to the right and v down.
fn square() -> Mesh {
    let corners = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    let positions = corners.map(|[u, v]| [u, 1.0 - v, 0.0]).to_vec();
    let mesh = Mesh::new(positions, corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    mesh.with_normals(vec![[0.0, 0.0, 1.0]; 4]).unwrap()
}

/// A torus around z whose texture is mirrored at x = 0: u goes forth on the right and back on the left.
fn ring() -> Mesh {
    let (around, across) = (96, 48);
    let (mut positions, mut normals, mut texcoords) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=around {
        let (sin, cos) = (TAU * (i as f32 / around as f32 - 0.25)).sin_cos();
        let u = 2.0 * i.min(around - i) as f32 / around as f32 * 2.0;
        for j in 0..=across {
            let (height, outwards) = (TAU * j as f32 / across as f32).sin_cos();
            let radius = 1.0 + 0.45 * outwards;
            positions.push([radius * cos, radius * sin, 0.45 * height]);
            normals.push([outwards * cos, outwards * sin, height]);
            texcoords.push([u, 1.0 - j as f32 / across as f32]);
        }
    }
    let corner = |i: u32, j: u32| i * (across + 1) + j;
    let faces = |i, j| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..around).flat_map(|i| (0..across).flat_map(move |j| faces(i, j))).collect();
    Mesh::new(positions, texcoords, triangles).unwrap().with_normals(normals).unwrap()
}

fn worn(mesh: &Mesh) -> Worn {
    Worn::of_tangents(mesh, &Baker::cpu().tangents(mesh, &TangentOptions::default()).unwrap()).unwrap()
}

/// The brightness of each sample, seen from the front and from above; the background is below zero.
fn painted(worn: &Worn, look: &Look, from: [f32; 3], paint: Paint) -> Vec<f32> {
    let bricks =
        heights(|x, y| if (0.1..0.9).contains(&x) && (0.2..0.8).contains(&y) { 0.5 + 0.4 * x * y } else { 0.2 });
    let points: Vec<[f32; 3]> = worn.positions().collect();
    let viewpoint = Viewpoint::around(&points, from, [0.0, 1.0, 0.0]);
    let mut canvas = Canvas::new(SIDE, viewpoint, [-1.0; 3]);
    worn.paint(&mut canvas, &viewpoint, &material(&bricks, Convention::Gl), look, paint);
    canvas.colours().iter().map(|colour| colour[0]).collect()
}

/// A dome on a square: bright where it faces the light. Upper left, and lower right with light from there.
#[test]
fn bumps_stand_out_of_a_mesh() {
    let dome = heights(|x, y| (0.2 - (x - 0.5).powi(2) - (y - 0.5).powi(2)).max(0.0).sqrt());
    let (square, points) = (worn(&square()), [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    for convention in [Convention::Gl, Convention::Dx] {
        let dome = material(&dome, convention);
        for (azimuth, is_upper_left) in [(135.0, true), (-45.0, false)] {
            let viewpoint = Viewpoint::around(&points, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
            let mut canvas = Canvas::new(SIDE, viewpoint, [0.0; 3]);
            square.paint(&mut canvas, &viewpoint, &dome, &plain(azimuth), LIT);
            let at = |x: usize, y: usize| canvas.colours()[y * SIDE + x][0];
            let (near, far) = (SIDE / 2 - SIDE / 12, SIDE / 2 + SIDE / 12);
            let slant = at(near, near) - at(far, far);
            assert!(if is_upper_left { slant > 0.05 } else { slant < -0.05 }, "{convention} {azimuth}: {slant}");
            assert!((at(near, far) - at(far, near)).abs() < 0.01);
        }
    }
}

/// How many pixels of the left half are not as bright as those of the right one, mirrored, of all that are seen.
fn asymmetric(brightness: &[f32]) -> (usize, usize) {
    let pairs = (0..SIDE * SIDE / 2).map(|i| (i / (SIDE / 2) * SIDE, i % (SIDE / 2)));
    let pairs = pairs.map(|(row, x)| [brightness[row + x], brightness[row + SIDE - 1 - x]]);
    let seen: Vec<[f32; 2]> = pairs.filter(|[left, right]| *left >= 0.0 && *right >= 0.0).collect();
    (seen.iter().filter(|[left, right]| (left - right).abs() > 0.02).count(), seen.len())
}

/// A ring that is mirrored looks so: with the eye and the light in the plane between its halves, both are lit alike, bumps
/// out. Samples at the edges of bumps may see another triangle: one in a hundred.
#[test]
fn mirrored_halves_are_lit_alike() {
    let (look, from) = (plain(90.0), [0.0, -0.6, 0.8]);
    let mesh = ring();
    let (different, seen) = asymmetric(&painted(&worn(&mesh), &look, from, LIT));
    assert!(seen > SIDE * SIDE / 8 && different * 100 < seen, "{different} of {seen}");

    // With one handedness for both halves the bumps of one go in: the test can fail.
    let mut made = Baker::cpu().tangents(&mesh, &TangentOptions::default()).unwrap();
    made.tangents.iter_mut().for_each(|tangent| tangent[3] = 1.0);
    let (different, seen) = asymmetric(&painted(&Worn::of_tangents(&mesh, &made).unwrap(), &look, from, LIT));
    assert!(different * 10 > seen, "{different} of {seen}");
}

#[test]
fn tangents_of_another_mesh_are_refused() {
    let error = Worn::with_tangents(&square(), &[[1.0, 0.0, 0.0, 1.0]]).unwrap_err().to_string();
    assert_eq!(error, "number of tangents is 1: it must be 4, one for each vertex");
    let made = Baker::cpu().tangents(&ring(), &TangentOptions::default()).unwrap();
    assert!(Worn::of_tangents(&square(), &made).is_err());
}

/// Red lines go along growing u, green ones against growing v, and blue ones, which point to the eye, are dots.
#[test]
fn vectors_are_drawn_along_their_axes() {
    let worn = worn(&square());
    let points: Vec<[f32; 3]> = worn.positions().collect();
    let viewpoint = Viewpoint::around(&points, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    let mut canvas = Canvas::new(SIDE, viewpoint, [1.0; 3]);
    let hills = material(&super::hills(), Convention::Gl);
    worn.paint(&mut canvas, &viewpoint, &hills, &plain(90.0), Paint::Vectors);
    let of = |channel: usize| {
        let is_pure = |c: &[f32; 3]| (0..3).all(|other| other == channel || c[other] < 0.6 * c[channel]);
        let places = (0..SIDE * SIDE).filter(|i| is_pure(&canvas.colours()[*i])).map(|i| [i % SIDE, i / SIDE]);
        places.collect::<Vec<_>>()
    };
    let (red, green) = (of(0), of(1));
    assert!(!red.is_empty() && !green.is_empty() && !of(2).is_empty());
    // Beyond the square's right side and above it: lines are five samples long, and start under those to the eye.
    let right = |places: &[[usize; 2]]| places.iter().map(|place| place[0]).max().unwrap();
    let top = |places: &[[usize; 2]]| places.iter().map(|place| place[1]).min().unwrap();
    assert!(right(&red) > right(&green) + 2 && top(&green) + 2 < top(&red));
}

#[test]
fn a_model_sheet_has_a_panel_for_each_paint() {
    let hills = material(&super::hills(), Convention::Gl);
    let sheet = |paints: Vec<Paint>, monitor: &Monitor| {
        let options = ModelSheetOptions { paints, panel: 64, ..ModelSheetOptions::default() };
        model_sheet(&[worn(&square())], &hills, &options, monitor)
    };
    let all = sheet(ModelSheetOptions::default().paints, &Monitor::default()).unwrap();
    let one = sheet(vec![Paint::Tangents], &Monitor::default()).unwrap();
    assert_eq!(all.size().width() - one.size().width(), 3 * (64 + 8));
    // u grows to the right: red is (1 + 1)/2, green and blue are 1/2 of linear light, 188 of sRGB.
    assert!(one.pixels().contains(&[255, 188, 188]));
    let cancelled = Monitor::default();
    cancelled.cancel();
    assert!(matches!(sheet(vec![LIT], &cancelled), Err(texbake::Error::Cancelled)));
    let usual = ModelSheetOptions::default;
    for (options, expected) in [
        (ModelSheetOptions { panel: 1_000_000, ..usual() }, "panel is 1000000: it must be from 16 to 4096"),
        (ModelSheetOptions { elevation: 90.0, ..usual() }, "elevation is 90: it must be from -89 to 89"),
        (ModelSheetOptions { turn: f32::NAN, ..usual() }, "turn is NaN: it must be from -360 to 360"),
        (
            ModelSheetOptions { paints: vec![LIT; 17], panel: 4096, ..usual() },
            "picture is 69632x4096 pixels: it must be at most 268435456 pixels in all: take fewer panels, or smaller ones",
        ),
    ] {
        let drawn = model_sheet(&[worn(&square())], &hills, &options, &Monitor::default());
        assert_eq!(drawn.unwrap_err().to_string(), expected);
    }
}

/// A mesh is worn by what moves it as by the mesh that was moved before: turned and scaled, and in a mirror, where its
/// handedness and its triangles turn over. All numbers are exact.
#[test]
fn what_moves_a_mesh_moves_its_tangent_space() {
    let moved = |to: fn([f32; 3]) -> [f32; 3], normal: [f32; 3], is_mirror: bool| {
        let square = square();
        let positions = square.positions().iter().map(|position| to(*position)).collect();
        let turned = |[a, b, c]: &[u32; 3]| if is_mirror { [*a, *c, *b] } else { [*a, *b, *c] };
        let triangles = square.triangles().iter().map(turned).collect();
        let mesh = Mesh::new(positions, square.texcoords().to_vec(), triangles).unwrap();
        worn(&mesh.with_normals(vec![normal; 4]).unwrap())
    };
    let turn = [[0.0, 0.0, -2.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0], [5.0, 6.0, 7.0]];
    let turned = moved(|[x, y, z]| [2.0 * z + 5.0, 2.0 * y + 6.0, -2.0 * x + 7.0], [1.0, 0.0, 0.0], false);
    assert_eq!(worn(&square()).placed(&turn), turned);
    let mirror = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let mirrored = moved(|[x, y, z]| [-x, y, z], [0.0, 0.0, 1.0], true);
    assert_eq!(worn(&square()).placed(&mirror), mirrored);
    assert_ne!(mirrored, worn(&square()));
}
