//! The position law, axis by axis, with a capped approach speed. Section 1 of `docs/extended-law.md`.
//!
//! | here | equation |
//! |---|---|
//! | `z_1` = p~ + (1/k_f + 1/k_s) v~ + u_f / (k_f k_s), `z_2` = v~ + u_f / k_f + u_s / k_s | the paper's (9), each axis with its own filters |
//! | phi(z_1) = s(k_p z_1; k_v v_c) | the approach: its speed is at most v_c |
//! | `feedback` = -s(phi(z_1) + k_v z_2; M) | ubar |
//! | s(x; M) = M x / sqrt(M^2 + \|x\|^2) | radial across; along the vertical a level for either sign |
//! | u_f' = -k_f (u_f - u_s), u_s' = -k_s (u_s - ubar) | the paper's (7) |
//!
//! World frame; accelerations in m/s^2. Along the vertical M is M_z+ upwards and M_z- downwards, v_c the speed of ascent or
//! descent. All theorems on ubar need is that s is monotone, has a slope of at most one and the sign of its argument.

use super::parameters::PositionParameters;
use crate::error::ParameterError;
use crate::math;
use crate::position::{FilterState, FilterTransition};
use crate::reference::Reference;
use crate::state::State;
use nalgebra::{Vector2, Vector3};

/// M x / sqrt(M^2 + |x|^2): shorter than M, along x.
#[must_use]
pub fn radial(x: &Vector2<f32>, level: f32) -> Vector2<f32> {
    x * (level / math::sqrt(level * level + x.x * x.x + x.y * x.y))
}

/// The same of a number, with `positive` the level above zero and `negative` the one below.
#[must_use]
pub fn asymmetric(x: f32, positive: f32, negative: f32) -> f32 {
    let level = if x > 0.0 { positive } else { negative };
    x * (level / math::sqrt(level * level + x * x))
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
    parameters: PositionParameters,
    /// k_f and k_s of each axis, 1/s.
    k_f: Vector3<f32>,
    k_s: Vector3<f32>,
    /// 1 / k_f and 1 / k_s of each axis, s.
    second_lag: Vector3<f32>,
    first_lag: Vector3<f32>,
    across: FilterTransition,
    vertical: FilterTransition,
}

impl PositionLaw {
    /// For steps of `period`, s.
    ///
    /// # Errors
    /// Names `control.period` if it is outside (0, 0.1].
    pub fn new(parameters: &PositionParameters, period: f32) -> Result<Self, ParameterError> {
        let p = parameters;
        let k_f = Vector3::new(p.k_f_across, p.k_f_across, p.k_f_vertical);
        let k_s = Vector3::new(p.k_s_across, p.k_s_across, p.k_s_vertical);
        Ok(Self {
            parameters: *p,
            k_f,
            k_s,
            second_lag: k_f.map(|k| 1.0 / k),
            first_lag: k_s.map(|k| 1.0 / k),
            across: FilterTransition::new(p.k_f_across, p.k_s_across, period)?,
            vertical: FilterTransition::new(p.k_f_vertical, p.k_s_vertical, period)?,
        })
    }

    /// Evaluates the law at one instant; the filters are read, not advanced.
    #[must_use]
    pub fn feedback(&self, state: &State, reference: &Reference, filter: &FilterState) -> PositionFeedback {
        let FilterState { filtered: u_f, intermediate: u_s } = filter;
        let position_error = state.position - reference.position;
        let velocity_error = state.velocity - reference.velocity;
        let ahead = u_f.component_mul(&self.second_lag);
        let z_2 = velocity_error + ahead + u_s.component_mul(&self.first_lag);
        let z_1 = position_error
            + velocity_error.component_mul(&self.second_lag)
            + (velocity_error + ahead).component_mul(&self.first_lag);

        let feedback = -self.saturated(&z_1, &z_2);
        let filtered_rate = (u_s - u_f).component_mul(&self.k_f);
        let intermediate_rate = (feedback - u_s).component_mul(&self.k_s);
        let filtered_acceleration = (intermediate_rate - filtered_rate).component_mul(&self.k_f);
        PositionFeedback { position_error, velocity_error, z_1, z_2, feedback, filtered_rate, filtered_acceleration }
    }

    /// s(phi(z_1) + k_v z_2; M).
    fn saturated(&self, z_1: &Vector3<f32>, z_2: &Vector3<f32>) -> Vector3<f32> {
        let p = &self.parameters;
        let approach = radial(&(z_1.xy() * p.k_p_across), p.k_v_across * p.v_across);
        let across = radial(&(approach + z_2.xy() * p.k_v_across), p.m_across);
        // Above the reference the vehicle descends.
        let approach = asymmetric(z_1.z * p.k_p_vertical, p.k_v_vertical * p.v_down, p.k_v_vertical * p.v_up);
        let vertical = asymmetric(approach + z_2.z * p.k_v_vertical, p.m_down, p.m_up);
        Vector3::new(across.x, across.y, vertical)
    }

    /// The filters' states one period later, with `feedback` held.
    #[must_use]
    pub fn advance(&self, filter: &FilterState, feedback: &Vector3<f32>) -> FilterState {
        let FilterState { filtered: f, intermediate: s } = filter;
        let (x_f, x_s) = self.across.advance_axis(f.x, s.x, feedback.x);
        let (y_f, y_s) = self.across.advance_axis(f.y, s.y, feedback.y);
        let (z_f, z_s) = self.vertical.advance_axis(f.z, s.z, feedback.z);
        FilterState { filtered: Vector3::new(x_f, y_f, z_f), intermediate: Vector3::new(x_s, y_s, z_s) }
    }
}
