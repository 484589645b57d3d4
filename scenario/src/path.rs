//! Where a reference goes between the points that a file names: out of their box, or below the ground.

use crate::reality::ground::Ground;
use crate::reference::ReferenceKind;
use crate::section::FieldError;
use crate::trajectory::{Route, Way};
use controller_core::reference::Trajectory;
use controller_core::reference::waypoints::Waypoint;
use nalgebra::Vector3;
use std::fmt;

/// Instants looked at on each leg: a peak between two of them is missed by less than 1e-4 of the leg's swing.
const INSTANTS_PER_LEG: u32 = 256;

/// The greatest distance that is not reported, and the rounding of single precision, m.
const DISTANCE_TOLERANCE_M: f64 = 0.01;

/// A path that goes deeper than this, m, and less than this share of that above zero, has its z axis downwards.
const Z_DOWN_DEPTH_M: f64 = 0.2;
const Z_DOWN_HEIGHT_SHARE: f64 = 0.1;

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// m, world.
    pub position: Vector3<f64>,
    /// s.
    pub time: f64,
}

/// How far a path leaves the box of its waypoints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// m.
    pub distance: f64,
    /// Where it is farthest out.
    pub at: Place,
}

impl Swing {
    /// The farthest that the path of `reference` leaves the box of its waypoints; none where it stays inside, or where
    /// there are none.
    #[must_use]
    pub fn find(reference: &ReferenceKind, trajectory: &dyn Trajectory) -> Option<Self> {
        let ReferenceKind::Route(Route { points, way: Way::Smooth, .. }) = reference else { return None };
        let positions = || points.iter().map(|point| Vector3::from(point.position));
        let (least, greatest) = (positions().reduce(|a, b| a.inf(&b))?, positions().reduce(|a, b| a.sup(&b))?);
        let swings = places(points, trajectory).map(|at| {
            let nearest = at.position.sup(&least).inf(&greatest);
            Self { distance: (at.position - nearest).norm(), at }
        });
        swings.max_by(|a, b| a.distance.total_cmp(&b.distance)).filter(|swing| swing.distance > DISTANCE_TOLERANCE_M)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { position: p, time } = self;
        write!(f, "({:.2}, {:.2}, {:.2}) m at {time:.2} s", p.x, p.y, p.z)
    }
}

impl fmt::Display for Swing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { distance, at } = self;
        write!(f, "the path leaves the box of its waypoints by {distance:.2} m: {at}; path = \"inside\" keeps it in")
    }
}

/// Refuses a reference that goes below the ground: below `ground`, or below zero between waypoints that all lie above;
/// or, where nothing is said of the ground, one that is hardly anywhere above zero.
///
/// # Errors
/// Names the field, the place and the time.
pub fn check_ground(
    reference: &ReferenceKind,
    trajectory: &dyn Trajectory,
    ground: Option<Ground>,
) -> Result<(), FieldError> {
    let at = |time: f64| place(trajectory, time);
    let (field, lowest, highest, remedy) = match reference {
        ReferenceKind::Hover { position, .. } => ("reference.position", at(0.0), position.z, "raise it"),
        ReferenceKind::Harmonic(harmonic) => {
            let [(frequency, phase, amplitude)] = [(harmonic.frequency[2], harmonic.phase[2], harmonic.amplitude[2])];
            let down = if amplitude > 0.0 { std::f64::consts::PI } else { 0.0 };
            let turned = (down - phase).rem_euclid(std::f64::consts::TAU);
            let time = if frequency == 0.0 { 0.0 } else { turned / frequency.abs() };
            ("reference.center", at(time), harmonic.center[2] + amplitude.abs(), "raise it")
        }
        ReferenceKind::Route(Route { points, way, name, .. }) => {
            let lowest = places(points, trajectory).min_by(|a, b| a.position.z.total_cmp(&b.position.z));
            let remedy = match way {
                Way::Smooth => "take path = \"inside\", or raise the points",
                Way::Paced { .. } => "narrow the corridor, or raise the points",
                Way::Inside | Way::Near { .. } => "raise the points",
            };
            let highest = points.iter().map(|point| point.position[2]).fold(f64::NEG_INFINITY, f64::max);
            (name.as_str(), lowest.unwrap_or_else(|| at(0.0)), highest, remedy)
        }
    };
    let height = match (ground, reference) {
        (Some(ground), _) => ground.height,
        (None, _) if lowest.position.z < -Z_DOWN_DEPTH_M && highest < -Z_DOWN_HEIGHT_SHARE * lowest.position.z => {
            let problem = format!(
                "lies below zero, from z = {:.2} to {highest:.2} m, and z points up: where it points down (NED), turn \
                 it round to (x, -y, -z) and -yaw; where the ground is that low, say so in [ground] height",
                lowest.position.z
            );
            return Err(FieldError::new(field, problem));
        }
        (None, ReferenceKind::Route(Route { points, .. })) if points.iter().all(|p| p.position[2] >= 0.0) => 0.0,
        _ => return Ok(()),
    };
    if lowest.position.z >= height - DISTANCE_TOLERANCE_M {
        return Ok(());
    }
    let problem = format!("the path must stay above the ground at {height} m, found {lowest}; {remedy}");
    Err(FieldError::new(field, problem))
}

/// Places all along the legs between `points`.
fn places(points: &[Waypoint], trajectory: &dyn Trajectory) -> impl Iterator<Item = Place> {
    points.windows(2).flat_map(move |pair| {
        let (from, to) = (pair[0].time, pair[1].time);
        (0..=INSTANTS_PER_LEG)
            .map(move |i| place(trajectory, from + (to - from) * f64::from(i) / f64::from(INSTANTS_PER_LEG)))
    })
}

fn place(trajectory: &dyn Trajectory, time: f64) -> Place {
    Place { position: trajectory.at((time * 1e6).round() as u64).position.map(f64::from), time }
}

#[cfg(test)]
mod tests;
