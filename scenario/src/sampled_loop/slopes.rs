//! The slopes of a law at hover, SI units, and the same in samples.

use super::gains::{EstimateGains, ForceGains, PositionGains, TorqueGains};
use super::lag::Arrival;
use controller_core::certificate::configuration::{ExtendedLaw, LawParameters};
use controller_core::extended::parameters::{AttitudeParameters, EstimateParameters};
use controller_core::extended::thrust_scale::LEAST_THRUST;
use controller_core::gains::Gains;
use controller_core::vehicle::Vehicle;

/// A law near hover.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slopes {
    /// Torque per angle about each body axis, N m/rad.
    stiffness: [f64; 3],
    /// Torque per body rate, N m s.
    damping: [f64; 3],
    /// Gains across.
    across: PositionGains,
    /// Gains along the vertical.
    vertical: PositionGains,
    /// The extended law's estimates.
    estimates: Option<Estimates>,
}

/// What the extended law estimates, and by which model of its actuators.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Estimates {
    parameters: EstimateParameters,
    /// g, m/s^2.
    gravity: f64,
    /// The actuator's lag and delay, s.
    lag: f64,
    delay: f64,
}

impl Slopes {
    /// Of `law` on `vehicle`.
    pub fn of(law: &LawParameters, vehicle: &Vehicle) -> Self {
        match law {
            LawParameters::Paper(law) => Self::paper(&law.gains),
            LawParameters::Extended(law) => Self::extended(law, f64::from(vehicle.gravity)),
        }
    }

    /// Of the paper's law: the MRP of a small angle is angle / 4, and (1 + |theta|^2) / 4 is 1/4.
    fn paper(gains: &Gains) -> Self {
        let [k_p, k_v, k_f, k_s] = [gains.k_p, gains.k_v, gains.k_f, gains.k_s].map(f64::from);
        let position = PositionGains { k_p, k_v, k_f, k_s };
        Self {
            stiffness: [f64::from(gains.k_theta) / 16.0; 3],
            damping: [f64::from(gains.k_omega); 3],
            across: position,
            vertical: position,
            estimates: None,
        }
    }

    /// Of the extended law: sections 1, 2, 4, 5 and 7 of `docs/extended-law.md`.
    fn extended(ExtendedLaw { parameters, actuators }: &ExtendedLaw, gravity: f64) -> Self {
        let p = &parameters.position;
        let AttitudeParameters { w, eta, k_t, eta_t, k_omega_t, k_omega_z, .. } = parameters.attitude;
        let [w, eta, k_t, eta_t] = [w, eta, k_t, eta_t].map(f64::from);
        let tilt = w / 4.0 + k_t / (2.0 * eta_t.hypot(1.0));
        let yaw = w * eta / (4.0 * (1.0 + eta));
        let gains = |[k_p, k_v, k_f, k_s]: [f32; 4]| PositionGains {
            k_p: k_p.into(),
            k_v: k_v.into(),
            k_f: k_f.into(),
            k_s: k_s.into(),
        };
        let [lag, delay] = [actuators.lag, actuators.delay].map(f64::from);
        Self {
            stiffness: [tilt, tilt, yaw],
            damping: [k_omega_t, k_omega_t, k_omega_z].map(f64::from),
            across: gains([p.k_p_across, p.k_v_across, p.k_f_across, p.k_s_across]),
            vertical: gains([p.k_p_vertical, p.k_v_vertical, p.k_f_vertical, p.k_s_vertical]),
            estimates: Some(Estimates { parameters: parameters.estimates, gravity, lag, delay }),
        }
    }

    /// With k_p and k_v multiplied by `factor`.
    pub fn with_position_feedback(self, factor: f64) -> Self {
        let scaled = |gains: PositionGains| PositionGains { k_p: gains.k_p * factor, k_v: gains.k_v * factor, ..gains };
        Self { across: scaled(self.across), vertical: scaled(self.vertical), ..self }
    }

    /// The attitude law about `axis` of a body with this moment of `inertia`, kg m^2, at ticks `period` seconds apart.
    pub fn torque(&self, axis: usize, inertia: f64, period: f64) -> TorqueGains {
        TorqueGains {
            angle: self.stiffness[axis] * period * period / inertia,
            rate: self.damping[axis] * period / inertia,
        }
    }

    /// The position law across.
    pub fn across(&self, period: f64) -> PositionGains {
        in_samples(&self.across, period)
    }

    /// The position law along the vertical.
    pub fn vertical(&self, period: f64) -> PositionGains {
        in_samples(&self.vertical, period)
    }

    /// What is estimated across, with the torque about the tilt's axes.
    pub fn estimated_across(&self, period: f64) -> EstimateGains {
        self.estimates.map_or_else(EstimateGains::default, |Estimates { parameters: e, .. }| EstimateGains {
            force: force(
                [e.force_across, e.force_snap_across],
                [e.force_smoothing_across, e.force_bandwidth_across, e.drag_across],
                period,
            ),
            scale: None,
            torque: torque(e.torque_tilt, e.torque_smoothing, period),
        })
    }

    /// What is estimated along and about the vertical.
    pub fn estimated_vertical(&self, period: f64) -> EstimateGains {
        self.estimates.map_or_else(EstimateGains::default, |Estimates { parameters: e, gravity, .. }| {
            let weight = gravity * gravity / (gravity * gravity + f64::from(LEAST_THRUST).powi(2));
            let learns = e.scale_rate > 0.0 && e.scale_least < e.scale_greatest;
            EstimateGains {
                force: force(
                    [e.force_vertical, e.force_snap_vertical],
                    [e.force_smoothing_vertical, e.force_bandwidth_vertical, 0.0],
                    period,
                ),
                scale: learns.then(|| f64::from(e.scale_rate) * period * weight),
                torque: torque(e.torque_yaw, e.torque_smoothing, period),
            }
        })
    }

    /// The law's model of its actuators.
    pub fn actuator(&self, period: f64) -> Arrival {
        let Some(Estimates { lag, delay, .. }) = self.estimates else {
            return Arrival::new(0.0, 0.0);
        };
        let samples = delay / period;
        // As the law does: a delay of whole samples that rounding put just below is one.
        let whole = (samples + 1e-6).floor();
        Arrival::new(lag / period, whole + (samples - whole).max(0.0))
    }
}

/// With the period for the unit of time.
fn in_samples(gains: &PositionGains, period: f64) -> PositionGains {
    let PositionGains { k_p, k_v, k_f, k_s } = *gains;
    PositionGains { k_p: k_p * period * period, k_v: k_v * period, k_f: k_f * period, k_s: k_s * period }
}

/// The force estimate along an axis with these limits (D, S) and rates (L, k_d, kappa); none where a limit is zero.
fn force(limits: [f32; 2], rates: [f32; 3], period: f64) -> Option<ForceGains> {
    let [averaging, bandwidth, drag] = rates.map(|rate| f64::from(rate) * period);
    let on = limits.iter().all(|limit| *limit > 0.0);
    on.then(|| ForceGains { averaging: -(-averaging).exp_m1(), bandwidth, drag })
}

/// The torque bias of this level and rate; none where the level is zero.
fn torque(level: f32, smoothing: f32, period: f64) -> Option<f64> {
    (level > 0.0).then(|| -(-f64::from(smoothing) * period).exp_m1())
}
