//! The sampled loop with real actuators, linearised about hover: will these gains hold still on this vehicle?
//!
//! The paper's proofs are for continuous time and ideal actuators. On a vehicle the law is evaluated every h seconds,
//! its wrench arrives d samples late and is held, and rotors follow it with a first-order lag. Near the origin the
//! saturations have unit slope and the axes separate, so each axis is a linear sampled loop whose transition matrix is
//! known exactly:
//!
//! | [`Axis`] | command | what follows it |
//! |---|---|---|
//! | `Roll`, `Pitch`, `Yaw` | tau_i from MRP and rate error | body rate, angle |
//! | `LateralX`, `LateralY` | tau_2, tau_1 with the whole law in front: z, filters, force, omega_d, omega_d' | rate, tilt, velocity, position |
//! | `Vertical` | thrust from z and filters | velocity, position |
//!
//! For each: the spectral radius per sample, and the gain and delay margins at the actuator's command.
//! `docs/sampled-loop.md` derives the matrices. The extended law's estimates are part of them, each with its own gains.
//! Mass drops out.
//!
//! It cannot speak about large errors: a saturated loop has less gain, so a loop with a lower gain limit
//! ([`Margins::gain_down`]) or a small one may still hang in a limit cycle far from the origin. Nor about noise,
//! flexible frames, the thrust that a rotor loses in moving air, or the torque of a rotor's own acceleration, which
//! helps yaw.

mod chain;
mod compensator;
pub(crate) mod disturbed;
mod gains;
mod lag;
mod law;
mod margins;
mod slopes;
mod spectral_radius;

use chain::SampledLoop;
use controller_core::configuration::LawParameters;
use controller_core::error::{ParameterError, Reason};
use controller_core::vehicle::Vehicle;
use disturbed::DisturbedLoop;
use law::{Law, Tracker};
use slopes::Slopes;
pub(crate) use spectral_radius::{balance, spectral_radius};

/// The law's own limit.
const PERIOD_MAX_S: f32 = 0.1;

/// The factors on the lag that are looked at: powers of this, and of its inverse.
const LAG_FACTOR_STEP: f64 = 1.05;
const LAG_FACTOR_STEPS: i32 = 47;

/// The maximum delay looked at, samples: the delay line is part of the matrix.
pub const DELAY_MAX_SAMPLES: f32 = 64.0;

/// When commands are computed and how they reach the vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopTiming {
    /// Time h between ticks, s, in (0, 0.1].
    pub period: f64,
    /// Time constant of the rotors' thrust, s; zero for ideal ones.
    pub rotor_lag: f64,
    /// From the sample to the moment its wrench is applied, in periods, in [0, 64].
    pub delay_samples: f64,
}

/// One loop of the vehicle near hover. World axes are those of the heading: x forward, y left, z up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Attitude about body x, its reference at rest.
    Roll,
    /// Attitude about body y, its reference at rest.
    Pitch,
    /// Attitude about body z: the heading.
    Yaw,
    /// Position forward, through pitch.
    LateralX,
    /// Position to the left, through roll.
    LateralY,
    /// Height, through the thrust.
    Vertical,
}

impl Axis {
    /// All of them, in the order of [`LoopModel::reports`].
    pub const ALL: [Self; 6] = [Self::Roll, Self::Pitch, Self::Yaw, Self::LateralX, Self::LateralY, Self::Vertical];

    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Roll => "roll",
            Self::Pitch => "pitch",
            Self::Yaw => "yaw",
            Self::LateralX => "lateral x",
            Self::LateralY => "lateral y",
            Self::Vertical => "vertical",
        }
    }
}

/// How far a stable loop is from instability, each margin alone and taken at the actuator's command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Minimum factor > 1 on the loop's gain that destabilises it; infinite if none does.
    pub gain_up: f64,
    /// Maximum factor < 1 that destabilises it; zero if none does.
    pub gain_down: f64,
    /// Minimum additional delay that destabilises it, s.
    pub delay: f64,
    /// Highest frequency at which the loop's gain is one, rad/s.
    pub crossover: f64,
}

/// The linear model's result for one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopReport {
    /// Which loop.
    pub axis: Axis,
    /// Largest magnitude of a closed-loop eigenvalue, per sample: stable below one.
    pub spectral_radius: f64,
    /// None if the loop is unstable as it is.
    pub margins: Option<Margins>,
}

/// A vehicle, its law and its timing, as far as small motions are concerned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopModel {
    slopes: Slopes,
    timing: LoopTiming,
    /// Of the filter that the velocity comes from, rad/s; none if it is known.
    velocity_bandwidth: Option<f64>,
}

impl LoopModel {
    /// The loops of `vehicle` flown under `law` at the given timing.
    ///
    /// # Errors
    /// Names `control.period`, `rotors.lag` or `sampling.delay` if it is not finite or outside its range.
    pub fn new(vehicle: &Vehicle, law: &LawParameters, timing: LoopTiming) -> Result<Self, ParameterError> {
        let LoopTiming { period, rotor_lag, delay_samples } = timing;
        for (value, field) in [(period, "control.period"), (rotor_lag, "rotors.lag"), (delay_samples, "sampling.delay")]
        {
            require(value.is_finite(), field, Reason::NotFinite)?;
        }
        require(period > 0.0, "control.period", Reason::NotPositive)?;
        require(period <= f64::from(PERIOD_MAX_S), "control.period", Reason::Above(PERIOD_MAX_S))?;
        require(rotor_lag >= 0.0, "rotors.lag", Reason::Negative)?;
        require(delay_samples >= 0.0, "sampling.delay", Reason::Negative)?;
        require(delay_samples <= f64::from(DELAY_MAX_SAMPLES), "sampling.delay", Reason::Above(DELAY_MAX_SAMPLES))?;
        let inertia = [vehicle.inertia.x, vehicle.inertia.y, vehicle.inertia.z].map(f64::from);
        Ok(Self { slopes: Slopes::from_law(law, inertia), timing, velocity_bandwidth: None })
    }

    /// The same loops with the velocity from the positions, by an alpha-beta filter with a double pole at `bandwidth`,
    /// rad/s.
    #[must_use]
    pub fn with_velocity_from_positions(&self, bandwidth: f64) -> Self {
        Self { velocity_bandwidth: Some(bandwidth), ..*self }
    }

    /// The same loops with k_p and k_v multiplied by these factors: stable for all pairs of equal factors from one to a
    /// number, they have that gain margin at the position feedback. The gains need not be ones that may fly.
    #[must_use]
    pub fn with_position_feedback(&self, factors: [f64; 2]) -> Self {
        Self { slopes: self.slopes.with_position_feedback(factors), ..*self }
    }

    /// Spectral radius and margins of one loop.
    #[must_use]
    pub fn report(&self, axis: Axis) -> LoopReport {
        let LoopTiming { period, rotor_lag, delay_samples } = self.timing;
        let law = self.law(axis);
        let compensator = law.compensator();
        let chain = SampledLoop::new(&compensator, law.integrators(), rotor_lag / period, delay_samples);
        let spectral_radius = chain.spectral_radius();
        let margins = (spectral_radius < 1.0).then(|| {
            let margins = margins::margins(&chain, delay_samples, period);
            Margins {
                gain_up: margins.gain_up,
                gain_down: margins.gain_down,
                delay: margins.delay * period,
                crossover: margins.crossover / period,
            }
        });
        LoopReport { axis, spectral_radius, margins }
    }

    /// The minimum and the maximum factor on the rotors' lag, while the law believes in the one it was given, between
    /// which every loop is stable; zero or infinite where none destabilises it.
    #[must_use]
    pub fn lag_factors(&self) -> [f64; 2] {
        let is_stable = |factor: f64| {
            let timing = LoopTiming { rotor_lag: self.timing.rotor_lag * factor, ..self.timing };
            Axis::ALL.into_iter().all(|axis| Self { timing, ..*self }.spectral_radius(axis) < 1.0)
        };
        let first_unstable =
            |step: f64| (1..=LAG_FACTOR_STEPS).map(|n| step.powi(n)).find(|factor| !is_stable(*factor));
        [first_unstable(1.0 / LAG_FACTOR_STEP).unwrap_or(0.0), first_unstable(LAG_FACTOR_STEP).unwrap_or(f64::INFINITY)]
    }

    /// All loops, in the order of [`Axis::ALL`].
    #[must_use]
    pub fn reports(&self) -> [LoopReport; 6] {
        Axis::ALL.map(|axis| self.report(axis))
    }

    /// The spectral radius of one loop alone: a fraction of a report's cost.
    #[must_use]
    pub fn spectral_radius(&self, axis: Axis) -> f64 {
        let LoopTiming { period, rotor_lag, delay_samples } = self.timing;
        let law = self.law(axis);
        let compensator = law.compensator();
        SampledLoop::new(&compensator, law.integrators(), rotor_lag / period, delay_samples).spectral_radius()
    }

    /// One loop with what comes to it from outside, the actuator's lag and gain being so many times those that the law
    /// believes in.
    pub(crate) fn disturbed(&self, axis: Axis, lag_factor: f64, gain: f64) -> DisturbedLoop {
        let LoopTiming { period, rotor_lag, delay_samples } = self.timing;
        DisturbedLoop::new(&self.law(axis), lag_factor * rotor_lag / period, delay_samples, gain)
    }

    fn law(&self, axis: Axis) -> Law {
        let (slopes, period) = (&self.slopes, self.timing.period);
        let actuator = slopes.actuator(period);
        let (across, vertical) = (slopes.estimated_across(period), slopes.estimated_vertical(period));
        let torque = |body: usize| slopes.torque(body, period);
        let tracker = self.velocity_bandwidth.map(|bandwidth| Tracker::new(bandwidth * period));
        match axis {
            Axis::Roll => Law::attitude(torque(0), across, actuator),
            Axis::Pitch => Law::attitude(torque(1), across, actuator),
            Axis::Yaw => Law::attitude(torque(2), vertical, actuator),
            Axis::LateralX => Law::lateral(slopes.across(period), torque(1), across, actuator).tracking(tracker),
            Axis::LateralY => Law::lateral(slopes.across(period), torque(0), across, actuator).tracking(tracker),
            Axis::Vertical => Law::vertical(slopes.vertical(period), vertical, actuator).tracking(tracker),
        }
    }
}

/// Refuses `field` for `reason` unless `condition` holds.
fn require(condition: bool, field: &'static str, reason: Reason) -> Result<(), ParameterError> {
    if condition { Ok(()) } else { Err(ParameterError { field, reason }) }
}
