//! The law near the origin, one axis at a time, as a linear system in samples.
//!
//! Everything is divided by what turns the actuator's command into the first derivative of the chain, so no inertia,
//! mass or gravity is left; and time is counted in periods h, so a gain per second is multiplied by h. With y_m the
//! m-th integral of the actual command a (see [`super::lag`]):
//!
//! | axis | a | y_1 | y_2 | y_3 | y_4 | u_f, u_s |
//! |---|---|---|---|---|---|---|
//! | attitude about body axis i | tau_i / J_i | body rate | angle | | | |
//! | vertical | thrust / m - g | velocity | position | | | as they are |
//! | lateral | tau_i / J_i | body rate | tilt | velocity / g | position / g | divided by g |
//!
//! Slopes at the origin: s(k x) has slope k, M tanh(x / M) has slope one, the MRP of a small angle is angle / 4 and
//! (1 + |theta|^2) / 4 is 1/4. Hence tau_i / J_i = -A angle~ - B rate~ + omega_d' with A = k_theta / (16 J_i) and
//! B = k_omega / J_i; laterally the desired tilt is u_f, omega_d = u_f' and omega_d' = u_f''.

use super::lag::INTEGRATORS;
use nalgebra::{Matrix2, RowVector2, RowVector4, Vector2};

/// Gains of the position law; here times the powers of the period that make them dimensionless.
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
}

/// Gains of the torque law over the axis' inertia, in samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct TorqueGains {
    /// A = k_theta h^2 / (16 J) under the paper's law.
    pub angle: f64,
    /// B = k_omega h / J.
    pub rate: f64,
}

/// The two filters with the feedback through z_1 and z_2 closed around them: x_f+ = transition x_f + input q, driven by
/// the part q = -(k_p, k_p (1/k_f + 1/k_s) + k_v) (p, v) of ubar that the vehicle's motion makes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Filters {
    /// From x_f = (u_f, u_s) to the next x_f.
    pub transition: Matrix2<f64>,
    /// From ubar to the next x_f.
    pub input: Vector2<f64>,
    /// q per y_m; entry m - 1.
    pub drive: RowVector4<f64>,
    /// The actuator's command per x_f.
    pub output: RowVector2<f64>,
}

/// Command w = `gains` y + filters' output.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law {
    /// Number of integrators behind the actuator; y_m beyond it do not exist.
    pub integrators: usize,
    /// w per y_m; entry m - 1.
    pub gains: RowVector4<f64>,
    /// What the position law remembers; the attitude law remembers nothing.
    pub filters: Option<Filters>,
}

impl Law {
    /// The attitude law about one axis, its reference at rest.
    pub fn attitude(torque: TorqueGains) -> Self {
        Self { integrators: 2, gains: -RowVector4::new(torque.rate, torque.angle, 0.0, 0.0), filters: None }
    }

    /// The position law along the thrust: w = u_f.
    pub fn vertical(position: PositionGains) -> Self {
        let ubar = Feedback::of(position);
        let drive = RowVector4::new(ubar.velocity, ubar.position, 0.0, 0.0);
        let filters = Filters::closed(position, ubar, drive, RowVector2::new(1.0, 0.0));
        Self { integrators: 2, gains: RowVector4::zeros(), filters: Some(filters) }
    }

    /// The position law across the thrust, realised by tilting through the attitude law.
    pub fn lateral(position: PositionGains, torque: TorqueGains) -> Self {
        let PositionGains { k_f, k_s, .. } = position;
        let ubar = Feedback::of(position);
        let drive = RowVector4::new(0.0, 0.0, ubar.velocity, ubar.position);
        // u_f' = k_f (u_s - u_f) and u_f'' = k_f^2 (u_f - u_s) - k_f k_s (u_s - ubar), per (u_f, u_s).
        let rate = RowVector2::new(-k_f, k_f);
        let acceleration = RowVector2::new(k_f * k_f, -k_f * (k_f + k_s)) + ubar.filters * (k_f * k_s);
        let tilt = RowVector2::new(1.0, 0.0);
        let output = tilt * torque.angle + rate * torque.rate + acceleration;
        let gains = drive * (k_f * k_s) - RowVector4::new(torque.rate, torque.angle, 0.0, 0.0);
        Self { integrators: INTEGRATORS, gains, filters: Some(Filters::closed(position, ubar, drive, output)) }
    }
}

/// ubar = -(k_p z_1 + k_v z_2), sorted by what it multiplies.
#[derive(Debug, Clone, Copy)]
struct Feedback {
    position: f64,
    velocity: f64,
    filters: RowVector2<f64>,
}

impl Feedback {
    fn of(PositionGains { k_p, k_v, k_f, k_s }: PositionGains) -> Self {
        Self {
            position: -k_p,
            velocity: -(k_p * (1.0 / k_f + 1.0 / k_s) + k_v),
            filters: -RowVector2::new(k_p / (k_f * k_s) + k_v / k_f, k_v / k_s),
        }
    }
}

impl Filters {
    fn closed(gains: PositionGains, ubar: Feedback, drive: RowVector4<f64>, output: RowVector2<f64>) -> Self {
        let PositionGains { k_f, k_s, .. } = gains;
        let (keep_filtered, keep_intermediate) = ((-k_f).exp(), (-k_s).exp());
        // k_f (e^-k_f - e^-k_s) / (k_s - k_f), from the slower exponential so that nothing overflows.
        let spread = (k_s - k_f).abs();
        let mean = if spread > 0.0 { -(-spread).exp_m1() / spread } else { 1.0 };
        let mixed = k_f * (-k_f.min(k_s)).exp() * mean;
        let open = Matrix2::new(keep_filtered, mixed, 0.0, keep_intermediate);
        let input = Vector2::new(1.0 - keep_filtered - mixed, 1.0 - keep_intermediate);
        Self { transition: open + input * ubar.filters, input, drive, output }
    }
}
