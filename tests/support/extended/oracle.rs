//! A second, plain transcription of the extended law, in f64, from `docs/extended-law.md`, for the tests to compare the
//! core with.
//!
//! It shares no code with the core and takes the other road wherever there is one: rotation matrices instead of
//! quaternions, the tilt as an angle between two axes, the thrust direction's turn in world axes, the gyroscopic torque
//! from Euler's equations, shares of torque by bisection over all rows, omega_d and omega_d' by differentiating the
//! frame numerically, filters in small Runge-Kutta steps. One tick, [`Law::evaluate`], is a pure function of [`Tick`],
//! so that its sensitivity to every rounding can be computed. Its pieces:
//!
//! - [`position`] and [`turning`]: the commanded force, and how the thrust direction follows it;
//! - [`attitude`] and [`heading`]: the torque that the errors ask for;
//! - [`spending`]: what rotors and limits leave of it;
//! - [`estimates`]: what is learnt of the forces; [`acting`]: what rotors still do of earlier commands;
//! - [`fallback`]: the slowed law.

pub mod acting;
pub mod attitude;
pub mod estimates;
pub mod fallback;
pub mod heading;
pub mod position;
pub mod spending;
pub mod tick;
pub mod turning;

use crate::support::oracle::desired::{Command, velocity};
use crate::support::oracle::lifting::Lift;
use controller_core::allocation::Rotors;
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::vehicle::{Limits, Vehicle};
use nalgebra::{Matrix3, Vector2, Vector3};
use spending::{Rotor, Row, THRUST_LEFT};
use tick::{Answer, Tick};
use turning::Turn;

/// How much of what thrust takes at once may push across, m/s^2.
const PUSH_ACROSS: f64 = 5.0;

/// The least share of M_theta that a bias leaves.
const LEVEL_LEAST: f64 = 0.05;

/// The law in f64, under the page's symbols.
pub struct Law {
    pub p: ExtendedParameters,
    pub mass: f64,
    pub gravity: f64,
    pub inertia: Matrix3<f64>,
    pub rotors: Vec<Rotor>,
    pub period: f64,
    /// T.
    pub late: f64,
    thrust_max: f64,
    yaw_max: f64,
    rows: Vec<Row>,
}

fn double(x: f32) -> f64 {
    f64::from(x)
}

fn axes(across: f32, vertical: f32) -> Vector3<f64> {
    Vector3::new(across, across, vertical).cast()
}

/// s(x; M).
fn saturate(x: f64, level: f64) -> f64 {
    level * x / level.hypot(x)
}

impl Law {
    pub fn new(
        vehicle: &Vehicle,
        limits: &Limits,
        p: &ExtendedParameters,
        rotors: Option<&Rotors>,
        late: f32,
        period: f32,
    ) -> Self {
        let rows = rotors.into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse()));
        let rotors = rows.map(|(rotor, row)| Rotor {
            least: double(rotor.thrust_min),
            greatest: double(rotor.thrust_max),
            row: *row,
        });
        let law = Self {
            p: *p,
            mass: double(vehicle.mass),
            gravity: double(vehicle.gravity),
            inertia: Matrix3::from_diagonal(&vehicle.inertia.cast()),
            rotors: rotors.collect(),
            period: double(period),
            late: double(late),
            thrust_max: double(limits.thrust_max),
            yaw_max: double(limits.torque_max.z),
            rows: Vec::new(),
        };
        Self { rows: law.rows(&limits.torque_max.cast()), ..law }
    }

    /// The diagonal of J, kg m^2.
    pub fn moments(&self) -> Vector3<f64> {
        self.inertia.diagonal()
    }

    /// One tick.
    pub fn evaluate(&self, t: &Tick) -> Answer {
        let (p, h, back) = (&self.p, self.period, t.rotation.transpose());
        let axis: Vector3<f64> = t.rotation.column(2).into();
        let averages = self.learnt(t, &axis);
        let scale = averages.scale;
        let bias = averages.bias.zip_map(&axes(p.torque_tilt, p.torque_yaw), |x: f64, level| x.clamp(-level, level));
        let greatest = self.greatest(scale, &bias) * (1.0 + t.nudge.greatest);
        let kappa = Vector3::new(1.0, 1.0, 0.0) * double(p.drag_across);
        let [v_d, a_d, j_d, s_d] = t.reference;
        let rest = Vector3::new(0.0, 0.0, self.gravity) + a_d + kappa.component_mul(&v_d);
        let (d, force_cut) = self.believed(&averages.force, &(rest + t.nudge.rest), greatest);

        let gains = self.gains(t.fallback.slow);
        let feedback = self.feedback(t, &gains, &d, greatest);
        let [c, x, y] = t.filters;
        let [k_f, k_s, k_d] = gains.filters;
        let c_rate = k_f * (x - c);
        let smoothed = feedback + (y - feedback) * (-k_d * h).exp();
        let drive = (smoothed - x) * ((1.0 - (-k_s * h).exp()) / h);
        let c_second = k_f * (drive - c_rate);
        let u = c + rest + t.nudge.command[0];
        let u_dot = c_rate + j_d + kappa.component_mul(&a_d) + t.nudge.command[1];
        let u_ddot = c_second + s_d + kappa.component_mul(&j_d) + t.nudge.command[2];

        // How rho turns, and the errors. Rates do not depend on u''.
        let n = u.norm();
        let rho = u / n;
        let (r, along) = (rho.dot(&u_dot), rho.dot(&u_ddot));
        let rate = (u_dot - rho * r) / n;
        let wanted = Turn { rho, n, r, p: rate, q: (u_ddot - rho * along - rate * (2.0 * r)) / n, along };
        let command = Command { u, u_dot, u_ddot: Vector3::zeros(), heading: t.heading };
        let (desired, omega_d) = velocity(|e| command.desired_attitude(e), command.fastest());
        let error = desired.transpose() * t.rotation;
        let (turning, frame) = (back * rho.cross(&rate), error.transpose() * omega_d);
        let behind = t.omega - frame;
        let counted = (t.omega - turning).xy().push(behind.z);
        let (projected, projected_rate) = self.projected(t, &error, [&behind, &counted], scale, &bias);
        let before = t.lift.unwrap_or_else(|| Lift::initial(&projected));
        let (lift, lifted) = before.advance(&projected, double(p.delta), double(p.alpha));
        let tilt = self.tilt(&projected, t.side);

        // The torque about the tilt's axes, part by part.
        let reserve = self.moments().xy().max() * double(p.turn_reserve);
        let m_tilt = double(p.m_tilt);
        let [of_bias, of_pull, of_gyroscopic, of_damping, of_precession, of_turning] = t.nudge.parts;
        let mut spending = self.spending(scale, t.nudge.rooms);
        spending.spend(&(of_bias - bias.xy()), 0.0);
        let left = spending.radius() - bias.xy().norm() - reserve;
        let level = m_tilt.min(left.max(LEVEL_LEAST * m_tilt));
        let pull = self.pull(&tilt, level);
        spending.spend(&(of_pull - pull), reserve);
        let (gyroscopic, gyroscopic_size) = self.gyroscopic(&turning, &t.omega);
        let of_g = spending.spend(&(of_gyroscopic + gyroscopic), reserve);
        let wanted_damping = self.damping(&tilt, &projected_rate.xy());
        let lambda = spending.spend(&(of_damping - wanted_damping), reserve);
        let damping = wanted_damping * lambda;
        let precession = self.precession(&turning, &t.omega);
        let of_h = spending.spend(&(of_precession + precession), reserve);
        let (q, [faster, sooner, tilted]) = self.turned(&wanted, &t.nudge.turn);
        let whole = back * rho.cross(&q);
        let part = (self.inertia * whole).xy() + of_turning;
        let steep = rho.z.max(double(p.tilt_max).cos());
        let more = (smoothed.z - c.z + t.nudge.command[0].z) / steep;
        let across = PUSH_ACROSS / rho.xy().norm();
        let length = (n + more.clamp(-across, across)).max(0.0).min(greatest);
        let thrust = (1.0 - THRUST_LEFT) * self.mass * length;
        let above = self.share_above_the_floor(&spending.spent, &part, thrust, scale);
        let above = above.max((double(p.turn_reserve) / q.norm()).min(1.0));
        let of_rows = spending.spend(&(part * above), 0.0);
        let q = q * (above * of_rows);
        let turned = whole * (above * of_rows);
        let vertical = [c.z, c_rate.z, c_second.z];
        let (change, [swells, falls]) = self.change(&wanted, &q, greatest, &vertical);

        // Thrust, then yaw.
        let tilting: Vector2<f64> = spending.spent;
        let (_, _, omega_d_dot) = Command { u_ddot: u_ddot + change, ..command }.differentiate();
        let forward = self.forward(&t.omega, &frame, &(error.transpose() * omega_d_dot));
        let psi = 2.0 * lifted[3];
        let asked = self.yaw_torque([psi, projected_rate.z], forward, &t.omega, t.yaw_room) - bias.z;
        let asked = asked + t.nudge.yaw[0];
        let along = self.mass * length * rho.dot(&axis);
        let [floor, ceiling] = self.thrusts(&tilting.push(0.0), scale).map(|end| end + t.nudge.thrust);
        let braking = self.braking(asked, projected_rate.z);
        let [_, beside_yaw] = self.thrusts(&tilting.push(braking), scale).map(|end| end + t.nudge.thrust);
        let thrust = floor.max(ceiling.min(beside_yaw).min(along));
        let [least, most] = self.yaw(thrust, &tilting, scale);
        let [least, most] = [least - t.nudge.yaw[1], most + t.nudge.yaw[1]];
        let yaw = asked.clamp(least, most);

        let fallback = t.fallback.after(t.position_error.norm(), t.velocity_error.norm(), h);
        let fell = fallback.slow && !t.fallback.slow;
        let filters = self.filtered([c, x], drive + change / k_f, smoothed, k_f);
        let switch = lifted[0].abs() - attitude::switching(double(p.delta));
        let j = self.moments();
        let yaw_size = j.z
            * (omega_d_dot.norm()
                + t.omega.norm() * frame.norm()
                + double(p.c_2) * (t.omega.z.abs() + frame.norm() + double(p.yaw_rate)))
            + (j.x - j.y).abs() * t.omega.norm_squared();
        Answer {
            thrust,
            torque: tilting.push(yaw),
            pull,
            damping,
            omega_d,
            omega_d_dot,
            filters: if fell { [-d; 3] } else { filters },
            averages,
            lifted,
            lift,
            side: tilt.side,
            yaw_room: most.min(-least),
            fallback,
            forward: turned.xy().push(forward),
            sizes: [
                bias.xy().norm(),
                pull.norm(),
                gyroscopic_size,
                wanted_damping.norm(),
                precession.norm(),
                j.max() * whole.norm(),
                yaw_size + bias.z.abs(),
            ],
            edge: tilt.edge.min(switch.abs()).min(projected_rate.z.abs()),
            taken: [
                faster,
                sooner,
                tilted,
                swells,
                falls,
                force_cut,
                level < m_tilt,
                of_g < 1.0,
                lambda < 1.0,
                of_h < 1.0,
                of_rows < 1.0,
                above < 1.0,
                along < floor,
                along > ceiling,
                asked < least || asked > most,
                floor.max(beside_yaw) < along.min(ceiling),
                tilt.held,
                tilt.round,
            ],
        }
    }
}
