//! When the law has to take over: the rules, in the order in which they are looked at. The first that holds is said.
//!
//! | reason | holds when | number | why |
//! |---|---|---|---|
//! | [`Reason::Demand`] | a demand cannot be used | | [`Demand::check`](super::Demand::check) |
//! | [`Reason::Silent`] | no demand for longer than `silence` | 0.1 s | ten ticks at 100 Hz: a policy that is late by more does not fly |
//! | [`Reason::Tilt`] | the thrust axis is farther from the wanted one than [`TILT_MAX_RAD`] | 60 degrees | thrust along u is then half; beyond a right angle none is left |
//! | [`Reason::Rate`] | the body turns about the tilt's axes faster than 1.15 Omega + sqrt(2 TILT_MAX_RAD M_theta / J), or about z faster than [`YAW_RATE_SHARE_MAX`] W_max | | M_theta stops such a turn within [`TILT_MAX_RAD`]; 1.15 Omega is the frame's own |
//! | [`Reason::Speed`] | faster than `speed` | 10 m/s | chosen; a shield's settings change it |
//! | [`Reason::Stop`] | no room holds all places of the [`StoppingForecast`] | | the law would not stop inside |
//! | [`Reason::Estimate`] | force or thrust scale at a level, held, or the force more than thrust holds, for longer than [`DOUBT_MAX_S`] | 1 s | the levels for stopping count on them |

use super::Settings;
use super::reason::Reason;
use crate::extended::controller::StoppingForecast;
use crate::extended::parameters::ExtendedParameters;
use crate::math;
use crate::state::State;
use crate::vehicle::Vehicle;

/// The greatest angle from the thrust axis to where it is wanted, rad, and its cosine.
pub const TILT_MAX_RAD: f32 = core::f32::consts::FRAC_PI_3;
const TILT_COSINE_MIN: f32 = 0.5;

/// The share of Omega by which the frame may exceed it in samples: `docs/extended-law.md`, section 3.
const FRAME_RATE_SHARE_MAX: f32 = 1.15;

/// The greatest rate about the thrust axis, in W_max.
pub const YAW_RATE_SHARE_MAX: f32 = 3.0;

/// For how long an estimate may be in doubt, s.
pub const DOUBT_MAX_S: f32 = 1.0;

/// The rules with their numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Monitor {
    /// Squares of the greatest rate about the tilt's axes, rad^2/s^2, and of the greatest speed, m^2/s^2.
    rate: f32,
    speed: f32,
    yaw_rate: f32,
}

impl Monitor {
    /// For a vehicle under the extended law.
    pub fn new(settings: &Settings, parameters: &ExtendedParameters, vehicle: &Vehicle) -> Self {
        let inertia = math::max(vehicle.inertia.x, vehicle.inertia.y);
        let rate =
            FRAME_RATE_SHARE_MAX * parameters.turn_rate + math::sqrt(2.0 * TILT_MAX_RAD * parameters.m_tilt / inertia);
        Self {
            rate: rate * rate,
            speed: settings.speed * settings.speed,
            yaw_rate: YAW_RATE_SHARE_MAX * parameters.yaw_rate,
        }
    }

    /// Other settings from now on.
    pub fn set_settings(&mut self, settings: &Settings) {
        self.speed = settings.speed * settings.speed;
    }

    /// What speaks against the policy: `inside` says whether a room holds the whole prospect, `doubtful` for how long
    /// an estimate was in doubt, s.
    pub fn violation(&self, state: &State, prospect: &StoppingForecast, inside: bool, doubtful: f32) -> Option<Reason> {
        // Comparisons as they are: one with a NaN is against.
        let w = &state.angular_velocity;
        let fine = [
            (prospect.alignment >= TILT_COSINE_MIN, Reason::Tilt),
            (w.x * w.x + w.y * w.y <= self.rate && w.z.abs() <= self.yaw_rate, Reason::Rate),
            (state.velocity.norm_squared() <= self.speed, Reason::Speed),
            (inside, Reason::Stop),
            (doubtful <= DOUBT_MAX_S, Reason::Estimate),
        ];
        fine.iter().find(|(fine, _)| !fine).map(|(_, reason)| *reason)
    }
}
