//! Polygons as triangles.

/// The most corners of a polygon that is not convex: cutting one takes time with the square of its corners.
pub(super) const MOST_CORNERS: usize = 1 << 14;

/// Triangles of a polygon's corners, by number: a fan if it is convex, else ears cut off one by one. `None` if it is
/// not convex and has more than [`MOST_CORNERS`].
pub(super) fn triangulate(points: &[[f32; 3]]) -> Option<Vec<[usize; 3]>> {
    let flat = flattened(points);
    let mut rest: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len().saturating_sub(2));
    if !(0..rest.len()).all(|at| turn(&flat, around(&rest, at)) >= 0.0) {
        if points.len() > MOST_CORNERS {
            return None;
        }
        cut_ears(&flat, &mut rest, &mut triangles);
    }
    triangles.extend(rest.windows(2).skip(1).map(|pair| [rest[0], pair[0], pair[1]]));
    Some(triangles)
}

/// Cuts off the first ear, until three corners are left, or no ear: then edges cross, and any triangles are as good as
/// others.
///
/// Around a simple polygon, cutting an ear changes nothing but its two neighbours. Where edges touch or cross, others
/// may have become ears: they are looked for again, but not without end.
fn cut_ears(flat: &[[f64; 2]], rest: &mut Vec<usize>, triangles: &mut Vec<[usize; 3]>) {
    let all = |rest: &[usize]| -> Vec<bool> { (0..rest.len()).map(|at| is_ear(flat, rest, at)).collect() };
    let mut ears = all(rest);
    let mut searches = 8;
    while rest.len() > 3 {
        let Some(ear) = ears.iter().position(|is_ear| *is_ear) else {
            searches -= 1;
            ears = all(rest);
            if searches == 0 || !ears.contains(&true) {
                return;
            }
            continue;
        };
        triangles.push(around(rest, ear));
        rest.remove(ear);
        ears.remove(ear);
        let count = rest.len();
        for neighbour in [(ear + count - 1) % count, ear % count] {
            ears[neighbour] = is_ear(flat, rest, neighbour);
        }
    }
}

/// The corner at a place, between its neighbours.
fn around(rest: &[usize], at: usize) -> [usize; 3] {
    let count = rest.len();
    [rest[(at + count - 1) % count], rest[at], rest[(at + 1) % count]]
}

/// Twice the area of a triangle, positive if it turns as the polygon does.
fn turn(flat: &[[f64; 2]], [a, b, c]: [usize; 3]) -> f64 {
    let [[ax, ay], [bx, by], [cx, cy]] = [flat[a], flat[b], flat[c]];
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// Whether the triangle at a corner is inside the polygon, and nothing else is in it.
fn is_ear(flat: &[[f64; 2]], rest: &[usize], at: usize) -> bool {
    let [a, b, c] = around(rest, at);
    let is_inside = |point: usize| [[a, b, point], [b, c, point], [c, a, point]].iter().all(|&t| turn(flat, t) >= 0.0);
    let is_corner = |point: usize| [a, b, c].iter().any(|&corner| flat[corner] == flat[point]);
    turn(flat, [a, b, c]) > 0.0 && !rest.iter().any(|&point| !is_corner(point) && is_inside(point))
}

/// The corners in the coordinate plane that the polygon lies flattest to, turning counterclockwise; its normal is
/// Newell's.
fn flattened(points: &[[f32; 3]]) -> Vec<[f64; 2]> {
    let mut normal = [0.0; 3];
    for (i, point) in points.iter().enumerate() {
        let next = points[(i + 1) % points.len()];
        for (axis, sum) in normal.iter_mut().enumerate() {
            let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
            *sum += (f64::from(point[y]) - f64::from(next[y])) * (f64::from(point[z]) + f64::from(next[z]));
        }
    }
    let axis = (0..3).max_by(|&a, &b| f64::total_cmp(&normal[a].abs(), &normal[b].abs())).unwrap_or(0);
    let (mut x, mut y) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        (x, y) = (y, x);
    }
    points.iter().map(|point| [point[x].into(), point[y].into()]).collect()
}

#[cfg(test)]
mod tests {
    use super::triangulate;

    #[test]
    fn triangles_stay_inside() {
        let point = |&[x, y]: &[f32; 2]| [5.0, x, y];
        let of = |corners: &[[f32; 2]]| triangulate(&corners.iter().map(point).collect::<Vec<_>>()).unwrap();
        assert_eq!(of(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(of(&[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]), [[0, 1, 2], [0, 2, 3]]);
        // An arrow's head: the diagonal from its first corner would lie outside.
        assert_eq!(of(&[[0.0, 0.0], [2.0, 2.0], [0.0, 4.0], [1.0, 2.0]]), [[3, 0, 1], [1, 2, 3]]);
        // An L, whose area is that of its triangles.
        let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0f32]];
        for turned in 0..6 {
            let corners: Vec<_> = (0..6).map(|i| corners[(i + turned) % 6]).collect();
            let areas = of(&corners).into_iter().map(|triangle| {
                let [[ax, ay], [bx, by], [cx, cy]] = triangle.map(|corner| corners[corner]);
                ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2.0
            });
            let areas: Vec<f32> = areas.collect();
            assert!(areas.iter().all(|area| *area >= 0.0));
            assert_eq!(areas.iter().sum::<f32>(), 5.0);
        }
        assert_eq!(triangulate(&[[0.0; 3]; 5]).unwrap(), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }
}
