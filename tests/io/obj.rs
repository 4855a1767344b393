//! OBJ files as models.

use super::support::Folder;
use serde_json::json;
use texbake::io::{Model, ModelReport};
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
    assert!(message("f 1 2 3\n").contains("m.obj: it is not OBJ: "));
    assert!(Model::read(folder.path("none.obj")).unwrap_err().to_string().ends_with("check how its path is written"));
    // A missing library of materials is none of the meshes' business.
    let path = folder.file("m.obj", SQUARE.as_bytes());
    assert_eq!(Model::read(path).unwrap().primitives().len(), 2);
}
