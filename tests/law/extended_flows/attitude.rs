//! V = 1/2 omega~_12^T J omega~_12 + the integral of |P| d theta of section 6: it falls by what the damping takes
//! and by nothing else, whatever the vehicle does about its thrust axis, and across half a turn.

use crate::support::body::Body;
use crate::support::extended::{law, random_configuration, random_parameters, with_constants, with_ideal_actuators};
use crate::support::random::{self, ChaCha8Rng};
use controller_core::certificate::Certificate;
use controller_core::configuration::Configuration;
use controller_core::extended::attitude::{AttitudeLaw, Tilt};
use controller_core::extended::budget::{TickBudget, TorqueBudget};
use controller_core::extended::parameters::{Extended, ExtendedParameters};
use controller_core::heading::Heading;
use controller_core::law::Law as Flown;
use controller_core::path_lifting::switching_magnitude;
use controller_core::reference::Reference;
use nalgebra::{Quaternion, Vector2, Vector3};
use rand::RngExt;

/// R(q)^T v.
fn back(q: &Quaternion<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    (q.conjugate() * Quaternion::from_imag(*v) * q).imag() / q.norm_squared()
}

/// A budget and the reserve that feedback leaves of it, N m.
fn budget(configuration: &Configuration) -> (TickBudget, f32) {
    let (p, inertia) = (law(configuration).parameters, configuration.vehicle().inertia);
    let budget = TorqueBudget::new(p.floor_margin, configuration.limits(), configuration.rotors());
    let scales = [p.scale_least, p.scale_greatest];
    (TickBudget::new(&budget, scales), inertia.x.max(inertia.y) * p.turn_reserve)
}

/// What one tick of the whole law commands, on flights that are thrown about: with the commanded torque beside the one
/// that is believed to act, V' is -lambda omega~ . D.
#[test]
fn v_falls_by_what_the_damping_takes_and_nothing_else() {
    let mut rng = random::generator(301);
    let (mut judged, mut short, mut eased) = (0, 0, 0);
    for _ in 0..200 {
        let configuration = with_ideal_actuators(&random_configuration(&mut rng));
        let Flown::Extended(mut controller) = Flown::uncertified(&configuration, 0.01).unwrap() else {
            panic!("another law")
        };
        let (budget, reserve) = budget(&configuration);
        let attitude = AttitudeLaw::new(&law(&configuration).parameters, &configuration.vehicle().inertia);
        let j: Vector3<f64> = configuration.vehicle().inertia.cast();
        let mut body = Body::resting(Vector3::zeros(), random::attitude(&mut rng).cast());
        let off = random::vector(&mut rng, 0.05);
        for tick in 0..200 {
            let nu = Vector2::new(1.0, 0.0);
            let heading = Heading::new(nu, rng.random_range(-3.0..3.0), rng.random_range(-5.0..5.0)).unwrap();
            let reference = Reference {
                velocity: random::vector(&mut rng, 1.0),
                acceleration: random::vector(&mut rng, 1.0),
                jerk: random::vector(&mut rng, 5.0),
                ..Reference::resting(Vector3::zeros(), heading)
            };
            if rng.random_bool(0.03) {
                body.attitude = random::attitude(&mut rng).cast();
                body.angular_velocity = random::vector(&mut rng, 15.0).cast();
                body.velocity = random::vector(&mut rng, 8.0).cast();
            }
            let state = body.state();
            let (wrench, shown) = controller.step(&state, &reference).unwrap();
            let (bias, scale) = (controller.estimates().torque, controller.thrust_scale());

            let omega: Vector3<f64> = state.angular_velocity.cast();
            let error = shown.desired_attitude.cast::<f64>().conjugate() * state.attitude.cast();
            // In the axes of the desired frame, which turns about rho as well.
            let (turn, change): (Vector3<f64>, Vector3<f64>) =
                (shown.desired_angular_velocity.cast(), shown.desired_angular_acceleration.cast());
            let omega_rho = Vector3::new(turn.x, turn.y, 0.0);
            let accelerated = Vector3::new(change.x, change.y, 0.0) + turn.cross(&omega_rho);
            let (r, r_rate) = (back(&error, &omega_rho), back(&error, &accelerated));
            let r_dot = r_rate - omega.cross(&r);
            let torque: Vector3<f64> = (wrench.torque + bias).cast();
            let omega_dot = (torque - omega.cross(&j.component_mul(&omega))).component_div(&j);
            let (behind, slope) = ((omega - r).xy(), (omega_dot - r_dot).xy());
            let [pull, damping]: [Vector2<f64>; 2] =
                [shown.attitude_feedback, shown.rate_feedback].map(|part| part.xy().cast());
            let v_dot = behind.dot(&(j.xy().component_mul(&slope) + pull));
            let damped = -behind.dot(&damping);

            let gyroscopic = attitude.gyroscopic(&r.cast(), &state.angular_velocity, &behind.cast()).norm();
            if bias.xy().norm() + pull.norm() as f32 + gyroscopic > budget.radius(scale) - reserve {
                short += 1;
            } else {
                judged += 1;
                eased += u32::from(behind.norm() > 1.0 && damping.norm() < 1e-4 * behind.norm());
                let spun = j.max() * (omega.norm() + r.norm()).powi(2);
                let terms = pull.norm() + damping.norm() + spun + j.max() * r_rate.norm() + torque.norm();
                let allowed = 2e-6 * behind.norm() * terms;
                assert!((v_dot - damped).abs() <= allowed, "{tick}: V' = {v_dot:e}, not {damped:e} to {allowed:e}");
                assert!(damped <= 0.0, "{tick}: {damped:e}");
            }
            let acting = controller_core::state::Wrench { torque: wrench.torque + off, ..wrench };
            body.advance(configuration.vehicle(), &acting, 0.01, 4);
        }
    }
    println!("{judged} ticks; in {short} the gyroscopic torque may not fit; hardly damped in {eased}");
    assert!(judged > 10_000 && short > 100, "{judged}, {short}");
}

/// The tilt's loop in continuous time, in a frame that turns with rho and about nothing else.
struct Loop {
    p: Extended,
    inertia: Vector3<f64>,
    law: AttitudeLaw,
    budget: TickBudget,
    reserve: f32,
    /// M, N m.
    level: f32,
    /// omega_rho = turn sin t, axes of the frame, rad/s.
    turn: Vector3<f64>,
}

/// What is integrated: the error, of length one, and omega.
type State = (Quaternion<f64>, Vector3<f64>);

fn after((q, omega): &State, (q_dot, omega_dot): &State, time: f64) -> State {
    (*q + *q_dot * time, omega + omega_dot * time)
}

impl Loop {
    /// Any hysteresis and any constants near the formulas'; the frame turns as far as the reserve always follows.
    fn random(rng: &mut ChaCha8Rng) -> Self {
        let configuration = random_configuration(rng);
        let (formulas, vehicle) = (law(&configuration).parameters, configuration.vehicle());
        let p = random_parameters(rng, &formulas, vehicle);
        let p = Extended::new(
            ExtendedParameters {
                turn_reserve: formulas.turn_reserve,
                m_tilt: formulas.m_tilt,
                delta: p.delta,
                r_0: p.r_0,
                k_tilt: p.k_tilt,
                k_omega_t: p.k_omega_t,
                ..*formulas
            },
            vehicle,
        )
        .unwrap();
        let (budget, reserve) = budget(&configuration);
        let level = p.m_tilt.min(budget.radius(1.0) - reserve);
        let most = p.turn_rate.min(p.turn_reserve);
        let along = random::direction(rng) * most;
        let turn = Vector3::new(along.x, along.y, 0.0).cast();
        Self {
            law: AttitudeLaw::new(&p, &vehicle.inertia),
            inertia: vehicle.inertia.cast(),
            p,
            budget,
            reserve,
            level,
            turn,
        }
    }

    fn tilt(&self, q: &Quaternion<f64>, side: Option<&Vector2<f32>>) -> Tilt {
        self.law.tilt(&q.cast(), side)
    }

    /// The flow with `yaw` N m about the thrust axis, and whether the gyroscopic torque fits.
    fn flow(&self, (q, omega): &State, side: Option<&Vector2<f32>>, time: f64, yaw: f64) -> (State, bool) {
        let (r, acceleration) = (back(q, &(self.turn * time.sin())), back(q, &(self.turn * time.cos())));
        let behind = omega - r;
        let (tilt, error) = (self.tilt(q, side), behind.xy().cast::<f32>());
        let mut spending = self.budget.spending(1.0);
        spending.spend(&-self.law.potential(&tilt, self.level), self.reserve);
        let fits = spending.spend(&self.law.gyroscopic(&r.cast(), &omega.cast(), &error), self.reserve) == 1.0;
        let share = spending.spend(&-self.law.damping(&tilt, &error), self.reserve);
        assert!(share > 0.0 || !fits || error.norm() == 0.0, "no damping at {q} and {omega}");
        spending.spend(&self.law.torque(&acceleration.cast()), 0.0);
        let torque: Vector3<f64> = spending.spent.cast().push(yaw);
        let spun = omega.cross(&self.inertia.component_mul(omega));
        ((*q * Quaternion::from_imag(behind) * 0.5, (torque - spun).component_div(&self.inertia)), fits)
    }

    /// The integral of |P| up to `theta`, by Simpson's rule.
    fn potential(&self, theta: f64) -> f64 {
        let (gain, level, steps) = (f64::from(self.p.k_tilt), f64::from(self.level), 100);
        let pull = |theta: f64| {
            let x = gain * (theta / 4.0).tan();
            level * x / level.hypot(x)
        };
        let width = theta / f64::from(steps);
        let part = |i| (pull(width * i) + 4.0 * pull(width * (i + 0.5)) + pull(width * (i + 1.0))) * width / 6.0;
        (0..steps).map(f64::from).map(part).sum()
    }

    fn v(&self, (q, omega): &State, tilt: &Tilt, time: f64) -> f64 {
        let behind = (omega - back(q, &(self.turn * time.sin()))).xy();
        0.5 * behind.dot(&self.inertia.xy().component_mul(&behind)) + self.potential(angle(tilt))
    }
}

/// theta, or theta_s.
fn angle(tilt: &Tilt) -> f64 {
    4.0 * tilt.mrp.cast::<f64>().norm().atan()
}

/// Whether the side is held: a side that is not is half as long as b reaches across.
fn is_held(tilt: &Tilt) -> bool {
    tilt.side.norm() > 0.75
}

#[test]
fn v_never_rises_whatever_yaw_does_across_half_a_turn_and_the_tilt_dies_out() {
    let mut rng = random::generator(302);
    let (mut switches, mut held, mut short, mut slowest) = (0, 0, 0, 0.0_f64);
    for number in 0..60 {
        let turning = Loop::random(&mut rng);
        let switch = switching_magnitude::<f64>(turning.p.delta);
        // Half of them begin within a tenth of half a turn and turn on.
        let attitude: Quaternion<f64> = random::attitude(&mut rng).cast().normalize();
        let beyond = random::direction(&mut rng).xy().normalize().cast::<f64>();
        let half = Quaternion::new(0.05, beyond.x, beyond.y, 0.0).normalize();
        let start = if number % 2 == 0 { attitude } else { half };
        let spin = random::vector(&mut rng, 15.0).cast::<f64>();
        let mut state = (
            start,
            if number % 2 == 0 { spin } else { Vector3::new(beyond.x, beyond.y, 0.0) * 8.0 + Vector3::z() * spin.z },
        );
        let (step, mut yaw) = (5e-4, 0.0);
        let mut tilt = turning.tilt(&state.0, None);
        let first = turning.v(&state, &tilt, 0.0);
        let mut v = first;
        for tick in 0..60_000 {
            let now = f64::from(tick) * step;
            if rng.random_bool(0.005) {
                // Cut to nothing, or anything.
                yaw = if rng.random_bool(0.3) { 0.0 } else { rng.random_range(-0.05..0.05) };
            }
            // A spin so fast that the gyroscopic torque fits no more ends after ten seconds.
            let fast = state.1.z.abs() > if now < 10.0 { 15.0 } else { 2.0 };
            let pushed = if fast { -0.05 * state.1.z.signum() } else { yaw };
            let side = Some(&tilt.side);
            let (a, fits) = turning.flow(&state, side, now, pushed);
            let (b, fits_b) = turning.flow(&after(&state, &a, 0.5 * step), side, now + 0.5 * step, pushed);
            let (c, fits_c) = turning.flow(&after(&state, &b, 0.5 * step), side, now + 0.5 * step, pushed);
            let (d, fits_d) = turning.flow(&after(&state, &c, step), side, now + step, pushed);
            let fits = fits && fits_b && fits_c && fits_d;
            state = [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)]
                .iter()
                .fold(state, |state, (flow, weight)| after(&state, flow, step * weight / 6.0));
            state.0 = state.0.normalize();
            let last = tilt;
            tilt = turning.tilt(&state.0, Some(&last.side));
            let next = turning.v(&state, &tilt, now + step);
            if !is_held(&last) && is_held(&tilt) {
                // Between two steps b has gone a little way round, so theta_s begins beyond theta by its square.
                let plain = 2.0 * f64::from(tilt.sine_squared).sqrt().asin();
                assert!(angle(&tilt) - plain < 1e-3);
                v += turning.potential(angle(&tilt)) - turning.potential(plain);
            }
            if fits {
                assert!(next <= v + 2e-6 * (first + v), "{number}: V rises from {v:e} to {next:e} at {now} s");
            }
            short += u32::from(!fits);
            held += u32::from(angle(&tilt) > std::f64::consts::PI);
            if tilt.mrp.dot(&last.mrp) < 0.0 && last.mrp.norm() > 1.0 {
                switches += 1;
                // By the pull over what the angle falls by, two thousandths of a second's turning aside.
                let fallen = angle(&last) - angle(&tilt);
                let least = 4.0 * switch.asin() * f64::from(turning.law.potential(&tilt, turning.level).norm());
                assert!(fallen > 4.0 * switch.asin() - 0.03, "{number}: the angle falls by {fallen}");
                assert!(v - next > least * (1.0 - 0.03 / fallen) - 1e-6 * first, "V falls by {:e} only", v - next);
            }
            v = next;
        }
        slowest = slowest.max(v / first);
    }
    println!(
        "{switches} switches, {held} steps beyond half a turn, {short} without room; V at most {slowest:.0e} of itself"
    );
    assert!(switches >= 20 && held > 1_000 && slowest < 1e-4, "{switches}, {held}, {slowest}");
}

#[test]
fn noise_smaller_than_the_hysteresis_never_makes_the_side_chatter() {
    let mut rng = random::generator(303);
    let configuration = random_configuration(&mut rng);
    let p = law(&configuration).parameters;
    let attitude = AttitudeLaw::new(&p, &configuration.vehicle().inertia);
    let within = 2.0 * switching_magnitude::<f64>(p.delta).asin() as f32;
    let mut switches = |amplitude: f32| {
        let mut side: Option<Vector2<f32>> = None;
        let mut last = Vector2::zeros();
        (0..5_000).fold(0, |switches, _| {
            // Half a turn about x, and a tilt from there.
            let by = random::direction(&mut rng).xy() * amplitude;
            let noise = Quaternion::new(1.0, 0.5 * by.x, 0.5 * by.y, 0.0).normalize();
            let tilt = attitude.tilt(&(noise * Quaternion::new(0.0, 1.0, 0.0, 0.0)), side.as_ref());
            let turned = tilt.mrp.dot(&last) < 0.0;
            (side, last) = (Some(tilt.side), tilt.mrp);
            switches + u32::from(turned)
        })
    };
    let (below, beyond) = (switches(0.95 * within), switches(3.0 * within));
    println!("within {within:.4} rad: {below} switches; three times that: {beyond}");
    assert!(below == 0 && beyond > 10, "{below}, {beyond}");
}

/// The side counts from half a turn: with a region that reaches a quarter turn, nothing would be zero at the target.
#[test]
fn at_the_target_nothing_pulls_whatever_hysteresis_is_allowed() {
    let mut rng = random::generator(304);
    let configuration = random_configuration(&mut rng);
    let (formulas, vehicle) = (law(&configuration).parameters, configuration.vehicle());
    for delta in [0.01, 0.1, 0.4, 0.5, 0.8, 1.0] {
        let Ok(p) = Extended::new(ExtendedParameters { delta, ..*formulas }, vehicle) else { continue };
        let tilt = AttitudeLaw::new(&p, &vehicle.inertia).tilt(&Quaternion::new(1.0, 1e-3, 0.0, 0.0), None);
        assert!(tilt.mrp.norm() < 1e-3, "delta = {delta} is allowed: {tilt:?}");
    }
}

/// Row D, of a bias at its level about both axes.
#[test]
fn the_greatest_bias_of_a_certified_vehicle_leaves_the_reserve() {
    let mut rng = random::generator(305);
    let (mut certified, mut most) = (0, 0.0_f32);
    while certified < 12 {
        let base = random_configuration(&mut rng);
        let (room, reserve) = budget(&base);
        let least = room.radius(law(&base).parameters.scale_least);
        let level = (least - reserve) * rng.random_range(0.3..1.0);
        let configuration = with_constants(&base, |p| p.torque_tilt = level);
        // Where the rotors decide, not the limits.
        let limits = configuration.limits().torque_max;
        if least > 0.7 * limits.x.min(limits.y) || !Certificate::new(&configuration).unwrap().holds() {
            continue;
        }
        certified += 1;
        let mut spending = room.spending(law(&base).parameters.scale_least);
        let bias = Vector2::new(level, if rng.random_bool(0.5) { level } else { -level });
        let share = spending.spend(&bias, 0.0);
        let left = spending.spend(&(bias.normalize() * reserve), 0.0);
        most = most.max(level / least);
        assert!(
            share == 1.0 && left == 1.0,
            "{level} of {least} N m about both axes: {share} of it, {left} of the reserve"
        );
    }
    println!("levels up to {most:.2} of the torque");
}
