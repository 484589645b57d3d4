//! The position law, axis by axis, with a capped approach speed. Section 1 of `docs/extended-law.md`.
//!
//! | here | equation |
//! |---|---|
//! | `z_1` = p~ + (1/k_f + 1/k_s) v~ + u_f / (k_f k_s), `z_2` = v~ + u_f / k_f + u_s / k_s | the paper's (9), each axis with its own filters |
//! | phi(z_1) = s(k_p z_1; k_v v_c) = k_v s(k_p z_1 / k_v; v_c) | the approach: its speed is at most v_c |
//! | `feedback` = -s(phi(z_1) + k_v z_2; M) | ubar |
//! | s(x; M) = M x / sqrt(M^2 + \|x\|^2) | [`Saturation`]: radial across; along the vertical a level for either sign |
//! | u_f' = -k_f (u_f - u_s), u_s' = -k_s (u_s - ubar) | the paper's (7) |
//! | u_f'' = k_f k_s (ubar - u_s) - k_f^2 (u_s - u_f) | from the line above |
//!
//! World frame; accelerations in m/s^2. Along the vertical M is M_z+ upwards and M_z- downwards, v_c the speed of ascent or
//! descent. All theorems on ubar need is that s is monotone, has a slope of at most one and the sign of its argument.

use super::parameters::PositionParameters;
use super::saturation::Saturation;
use crate::error::ParameterError;
use crate::position::{FilterState, FilterTransition};
use crate::reference::Reference;
use crate::state::State;
use nalgebra::Vector3;

/// The feedback's saturations in one direction: of the approach, s(k_p z_1; k_v v_c) / k_v, and of the whole, s(k_v .; M).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Levels {
    approach: Saturation,
    whole: Saturation,
}

impl Levels {
    fn new(k_p: f32, k_v: f32, approach_speed: f32, level: f32) -> Self {
        Self { approach: Saturation::new(k_p / k_v, approach_speed), whole: Saturation::new(k_v, level) }
    }
}

/// The filters of one axis and what the law makes of them.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Filters {
    /// 1 / k_f, 1 / k_s and their sum, s; their product, s^2.
    second_lag: f32,
    first_lag: f32,
    both_lags: f32,
    lags_product: f32,
    /// k_f, 1/s.
    k_f: f32,
    /// k_f^2 and k_f k_s, 1/s^2.
    k_f_squared: f32,
    k_f_k_s: f32,
    transition: FilterTransition,
}

impl Filters {
    fn new(k_f: f32, k_s: f32, period: f32) -> Result<Self, ParameterError> {
        let (second_lag, first_lag) = (1.0 / k_f, 1.0 / k_s);
        Ok(Self {
            second_lag,
            first_lag,
            both_lags: second_lag + first_lag,
            lags_product: second_lag * first_lag,
            k_f,
            k_f_squared: k_f * k_f,
            k_f_k_s: k_f * k_s,
            transition: FilterTransition::new(k_f, k_s, period)?,
        })
    }

    /// z_1 and z_2.
    fn coordinates(&self, position_error: f32, velocity_error: f32, u_f: f32, u_s: f32) -> (f32, f32) {
        (
            position_error + self.both_lags * velocity_error + self.lags_product * u_f,
            velocity_error + self.second_lag * u_f + self.first_lag * u_s,
        )
    }

    /// u_f' and u_f''.
    fn rates(&self, u_f: f32, u_s: f32, feedback: f32) -> (f32, f32) {
        let (towards_intermediate, towards_feedback) = (u_s - u_f, feedback - u_s);
        (self.k_f * towards_intermediate, self.k_f_k_s * towards_feedback - self.k_f_squared * towards_intermediate)
    }
}

/// What the position law commands, with the quantities it went through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionFeedback {
    /// p~, m.
    pub position_error: Vector3<f32>,
    /// v~, m/s.
    pub velocity_error: Vector3<f32>,
    /// z_1, m.
    pub z_1: Vector3<f32>,
    /// z_2, m/s.
    pub z_2: Vector3<f32>,
    /// ubar, m/s^2.
    pub feedback: Vector3<f32>,
    /// u_f', m/s^3.
    pub filtered_rate: Vector3<f32>,
    /// u_f'', m/s^4.
    pub filtered_acceleration: Vector3<f32>,
}

/// The position law's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionLaw {
    across: Filters,
    vertical: Filters,
    levels_across: Levels,
    levels_up: Levels,
    levels_down: Levels,
}

impl PositionLaw {
    /// For steps of `period`, s.
    ///
    /// # Errors
    /// Names `control.period` if it is outside (0, 0.1].
    pub fn new(parameters: &PositionParameters, period: f32) -> Result<Self, ParameterError> {
        let p = parameters;
        Ok(Self {
            across: Filters::new(p.k_f_across, p.k_s_across, period)?,
            vertical: Filters::new(p.k_f_vertical, p.k_s_vertical, period)?,
            levels_across: Levels::new(p.k_p_across, p.k_v_across, p.v_across, p.m_across),
            levels_up: Levels::new(p.k_p_vertical, p.k_v_vertical, p.v_up, p.m_up),
            levels_down: Levels::new(p.k_p_vertical, p.k_v_vertical, p.v_down, p.m_down),
        })
    }

    /// Evaluates the law at one instant; the filters are read, not advanced.
    #[must_use]
    pub fn feedback(&self, state: &State, reference: &Reference, filter: &FilterState) -> PositionFeedback {
        let FilterState { filtered: u_f, intermediate: u_s } = filter;
        let p = state.position - reference.position;
        let v = state.velocity - reference.velocity;
        let (z_1x, z_2x) = self.across.coordinates(p.x, v.x, u_f.x, u_s.x);
        let (z_1y, z_2y) = self.across.coordinates(p.y, v.y, u_f.y, u_s.y);
        let (z_1z, z_2z) = self.vertical.coordinates(p.z, v.z, u_f.z, u_s.z);
        let (z_1, z_2) = (Vector3::new(z_1x, z_1y, z_1z), Vector3::new(z_2x, z_2y, z_2z));

        let feedback = self.saturated(&z_1, &z_2);
        let (x_rate, x_acceleration) = self.across.rates(u_f.x, u_s.x, feedback.x);
        let (y_rate, y_acceleration) = self.across.rates(u_f.y, u_s.y, feedback.y);
        let (z_rate, z_acceleration) = self.vertical.rates(u_f.z, u_s.z, feedback.z);
        PositionFeedback {
            position_error: p,
            velocity_error: v,
            z_1,
            z_2,
            feedback,
            filtered_rate: Vector3::new(x_rate, y_rate, z_rate),
            filtered_acceleration: Vector3::new(x_acceleration, y_acceleration, z_acceleration),
        }
    }

    /// -s(phi(z_1) + k_v z_2; M), with phi(z_1) = k_v times a velocity of approach.
    fn saturated(&self, z_1: &Vector3<f32>, z_2: &Vector3<f32>) -> Vector3<f32> {
        let Levels { approach, whole } = &self.levels_across;
        let across = z_2.xy() + z_1.xy() * approach.factor(z_1.xy().norm_squared());
        let across = across * -whole.factor(across.norm_squared());
        // Above the reference the vehicle descends.
        let side = |positive: bool| if positive { &self.levels_down } else { &self.levels_up };
        let vertical = z_2.z + z_1.z * side(z_1.z > 0.0).approach.factor(z_1.z * z_1.z);
        let vertical = vertical * -side(vertical > 0.0).whole.factor(vertical * vertical);
        Vector3::new(across.x, across.y, vertical)
    }

    /// The filters' states one period later, with `feedback` held.
    #[must_use]
    pub fn advance(&self, filter: &FilterState, feedback: &Vector3<f32>) -> FilterState {
        let FilterState { filtered: f, intermediate: s } = filter;
        let (x_f, x_s) = self.across.transition.advance_axis(f.x, s.x, feedback.x);
        let (y_f, y_s) = self.across.transition.advance_axis(f.y, s.y, feedback.y);
        let (z_f, z_s) = self.vertical.transition.advance_axis(f.z, s.z, feedback.z);
        FilterState { filtered: Vector3::new(x_f, y_f, z_f), intermediate: Vector3::new(x_s, y_s, z_s) }
    }
}
