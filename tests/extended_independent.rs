//! The core's extended law against the independent transcription in `support::extended::oracle`, tick by tick on flights of random
//! vehicles with random constants: thrown about, pushed by wind, with rotors that deliver what they like, through delay and lag.
//!
//! At every tick the oracle starts from what the core remembers and has to come to the same wrench, the same desired motion and
//! the same memory; what the core hides (what was commanded, the last state, for how long it learns nothing) it keeps for
//! itself. The tolerances are derived from the rounding of single precision in `support::extended::rounding`.

use crate::support::body::Body;
use crate::support::extended::oracle::{Acting, Answer, Last, Law, Tick};
use crate::support::extended::rounding::{NAMES, distances, tolerances};
use crate::support::extended::{around_the_example, law};
use crate::support::oracle::lifting;
use crate::support::oracle::rounding::vector4;
use crate::support::random::{self, ChaCha8Rng};
use controller_core::certificate::configuration::{Configuration, ExtendedLaw};
use controller_core::extended::actuators::ActuatorParameters;
use controller_core::extended::memory::Memory;
use controller_core::heading::Heading;
use controller_core::law::Law as Flown;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use nalgebra::{Vector2, Vector3, Vector4};
use rand::RngExt;

/// Control period, s.
const PERIOD: f32 = 0.01;

/// Where q_0 of the attitude error is this near to the switch, either side of it is accepted.
const EITHER_SIDE: f64 = 1e-5;

/// A vehicle with rotors that lag and answer late, or at once.
fn configuration(rng: &mut ChaCha8Rng) -> Configuration {
    let base = around_the_example(rng);
    let mut time = |most: f32| if rng.random_bool(0.3) { 0.0 } else { rng.random_range(0.001..most) };
    let actuators = ActuatorParameters { lag: time(0.06), delay: time(0.028) };
    let law = ExtendedLaw { actuators, ..law(&base) };
    let rotors = base.rotors().unwrap().clone();
    let extended = Configuration::extended(*base.vehicle(), *base.limits(), law, *base.bounds()).unwrap();
    if rng.random_bool(0.2) { extended } else { extended.with_rotors(rotors).unwrap() }
}

fn reference(rng: &mut ChaCha8Rng, configuration: &Configuration) -> Reference {
    let room = configuration.vehicle().gravity - configuration.greatest_fall();
    let (sin, cos) = rng.random_range(-3.2_f32..3.2).sin_cos();
    let turning = [rng.random_range(-3.0..3.0), rng.random_range(-8.0..8.0)];
    let mut acceleration = random::vector(rng, 3.0);
    acceleration.z = rng.random_range(-0.7..0.7) * room;
    Reference {
        position: random::vector(rng, 20.0),
        velocity: random::vector(rng, 3.0),
        acceleration,
        jerk: random::vector(rng, 5.0),
        snap: random::vector(rng, 10.0),
        heading: Heading::new(Vector2::new(cos, sin), turning[0], turning[1]).unwrap(),
    }
}

/// What the core cannot be asked for.
struct Hidden {
    last: Option<Last>,
    held: u32,
    acting: Acting,
    acted: Vector4<f64>,
}

impl Hidden {
    fn new(oracle: &Law, actuators: &ActuatorParameters) -> Self {
        let hover = Vector4::new(oracle.mass * oracle.gravity, 0.0, 0.0, 0.0);
        let ActuatorParameters { lag, delay } = *actuators;
        Self { last: None, held: 0, acting: Acting::new(lag, delay, PERIOD, hover), acted: hover }
    }
}

/// The tick ahead, in the oracle's terms.
fn tick(memory: &Memory, hidden: &Hidden, state: &State, reference: &Reference) -> Tick {
    let double = |v: &Vector3<f32>| v.cast::<f64>();
    let nu = reference.heading.direction();
    let force = &memory.estimates.force;
    Tick {
        position_error: double(&state.position) - double(&reference.position),
        velocity_error: double(&state.velocity) - double(&reference.velocity),
        velocity: double(&state.velocity),
        rotation: lifting::rotation(&vector4(&state.attitude)),
        omega: double(&state.angular_velocity),
        reference: [reference.velocity, reference.acceleration, reference.jerk, reference.snap].map(|d| double(&d)),
        heading: [
            f64::from(nu.y).atan2(nu.x.into()),
            reference.heading.rate().into(),
            reference.heading.acceleration().into(),
        ],
        filters: [double(&memory.filter.filtered), double(&memory.filter.intermediate)],
        lag: memory.heading.map(|lag| {
            let half = lag.half_angle.cast::<f64>();
            [2.0 * half.y.atan2(half.x), lag.rate.into()]
        }),
        lift: memory.lift.map(|lift| lifting::Lift { memory: vector4(&lift.memory), sign: lift.sign.into() }),
        force: [double(&force.average), double(&force.value), double(&force.rate)],
        bias: double(&memory.estimates.torque),
        scale: memory.estimates.scale.into(),
        last: hidden.last.filter(|_| hidden.held == 0),
        acted: hidden.acted,
        nudge: [Vector3::zeros(); 3],
        turn_nudge: 0.0,
    }
}

/// What the core came to. The lift is compared by itself: here it is the oracle's.
fn of_core(memory: &Memory, wrench: &Wrench, desired: [Vector3<f32>; 2], answer: &Answer) -> Answer {
    let double = |v: &Vector3<f32>| v.cast::<f64>();
    let (force, lag) = (&memory.estimates.force, memory.heading.unwrap());
    let half = lag.half_angle.cast::<f64>();
    Answer {
        thrust: wrench.thrust.into(),
        torque: double(&wrench.torque),
        omega_d: double(&desired[0]),
        omega_d_dot: double(&desired[1]),
        filters: [double(&memory.filter.filtered), double(&memory.filter.intermediate)],
        force: [double(&force.average), double(&force.value), double(&force.rate)],
        bias: double(&memory.estimates.torque),
        scale: memory.estimates.scale.into(),
        lag: [2.0 * half.y.atan2(half.x), lag.rate.into()],
        ..*answer
    }
}

/// What a flight showed.
#[derive(Default)]
struct Shown {
    /// The greatest error and the greatest share of its tolerance, each over [`NAMES`].
    worst: [(f64, f64); NAMES.len()],
    /// How often the lift switched.
    switches: u32,
    /// Ticks so near to the switch that neither wrench is wrong.
    either: u32,
}

/// One flight.
fn fly(rng: &mut ChaCha8Rng, ticks: u32, shown: &mut Shown) {
    let configuration = configuration(rng);
    let extended = law(&configuration);
    let vehicle = configuration.vehicle();
    let oracle = Law::new(vehicle, &extended.parameters, configuration.rotors(), PERIOD);
    let Flown::Extended(mut controller) = Flown::uncertified(&configuration, PERIOD).unwrap() else {
        panic!("another law")
    };
    let settling = ((extended.actuators.delay + 5.0 * extended.actuators.lag) / PERIOD) as u32 + 2;
    let mut hidden = Hidden::new(&oracle, &extended.actuators);
    let mut asked = reference(rng, &configuration);
    let mut body = Body::resting(asked.position.cast(), random::attitude(rng).cast());
    let (delivered, off, mut wind) = (rng.random_range(0.7..1.2), random::vector(rng, 0.02), Vector3::zeros());
    for number in 0..ticks {
        if rng.random_bool(0.02) {
            asked = reference(rng, &configuration);
            wind = random::vector(rng, 4.0).cast::<f64>();
        }
        if rng.random_bool(0.02) {
            body.attitude = random::attitude(rng).cast();
            body.angular_velocity = random::vector(rng, 10.0).cast();
            body.velocity = random::vector(rng, 8.0).cast();
            body.position = (asked.position + random::vector(rng, 10.0)).cast();
        }
        if rng.random_bool(0.01) {
            controller.hold_estimates();
            hidden.held = settling;
        }
        let state = body.state();
        let before = tick(controller.memory(), &hidden, &state, &asked);
        let answer = oracle.evaluate(&before);
        let (wrench, diagnostics) = controller.step(&state, &asked).unwrap();
        let desired = [diagnostics.desired_angular_velocity, diagnostics.desired_angular_acceleration];

        let far = f64::from(state.position.norm() + asked.position.norm());
        let fast = f64::from(state.velocity.norm() + asked.velocity.norm());
        let core = of_core(controller.memory(), &wrench, desired, &answer);
        let allowed = tolerances(&oracle, &before, &answer, far, fast);
        let lifted = vector4(&diagnostics.attitude_error);
        let scalar = f64::from(controller_core::path_lifting::switching_scalar(extended.parameters.attitude.delta));
        let either = (answer.lifted[0].abs() + scalar).abs() < EITHER_SIDE;
        shown.either += u32::from(either);
        if !either {
            let error = (lifted - answer.lifted).norm();
            assert!(error < 1e-5, "tick {number}: lifted to {lifted} instead of {}", answer.lifted);
            let memory = controller.memory().lift.unwrap();
            assert!(
                (vector4(&memory.memory) - answer.lift.memory).norm() < 1e-5
                    && f64::from(memory.sign) == answer.lift.sign
            );
            shown.switches += u32::from(before.lift.is_some_and(|lift| lift.sign != answer.lift.sign));
        }
        for (part, ((error, allowed), name)) in
            distances(&core, &answer).into_iter().zip(allowed).zip(NAMES).enumerate()
        {
            if either && matches!(name, "thrust" | "torque") {
                continue;
            }
            let what = format!("tick {number}: {name} is off by {error:e}, allowed {allowed:e}");
            assert!(error <= allowed, "{what}\n{core:?}\n{answer:?}\n{before:?}");
            let (most, share) = &mut shown.worst[part];
            (*most, *share) = (most.max(error), share.max(error / allowed));
        }

        let commanded = Vector4::new(wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z);
        hidden.acted = hidden.acting.advance(commanded.cast::<f64>() / core.scale);
        hidden.held = hidden.held.saturating_sub(1);
        let axis = before.rotation.column(2).into();
        hidden.last = Some(Last { velocity: before.velocity, axis, omega: before.omega });
        let acting = Wrench { thrust: wrench.thrust * delivered, torque: wrench.torque * delivered + off };
        body.advance(vehicle, &acting, f64::from(PERIOD), 4);
        body.velocity += wind * f64::from(PERIOD);
    }
}

#[test]
fn every_tick_of_random_flights_agrees_with_the_plain_transcription() {
    let mut rng = random::generator(401);
    let mut shown = Shown::default();
    for _ in 0..40 {
        fly(&mut rng, 150, &mut shown);
    }
    let Shown { worst, switches, either } = shown;
    for (name, (error, share)) in NAMES.iter().zip(worst) {
        println!("{name:9} worst error {error:.1e}, {share:.2} of what rounding allows");
    }
    println!("the lift switched {switches} times; {either} ticks were too near to a switch to tell");
    assert!(switches > 10 && either < 3, "{switches} switches, {either} at one");
}
