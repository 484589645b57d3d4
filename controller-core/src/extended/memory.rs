//! What the extended law remembers from one tick to the next.

use super::actuators::ActuatorState;
use super::fallback::Fallback;
use super::position::Filters;
use super::rotor_loss::detector::Suspicion;
use crate::path_lifting::Lift;
use crate::vehicle::Vehicle;
use nalgebra::{Vector2, Vector3, Vector4};

/// The estimates, cut to their levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimates {
    /// d, the force per mass, m/s^2, world frame.
    pub force: Vector3<f32>,
    /// The torque bias, N m, body frame.
    pub torque: Vector3<f32>,
    /// The thrust scale: delivered over commanded.
    pub scale: f32,
}

impl Estimates {
    /// Nothing known.
    pub const NONE: Self = Self { force: Vector3::new(0.0, 0.0, 0.0), torque: Vector3::new(0.0, 0.0, 0.0), scale: 1.0 };
}

/// The thrust scale and the averages behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleEstimate {
    /// ybar and fbar, m/s^2. The first interval starts them: any other start would look like a variation.
    pub slow: Option<[Vector3<f32>; 2]>,
    /// s.
    pub scale: f32,
}

/// The averages, before they are cut to their levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Averages {
    /// zeta, the force per mass, m/s^2, world frame.
    pub force: Vector3<f32>,
    /// The torque bias, N m, body frame.
    pub torque: Vector3<f32>,
    /// The thrust scale and its slow averages.
    pub scale: ScaleEstimate,
    /// B of [`measured`](super::measured), m/s^2, world frame.
    pub offset: Vector3<f32>,
}

impl Averages {
    /// With torque bias and thrust scale known.
    pub fn known(torque: Vector3<f32>, scale: f32) -> Self {
        Self { force: Vector3::zeros(), torque, scale: ScaleEstimate { slow: None, scale }, offset: Vector3::zeros() }
    }
}

/// The last tick, as far as the estimates need it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LastTick {
    pub velocity: Vector3<f32>,
    /// R e3.
    pub thrust_axis: Vector3<f32>,
    pub angular_velocity: Vector3<f32>,
    /// The acceleration fed forward, rad/s^2.
    pub forward: Vector3<f32>,
}

/// Everything the law remembers from one tick to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory {
    /// c, x and y.
    pub filters: Filters,
    /// The path lifting's memory; none before the first step.
    pub lift: Option<Lift>,
    /// The side that the thrust axis came from; none before the first step.
    pub side: Option<Vector2<f32>>,
    /// The torque about z, either way, that was left in the last tick, N m.
    pub yaw_torque_left: f32,
    /// The averages behind the estimates.
    pub averages: Averages,
    /// The fallback.
    pub fallback: Fallback,
    /// Ticks for which the estimates are still held.
    pub(super) held: u32,
    /// Ticks for which they are held because no velocity was known.
    pub(super) without_velocity: u32,
    pub(super) last: Option<LastTick>,
    pub(super) actuators: ActuatorState,
    /// The mean wrench since the last tick, as commanded: (T, tau) divided by the scale.
    pub(super) acted: Vector4<f32>,
    /// E of [`measured`](super::measured); none before rotor speeds were measured.
    pub(super) wrench_offset: Option<Vector4<f32>>,
    /// Whether a rotor fails.
    pub(super) suspicion: Suspicion,
}

impl Memory {
    /// A memory of `averages` and nothing else.
    pub(super) fn fresh(vehicle: &Vehicle, averages: Averages) -> Self {
        let hover = Vector4::new(vehicle.mass * vehicle.gravity / averages.scale.scale, 0.0, 0.0, 0.0);
        Self {
            filters: Filters::at(Vector3::zeros()),
            lift: None,
            side: None,
            yaw_torque_left: 0.0,
            averages,
            fallback: Fallback::FRESH,
            held: 0,
            without_velocity: 0,
            last: None,
            actuators: ActuatorState::steady(hover),
            acted: hover,
            wrench_offset: None,
            suspicion: Suspicion::NONE,
        }
    }
}
