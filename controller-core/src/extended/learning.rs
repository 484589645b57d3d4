//! How the estimates learn from an interval: the vehicle's motion against the wrench that acted. Sections 2, 7 and 9
//! of `docs/extended-law.md`.
//!
//! The acceleration, measured or else the difference of velocities, goes to the thrust scale, without gravity and known
//! drag. Its rest beside the scaled thrust goes to the force. The rotation's rest beside the scaled torque goes to the
//! torque bias. Where no velocity is known, the torque bias alone is learnt: rates are enough for it.

use super::force::ForceObserver;
use super::measured::{Measured, Sensors};
use super::memory::{Averages, Estimates, Memory};
use super::parameters::ExtendedParameters;
use super::thrust_scale::ThrustScale;
use super::torque_bias::TorqueBias;
use crate::state::State;
use crate::vehicle::{Limits, Vehicle};
use core::hint::cold_path;
use nalgebra::{Vector3, Vector4};

/// The greatest mean acceleration of an interval that can teach anything, m/s^2, and the greatest change of a body rate
/// in it, rad/s. Beyond them the state has jumped: a line of nonsense, a new frame.
const ACCELERATION_MAX_M_PER_S2: f32 = 1e3;
const RATE_CHANGE_MAX_RAD_PER_S: f32 = 1e3;

/// The constants of the three estimates, for intervals of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Learning {
    pub(super) force: ForceObserver,
    torque: TorqueBias,
    scale: ThrustScale,
    pub(super) sensors: Sensors,
    per_mass: f32,
}

impl Learning {
    /// For intervals of `period`, s.
    #[must_use]
    pub fn new(parameters: &ExtendedParameters, vehicle: &Vehicle, limits: &Limits, period: f32) -> Self {
        Self {
            force: ForceObserver::new(parameters, vehicle.gravity, period),
            torque: TorqueBias::new(parameters, &vehicle.inertia, period),
            scale: ThrustScale::new(parameters, period),
            sensors: Sensors::new(vehicle, limits, period),
            per_mass: 1.0 / vehicle.mass,
        }
    }

    /// The averages in `memory` brought up to this tick, if the last interval can teach anything; `axis` is R e3 now,
    /// `acted` the mean wrench as commanded, N and N m.
    #[must_use]
    #[inline(always)] // likewise: see position.rs
    pub fn updated(
        &self,
        memory: &Memory,
        state: &State,
        axis: &Vector3<f32>,
        measured: &Measured,
        acted: &Vector4<f32>,
    ) -> Averages {
        let averages = &memory.averages;
        let Some(last) = memory.last.as_ref().filter(|_| memory.held == 0) else {
            return *averages;
        };
        let rates = [&last.angular_velocity, &state.angular_velocity];
        if memory.without_velocity > 0 {
            cold_path();
            let acted = Vector3::new(acted.y, acted.z, acted.w) * averages.scale.scale;
            let torque = self.torque.filtered(&averages.torque, &self.torque.observed(rates, &acted));
            return Averages { torque, ..*averages };
        }
        let velocities = [&last.velocity, &state.velocity];
        let differed = self.force.mean_acceleration(velocities);
        let made = self.force.driven_acceleration(differed, velocities);
        let turned = (state.angular_velocity - last.angular_velocity).norm_squared();
        let moves = made.norm_squared() < ACCELERATION_MAX_M_PER_S2 * ACCELERATION_MAX_M_PER_S2;
        if !(moves & (turned < RATE_CHANGE_MAX_RAD_PER_S * RATE_CHANGE_MAX_RAD_PER_S)) {
            return *averages;
        }
        let felt = measured.usable_acceleration();
        let felt = felt.map(|felt| self.sensors.acceleration(felt, &differed, &averages.offset));
        let (made, offset) = felt.map_or((made, averages.offset), |[acceleration, offset]| {
            (self.force.driven_acceleration(acceleration, velocities), offset)
        });
        let commanded = (last.thrust_axis + axis) * (0.5 * self.per_mass * acted.x);
        let scale = self.scale.updated(&averages.scale, &made, &commanded);
        let force = self.force.filtered(&averages.force, &(made - commanded * scale.scale));
        let torque = Vector3::new(acted.y, acted.z, acted.w) * scale.scale;
        let torque = self.torque.observed(rates, &torque);
        Averages { force, scale, torque: self.torque.filtered(&averages.torque, &torque), offset }
    }

    /// The averages cut to their levels.
    #[must_use]
    pub fn estimates(&self, averages: &Averages) -> Estimates {
        let Averages { force, torque, scale, .. } = averages;
        Estimates { force: self.force.estimate(force), torque: self.torque.estimate(torque), scale: scale.scale }
    }
}
