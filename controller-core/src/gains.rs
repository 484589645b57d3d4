//! The gains of the paper's Table I, validated.

use crate::error::{ParameterError, Reason, require, require_positive};
use crate::vehicle::Vehicle;
use core::ops::Deref;

/// The law's gains under the paper's symbols; see [`Gains`] for the validated form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GainParameters {
    /// Position gain, 1/s^2.
    pub k_p: f32,
    /// Velocity gain, 1/s.
    pub k_v: f32,
    /// Bandwidth of the second filter (u_f), 1/s.
    pub k_f: f32,
    /// Bandwidth of the first filter (u_s), 1/s.
    pub k_s: f32,
    /// Attitude gain k_vartheta, N m.
    pub k_theta: f32,
    /// Body-rate gain, N m s.
    pub k_omega: f32,
    /// Saturation level of the position feedback per axis, m/s^2.
    pub m_p: f32,
    /// Saturation level of the attitude feedback M_vartheta, N m.
    pub m_theta: f32,
    /// Saturation level of the body-rate feedback, N m.
    pub m_omega: f32,
    /// Hysteresis of the switch between a modified Rodrigues vector and its shadow: it happens at |theta| = 1 + delta.
    pub delta: f32,
    /// Distance at which the path-lifting memory follows the attitude error, in (0, 1).
    pub alpha: f32,
}

impl GainParameters {
    /// Each gain beside its path in a scenario file, in the order of Table I.
    #[must_use]
    pub const fn named(&self) -> [(&'static str, f32); 11] {
        [
            ("gains.k_p", self.k_p),
            ("gains.k_v", self.k_v),
            ("gains.k_f", self.k_f),
            ("gains.k_s", self.k_s),
            ("gains.k_theta", self.k_theta),
            ("gains.k_omega", self.k_omega),
            ("gains.m_p", self.m_p),
            ("gains.m_theta", self.m_theta),
            ("gains.m_omega", self.m_omega),
            ("gains.delta", self.delta),
            ("gains.alpha", self.alpha),
        ]
    }

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
    /// The greatest value of any gain: beyond it, products with the largest accepted states overflow single precision.
    pub const GREATEST: f32 = 1e3;

    /// The least value of any gain, for the same reason: the law divides by k_f, k_s and M_p.
    pub const LEAST: f32 = 1e-7;

    /// Checks that every gain is between [`Self::LEAST`] and [`Self::GREATEST`], M_p < g and alpha < 1.
    ///
    /// # Errors
    /// Names the first gain that is not.
    pub fn new(parameters: GainParameters, vehicle: &Vehicle) -> Result<Self, ParameterError> {
        let p = &parameters;
        for (field, value) in p.named() {
            require_positive(value, field)?;
            require(value > Self::LEAST, field, Reason::NotAbove(Self::LEAST))?;
            require(value < Self::GREATEST, field, Reason::NotBelow(Self::GREATEST))?;
        }
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
