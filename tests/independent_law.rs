//! The core against the independent transcription of the law in `oracle`: single ticks at random states and references,
//! and long sequences in which the memory of the path lifting and of the filters matters.
//!
//! Tolerance. Single precision cannot be asked for more than the exact answer to a slightly different question, so the
//! oracle is asked how far its own answer moves when each quantity the law reads or forms (each axis of p~, v~, u, u',
//! u'', psi with its derivatives, R, omega) moves by one rounding, 2^-24 of the magnitudes that were added up to form it,
//! one at a time. The sum of these movements is what one rounding everywhere can do. A quantity of the law is formed by
//! about ten operations, whose roundings add up like a random walk: sqrt(10) to [`ROUNDINGS`]. The worst found is 2.1.

mod oracle;
mod random;

use controller_core::controller::{Controller, Diagnostics, Memory};
use controller_core::gains::Gains;
use controller_core::path_lifting::Lift;
use controller_core::position::FilterState;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use controller_core::vehicle::Vehicle;
use nalgebra::{Matrix3, Quaternion, Rotation3, Vector3, Vector4};
use oracle::{Evaluation, Law, Situation, lifting};
use rand::RngExt;
use random::ChaCha8Rng;

/// One rounding of single precision, relative.
const ULP: f64 = 1.0 / 16_777_216.0;

/// How many roundings a quantity may collect.
const ROUNDINGS: f64 = 4.0;

/// Worst absolute error of the core's tanh, in roundings (its module states 2.0e-7).
const TANH: f64 = 3.4;

/// Where |q_0| of the attitude error is below this, either lift is accepted.
const EITHER_LIFT: f64 = 1e-5;

/// The vehicle, the gains and what the core sees in one tick.
struct Case {
    law: Law,
    vehicle: Vehicle,
    gains: Gains,
    state: State,
    reference: Reference,
    memory: Memory,
}

fn vector4(q: &Quaternion<f32>) -> Vector4<f64> {
    Vector4::new(q.w.into(), q.i.into(), q.j.into(), q.k.into())
}

/// The same tick in the oracle's terms: errors formed in f64, the attitude as a matrix, the heading as an angle.
fn situation(state: &State, reference: &Reference, filter: &FilterState) -> Situation {
    let cast = |v: &Vector3<f32>| v.cast::<f64>();
    let nu = reference.heading.direction();
    Situation {
        position_error: cast(&state.position) - cast(&reference.position),
        velocity_error: cast(&state.velocity) - cast(&reference.velocity),
        rotation: lifting::rotation(&vector4(&state.attitude)),
        angular_velocity: cast(&state.angular_velocity),
        acceleration: cast(&reference.acceleration),
        jerk: cast(&reference.jerk),
        snap: cast(&reference.snap),
        heading: [
            f64::from(nu.y).atan2(nu.x.into()),
            reference.heading.rate().into(),
            reference.heading.acceleration().into(),
        ],
        u_f: cast(&filter.filtered),
        u_s: cast(&filter.intermediate),
    }
}

/// What is compared, from either side.
#[derive(Clone, Copy)]
struct Answer {
    thrust: f64,
    omega_d: Vector3<f64>,
    omega_d_dot: Vector3<f64>,
    torque: Vector3<f64>,
}

impl Answer {
    fn of_oracle(law: &Law, e: &Evaluation, lifted: &Vector4<f64>) -> Self {
        let torque = law.torque(e, lifting::mrp(lifted));
        Self { thrust: e.thrust, omega_d: e.omega_d, omega_d_dot: e.omega_d_dot, torque }
    }

    fn of_core(wrench: &Wrench, diagnostics: &Diagnostics) -> Self {
        Self {
            thrust: wrench.thrust.into(),
            omega_d: diagnostics.desired_angular_velocity.cast(),
            omega_d_dot: diagnostics.desired_angular_acceleration.cast(),
            torque: wrench.torque.cast(),
        }
    }

    /// Distances in thrust, omega_d, omega_d' and torque.
    fn distances(&self, other: &Self) -> [f64; 4] {
        [
            (self.thrust - other.thrust).abs(),
            (self.omega_d - other.omega_d).norm(),
            (self.omega_d_dot - other.omega_d_dot).norm(),
            (self.torque - other.torque).norm(),
        ]
    }
}

/// `s` with one quantity at a time moved by one rounding.
fn one_rounding_each(law: &Law, state: &State, reference: &Reference, s: &Situation) -> Vec<Situation> {
    let abs = |a: &Vector3<f32>, b: &Vector3<f32>| a.cast::<f64>().abs() + b.cast::<f64>().abs();
    let (u_f, u_s) = (s.u_f.abs(), s.u_s.abs());
    let position = abs(&state.position, &reference.position);
    let velocity = abs(&state.velocity, &reference.velocity);
    // The terms that add up to k_p z_1 + k_v z_2, per unit of k_p.
    let z = position
        + velocity * (1.0 / law.k_f + 1.0 / law.k_s + law.k_v / law.k_p)
        + u_f * (1.0 / (law.k_s * law.k_f) + law.k_v / (law.k_p * law.k_f))
        + u_s * (law.k_v / (law.k_p * law.k_s));
    let gravity = Vector3::new(0.0, 0.0, law.gravity);
    // The terms that add up to u, u' and u''.
    let u = s.acceleration.abs() + gravity + u_f;
    let u_dot = s.jerk.abs() + law.k_f * (u_f + u_s);
    let from_feedback = law.k_f * law.k_s * law.m_p;
    let u_ddot = s.snap.abs()
        + law.k_f * law.k_f * (u_f + u_s)
        + law.k_f * law.k_s * u_s
        + Vector3::repeat(from_feedback * (1.0 + TANH / ROUNDINGS));
    let rate = Vector3::repeat(s.angular_velocity.norm());
    let mut moved = Vec::new();
    for axis in 0..3 {
        let along = |scale: Vector3<f64>| Vector3::ith(axis, ULP * scale[axis]);
        let turn: Matrix3<f64> = Rotation3::new(Vector3::ith(axis, ULP)).into_inner();
        moved.push(Situation { position_error: s.position_error + along(z), ..*s });
        moved.push(Situation { acceleration: s.acceleration + along(u), ..*s });
        moved.push(Situation { jerk: s.jerk + along(u_dot), ..*s });
        moved.push(Situation { snap: s.snap + along(u_ddot), ..*s });
        moved.push(Situation { angular_velocity: s.angular_velocity + along(rate), ..*s });
        moved.push(Situation { rotation: s.rotation * turn, ..*s });
        let mut heading = s.heading;
        heading[axis] += ULP * if axis == 0 { 1.0 } else { heading[axis].abs() };
        moved.push(Situation { heading, ..*s });
    }
    moved
}

/// What `ROUNDINGS` roundings everywhere can do to the answer.
fn tolerances(law: &Law, moved: &[Situation], e: &Evaluation, lifted: &Vector4<f64>) -> [f64; 4] {
    let nominal = Answer::of_oracle(law, e, lifted);
    // The results' own last roundings.
    let (rate, acceleration) = (e.omega_d.norm(), e.omega_d_dot.norm() + e.omega_d.norm_squared());
    let torque = law.inertia.max() * acceleration + law.m_theta + law.m_omega;
    let mut sums = [nominal.thrust, rate, acceleration, torque].map(|scale| scale * ULP);
    for situation in moved {
        let e = law.evaluate(situation);
        let answer = Answer::of_oracle(law, &e, &lifting::nearest(lifted, &e.error));
        for (sum, distance) in sums.iter_mut().zip(answer.distances(&nominal)) {
            *sum += distance;
        }
    }
    sums.map(|sum| ROUNDINGS * sum)
}

/// What the same roundings can do to the lifted quaternion and to theta~.
fn lift_tolerances(law: &Law, moved: &[Situation], lifted: &Vector4<f64>) -> [f64; 2] {
    let mut sums = [ULP; 2];
    for situation in moved {
        let other = lifting::nearest(lifted, &law.evaluate(situation).error);
        sums[0] += (other - lifted).norm();
        sums[1] += (lifting::mrp(&other) - lifting::mrp(lifted)).norm();
    }
    sums.map(|sum| ROUNDINGS * sum)
}

/// A random tick; in one of four the attitude error is within 0.1 rad of a half turn, often extremely near.
fn random_case(rng: &mut ChaCha8Rng, vehicle: Vehicle, gains: Gains) -> Case {
    let law = Law::new(&vehicle, &gains);
    let reference = random::reference(rng, &vehicle, &gains);
    let mut state = random::state_around(rng, &reference);
    let filter = FilterState { filtered: random::in_box(rng, gains.m_p), intermediate: random::in_box(rng, gains.m_p) };
    if rng.random_bool(0.25) {
        let desired = law.evaluate(&situation(&state, &reference, &filter)).desired;
        let short: f32 = if rng.random_bool(0.1) { 0.0 } else { random::log_uniform(rng, 1e-9, 0.1) };
        let angle = std::f64::consts::PI - f64::from(short) * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let error = Rotation3::new(random::direction(rng).cast::<f64>() * angle).into_inner();
        let q = lifting::lifts(&(desired * error))[0].cast::<f32>();
        state.attitude = Quaternion::new(q[0], q[1], q[2], q[3]);
    }
    let lift = rng
        .random_bool(0.5)
        .then(|| Lift { memory: random::attitude(rng), sign: if rng.random_bool(0.5) { 1.0 } else { -1.0 } });
    Case { law, vehicle, gains, state, reference, memory: Memory { filter, lift } }
}

/// How far core and oracle are apart in thrust, omega_d, omega_d' and torque: in SI units, and over the tolerance.
struct Distance {
    errors: [f64; 4],
    ratios: [f64; 4],
}

impl Distance {
    fn agrees(&self) -> bool {
        self.ratios.iter().all(|ratio| *ratio <= 1.0)
    }
}

/// The distance, or a description of what disagrees.
fn compare(case: &Case) -> Result<Distance, String> {
    let law = &case.law;
    let mut controller = Controller::new(case.vehicle, case.gains, 0.01).unwrap();
    controller.restore(case.memory);
    let (wrench, diagnostics) = controller.step(&case.state, &case.reference).map_err(|e| e.to_string())?;
    let s = situation(&case.state, &case.reference, &case.memory.filter);
    let e = law.evaluate(&s);
    let before = match case.memory.lift {
        Some(lift) => lifting::Lift { memory: vector4(&lift.memory), sign: lift.sign.into() },
        None => lifting::Lift::initial(&e.error),
    };
    let (_, lifted) = before.advance(&e.error, law.delta, law.alpha);
    let moved = one_rounding_each(law, &case.state, &case.reference, &s);
    let core = Answer::of_core(&wrench, &diagnostics);
    let distance = |lifted: &Vector4<f64>| {
        let allowed = tolerances(law, &moved, &e, lifted);
        let errors = Answer::of_oracle(law, &e, lifted).distances(&core);
        Distance { errors, ratios: std::array::from_fn(|i| errors[i] / allowed[i]) }
    };
    let mut found = distance(&lifted);
    if !found.agrees() && lifted[0].abs() < EITHER_LIFT {
        found = distance(&-lifted);
    }
    if found.agrees() {
        Ok(found)
    } else {
        Err(format!("error / tolerance (thrust, omega_d, omega_d', torque) = {:?}, lift {lifted:?}", found.ratios))
    }
}

/// Runs `compare` on `count` cases and prints the worst distances.
fn compare_many(seed: u64, count: usize, mut configuration: impl FnMut(&mut ChaCha8Rng) -> (Vehicle, Gains)) {
    let mut rng = random::generator(seed);
    let (mut errors, mut ratios) = ([0.0_f64; 4], [0.0_f64; 4]);
    for number in 0..count {
        let (vehicle, gains) = configuration(&mut rng);
        let case = random_case(&mut rng, vehicle, gains);
        let found = compare(&case).unwrap_or_else(|what| {
            panic!("case {number}: {what}\n{:?}\n{:?}\n{:?}\n{gains:?}", case.state, case.reference, case.memory)
        });
        errors = std::array::from_fn(|i| errors[i].max(found.errors[i]));
        ratios = std::array::from_fn(|i| ratios[i].max(found.ratios[i]));
    }
    println!("{count} cases; thrust [N], omega_d [rad/s], omega_d' [rad/s^2], torque [N m]:");
    let errors = errors.map(|error| format!("{error:.1e}"));
    println!("  worst error {errors:?}, worst error / tolerance {ratios:.3?}");
}

#[test]
fn a_tick_with_table_i_agrees_with_the_plain_transcription() {
    let vehicle = random::paper_vehicle();
    let gains = random::paper_gains(&vehicle);
    compare_many(1, 12_000, |_| (vehicle, gains));
}

#[test]
fn a_tick_with_random_vehicles_and_gains_agrees_with_the_plain_transcription() {
    compare_many(2, 12_000, |rng| {
        let vehicle = random::vehicle(rng);
        (vehicle, random::gains(rng, &vehicle))
    });
}

/// Bodies that tumble for hundreds of ticks: with the rotation given, every decision of the path lifting depends on the
/// ones before. The oracle's filters run on by themselves; an exact step of the core's rounds by a few ulp of M_p and
/// forgets them at the rate of the slower filter, which bounds how far the two drift apart.
#[test]
fn memory_agrees_with_the_plain_transcription_along_hundreds_of_ticks() {
    const TICKS: usize = 400;
    const PERIOD: f32 = 0.01;
    let mut rng = random::generator(3);
    let (mut switches, mut follows) = (0, 0);
    for number in 0..60 {
        let table_i = number % 3 == 0;
        let vehicle = if table_i { random::paper_vehicle() } else { random::vehicle(&mut rng) };
        let gains = if table_i { random::paper_gains(&vehicle) } else { random::gains(&mut rng, &vehicle) };
        let law = Law::new(&vehicle, &gains);
        let mut plain = oracle::Controller::new(law, PERIOD.into());
        let mut core = Controller::new(vehicle, gains, PERIOD).unwrap();
        let reference = random::reference(&mut rng, &vehicle, &gains);
        let mut state = random::state_around(&mut rng, &reference);
        let slowest = -(-law.k_f.min(law.k_s) * plain.period).exp_m1();
        let drift = 16.0 * ULP * law.m_p / (slowest * slowest);
        let mut greatest_turn = 0.0_f64;
        for tick in 0..TICKS {
            // An eighth of the ticks changes the spin, so that the error turns back as well as round and round.
            if rng.random_bool(0.125) {
                state.angular_velocity = random::vector(&mut rng, 20.0);
                state.position = reference.position + random::vector(&mut rng, 3.0);
                state.velocity = reference.velocity + random::vector(&mut rng, 3.0);
            }
            let turn = Rotation3::new(state.angular_velocity.cast::<f64>() * plain.period).into_inner();
            let q = lifting::lifts(&(lifting::rotation(&vector4(&state.attitude)) * turn))[tick % 2].cast::<f32>();
            state.attitude = Quaternion::new(q[0], q[1], q[2], q[3]);

            let (before, lift_before) = (core.memory().filter, plain.lift);
            let (wrench, diagnostics) = core.step(&state, &reference).unwrap();
            // The torque at the core's own filter states; the lift and the filters with the plain controller's memory.
            let s = situation(&state, &reference, &before);
            let e = law.evaluate(&s);
            let lifted = lifting::nearest(&plain.tick(&s).1, &e.error);
            let moved = one_rounding_each(&law, &state, &reference, &s);
            let place = format!("sequence {number}, tick {tick}");
            let errors = Answer::of_oracle(&law, &e, &lifted).distances(&Answer::of_core(&wrench, &diagnostics));
            let allowed = tolerances(&law, &moved, &e, &lifted);
            assert!(errors.iter().zip(allowed).all(|(error, most)| *error <= most), "{place}: {errors:?} {allowed:?}");

            let (ours, theirs) = (plain.lift.unwrap(), core.memory().lift.unwrap());
            assert_eq!(ours.sign, f64::from(theirs.sign), "{place}: m*");
            let theta = (diagnostics.mrp.cast::<f64>() - lifting::mrp(&lifted)).norm();
            let [turn, most] = lift_tolerances(&law, &moved, &lifted);
            assert!(theta <= most, "{place}: theta {theta:e} apart, {most:e} allowed");
            // q_hat is a lift of this tick or of one before.
            greatest_turn = greatest_turn.max(turn);
            let apart = (vector4(&theirs.memory) - ours.memory).norm();
            assert!(apart <= greatest_turn, "{place}: q_hat {apart:e} apart, {greatest_turn:e} allowed");
            let FilterState { filtered, intermediate } = core.memory().filter;
            for (theirs, ours) in [filtered, intermediate].iter().zip(plain.x_f) {
                let apart = (theirs.cast::<f64>() - ours).norm();
                assert!(apart <= drift, "{place}: filters {apart:e} apart, {drift:e} allowed");
            }
            if let Some(before) = lift_before {
                switches += u32::from(before.sign != ours.sign);
                follows += u32::from(before.memory != ours.memory);
            }
        }
    }
    println!("m* switched {switches} times, q_hat followed {follows} times");
    assert!(switches > 200 && follows > 200, "the sequences must exercise both jumps");
}
