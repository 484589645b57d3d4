//! The core against the independent transcription of the law in `oracle`: single ticks at random states and references,
//! and long sequences in which the memory of the path lifting and of the filters matters.
//!
//! The tolerances are derived from the rounding of single precision in `oracle::rounding`.

use crate::support::oracle;
use crate::support::oracle::rounding::{
    Answer, ULP, lift_tolerances, one_rounding_each, situation, tolerances, vector4,
};
use crate::support::oracle::{Law, lifting};
use crate::support::random;
use crate::support::random::ChaCha8Rng;
use controller_core::controller::{Controller, Memory};
use controller_core::gains::Gains;
use controller_core::path_lifting::Lift;
use controller_core::position::FilterState;
use controller_core::reference::Reference;
use controller_core::state::State;
use controller_core::vehicle::Vehicle;
use nalgebra::{Quaternion, Rotation3, Vector4};
use rand::RngExt;

/// Where |q_0| of the attitude error is below this, either lift is accepted.
const EITHER_LIFT: f64 = 1e-5;

/// The vehicle, the gains and what the core sees in one tick.
struct Case {
    law: Law,
    vehicle: Vehicle,
    gains: Gains,
    thrust_floor: Option<f32>,
    state: State,
    reference: Reference,
    memory: Memory,
}

/// A random tick; in one of four the attitude error is within 0.1 rad of a half turn, often extremely near.
fn random_case(rng: &mut ChaCha8Rng, vehicle: Vehicle, gains: Gains) -> Case {
    let thrust_floor = random::thrust_floor(rng, &vehicle, &gains);
    let law = Law { thrust_floor: thrust_floor.map(f64::from), ..Law::new(&vehicle, &gains) };
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
    Case { law, vehicle, gains, thrust_floor, state, reference, memory: Memory { filter, lift } }
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
    let mut controller = Controller::uncertified(case.vehicle, case.gains, case.thrust_floor, 0.01).unwrap();
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
    const FLIGHT_TICKS: usize = 400;
    const PERIOD_S: f32 = 0.01;
    let mut rng = random::generator(3);
    let (mut switches, mut follows) = (0, 0);
    for number in 0..60 {
        let table_i = number % 3 == 0;
        let vehicle = if table_i { random::paper_vehicle() } else { random::vehicle(&mut rng) };
        let gains = if table_i { random::paper_gains(&vehicle) } else { random::gains(&mut rng, &vehicle) };
        let law = Law::new(&vehicle, &gains);
        let mut plain = oracle::Controller::new(law, PERIOD_S.into());
        let mut core = Controller::uncertified(vehicle, gains, None, PERIOD_S).unwrap();
        let reference = random::reference(&mut rng, &vehicle, &gains);
        let mut state = random::state_around(&mut rng, &reference);
        let slowest = -(-law.k_f.min(law.k_s) * plain.period).exp_m1();
        let drift = 16.0 * ULP * law.m_p / (slowest * slowest);
        let mut greatest_turn = 0.0_f64;
        for tick in 0..FLIGHT_TICKS {
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
