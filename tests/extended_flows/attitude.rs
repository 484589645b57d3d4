//! V = 1/2 omega~^T J omega~ + w (1 + eta - h) + U_t(r) of section 6, and the equilibria of the attitude loop.

use crate::support::extended::{law, random_configuration, random_parameters, vehicle};
use crate::support::oracle::lifting;
use crate::support::random::{self, ChaCha8Rng};
use controller_core::extended::attitude::{AttitudeFeedback, AttitudeLaw};
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::path_lifting::{self, Lift};
use nalgebra::{Quaternion, Vector3, Vector4};

/// V less its kinetic part, at a unit quaternion.
fn potential(p: &ExtendedParameters, q: &Vector4<f64>) -> f64 {
    let [w, eta, k_t, m_t, eta_t] = [p.w, p.eta, p.k_t, p.m_t, p.eta_t].map(f64::from);
    let h = (q[0] + eta).hypot(q[3]);
    // U_t in closed form: dU_t / ds = M k / sqrt((M^2 + k^2 s) (a - s)) with s = r^2.
    let (a, s) = (1.0 + eta_t * eta_t, q[1] * q[1] + q[2] * q[2]);
    let (level, gain) = (m_t * m_t, k_t * k_t);
    let angle = |s: f64| ((2.0 * gain * s + level - gain * a) / (gain * a + level)).asin();
    w * (1.0 + eta - h) + m_t * (angle(s) - angle(0.0))
}

/// By how much V falls at least across the switch.
fn least_fall(p: &ExtendedParameters) -> f64 {
    let (w, eta, qbar) = (f64::from(p.w), f64::from(p.eta), switch(p));
    2.0 * w * eta * qbar / (1.0 + 2.0 * eta * qbar + eta * eta).sqrt()
}

/// qbar.
fn switch(p: &ExtendedParameters) -> f64 {
    let square = (1.0 + f64::from(p.delta)).powi(2);
    (square - 1.0) / (square + 1.0)
}

/// q' = q (0, omega~) / 2.
fn spin(q: &Vector4<f64>, rate: &Vector3<f64>) -> Vector4<f64> {
    let vector = Vector3::new(q[1], q[2], q[3]);
    let v = (rate * q[0] + vector.cross(rate)) * 0.5;
    Vector4::new(-0.5 * vector.dot(rate), v.x, v.y, v.z)
}

fn quaternion(q: &Vector4<f64>) -> Quaternion<f32> {
    let q = q.cast::<f32>();
    Quaternion::new(q[0], q[1], q[2], q[3])
}

/// The loop in error coordinates: q and omega~, with omega_d and omega_d' given in the axes of the desired frame.
struct Loop {
    parameters: ExtendedParameters,
    inertia: Vector3<f64>,
    law: AttitudeLaw,
}

impl Loop {
    fn random(rng: &mut ChaCha8Rng) -> Self {
        let configuration = random_configuration(rng);
        let vehicle = configuration.vehicle();
        let parameters = random_parameters(rng, &law(&configuration).parameters, vehicle);
        Self::of(&parameters, &vehicle.inertia)
    }

    /// With the constants that follow from the vehicle's numbers, which are certified.
    fn certified(rng: &mut ChaCha8Rng) -> Self {
        let configuration = random_configuration(rng);
        Self::of(&law(&configuration).parameters, &configuration.vehicle().inertia)
    }

    fn of(parameters: &ExtendedParameters, inertia: &Vector3<f32>) -> Self {
        Self { parameters: *parameters, inertia: inertia.cast(), law: AttitudeLaw::new(parameters, inertia) }
    }

    /// The core's torque, and omega~'.
    fn turned(
        &self,
        q: &Vector4<f64>,
        rate_error: &Vector3<f64>,
        desired: &[Vector3<f64>; 2],
    ) -> (AttitudeFeedback, Vector3<f64>) {
        let back = lifting::rotation(q).transpose();
        let (velocity, acceleration) = (back * desired[0], back * desired[1]);
        let omega = rate_error + velocity;
        let feedback = self.law.feedback(&quaternion(q), &rate_error.cast());
        let momentum = self.inertia.component_mul(&omega);
        let torque: Vector3<f64> = self.law.torque(&feedback, &velocity.cast(), &acceleration.cast()).cast();
        let omega_dot = (momentum.cross(&omega) + torque).component_div(&self.inertia);
        // d/dt (R~^T omega_d) = R~^T omega_d' - omega~ x R~^T omega_d.
        (feedback, omega_dot - acceleration + rate_error.cross(&velocity))
    }

    /// lambda, from the damping that the core gives and what it would give without a bound.
    fn share(&self, q: &Vector4<f64>, rate_error: &Vector3<f64>, damping: &Vector3<f64>) -> f64 {
        let p = &self.parameters;
        let easing = (1.0 + (q[1].hypot(q[2]) / f64::from(p.r_0)).powi(2)).powf(0.25);
        damping.xy().norm() * easing / (f64::from(p.k_omega_t) * rate_error.xy().norm())
    }

    fn energy(&self, q: &Vector4<f64>, rate_error: &Vector3<f64>) -> f64 {
        0.5 * rate_error.dot(&self.inertia.component_mul(rate_error)) + potential(&self.parameters, q)
    }

    /// A lifted error anywhere above the switch.
    fn random_error(&self, rng: &mut ChaCha8Rng) -> Vector4<f64> {
        let q = lifting_vector(rng);
        if q[0] < -switch(&self.parameters) { -q } else { q }
    }
}

fn lifting_vector(rng: &mut ChaCha8Rng) -> Vector4<f64> {
    let q = random::attitude(rng);
    Vector4::new(q.w, q.i, q.j, q.k).cast::<f64>().normalize()
}

#[test]
fn v_falls_along_flows_by_what_the_damping_takes_and_nothing_else() {
    let mut rng = random::generator(301);
    let mut eased = 0;
    for number in 0..50_000 {
        let turning = Loop::random(&mut rng);
        let q = turning.random_error(&mut rng);
        let fast = random::log_uniform(&mut rng, 0.01, 30.0);
        let rate = random::vector(&mut rng, fast).cast::<f64>();
        let desired = [random::vector(&mut rng, 5.0).cast(), random::vector(&mut rng, 50.0).cast()];
        let (answer, acceleration) = turning.turned(&q, &rate, &desired);
        let step = 1e-5 / rate.norm();
        let along = |side: f64| potential(&turning.parameters, &(q + spin(&q, &rate) * (side * step)).normalize());
        let kinetic = rate.dot(&turning.inertia.component_mul(&acceleration));
        let v_dot = (along(1.0) - along(-1.0)) / (2.0 * step) + kinetic;
        let damped = -rate.dot(&answer.damping.cast());
        // Single precision rounds the torque's terms, differences those of the potential.
        let feed_forward = turning.inertia.max() * (desired[1].norm() + desired[0].norm_squared());
        let terms = f64::from(answer.potential.norm() + answer.damping.norm()) + feed_forward;
        let allowed = rate.norm() * (3e-6 * terms + 1e-6 * f64::from(turning.parameters.w));
        assert!(
            (v_dot - damped).abs() <= allowed,
            "case {number}: V' = {v_dot:e}, damping {damped:e}, at {q} and {rate}"
        );
        let most = f64::from(turning.parameters.m_all) * (1.0 + 1e-5);
        assert!(damped < 0.0 && f64::from(answer.tilt()) <= most, "case {number}: {answer:?}");
        eased += u32::from(turning.share(&q, &rate, &answer.damping.cast()) < 0.999);
    }
    println!("damping has less than it asks for in {eased} of 50000");
    assert!((1_000..45_000).contains(&eased), "{eased}");
}

/// A flight in small steps after a target that turns, from `q` and `rate`.
fn fly(turning: &Loop, mut q: Vector4<f64>, mut rate: Vector3<f64>, turn: &Vector3<f64>, time: f64) -> (u32, f64, f64) {
    let step = 5e-4;
    let motion = |time: f64| [turn * time.sin(), turn * time.cos()];
    let p = &turning.parameters;
    let scalar = path_lifting::switching_scalar(p.delta);
    let mut lift = Some(Lift { memory: quaternion(&q), sign: 1.0 });
    let (mut switches, start) = (0, turning.energy(&q, &rate));
    let mut energy = start;
    for tick in 0..(time / step) as u32 {
        let now = f64::from(tick) * step;
        let flow = |q: &Vector4<f64>, rate: &Vector3<f64>, late: f64| {
            (spin(q, rate), turning.turned(q, rate, &motion(now + late)).1)
        };
        let half = 0.5 * step;
        let (q_1, w_1) = flow(&q, &rate, 0.0);
        let (q_2, w_2) = flow(&(q + q_1 * half), &(rate + w_1 * half), half);
        let (q_3, w_3) = flow(&(q + q_2 * half), &(rate + w_2 * half), half);
        let (q_4, w_4) = flow(&(q + q_3 * step), &(rate + w_3 * step), step);
        q = (q + (q_1 + (q_2 + q_3) * 2.0 + q_4) * (step / 6.0)).normalize();
        rate += (w_1 + (w_2 + w_3) * 2.0 + w_4) * (step / 6.0);
        let after = turning.energy(&q, &rate);
        assert!(after <= energy + 1e-6 * (start + after), "V rises from {energy:e} to {after:e} at {now} s");
        energy = after;
        let lifted = path_lifting::lift(lift.as_ref(), &quaternion(&q), scalar, p.alpha);
        lift = Some(lifted.lift);
        if lifted.factor < 0.0 {
            q = -q;
            let after = turning.energy(&q, &rate);
            assert!(energy - after >= least_fall(p) * (1.0 - 1e-5), "V falls by {:e} only", energy - after);
            (energy, switches) = (after, switches + 1);
        }
    }
    (switches, start, energy)
}

#[test]
fn v_never_rises_on_flights_after_a_turning_target_and_the_error_dies_out() {
    let mut rng = random::generator(302);
    let (mut switches, mut slowest) = (0, 0.0_f64);
    for _ in 0..40 {
        let turning = Loop::certified(&mut rng);
        let q = turning.random_error(&mut rng);
        let rate = random::vector(&mut rng, 12.0).cast::<f64>();
        let turn = random::vector(&mut rng, 3.0).cast::<f64>();
        let (switched, start, end) = fly(&turning, q, rate, &turn, 40.0);
        switches += switched;
        slowest = slowest.max(end / start);
    }
    println!("{switches} switches; V falls to at most {slowest:.1e} of its start");
    assert!(switches >= 20 && slowest < 1e-3, "{switches} switches, V still at {slowest}");
}

/// The core's potential torque.
fn pull(p: &ExtendedParameters, q: &Vector4<f64>) -> Vector3<f64> {
    AttitudeLaw::new(p, &Vector3::repeat(1e-3)).feedback(&quaternion(q), &Vector3::zeros()).potential.cast()
}

/// The Hummingbird's constants.
fn hummingbird() -> ExtendedParameters {
    *law(&vehicle("hummingbird").configuration).parameters
}

/// w eta_t sqrt(1 - qbar^2) over 2 qbar M_t: above one where the certificate's row on the tilt holds.
fn tilt_row(p: &ExtendedParameters) -> f64 {
    let qbar = switch(p);
    f64::from(p.w * p.eta_t) * (1.0 - qbar * qbar).sqrt() / (2.0 * qbar * f64::from(p.m_t))
}

/// The least torque over a dense grid of errors above the switch, over the distance to the target, relative to w.
fn least_pull(p: &ExtendedParameters) -> f64 {
    let qbar = switch(p);
    let mut least = f64::INFINITY;
    for i in 0..=200 {
        // Towards the target in ever smaller steps.
        let q_0 = 1.0 - (1.0 + qbar) * (f64::from(i + 1) / 201.0).powi(3);
        let length = (1.0 - q_0 * q_0).sqrt();
        for j in -100..=100 {
            let height = f64::from(j) / 100.0;
            let r = (1.0 - height * height).sqrt();
            // The law is the same for every direction of the tilt.
            let q = Vector4::new(q_0, length * r, 0.0, length * height);
            least = least.min(pull(p, &q).norm() / length);
        }
    }
    least / f64::from(p.w * p.eta)
}

#[test]
fn the_only_equilibrium_is_the_target_while_the_certificates_rows_hold() {
    let mut rng = random::generator(303);
    let (mut held, mut least) = (0, f64::INFINITY);
    while held < 60 {
        let p = Loop::random(&mut rng).parameters;
        if switch(&p) < 0.95 * f64::from(p.eta) && tilt_row(&p) > 1.05 {
            held += 1;
            let pull = least_pull(&p);
            least = least.min(pull);
            assert!(pull > 0.005, "a torque of {pull} of w eta with {p:?}");
        }
    }
    println!("least torque over the distance from the target: {least:.4} of w eta");
}

#[test]
fn without_the_tilts_row_there_is_another_equilibrium() {
    // From a row that holds to one that fails, by M_t alone.
    for excess in [1.05_f64, 1.5, 4.0] {
        let p = ExtendedParameters { delta: 0.3, eta: 0.4, eta_t: 1.0, k_t: 100.0, ..hummingbird() };
        let p = ExtendedParameters { m_t: (f64::from(p.m_t) * tilt_row(&p) * excess) as f32, ..p };
        // Without q_3 the torque is along the tilt: where it changes its sign there is no torque at all.
        let along = |q_0: f64| pull(&p, &Vector4::new(q_0, (1.0 - q_0 * q_0).sqrt(), 0.0, 0.0)).x;
        let (mut pushes, mut pulls) = (-switch(&p), 0.0);
        assert!(tilt_row(&p) < 1.0 && along(pushes) < 0.0 && along(pulls) > 0.0, "{excess}: {}", along(pushes));
        for _ in 0..60 {
            let middle = 0.5 * (pushes + pulls);
            if along(middle) < 0.0 { pushes = middle } else { pulls = middle }
        }
        let rest = pull(&p, &Vector4::new(pulls, (1.0 - pulls * pulls).sqrt(), 0.0, 0.0)).norm();
        assert!(rest < 1e-5 * f64::from(p.w), "{excess}: {rest} at q_0 = {pulls}");
    }
}

#[test]
fn without_the_switchs_row_the_torque_turns_round_within_reach() {
    let p = ExtendedParameters { delta: 0.3, eta: 0.1, m_t: 0.001, ..hummingbird() };
    let eta = f64::from(p.eta);
    assert!(switch(&p) > eta);
    let along = |q_0: f64| pull(&p, &Vector4::new(q_0, (1.0 - q_0 * q_0).sqrt(), 0.0, 0.0)).x;
    let half = 0.5 * f64::from(p.w);
    assert!(along(1e-4 - eta) > 0.9 * half && along(-1e-4 - eta) < -0.9 * half);
}
