//! Which points a path passes exactly: those between which the straight legs miss the others by little.
//!
//! Douglas and Peucker's: the point farthest from the leg between two others is kept, and so on on both sides of it,
//! until all that are left are near their legs. What they are off is less corridor for the leg: a path so near to it is
//! within the whole corridor of the straight lines between all points, and of each point.

use nalgebra::{Vector3, Vector4};

/// How far points that are not kept may be from their leg: a share of the corridor, and at most, m; how far their
/// heading from its, rad; and how far, relative, their speed from that at its start.
const DISTANCE_CORRIDOR_SHARE: f64 = 0.5;
const DISTANCE_MAX_M: f64 = 0.25;
const HEADING_TOLERANCE_RAD: f64 = 0.05;
const SPEED_TOLERANCE_SHARE: f64 = 0.1;

/// A point, m and rad, and the speed up to the next one at most, m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// m and rad; headings go the way that is meant.
    pub place: Vector4<f64>,
    /// m/s.
    pub speed: f64,
}

/// The straight way from one point to the next, and how far around it a path may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// m and rad.
    pub from: Vector4<f64>,
    /// m and rad.
    pub to: Vector4<f64>,
    /// m.
    pub corridor: f64,
    /// m/s at most.
    pub speed: f64,
}

impl Leg {
    /// m.
    pub fn length(&self) -> f64 {
        (self.to - self.from).xyz().norm()
    }

    /// From the nearest of its places to `place`, m.
    pub fn off(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let (straight, gone) = ((self.to - self.from).xyz(), place - self.from.xyz());
        let square = straight.norm_squared();
        let along = if square > 0.0 { (gone.dot(&straight) / square).clamp(0.0, 1.0) } else { 0.0 };
        gone - straight * along
    }
}

/// Which of the points are kept, and the legs between them. Both ends are.
pub fn merged(points: &[Point], corridor: f64) -> (Vec<usize>, Vec<Leg>) {
    let tolerance = (DISTANCE_CORRIDOR_SHARE * corridor).min(DISTANCE_MAX_M);
    let last = points.len() - 1;
    let mut kept = vec![0];
    // Ranges whose ends are kept, the first of them last.
    let mut ranges = if last > 0 { vec![(0, last)] } else { Vec::new() };
    while let Some((start, end)) = ranges.pop() {
        match farthest(points, (start, end), tolerance) {
            Some(number) => ranges.extend([(number, end), (start, number)]),
            None => kept.push(end),
        }
    }
    // Some were farthest at first, and are near between their neighbours.
    for place in (1..kept.len() - 1).rev() {
        if farthest(points, (kept[place - 1], kept[place + 1]), tolerance).is_none() {
            kept.remove(place);
        }
    }
    let legs = kept.windows(2).map(|pair| leg(points, (pair[0], pair[1]), corridor)).collect();
    (kept, legs)
}

/// The leg between two points, with what is left of the corridor, and the least speed of those that it replaces.
fn leg(points: &[Point], (start, end): (usize, usize), corridor: f64) -> Leg {
    let speed = points[start..end].iter().map(|point| point.speed).fold(f64::INFINITY, f64::min);
    let leg = Leg { from: points[start].place, to: points[end].place, corridor, speed };
    let off = points[start + 1..end].iter().map(|point| leg.off(&point.place.xyz()).norm()).fold(0.0, f64::max);
    Leg { corridor: corridor - off, ..leg }
}

/// The point between two that is farthest from their leg; none where all are near, unless it is no leg.
fn farthest(points: &[Point], (start, end): (usize, usize), tolerance: f64) -> Option<usize> {
    let (first, last) = (&points[start], &points[end]);
    let leg = Leg { from: first.place, to: last.place, corridor: 0.0, speed: first.speed };
    let distance = |number: &usize| {
        let Point { place, speed } = points[*number];
        let off = leg.off(&place.xyz());
        let along = (place.xyz() - off - leg.from.xyz()).norm() / leg.length().max(f64::MIN_POSITIVE);
        let turned = place.w - leg.from.w - (leg.to.w - leg.from.w) * along;
        let faster = if speed == leg.speed { 0.0 } else { (speed / leg.speed - 1.0).abs() };
        (off.norm() / tolerance).max(turned.abs() / HEADING_TOLERANCE_RAD).max(faster / SPEED_TOLERANCE_SHARE)
    };
    let between = (start + 1..end).map(|number| (number, distance(&number)));
    let (number, most) = between.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (most > 1.0 || leg.from == leg.to).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(places: &[[f64; 3]]) -> Vec<Point> {
        places.iter().map(|[x, y, heading]| Point { place: Vector4::new(*x, *y, 1.0, *heading), speed: 3.0 }).collect()
    }

    #[test]
    fn points_near_the_line_between_others_are_merged_and_corners_are_kept() {
        let points = along(&[[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [2.0, -0.05, 0.0], [4.0, 0.0, 0.0], [4.0, 3.0, 0.0]]);
        let (kept, legs) = merged(&points, 0.3);
        assert_eq!(kept, [0, 3, 4]);
        assert!((legs[0].corridor - 0.2).abs() < 1e-9 && legs[1].corridor == 0.3, "{legs:?}");
        // In a narrow corridor they are corners.
        assert_eq!(merged(&points, 0.05).0, [0, 1, 2, 3, 4]);
        // However wide it is, what is no noise stays.
        assert_eq!(merged(&points, 100.0).0, [0, 3, 4]);
    }

    #[test]
    fn a_turn_of_the_heading_and_another_speed_are_kept() {
        let turning = along(&[[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [2.0, 0.0, 1.0]]);
        assert_eq!(merged(&turning, 0.3).0, [0, 1, 2]);
        let mut slowing = along(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
        (slowing[2].speed, slowing[1].speed) = (1.0, 2.9);
        let (kept, legs) = merged(&slowing, 0.3);
        assert_eq!((kept, [legs[0].speed, legs[1].speed]), (vec![0, 2, 3], [2.9, 1.0]));
    }

    #[test]
    fn a_way_there_and_back_is_two_legs() {
        assert_eq!(merged(&along(&[[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 0.0]]), 0.3).0, [0, 1, 2]);
        assert_eq!(merged(&along(&[[0.0, 0.0, 0.0]]), 0.3), (vec![0], vec![]));
    }
}
