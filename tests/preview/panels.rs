//! Single looks at a plane, beside closed forms and rays in f64.

use super::{SCALE, SIDE, from_above, heights, hills, material, options, plain, pyramid, wide};
use texbake::material::{Material, ParallaxMethod};
use texbake::preview::{Camera, Look, Shot, Surface};
use texbake::stream::Monitor;
use texbake::{Baker, Codes, CodesRef, Convention, NormalMap};

const NORMAL_MAPPED: Surface = Surface::Mapped(ParallaxMethod::None);

/// Middles of the faces of the pyramid on the left, right, upper and lower side: column, row, and the way they face.
const FACES: [(usize, usize, [f64; 2]); 4] = [
    (SIDE / 8, SIDE / 2, [-1.0, 0.0]),
    (7 * SIDE / 8, SIDE / 2, [1.0, 0.0]),
    (SIDE / 2, SIDE / 8, [0.0, -1.0]),
    (SIDE / 2, 7 * SIDE / 8, [0.0, 1.0]),
];

/// Each face of a pyramid that stands out is as bright as its normal and the light make it. A code of 16 bits is 2^-15 wide,
/// and a texel's neighbours are sampled, which are the same.
#[test]
fn faces_are_as_bright_as_they_face_the_light() {
    for convention in [Convention::Gl, Convention::Dx] {
        let material = material(&pyramid(), convention);
        for azimuth in [135.0f32, 20.0, -70.0] {
            let look = plain(azimuth);
            let colours = from_above(&material, NORMAL_MAPPED, look).colours;
            let (sin, cos) = f64::from(azimuth).to_radians().sin_cos();
            let (up, across) = 40f64.to_radians().sin_cos();
            for (x, y, [east, south]) in FACES {
                // The height falls by 2 in a width of 1, of SIDE texels: dz/dx in texels.
                let slope = 2.0 * f64::from(SCALE) / SIDE as f64;
                let cosine = (slope * (east * cos - south * sin) * across + up) / slope.hypot(1.0);
                let expected = f64::from(look.ambient) + (1.0 - f64::from(look.ambient)) * cosine.max(0.0);
                let got = f64::from(colours[y * SIDE + x][0]);
                assert!((got - expected).abs() < 2e-4, "{convention} {azimuth} {x},{y}: {got}, not {expected}");
            }
        }
    }
}

/// With light from the upper left, what faces it is brighter than what faces away: a quarter of the way from the middle a
/// dome leans by 0.04 to each side, of which a light at 40 degrees makes 0.02 each.
#[test]
fn a_dome_is_bright_at_its_upper_left() {
    let dome = heights(|x, y| (0.2 - (x - 0.5).powi(2) - (y - 0.5).powi(2)).max(0.0).sqrt());
    for convention in [Convention::Gl, Convention::Dx] {
        let colours = from_above(&material(&dome, convention), NORMAL_MAPPED, plain(135.0)).colours;
        let at = |x: usize, y: usize| colours[y * SIDE + x][0];
        let (near, far) = (3 * SIDE / 8, 5 * SIDE / 8);
        for side in [at(far, near), at(near, far)] {
            assert!(at(near, near) > side + 0.02 && side > at(far, far) + 0.02, "{convention}: {side}");
        }
    }
}

/// Signed codes have no code of their own for zero turned round: both conventions hold the same slopes.
#[test]
fn both_conventions_give_one_picture() {
    let [gl, dx] = [Convention::Gl, Convention::Dx].map(|convention| material(&hills(), convention));
    let camera = Camera { elevation: 40.0, width: 1.0 };
    for surface in [NORMAL_MAPPED, Surface::Mapped(ParallaxMethod::Plane { limit: 3.0 }), Surface::Truth] {
        let [gl, dx] = [&gl, &dx].map(|material| {
            let shot = Shot { material, surface, camera, look: Look::default(), count: [48, 40] };
            shot.on_cpu(&Monitor::default()).unwrap()
        });
        assert_eq!(gl, dx, "{surface}");
    }
}

/// Green down that is read as green up gives another picture: the test above can fail.
#[test]
fn the_wrong_convention_is_seen() {
    let heights = pyramid();
    let maps = Baker::cpu().bake(&heights, &options(Convention::Dx)).unwrap();
    let (normals, parallax) = (maps.normal.unwrap(), maps.parallax.unwrap());
    let CodesRef::U16(codes) = normals.codes() else { panic!("16 bits") };
    let misread = NormalMap::new(normals.size(), super::format(Convention::Gl), Codes::U16(codes.to_vec())).unwrap();
    let scale = options(Convention::Dx).scale.resolve(heights.size()).unwrap();
    let material = |normals| Material::of_maps(&heights, normals, &parallax, scale, Default::default());
    let [right, wrong] =
        [&normals, &misread].map(|normals| from_above(&material(normals), NORMAL_MAPPED, plain(90.0)).colours);
    // Light from above: the upper face is bright, and dark if it seems to be the lower one.
    let upper = SIDE / 8 * SIDE + SIDE / 2;
    assert!(right[upper][0] > wrong[upper][0] + 0.3, "{:?} {:?}", right[upper], wrong[upper]);
}

#[test]
fn a_flat_surface_has_one_colour() {
    let material = material(&pyramid(), Convention::Gl);
    let colours = from_above(&material, Surface::Flat, plain(135.0)).colours;
    assert!(colours.iter().all(|colour| *colour == colours[0]));
    let mapped = from_above(&material, NORMAL_MAPPED, plain(135.0)).colours;
    assert!(mapped.iter().any(|colour| *colour != mapped[0]));
}

/// The pixel's ray in f64, from where the eye is: above the middle of a plane of width 1, to the south of it.
fn ray(camera: Camera, count: [u32; 2], height: f64, x: u32, y: u32) -> ([f64; 2], [f64; 3]) {
    let elevation = f64::from(camera.elevation).to_radians();
    let half_field = 8f64.min(f64::from(camera.elevation) / 2.0).to_radians();
    let [across, down] = count.map(f64::from);
    let (half_height, half_width) = (half_field.tan(), half_field.tan() * across / down);
    let distance = f64::from(camera.width) / 2.0 / half_width;
    let eye = [0.5, 0.5 * height + distance * elevation.cos(), distance * elevation.sin()];
    let (right, up) = (2.0 * (f64::from(x) + 0.5) / across - 1.0, 1.0 - 2.0 * (f64::from(y) + 0.5) / down);
    // Ahead, and up as the camera has it: at right angles to ahead.
    let ray = [
        right * half_width,
        -elevation.cos() - up * half_height * elevation.sin(),
        -elevation.sin() + up * half_height * elevation.cos(),
    ];
    let t = -eye[2] / ray[2];
    let length = ray.iter().map(|part| part * part).sum::<f64>().sqrt();
    ([eye[0] + t * ray[0], (eye[1] + t * ray[1]) / height], ray.map(|part| -part / length))
}

/// Offsets of a panel are those of each pixel's ray. The ray is a few roundings of a distance of 4 widths off, 2^-24 each:
/// less than 1e-4 texels. A hill rises by less than 0.5 in that, and the longest offsets are 3 times a height.
#[test]
fn offsets_are_those_of_each_rays_eye() {
    let square = material(&hills(), Convention::Gl);
    for (material, height, elevation) in [(&square, 1.0), (&wide(), 0.5)]
        .into_iter()
        .flat_map(|(material, height)| [90.0, 60.0, 25.0].map(|elevation| (material, height, elevation)))
    {
        let (camera, count) = (Camera { elevation, width: 0.8 }, [30, 24]);
        for method in [
            ParallaxMethod::Welsh,
            ParallaxMethod::Limited,
            ParallaxMethod::Plane { limit: 3.0 },
            ParallaxMethod::steps(1),
            ParallaxMethod::steps(4),
            ParallaxMethod::Relief { steps: 512, bisections: 16 },
        ] {
            let surface = Surface::Mapped(method);
            let shot = Shot { material, surface, camera, look: Look::default(), count };
            let offsets = shot.on_cpu(&Monitor::default()).unwrap().offsets;
            for (i, offset) in offsets.iter().enumerate() {
                let (uv, eye) = ray(camera, count, height, i as u32 % 30, i as u32 / 30);
                let expected = material.offset(method, uv.map(|part| part as f32), eye.map(|part| part as f32));
                let size = material.size();
                let [x, y] = [size.width() as f32, size.height() as f32];
                let texels = (x * (offset[0] - expected[0])).hypot(y * (offset[1] - expected[1]));
                assert!(texels < 1e-3, "{method} from {elevation}, {i}: {offset:?}, not {expected:?}");
            }
        }
    }
}

/// Half of a map that stands out, seen from the south: its near border, and all of it, move up in the picture, away from
/// the eye; by the truth as far as the geometry says.
#[test]
fn what_stands_out_moves_away_from_the_eye() {
    let plateau = heights(|x, y| if (0.25..0.75).contains(&x) && (0.25..0.75).contains(&y) { 1.0 } else { 0.5 });
    let material = material(&plateau, Convention::Gl);
    // No more than one plateau is in sight.
    let (camera, count) = (Camera { elevation: 45.0, width: 0.8 }, [96, 96]);
    let look = Look { ambient: 1.0, highlight: 0.0, low: [0.0; 3], high: [1.0; 3], ..Look::default() };
    // The mean row of what is high.
    let row = |surface| {
        let shot = Shot { material: &material, surface, camera, look, count };
        let colours = shot.on_cpu(&Monitor::default()).unwrap().colours;
        let high: Vec<usize> = (0..colours.len()).filter(|i| colours[*i][0] > 0.99).map(|i| i / 96).collect();
        high.iter().sum::<usize>() as f64 / high.len() as f64
    };
    let flat = row(NORMAL_MAPPED);
    for method in [ParallaxMethod::Welsh, ParallaxMethod::Limited, ParallaxMethod::steps(1), ParallaxMethod::steps(4)] {
        let row = row(Surface::Mapped(method));
        assert!(row < flat - 1.0, "{method}: {row}, not above {flat}");
    }
    // h = 1 is SCALE / 2 texels above the plane, and is seen against what is as far behind it, at 45 degrees. Rows are
    // closer there than texels: by sin 45.
    let rows = f64::from(SCALE) / 2.0 * 45f64.to_radians().sin() * 96.0 / (0.8 * SIDE as f64);
    let moved = flat - row(Surface::Truth);
    assert!((moved - rows).abs() < 0.5, "{moved}, not {rows}");
}
