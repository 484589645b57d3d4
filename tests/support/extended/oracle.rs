//! A second, plain transcription of the extended law, in f64, from the headers of its modules, for the tests to compare the core with.
//!
//! It shares no code with the core and takes the other road wherever there is one: rotation matrices instead of quaternions, the
//! thrust direction's turn in world axes, the heading's lag as an angle, omega_d and omega_d' by differentiating the lagging frame
//! numerically, filters in small Runge-Kutta steps. One tick is a pure function of [`Tick`], so that its sensitivity to every
//! rounding can be asked for.

use crate::support::oracle::desired::{Command, differentiate, velocity};
use crate::support::oracle::lifting::Lift;
use crate::support::oracle::skew;
use controller_core::allocation::Rotors;
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::vehicle::{Limits, Vehicle};
use nalgebra::{Matrix3, Vector2, Vector3, Vector4};

/// mu, and the part of a room that a tick leaves (section 4).
const THRUST_LEFT: f64 = 0.05;
const ROOM_LEFT: f64 = 0.01;

/// The least level of a feedback, m/s^2, and how much of tilt and thrust it uses across (section 1).
const LEVEL_LEAST: f64 = 0.3;
const SHARE_ACROSS: f64 = 0.95;

/// k, 1/s, and the part of alpha that q may take (section 3).
const SOFTNESS: f64 = 10.0;
const TURNED: f64 = 0.6;

/// How far beyond Omega a tick may take the thrust direction (section 4).
const RATE_BEYOND: f64 = 1.15;

/// c_0, m/s^2, and the bandwidth of the slow averages, 1/s (section 9).
const LEAST_VARIATION: f64 = 2.0;
const SLOW: f64 = 0.7;

/// When the net catches, s, what it forgives of a silent time, and how near the target is, m and m/s (section 13).
pub const PATIENCE: f64 = 60.0;
const FORGIVEN: f64 = 0.05;
const NEAR: f64 = 0.05;

/// What the law knows from the tick before.
#[derive(Debug, Clone, Copy)]
pub struct Last {
    pub velocity: Vector3<f64>,
    pub axis: Vector3<f64>,
    pub omega: Vector3<f64>,
    /// R~^T omega_d'.
    pub wanted: Vector3<f64>,
}

/// The net: for how long drives were changed, and whether its level is in force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Net {
    pub acted: f64,
    pub caught: bool,
}

/// What is averaged: zeta, the torque bias, ybar and fbar (none before the first interval); and the scale.
#[derive(Debug, Clone, Copy)]
pub struct Averages {
    pub force: Vector3<f64>,
    pub bias: Vector3<f64>,
    pub slow: Option<[Vector3<f64>; 2]>,
    pub scale: f64,
}

/// Everything one tick depends on.
#[derive(Debug, Clone, Copy)]
pub struct Tick {
    pub position_error: Vector3<f64>,
    pub velocity_error: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub rotation: Matrix3<f64>,
    pub omega: Vector3<f64>,
    /// p_d' to p_d''''.
    pub reference: [Vector3<f64>; 4],
    /// psi, psi', psi''.
    pub heading: [f64; 3],
    /// c, x and y.
    pub filters: [Vector3<f64>; 3],
    /// chi and W; none before the first tick.
    pub lag: Option<[f64; 2]>,
    pub lift: Option<Lift>,
    pub averages: Averages,
    pub net: Net,
    /// None before the first tick.
    pub last: Option<Last>,
    /// Nothing is learnt.
    pub held: bool,
    /// The mean of the wrench commanded since the last tick, through delay and lag; the impulse that is still under way.
    pub acted: Vector4<f64>,
    pub pending: Vector4<f64>,
    pub nudge: Nudge,
}

/// The roundings of sums and differences that are formed on the way: added to each.
#[derive(Debug, Clone, Copy, Default)]
pub struct Nudge {
    /// u, u' and u''.
    pub command: [Vector3<f64>; 3],
    /// U, relative.
    pub greatest: f64,
    /// alpha, rad/s^2.
    pub budget: f64,
    /// rho'' across rho, rad/s^2, as limited.
    pub turn: Vector3<f64>,
    /// W', rad/s^2.
    pub heading: f64,
}

/// What one tick comes to.
#[derive(Debug, Clone, Copy)]
pub struct Answer {
    pub thrust: f64,
    pub torque: Vector3<f64>,
    pub omega_d: Vector3<f64>,
    pub omega_d_dot: Vector3<f64>,
    pub filters: [Vector3<f64>; 3],
    pub averages: Averages,
    /// chi and W.
    pub lag: [f64; 2],
    /// m* Phi, and the lift's memory.
    pub lifted: Vector4<f64>,
    pub lift: Lift,
    pub net: Net,
    /// R~^T omega_d'.
    pub wanted: Vector3<f64>,
    /// Which way the tick went where it can go two: the frame's rate, its acceleration, the same with W, its cone; |u|, c_z; the damping's
    /// share; the floor, the ceiling; W cut.
    pub taken: [bool; 10],
}

/// A row of the budget: t, y, R.
#[derive(Debug, Clone, Copy)]
struct Row {
    tilt: f64,
    yaw: f64,
    room: f64,
}

/// A rotor: its range and its row of B+.
#[derive(Debug, Clone, Copy)]
pub struct Rotor {
    least: f64,
    greatest: f64,
    pub row: Vector4<f64>,
}

impl Rotor {
    /// b_tau / b_T.
    fn per_thrust(&self) -> Vector3<f64> {
        Vector3::new(self.row[1], self.row[2], self.row[3]) / self.row[0]
    }
}

/// The law in f64, under the headers' symbols.
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
    rows: Vec<Row>,
    /// N_0, and L.
    floor: [f64; 2],
    /// What bias and yaw take of the greatest thrust.
    taken: f64,
}

fn double(x: f32) -> f64 {
    f64::from(x)
}

fn axes(across: f32, vertical: f32) -> Vector3<f64> {
    Vector3::new(across, across, vertical).cast()
}

fn cut(x: f64, level: f64) -> f64 {
    x.clamp(-level, level)
}

fn about_z(angle: f64) -> Matrix3<f64> {
    let (sin, cos) = angle.sin_cos();
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// s(x; M).
fn saturate(x: f64, level: f64) -> f64 {
    level * x / level.hypot(x)
}

fn saturate_across(x: Vector2<f64>, level: f64) -> Vector2<f64> {
    x * (level / level.hypot(x.norm()))
}

/// `v`, at most `length` long, and whether it was shortened.
fn shortened(v: Vector3<f64>, length: f64) -> (Vector3<f64>, bool) {
    let long = v.norm() > length;
    (if long { v * (length / v.norm()) } else { v }, long)
}

/// How u moves, and what bounds it.
struct Turn {
    rho: Vector3<f64>,
    n: f64,
    /// rho . u'.
    r: f64,
    /// rho', and rho'' as wanted without its radial part.
    p: Vector3<f64>,
    q: Vector3<f64>,
    /// rho . u''.
    along: f64,
}

/// d, U and whether the level is the net's.
struct Envelope {
    d: Vector3<f64>,
    greatest: f64,
    most: f64,
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
        let mut law = Self {
            p: *p,
            mass: double(vehicle.mass),
            gravity: double(vehicle.gravity),
            inertia: Matrix3::from_diagonal(&vehicle.inertia.cast()),
            rotors: rotors.collect(),
            period: double(period),
            late: double(late),
            thrust_max: double(limits.thrust_max),
            rows: Vec::new(),
            floor: [0.0; 2],
            taken: 0.0,
        };
        law.spend(&limits.torque_max.cast());
        law
    }

    fn moments(&self) -> Vector3<f64> {
        self.inertia.diagonal()
    }

    /// The budget's fixed part, section 4.
    fn spend(&mut self, torque_max: &Vector3<f64>) {
        let (p, j) = (&self.p, self.moments());
        let [yaw_acceleration, yaw_rate, margin] = [p.yaw_acceleration, p.yaw_rate, p.floor_margin].map(double);
        let turn_rate = RATE_BEYOND * double(p.turn_rate);
        let [bias_tilt, bias_yaw] = [p.torque_tilt, p.torque_yaw].map(double);
        let [s_lo, s_hi] = [p.scale_least, p.scale_greatest].map(double);
        // Two components of omega_d across each other, at Omega and W_max: their product is at most half the square.
        let product = (turn_rate.powi(2) + yaw_rate.powi(2)) / 2.0;
        let tilt = j.x.max(j.y) * yaw_acceleration + (j.z - j.x).abs().max((j.z - j.y).abs()) * product;
        let feedback = double(p.w) * double(p.eta) / 2.0 + double(p.m_omega_z);
        let yaw = j.z * yaw_acceleration + (j.x - j.y).abs() * product + feedback;
        self.rows = vec![
            Row { tilt: 1.0, yaw: 0.0, room: torque_max.x.min(torque_max.y) - tilt - bias_tilt },
            Row { tilt: 0.0, yaw: 1.0, room: torque_max.z - yaw - bias_yaw },
        ];
        let beside =
            |b: &Vector3<f64>| (b.x.abs() + b.y.abs()) * bias_tilt + b.z.abs() * (bias_yaw + j.z * yaw_acceleration);
        self.floor = [margin, 0.0];
        if !self.rotors.is_empty() {
            let pairs = || self.rotors.iter().flat_map(|k| self.rotors.iter().map(move |i| (k, i)));
            let most = |of: fn(Vector3<f64>) -> f64| {
                pairs().map(|(k, i)| of(k.per_thrust() - i.per_thrust())).fold(0.0, f64::max)
            };
            let range = pairs()
                .map(|(k, i)| s_lo * k.greatest / k.row[0] - s_hi * i.least / i.row[0])
                .fold(f64::INFINITY, f64::min);
            let (t, y) = (most(|b| b.x.hypot(b.y)), most(|b| b.z.abs()));
            let bias = most(|b| b.x.abs() + b.y.abs()) * bias_tilt + y * bias_yaw;
            self.rows.push(Row { tilt: t, yaw: y, room: range - 2.0 * margin - bias - t * tilt - y * yaw });
            let greatest = |of: &dyn Fn(&Rotor) -> f64| self.rotors.iter().map(of).fold(0.0, f64::max);
            let (t, y) = (greatest(&|r| r.per_thrust().xy().norm()), greatest(&|r| r.per_thrust().z.abs()));
            let below = self.thrust_max - greatest(&|r| s_hi * r.least / r.row[0]) - 2.0 * margin;
            let bias = greatest(&|r| r.per_thrust().x.abs() + r.per_thrust().y.abs()) * bias_tilt + y * bias_yaw;
            self.rows.push(Row { tilt: t, yaw: y, room: below - bias - t * tilt - y * yaw });
            let raised = greatest(&|rotor| s_hi * rotor.least / rotor.row[0] + beside(&rotor.per_thrust()));
            let slope = greatest(&|rotor| {
                let b = rotor.per_thrust();
                (j.x * b.x).hypot(j.y * b.y)
            });
            self.taken = greatest(&|rotor| beside(&rotor.per_thrust())) + margin;
            self.floor = [raised + margin, slope];
        }
    }

    /// U, section 4: what the thrust near the target leaves.
    fn greatest(&self, scale: f64) -> f64 {
        let each = self.rotors.iter().map(|rotor| rotor.greatest / rotor.row[0]).fold(f64::INFINITY, f64::min);
        (1.0 - THRUST_LEFT) * (scale * each - self.taken).min(self.thrust_max) / self.mass
    }

    /// alpha, section 4, and what was added up to it.
    fn budget(&self, n: f64, feedback: f64, sine: f64) -> (f64, f64) {
        let j = self.moments();
        let most = double(self.p.turn_acceleration);
        let [floor, slope] = self.floor;
        let (mut alpha, mut size) = (most, most);
        if slope > 0.0 {
            alpha = alpha.min(((1.0 - THRUST_LEFT) * self.mass * n - floor) / slope);
            size += (self.mass * n + floor) / slope;
        }
        for Row { tilt, yaw, room } in &self.rows {
            let cost = tilt * j.x.max(j.y) + yaw * j.z * sine;
            if cost > 0.0 {
                alpha = alpha.min((room * (1.0 - ROOM_LEFT) - tilt * feedback) / cost);
                size += if *tilt > 0.0 { room.min(1e3) / cost } else { 0.0 };
            }
        }
        (alpha, size)
    }

    /// What was added up to alpha, rad/s^2.
    pub fn budget_size(&self, n: f64) -> f64 {
        self.budget(n, 0.0, 0.0).1
    }

    /// One tick.
    pub fn evaluate(&self, t: &Tick) -> Answer {
        let (p, h) = (&self.p, self.period);
        let axis: Vector3<f64> = t.rotation.column(2).into();
        let averages = self.learnt(t, &axis);
        let scale = averages.scale;
        let across = averages.force.xy();
        let across = across * (double(p.force_across) / across.norm()).min(1.0);
        let d_z = averages.force.z.clamp(-double(p.force_down), double(p.force_up));
        let d = Vector3::new(across.x, across.y, d_z);
        let bias = averages.bias.zip_map(&axes(p.torque_tilt, p.torque_yaw), cut);

        let (mut net, mut filters) = (t.net, t.filters);
        if net.acted > PATIENCE && !net.caught {
            (net, filters) = (Net { acted: 0.0, caught: true }, [-d; 3]);
        }
        let greatest = self.greatest(scale) * (1.0 + t.nudge.greatest);
        let most = if net.caught { self.net_level() } else { f64::INFINITY };
        let ([z_1, z_2], feedback) = self.feedback(t, &filters, &Envelope { d, greatest, most });
        let [c, x, y] = filters;
        let k_f = double(p.k_f);
        let c_rate = k_f * (x - c);
        let smoothed = feedback + (y - feedback) * (-double(p.k_d) * h).exp();
        let drive = (smoothed - x) * ((1.0 - (-double(p.k_s) * h).exp()) / h);
        let c_second = k_f * (drive - c_rate);

        let kappa = Vector3::new(1.0, 1.0, 0.0) * double(p.drag_across);
        let [v_d, a_d, j_d, s_d] = t.reference;
        let u = c + Vector3::new(0.0, 0.0, self.gravity) + a_d + kappa.component_mul(&v_d) + t.nudge.command[0];
        let u_dot = c_rate + j_d + kappa.component_mul(&a_d) + t.nudge.command[1];
        let u_ddot = c_second + s_d + kappa.component_mul(&j_d) + t.nudge.command[2];
        // Rates do not depend on u''.
        let command = Command { u, u_dot, u_ddot: Vector3::zeros(), heading: t.heading };
        let (papers, papers_rate) = velocity(|e| command.desired_attitude(e), command.fastest());
        let lag = t.lag.unwrap_or_else(|| [0.0, cut(papers_rate.z, double(p.yaw_rate))]);
        let [chi, turn] = lag;
        let across = about_z(chi).transpose() * papers_rate;
        let omega_d = Vector3::new(across.x, across.y, turn);
        let error = (papers * about_z(chi)).transpose() * t.rotation;
        let behind = t.omega - error.transpose() * omega_d;

        let (projected, projected_rate) = self.projected(t, &error, &behind, scale, &bias);
        let before = t.lift.unwrap_or_else(|| Lift::initial(&projected));
        let (lift, lifted) = before.advance(&projected, double(p.delta), double(p.alpha));
        let potential = self.potential(&lifted);
        let (damping, eased) = self.damping(&lifted, &potential, &projected_rate);
        let pull = potential + damping;

        let n = u.norm();
        let rho = u / n;
        let r = rho.dot(&u_dot);
        let rate = (u_dot - rho * r) / n;
        let along = rho.dot(&u_ddot);
        let wanted = Turn { rho, n, r, p: rate, q: (u_ddot - rho * along - rate * (2.0 * r)) / n, along };
        let cosine = error[(2, 2)];
        let sine = if cosine > 0.0 { error[(0, 2)].hypot(error[(1, 2)]) } else { 1.0 };
        let alpha = self.budget(n, pull.xy().norm(), sine).0 + t.nudge.budget;
        let vertical = [c.z, c_rate.z, c_second.z];
        let (change, limited) = self.limited(&wanted, turn, alpha, greatest, &vertical, &t.nudge.turn);
        let command = Command { u_ddot: u_ddot + change, ..command };

        let (omega_d, omega_d_dot, mut after) = self.lagging(lag, &command, t.nudge.heading);
        // What q leaves of alpha is W's at the next tick, with |p| to an eighth.
        let turning = papers.transpose() * wanted.p;
        let fastest = (1.0 - TURNED) * alpha.max(double(p.turn_reserve))
            / (turning.x.abs().max(turning.y.abs()) + 0.5 * turning.x.abs().min(turning.y.abs())).max(1e-3);
        let slowed = after[1].abs() > fastest;
        after[1] = cut(after[1], fastest);
        let (rate, turned) = (error.transpose() * omega_d, error.transpose() * omega_d_dot);
        let torque = self.inertia * turned - skew(self.inertia * rate) * rate - pull - bias;
        let asked = self.mass * u.dot(&axis);
        let [least, ceiling] = self.thrusts(&torque, scale);
        let thrust = ceiling.min(least.max(asked));
        let [rate, acceleration, whole, cone, swells, falls] = limited;
        if z_1.norm() < NEAR && z_2.norm() < NEAR {
            net = Net { acted: 0.0, caught: false };
        } else if limited.contains(&true) || thrust < asked {
            net.acted += h;
        } else {
            net.acted = (net.acted - FORGIVEN * h).max(0.0);
        }
        Answer {
            thrust,
            torque,
            omega_d,
            omega_d_dot,
            filters: self.filtered([c, x], drive + change / k_f, smoothed),
            averages,
            lag: after,
            lifted,
            lift,
            net,
            wanted: turned,
            taken: [rate, acceleration, whole, cone, swells, falls, eased, asked < least, asked > ceiling, slowed],
        }
    }

    /// Sections 2, 7 and 9: the averages with what happened since the last tick.
    fn learnt(&self, t: &Tick, axis: &Vector3<f64>) -> Averages {
        let before = t.averages;
        let Some(last) = t.last.filter(|_| !t.held) else { return before };
        let (p, h) = (&self.p, self.period);
        let weight = |bandwidth: f64| 1.0 - (-bandwidth * h).exp();
        let drag = double(p.drag_across) * (t.velocity + last.velocity) / 2.0;
        let made = (t.velocity - last.velocity) / h + Vector3::new(drag.x, drag.y, self.gravity);
        let commanded = (last.axis + axis) / 2.0 * (t.acted[0] / self.mass);

        // They begin with the first interval.
        let [slow_made, slow_commanded] = before.slow.unwrap_or([made, commanded]);
        let slow =
            [(slow_made, made), (slow_commanded, commanded)].map(|(slow, new)| slow + (new - slow) * weight(SLOW));
        let (y, f) = (made - slow[0], commanded - slow[1]);
        let step = double(p.scale_rate) * h * (y - before.scale * f).dot(&f)
            / (f.norm_squared() + LEAST_VARIATION * LEAST_VARIATION);
        let scale = (before.scale + step).clamp(double(p.scale_least), double(p.scale_greatest));

        let averaging = axes(p.force_bandwidth_across, p.force_bandwidth_vertical).map(weight);
        let force = before.force + averaging.component_mul(&(made - commanded * scale - before.force));
        let omega = (last.omega + t.omega) / 2.0;
        let torque = Vector3::new(t.acted[1], t.acted[2], t.acted[3]) * scale;
        let observed = self.inertia * (t.omega - last.omega) / h + skew(omega) * self.inertia * omega - torque;
        let bias = before.bias + (observed - before.bias) * weight(double(p.torque_bandwidth));
        Averages { force, bias, slow: Some(slow), scale }
    }

    /// The net's level, section 13: c' and c'' take half of Omega and three tenths of alpha_0 at the least |u|.
    fn net_level(&self) -> f64 {
        let p = &self.p;
        let [k_f, k_s] = [p.k_f, p.k_s].map(double);
        let least = self.gravity - double(p.a_down);
        let by_rate = 0.5 * double(p.turn_rate) * least / (2.0 * k_f);
        by_rate.min(0.3 * double(p.turn_reserve) * least / (2.0 * k_f * (k_s + k_f)))
    }

    /// Section 1: z_1, z_2 and ubar.
    fn feedback(&self, t: &Tick, filters: &[Vector3<f64>; 3], e: &Envelope) -> ([Vector3<f64>; 2], Vector3<f64>) {
        let p = &self.p;
        let [f, s, d] = [p.k_f, p.k_s, p.k_d].map(|bandwidth| 1.0 / double(bandwidth));
        let [c, x, y] = filters.map(|filter| filter + e.d);
        let z_1 = t.position_error + t.velocity_error * (f + s + d) + c * (f * (s + d)) + x * (s * d);
        let z_2 = t.velocity_error + c * f + x * s + y * d;

        let (k_p, k_v) = (double(p.k_p_vertical), double(p.k_v_vertical));
        let speed = double(if z_1.z > 0.0 { p.v_down } else { p.v_up });
        let wanted = saturate(k_p * z_1.z, k_v * speed) + k_v * z_2.z;
        let level = if wanted > 0.0 { double(p.a_down) - e.d.z } else { e.greatest - self.gravity + e.d.z };
        let vertical = -saturate(wanted, level.max(LEVEL_LEAST).min(e.most)) - e.d.z;

        let lift = self.gravity + vertical;
        let left = (e.greatest.powi(2) - lift.powi(2)).max(0.0).sqrt();
        let reach = double(p.a_across).min(SHARE_ACROSS * left).min(SHARE_ACROSS * lift * double(p.tilt_max).tan());
        let level = (reach - e.d.xy().norm()).max(LEVEL_LEAST).min(e.most);
        let (k_p, k_v) = (double(p.k_p_across), double(p.k_v_across));
        let wanted = saturate_across(k_p * z_1.xy(), k_v * double(p.v_across)) + k_v * z_2.xy();
        let across = -saturate_across(wanted, level) - e.d.xy();
        ([z_1, z_2], Vector3::new(across.x, across.y, vertical))
    }

    /// Section 6: the errors as they will be once what is under way has arrived.
    fn projected(
        &self,
        t: &Tick,
        error: &Matrix3<f64>,
        behind: &Vector3<f64>,
        scale: f64,
        bias: &Vector3<f64>,
    ) -> (Matrix3<f64>, Vector3<f64>) {
        // Cayley's transform of v is the rotation of the quaternion (1, v).
        let v = skew(behind * (0.5 * self.late));
        let turned = (Matrix3::identity() - v).try_inverse().unwrap() * (Matrix3::identity() + v);
        let impulse = Vector3::new(t.pending[1], t.pending[2], t.pending[3]) * scale + bias * self.late;
        let wanted = t.last.map_or_else(Vector3::zeros, |last| last.wanted);
        (error * turned, behind + impulse.component_div(&self.moments()) - wanted * self.late)
    }

    /// Section 6: P.
    fn potential(&self, q: &Vector4<f64>) -> Vector3<f64> {
        let p = &self.p;
        let [w, eta, k_t, m_t, eta_t] = [p.w, p.eta, p.k_t, p.m_t, p.eta_t].map(double);
        let r = q[1].hypot(q[2]);
        let h = (q[0] + eta).hypot(q[3]);
        let g = m_t * k_t / (m_t.hypot(k_t * r) * ((1.0 - r * r).max(0.0) + eta_t * eta_t).sqrt());
        // The gradients of h and of r^2 along the body's rates.
        let of_h = Vector3::new((q[0] + eta) * q[1] + q[2] * q[3], (q[0] + eta) * q[2] - q[1] * q[3], eta * q[3]);
        let of_r = Vector3::new(q[0] * q[1] + q[2] * q[3], q[0] * q[2] - q[1] * q[3], 0.0);
        of_h * (w / (2.0 * h)) + of_r * g
    }

    /// Section 6: the damping, and whether it has less than it asks for.
    fn damping(&self, q: &Vector4<f64>, potential: &Vector3<f64>, behind: &Vector3<f64>) -> (Vector3<f64>, bool) {
        let p = &self.p;
        let r = q[1].hypot(q[2]);
        let d = behind.xy() * (double(p.k_omega_t) / (1.0 + (r / double(p.r_0)).powi(2)).powf(0.25));
        let (pull, most) = (potential.xy(), double(p.m_all));
        let room = (most.powi(2) - pull.norm_squared()).max(0.0);
        let (along, square) = (pull.dot(&d), d.norm_squared());
        let eased = (pull + d).norm() > most;
        // The positive root of |P + lambda D| = M_all.
        let lambda = if !eased {
            1.0
        } else if along > 0.0 {
            room / ((along * along + square * room).sqrt() + along)
        } else {
            ((along * along + square * room).sqrt() - along) / square
        };
        let yaw = saturate(double(p.k_omega_z) * behind.z, double(p.m_omega_z));
        (Vector3::new(lambda * d.x, lambda * d.y, yaw), eased)
    }

    /// Section 3, in world axes: what is added to u''.
    fn limited(
        &self,
        turn: &Turn,
        yaw_rate: f64,
        alpha: f64,
        greatest: f64,
        [c, c_rate, c_second]: &[f64; 3],
        nudge: &Vector3<f64>,
    ) -> (Vector3<f64>, [bool; 6]) {
        let (parameters, h) = (&self.p, self.period);
        let Turn { rho, n, r, p, q: wanted, along: radial } = turn;
        let [rate, reserve] = [parameters.turn_rate, parameters.turn_reserve].map(double);
        let most = alpha.max(reserve);
        let (own, shorter) = shortened(*wanted, TURNED * most);
        let mut q = if shorter { own + nudge } else { *wanted };

        // e3 without its part along rho.
        let z = Vector3::z() - rho * rho.z;
        let rising = (p + q * h).dot(&z);
        let least = -(reserve / rate) * (rho.z - double(parameters.tilt_max).cos());
        let carried = p.cross(rho) * yaw_rate;
        let tilted = rising < least;
        if tilted {
            let inwards = z * ((least - rising) / (z.norm_squared().max(1e-6) * h));
            q += shortened(inwards, most).0 + nudge;
        }
        let (next, faster) = shortened(p + q * h, rate);
        if faster {
            q = (next - p) / h + nudge;
        }
        let (whole, sooner) = shortened(q + carried, most);
        if sooner {
            q = whole - carried + nudge;
        }

        let tangential = (q - wanted) * *n;
        let k = SOFTNESS.min(0.5 / h);
        let mut along = 0.0;
        let falling = c_second + tangential.z;
        let climbing = -2.0 * k * c_rate - k * k * (c + double(parameters.a_down));
        let falls = falling < climbing;
        if falls {
            along = (climbing - falling) / rho.z;
        }
        let swelling = radial + along + n * p.norm_squared();
        let shrinking = -2.0 * k * r - k * k * (n - greatest);
        let swells = swelling > shrinking;
        if swells {
            along += shrinking - swelling;
        }
        (tangential + rho * along, [faster, shorter, sooner, tilted, swells, falls])
    }

    /// Section 5: the frame's motion that lags in heading, and chi and W a period later.
    fn lagging(&self, [chi, turn]: [f64; 2], command: &Command, nudge: f64) -> (Vector3<f64>, Vector3<f64>, [f64; 2]) {
        let (p, h) = (&self.p, self.period);
        let (_, papers, papers_rate) = command.differentiate();
        let chi_rate = turn - papers.z;
        let wanted = papers_rate.z - double(p.c_2) * chi_rate - 2.0 * double(p.c_1) * (chi / 2.0).sin();
        let reached = cut(turn + cut(wanted, double(p.yaw_acceleration)) * h, double(p.yaw_rate));
        let turn_rate = (reached - turn) / h + nudge;
        let chi_second = turn_rate - papers_rate.z;
        let frame = |e: f64| command.desired_attitude(e) * about_z(chi + chi_rate * e + chi_second * e * e / 2.0);
        let scale = command.fastest().max(chi_rate.abs()).max(chi_second.abs().sqrt());
        let (_, omega_d, omega_d_dot) = differentiate(frame, scale);
        // The half angle moves along its tangent and is brought back to the circle.
        let next = chi + 2.0 * (0.5 * h * chi_rate).atan();
        (omega_d, omega_d_dot, [next.sin().atan2(next.cos()), turn + turn_rate * h])
    }

    /// Section 8: N and C.
    fn thrusts(&self, torque: &Vector3<f64>, scale: f64) -> [f64; 2] {
        let margin = double(self.p.floor_margin);
        let each = |end: fn(&Rotor) -> f64| {
            self.rotors.iter().map(move |rotor| scale * end(rotor) / rotor.row[0] - rotor.per_thrust().dot(torque))
        };
        let least = each(|rotor| rotor.least).fold(0.0, f64::max) + margin;
        [least, each(|rotor| rotor.greatest).map(|most| most - margin).fold(self.thrust_max, f64::min)]
    }

    /// c and x a period later, with the drive held, and y at `smoothed`.
    fn filtered(
        &self,
        [mut c, mut x]: [Vector3<f64>; 2],
        drive: Vector3<f64>,
        smoothed: Vector3<f64>,
    ) -> [Vector3<f64>; 3] {
        let k_f = double(self.p.k_f);
        let flow = |c: Vector3<f64>, x: Vector3<f64>| k_f * (x - c);
        let steps = 60;
        let h = self.period / f64::from(steps);
        for _ in 0..steps {
            let (middle, end) = (x + drive * (h / 2.0), x + drive * h);
            let k_1 = flow(c, x);
            let k_2 = flow(c + k_1 * (h / 2.0), middle);
            let k_3 = flow(c + k_2 * (h / 2.0), middle);
            let k_4 = flow(c + k_3 * h, end);
            c += (k_1 + 2.0 * k_2 + 2.0 * k_3 + k_4) * (h / 6.0);
            x = end;
        }
        let lowest = -double(self.p.a_down);
        if c.z < lowest {
            (c.z, x.z) = (lowest, x.z.max(lowest));
        }
        [c, x, smoothed]
    }
}

/// Section 10: what was commanded, through delay and lag, in pieces between the moments at which the command that acts changes.
pub struct Acting {
    lag: f64,
    /// In periods.
    delay: f64,
    period: f64,
    wrench: Vector4<f64>,
    /// The newest last.
    commands: Vec<Vector4<f64>>,
}

impl Acting {
    /// With `wrench` commanded for ever.
    pub fn new(lag: f32, delay: f32, period: f32, wrench: Vector4<f64>) -> Self {
        let period = double(period);
        Self { lag: double(lag), delay: double(delay) / period, period, wrench, commands: vec![wrench; 8] }
    }

    /// How many whole periods a command is late, and for how long after a tick the one before it still acts, s.
    fn late(&self) -> (usize, f64) {
        let whole = self.delay.floor();
        (whole as usize, (self.delay - whole) * self.period)
    }

    fn command(&self, age: usize) -> Vector4<f64> {
        self.commands[self.commands.len() - 1 - age]
    }

    /// A period with `command` given at its start; the mean over it.
    pub fn advance(&mut self, command: Vector4<f64>) -> Vector4<f64> {
        self.commands.push(command);
        let (whole, late) = self.late();
        let mut sum = Vector4::zeros();
        for (duration, command) in [(late, self.command(whole + 1)), (self.period - late, self.command(whole))] {
            if self.lag > 0.0 {
                let left = (-duration / self.lag).exp();
                sum += command * duration + (self.wrench - command) * (self.lag * (1.0 - left));
                self.wrench = command + (self.wrench - command) * left;
            } else {
                sum += command * duration;
                self.wrench = command;
            }
        }
        sum / self.period
    }

    /// What it would still deliver if nothing were commanded from now on.
    pub fn pending(&self) -> Vector4<f64> {
        let (whole, late) = self.late();
        let waiting: Vector4<f64> = (0..whole).map(|age| self.command(age) * self.period).sum();
        self.wrench * self.lag + waiting + self.command(whole) * late
    }
}
