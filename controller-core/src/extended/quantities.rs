//! The numbers that the constants' defaults are made of. The formulas of the defaults stand where the constants are
//! declared, in [`super::parameters`]; section 14 of `docs/extended-law.md` derives them.

use super::actuators::ActuatorParameters;
use super::budget::{TORQUE_THRUST_SHARE, TorqueBudget};
use crate::allocation::Rotors;
use crate::math::{max_f64 as max, min_f64 as min, sqrt_f64 as sqrt, tan};
use crate::vehicle::{Limits, Vehicle};
use core::f64::consts::PI;

/// The numbers of a vehicle.
#[derive(Debug, Clone, Copy)]
pub struct Airframe<'a> {
    /// The body.
    pub vehicle: &'a Vehicle,
    /// Its limits.
    pub limits: &'a Limits,
    /// Its rotors, if it has any.
    pub rotors: Option<&'a Rotors>,
    /// How they respond.
    pub actuators: ActuatorParameters,
    /// Between ticks, s.
    pub period: f32,
    /// Known drag across per velocity and mass, 1/s.
    pub drag: f32,
}

/// A vehicle's numbers, and each constant by its key: as it is given, or by its formula. SI units.
#[allow(non_snake_case, reason = "inertia is called as in docs/scenario-file.md")]
pub struct Quantities<'a> {
    airframe: &'a Airframe<'a>,
    given: &'a dyn Fn(&str) -> Option<f32>,
    budget: TorqueBudget,
    pub(super) mass: f64,
    pub(super) g: f64,
    J_11: f64,
    J_22: f64,
    pub(super) J_33: f64,
    h: f64,
    lag: f64,
    delay: f64,
    pub(super) drag: f64,
    pub(super) torque_max_z: f64,
    /// Without rotors the delivered thrust is the commanded one.
    pub(super) thrust_loss: f64,
    pub(super) thrust_gain: f64,
}

/// Declares quantities by their formulas, which the page of scenario files shows.
macro_rules! quantities {
    ($of:ident: $( $(#[$about:meta])* $name:ident = $formula:expr; )*) => {
        #[allow(non_snake_case, reason = "they are called as in docs/scenario-file.md")]
        impl Quantities<'_> {
            /// Names and formulas.
            pub const FORMULAS: &'static [(&'static str, &'static str)] =
                &[$((stringify!($name), stringify!($formula))),*];

            $( $(#[$about])* pub(super) fn $name(&self) -> f64 {
                let $of = self;
                $formula
            } )*
        }
    };
}

quantities! { d:
    /// The mean moment of inertia of the tilt.
    J = (d.J_11 + d.J_22) / 2.0;
    /// The greater one.
    J_max = max(d.J_11, d.J_22);
    /// The rotors' lag and the delay together.
    T = d.lag + d.delay;
    /// The delay that projection leaves: half a tick, a part of T, and what is unknown of when a pose was true.
    t_0 = d.h / 2.0 + 0.12 * d.T() + 0.01;
    /// The bandwidth of the tilt, rad/s: what size, delay and torque allow.
    w_a = min(sqrt(min(0.075 / sqrt(d.J() / d.mass), 1.0)) * 0.22 / d.t_0(), sqrt(2.0 * d.tilt_torque() / d.J()));
    /// The bandwidth of the heading, rad/s.
    w_y = min(2.4 * sqrt(d.yaw_acceleration()), 0.3 * d.w_a());
    /// How much stiffer the vertical may be: its loop has no tilt in it.
    stiffer = min(1.4, 0.42 / (d.k_v_across() * max(d.T(), 0.001)));
    /// The cosine of the tilt that leaves the least lift at the greatest |u|.
    lift_cosine = min(1.05 * (d.g - d.a_down()) / d.U(), 1.0);
    /// tan gamma.
    steepest = min(sqrt(max(1.0 - d.lift_cosine() * d.lift_cosine(), 0.0)) / d.lift_cosine(), tan(75.0 * PI / 180.0));
}

/// The references' vertical acceleration that the thrust floor allows, m/s^2.
const REFERENCE_FALL_M_PER_S2: f64 = 1.0;

impl<'a> Quantities<'a> {
    /// Of `airframe`, some of whose constants are `given`, by their keys.
    pub(super) fn new(airframe: &'a Airframe, given: &'a dyn Fn(&str) -> Option<f32>) -> Self {
        let Airframe { vehicle, limits, rotors, actuators, .. } = *airframe;
        let [thrust_loss, thrust_gain] = if rotors.is_some() { [0.1, 0.15] } else { [0.0, 0.0] };
        let mut quantities = Self {
            airframe,
            given,
            budget: TorqueBudget::new(0.0, limits, rotors),
            mass: vehicle.mass.into(),
            g: vehicle.gravity.into(),
            J_11: vehicle.inertia.x.into(),
            J_22: vehicle.inertia.y.into(),
            J_33: vehicle.inertia.z.into(),
            h: airframe.period.into(),
            lag: actuators.lag.into(),
            delay: actuators.delay.into(),
            drag: airframe.drag.into(),
            torque_max_z: limits.torque_max.z.into(),
            thrust_loss,
            thrust_gain,
        };
        quantities.budget = TorqueBudget::new(quantities.floor_margin() as f32, limits, rotors);
        quantities
    }

    /// The constant that is given under this key.
    pub(super) fn given(&self, key: &str) -> Option<f64> {
        (self.given)(key).map(f64::from)
    }

    /// M: the torque about the tilt's axes that limits and rotors give in every direction, N m.
    pub(super) fn tilt_torque(&self) -> f64 {
        min(self.budget.radius(self.scale_least()), self.budget.radius(self.scale_greatest()))
    }

    /// The part of the acceleration that the rotors hold near the target, m/s^2.
    #[allow(non_snake_case, reason = "its name in docs/extended-law.md")]
    pub(super) fn U(&self) -> f64 {
        self.budget.held_acceleration(self.airframe.vehicle, self.airframe.limits, 1.0)
    }

    /// The rotors' greatest |beta_12| and |beta_3|, 1/m.
    fn reach(&self) -> [f64; 2] {
        self.budget.reach.map(|reach| max(reach, 1e-12))
    }

    /// How far the least thrust near the target is above the idle thrust, N.
    fn above_idle(&self) -> f64 {
        let least = (1.0 - TORQUE_THRUST_SHARE) * self.mass * (self.g - self.force_up() - REFERENCE_FALL_M_PER_S2);
        max(least - self.scale_greatest() * self.budget.ends[0] - self.budget.margin, 0.0)
    }

    /// The torque about z that limits and rotors give near the target, N m.
    pub(super) fn yaw_torque(&self) -> f64 {
        let thrust_max = min(self.budget.ends[1], self.airframe.limits.thrust_max.into());
        let below = max(self.scale_least() * thrust_max - 1.1 * self.mass * self.g, 0.0);
        min(self.torque_max_z, 0.8 * min(self.above_idle(), below) / self.reach()[1])
    }

    /// What the least thrust near the target leaves the rotors to turn with beside A, rad/s^2.
    pub(super) fn lifted(&self) -> f64 {
        let [tilt_reach, yaw_reach] = self.reach();
        let left = max(self.above_idle() - yaw_reach * self.J_33 * self.yaw_acceleration(), 0.0);
        0.9 * left / (tilt_reach * self.J_max())
    }
}
