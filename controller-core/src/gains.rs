//! The gains of the paper's Table I, validated.

use crate::constants::{Range, constants};
use crate::error::{ParameterError, Reason, require};
use crate::vehicle::Vehicle;
use core::ops::Deref;

constants! {
    /// The law's gains under the paper's symbols; see [`Gains`] for the validated form.
    pub struct GainParameters {
        /// Position gain, 1/s^2.
        gains.k_p: Range::POSITIVE, SEARCHED;
        /// Velocity gain, 1/s.
        gains.k_v: Range::POSITIVE, SEARCHED;
        /// Bandwidth of the second filter (u_f), 1/s.
        gains.k_f: Range::POSITIVE, SEARCHED;
        /// Bandwidth of the first filter (u_s), 1/s.
        gains.k_s: Range::POSITIVE, SEARCHED;
        /// Attitude gain k_vartheta, N m.
        gains.k_theta: Range::POSITIVE, SEARCHED;
        /// Body-rate gain, N m s.
        gains.k_omega: Range::POSITIVE, SEARCHED;
        /// Saturation level of the position feedback per axis, m/s^2.
        gains.m_p: Range::POSITIVE, SEARCHED;
        /// Saturation level of the attitude feedback M_vartheta, N m.
        gains.m_theta: Range::POSITIVE, SEARCHED;
        /// Saturation level of the body-rate feedback, N m.
        gains.m_omega: Range::POSITIVE, SEARCHED;
        /// Hysteresis of the switch to the shadow of a modified Rodrigues vector: it happens at |theta| = 1 + delta.
        gains.delta: Range::POSITIVE, FIXED;
        /// Distance at which the path-lifting memory follows the attitude error, in (0, 1).
        gains.alpha: Range::POSITIVE, FIXED;
    }
}

impl GainParameters {
    /// The paper's Table I.
    pub const TABLE_1: Self = Self {
        k_p: 9.0,
        k_v: 6.0,
        k_f: 2.0,
        k_s: 20.0,
        k_theta: 100.0,
        k_omega: 0.1,
        m_p: 2.0,
        m_theta: 0.206,
        m_omega: 0.045,
        delta: 0.02,
        alpha: 0.25,
    };
}

/// Gains for which the law is defined. Reads like its [`GainParameters`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains(GainParameters);

impl Gains {
    /// Checks that every gain is in its range, M_p < g and alpha < 1. The law divides by k_f, k_s and M_p; products of
    /// greater gains with the largest accepted states would overflow single precision.
    ///
    /// # Errors
    /// Names the first gain that is not.
    pub fn new(parameters: GainParameters, vehicle: &Vehicle) -> Result<Self, ParameterError> {
        let p = &parameters;
        p.check()?;
        require(p.m_p < vehicle.gravity, "gains.m_p", Reason::NotBelow(vehicle.gravity))?;
        require(p.alpha < 1.0, "gains.alpha", Reason::NotBelow(1.0))?;
        Ok(Self(parameters))
    }
}

impl Deref for Gains {
    type Target = GainParameters;

    fn deref(&self) -> &GainParameters {
        &self.0
    }
}

#[cfg(test)]
mod tests;
