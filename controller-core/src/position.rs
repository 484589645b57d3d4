//! The saturated position law with its two filters, Section IV of the paper.
//!
//! | paper | here | equation |
//! |---|---|---|
//! | p~ = p - p_d, v~ = v - p_d' | `position_error`, `velocity_error` | Section IV |
//! | z_1 = p~ + (1/k_f + 1/k_s) v~ + u_f / (k_s k_f) | `z_1` | (Zcoordinates) |
//! | z_2 = v~ + u_f / k_f + u_s / k_s | `z_2` | (Zcoordinates) |
//! | ubar_p = -sigma_p(k_p z_1 + k_v z_2), sigma_p(s) = M_p tanh(s / M_p) | `feedback` | Section IV, VI |
//! | u = u_f + g e3 + p_d'' | `acceleration_command` | (PositionControlLaw) |
//! | u_f' = -k_f (u_f - u_s), u_s' = -k_s (u_s - ubar_p) | [`FilterTransition`] | (FilterDynamics) |
//! | u' = u_f' + p_d''' | [`CommandRates::jerk_command`] | from the two above |
//! | u'' = -k_f (u_f' - u_s') + p_d'''' | [`CommandRates::snap_command`] | from the two above |
//!
//! All vectors are in the world frame; u in m/s^2. The filters are linear and their input is held between ticks, so
//! they are advanced exactly: each new state is a convex combination of the old ones and the input, whatever the
//! period.
//!
//! The tick does not form z: the argument of tanh, (k_p z_1 + k_v z_2) / M_p, is linear in p~, v~, u_f and u_s, with
//! weights
//!
//! k_p / M_p,  (k_p (1/k_f + 1/k_s) + k_v) / M_p,  (k_p / (k_s k_f) + k_v / k_f) / M_p,  k_v / (k_s M_p),
//!
//! all multiplied by the scale at which [`math::tanh_of_scaled`] takes its argument. u' and u'' are made of the
//! differences u_s - u_f and ubar_p - u_s, which the filters' step needs too:
//!
//! u' = k_f (u_s - u_f) + p_d''',  u'' = k_f k_s (ubar_p - u_s) - k_f^2 (u_s - u_f) + p_d''''.

use crate::error::{ParameterError, Reason, require, require_positive};
use crate::gains::{GainParameters, Gains};
use crate::math;
use crate::reference::Reference;
use crate::state::State;
use nalgebra::Vector3;

/// x_f = (u_f, u_s), the filters' states, m/s^2. Zero after a reset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterState {
    /// u_f: what reaches the vehicle.
    pub filtered: Vector3<f32>,
    /// u_s: the state between the two filters.
    pub intermediate: Vector3<f32>,
}

impl FilterState {
    /// x_f = 0, the only way into flight: the certificate's bounds start from it.
    pub const ZERO: Self = Self { filtered: Vector3::new(0.0, 0.0, 0.0), intermediate: Vector3::new(0.0, 0.0, 0.0) };
}

/// The exact solution of the filters over one period with their input held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterTransition {
    /// Weight of u_s - u_f in u_f's step: k_f (e^(-k_f h) - e^(-k_s h)) / (k_s - k_f).
    towards_intermediate: f32,
    /// Weight of ubar_p - u_f in u_f's step: what is left of 1 - e^(-k_f h).
    towards_input: f32,
    /// Weight of ubar_p - u_s in u_s' step: 1 - e^(-k_s h).
    intermediate_towards_input: f32,
}

impl FilterTransition {
    /// The longest period, s: the slowest tick of the link's simulators.
    pub const PERIOD_MAX_S: f32 = 0.1;

    /// How much of the way a filter may go in one step: all but eight roundings, see [`Self::advance`].
    const WEIGHT_MAX: f64 = 1.0 - 8.0 / 16_777_216.0;

    /// For the bandwidths `k_f` and `k_s`, 1/s, and a period in (0, [`Self::PERIOD_MAX_S`]] s.
    ///
    /// # Errors
    /// Names `control.period` if it is outside.
    pub fn new(k_f: f32, k_s: f32, period: f32) -> Result<Self, ParameterError> {
        require_positive(period, "control.period")?;
        let longest = Self::PERIOD_MAX_S;
        require(period <= longest, "control.period", Reason::Above(longest))?;
        let (k_f, k_s, h) = (f64::from(k_f), f64::from(k_s), f64::from(period));
        let slow = math::exp(-k_f * h);
        // (e^-a - e^-b) / (b - a) = e^-a (1 - e^-(b - a)) / (b - a), whose limit at b = a is e^-a.
        let spread = (k_s - k_f) * h;
        let mixed = if spread.abs() < 1e-9 { slow } else { -slow * math::exp_m1(-spread) / spread };
        let towards_intermediate = (k_f * h * mixed).min(Self::WEIGHT_MAX);
        let both = (-math::exp_m1(-k_f * h)).min(Self::WEIGHT_MAX);
        Ok(Self {
            towards_intermediate: towards_intermediate as f32,
            towards_input: (both - towards_intermediate).max(0.0) as f32,
            intermediate_towards_input: (-math::exp_m1(-k_s * h)).min(Self::WEIGHT_MAX) as f32,
        })
    }

    /// The filters' states one period later, with `feedback` held. Every component stays within the box that holds all
    /// of them now, to the last bit.
    pub fn advance(&self, state: &FilterState, feedback: &Vector3<f32>) -> FilterState {
        let FilterState { filtered: f, intermediate: s } = state;
        let (x_f, x_s) = self.advance_axis(f.x, s.x, feedback.x);
        let (y_f, y_s) = self.advance_axis(f.y, s.y, feedback.y);
        let (z_f, z_s) = self.advance_axis(f.z, s.z, feedback.z);
        FilterState { filtered: Vector3::new(x_f, y_f, z_f), intermediate: Vector3::new(x_s, y_s, z_s) }
    }

    /// One axis' u_f and u_s one period later, with its ubar held.
    pub fn advance_axis(&self, u_f: f32, u_s: f32, ubar: f32) -> (f32, f32) {
        // Steps, not weighted sums: at fast ticks the weights of the old states are so near one that rounding them
        // would move the filters' bandwidth. To the last bit: in a step from x towards values of at most M, three
        // roundings make each product at most its weight times (M - x) (1 + 2^-24)^3, and the weights add up to less
        // than that leaves. So x plus the step is at most M before it is rounded, and hence after.
        (
            u_f + (self.towards_intermediate * (u_s - u_f) + self.towards_input * (ubar - u_f)),
            u_s + self.intermediate_towards_input * (ubar - u_s),
        )
    }
}

/// The position law's constants, with what a tick would otherwise work out again and again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionLaw {
    k_f: f32,
    /// k_f^2, 1/s^2.
    k_f_squared: f32,
    /// k_f k_s, 1/s^2.
    k_f_k_s: f32,
    m_p: f32,
    /// 1 / k_f, s.
    second_lag: f32,
    /// 1 / k_s, s.
    first_lag: f32,
    /// Weights of p~, v~, u_f and u_s in (k_p z_1 + k_v z_2) / M_p, scaled as [`math::tanh_of_scaled`] wants it.
    weights: [f32; 4],
    /// g, m/s^2.
    gravity: f32,
}

/// What the position law commands, with the quantities it went through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionCommand {
    /// p~, m.
    pub position_error: Vector3<f32>,
    /// v~, m/s.
    pub velocity_error: Vector3<f32>,
    /// z_1, m.
    pub z_1: Vector3<f32>,
    /// z_2, m/s.
    pub z_2: Vector3<f32>,
    /// ubar_p, m/s^2, each component within ±M_p.
    pub feedback: Vector3<f32>,
    /// u, m/s^2.
    pub acceleration_command: Vector3<f32>,
}

/// How u moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommandRates {
    /// u', m/s^3.
    pub jerk_command: Vector3<f32>,
    /// u'', m/s^4.
    pub snap_command: Vector3<f32>,
}

impl PositionLaw {
    /// For `gains` under `gravity`, m/s^2.
    pub fn new(gains: &Gains, gravity: f32) -> Self {
        let GainParameters { k_f, k_s, m_p, .. } = **gains;
        let [p, v, f, s, m] = [gains.k_p, gains.k_v, k_f, k_s, m_p].map(f64::from);
        let weights = [p, p * (1.0 / f + 1.0 / s) + v, (p / s + v) / f, v / s]
            .map(|weight| (weight / m * math::TANH_SCALE) as f32);
        let (k_f_squared, k_f_k_s) = ((f * f) as f32, (f * s) as f32);
        Self { k_f, k_f_squared, k_f_k_s, m_p, second_lag: 1.0 / k_f, first_lag: 1.0 / k_s, weights, gravity }
    }

    /// Evaluates the law at one instant; the filters are read, not advanced.
    #[inline(always)]
    pub fn command(&self, state: &State, reference: &Reference, filter: &FilterState) -> PositionCommand {
        let Self { second_lag, first_lag, .. } = *self;
        let [of_position, of_velocity, of_filtered, of_intermediate] = self.weights;
        let FilterState { filtered: u_f, intermediate: u_s } = filter;
        let a = &reference.acceleration;

        let position_error = state.position - reference.position;
        let velocity_error = state.velocity - reference.velocity;
        let scaled =
            position_error * of_position + velocity_error * of_velocity + u_f * of_filtered + u_s * of_intermediate;
        PositionCommand {
            position_error,
            velocity_error,
            z_1: position_error + velocity_error * (second_lag + first_lag) + u_f * (second_lag * first_lag),
            z_2: velocity_error + u_f * second_lag + u_s * first_lag,
            feedback: math::tanh_of_all_scaled(&scaled) * -self.m_p,
            acceleration_command: Vector3::new(u_f.x + a.x, u_f.y + a.y, u_f.z + (a.z + self.gravity)),
        }
    }

    /// u' and u'' while the filters take up `feedback`.
    #[inline(always)]
    pub fn rates(&self, reference: &Reference, filter: &FilterState, feedback: &Vector3<f32>) -> CommandRates {
        let FilterState { filtered: u_f, intermediate: u_s } = filter;
        let towards_intermediate = u_s - u_f;
        let towards_feedback = feedback - u_s;
        CommandRates {
            jerk_command: reference.jerk + towards_intermediate * self.k_f,
            snap_command: reference.snap + towards_feedback * self.k_f_k_s - towards_intermediate * self.k_f_squared,
        }
    }
}

#[cfg(test)]
mod tests;
