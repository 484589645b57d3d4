//! What is measured of an interval beside the states at its ends. Sections 2 and 10 of `docs/extended-law.md`.
//!
//! | here | equation |
//! |---|---|
//! | [`Measured::acceleration`] | A, the mean of R f - g e3, f an accelerometer's specific force |
//! | [`Sensors::acceleration`] | v' = A - B; B += (1 - e^(-OFFSET_BANDWIDTH_PER_S h)) (A - B - (v_k - v_(k-1)) / h) |
//! | [`Sensors::quick_difference`] | e = W - W_c - E: how the rotors turned beside the model of their commands |
//! | [`Sensors::quick_difference`] | E += (1 - e^(-OFFSET_BANDWIDTH_PER_S h)) e |
//!
//! [`Measured::lost`] is a rotor that its own speed shows to fail. It counts where the motion agrees:
//! [`detector`](super::rotor_loss::detector).
//!
//! W is the mean wrench by the rotors' speeds, W_c the model's. Sensors say what is quick, states and commands what
//! lasts: a bias or a tilt that nobody knows of moves no vehicle, and rotors that turn too slowly for good show in the
//! estimates, or nothing would make up for them. Whatever is measured, the estimates keep to their levels, and what is
//! spent to the tick's budget: a wrong sensor breaks no limit.

use crate::allocation::remaining::LostRotor;
use crate::math;
use crate::state::Wrench;
use crate::vehicle::{Limits, Vehicle};
use nalgebra::{Vector3, Vector4};

/// The greatest acceleration that counts as measured, m/s^2: twice what a sensor of 24 g shows.
const ACCELERATION_MAX_M_PER_S2: f32 = 500.0;

/// Bandwidth of B and E, 1/s.
const OFFSET_BANDWIDTH_PER_S: f64 = 1.0;

/// W counts up to so many times the greatest thrust, along each axis, with the vehicle's radius for an arm.
const THRUSTS_MAX: f32 = 2.0;

/// What was measured since the last tick, as means over that time. Absent, or out of range, it does not count.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measured {
    /// A, m/s^2, world frame.
    pub acceleration: Option<Vector3<f32>>,
    /// W, N and N m: what the rotors' speeds make by the coefficients that commands are converted with.
    pub wrench: Option<Wrench>,
    /// The rotor that fails by its speed.
    pub lost: Option<LostRotor>,
}

impl Measured {
    /// A, if it can be used.
    pub fn usable_acceleration(&self) -> Option<&Vector3<f32>> {
        // A NaN compares false.
        let in_range = |a: &&Vector3<f32>| a.norm_squared() < ACCELERATION_MAX_M_PER_S2 * ACCELERATION_MAX_M_PER_S2;
        self.acceleration.as_ref().filter(in_range)
    }
}

/// The constants for both, for intervals of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// 1 - e^(-OFFSET_BANDWIDTH_PER_S h).
    averaging: f32,
    /// 1 / N, and about each axis 1 / (N m): of the greatest wrench that counts.
    per_greatest: Vector4<f32>,
}

impl Sensors {
    /// For intervals of `period`, s.
    pub fn new(vehicle: &Vehicle, limits: &Limits, period: f32) -> Self {
        let thrust = THRUSTS_MAX * limits.thrust_max;
        let radius = 2.0 * math::sqrt(math::max(vehicle.inertia.x, vehicle.inertia.y) / vehicle.mass);
        let per_torque = 1.0 / (thrust * radius);
        Self {
            averaging: -math::exp_m1(-OFFSET_BANDWIDTH_PER_S * f64::from(period)) as f32,
            per_greatest: Vector4::new(1.0 / thrust, per_torque, per_torque, per_torque),
        }
    }

    /// v', m/s^2, and B with it, for an acceleration that was `measured` while velocities have `differed` by theirs and
    /// B was `offset`.
    pub fn acceleration(
        &self,
        measured: &Vector3<f32>,
        differed: &Vector3<f32>,
        offset: &Vector3<f32>,
    ) -> [Vector3<f32>; 2] {
        let acceleration = measured - offset;
        [acceleration, offset + (acceleration - differed) * self.averaging]
    }

    /// e, and E with it, for a wrench that was `measured` while the model has `acted` and E was `lasting`, N and N m.
    /// The first interval starts E. None for a wrench out of range.
    pub fn quick_difference(
        &self,
        measured: &Wrench,
        acted: &Vector4<f32>,
        lasting: Option<&Vector4<f32>>,
    ) -> Option<[Vector4<f32>; 2]> {
        let Wrench { thrust, torque } = *measured;
        let measured = Vector4::new(thrust, torque.x, torque.y, torque.z);
        // A NaN compares false.
        let in_range = measured.component_mul(&self.per_greatest).norm_squared() < 1.0;
        if !in_range {
            return None;
        }
        let difference = measured - acted;
        let lasting = lasting.copied().unwrap_or(difference);
        let beside = difference - lasting;
        Some([beside, lasting + beside * self.averaging])
    }
}
