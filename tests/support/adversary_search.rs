//! An adversary for the certificate: it searches everything reachable after a reset for the greatest rates and torques.
//!
//! A [`Situation`] is one instant: per axis a point of the filters' reachable set
//! (`controller_core::certificate:: reachable`), a feedback within ±M_p, a reference within Omega_r with any heading,
//! any attitude error the path lifting admits and any body-rate error. Situations are coded as points of a cube, so
//! that the search knows nothing of the sets' shapes; what a situation amounts to is worked out by the law's own code
//! in `controller-core`.

pub mod configurations;
pub mod search;

use controller_core::attitude::{self, AttitudeLaw};
use controller_core::attitude_reference::{AttitudeReference, attitude_reference};
use controller_core::configuration::Configuration;
use controller_core::controller::Memory;
use controller_core::heading::Heading;
use controller_core::path_lifting::Lift;
use controller_core::position::FilterState;
use controller_core::reference::Reference;
use controller_core::state::State;
use nalgebra::{Quaternion, Vector2, Vector3};

/// How many coordinates code a situation.
pub const COORDINATE_COUNT: usize = 30;

/// A situation's code: every coordinate in [-1, 1].
pub type Code = [f64; COORDINATE_COUNT];

/// How close to |theta~| = 1 + delta an attitude error may come and still not be switched by rounding.
const SWITCHING_ROOM: f64 = 1e-5;

/// Body-rate errors reach this multiple of M_omega / k_omega: their saturation is then within 1e-4 of its level.
const RATE_ERROR_RANGE: f64 = 100.0;

/// One instant of a flight.
#[derive(Debug, Clone, Copy)]
pub struct Situation {
    /// x_f.
    pub filter: FilterState,
    /// ubar_p, m/s^2.
    pub feedback: Vector3<f32>,
    /// The reference, at the origin and at rest.
    pub reference: Reference,
    /// The lifted attitude error m* Phi.
    pub attitude_error: Quaternion<f32>,
    /// omega~, rad/s, body.
    pub rate_error: Vector3<f32>,
    command: Vector3<f32>,
    command_rate: Vector3<f32>,
    command_acceleration: Vector3<f32>,
}

/// Which filter states the adversary may start from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Domain {
    /// What a feedback within ±M_p can reach from x_f = 0, and nothing else.
    Reachable,
    /// Any u_f in the box ±M_p beside the derivatives u_f' and u_f'' of any reachable state: how the bounds are argued,
    /// Lemma 1 and the sharp one alike. It holds the reachable set and more, so what is found here need not occur in
    /// flight, and no filter state belongs to it.
    Decoupled,
}

/// The point of one axis' reachable set at `along` of its upper arc (0 to 1), scaled by `depth` in [-1, 1]: (u_f, u_s).
pub fn reachable_point(k_f: f64, k_s: f64, level: f64, along: f64, depth: f64) -> (f64, f64) {
    let slow = k_f.min(k_s);
    let time = -(1.0 - along).ln() / slow;
    let (e_f, e_s) = ((-k_f * time).exp(), (-k_s * time).exp());
    let spread = k_s - k_f;
    let difference = if along == 1.0 {
        0.0
    } else if spread.abs() < 1e-9 * k_s {
        2.0 * level * k_s * time * e_f
    } else {
        2.0 * level * k_s * (e_f - e_s) / spread
    };
    let u_s = level * (2.0 * e_s - 1.0);
    (depth * (u_s + difference), depth * u_s)
}

/// The point of the ball of radius `radius` nearest to a cube's point blown up to it.
fn in_ball<const N: usize>(x: [f64; N], radius: f64) -> [f64; N] {
    let length = x.iter().map(|c| c * c).sum::<f64>().sqrt();
    x.map(|c| c * radius / length.max(1.0))
}

impl Situation {
    /// What `code` stands for under `configuration`.
    pub fn decode(configuration: &Configuration, domain: Domain, code: &Code) -> Self {
        let (gains, bounds) = (configuration.gains().unwrap(), configuration.bounds());
        let (k_f, k_s, level) = (f64::from(gains.k_f), f64::from(gains.k_s), f64::from(gains.m_p));
        let triple = |from: usize| [code[from], code[from + 1], code[from + 2]];

        let axes = [0, 3, 6].map(|from| reachable_point(k_f, k_s, level, 0.5 + 0.5 * code[from], code[from + 1]));
        let (u_f, u_s) = (Vector3::from(axes.map(|axis| axis.0)), Vector3::from(axes.map(|axis| axis.1)));
        let ubar = Vector3::new(code[2], code[5], code[8]) * level;

        let [a_x, a_y] = in_ball([code[12], code[13]], f64::from(bounds.horizontal_acceleration));
        let acceleration = Vector3::new(a_x, a_y, code[14] * f64::from(bounds.vertical_acceleration));
        let jerk = Vector3::from(in_ball(triple(15), f64::from(bounds.jerk)));
        let snap = Vector3::from(in_ball(triple(18), f64::from(bounds.snap)));
        // |nu'| = |psi'| and |nu''|^2 = psi''^2 + psi'^4.
        let second = f64::from(bounds.heading_second_derivative);
        let rate = code[22] * f64::from(bounds.heading_rate).min(second.sqrt());
        let acceleration_of_heading = code[23] * (second * second - rate.powi(4)).max(0.0).sqrt();
        let (sin, cos) = (std::f64::consts::PI * code[21]).sin_cos();
        let direction = Vector2::new(cos as f32, sin as f32);
        let heading = Heading::new(direction, rate as f32, acceleration_of_heading as f32).unwrap();

        let radius = 1.0 + f64::from(gains.delta);
        let theta = Vector3::from(in_ball(triple(24), radius * (1.0 - SWITCHING_ROOM)));
        let square = theta.norm_squared();
        let quaternion = Quaternion::from_parts(1.0 - square, theta * 2.0) / (1.0 + square);
        let fastest = RATE_ERROR_RANGE * f64::from(gains.m_omega / gains.k_omega);

        let difference = u_f - u_s;
        let in_command = match domain {
            Domain::Reachable => u_f,
            Domain::Decoupled => Vector3::from(triple(9)) * level,
        };
        let gravity = Vector3::new(0.0, 0.0, f64::from(configuration.vehicle().gravity));
        Self {
            filter: FilterState { filtered: u_f.cast(), intermediate: u_s.cast() },
            feedback: ubar.cast(),
            reference: Reference {
                position: Vector3::zeros(),
                velocity: Vector3::zeros(),
                acceleration: acceleration.cast(),
                jerk: jerk.cast(),
                snap: snap.cast(),
                heading,
            },
            attitude_error: quaternion.cast(),
            rate_error: (Vector3::from(triple(27)) * fastest).cast(),
            command: (in_command + acceleration + gravity).cast(),
            command_rate: (jerk - difference * k_f).cast(),
            command_acceleration: ((difference * k_f - (u_s - ubar) * k_s) * k_f + snap).cast(),
        }
    }

    /// u, u' and u''.
    pub fn command_and_derivatives(&self) -> [Vector3<f32>; 3] {
        [self.command, self.command_rate, self.command_acceleration]
    }

    /// R_d, omega_d and omega_d'.
    pub fn desired(&self) -> AttitudeReference {
        let Self { command, command_rate, command_acceleration, reference, .. } = self;
        attitude_reference(command, command_rate, command_acceleration, &reference.heading)
    }

    /// The torque the law commands.
    pub fn torque(&self, configuration: &Configuration) -> Vector3<f32> {
        let desired = self.desired();
        let error = &self.attitude_error;
        let law = AttitudeLaw::new(configuration.gains().unwrap(), &configuration.vehicle().inertia);
        law.command(
            error,
            1.0,
            &(self.rate_error + attitude::rotate_back(error, &desired.angular_velocity)),
            &desired.angular_velocity,
            &desired.angular_acceleration,
        )
        .torque
    }

    /// The memory and the state with which a controller's next step is in this situation.
    pub fn start(&self, configuration: &Configuration) -> (Memory, State) {
        let gains = configuration.gains().unwrap();
        let (k_f, k_s, level) = (gains.k_f, gains.k_s, gains.m_p);
        let FilterState { filtered, intermediate } = self.filter;
        // Beyond ten levels the saturation is flat: that is where a feedback of ±M_p comes from.
        let argument = self.feedback.map(|ubar| {
            let share = ubar / level;
            if share.abs() < 1.0 { -level * share.atanh().clamp(-10.0, 10.0) } else { -10.0 * level * share }
        });
        let z_2 = filtered / k_f + intermediate / k_s;
        let z_1 = (argument - z_2 * gains.k_v) / gains.k_p;
        let desired = self.desired();
        let state = State {
            position: z_1 - filtered / (k_s * k_f),
            velocity: Vector3::zeros(),
            attitude: desired.attitude * self.attitude_error,
            angular_velocity: self.rate_error + attitude::rotate_back(&self.attitude_error, &desired.angular_velocity),
        };
        let lift = Lift { memory: self.attitude_error, sign: 1.0 };
        (Memory { filter: self.filter, lift: Some(lift) }, state)
    }
}
