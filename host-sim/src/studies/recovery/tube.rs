//! How near the vehicle stays once it is there: the radius that is proven, and the worst gusts flown beside it.

use super::flight::Flyer;
use super::start::Start;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::sampled_loop::Axis;
use std::fmt;

/// As shares of the file's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Of the rotors' lag.
    pub lag: f64,
    /// Of each moment of inertia.
    pub inertia: f64,
}

/// A proven tube about the hover.
#[derive(Debug, Clone, PartialEq)]
pub struct Tube {
    across: f64,
    vertical: f64,
    gusts: [Vec<f64>; 3],
}

/// Why there is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoTube(&'static str);

impl fmt::Display for NoTube {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

/// The tube of `scenario`.
///
/// # Errors
/// Why there is none.
pub fn judge(_scenario: &Scenario, _gust: f64, _tolerances: &Tolerances) -> Result<Tube, NoTube> {
    Err(NoTube("not there yet"))
}

impl Tube {
    /// m, along each horizontal axis.
    #[must_use]
    pub fn across(&self) -> f64 {
        self.across
    }

    /// m.
    #[must_use]
    pub fn vertical(&self) -> f64 {
        self.vertical
    }

    /// -1 or 1 for each tick, oldest first.
    #[must_use]
    pub fn worst_gust(&self, axis: Axis) -> &[f64] {
        match axis {
            Axis::LateralX => &self.gusts[0],
            Axis::LateralY => &self.gusts[1],
            _ => &self.gusts[2],
        }
    }
}

/// Where a vehicle counts as back: a box about its reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radii {
    /// m, along each horizontal axis.
    pub across: f64,
    /// m.
    pub vertical: f64,
}

impl Radii {
    /// What counts where nothing is proven.
    pub const UNPROVEN: Self = Self { across: 0.5, vertical: 0.5 };

    /// Whether a position, m, is within.
    #[must_use]
    pub fn hold(&self, position: &Vector3<f64>) -> bool {
        position.x.abs().max(position.y.abs()) <= self.across && position.z.abs() <= self.vertical
    }
}

/// The worst gust of a tube along each axis.
#[must_use]
pub fn worst_gusts(tube: &Tube) -> [&[f64]; 3] {
    [Axis::LateralX, Axis::LateralY, Axis::Vertical].map(|axis| tube.worst_gust(axis))
}

/// How far the vehicle comes from a hover, m, along each axis, in these gusts (-1 or 1 for each tick, oldest first),
/// each along its own axis alone, and all at once: with lag and moments of inertia as they are, and at both ends.
#[must_use]
pub fn beside_the_tube(flyer: &Flyer, gusts: [&[f64]; 3]) -> Vector3<f64> {
    let ticks = gusts.map(<[f64]>::len).into_iter().max().unwrap_or(0);
    // All end together: the last gust counts most.
    let at = |axis: usize, tick: usize| {
        let waits = ticks - gusts[axis].len();
        tick.checked_sub(waits).and_then(|tick| gusts[axis].get(tick)).copied().unwrap_or(0.0)
    };
    let factors = |share: f64| [1.0 - share, 1.0, 1.0 + share];
    let mut farthest = Vector3::zeros();
    for lag in factors(flyer.sets().lag) {
        for inertia in factors(flyer.sets().inertia) {
            let start = Start { lag, inertia: Vector3::repeat(inertia), ..Start::at_rest() };
            for alone in [Some(0), Some(1), Some(2), None] {
                let blows = |axis: usize| alone.is_none_or(|alone| alone == axis);
                let gust =
                    (0..ticks).map(|tick| Vector3::from_fn(|axis, _| if blows(axis) { at(axis, tick) } else { 0.0 }));
                flyer.fly(&start, gust, |position| farthest = farthest.sup(&position.abs()));
            }
        }
    }
    farthest
}
