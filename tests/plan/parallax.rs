//! Whether there is parallax, and by which method.

use super::{decision, plan, plan_error, plan_of_one, scene, setting, wave};
use crate::cli::support::Folder;
use texbake::plan::FilePlan;

/// Black and white in blocks of 8 texels: heights from 0 to 1.
fn blocks(folder: &Folder) {
    folder.grey8("blocks_h.png", 64, 64, |x, y| if (x / 8 + y / 8) % 2 == 0 { 0 } else { 255 });
}

fn method(file: &FilePlan) -> String {
    file.prediction.parallax.method.to_string()
}

#[test]
fn offsets_below_the_tolerance_are_not_worth_a_map() {
    let folder = Folder::new();
    blocks(&folder);
    // s/2 cot 30 degrees = 2 * 1.7320508 = 3.4641016 texels.
    let file = |tolerance: &str, texels_per_pixel: &str| {
        let view = format!("scale = 4\nview = {{ angle = 30, texels-per-pixel = {texels_per_pixel} }}");
        plan_of_one(&folder, &scene(&format!("normal = 60\nparallax = {tolerance}"), &view))
    };
    let offset = |file: &FilePlan| file.prediction.parallax.pixels;
    for (tolerance, texels_per_pixel, pixels) in [("3.4642", "1", 3.464_101_6), ("0.34642", "10", 0.346_410_16)] {
        let file = file(tolerance, texels_per_pixel);
        assert_eq!((method(&file).as_str(), decision(&file, "parallax").choice.as_str()), ("none", "none"));
        assert!((offset(&file) - pixels).abs() < 1e-6, "{}", offset(&file));
    }
    for (tolerance, texels_per_pixel) in [("3.464", "1"), ("0.3464", "10")] {
        let view = format!("scale = 4\nview = {{ angle = 30, texels-per-pixel = {texels_per_pixel} }}");
        // Relief of edges finds them where it marches, so that a largest error may have no method at all.
        match plan(&folder, &scene(&format!("normal = 60\nparallax = {tolerance}"), &view)) {
            Ok(plan) => assert_ne!(method(&plan.files[0]), "none"),
            Err(error) => assert!(error.to_string().contains("the tolerance parallax of"), "{error}"),
        }
    }
}

#[test]
fn straight_from_above_nothing_moves() {
    let folder = Folder::new();
    blocks(&folder);
    let view = "scale = 40\nview = { angle = 90 }";
    let file = plan_of_one(&folder, &scene("normal = 60\nparallax = 0.001", view));
    assert_eq!((method(&file).as_str(), file.prediction.parallax.pixels), ("none", 0.0));
}

#[test]
fn steep_steps_take_relief_intersection_and_gentle_hills_a_few_lookups() {
    let folder = Folder::new();
    blocks(&folder);
    let file = plan_of_one(&folder, &scene("normal = 60\nparallax-99 = 0.5", "scale = 16"));
    assert!(method(&file).starts_with("relief "), "{}", method(&file));
    assert_eq!((setting(&file, "maps"), &file.prediction.parallax.map), (Some("normal"), &None));
    let rejected: Vec<&str> = decision(&file, "parallax").rejected.iter().map(|it| it.what.as_str()).collect();
    assert_eq!(rejected[..3], ["none", "limited", "welsh"], "{rejected:?}");
    assert!(rejected.contains(&"steps 1 to steps 16"), "{rejected:?}");

    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    // A step is too short by 1 - sin 70 degrees, 6 %, of 1.456 pixels, and looks up the height where the pixel is; the
    // second looks it up where the first has come to. The height map, of two bytes, would be too large beside the normals.
    let view = "scale = 8\nview = { angle = 70 }";
    let file = plan_of_one(&folder, &scene("normal = 1\nparallax = 0.19\nbytes-per-texel = 3", view));
    assert_eq!(method(&file), "steps 2");
    let rejected = &decision(&file, "parallax").rejected;
    assert!(
        rejected.iter().any(|it| it.what == "limited" && it.why.contains("; it reads 2 bytes per texel, of 1 left")),
        "{rejected:?}"
    );
    assert!(rejected.iter().any(|it| it.what == "steps 1"), "{rejected:?}");
    assert_eq!(setting(&file, "maps"), Some("normal,parallax"));
    assert!(file.prediction.parallax.pixels <= 0.19);
    let map = file.prediction.parallax.map.as_ref().unwrap();
    assert_eq!((map.texels, map.bytes), ([64, 64], 64 * 64 * map.bits.bytes()));
}

#[test]
fn silhouettes_cannot_be_had_and_the_error_tells_the_way_out() {
    let folder = Folder::new();
    blocks(&folder);
    let error = plan_error(&folder, &scene("normal = 60\nparallax = 0.5", "scale = 16"));
    for part in ["the tolerance parallax of 0.5 pixels cannot be met", "parallax-99 = 0.5"] {
        assert!(error.contains(part), "{part:?} is not in {error}");
    }
}

#[test]
fn an_offset_that_few_pixels_see_does_not_count_among_99_of_100() {
    let folder = Folder::new();
    // Two texels of 4096 are white, the others lie in the plane, as near as a code can.
    folder.grey16("spot_h.png", 64, 64, |x, y| if y == 30 && (x == 30 || x == 31) { 65_535 } else { 32_768 });
    let choice = |tolerance: &str| plan_of_one(&folder, &scene(&format!("normal = 90\n{tolerance}"), "scale = 4"));
    assert_eq!(method(&choice("parallax-99 = 0.1")), "none");
    let all = choice("parallax = 2.1");
    // s/2 cot 45 degrees.
    assert!(method(&all) == "none" && (all.prediction.parallax.pixels - 2.0).abs() < 1e-4);
    let wanted = scene("normal = 90\nparallax = 0.1", "scale = 4");
    assert!(plan(&folder, &wanted).map_or(true, |plan| method(&plan.files[0]) != "none"));
}

#[test]
fn silhouettes_may_be_left_out_of_the_account() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    let fetches = |tolerance: &str| {
        let file = plan_of_one(&folder, &scene(&format!("normal = 1\n{tolerance}"), "scale = 12"));
        let reason = &decision(&file, "parallax").reason;
        let (before, _) = reason.split_once(" lookups").unwrap();
        (reason.contains("in 99 of 100"), before.rsplit(' ').next().unwrap().parse::<u32>().unwrap())
    };
    let (all, most) = (fetches("parallax = 1"), fetches("parallax-99 = 1"));
    assert_eq!((all.0, most.0), (false, true));
    assert!(most.1 <= all.1, "{most:?} {all:?}");
}

#[test]
fn bytes_and_milliseconds_bound_the_choice() {
    let folder = Folder::new();
    blocks(&folder);
    let bounded = |bounds: &str| scene(&format!("normal = 1.5\nparallax-99 = 0.5\n{bounds}"), "scale = 16");
    // Three bytes of normals, which are too steep for two, and one of heights.
    let file = plan_of_one(&folder, &bounded("bytes-per-texel = 4"));
    assert!(decision(&file, "maps").reason.ends_with("in all 4 bytes per texel of the height map, of 4 allowed"));
    let error = plan_error(&folder, &bounded("bytes-per-texel = 3.5"));
    let text = "the tolerance bytes-per-texel of 3.5 bytes per texel cannot be met: the best is 4 bytes per texel, with relief";
    assert!(error.contains(text), "{error}");

    let screen = |bounds: &str| bounded(bounds).replace("[view]", "[view]\nresolution = [1920, 1080]");
    let error = plan_error(&folder, &screen("milliseconds = 1e-9"));
    assert!(error.contains("the tolerance milliseconds of 1e-9 milliseconds cannot be met: the best is "), "{error}");
    let file = plan_of_one(&folder, &screen("milliseconds = 1e9"));
    let times = decision(&file, "parallax").times.clone().unwrap();
    assert!(times.ends_with(" ms on all threads of this CPU, of 1e9 allowed"), "{times}");
    assert!(file.prediction.parallax.milliseconds.is_some_and(|takes| takes > 0.0 && takes < 1e9));
}
