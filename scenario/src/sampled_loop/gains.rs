//! The gains of a law near hover, as each axis has them.
//!
//! In [`super::slopes`] they are in SI units, in [`super::law`] in samples: times the powers of the period h that make
//! them dimensionless, torques over the axis' inertia.

/// Gains of the position law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PositionGains {
    /// k_p h^2.
    pub k_p: f64,
    /// k_v h.
    pub k_v: f64,
    /// k_f h.
    pub k_f: f64,
    /// k_s h.
    pub k_s: f64,
    /// k_d h, of the extended law's third filter; it holds x' between ticks, the paper's law, which has none, ubar.
    pub k_d: Option<f64>,
}

impl PositionGains {
    /// What position feedback makes of z_1 and z_2.
    pub fn feedback(&self, [z_1, z_2]: [f64; 2]) -> f64 {
        -(self.k_p * z_1 + self.k_v * z_2)
    }
}

/// Gains of the attitude law about one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TorqueGains {
    /// A = k_theta h^2 / (16 J) under the paper's law.
    pub angle: f64,
    /// B = k_omega h / J.
    pub rate: f64,
}

impl TorqueGains {
    /// What attitude feedback makes of the errors of angle and rate.
    pub fn feedback(&self, [angle, rate]: [f64; 2]) -> f64 {
        -(self.angle * angle + self.rate * rate)
    }
}

/// Gains of the force estimate along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ForceGains {
    /// 1 - e^(-L h).
    pub averaging: f64,
    /// kappa h.
    pub drag: f64,
}

/// The law's estimates along one axis; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct EstimateGains {
    /// The force.
    pub force: Option<ForceGains>,
    /// The torque bias: 1 - e^(-L_tau h).
    pub torque: Option<f64>,
    /// The lag and the delay that the errors are projected over; zero projects nothing.
    pub late: LateGains,
}

/// T: lag, whole and broken part of the delay, in samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct LateGains {
    pub lag: f64,
    pub whole_delay: usize,
    pub broken_delay: f64,
}

impl LateGains {
    /// All of it.
    pub fn time(&self) -> f64 {
        self.lag + self.whole_delay as f64 + self.broken_delay
    }
}
