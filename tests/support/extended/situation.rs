//! One instant of a flight under the extended law, coded as a point of a cube, for searches that know nothing of the sets' shapes.
//!
//! | coordinates | what |
//! |---|---|
//! | filters across | long at one point of the disc, then at another for a time; the feedback now |
//! | filters of the vertical | the same with a number |
//! | reference | v and a across in their discs, the vertical a, jerk and snap in their balls |
//! | force estimate | [`Histories`] of the generator, axis by axis |
//! | heading | W and W', of either sign up to their limits |
//! | attitude | any lifted error up to the switch, any body rate, any bias and scale estimate |
//!
//! What a situation amounts to is worked out by the law's own code in `controller-core`.

use super::force_generator::Histories;
use super::law;
use controller_core::allocation::Rotors;
use controller_core::attitude::rotate_back;
use controller_core::attitude_reference::DesiredAttitude;
use controller_core::certificate::configuration::{Configuration, ExtendedLaw};
use controller_core::extended::attitude::AttitudeLaw;
use controller_core::extended::heading::{HeadingLag, turning};
use controller_core::extended::parameters::Extended;
use controller_core::extended::thrust_floor::ThrustFloor;
use controller_core::heading::Heading;
use nalgebra::{Quaternion, Vector2, Vector3};

/// How many coordinates code a situation; those from [`ATTITUDE`] on are the attitude's.
pub const COORDINATES: usize = 43;
/// The first coordinate that says nothing about the desired motion.
pub const ATTITUDE: usize = 33;

/// A situation's code: every coordinate in [-1, 1].
pub type Code = [f64; COORDINATES];

/// How close to the switch an attitude error may come and still not be switched by rounding.
const SWITCHING_ROOM: f64 = 1e-5;

/// Body-rate errors reach this, rad/s: damping is then within a hundredth of a percent of its level.
const FASTEST: f64 = 1e4;

/// A period short against everything, s: W and W' are then limited each by itself.
const PERIOD: f32 = 1e-3;

/// What the law can be asked for, on one configuration.
pub struct World {
    parameters: Extended,
    mass: f32,
    gravity: f64,
    reference: [f64; 5],
    histories: Histories,
    attitude: AttitudeLaw,
    floor: ThrustFloor,
    rotors: Option<Rotors>,
}

/// One instant.
#[derive(Debug, Clone, Copy)]
pub struct Situation {
    /// u, u', u''.
    pub command: [Vector3<f32>; 3],
    /// omega_d and omega_d', desired body frame.
    pub desired: [Vector3<f32>; 2],
    /// The lifted attitude error.
    pub error: Quaternion<f32>,
    /// omega~, rad/s.
    pub rate_error: Vector3<f32>,
    /// The torque bias estimate, N m.
    pub bias: Vector3<f32>,
    /// The thrust scale.
    pub scale: f32,
}

fn in_ball<const N: usize>(x: [f64; N], radius: f64) -> [f64; N] {
    let length = x.iter().map(|c| c * c).sum::<f64>().sqrt();
    x.map(|c| c * radius / length.max(1.0))
}

/// (u_s, u_f), as shares, of a cascade at rest at one whose input has been zero since `time`.
fn fading(k_f: f64, k_s: f64, time: f64) -> [f64; 2] {
    let (fast, slow) = ((-k_f * time).exp(), (-k_s * time).exp());
    let spread = k_s - k_f;
    let lag = if spread.abs() < 1e-6 * k_s { k_f * time * fast } else { k_f * (fast - slow) / spread };
    [slow, fast + lag]
}

/// A time from 0 to a dozen time constants of the slower filter.
fn duration(code: f64, k_f: f64, k_s: f64) -> f64 {
    -(1.0 - (0.5 + 0.5 * code) * 0.999_99).ln() / k_f.min(k_s)
}

impl World {
    /// Everything reachable under `configuration`, one of the extended law.
    pub fn new(configuration: &Configuration) -> Self {
        let ExtendedLaw { parameters, .. } = law(configuration);
        let (vehicle, bounds) = (configuration.vehicle(), configuration.bounds());
        Self {
            parameters,
            mass: vehicle.mass,
            gravity: f64::from(vehicle.gravity),
            reference: [
                bounds.horizontal_speed,
                bounds.horizontal_acceleration,
                bounds.vertical_acceleration,
                bounds.jerk,
                bounds.snap,
            ]
            .map(f64::from),
            histories: Histories::new(&parameters.estimates),
            attitude: AttitudeLaw::new(&parameters.attitude, &vehicle.inertia),
            floor: ThrustFloor::new(configuration.rotors(), parameters.floor_margin),
            rotors: configuration.rotors().cloned(),
        }
    }

    /// u_f, u_f' and u_f''.
    fn feedback(&self, code: &Code) -> [Vector3<f64>; 3] {
        let p = &self.parameters.position;
        let [k_f, k_s, level] = [p.k_f_across, p.k_s_across, p.m_across].map(f64::from);
        let disc = |from: usize| Vector2::from(in_ball([code[from], code[from + 1]], level));
        let (long, then, now) = (disc(0), disc(2), disc(4));
        let [slow, fast] = fading(k_f, k_s, duration(code[6], k_f, k_s));
        let (u_s, u_f) = (then + (long - then) * slow, then + (long - then) * fast);
        let rate = (u_s - u_f) * k_f;
        let second = ((now - u_s) * k_s - rate) * k_f;

        let [k_f, k_s, up, down] = [p.k_f_vertical, p.k_s_vertical, p.m_up, p.m_down].map(f64::from);
        let level = |code: f64| 0.5 * (up - down) + 0.5 * (up + down) * code;
        let (long, then, now) = (level(code[7]), level(code[8]), level(code[9]));
        let [slow, fast] = fading(k_f, k_s, duration(code[10], k_f, k_s));
        let (z_s, z_f) = (then + (long - then) * slow, then + (long - then) * fast);
        let z_rate = (z_s - z_f) * k_f;
        let z_second = ((now - z_s) * k_s - z_rate) * k_f;
        [
            Vector3::new(u_f.x, u_f.y, z_f),
            Vector3::new(rate.x, rate.y, z_rate),
            Vector3::new(second.x, second.y, z_second),
        ]
    }

    /// p_d'' and its derivatives, with the drag fed forward.
    fn reference(&self, code: &Code) -> [Vector3<f64>; 3] {
        let [speed, across, vertical, jerk, snap] = self.reference;
        let drag = f64::from(self.parameters.estimates.drag_across);
        let triple = |from: usize| [code[from], code[from + 1], code[from + 2]];
        let v = in_ball([code[11], code[12]], speed);
        let a = in_ball([code[13], code[14]], across);
        let (j, s) = (Vector3::from(in_ball(triple(16), jerk)), Vector3::from(in_ball(triple(19), snap)));
        let acceleration = Vector3::new(a[0], a[1], code[15] * vertical);
        let dragged = |below: Vector3<f64>| Vector3::new(drag * below.x, drag * below.y, 0.0);
        [acceleration + dragged(Vector3::new(v[0], v[1], 0.0)), j + dragged(acceleration), s + dragged(j)]
    }

    /// What `code` stands for.
    pub fn decode(&self, code: &Code) -> Situation {
        let triple = |from: usize| [code[from], code[from + 1], code[from + 2]];
        let (feedback, reference) = (self.feedback(code), self.reference(code));
        // The starts' sides and times are one coordinate, shared out so that both ends of it are ends of the level.
        let force = self.histories.reached([triple(22), triple(25), triple(28)]);
        let gravity = Vector3::new(0.0, 0.0, self.gravity);
        let part = |order: usize| (feedback[order] + reference[order]).cast::<f32>() - force[order];
        let command = [(feedback[0] + reference[0] + gravity).cast::<f32>() - force[0], part(1), part(2)];

        let papers =
            DesiredAttitude::new(&command[0], &Heading::FORWARD).motion(&command[1], &command[2], &Heading::FORWARD);
        let heading = &self.parameters.heading;
        let lag = HeadingLag { half_angle: Vector2::new(1.0, 0.0), rate: code[31] as f32 * heading.rate };
        let turned = turning(&lag, &papers, heading, PERIOD);
        let mut acceleration = turned.acceleration;
        acceleration.z = code[32] as f32 * heading.acceleration;

        let radius = 1.0 + f64::from(self.parameters.attitude.delta);
        let mrp = Vector3::from(in_ball(triple(33), radius * (1.0 - SWITCHING_ROOM)));
        let square = mrp.norm_squared();
        let error = Quaternion::from_parts(1.0 - square, mrp * 2.0) / (1.0 + square);
        let e = &self.parameters.estimates;
        let bias = Vector3::from(triple(39)).cast::<f32>();
        let share = (0.5 + 0.5 * code[42]) as f32;
        Situation {
            command,
            desired: [turned.velocity, acceleration],
            error: error.cast(),
            rate_error: (Vector3::from(triple(36)) * FASTEST).cast(),
            bias: bias.component_mul(&Vector3::new(e.torque_tilt, e.torque_tilt, e.torque_yaw)),
            scale: e.scale_least + share * (e.scale_greatest - e.scale_least),
        }
    }

    /// The torque commanded, N m.
    pub fn torque(&self, situation: &Situation) -> Vector3<f32> {
        let Situation { desired: [velocity, acceleration], error, rate_error, bias, .. } = situation;
        let rate = rate_error + rotate_back(error, velocity);
        self.attitude.torque(error, &rate, velocity, acceleration).torque - bias
    }

    /// The thrust commanded with that torque, N.
    pub fn thrust(&self, situation: &Situation) -> f32 {
        let Situation { command: [u, ..], error, scale, .. } = situation;
        // m u . R e3 = m n rho . R~ e3 in the axes of the desired frame.
        let cosine = 1.0 - 2.0 * (error.i * error.i + error.j * error.j);
        (self.mass * u.norm() * cosine).max(self.floor.least(&self.torque(situation), *scale))
    }

    /// What a rotor is asked for, N, once the wrench is divided by the thrust scale.
    pub fn rotor(&self, situation: &Situation, rotor: usize) -> f64 {
        let row = self.rotors.as_ref().unwrap().pseudo_inverse()[rotor];
        let torque = self.torque(situation).cast::<f64>();
        let asked = row.x * f64::from(self.thrust(situation)) + Vector3::new(row.y, row.z, row.w).dot(&torque);
        asked / f64::from(situation.scale)
    }

    /// N of the feed-forward with the bias estimate, over m |u|.
    pub fn floor_share(&self, situation: &Situation) -> f64 {
        let there =
            Situation { error: Quaternion::new(1.0, 0.0, 0.0, 0.0), rate_error: Vector3::zeros(), ..*situation };
        let floor = self.floor.least(&self.torque(&there), situation.scale);
        f64::from(floor / (self.mass * situation.command[0].norm()))
    }
}
