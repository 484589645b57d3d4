//! What the extended law remembers from one tick to the next.

use super::actuators::ActuatorState;
use super::heading::HeadingLag;
use super::net::Net;
use super::thrust_scale::ScaleEstimate;
use crate::path_lifting::Lift;
use crate::position::FilterState;
use crate::vehicle::Vehicle;
use nalgebra::{Vector3, Vector4};

/// What the law knows beyond its filters and its lift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimates {
    /// zeta, the averaged force per mass, m/s^2, world frame, before it is cut to its levels.
    pub force: Vector3<f32>,
    /// The averaged torque bias, N m, body frame, before it is cut to its level.
    pub torque: Vector3<f32>,
    /// What the rotors deliver of what is commanded.
    pub scale: ScaleEstimate,
}

impl Estimates {
    /// Nothing known, under `gravity`, m/s^2.
    #[must_use]
    pub fn none(gravity: f32) -> Self {
        Self { force: Vector3::zeros(), torque: Vector3::zeros(), scale: ScaleEstimate::none(gravity) }
    }
}

/// The last tick, as far as the estimates need it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Last {
    pub velocity: Vector3<f32>,
    /// R e3.
    pub thrust_axis: Vector3<f32>,
    pub angular_velocity: Vector3<f32>,
    /// R~^T omega_d', rad/s^2.
    pub wanted: Vector3<f32>,
}

/// Everything the law remembers from one tick to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory {
    /// x_f.
    pub filter: FilterState,
    /// The path lifting's memory; none before the first step.
    pub lift: Option<Lift>,
    /// The heading's lag; none before the first step.
    pub heading: Option<HeadingLag>,
    /// The estimates.
    pub estimates: Estimates,
    /// The net.
    pub net: Net,
    /// Ticks for which the estimates are still held.
    pub(super) held: u32,
    pub(super) last: Option<Last>,
    pub(super) actuators: ActuatorState,
    /// The mean wrench since the last tick, as commanded: (T, tau) divided by the scale.
    pub(super) acted: Vector4<f32>,
}

impl Memory {
    /// A memory of `estimates` and nothing else.
    pub(super) fn fresh(vehicle: &Vehicle, estimates: Estimates) -> Self {
        let hover = Vector4::new(vehicle.mass * vehicle.gravity / estimates.scale.scale, 0.0, 0.0, 0.0);
        Self {
            filter: FilterState::ZERO,
            lift: None,
            heading: None,
            estimates,
            net: Net::FRESH,
            held: 0,
            last: None,
            actuators: ActuatorState::steady(hover),
            acted: hover,
        }
    }
}
