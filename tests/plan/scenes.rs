//! Scenes that are wrong: each is told with its line and the way out.

use super::wave;
use crate::cli::support::Folder;

const VIEW: &str = "[view]\ntexels-per-pixel = 1\nangle = 45\n";
const TOLERANCE: &str = "[tolerance]\nnormal = 1\nparallax = 1\n";
const MATERIAL: &str = "[[material]]\nfiles = '*'\nscale = 2\n";

#[test]
fn mistakes_are_named_with_their_line() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    let material = |lines: &str| format!("{VIEW}{TOLERANCE}[[material]]\nfiles = '*'\n{lines}\n");
    let view = |lines: &str| format!("[view]\n{lines}\n{TOLERANCE}{MATERIAL}");
    let tolerance = |lines: &str| format!("{VIEW}[tolerance]\n{lines}\n{MATERIAL}");
    for (scene, line, parts) in [
        ("folder = \n".to_owned(), 1, ["", "correct it"]),
        (format!("{VIEW}{TOLERANCE}"), 1, ["it has no material", "[[material]]"]),
        (format!("views = 1\n{VIEW}{TOLERANCE}{MATERIAL}"), 1, ["unknown field `views`", "folder"]),
        (material("bits = 16"), 9, ["unknown field `bits`", "`scale`"]),
        (material("scale = 'high'"), 9, ["high: it must be an integer, a decimal", "texbake plan --help"]),
        (material("scale = true"), 9, ["text or a number", "texbake plan --help"]),
        (material("filter = 'sobl'\nscale = 1"), 9, ["sobl: it must be central, sobel, scharr or prewitt", ""]),
        (material("edge = 'repeat'\nscale = 1"), 9, ["repeat: it must be wrap, clamp or mirror", ""]),
        (material(""), 7, ["scale, or size and depth, is missing", "scale = 24 (texels), or size"]),
        (material("size = [1, 1]"), 7, ["scale, or size and depth, is missing", "depth = 0.1"]),
        (material("scale = 1\ndepth = 1"), 7, ["has both scale and depth", "give one"]),
        (material("size = [0, 1]\ndepth = 1"), 9, ["size is not above zero", "size = [2.0, 1.5]"]),
        (material("size = [1]\ndepth = 1"), 9, ["invalid length 1", "correct it"]),
        (material("scale = 1\nformat = 'jpg'"), 10, ["jpg is no format of a map", "write png, tif or exr"]),
        (format!("{VIEW}{TOLERANCE}[[material]]\nscale = 1\n"), 7, ["missing field `files`", "correct it"]),
        (format!("{VIEW}{TOLERANCE}[[material]]\nfiles = '[a'\nscale = 1\n"), 8, ["[a", "correct the glob"]),
        (view("texels-per-pixel = 1"), 6, ["in the view angle is missing", "angle = 20"]),
        (view("texels-per-pixel = 1\nangle = 0"), 3, ["in the view angle is 0: it must be", "from 1 to 90"]),
        (view("texels-per-pixel = 1\nangle = 91"), 3, ["in the view angle is 91", "from 1 to 90"]),
        (view("texels-per-pixel = -1\nangle = 9"), 2, ["texels-per-pixel is -1", "from 0.000001 to 1000000"]),
        (view("angle = 9"), 6, ["in the view distance is missing", "texels-per-pixel = 0.5"]),
        (view("angle = 9\ndistance = 1"), 7, ["in the view fov is missing", "fov = 60"]),
        (view("angle = 9\ndistance = 1\nfov = 60"), 8, ["in the view resolution is missing", "[1920, 1080]"]),
        (view("angle = 9\ndistance = 1\nfov = 180"), 4, ["fov is 180", "from 1 to 179"]),
        (
            view("angle = 9\ndistance = 1\nfov = 60\nresolution = [0, 1]"),
            5,
            ["resolution is [0, 1]", "width and height in pixels"],
        ),
        (
            view("angle = 9\ndistance = 1\nfov = 60\nresolution = [4, 3]"),
            9,
            ["size is missing: this material is seen from a distance", "size = [2.0, 2.0]"],
        ),
        (view("angle = 9\ndistance = 1\ntexels-per-pixel = 1"), 3, ["both distance and texels-per-pixel", "give one"]),
        (view("texels-per-pixel = 1e-320\nangle = 9"), 2, ["texels-per-pixel is ", "from 0.000001 to 1000000"]),
        (view("texels-per-pixel = 1\nangle = 1e-9"), 3, ["angle is 0.000000001", "from 1 to 90"]),
        (view("angle = 9\ndistance = 1e300\nfov = 60"), 3, ["distance is 1000", "from 0.000001 to 1000000"]),
        (view("texels-per-pixel = 1\nangle = 'steep'"), 3, ["angle: invalid type: string", "expected a number"]),
        (view("angle = 9\nresolution = [1920]"), 3, ["resolution: invalid length 1", "expected [a, b]"]),
        (material("scale = 1\nview = { angle = true }"), 10, ["angle: invalid type: boolean", "expected a number"]),
        (format!("{VIEW}{TOLERANCE}[[material]]\nfiles = 3\n"), 8, ["files: invalid type", "text, or a list of texts"]),
        (material("scale = 1\nmodel = 'none.glb'"), 7, ["its model none.glb is not there", "correct model"]),
        (tolerance("parallax = 1"), 6, ["the tolerance normal is missing", "normal = 1.0 (degrees)"]),
        (tolerance("normal = 1"), 6, ["the tolerance parallax is missing", "parallax = 1.0 (pixels)"]),
        (tolerance("normal = 0\nparallax = 1"), 5, ["the tolerance normal is 0", "a number above zero"]),
        (tolerance("normal = 1\nparallax = nan"), 6, ["the tolerance parallax is NaN", "a number above zero"]),
        (tolerance("normal = 1\nparallax = 1\nparallax-99 = 1"), 7, ["both parallax and parallax-99", "give one"]),
        (
            tolerance("normal = 1\nparallax = 1\nmilliseconds = 1"),
            8,
            ["milliseconds are for a screen, whose resolution is missing", "resolution = [1920, 1080]"],
        ),
        (tolerance("normal = 1\nparallax = 1\nbytes-per-texel = -1"), 7, ["bytes-per-texel is -1", "above zero"]),
    ] {
        folder.file("scene.toml", &scene);
        let run = folder.run(&["plan", "scene.toml", "-o", "t.toml"]).ends(2);
        let said = run.line("error: ");
        assert!(said.starts_with(&format!("error: scene.toml:{line}: ")), "{scene}\n{said}");
        for part in parts {
            assert!(said.contains(part), "{part:?} is not in {said}");
        }
        assert!(!folder.path("t.toml").exists());
    }
}

#[test]
fn scenes_without_files_are_refused() {
    let folder = Folder::new();
    folder.grey16("tex/wave_h.png", 64, 64, wave);
    let scene = format!("{VIEW}{TOLERANCE}[[material]]\nfiles = ['walls/*', 'b*']\nscale = 2\n");
    folder.file("tex/scene.toml", scene);
    let run = folder.run(&["plan", "tex/scene.toml", "-o", "t.toml"]).ends(1);
    run.says(
        "error: tex/scene.toml:7",
        &["no height map in tex matches walls/*, b*", "names of height maps end in _height"],
    );
    let run = folder.run(&["plan", "none.toml", "-o", "t.toml"]).ends(2);
    run.says("error: none.toml", &["No such file"]);
    let lost = format!("folder = 'lost'\n{VIEW}{TOLERANCE}{MATERIAL}");
    folder.file("scene.toml", lost);
    let run = folder.run(&["plan", "scene.toml", "-o", "t.toml"]).ends(1);
    run.says("error: scene.toml", &["its folder lost is not there", "correct folder"]);
}
