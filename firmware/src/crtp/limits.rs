//! How fast a path may be flown: within the bounds that the vehicle is certified for.
//!
//! A governor that is sent more smooths it, and comes late by a way of its own. So a path that asks for more is flown
//! more slowly, along the same way. With the greatest speed v, acceleration a, jerk j and snap s along it, k times as
//! slow is slow enough where v / k, a / k^2, j / k^3 and s / k^4 are within their bounds, and so for the heading.

use super::path::Path;
use super::pieces::Pieces;
use super::polynomial::Point;
use controller_core::math;
use controller_core::reference::ReferenceBounds;

/// How many times as slow as the bounds need it a path is: the rest is for the governor's feedback, which follows one
/// like that as it is sent.
const ROOM: f32 = 1.1;

/// Time between the places that are looked at, s, and how many there are at most.
const INTERVAL_S: f32 = 0.05;
const PLACES_MAX: u32 = 2_000;

/// What a vehicle may fly: its bounds, and the governor's speeds, m/s.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// The bounds of the reference.
    pub bounds: ReferenceBounds,
    /// Across, and up or down.
    pub speeds: [f32; 2],
}

/// The greatest of each along a path: across and vertical, then those of all axes together.
#[derive(Debug, Clone, Copy, Default)]
struct Peaks {
    speeds: [f32; 2],
    accelerations: [f32; 2],
    jerk: f32,
    snap: f32,
    turning: f32,
    turning_acceleration: f32,
}

impl Peaks {
    /// With what a point of it has.
    fn with(&self, point: &Point) -> Self {
        let [x, y, z] = &point.axes;
        let length = |squares: f32| math::sqrt(squares);
        let across = |one: f32, other: f32| length(one * one + other * other);
        let all = |x: f32, y: f32, z: f32| length(x * x + y * y + z * z);
        Self {
            speeds: greater(self.speeds, [across(x.rate, y.rate), z.rate.abs()]),
            accelerations: greater(self.accelerations, [across(x.acceleration, y.acceleration), z.acceleration.abs()]),
            jerk: math::max(self.jerk, all(x.jerk, y.jerk, z.jerk)),
            snap: math::max(self.snap, all(x.snap, y.snap, z.snap)),
            turning: math::max(self.turning, point.yaw.rate.abs()),
            turning_acceleration: math::max(
                self.turning_acceleration,
                across(point.yaw.acceleration, point.yaw.rate * point.yaw.rate),
            ),
        }
    }

    /// Whether all of it is within the limits, so many times as slow.
    fn fits(&self, limits: &Limits, slower: f32) -> bool {
        let Limits { bounds, speeds: [across, vertical] } = limits;
        let slower = slower / ROOM;
        let (square, cube) = (slower * slower, slower * slower * slower);
        let [speed, climb] = self.speeds;
        let [acceleration, lift] = self.accelerations;
        [
            (speed / slower, *across),
            (climb / slower, *vertical),
            (acceleration / square, bounds.horizontal_acceleration),
            (lift / square, bounds.vertical_acceleration),
            (self.jerk / cube, bounds.jerk),
            (self.snap / (square * square), bounds.snap),
            (self.turning / slower, bounds.heading_rate),
            (self.turning_acceleration / square, bounds.heading_second_derivative),
        ]
        .iter()
        .all(|(peak, bound)| peak <= bound)
    }
}

fn greater([a, b]: [f32; 2], [c, d]: [f32; 2]) -> [f32; 2] {
    [math::max(a, c), math::max(b, d)]
}

impl Limits {
    /// How many times as slow a path has to be, in steps of a twentieth; none where a hundred times is not enough, its
    /// numbers are not finite, or its pieces are gone.
    pub fn slower(&self, path: &Path, pieces: &Pieces<'_>) -> Option<f32> {
        let duration = path.duration()?;
        let count = ((duration / INTERVAL_S) as u32).clamp(20, PLACES_MAX);
        let mut peaks = Peaks::default();
        for place in 0..=count {
            let point = path.at(duration * place as f32 / count as f32, pieces)?;
            if !point.is_finite() {
                return None;
            }
            peaks = peaks.with(&point);
        }
        let mut slower = 1.0;
        while !peaks.fits(self, slower) {
            slower *= 1.05;
            if slower > 100.0 {
                return None;
            }
        }
        Some(slower)
    }
}

#[cfg(test)]
mod tests;
