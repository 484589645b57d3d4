//! The extremes of a flight that claims and searches judge, gathered tick by tick.
//!
//! "Steady state" is the last quarter of a flight, its last tick at least: of the paper's 40 s, the last 10. A flight
//! has *reached* its reference once it is near it and stays near it until the end: in position within
//! [`POSITION_TOLERANCE_M`], in attitude, heading included, within [`MRP_TOLERANCE`]. Where a known path goes beyond
//! `[reference_bounds]` its heading may lag, so there the tilt alone counts. A vehicle that stands on the ground does
//! not fly: it is away from its reference wherever that is.
//!
//! A flight is *there* once it has been near in both for a second, or from its start if it starts near in both and at
//! the reference's velocity. From then on it is on its way with its reference, and the greatest distance from it counts
//! as tracking error: before, it recovers or approaches.

use crate::flight::least_command::LeastCommand;
use crate::flight::{Flight, FlightError, Tick};
use controller_core::reference::{Reference, ReferenceBounds};
use nalgebra::Vector3;
use scenario::Scenario;

/// How near to its reference's position a vehicle must stay: less than a quadrotor's own size.
pub const POSITION_TOLERANCE_M: f64 = 0.2;
/// How near to the desired attitude, norm of the modified Rodrigues parameters: 11 degrees.
pub const MRP_TOLERANCE: f64 = 0.05;
/// How near to the reference's velocity a flight must start to be there.
const VELOCITY_TOLERANCE_M_PER_S: f64 = 0.2;
/// For how long a flight must be near before it is there: a vehicle that passes by is not.
const ARRIVAL_DEBOUNCE_US: u64 = 1_000_000;
/// Extremes of no value at all.
const EMPTY_EXTREMES: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// The extremes of a flight, gathered tick by tick.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightExtremes {
    steady_from_us: u64,
    /// Until when the vehicle was, or may have been, away from its reference in position and in attitude, us.
    away_until_us: (u64, u64),
    period_us: u64,
    /// `[reference_bounds]`.
    bounds: ReferenceBounds,
    there: bool,
    last_sign: Option<f32>,
    start_height: Option<f64>,
    /// Ticks seen.
    pub ticks: u64,
    /// Least and greatest commanded thrust, N.
    pub thrust: (f64, f64),
    /// Greatest commanded |torque| about each body axis, N m.
    pub torque: [f64; 3],
    /// Least and greatest thrust commanded of each rotor, N; empty without rotors.
    pub rotors: Vec<(f64, f64)>,
    /// Least command of any rotor.
    pub least_command: LeastCommand,
    /// Greatest component of u_f and u_s, m/s^2.
    pub filter: f64,
    /// Ticks at which the plant clipped a command.
    pub clipped: u64,
    /// Changes of m*.
    pub lift_changes: u64,
    /// Greatest position error in steady state, m.
    pub steady_position_error: f64,
    /// Greatest norm of the modified Rodrigues parameters in steady state.
    pub steady_mrp_error: f64,
    /// Start minus lowest height, m.
    pub height_lost: f64,
    /// Greatest position error since it was there, m, and when, s; none before.
    pub strayed: Option<(f64, f64)>,
}

/// Whether yaw is certified to follow the heading of `reference`: it is within `bounds`.
pub fn heading_is_followed(reference: &Reference, bounds: &ReferenceBounds) -> bool {
    const HEADING_BOUNDS_TOLERANCE: f32 = 1e-3;
    bounds.contain(reference, HEADING_BOUNDS_TOLERANCE)
}

/// The part of an attitude's error, modified Rodrigues parameters, that is certified to vanish.
pub fn claimed_error(mrp: &Vector3<f32>, reference: &Reference, bounds: &ReferenceBounds) -> f64 {
    f64::from(if heading_is_followed(reference, bounds) { mrp.norm() } else { mrp.xy().norm() })
}

impl FlightExtremes {
    /// Nothing seen yet of a flight of `scenario`.
    pub fn new(scenario: &Scenario) -> Self {
        let timing = &scenario.timing;
        Self {
            steady_from_us: timing.ticks.saturating_sub((timing.ticks / 4).max(1)) * timing.period_us,
            away_until_us: (0, 0),
            period_us: timing.period_us,
            bounds: *scenario.configuration.bounds(),
            there: false,
            last_sign: None,
            start_height: None,
            ticks: 0,
            thrust: EMPTY_EXTREMES,
            torque: [0.0; 3],
            rotors: Vec::new(),
            least_command: LeastCommand::before_flight(scenario),
            filter: 0.0,
            clipped: 0,
            lift_changes: 0,
            steady_position_error: 0.0,
            steady_mrp_error: 0.0,
            height_lost: 0.0,
            strayed: None,
        }
    }

    /// Takes one tick into account.
    pub fn observe(&mut self, tick: &Tick) {
        let (wrench, diagnostics) = (&tick.wrench, &tick.diagnostics);
        let thrust = f64::from(wrench.thrust);
        self.ticks += 1;
        self.thrust = (self.thrust.0.min(thrust), self.thrust.1.max(thrust));
        for (greatest, torque) in self.torque.iter_mut().zip(wrench.torque.iter()) {
            *greatest = greatest.max(f64::from(torque.abs()));
        }
        self.filter = self.filter.max(f64::from(diagnostics.filtered.amax().max(diagnostics.intermediate.amax())));
        // While the first command is on its way there is none.
        self.rotors.resize(self.rotors.len().max(tick.rotor_thrusts.len()), EMPTY_EXTREMES);
        for (rotor, (extremes, thrust)) in self.rotors.iter_mut().zip(&tick.rotor_thrusts).enumerate() {
            let thrust = f64::from(*thrust);
            // A rotor that is gone is stopped.
            if thrust == 0.0 && tick.lost.is_some_and(|lost| lost.rotor == rotor) {
                continue;
            }
            *extremes = (extremes.0.min(thrust), extremes.1.max(thrust));
        }
        self.least_command.observe(&tick.rotor_thrusts);
        self.clipped += u64::from(tick.clipped);
        self.lift_changes += u64::from(self.last_sign.is_some_and(|sign| sign != diagnostics.lift_sign));
        self.last_sign = Some(diagnostics.lift_sign);
        let height = tick.state.position.z;
        self.height_lost = self.height_lost.max(*self.start_height.get_or_insert(height) - height);
        let position_error = (tick.state.position - tick.reference.position.map(f64::from)).norm();
        let mrp_error = f64::from(diagnostics.mrp.norm());
        if position_error > POSITION_TOLERANCE_M || tick.surroundings.standing {
            self.away_until_us.0 = tick.time_us + self.period_us;
        }
        if claimed_error(&diagnostics.mrp, &tick.reference, &self.bounds) > MRP_TOLERANCE {
            self.away_until_us.1 = tick.time_us + self.period_us;
        }
        let velocity_error = (tick.state.velocity - tick.reference.velocity.map(f64::from)).norm();
        self.there |= self.ticks == 1 && self.away_until_us == (0, 0) && velocity_error <= VELOCITY_TOLERANCE_M_PER_S;
        self.there |= tick.time_us >= self.away_until_us.0.max(self.away_until_us.1) + ARRIVAL_DEBOUNCE_US;
        if self.there && self.strayed.is_none_or(|(greatest, _)| position_error > greatest) {
            self.strayed = Some((position_error, tick.time_us as f64 / 1e6));
        }
        if tick.time_us >= self.steady_from_us {
            self.steady_position_error = self.steady_position_error.max(position_error);
            self.steady_mrp_error = self.steady_mrp_error.max(mrp_error);
        }
    }

    /// When the vehicle reached its reference's position for good, s; none if it was away from it at the last tick.
    pub fn position_reached(&self) -> Option<f64> {
        self.reached(self.away_until_us.0)
    }

    /// When it reached the desired attitude for good, s; none likewise.
    pub fn attitude_reached(&self) -> Option<f64> {
        self.reached(self.away_until_us.1)
    }

    fn reached(&self, away_until_us: u64) -> Option<f64> {
        (away_until_us < self.ticks * self.period_us).then_some(away_until_us as f64 / 1e6)
    }

    /// Flies a whole `flight` of `scenario` from its start.
    ///
    /// # Errors
    /// If it cannot be flown to its end.
    pub fn gather(scenario: &Scenario, mut flight: Flight) -> Result<Self, FlightError> {
        let mut flown = Self::new(scenario);
        for _ in 0..scenario.timing.ticks {
            flown.observe(&flight.tick()?);
        }
        Ok(flown)
    }
}

#[cfg(test)]
mod tests;
