//! Which maps, how large, and of which codes.

use super::{decision, plan, plan_error, plan_of_one, scene, setting, wave};
use crate::cli::support::Folder;
use texbake::material::ParallaxMethod;
use texbake::plan::TangentSpace;

/// A ramp that rises by one code a texel: its slope is s / 255, and half of that at the borders.
fn ramp(folder: &Folder) {
    folder.grey8("ramp_h.png", 64, 8, |x, _| 96 + x as u8);
}

#[test]
fn a_map_that_is_flat_to_within_the_tolerance_gets_no_normal_map() {
    let folder = Folder::new();
    ramp(&folder);
    // atan(1/255) is 0.224690 degrees.
    let file = |tolerance: &str| {
        let material = "scale = 1\nedge = 'clamp'";
        plan_of_one(&folder, &scene(&format!("normal = {tolerance}\nparallax = 9"), material))
    };
    let flat = file("0.2247");
    assert_eq!((setting(&flat, "maps"), decision(&flat, "normal map").choice.as_str()), (Some("none"), "none"));
    let predicted = flat.prediction.normal.degrees;
    assert!((predicted - (1.0f64 / 255.0).atan().to_degrees()).abs() < 1e-6, "{predicted}");
    assert_eq!(flat.prediction.normal.map, None);
    let leaning = file("0.2246");
    assert_eq!(setting(&leaning, "maps"), Some("normal"));
    assert_eq!(decision(&leaning, "normal map").rejected[0].why, "normals lean by up to 0.225 degrees");
}

#[test]
fn a_flat_map_gets_nothing() {
    let folder = Folder::new();
    folder.grey8("flat_h.png", 16, 16, |_, _| 255);
    let file = plan_of_one(&folder, &scene("normal = 0.001\nparallax = 8", "scale = 8"));
    // White lies s/2 above the plane: 4 texels, times cot 45 degrees.
    assert_eq!(file.prediction.normal.degrees, 0.0);
    assert!((file.prediction.parallax.pixels - 4.0).abs() < 1e-6, "{:?}", file.prediction.parallax);
    assert_eq!(setting(&file, "maps"), Some("none"));
    assert_eq!(file.settings.len(), 1);
    assert_eq!(decision(&file, "tangent space").choice, "none");
}

#[test]
fn no_texel_covers_less_than_a_pixel() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    let shrink = |texels_per_pixel: &str| {
        let view = format!("scale = 2\nview = {{ texels-per-pixel = {texels_per_pixel} }}");
        let file = plan_of_one(&folder, &scene("normal = 1\nparallax = 9", &view));
        setting(&file, "shrink").unwrap().to_owned()
    };
    // The divisors of 64 are powers of two.
    for (texels, expected) in [("1", "1"), ("0.25", "1"), ("1.99", "1"), ("2", "2"), ("3.99", "2"), ("4", "4")] {
        assert_eq!(shrink(texels), expected, "{texels} texels a pixel");
    }
}

#[test]
fn detail_that_a_reduced_map_would_lose_keeps_it_whole() {
    let folder = Folder::new();
    folder.grey8("noise_h.png", 64, 64, |x, y| ((x * 7919 + y * 104_729) % 251) as u8);
    let view = "scale = 6\nview = { texels-per-pixel = 4 }";
    let file = plan_of_one(&folder, &scene("normal = 1\nparallax = 9", view));
    assert_eq!(setting(&file, "shrink"), Some("1"));
    let rejected: Vec<&str> = decision(&file, "resolution").rejected.iter().map(|it| it.what.as_str()).collect();
    assert_eq!(rejected, ["shrink 4", "shrink 2"]);
}

#[test]
fn a_distance_is_pixels_per_texel() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 32, wave);
    let scene = "[view]\ndistance = 1.5\nfov = 60\nresolution = [1920, 1080]\nangle = 45\n\
                 [tolerance]\nnormal = 1\nparallax = 99\n[[material]]\nfiles = 'wave_h.png'\nsize = [2.0, 1.5]\n";
    // 1080 rows show 2 * 1.5 * tan(30 degrees) = 1.7320508: 623.538291 pixels a unit. A texel is 2/64 wide, 1.5/32 high.
    let seen = |height: &str| plan_of_one(&folder, &format!("{scene}{height}")).prediction.seen.pixels_per_texel;
    // A scale in texels with a size to see it by sees the same.
    for height in ["depth = 0.1", "scale = 3"] {
        let [x, y] = seen(height);
        assert!((x - 623.538_291 * 2.0 / 64.0).abs() < 1e-6, "{x}");
        assert!((y - 623.538_291 * 1.5 / 32.0).abs() < 1e-6, "{y}");
    }
}

#[test]
fn the_cheapest_codes_that_hold_are_taken() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    let codes = |tolerance: &str, format: &str| {
        let material = format!("scale = 2\nformat = '{format}'");
        let file = plan_of_one(&folder, &scene(&format!("normal = {tolerance}\nparallax = 9"), &material));
        let predicted = file.prediction.normal.degrees;
        assert!(predicted <= tolerance.parse().unwrap() && predicted > 0.0, "{predicted} of {tolerance}");
        ["encoding", "bits", "channels"].map(|key| setting(&file, key).unwrap().to_owned()).join(" ")
    };
    // Unorm has no code for y = 0: 1/255 of it beside up to 1/255 of x, near z = 1, is 0.318 degrees. Biased has one, and
    // x is off by up to 1/254: 0.226 degrees. Steeper normals add a little.
    assert_eq!(codes("0.4", "png"), "unorm 8 xy");
    assert_eq!(codes("0.3", "png"), "biased 8 xy");
    assert_eq!(codes("0.01", "png"), "unorm 16 xy");
    assert_eq!(codes("0.01", "tif"), "unorm 16 xy");
    // 11 bits of a half float near 1, which has no third component to make it worse.
    assert_eq!(codes("0.1", "exr"), "float 16f xy");
    assert_eq!(codes("0.0001", "exr"), "float 32f xy");
}

#[test]
fn files_that_the_scene_does_not_show_get_no_map() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    folder.grey8("sub/other_h.png", 8, 8, |x, _| x as u8);
    let tolerances = "normal = 1\nparallax = 9";
    let plan = plan(&folder, &scene(tolerances, "scale = 2").replace("'*'", "'wave_*'")).unwrap();
    assert_eq!(plan.left_out, [std::path::PathBuf::from("sub/other_h.png")]);
    assert!(plan.settings().unwrap().contains("[defaults]\nmaps = \"none\""));
}

#[test]
fn tolerances_that_cannot_be_met_are_named_with_the_best_that_can() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    /// The number behind `allow NAME = `.
    fn allowed(message: &str, name: &str) -> f64 {
        let (_, rest) = message.split_once(&format!("allow {name} = ")).unwrap_or_else(|| panic!("{message}"));
        rest.split(',').next().unwrap().parse().unwrap()
    }
    let error = plan_error(&folder, &scene("normal = 0.000001\nparallax = 9", "scale = 2"));
    for part in ["wave_h.png: the tolerance normal of 1e-6 degrees cannot be met: the best is ", " with ", " 16 xy"] {
        assert!(error.contains(part), "{part:?} is not in {error}");
    }
    // What it says can be had can be had, and what is a little less cannot.
    let best = allowed(&error, "normal");
    assert!((0.0001..0.01).contains(&best), "{best}");
    let file = plan_of_one(&folder, &scene(&format!("normal = {best}\nparallax = 9"), "scale = 2"));
    assert_eq!(setting(&file, "bits"), Some("16"));
    plan_error(&folder, &scene(&format!("normal = {}\nparallax = 9", best * 0.98), "scale = 2"));

    let error = plan_error(&folder, &scene("normal = 0.4\nparallax = 9\nbytes-per-texel = 1.5", "scale = 2"));
    let text =
        "the tolerance bytes-per-texel of 1.5 bytes per texel cannot be met: the best is 2 bytes per texel, with unorm";
    assert!(error.contains(text), "{error}");
    let file = plan_of_one(&folder, &scene("normal = 0.4\nparallax = 9\nbytes-per-texel = 2", "scale = 2"));
    assert_eq!(setting(&file, "bits"), Some("8"));
    assert!(plan_error(&folder, &scene("normal = 0.000001\nparallax = 9", "scale = 2")).contains("format = \"exr\""));

    // All maps that cannot be planned are told.
    folder.grey16("waves_h.png", 64, 64, |x, y| wave(y, x));
    let error = plan_error(&folder, &scene("normal = 0.000001\nparallax = 9", "scale = 2"));
    for part in ["wave_h.png: the tolerance normal", "waves_h.png: the tolerance normal"] {
        assert!(error.contains(part), "{part:?} is not in {error}");
    }
}

#[test]
fn of_all_resolutions_the_nearest_to_the_tolerance_is_told() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    let file = |bounds: &str| {
        let material = "scale = 2\nview = { texels-per-pixel = 4 }";
        scene(&format!("normal = 0.4\nparallax = 9\n{bounds}"), material)
    };
    let free = plan_of_one(&folder, &file(""));
    assert_eq!(setting(&free, "shrink"), Some("4"));
    // A quarter of the texels of each axis, two bytes each.
    let error = plan_error(&folder, &file("bytes-per-texel = 0.1"));
    for part in
        ["the tolerance bytes-per-texel of 0.1 bytes per texel cannot", "the best is 0.125 bytes", "at shrink 4"]
    {
        assert!(error.contains(part), "{part:?} is not in {error}");
    }
    plan_of_one(&folder, &file("bytes-per-texel = 0.125"));
}

#[test]
fn a_map_that_is_resampled_along_one_axis_gets_the_same() {
    let seen = |width: usize, tolerance: &str| {
        let folder = Folder::new();
        folder.grey16("wave_h.png", width, 64, |x, y| wave(64 * (2 * y + 1) / 128, 64 * x / width));
        let scene = "[view]\ndistance = 1\nfov = 60\nresolution = [640, 480]\nangle = 45\n\
                     [[material]]\nfiles = '*'\nsize = [1, 1]\ndepth = 0.1\n[tolerance]\nnormal = 1\n";
        plan_of_one(&folder, &format!("{scene}{tolerance}")).prediction.parallax
    };
    // The offset of white, 0.05 cot 45 degrees, by 480 / (2 tan 30 degrees) pixels a metre; the wave comes to 1 but for
    // a sixty-fifth thousandth and where its texels lie.
    for width in [64, 128, 256] {
        let none = seen(width, "parallax = 30");
        assert_eq!(none.method, ParallaxMethod::None);
        assert!((none.pixels - 0.05 * 415.692_194).abs() < 0.03, "{width}: {}", none.pixels);
    }
    let methods = [64, 128, 256].map(|width| seen(width, "parallax-99 = 3").method);
    assert_ne!(methods[0], ParallaxMethod::None);
    assert_eq!(methods, [methods[0]; 3]);
}

#[test]
fn every_choice_is_told_with_its_reason() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    let file = plan_of_one(&folder, &scene("normal = 0.3\nparallax = 0.5", "scale = 8"));
    let topics = ["maps", "resolution", "normal map", "parallax", "parallax map", "precision", "tangent space"];
    assert_eq!(file.decisions.iter().map(|decision| decision.topic).collect::<Vec<_>>(), topics);
    let text = file.explanation();
    for decision in &file.decisions {
        assert!(!decision.choice.is_empty() && !decision.reason.is_empty(), "{decision:?}");
        assert!(text.contains(&format!("\n  {}: {}\n", decision.topic, decision.choice)), "{text}");
    }
    let rejected = &decision(&file, "normal map").rejected;
    assert_eq!(rejected.len(), 2, "{rejected:?}"); // none, unorm 8 xy
    assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
}

#[test]
fn tangents_are_kept_where_a_cotangent_frame_shows_other_normals() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
                  f 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n";
    folder.file("square.obj", square);
    // The same square with normals that lean outwards, as if it were a side of a ball.
    let bent = "vn -1 -1 2\nvn 1 -1 2\nvn 1 1 2\nvn -1 1 2\nf 1/1/1 2/2/2 3/3/3\nf 1/1/1 3/3/3 4/4/4\n";
    folder.file("ball.obj", square.split("vn").next().unwrap().to_owned() + bent);
    let choice = |model: &str| {
        let material = format!("scale = 8\nmodel = '{model}'");
        let file = plan_of_one(&folder, &scene("normal = 0.4\nparallax = 9", &material));
        (decision(&file, "tangent space").clone(), file.prediction.tangent_space)
    };
    let (flat, name) = choice("square.obj");
    assert_eq!((flat.choice.as_str(), name), ("cotangent frame", TangentSpace::CotangentFrame));
    assert!(flat.reason.contains("in 8 pixels"), "{}", flat.reason);
    let (ball, _) = choice("ball.obj");
    assert_eq!((ball.choice.as_str(), ball.rejected[0].what.as_str()), ("tangents", "cotangent frame"), "{ball:?}");
}
