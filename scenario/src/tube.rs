//! How far a gust takes a vehicle from where it hovers: a tube that it does not leave.
//!
//! The force per mass acts along x, y or z, is never above a level and may be anything else at any time. The rotors'
//! lag and the moments of inertia may be off by a share, and the law believes the file's. Then |p| never exceeds a
//! radius, which [`Loops::tube`] proves. `docs/recovery.md` has the derivation:
//!
//! 1. The vehicle, the law and their saturations in the plane of the gust are the [linear loops](crate::sampled_loop)
//!    with what comes to them from outside: the gust, and all by which vehicle and law differ from them
//!    (`deviation`).
//! 2. How much a signal is at most for inputs within one is a sum over the loop's responses, bounded from above
//!    (`contraction`). So bounds on what differs give bounds on the signals, and these bound what differs.
//! 3. If what the signals then make is no more than what was taken, they stay within their bounds for ever: a signal of
//!    a tick depends on what differed before it alone. Where nothing of that kind is found, or a limit of the law is
//!    reached, there is no radius, and the reason is said.
//! 4. The lag and the moment of inertia are cut into cells. In a cell they are those of its middle, and the rest is an
//!    error beside the actuator's command (`Cells`).

mod bounds;
mod cells;
mod contraction;
mod deviation;
mod limits;
mod refusal;
mod signals;

use crate::file::Scenario;
use crate::sampled_loop::Axis;
use crate::sampled_loop::disturbed::Input;
use bounds::{Deviation, Peaks};
use cells::Cells;
pub use cells::Tolerances;
use controller_core::configuration::{ExtendedLaw, LawParameters};
use controller_core::extended::fallback::{NEAR_DISTANCE_M, PROGRESS_WINDOW_S};
use deviation::{Ages, Plane};
pub use limits::Reached;
pub use refusal::NoTube;
use signals::AxisNorms;

/// How far a gust along an axis takes the vehicle, m: along x, y and z, in the gust's plane or along the vertical.
#[derive(Debug, Clone, PartialEq)]
pub struct Tube {
    /// Of a gust along x, y and z: the way along that axis, and the height it takes besides.
    radii: [[f64; 2]; 3],
    /// The sign of the worst gust for each axis, a tick each, the oldest first.
    worst: [Vec<f64>; 3],
}

impl Tube {
    /// The distance that no gust along `axis` exceeds, m.
    #[must_use]
    pub fn radius(&self, axis: Axis) -> f64 {
        let [along, height] = self.radii[place(axis)];
        along.hypot(height)
    }

    /// The distance that a gust along x or y does not exceed, m.
    #[must_use]
    pub fn across(&self) -> f64 {
        self.radius(Axis::LateralX).max(self.radius(Axis::LateralY))
    }

    /// The height that a gust along the vertical does not exceed, m.
    #[must_use]
    pub fn vertical(&self) -> f64 {
        self.radius(Axis::Vertical)
    }

    /// The greatest of all.
    #[must_use]
    pub fn greatest(&self) -> f64 {
        self.across().max(self.vertical())
    }

    /// The sign of the gust along `axis` that takes the linear loop farthest, a tick each, the oldest first.
    #[must_use]
    pub fn worst_gust(&self, axis: Axis) -> &[f64] {
        &self.worst[place(axis)]
    }
}

/// Where an axis' results stand.
fn place(axis: Axis) -> usize {
    match axis {
        Axis::LateralX | Axis::Pitch => 0,
        Axis::LateralY | Axis::Roll => 1,
        Axis::Vertical | Axis::Yaw => 2,
    }
}

/// How much of the lag and of the gain is in a cell at most: the less, the less is an error of the actuator.
const CELL_WIDTHS: [f64; 2] = [0.0125, 0.0085];

/// The loops of a vehicle with all that moves them: worked out once, for any gust.
#[derive(Clone)]
pub struct Loops<'a> {
    scenario: &'a Scenario,
    law: &'a ExtendedLaw,
    /// Along x, y and z.
    norms: [AxisNorms; 3],
    ages: Ages,
}

impl<'a> Loops<'a> {
    /// Of `scenario`; `progress` hears how much is done, from 0 to 1, and says whether to go on.
    ///
    /// # Errors
    /// If there is no such proof for the law, or a loop does not settle.
    pub fn new(
        scenario: &'a Scenario,
        tolerances: &Tolerances,
        progress: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<Self, NoTube> {
        let [lag_width, gain_width] = CELL_WIDTHS;
        let [lag, gain] = tolerances.ranges();
        let [lag, gain] = [(lag, lag_width), (gain, gain_width)]
            .map(|([low, high], width)| Cells::new([low, high], ((high - low) / width).ceil().max(1.0) as usize));
        Self::in_cells(scenario, tolerances, [&lag, &gain], progress)
    }

    /// The same in these cells of the lag and of the gain.
    fn in_cells(
        scenario: &'a Scenario,
        tolerances: &Tolerances,
        [lag, gain]: [&Cells; 2],
        progress: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<Self, NoTube> {
        let LawParameters::Extended(law) = scenario.configuration.law() else { return Err(NoTube::OtherLaw) };
        let [lag_range, gain_range] = tolerances.ranges();
        if !(lag.cover(lag_range) && gain.cover(gain_range)) {
            return Err(NoTube::LeftOut);
        }
        let one = Cells { middles: vec![1.0], share: 0.0 };
        // Nothing can be off about a lag of zero.
        let lag = if scenario.rotor_lag > 0.0 { lag } else { &one };
        let vertical = AxisNorms::new(scenario, law, Axis::Vertical, [lag, &one], &|_| progress(0.0))?;
        let along_x = AxisNorms::new(scenario, law, Axis::LateralX, [lag, gain], &|done| progress(0.5 * done))?;
        let inertia = scenario.configuration.vehicle().inertia;
        let along_y = if inertia.x == inertia.y {
            along_x.clone()
        } else {
            AxisNorms::new(scenario, law, Axis::LateralY, [lag, gain], &|done| progress(0.5 + 0.5 * done))?
        };
        let timing = scenario.loop_timing();
        let ages = Ages {
            period: timing.period,
            acting: (1.0 + tolerances.lag) * timing.rotor_lag + (timing.delay_samples + 0.5) * timing.period,
            unknown: tolerances.lag * timing.rotor_lag,
        };
        Ok(Self { scenario, law, norms: [along_x, along_y, vertical], ages })
    }

    /// How far no gust of at most `gust`, m/s^2, along one axis takes the vehicle from hover.
    ///
    /// # Errors
    /// Why there is no such radius.
    pub fn tube(&self, gust: f64) -> Result<Tube, NoTube> {
        let inertia = self.scenario.configuration.vehicle().inertia;
        let [along_x, along_y, vertical] = &self.norms;
        let still = AxisNorms::still();
        let in_plane = |axis, inertia: f32, across: &AxisNorms, gust| {
            let plane = Plane::new(&self.scenario.configuration, self.law, inertia.into(), self.ages);
            InPlane { axis, plane: &plane, across, vertical, gust }.bounded()
        };
        let x = in_plane(Axis::LateralX, inertia.y, along_x, [gust, 0.0])?;
        let y = in_plane(Axis::LateralY, inertia.x, along_y, [gust, 0.0])?;
        let z = in_plane(Axis::Vertical, inertia.y, &still, [0.0, gust])?;
        Ok(Tube { radii: [x, y, z], worst: [along_x, along_y, vertical].map(AxisNorms::worst_gust) })
    }

    /// The greatest gust with a radius, m/s^2, to a hundredth of itself and at most `max`; zero without one.
    #[must_use]
    pub fn greatest_gust(&self, max: f64) -> f64 {
        let (mut proven, mut beyond) = (0.0, max);
        if self.tube(max).is_ok() {
            return max;
        }
        while beyond - proven > 0.01 * beyond.max(0.01) {
            let middle = 0.5 * (proven + beyond);
            if self.tube(middle).is_ok() { proven = middle } else { beyond = middle }
        }
        proven
    }
}

/// A gust in a plane.
struct InPlane<'a> {
    axis: Axis,
    plane: &'a Plane<'a>,
    across: &'a AxisNorms,
    vertical: &'a AxisNorms,
    /// Across and along the vertical, m/s^2.
    gust: [f64; 2],
}

impl InPlane<'_> {
    /// The greatest distance across and along the vertical.
    fn bounded(&self) -> Result<[f64; 2], NoTube> {
        /// Each takes what the last one made.
        const ROUNDS_MAX: usize = 400;
        /// How much more is taken than the rounds come to.
        const TAKEN_FACTOR: f64 = 1.001;
        let mut taken = [Deviation::default(); 2];
        for _ in 0..ROUNDS_MAX {
            let (across, vertical) = self.peaks(&taken);
            if let Some(limit) = self.plane.reached(&across, &vertical) {
                return Err(NoTube::Reached { axis: self.axis, limit });
            }
            let made = self.made(&across, &vertical, &taken);
            // What is taken bounds all that it makes: the proof.
            if made.iter().zip(&taken).all(|(made, taken)| made.is_within(taken)) {
                return self.radii(&across, &vertical, &taken);
            }
            taken = made.map(|deviation| deviation.times(TAKEN_FACTOR));
        }
        Err(NoTube::Grows { axis: self.axis })
    }

    /// The signals' bounds.
    fn peaks(&self, [across, vertical]: &[Deviation; 2]) -> (Peaks, Peaks) {
        let [gust_across, gust_vertical] = self.gust;
        (self.across.peaks(across, gust_across), self.vertical.peaks(vertical, gust_vertical))
    }

    /// What differs while that is so.
    fn made(&self, across: &Peaks, vertical: &Peaks, taken: &[Deviation; 2]) -> [Deviation; 2] {
        let [made_across, made_vertical] = self.plane.deviations(across, vertical);
        [
            made_across.with(Input::Actuator, self.across.actuator_error(across, &taken[0])),
            made_vertical.with(Input::Actuator, self.vertical.actuator_error(vertical, &taken[1])),
        ]
    }

    /// The distances, between ticks as well; and no fallback on the way.
    fn radii(&self, across: &Peaks, vertical: &Peaks, taken: &[Deviation; 2]) -> Result<[f64; 2], NoTube> {
        let accelerations = self.plane.accelerations([across, vertical], taken, self.gust);
        let period = self.vertical.period();
        let [x, z] = [(across, accelerations[0]), (vertical, accelerations[1])]
            .map(|(peaks, acceleration)| peaks.position + acceleration * period * period / 8.0);
        // Along the gust some tick of every window has a speed of at most 2 r over the window, or the way would be
        // longer than it is.
        let slowest = |radius: f64| 2.0 * radius / f64::from(PROGRESS_WINDOW_S);
        let speeds = if self.gust[0] > 0.0 { [slowest(x), vertical.velocity] } else { [across.velocity, slowest(z)] };
        let distance = [x, z, speeds[0], speeds[1]].iter().map(|part| part * part).sum::<f64>().sqrt();
        if distance < NEAR_DISTANCE_M.into() { Ok([x, z]) } else { Err(NoTube::Fallback { axis: self.axis }) }
    }
}

#[cfg(test)]
mod tests;
