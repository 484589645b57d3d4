//! V_0 = 1/2 |z_2|^2 + the integral of s(phi(mu); M) . d mu of section 1, and what a force error does.

use crate::support::extended::{law, paper_vehicle, random_parameters};
use crate::support::random::{self, ChaCha8Rng};
use controller_core::extended::parameters::PositionParameters;
use controller_core::extended::position::PositionLaw;
use controller_core::heading::Heading;
use controller_core::position::FilterState;
use controller_core::reference::{Reference, Trajectory, hover::Hover};
use controller_core::state::State;
use nalgebra::{Quaternion, Vector3};

/// Position and velocity errors, u_f and u_s.
#[derive(Debug, Clone, Copy)]
struct Translation {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    u_f: Vector3<f64>,
    u_s: Vector3<f64>,
}

impl Translation {
    fn random(rng: &mut ChaCha8Rng, p: &PositionParameters) -> Self {
        let far = random::log_uniform(rng, 0.01, 100.0);
        let fast = random::log_uniform(rng, 0.01, 30.0);
        let filters = |rng: &mut ChaCha8Rng| {
            let (across, vertical) = (random::vector(rng, p.m_across), random::vector(rng, 1.0).x);
            let z = if vertical > 0.0 { vertical * p.m_up } else { vertical * p.m_down };
            Vector3::new(across.x, across.y, z).cast()
        };
        Self {
            position: random::vector(rng, far).cast(),
            velocity: random::vector(rng, fast).cast(),
            u_f: filters(rng),
            u_s: filters(rng),
        }
    }

    fn after(&self, flow: &Self, time: f64) -> Self {
        Self {
            position: self.position + flow.position * time,
            velocity: self.velocity + flow.velocity * time,
            u_f: self.u_f + flow.u_f * time,
            u_s: self.u_s + flow.u_s * time,
        }
    }

    fn filter(&self) -> FilterState {
        FilterState { filtered: self.u_f.cast(), intermediate: self.u_s.cast() }
    }

    fn state(&self) -> State {
        State {
            position: self.position.cast(),
            velocity: self.velocity.cast(),
            attitude: Quaternion::identity(),
            angular_velocity: Vector3::zeros(),
        }
    }
}

fn origin() -> Reference {
    Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0)
}

/// Bandwidths k_f, k_s of each axis.
fn bandwidths(p: &PositionParameters) -> [Vector3<f64>; 2] {
    [
        Vector3::new(p.k_f_across, p.k_f_across, p.k_f_vertical).cast(),
        Vector3::new(p.k_s_across, p.k_s_across, p.k_s_vertical).cast(),
    ]
}

/// z_1 and z_2 in double precision.
fn z(p: &PositionParameters, x: &Translation) -> [Vector3<f64>; 2] {
    let [k_f, k_s] = bandwidths(p);
    let both = k_f.map(|k| 1.0 / k) + k_s.map(|k| 1.0 / k);
    let z_1 = x.position + x.velocity.component_mul(&both) + x.u_f.component_div(&k_f.component_mul(&k_s));
    [z_1, x.velocity + x.u_f.component_div(&k_f) + x.u_s.component_div(&k_s)]
}

/// The closed loop with the core's feedback and a force error.
fn flow(law: &PositionLaw, p: &PositionParameters, x: &Translation, force: &Vector3<f64>) -> Translation {
    let feedback = law.feedback(&x.state(), &origin(), &x.filter()).feedback;
    let [k_f, k_s] = bandwidths(p);
    Translation {
        position: x.velocity,
        velocity: x.u_f + force,
        u_f: k_f.component_mul(&(x.u_s - x.u_f)),
        u_s: k_s.component_mul(&(feedback.cast() - x.u_s)),
    }
}

/// s(phi(mu); M) along a half-line: inner gain and level, outer level.
fn approached(mu: f64, gain: f64, inner: f64, outer: f64) -> f64 {
    let s = |x: f64, level: f64| level * x / level.hypot(x);
    s(s(gain * mu, inner), outer)
}

/// Its integral from zero: substituted so that neither end is steep, by Simpson's rule.
fn integral(to: f64, gain: f64, inner: f64, outer: f64) -> f64 {
    // mu = (inner / gain) sinh x.
    let scale = inner / gain;
    let end = (to / scale).asinh();
    let steps = 200;
    let width = end / f64::from(steps);
    let f = |x: f64| approached(scale * x.sinh(), gain, inner, outer) * scale * x.cosh();
    (0..steps)
        .map(|i| {
            let left = width * f64::from(i);
            (f(left) + 4.0 * f(left + 0.5 * width) + f(left + width)) * width / 6.0
        })
        .sum()
}

fn v_0(p: &PositionParameters, x: &Translation) -> f64 {
    let [z_1, z_2] = z(p, x);
    let d = f64::from;
    let (k_h, k_z) = (d(p.k_v_across), d(p.k_v_vertical));
    let across = integral(z_1.xy().norm(), d(p.k_p_across), k_h * d(p.v_across), d(p.m_across));
    let (speed, level) = if z_1.z > 0.0 { (p.v_down, p.m_down) } else { (p.v_up, p.m_up) };
    let vertical = integral(z_1.z.abs(), d(p.k_p_vertical), k_z * d(speed), d(level));
    0.5 * z_2.norm_squared() + across + vertical
}

#[test]
fn v_0_never_rises_along_flows() {
    let mut rng = random::generator(311);
    let mut falls = 0;
    for number in 0..5_000 {
        let p = random_parameters(&mut rng).position;
        let x = Translation::random(&mut rng, &p);
        let along = flow(&PositionLaw::new(&p, 0.01).unwrap(), &p, &x, &Vector3::zeros());
        let step = 1e-5;
        let v_dot = (v_0(&p, &x.after(&along, step)) - v_0(&p, &x.after(&along, -step))) / (2.0 * step);
        let [_, z_2] = z(&p, &x);
        let level = f64::from(p.m_across.max(p.m_up).max(p.m_down));
        // Differences, and the core's rounding of z: where the feedback is steep, k_p of a rounding of 100 m.
        let steep = 6e-8 * (f64::from(p.k_p_across.max(p.k_p_vertical)) * (x.position.norm() + x.velocity.norm()));
        let allowed = z_2.norm() * (2e-6 * level + 4.0 * steep) + 1e-15 * v_0(&p, &x) / step;
        assert!(v_dot <= allowed, "case {number}: V_0' = {v_dot:e} beyond {allowed:e} at {x:?} with {p:?}");
        falls += u32::from(v_dot < -100.0 * allowed);
    }
    println!("V_0 falls beyond doubt in {falls} of 5000");
    assert!(falls > 4_500, "{falls}");
}

#[test]
fn v_0_never_rises_on_flights_and_they_arrive() {
    let mut rng = random::generator(312);
    let p = law(&paper_vehicle()).parameters.position;
    let position = PositionLaw::new(&p, 0.01).unwrap();
    for _ in 0..20 {
        let mut x = Translation::random(&mut rng, &p);
        let (mut energy, step) = (v_0(&p, &x), 2e-3);
        for tick in 0..30_000 {
            let still = Vector3::zeros();
            let half = 0.5 * step;
            let a = flow(&position, &p, &x, &still);
            let b = flow(&position, &p, &x.after(&a, half), &still);
            let c = flow(&position, &p, &x.after(&b, half), &still);
            let d = flow(&position, &p, &x.after(&c, step), &still);
            x = x.after(&a, step / 6.0).after(&b, step / 3.0).after(&c, step / 3.0).after(&d, step / 6.0);
            if tick % 20 == 0 {
                let after = v_0(&p, &x);
                assert!(after <= energy * (1.0 + 1e-6) + 1e-9, "V_0 rises from {energy} to {after} at tick {tick}");
                energy = after;
            }
        }
        assert!(x.position.norm() < 1e-3, "{x:?}");
    }
}

#[test]
fn under_a_force_error_z_1_moves_by_it_as_well() {
    let mut rng = random::generator(313);
    for _ in 0..5_000 {
        let p = random_parameters(&mut rng).position;
        let x = Translation::random(&mut rng, &p);
        let x = Translation { position: x.position / x.position.norm(), velocity: x.velocity / x.velocity.norm(), ..x };
        let force = random::vector(&mut rng, 5.0).cast::<f64>();
        let position = PositionLaw::new(&p, 0.01).unwrap();
        let along = flow(&position, &p, &x, &force);
        let [z_1, z_2] = z(&p, &x);
        let core = |x: &Translation| position.feedback(&x.state(), &origin(), &x.filter());
        assert!((core(&x).z_1.cast::<f64>() - z_1).norm() < 1e-5 * (1.0 + z_1.norm()));
        assert!((core(&x).z_2.cast::<f64>() - z_2).norm() < 1e-5 * (1.0 + z_2.norm()));
        // z is linear in the state, so that any step will do.
        let [after, before] = [0.5, -0.5].map(|time| z(&p, &x.after(&along, time)));
        let [k_f, k_s] = bandwidths(&p);
        let c = k_f.map(|k| 1.0 / k) + k_s.map(|k| 1.0 / k);
        let [z_1_dot, z_2_dot] = [after[0] - before[0], after[1] - before[1]];
        let moved = c.component_mul(&force);
        assert!((z_1_dot - z_2 - moved).norm() < 1e-9 * (1.0 + z_1_dot.norm()), "{z_1_dot} {z_2} {moved}");
        let feedback = core(&x).feedback.cast::<f64>();
        assert!((z_2_dot - feedback - force).norm() < 1e-9 * (1.0 + z_2_dot.norm()), "{z_2_dot} {feedback} {force}");
    }
}
