//! A second, plain transcription of the extended law, in f64, from `docs/extended-law.md`, for the tests to compare the core with.
//!
//! It shares no code with the core: rotation matrices instead of quaternions, the heading's lag as an angle, omega_d and omega_d' by
//! differentiating the lagging frame numerically, filters in small Runge-Kutta steps. One tick is a pure function of [`Tick`],
//! so that its sensitivity to every rounding can be asked for.

use crate::support::oracle::desired::{Command, differentiate};
use crate::support::oracle::lifting::Lift;
use crate::support::oracle::skew;
use controller_core::allocation::Rotors;
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::vehicle::Vehicle;
use nalgebra::{Matrix3, Vector2, Vector3, Vector4};

/// c_0, m/s^2, and r, 1/s, of section 7.
const LEAST_THRUST: f64 = 2.0;
const SCALE_RATE: f64 = 0.2;

/// What the law knows from the tick before.
#[derive(Debug, Clone, Copy)]
pub struct Last {
    pub velocity: Vector3<f64>,
    pub axis: Vector3<f64>,
    pub omega: Vector3<f64>,
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
    /// u_f and u_s.
    pub filters: [Vector3<f64>; 2],
    /// chi and W; none before the first tick.
    pub lag: Option<[f64; 2]>,
    pub lift: Option<Lift>,
    /// zeta, d and d'.
    pub force: [Vector3<f64>; 3],
    /// The averaged torque bias.
    pub bias: Vector3<f64>,
    pub scale: f64,
    /// None where the estimates are held.
    pub last: Option<Last>,
    /// The mean of the wrench commanded since the last tick, through delay and lag.
    pub acted: Vector4<f64>,
    /// Added to u, u' and u'', and to W': the roundings of sums.
    pub nudge: [Vector3<f64>; 3],
    pub turn_nudge: f64,
}

/// What one tick comes to.
#[derive(Debug, Clone, Copy)]
pub struct Answer {
    pub thrust: f64,
    pub torque: Vector3<f64>,
    pub omega_d: Vector3<f64>,
    pub omega_d_dot: Vector3<f64>,
    pub filters: [Vector3<f64>; 2],
    pub force: [Vector3<f64>; 3],
    pub bias: Vector3<f64>,
    pub scale: f64,
    /// chi and W.
    pub lag: [f64; 2],
    /// m* Phi, and the lift's memory.
    pub lifted: Vector4<f64>,
    pub lift: Lift,
}

/// The law in f64, under the document's symbols.
pub struct Law {
    pub p: ExtendedParameters,
    pub mass: f64,
    pub gravity: f64,
    pub inertia: Matrix3<f64>,
    /// f_min and the row of the inverse allocation.
    pub rotors: Vec<(f64, Vector4<f64>)>,
    pub period: f64,
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

impl Law {
    pub fn new(vehicle: &Vehicle, p: &ExtendedParameters, rotors: Option<&Rotors>, period: f32) -> Self {
        let rows = rotors.into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse()));
        Self {
            p: *p,
            mass: double(vehicle.mass),
            gravity: double(vehicle.gravity),
            inertia: Matrix3::from_diagonal(&vehicle.inertia.cast()),
            rotors: rows.map(|(rotor, row)| (double(rotor.thrust_min), *row)).collect(),
            period: double(period),
        }
    }

    /// One tick.
    pub fn evaluate(&self, t: &Tick) -> Answer {
        let axis: Vector3<f64> = t.rotation.column(2).into();
        let (zeta, bias, scale) = self.estimated(t, &axis);
        let [_, d, d_rate] = t.force;
        let d_second = self.generated(&zeta, &d, &d_rate);

        let [u_f, u_s] = t.filters;
        let (k_f, k_s) = self.bandwidths();
        let feedback = self.feedback(t);
        let u_f_rate = k_f.component_mul(&(u_s - u_f));
        let u_s_rate = k_s.component_mul(&(feedback - u_s));
        let kappa = Vector3::new(1.0, 1.0, 0.0) * double(self.p.estimates.drag_across);
        let [v_d, a_d, j_d, s_d] = t.reference;
        let command = Command {
            u: u_f + Vector3::new(0.0, 0.0, self.gravity) + a_d + kappa.component_mul(&v_d) - d + t.nudge[0],
            u_dot: u_f_rate + j_d + kappa.component_mul(&a_d) - d_rate + t.nudge[1],
            u_ddot: k_f.component_mul(&(u_s_rate - u_f_rate)) + s_d + kappa.component_mul(&j_d) - d_second + t.nudge[2],
            heading: t.heading,
        };

        let (desired, omega_d, omega_d_dot, lag) = self.lagging(t, &command);
        let error = desired.transpose() * t.rotation;
        let a = &self.p.attitude;
        let before = t.lift.unwrap_or_else(|| Lift::initial(&error));
        let (lift, lifted) = before.advance(&error, double(a.delta), double(a.alpha));
        let e = &self.p.estimates;
        let believed = bias.zip_map(&axes(e.torque_tilt, e.torque_yaw), cut);
        let torque = self.torque(&error, &lifted, &t.omega, &omega_d, &omega_d_dot) - believed;
        let along = self.mass * command.u.dot(&axis);
        let h = self.period;
        Answer {
            thrust: along.max(self.least_thrust(&torque, scale)),
            torque,
            omega_d,
            omega_d_dot,
            filters: self.filtered(t.filters, feedback),
            force: [zeta, d + d_rate * h + d_second * (0.5 * h * h), d_rate + d_second * h],
            bias,
            scale,
            lag,
            lifted,
            lift,
        }
    }

    fn bandwidths(&self) -> (Vector3<f64>, Vector3<f64>) {
        let p = &self.p.position;
        (axes(p.k_f_across, p.k_f_vertical), axes(p.k_s_across, p.k_s_vertical))
    }

    /// Sections 2, 5 and 7: zeta, the averaged torque and the scale with what happened since the last tick.
    fn estimated(&self, t: &Tick, axis: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>, f64) {
        let Some(last) = t.last else { return (t.force[0], t.bias, t.scale) };
        let (e, h) = (&self.p.estimates, self.period);
        let middle = (last.axis + axis) / 2.0;
        let acceleration = (t.velocity - last.velocity) / h;
        let thrust = t.acted[0] / self.mass;

        let (c, y) = (middle.z * thrust, acceleration.z + self.gravity);
        let step = double(e.scale_rate) * h * (y - t.scale * c) * c / (thrust * thrust + LEAST_THRUST * LEAST_THRUST);
        let scale = (t.scale + cut(step, SCALE_RATE * h)).clamp(double(e.scale_least), double(e.scale_greatest));

        let drag = double(e.drag_across) * (t.velocity + last.velocity) / 2.0;
        let model = middle * (scale * thrust) - Vector3::new(drag.x, drag.y, self.gravity);
        let weight = |smoothing: f64| 1.0 - (-smoothing * h).exp();
        let smoothing = axes(e.force_smoothing_across, e.force_smoothing_vertical).map(weight);
        let zeta = t.force[0] + smoothing.component_mul(&(acceleration - model - t.force[0]));

        let omega = (last.omega + t.omega) / 2.0;
        let torque = Vector3::new(t.acted[1], t.acted[2], t.acted[3]) * scale;
        let observed = self.inertia * (t.omega - last.omega) / h + skew(omega) * self.inertia * omega - torque;
        (zeta, t.bias + (observed - t.bias) * weight(double(e.torque_smoothing)), scale)
    }

    /// Section 2: d''.
    fn generated(&self, zeta: &Vector3<f64>, d: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
        let e = &self.p.estimates;
        let (k, level) =
            (axes(e.force_bandwidth_across, e.force_bandwidth_vertical), axes(e.force_across, e.force_vertical));
        let most = axes(e.force_snap_across, e.force_snap_vertical);
        Vector3::from_fn(|i, _| {
            let wanted = cut(k[i] * k[i] * (cut(zeta[i], level[i]) - d[i]) - 2.0 * k[i] * rate[i], most[i]);
            (cut(rate[i] + wanted * self.period, most[i] / k[i]) - rate[i]) / self.period
        })
    }

    /// Section 1: the feedback.
    fn feedback(&self, t: &Tick) -> Vector3<f64> {
        let p = &self.p.position;
        let (k_f, k_s) = self.bandwidths();
        let [u_f, u_s] = t.filters;
        let z_1 = t.position_error
            + t.velocity_error.component_div(&k_f)
            + t.velocity_error.component_div(&k_s)
            + u_f.component_div(&k_f).component_div(&k_s);
        let z_2 = t.velocity_error + u_f.component_div(&k_f) + u_s.component_div(&k_s);
        let (k_p, k_v) = (double(p.k_p_across), double(p.k_v_across));
        let approach = saturate_across(k_p * z_1.xy(), k_v * double(p.v_across));
        let across = -saturate_across(approach + k_v * z_2.xy(), double(p.m_across));
        let (k_p, k_v) = (double(p.k_p_vertical), double(p.k_v_vertical));
        let speed = if z_1.z > 0.0 { p.v_down } else { p.v_up };
        let wanted = saturate(k_p * z_1.z, k_v * double(speed)) + k_v * z_2.z;
        let level = if wanted > 0.0 { p.m_down } else { p.m_up };
        Vector3::new(across.x, across.y, -saturate(wanted, double(level)))
    }

    /// Section 3: the frame that lags in heading, its motion, and chi and W a period later.
    fn lagging(&self, t: &Tick, command: &Command) -> (Matrix3<f64>, Vector3<f64>, Vector3<f64>, [f64; 2]) {
        let g = &self.p.heading;
        let (fastest, h) = (double(g.rate), self.period);
        let (_, papers, papers_rate) = command.differentiate();
        let [chi, turn] = t.lag.unwrap_or_else(|| [0.0, cut(papers.z, fastest)]);
        let chi_rate = turn - papers.z;
        let wanted = papers_rate.z - double(g.c_2) * chi_rate - 2.0 * double(g.c_1) * (chi / 2.0).sin();
        let reached = cut(turn + cut(wanted, double(g.acceleration)) * h, fastest);
        let turn_rate = (reached - turn) / h + t.turn_nudge;
        let chi_second = turn_rate - papers_rate.z;
        let frame = |e: f64| command.desired_attitude(e) * about_z(chi + chi_rate * e + chi_second * e * e / 2.0);
        let scale = command.fastest().max(chi_rate.abs()).max(chi_second.abs().sqrt());
        let (desired, omega_d, omega_d_dot) = differentiate(frame, scale);
        // The half angle moves along its tangent and is brought back to the circle.
        let next = chi + 2.0 * (0.5 * h * chi_rate).atan();
        (desired, omega_d, omega_d_dot, [next.sin().atan2(next.cos()), turn + turn_rate * h])
    }

    /// Section 4: the torque without the bias.
    fn torque(
        &self,
        error: &Matrix3<f64>,
        q: &Vector4<f64>,
        omega: &Vector3<f64>,
        omega_d: &Vector3<f64>,
        omega_d_dot: &Vector3<f64>,
    ) -> Vector3<f64> {
        let a = &self.p.attitude;
        let [w, eta, k_t, m_t, eta_t] = [a.w, a.eta, a.k_t, a.m_t, a.eta_t].map(double);
        let r = q[1].hypot(q[2]);
        let h = (q[0] + eta).hypot(q[3]);
        let g = m_t * k_t / (m_t.hypot(k_t * r) * ((1.0 - r * r).max(0.0) + eta_t * eta_t).sqrt());
        // The gradients of h and of r^2 along the body's rates.
        let of_h = Vector3::new((q[0] + eta) * q[1] + q[2] * q[3], (q[0] + eta) * q[2] - q[1] * q[3], eta * q[3]);
        let of_r = Vector3::new(q[0] * q[1] + q[2] * q[3], q[0] * q[2] - q[1] * q[3], 0.0);
        let rate = error.transpose() * omega_d;
        let turned = self.inertia * (error.transpose() * omega_d_dot) - skew(self.inertia * rate) * rate;
        let behind = omega - rate;
        let gain = double(a.k_omega_t) * (1.0 - double(a.ease) * r * r);
        let tilt = saturate_across(gain * behind.xy(), double(a.m_omega_t));
        let yaw = saturate(double(a.k_omega_z) * behind.z, double(a.m_omega_z));
        turned - of_h * (w / (2.0 * h)) - of_r * g - Vector3::new(tilt.x, tilt.y, yaw)
    }

    /// Section 6: N.
    pub fn least_thrust(&self, torque: &Vector3<f64>, scale: f64) -> f64 {
        let each = self
            .rotors
            .iter()
            .map(|(least, row)| (scale * least - Vector3::new(row[1], row[2], row[3]).dot(torque)) / row[0]);
        each.fold(0.0, f64::max) + double(self.p.floor_margin)
    }

    /// The filters a period later.
    fn filtered(&self, [mut u_f, mut u_s]: [Vector3<f64>; 2], feedback: Vector3<f64>) -> [Vector3<f64>; 2] {
        let (k_f, k_s) = self.bandwidths();
        let flow = |f: Vector3<f64>, s: Vector3<f64>| (k_f.component_mul(&(s - f)), k_s.component_mul(&(feedback - s)));
        let steps = 60;
        let h = self.period / f64::from(steps);
        for _ in 0..steps {
            let (f_1, s_1) = flow(u_f, u_s);
            let (f_2, s_2) = flow(u_f + f_1 * (h / 2.0), u_s + s_1 * (h / 2.0));
            let (f_3, s_3) = flow(u_f + f_2 * (h / 2.0), u_s + s_2 * (h / 2.0));
            let (f_4, s_4) = flow(u_f + f_3 * h, u_s + s_3 * h);
            u_f += (f_1 + 2.0 * f_2 + 2.0 * f_3 + f_4) * (h / 6.0);
            u_s += (s_1 + 2.0 * s_2 + 2.0 * s_3 + s_4) * (h / 6.0);
        }
        [u_f, u_s]
    }
}

/// Section 8: what was commanded, through delay and lag, in pieces between the moments at which the command that acts changes.
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

    /// A period with `command` given at its start; the mean over it.
    pub fn advance(&mut self, command: Vector4<f64>) -> Vector4<f64> {
        self.commands.push(command);
        let newest = self.commands.len() - 1;
        let whole = self.delay.floor();
        let late = (self.delay - whole) * self.period;
        let acts = |age: f64| self.commands[newest - age as usize];
        let mut sum = Vector4::zeros();
        for (duration, command) in [(late, acts(whole + 1.0)), (self.period - late, acts(whole))] {
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
}
