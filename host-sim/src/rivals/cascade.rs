//! A cascade of P and PID loops as PX4's multicopter control flies it (its documentation's controller diagrams), with
//! the attitude law of D. Brescianini, M. Hehn, R. D'Andrea: *Nonlinear quadrocopter attitude control*, technical
//! report, ETH Zurich, 2013. Written from those descriptions.
//!
//! ```text
//! position   v_s = v_d + K_p (p_d - p), limited across and along the vertical
//! velocity   a_s = a_d + K_v e + K_i int(e) - K_d (v_f' - v_d'),  e = v_s - v
//!            z_d along (a_s, a_s, g + a_s z), tilted at most so far; thrust limited, the vertical first
//!            int' = e - (a_s - what the limits left of it) 2 / K_v        across: tracking anti-windup
//! attitude   q_r: the shortest turn of body z to z_d;  q_d = q_r (the rest about z, its angle times w)
//!            w_s = 2 sgn(q_e0) K_q q_e + feed-forward, limited
//! rate       tau = J (K_w e + int(K_j e) - K_e w_f') + w x J w
//! ```
//!
//! The rate integral is held while a rotor saturates, and takes in less of a larger error. Thrust is |a_s| along
//! z_d, as body z sees it, so that it does not push down while the vehicle is upside down. Added, since ours has it:
//! the angular velocity of the reference as feed-forward, and its acceleration in the velocity's D. Gains stand before
//! accelerations.
//!
//! Home: setpoints from a pilot or a planner, moderate attitudes; it also recovers.

use super::frame::{Frame, HeadingRule};
use super::jet::Jet;
use super::low_pass::LowPass;
use super::rival::{Commanded, Rival, RivalModel, RivalReference, RivalState, gyroscopic, paired};
use super::start::Pace;
use nalgebra::{UnitQuaternion, Vector2, Vector3};

/// The gains' names.
pub const NAMES: [&str; 18] = [
    "k_p_across",
    "k_p_vertical",
    "k_v_across",
    "k_i_across",
    "k_d_across",
    "k_v_vertical",
    "k_i_vertical",
    "k_d_vertical",
    "v_across",
    "v_vertical",
    "k_q_tilt",
    "yaw_weight",
    "k_w_tilt",
    "k_j_tilt",
    "k_e_tilt",
    "k_w_yaw",
    "k_j_yaw",
    "cut_off",
];
/// Where a search starts: PX4's defaults, in accelerations.
pub const START_GAINS: [f64; 18] =
    [0.95, 1.0, 1.8, 0.4, 0.2, 4.0, 2.0, 0.01, 12.0, 3.0, 6.5, 0.4, 18.0, 6.0, 0.05, 4.0, 1.0, 100.0];
/// The quantity that each gain scales with.
pub const GAIN_PACES: [Pace; 18] = [
    Pace::Position(1),
    Pace::Position(1),
    Pace::Position(1),
    Pace::Position(2),
    Pace::Kept,
    Pace::Position(1),
    Pace::Position(2),
    Pace::Kept,
    Pace::Kept,
    Pace::Kept,
    Pace::Attitude(1),
    Pace::Kept,
    Pace::Attitude(1),
    Pace::Attitude(2),
    Pace::Kept,
    Pace::Attitude(1),
    Pace::Attitude(2),
    Pace::Kept,
];

/// Greatest commanded tilt; greatest body rates: PX4's `MPC_TILTMAX_AIR`, `MC_ROLLRATE_MAX` and
/// `MC_YAWRATE_MAX`.
const TILT_MAX_RAD: f64 = 0.785;
const RATES_MAX_RAD_PER_S: Vector3<f64> = Vector3::new(3.84, 3.84, 3.49);
/// Level of the rate's integral.
const RATE_INTEGRAL_MAX_RAD_PER_S2: f64 = 20.0;
/// Error of a rate beyond which its integral takes nothing in: 400 degrees/s.
const RATE_ERROR_MAX_RAD_PER_S: f64 = 6.98;
/// Share of the thrust kept for moving across, however hard the vertical asks.
const LEVEL_THRUST_SHARE: f64 = 0.3;

/// The law and its memory.
#[derive(Debug, Clone)]
pub struct Cascade {
    model: RivalModel,
    k_p: Vector3<f64>,
    k_v: Vector3<f64>,
    k_i: Vector3<f64>,
    k_d: Vector3<f64>,
    v_across: f64,
    v_vertical: f64,
    k_q: f64,
    yaw_weight: f64,
    k_w: Vector3<f64>,
    k_j: Vector3<f64>,
    k_e: f64,
    velocity: LowPass,
    rate: LowPass,
    velocity_integral: Vector3<f64>,
    rate_integral: Vector3<f64>,
    saturated: bool,
}

impl Cascade {
    /// With gains as in [`NAMES`].
    #[must_use]
    pub fn new(model: RivalModel, gains: [f64; 18]) -> Self {
        let [p_a, p_v, v_a, i_a, d_a, v_v, i_v, d_v, v_across, v_vertical, k_q, weight, w_t, j_t, k_e, w_y, j_y, cut] =
            gains;
        Self {
            model,
            k_p: paired(p_a, p_v),
            k_v: paired(v_a, v_v),
            k_i: paired(i_a, i_v),
            k_d: paired(d_a, d_v),
            v_across,
            v_vertical,
            k_q,
            yaw_weight: weight.min(1.0),
            k_w: paired(w_t, w_y),
            k_j: paired(j_t, j_y),
            k_e,
            velocity: LowPass::new(cut, model.period),
            rate: LowPass::new(cut, model.period),
            velocity_integral: Vector3::zeros(),
            rate_integral: Vector3::zeros(),
            saturated: false,
        }
    }

    /// The commanded force per mass, m/s^2, world: position and velocity loop with their limits.
    fn force(&mut self, state: &RivalState, target: &RivalReference) -> Vector3<f64> {
        let towards = self.k_p.component_mul(&(target.position - state.position));
        let across = limited(target.velocity.xy() + towards.xy(), self.v_across);
        let along = (target.velocity.z + towards.z).clamp(-self.v_vertical, self.v_vertical);
        let error = across.push(along) - state.velocity;
        let (_, acceleration) = self.velocity.take(&state.velocity);
        let commanded = target.acceleration.0[0] + self.k_v.component_mul(&error) + self.velocity_integral
            - self.k_d.component_mul(&(acceleration - target.motion));

        // The vertical first, but some of the thrust is kept for moving across.
        let greatest = self.model.thrust_max / self.model.mass;
        let vertical = self.model.gravity + commanded.z;
        let wanted_across = commanded.xy().norm();
        let kept = wanted_across.min(LEVEL_THRUST_SHARE * greatest);
        let up = vertical.clamp(0.0, (greatest * greatest - kept * kept).sqrt());
        let room = (greatest * greatest - up * up).max(0.0).sqrt();
        // The tilt counts from gravity, as if the vertical were not accelerated.
        let produced = limited(commanded.xy(), room.min(TILT_MAX_RAD.tan() * up.max(self.model.gravity)));

        let period = self.model.period;
        let lost = (commanded.xy() - produced) * (2.0 / self.k_v.x);
        let mut taken = error - lost.push(0.0);
        if (vertical > up && error.z > 0.0) || (vertical < up && error.z < 0.0) {
            taken.z = 0.0;
        }
        self.velocity_integral += self.k_i.component_mul(&taken) * period;
        self.velocity_integral.z = self.velocity_integral.z.clamp(-self.model.gravity, self.model.gravity);
        produced.push(up)
    }

    /// The desired body rates, rad/s, and the desired attitude.
    fn rates(
        &self,
        state: &RivalState,
        force: Vector3<f64>,
        target: &RivalReference,
    ) -> (Vector3<f64>, UnitQuaternion<f64>) {
        let heading = Jet::constant(target.heading.0[0]);
        let full = Frame::new(&Jet::constant(force), &heading, HeadingRule::Horizontal).attitude;
        let reduced = shortest(&(state.attitude * Vector3::z()), &(full * Vector3::z())) * state.attitude;
        let rest = reduced.inverse() * full;
        let twist = 2.0 * rest.k.atan2(rest.w);
        let twist = twist.sin().atan2(twist.cos());
        let desired = reduced * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw_weight * twist);
        let error = state.attitude.inverse() * desired;
        let sign = if error.w < 0.0 { -1.0 } else { 1.0 };
        (error.imag() * (2.0 * sign * self.k_q), full)
    }
}

impl Rival for Cascade {
    fn step(&mut self, state: &RivalState, target: &RivalReference) -> Commanded {
        let force = self.force(state, target);
        let (rates, desired) = self.rates(state, force, target);
        let needed = target.acceleration.plus(&Jet::constant(Vector3::z() * self.model.gravity));
        let reference = Frame::new(&needed, &target.heading, HeadingRule::Horizontal);
        let forward = state.attitude.inverse() * (reference.attitude * reference.rate);
        let commanded = (rates + forward).zip_map(&RATES_MAX_RAD_PER_S, |rate, limit| rate.clamp(-limit, limit));

        let error = commanded - state.rate;
        let (_, acceleration) = self.rate.take(&state.rate);
        let turning = self.k_w.component_mul(&error) + self.rate_integral
            - Vector3::new(acceleration.x, acceleration.y, 0.0) * self.k_e;
        if !self.saturated {
            let share = error.map(|error| (1.0 - (error / RATE_ERROR_MAX_RAD_PER_S).powi(2)).max(0.0));
            let taken = self.k_j.component_mul(&error).component_mul(&share) * self.model.period;
            self.rate_integral = (self.rate_integral + taken)
                .map(|part| part.clamp(-RATE_INTEGRAL_MAX_RAD_PER_S2, RATE_INTEGRAL_MAX_RAD_PER_S2));
        }
        let inertia = &self.model.inertia;
        Commanded {
            thrust: self.model.mass * force.dot(&(state.attitude * Vector3::z())),
            torque: inertia.component_mul(&turning) + gyroscopic(inertia, &state.rate),
            desired,
            desired_rate: reference.rate,
        }
    }

    fn was_cut(&mut self, cut: bool) {
        self.saturated = cut;
    }

    fn boxed(&self) -> Box<dyn Rival> {
        Box::new(self.clone())
    }
}

/// `vector` shortened to `length`.
fn limited(vector: Vector2<f64>, length: f64) -> Vector2<f64> {
    let norm = vector.norm();
    if norm > length { vector * (length / norm) } else { vector }
}

/// The shortest turn, world, that takes the unit vector `from` to `to`; half a turn about x or y where they are
/// opposite.
fn shortest(from: &Vector3<f64>, to: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(from, to).unwrap_or_else(|| {
        let axis = if from.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        let axis = nalgebra::Unit::new_normalize(from.cross(&axis));
        UnitQuaternion::from_axis_angle(&axis, std::f64::consts::PI)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposite_directions_are_half_a_turn_apart() {
        for from in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let turned = shortest(&from, &-from) * from;
            assert!((turned + from).norm() < 1e-9);
        }
    }
}
