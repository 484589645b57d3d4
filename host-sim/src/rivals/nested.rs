//! The design that the paper argues against: an outer loop of nested saturations around the same saturated hybrid
//! attitude law.
//!
//! L. Martins, C. Cardeira, P. Oliveira: *Global trajectory tracking for quadrotors: An MRP-based hybrid strategy with
//! input saturation*, Automatica 162, 2024, after A. R. Teel: *Global stabilization and restricted tracking for
//! multiple integrators with bounded controls*, Systems & Control Letters 18, 1992. The article's own formula was not
//! at hand: what is here is the structure that its abstract and the paper's Section I describe, in the paper's
//! saturation.
//!
//! ```text
//! u = -s_v(k_v v~ + s_p(k_p p~ + s_i(k_i xi))) + g e3 + p_d'',  xi' = p~,  T = m |u|
//! s(x) = M tanh(x / M), each axis for itself;  M_v outermost, M_p < M_v / 2, M_i < M_p / 2
//! ```
//!
//! omega_d and omega_d' need u' and u'', and these v~' and v~'': the model's under the thrust commanded. R_d keeps the
//! nose to the heading's projection. The attitude law is the paper's, with its path lifting, from the core. xi is held
//! while a command is cut, and its level is part of the law: it winds up no further than `INTEGRAL_SPAN` times it. The
//! article's integral in the attitude loop is left out.
//!
//! Home: limits on thrust and torque that must be promised; any attitude.

use super::frame::{Frame, HeadingRule};
use super::jet::Jet;
use super::rival::{Commanded, Rival, RivalModel, RivalReference, RivalState};
use super::start::Pace;
use controller_core::attitude::AttitudeLaw;
use controller_core::gains::{GainParameters, Gains};
use controller_core::path_lifting::{Lift, lift, switching_scalar};
use controller_core::vehicle::Vehicle;
use nalgebra::{Quaternion, Vector3};

/// The gains' names.
pub const NAMES: [&str; 10] =
    ["k_v", "k_p", "k_i", "m_v", "m_p_share", "m_i_share", "k_theta", "m_theta", "k_omega", "m_omega"];
/// Where a search starts, on a vehicle like the Hummingbird with rotors that lag. Table I's attitude gains bear no lag.
pub const START_GAINS: [f64; 10] = [3.0, 2.5, 0.3, 4.0, 0.49, 0.3, 4.0, 0.3, 0.06, 0.4];
/// The speed that each of them scales with.
pub const GAIN_PACES: [Pace; 10] = [
    Pace::Position(1),
    Pace::Position(2),
    Pace::Position(3),
    Pace::Kept,
    Pace::Kept,
    Pace::Kept,
    Pace::Torque(2),
    Pace::Torque(2),
    Pace::Torque(1),
    Pace::Torque(1),
];

/// The paper's hysteresis and memory.
const PAPER_DELTA: f32 = 0.02;
const PAPER_ALPHA: f32 = 0.25;
/// The integral's greatest value, in multiples of what saturates it.
const INTEGRAL_SPAN: f64 = 2.0;

/// The outer loop by itself, for bounds as well as for flights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outer {
    /// 1/s.
    pub k_v: f64,
    /// 1/s^2, in s_v's argument.
    pub k_p: f64,
    /// 1/s^3, in s_p's argument.
    pub k_i: f64,
    /// Levels M_v, M_p, M_i, m/s^2.
    pub levels: [f64; 3],
}

impl Outer {
    /// Levels below half of the next outer one.
    #[must_use]
    pub fn new(k_v: f64, k_p: f64, k_i: f64, m_v: f64, p_share: f64, i_share: f64) -> Self {
        let m_p = m_v * p_share.min(0.499);
        Self { k_v, k_p, k_i, levels: [m_v, m_p, m_p * i_share.min(0.499)] }
    }

    /// The feedback, m/s^2, with its derivatives, for p~, v~ and the integral with theirs.
    #[must_use]
    pub fn feedback(&self, position: &Jet, velocity: &Jet, integral: &Jet) -> Jet {
        let [m_v, m_p, m_i] = self.levels;
        let by = |factor: f64| Vector3::repeat(factor);
        let inner = integral.scaled(&by(self.k_i)).saturated(m_i);
        let middle = position.scaled(&by(self.k_p)).plus(&inner).saturated(m_p);
        velocity.scaled(&by(self.k_v)).plus(&middle).saturated(m_v).scaled(&by(-1.0))
    }
}

/// The law and what it remembers.
#[derive(Debug, Clone)]
pub struct Nested {
    model: RivalModel,
    outer: Outer,
    attitude: AttitudeLaw,
    integral: Vector3<f64>,
    lift: Option<Lift>,
    cut: bool,
}

impl Nested {
    /// With gains as in [`NAMES`], for the `vehicle` of `model`; none if the attitude law is undefined for them.
    #[must_use]
    pub fn new(model: RivalModel, vehicle: &Vehicle, gains: [f64; 10]) -> Option<Self> {
        let [k_v, k_p, k_i, m_v, p_share, i_share, k_theta, m_theta, k_omega, m_omega] = gains;
        // Thrust must never vanish: u_z stays above zero for a reference that falls with up to a tenth of g.
        let m_v = m_v.min(0.9 * model.gravity);
        let [k_theta, m_theta, k_omega, m_omega] = [k_theta, m_theta, k_omega, m_omega].map(|gain| gain as f32);
        let table = GainParameters { k_theta, m_theta, k_omega, m_omega, ..GainParameters::TABLE_1 };
        let gains = Gains::new(table, vehicle).ok()?;
        Some(Self {
            outer: Outer::new(k_v, k_p, k_i, m_v, p_share, i_share),
            attitude: AttitudeLaw::new(&gains, &vehicle.inertia),
            integral: Vector3::zeros(),
            lift: None,
            cut: false,
            model,
        })
    }

    /// u and its derivatives: twice, since v~' is that of the thrust which u itself asks for.
    fn force(&self, state: &RivalState, target: &RivalReference) -> Jet {
        let gravity = Vector3::z() * self.model.gravity;
        let [acceleration, jerk, _] = target.acceleration.0;
        let needed = target.acceleration.plus(&Jet::constant(gravity));
        let (p, v) = (state.position - target.position, state.velocity - target.velocity);
        let axis = state.attitude * Vector3::z();
        let axis_rate = state.attitude * state.rate.cross(&Vector3::z());
        let command = |a: Vector3<f64>, j: Vector3<f64>| {
            let integral = Jet([self.integral, p, v]);
            self.outer.feedback(&Jet([p, v, a]), &Jet([v, a, j]), &integral).plus(&needed)
        };
        let first = command(Vector3::zeros(), Vector3::zeros()).0[0];
        let a = axis * first.norm() - gravity - acceleration;
        let [u, u_rate, _] = command(a, Vector3::zeros()).0;
        let thrust_rate = u.dot(&u_rate) / u.norm();
        let j = axis * thrust_rate + axis_rate * u.norm() - jerk;
        command(a, j)
    }
}

impl Rival for Nested {
    fn step(&mut self, state: &RivalState, target: &RivalReference) -> Commanded {
        let force = self.force(state, target);
        let frame = Frame::new(&force, &target.heading, HeadingRule::Projected);
        let single = |v: &Vector3<f64>| v.map(|x| x as f32);
        let error = frame.attitude.inverse() * state.attitude;
        let error = Quaternion::from(error.coords.map(|x| x as f32));
        let lifted = lift(self.lift.as_ref(), &error, switching_scalar(PAPER_DELTA), PAPER_ALPHA);
        self.lift = Some(lifted.lift);
        let torque = self
            .attitude
            .command(&error, lifted.factor, &single(&state.rate), &single(&frame.rate), &single(&frame.acceleration))
            .torque;
        if !self.cut {
            let [_, _, m_i] = self.outer.levels;
            let span = INTEGRAL_SPAN * m_i / self.outer.k_i;
            let taken = self.integral + (state.position - target.position) * self.model.period;
            self.integral = taken.map(|part| part.clamp(-span, span));
        }
        Commanded {
            thrust: self.model.mass * force.0[0].norm(),
            torque: torque.map(f64::from),
            desired: frame.attitude,
            desired_rate: frame.rate,
        }
    }

    fn was_cut(&mut self, cut: bool) {
        self.cut = cut;
    }

    fn boxed(&self) -> Box<dyn Rival> {
        Box::new(self.clone())
    }
}
