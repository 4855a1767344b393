//! OBJ files as models.

use super::support::Folder;
use serde_json::json;
use texbake::io::{Model, ModelReadOptions, ModelReport};
use texbake::{Baker, TangentOptions};

/// A square and a triangle of it with another material, as a modeller writes them.
const SQUARE: &str = "mtllib m.mtl\n\
    o square\n\
    v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n\
    vt 0 0\nvt 1 0\nvt 1 0.75\nvt 0 0.75\n\
    vn 0 0 1\n\
    usemtl red\n\
    f 1/1/1 2/2/1 3/3/1 4/4/1\n\
    o corner\n\
    usemtl rough\n\
    f -4/-4 -3/-3 -2/-2\n\
    o bare\nusemtl red\n\
    f 1 2 3\n";

#[test]
fn faces_become_triangles_with_v_growing_down() {
    let folder = Folder::new();
    folder.file("m.mtl", b"newmtl red\nKd 1 0.5 0.25\nnewmtl rough\nnorm -bm 2 n.png\nnewmtl lost\nnorm none.png\n");
    folder.file("n.png", b"an image");
    let path = folder.file("m.OBJ", SQUARE.as_bytes());
    let mut model = Model::read(&path).unwrap();
    assert_eq!(model.report(), ModelReport { primitives: 2, shared: 0, left_out: 1 });
    let names: Vec<&str> = model.primitives().iter().map(|primitive| primitive.name.as_str()).collect();
    assert_eq!(names, ["mesh 0 \"square\", primitive 0", "mesh 1 \"corner\", primitive 0"]);
    assert_eq!(model.left_out()[0].name, "mesh 2 \"bare\", primitive 0");
    assert_eq!(model.left_out()[0].reason, "it has no TEXCOORD_0");

    let square = model.mesh(0).unwrap();
    assert_eq!(square.positions(), [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
    assert_eq!(square.texcoords(), [[0.0, 1.0], [1.0, 1.0], [1.0, 0.25], [0.0, 0.25]]);
    assert_eq!(square.normals(), Some(&[[0.0, 0.0, 1.0]; 4][..]));
    assert_eq!(square.triangles(), [[0, 1, 2], [0, 2, 3]]);
    let corner = model.mesh(1).unwrap();
    assert_eq!((corner.normals(), corner.triangles()), (None, &[[0, 1, 2]][..]));

    let made = Baker::reference().tangents(&square, &TangentOptions::default()).unwrap();
    assert_eq!(made.tangents, [[1.0, 0.0, 0.0, 1.0]; 4]);
    model.set_tangents(0, made).unwrap();
    let flat = Baker::reference().tangents(&corner, &TangentOptions::default()).unwrap();
    model.set_tangents(1, flat).unwrap();
    model.write(folder.path("m.gltf")).unwrap();
    model.write(folder.path("m.glb")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(folder.path("m.gltf")).unwrap()).unwrap();
    assert_eq!(json["buffers"][0]["uri"], "m.bin");
    let materials = json!([
        { "name": "red", "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.5, 0.25, 1.0], "metallicFactor": 0.0 } },
        { "name": "rough", "normalTexture": { "index": 0 } },
        { "name": "lost" }
    ]);
    assert_eq!((&json["materials"], &json["images"]), (&materials, &json!([{ "uri": "n.png" }])));
    assert_eq!(json["meshes"][1]["primitives"][0]["material"], 1);
    for name in ["m.gltf", "m.glb"] {
        let written = Model::read(folder.path(name)).unwrap();
        assert_eq!(written.report(), ModelReport { primitives: 1, shared: 0, left_out: 2 });
        let again = written.mesh(0).unwrap();
        assert_eq!((again.positions(), again.normals()), (corner.positions(), Some(&[[0.0, 0.0, 1.0]; 3][..])));
    }
}

#[test]
fn what_is_no_model() {
    let folder = Folder::new();
    let message = |text: &str| Model::read(folder.file("m.obj", text.as_bytes())).unwrap_err().to_string();
    assert!(message("v 0 0 0\n").ends_with("m.obj: it has no faces; export the model as polygons"));
    assert!(message("f 1 2 3\n").contains("m.obj: line 1: a face refers to position 3 of 0"));
    assert!(Model::read(folder.path("none.obj")).unwrap_err().to_string().ends_with("check how its path is written"));
}

#[test]
fn errors_name_the_line() {
    let folder = Folder::new();
    for (text, reason) in [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n", "line 5: a face refers to position 4 of 3"),
        ("v 0 0 0\nf -2 1 1\n", "line 2: a face refers to position -2, and 1 stand before it"),
        ("v 0 0 0\nvt 0 0\nf 1/1 1/1 1/2\n", "line 3: a face refers to texture coordinate 2 of 1"),
        ("v 0,0 0 0\n", "line 1: \"0,0\" is no finite number"),
        ("v 0 0 0\nvn 1 0\n", "line 2: it has 2 of 3 numbers"),
        ("f a b c\n", "line 1: \"a\" is no corner of a face"),
        ("f 1/1/1/1 1 1\n", "line 1: \"1/1/1/1\" is no corner of a face"),
        ("f 0 1 1\n", "line 1: a face refers to position 0, and 0 stand before it"),
    ] {
        let message = Model::read(folder.file("m.obj", text.as_bytes())).unwrap_err().to_string();
        let expected = format!("m.obj: {reason}; it is not OBJ, or damaged; export the model again");
        assert!(message.ends_with(&expected), "{message}");
    }
    let path = folder.file("m.obj", SQUARE.as_bytes());
    let options = ModelReadOptions { max_bytes: SQUARE.len() as u64 + 1, ..Default::default() };
    let message = Model::read_with(path, &options).unwrap_err().to_string();
    assert!(message.ends_with("of the limit are left; raise it with --max-bytes"), "{message}");
}

/// The JSON of the model when it is written as .gltf beside it.
fn json_of(folder: &Folder, model: &Model) -> serde_json::Value {
    model.write(folder.path("written.gltf")).unwrap();
    serde_json::from_slice(&std::fs::read(folder.path("written.gltf")).unwrap()).unwrap()
}

#[test]
fn materials_keep_their_maps() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("tex")).unwrap();
    folder.file("tex/wood n.png", b"\x89PNG");
    folder.file("tex/wood.jpg", b"\xff\xd8\xff");
    folder.file("tex/wood.tga", b"tga");
    folder.file(
        "my mat.mtl",
        b"newmtl wood\nKd 1 1 1\nKe 0 0 0\nd 0.5\nmap_Kd tex\\wood.jpg\nmap_Bump -bm 1 -clamp on tex/wood n.png\n\
          newmtl plain\nillum 2\nmap_Kd tex/wood.tga\n",
    );
    let text = SQUARE.replace("m.mtl", "my mat.mtl").replace("red", "wood").replace("rough", "other");
    let model = Model::read(folder.file("m.obj", text.as_bytes())).unwrap();
    let [texture, dropped] = model.warnings() else { panic!("{:?}", model.warnings()) };
    let expected = "my mat.mtl: map_Kd tex/wood.tga: the texture is dropped: it is no PNG or JPEG file that exists, at a \
                    relative path";
    assert!(texture.ends_with(expected), "{texture}");
    assert!(dropped.ends_with("my mat.mtl: dropped, as texbake does not read it: Ke, d"), "{dropped}");
    let json = json_of(&folder, &model);
    let wood = json!({
        "name": "wood",
        "pbrMetallicRoughness": {
            "metallicFactor": 0.0, "baseColorFactor": [1.0, 1.0, 1.0, 1.0], "baseColorTexture": { "index": 0 }
        },
        "normalTexture": { "index": 1 }
    });
    assert_eq!(json["materials"], json!([wood, { "name": "plain" }, { "name": "other" }]));
    assert_eq!(json["images"], json!([{ "uri": "tex/wood.jpg" }, { "uri": "tex/wood%20n.png" }]));
    let files = model.write(folder.path("m.glb")).unwrap();
    assert_eq!((files.read.len(), files.written.len()), (4, 1));
    std::fs::remove_dir_all(folder.path("tex")).unwrap();
    assert_eq!(Model::read(folder.path("m.glb")).unwrap().warnings(), [""; 0]);

    // Without the library, names are left.
    std::fs::remove_file(folder.path("my mat.mtl")).unwrap();
    let model = Model::read(folder.path("m.obj")).unwrap();
    assert!(model.warnings().iter().all(|warning| warning.starts_with("its materials keep only their names: ")));
    assert!(!model.warnings().is_empty());
    assert_eq!(json_of(&folder, &model)["materials"], json!([{ "name": "wood" }, { "name": "other" }]));
}

#[test]
fn texts_of_any_age() {
    let folder = Folder::new();
    // Latin-1, a continued line, a comment behind, groups without an object, colours, a face without coordinates.
    let text = b"g R\xf6ck\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1 # a corner\nvt 0 0\nvt 1 0\nvt 0 1\n\
                 f 1/1 2/2 \\\n 3/3\nf 1 2/2 3/3\nl 1 2\n";
    let model = Model::read(folder.file("m.obj", text)).unwrap();
    assert_eq!(model.report(), ModelReport { primitives: 1, shared: 0, left_out: 1 });
    assert_eq!(model.primitives()[0].name, "mesh 0 \"R\u{fffd}ck\", primitive 0");
    assert_eq!(model.mesh(0).unwrap().positions().len(), 3);
    let json = json_of(&folder, &model);
    let primitives = &json["meshes"][0]["primitives"];
    assert_eq!(json["accessors"][primitives[0]["attributes"]["COLOR_0"].as_u64().unwrap() as usize]["type"], "VEC3");
    assert_eq!(primitives[1]["attributes"].get("TEXCOORD_0"), None);

    // No name is made up, and concave polygons are not covered twice.
    let text = "v 0 0 0\nv 2 2 0\nv 0 4 0\nv 1 2 0\nvt 0 0\nf 1/1 2/1 3/1 4/1\n";
    let model = Model::read(folder.file("n.obj", text.as_bytes())).unwrap();
    assert_eq!(model.primitives()[0].name, "mesh 0, primitive 0");
    let mesh = model.mesh(0).unwrap();
    let positions = mesh.triangles().iter().map(|triangle| triangle.map(|vertex| mesh.positions()[vertex as usize][1]));
    assert_eq!(positions.collect::<Vec<_>>(), [[2.0, 0.0, 2.0], [2.0, 4.0, 2.0]]);
}
