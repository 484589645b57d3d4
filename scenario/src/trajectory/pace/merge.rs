//! Which points a path passes exactly: those between which the straight legs miss the others by little.
//!
//! Douglas and Peucker's: the point farthest from the leg between two others is kept, and so on on both sides of it,
//! until all that are left are near their legs. What they are off is less corridor for the leg: a path so near to it is
//! within the whole corridor of the straight lines between all points, and of each point.

use nalgebra::{Vector3, Vector4};

/// How far points that are not kept may be from their leg: a share of the corridor, and at most, m; and how far their
/// heading from its, rad.
const SHARE: f64 = 0.5;
const MOST: f64 = 0.25;
const HEADING: f64 = 0.05;

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

/// Which of the points are kept, and the legs between them. Both ends are, and all at which the speed changes.
pub fn merged(points: &[Point], corridor: f64) -> (Vec<usize>, Vec<Leg>) {
    let tolerance = (SHARE * corridor).min(MOST);
    let last = points.len() - 1;
    let mut kept = vec![0];
    let changes = (1..last).filter(|number| points[*number].speed != points[number - 1].speed);
    for end in changes.chain((last > 0).then_some(last)) {
        let start = kept[kept.len() - 1];
        keep(points, (start, end), tolerance, &mut kept);
    }
    // Some were farthest at first, and are near between their neighbours.
    for place in (1..kept.len() - 1).rev() {
        let (before, after) = (kept[place - 1], kept[place + 1]);
        let leg = straight(points, (before, after));
        let is_speeds = points[kept[place]].speed != points[kept[place] - 1].speed;
        let is_far = between(points, &leg, (before, after)).any(|(_, off, turned)| off > tolerance || turned > HEADING);
        if !is_speeds && !is_far && leg.from != leg.to {
            kept.remove(place);
        }
    }
    let leg = |pair: &[usize]| {
        let leg = straight(points, (pair[0], pair[1]));
        let off = between(points, &leg, (pair[0], pair[1])).map(|(_, off, _)| off).fold(0.0, f64::max);
        Leg { corridor: corridor - off, ..leg }
    };
    let legs = kept.windows(2).map(leg).collect();
    (kept, legs)
}

/// Keeps what is needed after `start`, up to `end`.
fn keep(points: &[Point], (start, end): (usize, usize), tolerance: f64, kept: &mut Vec<usize>) {
    let leg = straight(points, (start, end));
    let farthest = between(points, &leg, (start, end))
        .map(|(number, off, turned)| (number, (off / tolerance).max(turned / HEADING)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    match farthest {
        // A leg of no length would be none.
        Some((number, off)) if off > 1.0 || leg.from == leg.to => {
            keep(points, (start, number), tolerance, kept);
            keep(points, (number, end), tolerance, kept);
        }
        _ => kept.push(end),
    }
}

fn straight(points: &[Point], (start, end): (usize, usize)) -> Leg {
    Leg { from: points[start].place, to: points[end].place, corridor: 0.0, speed: points[start].speed }
}

/// The points between two, how far each is from their leg, m, and its heading from the leg's there, rad.
fn between<'a>(
    points: &'a [Point],
    leg: &'a Leg,
    (start, end): (usize, usize),
) -> impl Iterator<Item = (usize, f64, f64)> + 'a {
    (start + 1..end).map(|number| {
        let Point { place, .. } = points[number];
        let off = leg.off(&place.xyz());
        let length = (leg.to - leg.from).xyz().norm();
        let along = (place.xyz() - off - leg.from.xyz()).norm() / length.max(f64::MIN_POSITIVE);
        let heading = leg.from.w + (leg.to.w - leg.from.w) * along;
        (number, off.norm(), (place.w - heading).abs())
    })
}
