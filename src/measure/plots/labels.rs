//! Labels of points that hide neither each other nor the points.

/// A rectangle: left, top, right, bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Area {
    fn meets(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left && self.top <= other.top && other.right <= self.right && other.bottom <= self.bottom
    }

    /// Around a point.
    pub fn around((x, y): (f64, f64), reach: f64) -> Self {
        Self { left: x - reach, top: y - reach, right: x + reach, bottom: y + reach }
    }
}

/// Where labels of points go.
pub(super) struct Places {
    /// What labels stay within.
    pub within: Area,
    /// What they must not hide.
    pub taken: Vec<Area>,
}

impl Places {
    /// A place for a label of this size near a point: near it if there is room, else farther away; what is returned is
    /// its left end's middle. `None` where there is no room.
    pub fn take(&mut self, (x, y): (f64, f64), (width, height): (f64, f64)) -> Option<(f64, f64)> {
        let middle = |distance: f64, (across, down): (f64, f64)| {
            let left = match across {
                a if a > 0.0 => x + a * distance,
                a if a < 0.0 => x + a * distance - width,
                _ => x - width / 2.0,
            };
            (left, y + down * (distance + height / 2.0 - 4.0))
        };
        let directions =
            [(1.0, -0.7), (1.0, 0.7), (-1.0, 0.7), (-1.0, -0.7), (0.0, -1.0), (0.0, 1.0), (1.0, 0.0), (-1.0, 0.0)];
        let distances = [9.0, 16.0, 26.0, 38.0, 52.0, 70.0, 90.0];
        let places = distances.iter().flat_map(|distance| directions.iter().map(move |side| middle(*distance, *side)));
        let area = |(left, middle): (f64, f64)| Area {
            left: left - 2.0,
            top: middle - height / 2.0,
            right: left + width + 2.0,
            bottom: middle + height / 2.0,
        };
        let is_free = |place: &(f64, f64)| {
            let label = area(*place);
            self.within.holds(&label) && !self.taken.iter().any(|taken| taken.meets(&label))
        };
        let place = places.into_iter().find(is_free)?;
        self.taken.push(area(place));
        Some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_one_point_do_not_meet() {
        let within = Area { left: 0.0, top: 0.0, right: 400.0, bottom: 300.0 };
        let mut places = Places { within, taken: vec![Area::around((200.0, 150.0), 4.0)] };
        let found: Vec<_> = (0..6).filter_map(|_| places.take((200.0, 150.0), (80.0, 14.0))).collect();
        assert_eq!(found.len(), 6);
        let areas = &places.taken;
        for (i, a) in areas.iter().enumerate() {
            assert!(within.holds(a));
            assert!(areas[..i].iter().all(|b| !a.meets(b)), "{areas:?}");
        }
        // And where there is no room, none is made.
        assert_eq!(places.take((200.0, 150.0), (500.0, 14.0)), None);
    }
}
