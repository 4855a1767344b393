//! `texbake tangents`: the meshes of a model.

use super::support::Folder;
use serde_json::{Value, json};
use texbake::{Baker, Convention, Mesh, MissingNormals, TangentMethod, TangentOptions, Tangents};

/// A wavy sheet of squares whose texture runs forth over its left half and back over the right one.
pub fn sheet(columns: u32, rows: u32) -> Mesh {
    let vertices = || (0..=rows).flat_map(|y| (0..=columns).map(move |x| (x as f32, y as f32)));
    let height = |x: f32, y: f32| (0.8 * x).sin() + 0.3 * (x + 1.7 * y).cos();
    let positions = vertices().map(|(x, y)| [x, y, height(x, y)]).collect();
    let half = columns as f32 / 2.0;
    let texcoords = vertices().map(|(x, y)| [(half - (x - half).abs()) / 7.0, 1.0 - y / 11.0]).collect();
    let normal = |(x, y): (f32, f32)| {
        let wave = 0.3 * (x + 1.7 * y).sin();
        let (dx, dy) = (0.8 * (0.8 * x).cos() - wave, -1.7 * wave);
        let length = (dx * dx + dy * dy + 1.0).sqrt();
        [-dx / length, -dy / length, 1.0 / length]
    };
    let normals = vertices().map(normal).collect();
    let corner = |x: u32, y: u32| y * (columns + 1) + x;
    let square = |x, y| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..rows).flat_map(|y| (0..columns).flat_map(move |x| square(x, y))).collect();
    Mesh::new(positions, texcoords, triangles).unwrap().with_normals(normals).unwrap()
}

/// A .glb in the making.
pub struct Model {
    pub json: Value,
    bytes: Vec<u8>,
}

impl Model {
    /// Nothing but two materials: one with a normal map, one without.
    pub fn new() -> Self {
        let normal_map = json!({ "normalTexture": { "index": 0 } });
        let json = json!({
            "asset": { "version": "2.0" },
            "accessors": [], "bufferViews": [], "buffers": [{}], "meshes": [], "nodes": [], "scenes": [{ "nodes": [] }],
            "scene": 0, "materials": [normal_map, { "name": "plain" }], "textures": [{ "source": 0 }],
            "images": [{ "uri": "data:image/png;base64,iVBORw0KGgo=" }],
        });
        Self { json, bytes: Vec::new() }
    }

    /// A node with a mesh of one primitive, which has the normals that `mesh` has.
    pub fn with(mut self, name: &str, mesh: &Mesh, material: usize) -> Self {
        let primitive = self.primitive(mesh, material);
        self.push("meshes", json!({ "name": name, "primitives": [primitive] }));
        let last = self.list("meshes").len() - 1;
        let node = self.push("nodes", json!({ "mesh": last }));
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(node.into());
        self
    }

    pub fn primitive(&mut self, mesh: &Mesh, material: usize) -> Value {
        let position = self.floats(mesh.positions());
        let (least, greatest) = mesh.positions().iter().fold(([f32::MAX; 3], [f32::MIN; 3]), |(least, greatest), p| {
            (std::array::from_fn(|i| least[i].min(p[i])), std::array::from_fn(|i| greatest[i].max(p[i])))
        });
        self.json["accessors"][position]["min"] = json!(least);
        self.json["accessors"][position]["max"] = json!(greatest);
        let mut attributes = json!({ "POSITION": position, "TEXCOORD_0": self.floats(mesh.texcoords()) });
        if let Some(normals) = mesh.normals() {
            attributes["NORMAL"] = self.floats(normals).into();
        }
        let indices = mesh.triangles().as_flattened();
        let view = self.view(indices.iter().flat_map(|index| index.to_le_bytes()).collect(), 34963);
        let accessor = json!({ "bufferView": view, "componentType": 5125, "count": indices.len(), "type": "SCALAR" });
        json!({ "attributes": attributes, "indices": self.push("accessors", accessor), "material": material })
    }

    fn floats<const N: usize>(&mut self, vectors: &[[f32; N]]) -> usize {
        let view = self.view(vectors.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect(), 34962);
        let accessor =
            json!({ "bufferView": view, "componentType": 5126, "count": vectors.len(), "type": format!("VEC{N}") });
        self.push("accessors", accessor)
    }

    fn view(&mut self, bytes: Vec<u8>, target: u32) -> usize {
        let view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len(), "target": target });
        self.bytes.extend(bytes);
        self.push("bufferViews", view)
    }

    fn list(&mut self, kind: &str) -> &mut Vec<Value> {
        self.json[kind].as_array_mut().unwrap()
    }

    pub fn push(&mut self, kind: &str, object: Value) -> usize {
        self.list(kind).push(object);
        self.list(kind).len() - 1
    }

    /// The file (glTF 2.0, section 4.4).
    pub fn glb(mut self) -> Vec<u8> {
        self.json["buffers"][0]["byteLength"] = self.bytes.len().into();
        let mut json = serde_json::to_vec(&self.json).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let word = |number: usize| (number as u32).to_le_bytes();
        let header = [*b"glTF", word(2), word(12 + 8 + json.len() + 8 + self.bytes.len())].concat();
        let chunk = |bytes: &[u8], kind: &[u8; 4]| [&word(bytes.len()), kind.as_slice(), bytes].concat();
        [header, chunk(&json, b"JSON"), chunk(&self.bytes, b"BIN\0")].concat()
    }

    /// What a .glb holds.
    fn read(folder: &Folder, name: &str) -> Self {
        let file = std::fs::read(folder.path(name)).unwrap();
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&file[..4], word(4), word(8)), (b"glTF".as_slice(), 2, file.len()));
        let end = 20 + word(12);
        let json = serde_json::from_slice(&file[20..end]).unwrap();
        assert_eq!(&file[end + 4..end + 8], b"BIN\0");
        Self { json, bytes: file[end + 8..end + 8 + word(end)].to_vec() }
    }

    /// The numbers of an accessor: 32-bit floats, one after the other.
    fn numbers(&self, accessor: &Value, kind: &str) -> Vec<f32> {
        let accessor = &self.json["accessors"][accessor.as_u64().expect("there is such an accessor") as usize];
        assert_eq!((&accessor["componentType"], &accessor["type"]), (&json!(5126), &json!(kind)));
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let number = |object: &Value, field: &str| object[field].as_u64().unwrap_or(0) as usize;
        let size = 4 * kind.trim_start_matches("VEC").parse::<usize>().unwrap();
        let stride = view["byteStride"].as_u64().map_or(size, |stride| stride as usize);
        let begin = number(view, "byteOffset") + number(accessor, "byteOffset");
        let elements = (0..number(accessor, "count")).map(|element| &self.bytes[begin + element * stride..][..size]);
        elements.flat_map(|bytes| bytes.chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap()))).collect()
    }

    /// The indices of a primitive.
    fn indices(&self, primitive: &Value) -> Vec<u32> {
        let accessor = &self.json["accessors"][primitive["indices"].as_u64().unwrap() as usize];
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let begin = (view["byteOffset"].as_u64().unwrap_or(0) + accessor["byteOffset"].as_u64().unwrap_or(0)) as usize;
        let count = accessor["count"].as_u64().unwrap() as usize;
        let bytes = &self.bytes[begin..];
        match accessor["componentType"].as_u64().unwrap() {
            5123 => bytes.chunks(2).take(count).map(|b| u16::from_le_bytes([b[0], b[1]]).into()).collect(),
            5125 => bytes.chunks(4).take(count).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect(),
            other => panic!("indices of the type {other}"),
        }
    }
}

fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

/// Fails unless the first primitive of mesh `index` in `model` is `mesh` with these tangents.
#[track_caller]
fn assert_tangents(model: &Model, index: usize, mesh: &Mesh, expected: &Tangents) {
    let primitive = &model.json["meshes"][index]["primitives"][0];
    let attributes = &primitive["attributes"];
    let numbers = |name: &str, kind| bits(&model.numbers(&attributes[name], kind));
    assert!(!expected.tangents.is_empty());
    assert!(numbers("TANGENT", "VEC4") == bits(expected.tangents.as_flattened()), "other tangents than the library's");
    let sources = || expected.sources().map(|source| source as usize);
    let positions: Vec<_> = sources().map(|source| mesh.positions()[source]).collect();
    assert!(numbers("POSITION", "VEC3") == bits(positions.as_flattened()), "other positions");
    let texcoords: Vec<_> = sources().map(|source| mesh.texcoords()[source]).collect();
    assert!(numbers("TEXCOORD_0", "VEC2") == bits(texcoords.as_flattened()), "other texture coordinates");
    let own: Option<Vec<_>> = mesh.normals().map(|normals| sources().map(|source| normals[source]).collect());
    let normals = expected.normals.clone().or(own).unwrap();
    assert!(numbers("NORMAL", "VEC3") == bits(normals.as_flattened()), "other normals");
    let triangles = expected.triangles.as_deref().unwrap_or(mesh.triangles());
    assert!(model.indices(primitive) == triangles.as_flattened(), "other triangles");
}

fn without_normals(mesh: &Mesh) -> Mesh {
    Mesh::new(mesh.positions().to_vec(), mesh.texcoords().to_vec(), mesh.triangles().to_vec()).unwrap()
}

#[test]
fn tangents_are_the_librarys() {
    let folder = Folder::new();
    let mesh = sheet(12, 9);
    folder.file("model.glb", Model::new().with("sheet", &mesh, 0).glb());
    for method in [TangentMethod::Mikktspace, TangentMethod::Lengyel, TangentMethod::Hegde] {
        for convention in [Convention::Gl, Convention::Dx] {
            let options = TangentOptions { method, convention, ..TangentOptions::default() };
            let expected = Baker::reference().tangents(&mesh, &options).unwrap();
            assert_eq!(expected.report.mirrored, 10, "a column of vertices");
            let (method, convention) = (method.to_string(), convention.to_string());
            let arguments = ["tangents", "model.glb", "-o", "new/model.glb"];
            let options = ["--method", &method, "--convention", &convention];
            let run = folder.run(&[&arguments[..], &options].concat()).ends(0);
            assert_tangents(&Model::read(&folder, "new/model.glb"), 0, &mesh, &expected);
            assert_eq!(run.stdout, "");
            let copies = expected.report.copies;
            run.line(&format!(
                "new/model.glb: 1 of 1 primitive, 130 vertices, 216 triangles, {method}, exact, {convention}, \
                 {copies} made by splits, 10 between mirrored halves; "
            ));
            assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
        }
    }
}

#[test]
fn every_option_reaches_the_library() {
    let folder = Folder::new();
    let mesh = without_normals(&sheet(6, 5));
    folder.file("model.glb", Model::new().with("sheet", &mesh, 0).glb());
    let lengyel = TangentOptions { method: TangentMethod::Lengyel, ..TangentOptions::default() };
    let cases: [(&[&str], TangentOptions); 4] = [
        (&["--normals", "flat"], lengyel),
        (&["--normals", "smooth"], TangentOptions { missing_normals: MissingNormals::Smooth, ..lengyel }),
        (&["--weld-seams", "90"], TangentOptions { weld_seams: Some(90.0), ..lengyel }),
        (&["--unwrap", "--backend", "reference"], TangentOptions { unwrap: true, ..lengyel }),
    ];
    for (options, expected) in cases {
        let expected = Baker::reference().tangents(&mesh, &expected).unwrap();
        let arguments = ["tangents", "model.glb", "-o", "out.glb", "--method", "lengyel", "--bitangent"];
        let run = folder.run(&[&arguments[..], options].concat()).ends(0);
        let model = Model::read(&folder, "out.glb");
        assert_tangents(&model, 0, &mesh, &expected);
        let bitangents = model.numbers(&model.json["meshes"][0]["primitives"][0]["attributes"]["_BITANGENT"], "VEC3");
        assert_eq!(bits(&bitangents), bits(expected.bitangents(&mesh).unwrap().as_flattened()));
        run.says("warning: vertices without a normal: 42 (mesh 0 \"sheet\", primitive 0): ", &[]);
        run.says("out.glb: 1 of 1 primitive", &[", 42 with made normals; "]);
    }
    // Without the option there are none.
    folder.run(&["tangents", "model.glb", "-o", "out.glb"]).ends(0);
    let again = folder.run(&["tangents", "out.glb", "-o", "again.glb"]).ends(0);
    again.line("exact, gl, tangents of 1 primitive replaced");
    let attributes = &Model::read(&folder, "out.glb").json["meshes"][0]["primitives"][0]["attributes"];
    assert_eq!((attributes["TANGENT"].is_u64(), &attributes["_BITANGENT"]), (true, &Value::Null));
}

#[test]
fn a_folder_takes_the_name_of_the_input() {
    let folder = Folder::new();
    folder.file("a/model.glb", Model::new().with("sheet", &sheet(2, 2), 0).glb());
    std::fs::create_dir(folder.path("there")).unwrap();
    folder.run(&["tangents", "a/model.glb", "-o", "out/new/", "-q"]).ends(0);
    folder.run(&["tangents", "a/model.glb", "-o", "there", "-q"]).ends(0);
    assert_eq!(folder.files("."), ["a/model.glb", "out/new/model.glb", "there/model.glb"]);
}

#[test]
fn an_obj_becomes_a_glb() {
    let folder = Folder::new();
    folder.file("scan.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    folder.run(&["tangents", "scan.obj", "-o", "out/", "--normals", "smooth", "--method", "lengyel"]).ends(0);
    let model = Model::read(&folder, "out/scan.glb");
    let primitive = &model.json["meshes"][0]["primitives"][0];
    // u grows along x; v of an OBJ grows up, where green points.
    assert_eq!(model.numbers(&primitive["attributes"]["TANGENT"], "VEC4"), [1.0, 0.0, 0.0, 1.0].repeat(4));
    assert_eq!(model.numbers(&primitive["attributes"]["NORMAL"], "VEC3"), [0.0, 0.0, 1.0].repeat(4));
    assert_eq!(model.indices(primitive).len(), 6);
}

#[test]
fn only_primitives_with_a_normal_map_are_taken() {
    let folder = Folder::new();
    let (first, second) = (sheet(4, 3), sheet(3, 5));
    let mut model = Model::new().with("first", &first, 0).with("second", &second, 1);
    model.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(json!({
        "attributes": { "POSITION": 0 }, "mode": 0, "material": 0
    }));
    folder.file("model.glb", model.glb());

    let run = folder.run(&["tangents", "model.glb", "-o", "out.glb"]).ends(0);
    let expected = |mesh| Baker::reference().tangents(mesh, &TangentOptions::default()).unwrap();
    let model = Model::read(&folder, "out.glb");
    assert_tangents(&model, 0, &first, &expected(&first));
    assert_eq!(model.json["meshes"][1]["primitives"][0]["attributes"]["TANGENT"], Value::Null);
    run.line("out.glb: 1 of 3 primitives, 20 vertices, 24 triangles");
    run.says("warning: left out: mesh 1 \"second\", primitive 0: ", &["no normal map", "--all"]);
    run.says("warning: left out: mesh 0 \"first\", primitive 1: ", &["points"]);

    folder.run(&["tangents", "model.glb", "-o", "out.glb", "--all"]).ends(0).line("out.glb: 2 of 3 primitives, ");
    let model = Model::read(&folder, "out.glb");
    assert_tangents(&model, 0, &first, &expected(&first));
    assert_tangents(&model, 1, &second, &expected(&second));
}

#[test]
fn a_model_without_a_normal_map_is_written_with_a_warning() {
    let folder = Folder::new();
    folder.file("model.glb", Model::new().with("plain", &sheet(2, 2), 1).glb());
    let run = folder.run(&["tangents", "model.glb", "-o", "out.glb"]).ends(0);
    run.says("warning: no primitive got tangents", &[]);
    run.says("warning: left out: ", &["mesh 0 \"plain\", primitive 0", "--all"]);
    run.line("out.glb: 0 of 1 primitive, 0 vertices, 0 triangles");
    assert!(folder.path("out.glb").exists());
}

#[test]
fn everything_else_stays_as_it_was() {
    let folder = Folder::new();
    let mut model = Model::new().with("sheet", &sheet(4, 4), 0);
    model.json["extensionsUsed"] = json!(["VENDOR_unknown"]);
    model.json["extensions"] = json!({ "VENDOR_unknown": { "list": [1, 2.5, "three", null], "index": 3 } });
    model.json["extras"] = json!({ "made by": "hand" });
    model.json["nodes"][0]["extensions"] = json!({ "VENDOR_unknown": { "z": 1, "a": 2 } });
    model.json["asset"]["generator"] = "a test".into();
    model.json["materials"][1]["extras"] = json!([true]);
    let before = model.json.clone();
    folder.file("model.glb", model.glb());
    folder.run(&["tangents", "model.glb", "-o", "out.glb"]).ends(0);
    let after = Model::read(&folder, "out.glb").json;
    for (key, value) in before.as_object().unwrap() {
        if !["accessors", "bufferViews", "buffers", "meshes"].contains(&key.as_str()) {
            assert_eq!(after[key], *value, "{key}");
        }
    }
    assert_eq!(after["meshes"][0]["name"], "sheet");
}

#[test]
fn what_is_wrong_with_a_mesh_is_said_and_counted() {
    let folder = Folder::new();
    // One triangle of which the texture is a point, and normals that are none or too long.
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = Mesh::new(positions, vec![[0.5, 0.5]; 3], vec![[0, 1, 2]]).unwrap();
    let mesh = mesh.with_normals(vec![[0.0; 3], [0.0, 0.0, 2.0], [0.0, 0.0, 1.0]]).unwrap();
    folder.file("model.glb", Model::new().with("speck", &mesh, 0).glb());
    let run = folder.run(&["tangents", "model.glb", "-o", "out.glb", "--report", "r.json"]).ends(0);
    run.says("warning: undirected vertices: 3 (mesh 0 \"speck\", primitive 0): ", &["no area in the texture"]);
    run.says("warning: vertices whose normal is zero: 1 (mesh 0 \"speck\", primitive 0): ", &["smooth"]);
    run.says("warning: vertices whose normal is not of unit length: 1 (mesh 0 ", &["normalised"]);
    run.says(
        "out.glb: 1 of 1 primitive, 3 vertices, 1 triangle, ",
        &["3 undirected, 2 with repaired normals, 1 triangle without area in the texture; "],
    );
    let report = folder.json("r.json");
    let total = &report["total"];
    assert_eq!([&total["undirected"], &total["normals_made"], &total["normals_normalised"]], [3, 1, 1]);
    assert_eq!(report["warnings"].as_array().unwrap().len(), 3);
    let model = Model::read(&folder, "out.glb");
    let tangents = model.numbers(&model.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"], "VEC4");
    assert!(tangents.chunks(4).all(|t| t[..3] == [1.0, 0.0, 0.0]), "{tangents:?}");
}

/// Squares side by side around a cylinder, of which the last one shares the vertices of the first; they are lower
/// than half of the texture.
fn cylinder(squares: u32) -> Mesh {
    let vertices = || (0..squares).flat_map(|i| [(i, 0.0), (i, 1.0)]);
    let around = |i: u32| (i as f32 * std::f32::consts::TAU / squares as f32).sin_cos();
    let positions = vertices().map(|(i, z)| [around(i).1, around(i).0, z]).collect();
    let texcoords = vertices().map(|(i, z)| [i as f32 / squares as f32, 0.4 * (1.0 - z)]).collect();
    let normals = vertices().map(|(i, _)| [around(i).1, around(i).0, 0.0]).collect();
    let square = |i: u32| {
        let [a, b, c, d] = [2 * i, 2 * ((i + 1) % squares), 2 * ((i + 1) % squares) + 1, 2 * i + 1];
        [[a, b, c], [a, c, d]]
    };
    Mesh::new(positions, texcoords, (0..squares).flat_map(square).collect()).unwrap().with_normals(normals).unwrap()
}

#[test]
fn a_jump_from_1_to_0_is_hinted_at() {
    let folder = Folder::new();
    folder.file("pipe.glb", Model::new().with("pipe", &cylinder(12), 0).glb());
    let run = folder.run(&["tangents", "pipe.glb", "-o", "out.glb"]).ends(0);
    run.says(
        "warning: triangles whose u spans more than half of the texture: 2 (mesh 0 \"pipe\", primitive 0): ",
        &["if it jumps from 1 to 0 there, --unwrap"],
    );
    run.says("out.glb: ", &[", 2 triangles across more than half of the texture; "]);
    let run = folder.run(&["tangents", "pipe.glb", "-o", "out.glb", "--unwrap"]).ends(0);
    run.says("out.glb: ", &[", 2 triangles unwrapped; "]);
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
}

#[test]
fn a_square_of_the_whole_texture_is_right_with_and_without_unwrap() {
    let folder = Folder::new();
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let texcoords = vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    let square = Mesh::new(positions, texcoords, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let square = square.with_normals(vec![[0.0, 0.0, 1.0]; 4]).unwrap();
    folder.file("square.glb", Model::new().with("square", &square, 0).glb());
    for options in [&["--unwrap"][..], &[]] {
        let run = folder.run(&[&["tangents", "square.glb", "-o", "out.glb"], options].concat()).ends(0);
        // The line of what was done, and no warning.
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    }
}

#[test]
fn other_commands_send_models_here() {
    let folder = Folder::new();
    folder.file("model.glb", Model::new().with("sheet", &sheet(2, 2), 0).glb());
    folder.file("scan.obj", "v 0 0 0\n");
    for arguments in [
        ["normal", "model.glb", "-o", "n.png"].as_slice(),
        &["normal", "scan.obj", "-o", "n.png"],
        &["check", "model.glb"],
        &["diff", "model.glb", "model.glb"],
    ] {
        folder.run(arguments).ends(1).says("no format that texbake knows", &["models are for texbake tangents"]);
    }
}

#[test]
fn the_report_holds_every_count() {
    let folder = Folder::new();
    let mesh = sheet(12, 9);
    folder.file("model.glb", Model::new().with("sheet", &mesh, 0).with("plain", &mesh, 1).glb());
    let arguments = ["tangents", "model.glb", "-o", "out.glb", "--method", "hegde", "--backend", "reference", "-q"];
    let run = folder.run(&[&arguments[..], &["--weld-seams", "2.5", "--report", "r.json"]].concat()).ends(0);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));

    let options = TangentOptions { method: TangentMethod::Hegde, weld_seams: Some(2.5), ..TangentOptions::default() };
    let found = Baker::reference().tangents(&mesh, &options).unwrap().report;
    let mut report = folder.json("r.json");
    let mut take = |key: &str| report.as_object_mut().unwrap().remove(key).unwrap();
    for time in ["milliseconds", "compute_milliseconds"] {
        assert!(take(time).as_f64().unwrap() > 0.0, "{time}");
    }
    let (primitives, left_out) = (take("primitives"), take("left_out"));
    assert_eq!(left_out.as_array().unwrap().len(), 1);
    assert_eq!(left_out[0]["name"], "mesh 1 \"plain\", primitive 0");
    assert!(left_out[0]["reason"].as_str().unwrap().contains("--all"), "{left_out}");
    let counts = json!({
        "triangles": 216, "vertices": 130, "copies": 10, "mirrored": 10, "without_area": 0,
        "without_texture_area": 0, "jumps": 0, "unused": 0, "undirected": 0, "normals_made": 0,
        "normals_normalised": 0, "welded": found.welded,
    });
    assert_eq!(take("total"), counts);
    let mut primitive = counts;
    primitive["name"] = "mesh 0 \"sheet\", primitive 0".into();
    (primitive["shared_by"], primitive["had_tangents"], primitive["has_normals"]) = (1.into(), 0.into(), true.into());
    assert_eq!(primitives, json!([primitive]));
    let warnings = take("warnings");
    assert_eq!(warnings.as_array().unwrap().len(), 1, "{warnings}");
    let bytes = |name: &str| std::fs::metadata(folder.path(name)).unwrap().len();
    assert_eq!(
        report,
        json!({
            "version": env!("CARGO_PKG_VERSION"), "input": "model.glb", "output": "out.glb", "result": "baked",
            "options": {
                "method": "hegde", "convention": "gl", "precision": "exact", "normals": "flat", "unwrap": false,
                "weld_seams": 2.5, "bitangent": false, "all": false, "max_bytes": 4_294_967_296u64,
            },
            "error": null, "backend": "cpu", "adapter": "reference, 1 thread", "reason": "asked for",
            "fallback": null, "bytes_in": bytes("model.glb"), "bytes_out": bytes("out.glb"),
            "files_read": [{ "path": "model.glb", "bytes": bytes("model.glb") }],
            "files_written": [{ "path": "out.glb", "bytes": bytes("out.glb") }],
        })
    );
}

#[test]
fn refusals_name_the_file_and_the_way_out() {
    let folder = Folder::new();
    let mesh = sheet(2, 2);
    let model = || Model::new().with("sheet", &mesh, 0);
    folder.file("model.glb", model().glb());
    folder.file("folder/keep.txt", "");
    folder.file("text.glb", "no model");
    let mut nan = model();
    nan.bytes[0..4].copy_from_slice(&f32::NAN.to_le_bytes());
    folder.file("nan.glb", nan.glb());
    let mut index = model();
    let end = index.bytes.len();
    index.bytes[end - 4..].copy_from_slice(&9u32.to_le_bytes());
    folder.file("index.glb", index.glb());
    let mut draco = model();
    draco.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    draco.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    draco.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": {} } });
    folder.file("draco.glb", draco.glb());
    let away = json!({ "asset": { "version": "2.0" }, "buffers": [{ "uri": "away.bin", "byteLength": 4 }] });
    folder.file("away.gltf", away.to_string());
    let before = folder.files(".");

    let cases: [(&[&str], &[&str]); 12] = [
        (&["missing.glb", "-o", "o.glb"], &["missing.glb: ", "check how its path is written"]),
        (&["text.glb", "-o", "o.glb"], &["text.glb: ", ".glb, .gltf and .obj"]),
        (&["model.glb", "-o", "model.glb"], &["model.glb", "would overwrite this input", "another output"]),
        (&["model.glb", "-o", "./folder/../model.glb"], &["would overwrite this input", "another output"]),
        (&["folder", "-o", "o.glb"], &["folder: it is a folder; name a model file", "for model in folder/*.glb"]),
        (&["-o", "out/", "folder/"], &["folder/: it is a folder; name a model file"]),
        (&["away.gltf", "-o", "o.glb"], &["away.gltf: it refers to \"away.bin\", which cannot be read"]),
        (&["model.glb", "-o", "o.obj"], &["o.obj: ", ".glb or .gltf", "folder in /"]),
        (&["nan.glb", "-o", "o.glb"], &["nan.glb: mesh 0 \"sheet\", primitive 0: the position of vertex 0 is [NaN"]),
        (
            &["index.glb", "-o", "o.glb"],
            &["index.glb: mesh 0 \"sheet\", primitive 0: its index is 9 (triangle 7: [", "below 9"],
        ),
        (&["draco.glb", "-o", "o.glb"], &["draco.glb: ", "KHR_draco_mesh_compression", "without compression"]),
        (&["model.glb", "-o", "o.glb", "--max-bytes", "100"], &["model.glb: ", "100", "--max-bytes"]),
    ];
    for (arguments, parts) in cases {
        let run = folder.run(&[&["tangents"], arguments].concat()).ends(1);
        run.says("error: ", parts);
        assert_eq!(run.stdout, "", "{arguments:?}");
    }
    let report = folder.run(&["tangents", "model.glb", "-o", "o.glb", "--report", "model.glb"]).ends(1);
    report.says("error: ", &["the report would overwrite the input model.glb", "another name for the report"]);
    assert_eq!(folder.files("."), before);
}

#[test]
fn wrong_arguments_end_with_2() {
    let folder = Folder::new();
    let cases: [(&[&str], &[&str]); 9] = [
        (&["m.glb"], &["--output <FILE>"]),
        (&["-o", "o.glb"], &["<MODEL>"]),
        (&["m.glb", "-o", "o.glb", "--method", "mikk"], &["'mikk' for '--method", "mikktspace, lengyel, hegde"]),
        (&["m.glb", "-o", "o.glb", "--normals", "none"], &["'none' for '--normals", "flat, smooth"]),
        (&["m.glb", "-o", "o.glb", "--weld-seams", "91"], &["'91' for '--weld-seams", "degrees from 0 to 90"]),
        (&["m.glb", "-o", "o.glb", "--weld-seams", "-1"], &["'-1' for '--weld-seams", "degrees from 0 to 90"]),
        (&["m.glb", "-o", "o.glb", "--weld-seams", "NaN"], &["'NaN' for '--weld-seams", "degrees from 0 to 90"]),
        (&["m.glb", "-o", "o.glb", "--convention", "up"], &["'up' for '--convention", "gl, dx"]),
        (&["m.glb", "-o", "o.glb", "--backend", "cpu", "--adapter", "x"], &["--adapter is x", "--backend gpu"]),
    ];
    for (arguments, parts) in cases {
        let run = folder.run(&[&["tangents"], arguments].concat()).ends(2);
        for part in parts {
            assert!(run.stderr.contains(part), "{arguments:?}: {part:?} is not in {}", run.stderr);
        }
    }
    assert!(folder.files(".").is_empty());
}

#[test]
fn what_help_shows_works() {
    let folder = Folder::new();
    let model = || Model::new().with("sheet", &sheet(3, 3), 0).glb();
    folder.file("model.glb", model());
    folder.file("pipe.glb", model());
    folder.file("scan.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n");
    // A .glb is a .gltf by its first bytes.
    folder.file("model.gltf", model());
    let help = folder.run(&["tangents", "--help"]).ends(0).stdout;
    let examples: Vec<&str> = help.lines().filter(|line| line.starts_with("  texbake tangents ")).collect();
    assert_eq!(examples.len(), 4, "{help}");
    for example in examples {
        let arguments: Vec<&str> = example.split_whitespace().skip(1).collect();
        folder.run(&arguments).ends(0);
    }
    assert!(folder.path("out/model.gltf").exists());
}

#[test]
fn primitives_that_are_the_same_are_computed_once() {
    let folder = Folder::new();
    let mesh = sheet(4, 3);
    let mut model = Model::new().with("first", &mesh, 0);
    let same = model.json["meshes"][0]["primitives"][0].clone();
    model.push("meshes", json!({ "name": "second", "primitives": [same] }));
    folder.file("model.glb", model.glb());
    let run = folder.run(&["tangents", "model.glb", "-o", "out.glb", "--report", "r.json"]).ends(0);
    // 20 vertices, not 40.
    run.line("out.glb: 2 of 2 primitives, 20 vertices, 24 triangles, ");
    assert_eq!(folder.json("r.json")["primitives"][0]["shared_by"], 2);
    let expected = Baker::reference().tangents(&mesh, &TangentOptions::default()).unwrap();
    let model = Model::read(&folder, "out.glb");
    assert_tangents(&model, 0, &mesh, &expected);
    assert_tangents(&model, 1, &mesh, &expected);
}
