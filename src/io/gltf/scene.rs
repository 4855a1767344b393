//! Where the nodes of a scene put meshes.

use super::document::Document;
use crate::error::Result;
use serde_json::Value;
use std::collections::BTreeMap;

/// A place in a scene: what x, y and z of a mesh become, and where its origin goes.
pub type Placement = [[f32; 3]; 4];

/// A mesh that no node moves.
pub(super) const UNMOVED: Placement = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];

/// In f64, as nodes multiply.
type Matrix = [[f64; 3]; 4];

/// The places of each mesh, by its number, in the scene that the file shows first, or, of a file without scenes, in any;
/// where no node of it has a mesh, that one is not among them. Skins move nothing here.
pub(super) fn placements(document: &Document) -> Result<BTreeMap<u64, Vec<Placement>>> {
    let scene = document.json["scene"].as_u64().unwrap_or(0) as usize;
    let roots = match document.list("scenes").get(scene) {
        Some(scene) => indices(document, scene, "nodes")?,
        None => (0..document.list("nodes").len()).collect(),
    };
    let mut waiting: Vec<(usize, Matrix)> =
        roots.into_iter().map(|node| (node, UNMOVED.map(|column| column.map(f64::from)))).collect();
    let (mut found, mut seen) = (BTreeMap::<u64, Vec<_>>::new(), vec![false; document.list("nodes").len()]);
    while let Some((index, parent)) = waiting.pop() {
        let node = document.object("nodes", index)?;
        // A node has one parent: what comes again goes round in a circle, or stands twice.
        if std::mem::replace(&mut seen[index], true) {
            continue;
        }
        let place = product(parent, matrix(document, index, node)?);
        waiting.extend(indices(document, node, "children")?.into_iter().map(|child| (child, place)));
        if let Some(mesh) = node["mesh"].as_u64() {
            found.entry(mesh).or_default().push(place.map(|column| column.map(|part| part as f32)));
        }
    }
    Ok(found)
}

fn indices(document: &Document, object: &Value, field: &str) -> Result<Vec<usize>> {
    let Some(list) = object.get(field) else { return Ok(Vec::new()) };
    let list = list.as_array().and_then(|list| list.iter().map(|it| Some(it.as_u64()? as usize)).collect());
    list.ok_or_else(|| document.damaged(format!("its {field} are no list of numbers")))
}

/// A node's matrix, or its scale, rotation (a quaternion) and translation, in this order.
fn matrix(document: &Document, index: usize, node: &Value) -> Result<Matrix> {
    let numbers = |field: &str, absent: &[f64]| match node.get(field) {
        None => Ok(absent.to_vec()),
        Some(list) => {
            let list: Option<Vec<f64>> = list.as_array().and_then(|list| list.iter().map(Value::as_f64).collect());
            let list = list.filter(|list| list.len() == absent.len());
            list.ok_or_else(|| document.damaged(format!("{field} of nodes[{index}] is not {} numbers", absent.len())))
        }
    };
    if node.get("matrix").is_some() {
        let m = numbers("matrix", &[0.0; 16])?;
        return Ok([0, 4, 8, 12].map(|column| [m[column], m[column + 1], m[column + 2]]));
    }
    let (t, s) = (numbers("translation", &[0.0; 3])?, numbers("scale", &[1.0; 3])?);
    let q = numbers("rotation", &[0.0, 0.0, 0.0, 1.0])?;
    let [x, y, z, w] = [q[0], q[1], q[2], q[3]];
    Ok([
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)].map(|part| s[0] * part),
        [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)].map(|part| s[1] * part),
        [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)].map(|part| s[2] * part),
        [t[0], t[1], t[2]],
    ])
}

/// What a child's place is in its parent's space.
fn product(parent: Matrix, child: Matrix) -> Matrix {
    let turned = |v: [f64; 3]| [0, 1, 2].map(|row| (0..3).map(|column| parent[column][row] * v[column]).sum::<f64>());
    let [x, y, z, origin] = child.map(turned);
    [x, y, z, [0, 1, 2].map(|row| origin[row] + parent[3][row])]
}
