//! Triangles and lines, in perspective, the nearest in front.

use crate::vector::{add, dot, sub, times};

/// Where a mesh is looked at from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint {
    /// The eye.
    pub eye: [f32; 3],
    /// To the right, down and ahead, of length one each.
    pub axes: [[f32; 3]; 3],
    /// The tangent of the angle between the middle of the picture and its upper border.
    pub field: f32,
}

/// The angle between the middle of a picture and its upper border, in degrees.
const HALF_FIELD: f32 = 15.0;

impl Viewpoint {
    /// From the direction `from`, of length one, so that all `points` fit into a square picture; `up` is upwards there.
    pub fn around(points: &[[f32; 3]], from: [f32; 3], up: [f32; 3]) -> Self {
        let bound = |better: fn(f32, f32) -> f32, start: f32| {
            points.iter().fold([start; 3], |bound, point| [0, 1, 2].map(|i| better(bound[i], point[i])))
        };
        let (least, greatest) = (bound(f32::min, f32::MAX), bound(f32::max, f32::MIN));
        let middle = [0, 1, 2].map(|i| 0.5 * least[i] + 0.5 * greatest[i]);
        let farthest = points.iter().map(|point| length(sub(*point, middle))).fold(0.0, f32::max);
        // A mesh that is a point is looked at too.
        let radius = if farthest > 0.0 { farthest } else { 1.0 };
        let ahead = times(-1.0, from);
        let right = unit(crate::vector::cross(ahead, up));
        let down = crate::vector::cross(ahead, right);
        let half_field = HALF_FIELD.to_radians();
        // The border's rays touch the sphere around all points.
        let eye = add(middle, times(radius / half_field.sin(), from));
        Self { eye, axes: [right, down, ahead], field: half_field.tan() }
    }

    /// A direction of the picture (x to the right, y down, z to the eye) in the mesh's space.
    pub fn to_space(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let [right, down, ahead] = self.axes;
        add(add(times(x, right), times(y, down)), times(-z, ahead))
    }
}

fn length(v: [f32; 3]) -> f32 {
    // No square of it overflows.
    f64::from(v[0]).hypot(v[1].into()).hypot(v[2].into()) as f32
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    times(1.0 / length(v), v)
}

/// A point and what comes with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner<const N: usize> {
    /// Where it is.
    pub position: [f32; 3],
    /// What is interpolated between corners.
    pub attributes: [f32; N],
}

/// A square of samples, and how near what they show is.
#[derive(Debug, Clone, PartialEq)]
pub struct Canvas {
    side: usize,
    viewpoint: Viewpoint,
    /// One over the distance along the view, of what is nearest; 0 is nothing.
    nearness: Vec<f32>,
    colours: Vec<[f32; 3]>,
}

/// A point on the canvas: column, row, and one over its distance.
type Projected = [f32; 3];

impl Canvas {
    /// An empty one of `side` by `side` samples.
    pub fn new(side: usize, viewpoint: Viewpoint, background: [f32; 3]) -> Self {
        Self { side, viewpoint, nearness: vec![0.0; side * side], colours: vec![background; side * side] }
    }

    /// The linear colours, in rows from the top.
    pub fn colours(&self) -> &[[f32; 3]] {
        &self.colours
    }

    fn project(&self, position: [f32; 3]) -> Projected {
        let from_eye = sub(position, self.viewpoint.eye);
        let [x, y, distance] = self.viewpoint.axes.map(|axis| dot(axis, from_eye));
        let half = self.side as f32 / 2.0;
        let scale = half / (self.viewpoint.field * distance);
        [half + scale * x, half + scale * y, 1.0 / distance]
    }

    /// Draws a triangle, from either side; `shade` gives the colour of a sample from what is interpolated there, position
    /// and attributes, in perspective.
    pub fn triangle<const N: usize>(
        &mut self,
        corners: [&Corner<N>; 3],
        shade: impl Fn([f32; 3], [f32; N]) -> [f32; 3],
    ) {
        let projected = corners.map(|corner| self.project(corner.position));
        let [p, q, r] = projected;
        let area =
            |p: Projected, q: Projected, r: Projected| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let whole = area(p, q, r);
        if whole == 0.0 || !whole.is_finite() {
            return;
        }
        let range = |axis: usize| {
            let values = projected.map(|point| point[axis]);
            let least = values.into_iter().fold(f32::MAX, f32::min).max(0.0);
            let greatest = values.into_iter().fold(f32::MIN, f32::max).min(self.side as f32 - 1.0);
            least as usize..=greatest.max(-1.0) as usize
        };
        for y in range(1) {
            for x in range(0) {
                let s = [x as f32 + 0.5, y as f32 + 0.5, 0.0];
                let weights = [area(s, q, r) / whole, area(p, s, r) / whole, area(p, q, s) / whole];
                let nearness = dot(weights, projected.map(|point| point[2]));
                let at = y * self.side + x;
                if weights.iter().any(|weight| *weight < 0.0) || nearness <= self.nearness[at] {
                    continue;
                }
                // What is linear in space is so in the picture after division by the distance.
                let shares = [0, 1, 2].map(|i| weights[i] * projected[i][2] / nearness);
                let mixed = |value: &dyn Fn(&Corner<N>) -> f32| {
                    shares[0] * value(corners[0]) + shares[1] * value(corners[1]) + shares[2] * value(corners[2])
                };
                let position = [0, 1, 2].map(|i| mixed(&|corner| corner.position[i]));
                let attributes = std::array::from_fn(|i| mixed(&|corner| corner.attributes[i]));
                self.nearness[at] = nearness;
                self.colours[at] = shade(position, attributes);
            }
        }
    }

    /// Draws a line of `width` samples where nothing is nearer.
    pub fn line(&mut self, from: [f32; 3], to: [f32; 3], width: usize, colour: [f32; 3]) {
        let (from, to) = (self.project(from), self.project(to));
        let steps = (to[0] - from[0]).abs().max((to[1] - from[1]).abs()).ceil().clamp(1.0, 4.0 * self.side as f32);
        for step in 0..=steps as usize {
            let [x, y, nearness] = add(from, times(step as f32 / steps, sub(to, from)));
            // Lines stand on what they belong to.
            self.dot([x, y], width, 1.002 * nearness, colour);
        }
    }

    fn dot(&mut self, [x, y]: [f32; 2], width: usize, nearness: f32, colour: [f32; 3]) {
        let first = |at: f32| (at - width as f32 / 2.0).round();
        let (left, top) = (first(x), first(y));
        for i in 0..width * width {
            let (x, y) = (left + (i % width) as f32, top + (i / width) as f32);
            let inside = |at: f32| (0.0..self.side as f32).contains(&at);
            let at = y as usize * self.side + x as usize;
            if inside(x) && inside(y) && nearness > self.nearness[at] {
                self.nearness[at] = nearness;
                self.colours[at] = colour;
            }
        }
    }
}
