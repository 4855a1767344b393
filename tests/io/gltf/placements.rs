//! Where the nodes of a scene put meshes, and nodes that are damaged.

use super::Builder;
use serde_json::{Value, json};
use texbake::io::Placement;

const UNMOVED: Placement = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]];

/// The places of the square in a file with these nodes and scenes.
fn placements(nodes: Value, scenes: Value) -> texbake::Result<Vec<Placement>> {
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    file.json["nodes"] = nodes;
    file.json["scenes"] = scenes;
    Ok(file.model().placements()?.remove(0))
}

#[test]
fn nodes_move_turn_and_scale_what_is_below_them() {
    // A quarter turn around z.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = json!([
        { "translation": [10, 0, 0], "rotation": [0, 0, half, half], "scale": [2, 3, 4], "children": [1, 2] },
        { "mesh": 0, "translation": [1, 1, 1] },
        { "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1], "mesh": 0 },
    ]);
    let mut found = placements(nodes, json!([{ "nodes": [0] }])).unwrap();
    found.sort_by(|a, b| a[3][2].total_cmp(&b[3][2]));
    // x goes to 2y, y to -3x, z to 4z: the origin (1, 1, 1) to (10 - 3, 2, 4), and (5, 6, 7) to (10 - 18, 10, 28).
    let axes = [[0.0, 2.0, 0.0], [-3.0, 0.0, 0.0], [0.0, 0.0, 4.0]];
    let expected =
        [[axes[0], axes[1], axes[2], [7.0, 2.0, 4.0]], [[0.0, -2.0, 0.0], axes[1], axes[2], [-8.0, 10.0, 28.0]]];
    assert_eq!(found.len(), 2);
    for (found, expected) in found.as_flattened().as_flattened().iter().zip(expected.as_flattened().as_flattened()) {
        // Of numbers up to 28, in f32.
        assert!((found - expected).abs() < 4e-6, "{found} {expected}");
    }
}

#[test]
fn only_the_scene_that_is_shown_counts() {
    let nodes = || json!([{ "mesh": 0, "translation": [1, 0, 0] }, { "translation": [2, 0, 0], "mesh": 0 }, {}]);
    let at = |x: f32| vec![[UNMOVED[0], UNMOVED[1], UNMOVED[2], [x, 0.0, 0.0]]];
    assert_eq!(placements(nodes(), json!([{ "nodes": [1] }, { "nodes": [0] }])).unwrap(), at(2.0));
    // No node of the scene has it.
    assert_eq!(placements(nodes(), json!([{ "nodes": [2] }])).unwrap(), at(0.0));
}

#[test]
fn nodes_that_are_damaged_are_refused_and_circles_end() {
    let scene = || json!([{ "nodes": [0] }]);
    let circle = json!([{ "children": [1] }, { "mesh": 0, "children": [0, 1] }]);
    assert_eq!(placements(circle, scene()).unwrap(), [UNMOVED]);
    for (nodes, part) in [
        (json!([{ "children": [7] }]), "nodes[7], which it does not have"),
        (json!([{ "children": "all" }]), "its children are no list of numbers"),
        (json!([{ "scale": [1, 2] }]), "scale of nodes[0] is not 3 numbers"),
        (json!([{ "matrix": [1, 2, "x"] }]), "matrix of nodes[0] is not 16 numbers"),
    ] {
        let error = placements(nodes, scene()).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}
