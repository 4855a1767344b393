//! Sheets: what is on them, and where.

use super::{SCALE, hills, material, pyramid};
use texbake::Convention;
use texbake::material::ParallaxMethod;
use texbake::preview::{Camera, Look, Renderer, Sheet, SheetOptions, Shot, Surface, Told};
use texbake::stream::Monitor;

fn render(options: &SheetOptions) -> Sheet {
    Sheet::render(&material(&hills(), Convention::Gl), options, &Renderer::cpu(), &Monitor::default()).unwrap()
}

/// How many pixels are of a colour.
fn count(sheet: &Sheet, colour: [u8; 3]) -> usize {
    sheet.picture.pixels().iter().filter(|pixel| **pixel == colour).count()
}

#[test]
fn the_truth_has_no_error_and_a_black_heatmap() {
    let panel = [80, 60];
    let sheet = render(&SheetOptions { surfaces: vec![Surface::Truth], panel, ..SheetOptions::default() });
    assert!(sheet.told.iter().all(|told| told.errors == Default::default()) && sheet.told.len() == 2);
    // Two rows; no sample of a lit hill is black, and letters are not.
    assert_eq!(count(&sheet, [0; 3]), 2 * 80 * 60);
}

/// Without parallax the error is the offset itself: the height times the cotangent of the elevation.
#[test]
fn errors_are_told_in_texels() {
    let surfaces =
        vec![Surface::Mapped(ParallaxMethod::None), Surface::Mapped(ParallaxMethod::Limited), Surface::Truth];
    let sheet = render(&SheetOptions { surfaces, elevations: vec![45.0], ..SheetOptions::default() });
    let [none, limited, truth] = sheet.told[..] else { panic!("{:?}", sheet.told) };
    assert_eq!(none.elevation, 45.0);
    // The heights go from 0.06 to 0.94; the lens has 8 degrees above and below the middle.
    let highest = 0.44 * f64::from(SCALE);
    let range = highest..highest / 37f64.to_radians().tan();
    assert!(range.contains(&none.errors.largest), "{none:?}");
    assert!(limited.errors.mean < none.errors.mean && truth.errors.largest == 0.0);
}

/// Every default column and row is there, with a picture, and all but the flat one with a heat map.
#[test]
fn a_sheet_has_a_panel_for_each_surface_and_elevation() {
    // Lit surfaces without light are as black as the truth's heat map.
    let look = Look { ambient: 0.0, highlight: 0.0, low: [0.0; 3], high: [0.0; 3], ..Look::default() };
    let options =
        SheetOptions { surfaces: SheetOptions::every_surface(&[1, 4, 8]), look, panel: [64, 64], ..Default::default() };
    let sheet = render(&options);
    assert_eq!(options.surfaces.len(), 10);
    let titles: Vec<String> = options.surfaces.iter().map(Surface::to_string).collect();
    let words = "flat|normal mapped|Welsh|Welsh, limited|plane, limit 1|plane, limit 3|1 step|4 steps|8 steps|relief: the truth";
    assert_eq!(titles.join("|"), words);
    let told: Vec<(f32, Surface)> = sheet.told.iter().map(|told: &Told| (told.elevation, told.surface)).collect();
    let expected =
        [60.0, 25.0].into_iter().flat_map(|elevation| options.surfaces.iter().map(move |it| (elevation, *it)));
    assert_eq!(told, expected.collect::<Vec<_>>());
    // Two rows of ten pictures, less than an eighth of one under a sun, and the truth's heat maps.
    let black = count(&sheet, [0; 3]);
    assert!((2 * 10 * 64 * 64..).contains(&black), "{black}");
}

#[test]
fn without_truth_there_are_no_errors() {
    let surfaces = vec![Surface::Flat, Surface::Mapped(ParallaxMethod::steps(4))];
    let with = render(&SheetOptions { surfaces: [&surfaces[..], &[Surface::Truth]].concat(), ..Default::default() });
    let without = render(&SheetOptions { surfaces, ..Default::default() });
    assert!(without.told.is_empty() && with.told.len() == 6);
    assert!(without.picture.size().height() < with.picture.size().height());
}

/// The same picture, whoever counts the threads.
#[test]
fn pictures_are_repeatable_and_a_cancelled_one_is_none() {
    let material = material(&pyramid(), Convention::Gl);
    let options = SheetOptions::default();
    let render = |monitor: &Monitor| Sheet::render(&material, &options, &Renderer::cpu(), monitor);
    let (first, second) = (render(&Monitor::default()).unwrap(), render(&Monitor::default()).unwrap());
    assert_eq!(first, second);
    let cancelled = Monitor::default();
    cancelled.cancel();
    assert!(matches!(render(&cancelled), Err(texbake::Error::Cancelled)));
}

/// What a picture cannot be made of is said before anything is rendered.
#[test]
fn options_out_of_range_are_errors() {
    let material = material(&hills(), Convention::Gl);
    let usual = SheetOptions::default;
    let steps = vec![Surface::Mapped(ParallaxMethod::steps(u32::MAX))];
    let relief = |steps, bisections| vec![Surface::Mapped(ParallaxMethod::Relief { steps, bisections })];
    for (options, expected) in [
        (SheetOptions { panel: [0, 64], ..usual() }, "panel is 0: it must be from 16 to 4096"),
        (SheetOptions { panel: [64, 0], ..usual() }, "panel is 0: it must be from 16 to 4096"),
        (SheetOptions { panel: [64, u32::MAX], ..usual() }, "panel is 4294967295: it must be from 16 to 4096"),
        (SheetOptions { elevations: vec![60.0, f32::NAN], ..usual() }, "elevation is NaN: it must be from 5 to 90"),
        (SheetOptions { elevations: vec![91.0], ..usual() }, "elevation is 91: it must be from 5 to 90"),
        (SheetOptions { width: Some(0.0), ..usual() }, "width is 0: it must be from 0.000000001 to 1000000"),
        (SheetOptions { white: Some(f32::NAN), ..usual() }, "error-max is NaN: it must be from 0.000001 to 1000000000"),
        (SheetOptions { surfaces: steps, ..usual() }, "iterations is 4294967295: it must be from 1 to 65536"),
        (SheetOptions { surfaces: relief(u32::MAX, 9), ..usual() }, "steps is 4294967295: it must be from 1 to 65536"),
        (SheetOptions { surfaces: relief(9, 99), ..usual() }, "bisections is 99: it must be from 0 to 64"),
        (
            SheetOptions { elevations: vec![9.0; 1000], panel: [4096; 2], ..usual() },
            "picture is 36936x8266050 pixels: it must be at most 268435456 pixels in all: take fewer panels, or smaller ones",
        ),
    ] {
        let rendered = Sheet::render(&material, &options, &Renderer::cpu(), &Monitor::default());
        assert_eq!(rendered.unwrap_err().to_string(), expected);
    }
    let camera = Camera { elevation: 60.0, width: 1.0 };
    let shot = Shot { material: &material, surface: Surface::Flat, camera, look: Look::default(), count: [8193, 1] };
    let expected = "samples on a side is 8193: it must be from 1 to 8192";
    assert_eq!(shot.on_cpu(&Monitor::default()).unwrap_err().to_string(), expected);
    assert_eq!(Renderer::cpu().take(&shot, &Monitor::default()).unwrap_err().to_string(), expected);
}
