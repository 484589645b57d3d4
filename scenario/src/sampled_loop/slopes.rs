//! The slopes of a law at hover, SI units, and the same in samples.

use super::gains::{EstimateGains, ForceGains, LateGains, PositionGains, TorqueGains};
use super::lag::Arrival;
use controller_core::configuration::{ExtendedLaw, LawParameters};
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::gains::Gains;

/// A law near hover.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slopes {
    /// Angular acceleration per angle about each body axis, 1/s^2.
    stiffness: [f64; 3],
    /// Angular acceleration per body rate, 1/s.
    damping: [f64; 3],
    /// Gains across.
    across: PositionGains,
    /// Gains along the vertical.
    vertical: PositionGains,
    /// The extended law's estimates.
    estimates: Option<Estimates>,
}

/// The extended law's estimates, and its model of its actuators.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Estimates {
    parameters: ExtendedParameters,
    /// The actuator's lag and delay, s.
    lag: f64,
    delay: f64,
}

impl Slopes {
    /// Of `law` on a body with these moments of inertia, kg m^2.
    pub fn from_law(law: &LawParameters, inertia: [f64; 3]) -> Self {
        match law {
            LawParameters::Paper(law) => Self::paper(&law.gains, inertia),
            LawParameters::Extended(law) => Self::extended(law, inertia),
        }
    }

    /// Of the paper's law: the MRP of a small angle is angle / 4, and (1 + |theta|^2) / 4 is 1/4.
    fn paper(gains: &Gains, inertia: [f64; 3]) -> Self {
        let [k_p, k_v, k_f, k_s] = [gains.k_p, gains.k_v, gains.k_f, gains.k_s].map(f64::from);
        let position = PositionGains { k_p, k_v, k_f, k_s, k_d: None };
        Self {
            stiffness: inertia.map(|moment| f64::from(gains.k_theta) / (16.0 * moment)),
            damping: inertia.map(|moment| f64::from(gains.k_omega) / moment),
            across: position,
            vertical: position,
            estimates: None,
        }
    }

    /// Of the extended law: sections 1, 2, 5, 6, 7 and 10 of `docs/extended-law.md`.
    fn extended(ExtendedLaw { parameters, actuators }: &ExtendedLaw, [x, y, _]: [f64; 3]) -> Self {
        let p = parameters;
        let [tilt, damping, c_1, c_2] = [p.k_tilt / 4.0, p.k_omega_t, p.c_1, p.c_2].map(f64::from);
        let gains = |k_p: f32, k_v: f32| PositionGains {
            k_p: k_p.into(),
            k_v: k_v.into(),
            k_f: p.k_f.into(),
            k_s: p.k_s.into(),
            k_d: Some(p.k_d.into()),
        };
        let [lag, delay] = [actuators.lag, actuators.delay].map(f64::from);
        Self {
            stiffness: [tilt / x, tilt / y, c_1],
            damping: [damping / x, damping / y, c_2],
            across: gains(p.k_p_across, p.k_v_across),
            vertical: gains(p.k_p_vertical, p.k_v_vertical),
            estimates: Some(Estimates { parameters: **parameters, lag, delay }),
        }
    }

    /// With k_p and k_v multiplied by these factors.
    pub fn with_position_feedback(self, [k_p, k_v]: [f64; 2]) -> Self {
        let scaled = |gains: PositionGains| PositionGains { k_p: gains.k_p * k_p, k_v: gains.k_v * k_v, ..gains };
        Self { across: scaled(self.across), vertical: scaled(self.vertical), ..self }
    }

    /// The attitude law about `axis`, at ticks `period` seconds apart.
    pub fn torque(&self, axis: usize, period: f64) -> TorqueGains {
        TorqueGains { angle: self.stiffness[axis] * period * period, rate: self.damping[axis] * period }
    }

    /// The position law across.
    pub fn across(&self, period: f64) -> PositionGains {
        in_samples(&self.across, period)
    }

    /// The position law along the vertical.
    pub fn vertical(&self, period: f64) -> PositionGains {
        in_samples(&self.vertical, period)
    }

    /// The estimates across, with the torque about the tilt's axes.
    pub fn estimated_across(&self, period: f64) -> EstimateGains {
        self.estimates.map_or_else(EstimateGains::default, |estimates| {
            let p = &estimates.parameters;
            EstimateGains {
                force: force(p.force_across, p.force_bandwidth_across, p.drag_across, period),
                torque: torque(p.torque_tilt, p.torque_bandwidth, period),
                late: estimates.late(period),
            }
        })
    }

    /// What is estimated along and about the vertical, the torque there with half of the bandwidth. The thrust scale is
    /// learnt from what varies alone: near hover it stands still.
    pub fn estimated_vertical(&self, period: f64) -> EstimateGains {
        self.estimates.map_or_else(EstimateGains::default, |estimates| {
            let p = &estimates.parameters;
            EstimateGains {
                force: force(p.force_up.min(p.force_down), p.force_bandwidth_vertical, 0.0, period),
                torque: torque(p.torque_yaw, 0.5 * p.torque_bandwidth, period),
                late: estimates.late(period),
            }
        })
    }

    /// The law's model of its actuators.
    pub fn actuator(&self, period: f64) -> Arrival {
        let Some(estimates) = self.estimates else {
            return Arrival::new(0.0, 0.0);
        };
        let LateGains { lag, whole_delay, broken_delay } = estimates.late(period);
        Arrival::new(lag, whole_delay as f64 + broken_delay)
    }
}

impl Estimates {
    /// Lag and delay in samples.
    fn late(&self, period: f64) -> LateGains {
        let samples = self.delay / period;
        // As the law does: a delay of whole samples that rounding put just below is one.
        let whole = (samples + 1e-6).floor();
        LateGains { lag: self.lag / period, whole_delay: whole as usize, broken_delay: (samples - whole).max(0.0) }
    }
}

/// With the period for the unit of time.
fn in_samples(gains: &PositionGains, period: f64) -> PositionGains {
    let PositionGains { k_p, k_v, k_f, k_s, k_d } = *gains;
    PositionGains {
        k_p: k_p * period * period,
        k_v: k_v * period,
        k_f: k_f * period,
        k_s: k_s * period,
        k_d: k_d.map(|k_d| k_d * period),
    }
}

/// The force estimate along an axis of this level, bandwidth and known drag; none where the level is zero.
fn force(level: f32, bandwidth: f32, drag: f32, period: f64) -> Option<ForceGains> {
    let [averaging, drag] = [bandwidth, drag].map(|rate| f64::from(rate) * period);
    (level > 0.0).then(|| ForceGains { averaging: -(-averaging).exp_m1(), drag })
}

/// The torque bias of this level and rate; none where the level is zero.
fn torque(level: f32, smoothing: f32, period: f64) -> Option<f64> {
    (level > 0.0).then(|| -(-f64::from(smoothing) * period).exp_m1())
}
