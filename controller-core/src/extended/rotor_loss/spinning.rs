//! The law without a rotor: the vehicle gives up its heading, turns, and holds its place.
//!
//! Three rotors of four hold a vehicle up only if it turns ever faster until drag stops that (*relaxed hover*: M. W.
//! Mueller, R. D'Andrea, *Relaxed hover solutions for multicopters*, IJRR 35(8), 2016). Then a constant torque about an
//! axis of the body averages out in the world. n is an axis in the body, near its z; the vehicle is to turn about n,
//! and n to point along u:
//!
//! | here | equation |
//! |---|---|
//! | u | g e3 + p_d'' - k_v (v~ + v(z)) - d, upwards and across within their levels; v(z) of [`super::super::approach`] |
//! | p~, v~ | p - c - p_d, v - c' - p_d', c = -a / omega^2, a = T (R e3 - R n n_3) / m: the circle that the thrust turns it on |
//! | d | d' = l (v' - (u - g e3) - d): whatever keeps the vehicle from moving as it is told |
//! | eta | R^T u / \|u\|, as it will be when a command acts |
//! | error | e = (n x eta) / cos(theta / 2), cos theta = n . eta: 2 sin(theta / 2) long |
//! | rate error | delta = omega - w, w = n omega_3 / n_3 |
//! | torque | tau = J (k_q e - k_w delta + delta x w) + omega x J omega |
//! | thrust | T = m \|u\| cos theta / n_3, or more while it begins to turn |
//! | yaw | tau_3 = J_3 k_y (r - omega_3), r towards the heading: what is left for it, often nothing |
//!
//! delta x w makes delta fall in the world's axes, not in those of the turning body. The body turns by omega T within
//! the lag and the delay T, at 18 rad/s and 25 ms by 26 degrees: all errors are those at its end, by the gyro and what
//! past commands will still do.
//!
//! **The axis.** The rotor opposite a failed one can only push that side further down, so about z it has nothing to do,
//! and the tilt is held in one direction only. Turning about n = z cos phi + sin phi a, a from the failed rotor to
//! the one opposite, needs from that one the torque (J_3 - J_1) omega_3^2 tan phi, which grows until its drag ends the
//! vehicle's turning faster; and with a thrust to take back it holds the tilt both ways. It needs J_3 > J_1, as flat
//! vehicles have it. Where thrusts that are left hold the tilt in every direction, n is z.
//!
//! **The beginning.** Until the vehicle has turned by a quarter, nothing stops it from falling over to the failed side.
//! More thrust turns it sooner, and gains height while the axis still points up. Once it has turned, never again: a
//! vehicle that touches the ground turns no more.

use super::super::approach::Approach;
use super::super::memory::Estimates;
use crate::allocation::Rotors;
use crate::allocation::minimum_norm::Thrusts;
use crate::allocation::remaining::{LostRotor, RemainingRotors};
use crate::attitude::rotate_back;
use crate::math;
use crate::reference::Reference;
use crate::state::{State, Wrench, length_squared};
use crate::vehicle::{Limits, Vehicle};
use nalgebra::{Quaternion, Vector3, Vector4};

/// phi, rad: its cosine and sine.
const AXIS_COSINE_SINE: (f32, f32) = (0.968_912_4, 0.247_403_96);

/// The least J_3 over the mean of J_1 and J_2 for which n is not z.
const FLATNESS_MIN: f32 = 1.15;

/// How much of a torque that raises the failed side has to be had for n to be z.
const RAISING_TORQUE_SHARE_MIN: f32 = 0.8;

/// The greatest bandwidth of the attitude, 1/s; it times lag, delay and period; its damping.
const BANDWIDTH_MAX_PER_S: f32 = 20.0;
const BANDWIDTH_DELAY_MAX: f32 = 0.7;
const DAMPING_RATIO: f32 = 0.8;

/// k_p, 1/s^2, and k_v, 1/s, across and along the vertical.
const GAINS_ACROSS: (f32, f32) = (2.4, 2.0);
const GAINS_VERTICAL: (f32, f32) = (5.4, 3.0);

/// The acceleration that an approach counts on to brake, m/s^2, and its greatest speed, m/s.
const BRAKING_ACCELERATION_M_PER_S2: f32 = 4.0;
const APPROACH_SPEED_MAX_M_PER_S: f32 = 4.0;

/// u's vertical component, in g, and the tangent of its tilt.
const LIFT_RANGE_G: (f32, f32) = (0.4, 2.0);
const TILT_TANGENT_MAX: f32 = 0.7;

/// Bandwidth of d, 1/s, and its greatest size along each axis, m/s^2.
const FORCE_BANDWIDTH_PER_S: f64 = 1.5;
const FORCE_MAX_M_PER_S2: f32 = 6.0;

/// k_y, 1/s; the rate towards the heading, rad/s, for one rad and at most; and up to which rate it is looked for.
const YAW_BANDWIDTH_PER_S: f32 = 5.0;
const HEADING_GAIN_AND_RATE: (f32, f32) = (2.0, 1.0);
const HEADING_RATE_MAX_RAD_PER_S: f32 = 2.0;

/// The thrust while it begins to turn, in weights, for how long at most, s, up to which rate it does, rad/s, the least
/// part of a rotor's share of the weight that is lacking for the tilt then, and the least cosine of the axis' tilt.
const SPIN_UP_THRUST_WEIGHTS: f32 = 2.0;
const SPIN_UP_MAX_S: f32 = 0.6;
const SPIN_UP_RATE_RAD_PER_S: f32 = 6.0;
const SPIN_UP_MISSING_TORQUE_SHARE_MIN: f32 = 0.1;
const SPIN_UP_COSINE_MIN: f32 = 0.5;

/// How long what the failed rotor has left is watched, s; the least mean thrust of it that tells, in a share of the
/// weight; the least share of that which has to be missing; and the least that a rotor has left that is not gone.
const REFINING_S: f32 = 0.05;
const TELLING_THRUST_SHARE_MIN: f32 = 0.15;
const MISSING_SHARE_MIN: f32 = 0.25;
const LEFT_SHARE_MIN: f32 = 0.1;

/// Steps of the motion that is looked ahead.
const STEPS_AHEAD: usize = 3;

/// The law for a vehicle with a certain rotor lost, and its memory.
#[derive(Debug, Clone, PartialEq)]
pub struct RotorLossLaw {
    /// What is lost.
    lost: LostRotor,
    rotors: RemainingRotors,
    /// a and n.
    away: Vector3<f32>,
    axis: Vector3<f32>,
    vehicle: Vehicle,
    /// k_q, 1/s^2, and k_w, 1/s.
    stiffness: f32,
    damping: f32,
    approaches: [Approach; 2],
    /// How late a command is in its middle, s.
    late: f32,
    /// A rotor's share of the weight times its arm, N m.
    unit: f32,
    memory: Memory,
    /// The last tick's, N, and what they deliver.
    commands: Thrusts,
    delivered: Wrench,
}

/// What it remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Memory {
    /// d, m/s^2.
    force: Vector3<f32>,
    /// The velocity at the last tick, m/s, and u - g e3, m/s^2.
    last: Option<(Vector3<f32>, Vector3<f32>)>,
    /// The torque about the tilt's axes that was not to be had, in `unit`.
    lacking: f32,
    /// What the failed rotor was taken to deliver, what was missing of it, N s, and for how long, s.
    taken: f32,
    missed: f32,
    watched: f32,
    /// How long it has taken to begin to turn, s, so far; at least `SPIN_UP_MAX_S` once it has.
    beginning: f32,
}

/// A tick's outcome, beside the commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotorLossStep {
    /// u, m/s^2.
    pub command: Vector3<f32>,
    /// The tilt's error as modified Rodrigues parameters, body frame.
    pub mrp: Vector3<f32>,
}

impl RotorLossLaw {
    /// For a vehicle whose `rotors` have `lost` one, in ticks `period` seconds apart with commands that are `late`, s,
    /// and with the `estimates` that there were of it.
    pub fn new(
        vehicle: &Vehicle,
        limits: &Limits,
        rotors: &Rotors,
        lost: &LostRotor,
        [late, period]: [f32; 2],
        estimates: &Estimates,
    ) -> Self {
        let Estimates { force, scale, .. } = estimates;
        let weight = vehicle.mass * vehicle.gravity;
        let remaining = RemainingRotors::new(rotors, limits, lost, *scale, weight);
        let place = rotors.get(lost.rotor).map_or_else(Vector3::zeros, |rotor| rotor.position);
        let arm = math::max(math::sqrt(place.xy().norm_squared()), f32::MIN_POSITIVE);
        let away = Vector3::new(-place.x, -place.y, 0.0) / arm;
        let unit = arm * weight / rotors.len() as f32;
        let axis = axis(vehicle, &remaining, &away, unit);
        let bandwidth = math::min(BANDWIDTH_MAX_PER_S, BANDWIDTH_DELAY_MAX / (late + period));
        Self {
            lost: *lost,
            rotors: remaining,
            away,
            axis,
            vehicle: *vehicle,
            stiffness: bandwidth * bandwidth,
            damping: 2.0 * DAMPING_RATIO * bandwidth,
            approaches: [GAINS_ACROSS, GAINS_VERTICAL]
                .map(|(k_p, k_v)| Approach::new(k_p, k_v, APPROACH_SPEED_MAX_M_PER_S)),
            late: late + 0.5 * period,
            unit,
            memory: Memory {
                force: force.map(|x| math::saturate(x, FORCE_MAX_M_PER_S2)),
                last: None,
                lacking: 0.0,
                taken: 0.0,
                missed: 0.0,
                watched: 0.0,
                beginning: 0.0,
            },
            commands: Thrusts::new(),
            delivered: Wrench { thrust: weight, torque: Vector3::zeros() },
        }
    }

    /// Learns what the failed rotor has left, from the thrust that it was taken to deliver in an interval of `period`,
    /// s, and what was `missing` of it, N. A flip, in which it was found to fail, tells too little of that.
    pub fn refine_loss(&mut self, thrust: f32, missing: f32, period: f32) {
        let Memory { taken, missed, watched, .. } = &mut self.memory;
        (*taken, *missed, *watched) = (*taken + thrust * period, *missed + missing * period, *watched + period);
        if *watched < REFINING_S {
            return;
        }
        let tells = *taken > REFINING_S * TELLING_THRUST_SHARE_MIN * self.rotors.share();
        let share = math::clamp(*missed / math::max(*taken, f32::MIN_POSITIVE), -1.0, 1.0);
        (*taken, *missed, *watched) = (0.0, 0.0, 0.0);
        if tells && share.abs() > MISSING_SHARE_MIN {
            let left = math::min(self.lost.left * (1.0 - share), 1.0);
            self.lost.left = if left > LEFT_SHARE_MIN { left } else { 0.0 };
            self.rotors.set_left(&self.lost);
            self.axis = axis(&self.vehicle, &self.rotors, &self.away, self.unit);
        }
    }

    /// What is lost.
    pub fn lost(&self) -> &LostRotor {
        &self.lost
    }

    /// What to command of each rotor, N; nothing before the first tick.
    pub fn commands(&self) -> &Thrusts {
        &self.commands
    }

    /// What they deliver.
    pub fn delivered(&self) -> &Wrench {
        &self.delivered
    }

    /// d, m/s^2, world frame.
    pub fn force(&self) -> Vector3<f32> {
        self.memory.force
    }

    /// One tick: `pending` is the impulse that past commands will still deliver, N s and N m s.
    pub fn step(&mut self, state: &State, reference: &Reference, pending: &Vector4<f32>, period: f32) -> RotorLossStep {
        self.learn(&state.velocity, period);
        let command = self.command(state, reference);
        let (attitude, velocity) = self.ahead(state, pending);
        let length = math::sqrt(command.norm_squared());
        let (error, half) = self.error(&rotate_back(&attitude, &(command / length)));
        let spin = self.axis * (velocity.z / self.axis.z);
        let delta = velocity - spin;
        let inertia = &self.vehicle.inertia;
        let turning = error * self.stiffness - delta * self.damping + delta.cross(&spin);
        let mut torque = inertia.component_mul(&turning) + velocity.cross(&inertia.component_mul(&velocity));
        torque.z = inertia.z * YAW_BANDWIDTH_PER_S * (towards(state, reference) - velocity.z);

        // cos theta = 2 cos(theta / 2)^2 - 1.
        let along = self.vehicle.mass * length * (2.0 * half * half - 1.0) / self.axis.z;
        let upwards = 1.0 - 2.0 * (attitude.i * attitude.i + attitude.j * attitude.j) / length_squared(&attitude);
        let turns = velocity.z.abs() > SPIN_UP_RATE_RAD_PER_S;
        self.memory.beginning += if turns { SPIN_UP_MAX_S } else { period };
        let is_short = self.memory.beginning < SPIN_UP_MAX_S;
        let begins = is_short && self.memory.lacking > SPIN_UP_MISSING_TORQUE_SHARE_MIN && upwards > SPIN_UP_COSINE_MIN;
        let min = if begins { SPIN_UP_THRUST_WEIGHTS * self.vehicle.mass * self.vehicle.gravity } else { 0.0 };
        let wanted = Wrench { thrust: math::max(along, min), torque };

        let thrusts = self.rotors.allocate(&wanted);
        let delivered = self.rotors.wrench(&thrusts);
        let lacking = (delivered.torque - torque).xy();
        let mut falling = command;
        falling.z -= self.vehicle.gravity;
        self.memory.lacking = math::sqrt(lacking.norm_squared()) / self.unit;
        self.memory.last = Some((state.velocity, falling));
        self.commands = self.rotors.commands(&thrusts);
        self.delivered = delivered;
        RotorLossStep { command, mrp: error * (-0.5 / (1.0 + half)) }
    }

    /// d.
    fn learn(&mut self, velocity: &Vector3<f32>, period: f32) {
        let Some((before, falling)) = self.memory.last else { return };
        let averaging = -math::exp_m1(-FORCE_BANDWIDTH_PER_S * f64::from(period)) as f32;
        let beside = (velocity - before) / period - falling;
        let force = &mut self.memory.force;
        *force += (beside.map(|x| math::saturate(x, FORCE_MAX_M_PER_S2)) - *force) * averaging;
    }

    /// u.
    fn command(&self, state: &State, reference: &Reference) -> Vector3<f32> {
        let [around, turned] = self.circle(state);
        let (p, v) = (state.position - around - reference.position, state.velocity - turned - reference.velocity);
        let [across, vertical] = &self.approaches;
        let closing = across.factor(p.xy().norm_squared(), BRAKING_ACCELERATION_M_PER_S2);
        let ((_, k_v), (_, k_v_vertical)) = (GAINS_ACROSS, GAINS_VERTICAL);
        let gravity = self.vehicle.gravity;
        let rest = reference.acceleration - self.memory.force;
        let wanted = rest.xy() - (v.xy() + p.xy() * closing) * k_v;
        let lift =
            rest.z + gravity - (v.z + p.z * vertical.factor(p.z * p.z, BRAKING_ACCELERATION_M_PER_S2)) * k_v_vertical;
        let (min, max) = LIFT_RANGE_G;
        let lift = math::clamp(lift, min * gravity, max * gravity);
        let (length, reach) = (math::sqrt(wanted.norm_squared()), lift * TILT_TANGENT_MAX);
        let share = if length > reach { reach / length } else { 1.0 };
        Vector3::new(wanted.x * share, wanted.y * share, lift)
    }

    /// c and c', of a vehicle that turns.
    fn circle(&self, state: &State) -> [Vector3<f32>; 2] {
        let rate = state.angular_velocity.z / self.axis.z;
        if rate.abs() < SPIN_UP_RATE_RAD_PER_S {
            return [Vector3::zeros(); 2];
        }
        let [thrust, turning] = [Vector3::z(), self.axis].map(|axis| rotate_back(&state.attitude.conjugate(), &axis));
        let across = (thrust - turning * self.axis.z) * (self.delivered.thrust / self.vehicle.mass);
        [across * (-1.0 / (rate * rate)), turning.cross(&across) * (-1.0 / rate)]
    }

    /// Attitude, of any length, and body rate when a command of now acts.
    fn ahead(&self, state: &State, pending: &Vector4<f32>) -> (Quaternion<f32>, Vector3<f32>) {
        let inertia = &self.vehicle.inertia;
        let step = self.late / STEPS_AHEAD as f32;
        let torque = Vector3::new(pending.y, pending.z, pending.w) / self.late;
        let (mut attitude, mut velocity) = (state.attitude, state.angular_velocity);
        for _ in 0..STEPS_AHEAD {
            let gyroscopic = velocity.cross(&inertia.component_mul(&velocity));
            let next = velocity + (torque - gyroscopic).component_div(inertia) * step;
            let half = (velocity + next) * (0.25 * step);
            attitude *= Quaternion::from_parts(1.0, half);
            velocity = next;
        }
        (attitude, velocity)
    }

    /// e, and cos(theta / 2), for eta. Exactly half a turn away there is no nearest way, and no error.
    fn error(&self, eta: &Vector3<f32>) -> (Vector3<f32>, f32) {
        let half = math::sqrt(math::max(0.5 * (1.0 + self.axis.dot(eta)), 0.0));
        (self.axis.cross(eta) / math::max(half, 1e-3), half)
    }
}

/// n, for the rotors that are left, a from the failed one, and its share of the weight times its arm, N m.
fn axis(vehicle: &Vehicle, rotors: &RemainingRotors, away: &Vector3<f32>, unit: f32) -> Vector3<f32> {
    // Raises the failed side: a force f at p turns by p x f.
    let raising = Vector3::new(-away.y, away.x, 0.0) * (0.5 * unit);
    let thrust = vehicle.mass * vehicle.gravity;
    let had = rotors.wrench(&rotors.allocate(&Wrench { thrust, torque: raising }));
    let holds = had.torque.dot(&raising) >= RAISING_TORQUE_SHARE_MIN * raising.norm_squared();
    let inertia = &vehicle.inertia;
    let is_flat = inertia.z > FLATNESS_MIN * 0.5 * (inertia.x + inertia.y);
    let (cosine, sine) = AXIS_COSINE_SINE;
    if holds || !is_flat { Vector3::z() } else { Vector3::z() * cosine + away * sine }
}

/// r: the rate towards the reference's heading, rad/s; none of a vehicle that spins.
fn towards(state: &State, reference: &Reference) -> f32 {
    if state.angular_velocity.z.abs() > HEADING_RATE_MAX_RAD_PER_S {
        return 0.0;
    }
    let forward = crate::heading::Heading::from_attitude(&state.attitude).direction();
    let heading = reference.heading.direction();
    let sine = forward.x * heading.y - forward.y * heading.x;
    let behind = forward.dot(&heading) < 0.0;
    let (of_one, max) = HEADING_GAIN_AND_RATE;
    let turn = if behind { if sine < 0.0 { -max } else { max } } else { math::saturate(of_one * sine, max) };
    turn + reference.heading.rate()
}

#[cfg(test)]
mod tests;
