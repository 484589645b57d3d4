//! The inputs and outputs of a rival law.
//!
//! World frame z up; body x forward, y left, z up; attitudes are body to world; SI units; double precision.

use super::jet::Jet;
use crate::vehicle::sensed::Sensed;
use nalgebra::{UnitQuaternion, Vector3};

/// A rival's model of its vehicle: the same numbers as ours has, rotor lag and delay included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RivalModel {
    /// kg.
    pub mass: f64,
    /// Diagonal of J, kg m^2.
    pub inertia: Vector3<f64>,
    /// m/s^2.
    pub gravity: f64,
    /// Between ticks, s.
    pub period: f64,
    /// Of the rotors, s.
    pub lag: f64,
    /// Between a tick and its command's effect, s.
    pub delay: f64,
    /// Greatest thrust, N.
    pub thrust_max: f64,
}

/// The vehicle's state, as measured, and what is measured beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RivalState {
    /// m, world.
    pub position: Vector3<f64>,
    /// m/s, world.
    pub velocity: Vector3<f64>,
    /// R.
    pub attitude: UnitQuaternion<f64>,
    /// omega, rad/s, body.
    pub rate: Vector3<f64>,
    /// Force and torque, by accelerometer and rotor speeds.
    pub sensed: Sensed,
}

/// The reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RivalReference {
    /// m.
    pub position: Vector3<f64>,
    /// m/s.
    pub velocity: Vector3<f64>,
    /// The reference's own acceleration, m/s^2.
    pub motion: Vector3<f64>,
    /// The same with the known drag of the reference's velocity added, and its derivatives: what the rotors must make
    /// besides gravity.
    pub acceleration: Jet,
    /// Unit vector of the heading, its z zero.
    pub heading: Jet,
}

/// A rival's command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Commanded {
    /// N, along body z; negative is clipped.
    pub thrust: f64,
    /// N m, body.
    pub torque: Vector3<f64>,
    /// R_d.
    pub desired: UnitQuaternion<f64>,
    /// omega_d, rad/s, axes of the desired body frame.
    pub desired_rate: Vector3<f64>,
}

/// A control law to compare with.
pub trait Rival: std::fmt::Debug + Send + Sync {
    /// One tick.
    fn step(&mut self, state: &RivalState, target: &RivalReference) -> Commanded;

    /// Whether limits or rotors cut something of the tick's command. Laws without memory of it ignore it.
    fn was_cut(&mut self, _cut: bool) {}

    /// Itself, elsewhere.
    fn boxed(&self) -> Box<dyn Rival>;
}

/// omega x J omega: the torque that keeps a spinning body turning about where it turns.
#[must_use]
pub fn gyroscopic(inertia: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    rate.cross(&inertia.component_mul(rate))
}

/// (across, across, along): a gain across and one along the third axis.
#[must_use]
pub fn paired(across: f64, along: f64) -> Vector3<f64> {
    Vector3::new(across, across, along)
}
