//! Duplicates at one position whose tangents are nearly equal become equal (FGED2, end of section 7.5).

use super::finish::Vertices;
use super::{bits_of_value, project, unit};
use crate::mesh::Mesh;
use crate::vector::{add, dot, sub};
use std::collections::HashMap;

/// Averages the tangents of vertices that have position and handedness in common and whose tangents and normals lie at
/// most `degrees` from those of the first of them that has not been averaged. Where normals differ, by rounding say,
/// each vertex projects the average for itself. Tells how many vertices have another tangent now.
pub(super) fn weld_seams(mesh: &Mesh, vertices: &mut Vertices<'_>, degrees: f32) -> usize {
    let own = mesh.positions().len();
    let mut places = HashMap::<_, Vec<usize>>::new();
    for vertex in (0..vertices.tangents.len()).filter(|&vertex| vertices.is_directed[vertex]) {
        let source = vertex.checked_sub(own).map_or(vertex, |copy| vertices.copies[copy] as usize);
        let place = (bits_of_value(mesh.positions()[source]), vertices.tangents[vertex][3] > 0.0);
        places.entry(place).or_default().push(vertex);
    }

    // The square of the chord: near an angle of zero, where cosines are all 1, it is as precise as anywhere.
    let chord = 2.0 * libm::sinf(0.5 * degrees.to_radians());
    let greatest = chord * chord;
    let mut welded = 0;
    for mut rest in places.into_values().filter(|vertices| vertices.len() > 1) {
        while let [first, ..] = rest[..] {
            let direction = |vertex: usize| {
                let [x, y, z, _] = vertices.tangents[vertex];
                [x, y, z]
            };
            let are_near = |a: [f32; 3], b: [f32; 3]| {
                let apart = sub(a, b);
                dot(apart, apart) <= greatest
            };
            let is_near = |&vertex: &usize| {
                are_near(direction(first), direction(vertex))
                    && are_near(vertices.normals[first], vertices.normals[vertex])
            };
            let (near, far): (Vec<usize>, Vec<usize>) = rest.iter().partition(|vertex| is_near(vertex));
            let sum = near.iter().fold([0.0; 3], |sum, &vertex| add(sum, direction(vertex)));
            for &vertex in &near {
                let [x, y, z] = unit(project(vertices.normals[vertex], sum));
                let tangent = [x, y, z, vertices.tangents[vertex][3]];
                if near.len() > 1 && tangent != vertices.tangents[vertex] {
                    vertices.tangents[vertex] = tangent;
                    welded += 1;
                }
            }
            rest = far;
        }
    }
    welded
}
