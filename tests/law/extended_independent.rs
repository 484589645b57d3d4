//! The core's extended law against the independent transcription in `support::extended::oracle`, tick by tick on
//! flights of random vehicles with random constants: thrown about, pushed by wind, with rotors that deliver what they
//! like, through delay and lag; every other one of them with an accelerometer and rotor speeds, and with nonsense from
//! these.
//!
//! At every tick the oracle starts from what the core remembers and has to come to the same wrench, the same desired
//! motion and the same memory; what the core hides (what was commanded, the last state, for how long it learns nothing,
//! the fallback's clock) it keeps for itself. The tolerances are derived from the rounding of single precision in
//! `support::extended::rounding`.
//!
//! Nearly every branch meets its neighbour continuously, so a tick at an edge is no tie: either side is right to within
//! its rounding. Only the lift jumps, at its switch, and the side that is held near half a turn. Ticks within
//! [`EITHER_SIDE`] of such an edge are compared in what does not depend on it, and counted.

use crate::support::body::Body;
use crate::support::extended::oracle::Law;
use crate::support::extended::oracle::acting::{Acting, Speeds};
use crate::support::extended::oracle::estimates::Averages;
use crate::support::extended::oracle::fallback::Fallback;
use crate::support::extended::oracle::tick::{Answer, BRANCHES, Last, Nudge, Tick};
use crate::support::extended::rounding::{ACCELERATION_PLACE, NAMES, Scales, distances, tolerances};
use crate::support::extended::{around_the_formulas, law, random_configuration, vehicle};
use crate::support::oracle::lifting;
use crate::support::oracle::rounding::{ROUNDINGS_MAX, vector4};
use crate::support::random::{self, ChaCha8Rng};
use controller_core::configuration::Configuration;
use controller_core::controller::Diagnostics;
use controller_core::extended::measured::Measured;
use controller_core::extended::memory::Memory;
use controller_core::extended::position::Filters;
use controller_core::heading::Heading;
use controller_core::law::Law as Flown;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use nalgebra::{Quaternion, Vector2, Vector3, Vector4};
use rand::RngExt;

/// Where a tick is this near to an edge at which the answer jumps, either side of it is accepted.
const EITHER_SIDE: f64 = 1e-5;

/// What such a tick cannot change.
const UNCHANGED_MEMORY: [&str; 7] = ["omega_d", "y", "zeta", "bias", "averages", "scale", "x"];

fn reference(rng: &mut ChaCha8Rng, configuration: &Configuration) -> Reference {
    let room = configuration.vehicle().gravity - configuration.max_fall();
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

/// State that the core does not expose.
struct Hidden {
    last: Option<Last>,
    held: u32,
    acting: Acting,
    acted: Vector4<f64>,
    fallback: Fallback,
    /// What the last tick's acceleration fed forward is known to, rad/s^2, if it was compared.
    forward: Option<f64>,
}

/// The tick ahead, in the oracle's terms.
fn tick(memory: &Memory, hidden: &Hidden, state: &State, reference: &Reference) -> Tick {
    let double = |v: &Vector3<f32>| v.cast::<f64>();
    let nu = reference.heading.direction();
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
        filters: filters(memory),
        lift: memory.lift.map(|lift| lifting::Lift { memory: vector4(&lift.memory), sign: lift.sign.into() }),
        side: memory.side.map(|side| side.cast()),
        yaw_room: memory.yaw_torque_left.into(),
        averages: averages(memory),
        fallback: hidden.fallback,
        last: hidden.last,
        held: hidden.held > 0,
        felt: None,
        acted: hidden.acted,
        pending: hidden.acting.pending(),
        nudge: Nudge::default(),
    }
}

fn filters(memory: &Memory) -> [Vector3<f64>; 3] {
    let Filters { command, intermediate, smoothed } = memory.filters;
    [command, intermediate, smoothed].map(|filter| filter.cast())
}

fn averages(memory: &Memory) -> Averages {
    let double = |v: &Vector3<f32>| v.cast::<f64>();
    let scale = &memory.averages.scale;
    Averages {
        force: double(&memory.averages.force),
        bias: double(&memory.averages.torque),
        slow: scale.slow.map(|slow| slow.map(|x| double(&x))),
        scale: scale.scale.into(),
        offset: double(&memory.averages.offset),
    }
}

/// What the core came to. The lift is compared by itself: here it is the oracle's.
fn of_core(memory: &Memory, wrench: &Wrench, shown: &Diagnostics, answer: &Answer) -> Answer {
    let double = |v: &Vector3<f32>| v.cast::<f64>();
    let side = memory.side.unwrap().cast::<f64>();
    Answer {
        thrust: wrench.thrust.into(),
        torque: double(&wrench.torque),
        pull: double(&shown.attitude_feedback).xy(),
        damping: double(&shown.rate_feedback).xy(),
        omega_d: double(&shown.desired_angular_velocity),
        omega_d_dot: double(&shown.desired_angular_acceleration),
        filters: filters(memory),
        averages: averages(memory),
        // Its length is the core's own.
        side: side * (answer.side.norm() / side.norm().max(1e-300)),
        yaw_room: memory.yaw_torque_left.into(),
        ..*answer
    }
}

/// What the accelerometer, m/s^2, and the rotors' speeds show where `acted`: nothing, nearly the truth, or nonsense.
fn measured(rng: &mut ChaCha8Rng, acceleration: &Vector3<f64>, acted: &Vector4<f64>) -> Measured {
    let acceleration = match rng.random_range(0..20) {
        0 => None,
        1 => Some(Vector3::repeat(f32::NAN)),
        2 => Some(random::vector(rng, 1e4)),
        _ => Some(acceleration.cast() + random::vector(rng, 3.0)),
    };
    let wrench = match rng.random_range(0..20) {
        0 => None,
        1 => Some(Wrench { thrust: f32::INFINITY, torque: Vector3::zeros() }),
        2 => Some(Wrench { thrust: 1.0, torque: random::vector(rng, 1e4) }),
        _ => {
            let shown = (acted * rng.random_range(0.6..1.1)).cast::<f32>();
            Some(Wrench { thrust: shown.x, torque: Vector3::new(shown.y, shown.z, shown.w) })
        }
    };
    Measured { acceleration, wrench, lost: None }
}

/// What flights showed.
#[derive(Default)]
struct Shown {
    /// The greatest error and the greatest share of its tolerance, each over [`NAMES`].
    worst: [(f64, f64); NAMES.len()],
    /// How often the lift switched, and how often the law was slowed and came back.
    switches: u32,
    slowed: u32,
    back: u32,
    /// Ticks in each of [`BRANCHES`], and ticks so near to a jump that neither answer is wrong.
    taken: [u32; BRANCHES.len()],
    either: u32,
}

/// What a flight is disturbed by.
struct World {
    goal: Reference,
    body: Body,
    /// m/s^2.
    wind: Vector3<f64>,
    /// Whether the estimates are held from now on.
    hold: bool,
}

/// Ticks of `period` s, two of so many `compared`.
struct Plan {
    period: f32,
    ticks: u32,
    compared: u32,
    /// The seed of what is measured beside the state, if anything is.
    measures: Option<u64>,
}

fn fly(
    configuration: &Configuration,
    plan: &Plan,
    rng: &mut ChaCha8Rng,
    shown: &mut Shown,
    disturb: impl Fn(u32, &mut World, &mut ChaCha8Rng),
) {
    let extended = law(configuration);
    let (vehicle, period) = (configuration.vehicle(), plan.period);
    let (lag, delay) = (extended.actuators.lag, extended.actuators.delay);
    let oracle =
        Law::new(vehicle, configuration.limits(), &extended.parameters, configuration.rotors(), lag + delay, period);
    let Flown::Extended(mut controller) = Flown::uncertified(configuration, period).unwrap() else {
        panic!("another law")
    };
    let settling = ((delay + 5.0 * lag) / period) as u32 + 2;
    let hover = Vector4::new(oracle.mass * oracle.gravity, 0.0, 0.0, 0.0);
    let mut hidden = Hidden {
        last: None,
        held: 0,
        acting: Acting::new(lag, delay, period, hover),
        acted: hover,
        fallback: Fallback::FRESH,
        forward: None,
    };
    let goal = reference(rng, configuration);
    let body = Body::resting(goal.position.cast(), random::attitude(rng).cast());
    let mut world = World { goal, body, wind: Vector3::zeros(), hold: false };
    let mut sensors = plan.measures.map(random::generator);
    let radius = 2.0 * (oracle.moments().xy().max() / oracle.mass).sqrt();
    let mut speeds = Speeds::new(lag, period, configuration.limits().thrust_max, radius);
    let (delivered, off) = (rng.random_range(0.7..1.2), random::vector(rng, 0.02));
    for number in 0..plan.ticks {
        disturb(number, &mut world, rng);
        if std::mem::take(&mut world.hold) {
            controller.hold_estimates();
            hidden.held = settling;
        }
        let (state, goal) = (world.body.state(), world.goal);
        let mut before = tick(controller.memory(), &hidden, &state, &goal);
        if let Some(sensors) = &mut sensors {
            let moved =
                hidden.last.map_or_else(Vector3::zeros, |last| (before.velocity - last.velocity) / f64::from(period));
            let shown = measured(sensors, &moved, &hidden.acted);
            controller.measured(&shown);
            before.felt = shown.acceleration.map(|felt| felt.cast());
            if let Some(Wrench { thrust, torque }) = shown.wrench {
                let shown = Vector4::new(thrust, torque.x, torque.y, torque.z).cast();
                [before.acted, before.pending] = speeds.corrected(&shown, &hidden.acted, &before.pending, before.held);
            }
        }
        let answer = oracle.evaluate(&before);
        let (wrench, diagnostics) = controller.step(&state, &goal).unwrap();
        let core = of_core(controller.memory(), &wrench, &diagnostics, &answer);
        let mut forward = None;
        if number % plan.compared <= 1 {
            let scales = Scales {
                far: f64::from(state.position.norm() + goal.position.norm()),
                fast: f64::from(state.velocity.norm() + goal.velocity.norm()),
                forward: hidden.forward.unwrap_or_default(),
            };
            let allowed = tolerances(&oracle, &before, &answer, &scales);
            forward = Some(allowed[ACCELERATION_PLACE] / ROUNDINGS_MAX);
            let either = answer.edge < EITHER_SIDE;
            shown.either += u32::from(either);
            if !either {
                let lifted = vector4(&diagnostics.attitude_error);
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
                if number > 0 && hidden.forward.is_none() || either && !UNCHANGED_MEMORY.contains(&name) {
                    continue;
                }
                let what = format!("tick {number}: {name} is off by {error:e}, allowed {allowed:e}");
                assert!(error <= allowed, "{what}\n{core:?}\n{answer:?}\n{before:?}\n{:?}", extended.parameters);
                let (most, share) = &mut shown.worst[part];
                (*most, *share) = (most.max(error), share.max(error / allowed));
            }
            shown.taken.iter_mut().zip(answer.taken).for_each(|(count, taken)| *count += u32::from(taken));
        }
        let fallback = &controller.memory().fallback;
        let expected = answer.fallback;
        let seen = (fallback.is_slow(), fallback.times());
        assert_eq!(seen, (expected.slow, expected.times), "tick {number}: {fallback:?} and {expected:?}");
        shown.slowed += u32::from(expected.slow && !before.fallback.slow);
        shown.back += u32::from(!expected.slow && before.fallback.slow);

        let commanded = Vector4::new(wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z);
        hidden.acted = hidden.acting.advance(commanded.cast::<f64>() / core.averages.scale);
        hidden.held = hidden.held.saturating_sub(1);
        (hidden.fallback, hidden.forward) = (answer.fallback, forward);
        let axis = before.rotation.column(2).into();
        hidden.last = Some(Last { velocity: before.velocity, axis, omega: before.omega, forward: answer.forward });
        let acting = Wrench { thrust: wrench.thrust * delivered, torque: wrench.torque * delivered + off };
        world.body.advance(vehicle, &acting, f64::from(period), 4);
        world.body.velocity += world.wind * f64::from(period);
    }
}

/// Throws vehicle and reference about.
fn thrown(configuration: &Configuration, world: &mut World, rng: &mut ChaCha8Rng) {
    const CHANGE_PROBABILITY: f64 = 0.02;
    if rng.random_bool(CHANGE_PROBABILITY) {
        world.goal = reference(rng, configuration);
        world.wind = random::vector(rng, 4.0).cast::<f64>();
    }
    if rng.random_bool(CHANGE_PROBABILITY) {
        world.body.attitude = random::attitude(rng).cast();
        world.body.angular_velocity = random::vector(rng, 10.0).cast();
        world.body.velocity = random::vector(rng, 8.0).cast();
        world.body.position = (world.goal.position + random::vector(rng, 10.0)).cast();
    }
    // Upside down and turning on: beyond half a turn the other way round is nearer.
    if rng.random_bool(CHANGE_PROBABILITY) {
        let angle = rng.random_range(0.0..std::f64::consts::TAU);
        let axis = Vector3::new(angle.cos(), angle.sin(), 0.0);
        world.body.attitude = Quaternion::new(0.0, axis.x, axis.y, 0.0);
        world.body.angular_velocity = axis * rng.random_range(-20.0..20.0);
    }
    // Level, spinning and falling: yaw brakes while thrust is wanted.
    if rng.random_bool(CHANGE_PROBABILITY) {
        world.body.attitude = Quaternion::identity();
        world.body.angular_velocity = Vector3::z() * rng.random_range(-30.0..30.0);
        world.body.velocity = Vector3::z() * rng.random_range(-40.0..0.0);
    }
    world.hold = rng.random_bool(0.5 * CHANGE_PROBABILITY);
}

#[test]
fn every_tick_of_random_flights_agrees_with_the_plain_transcription() {
    let mut rng = random::generator(401);
    let mut shown = Shown::default();
    let plan =
        |number| Plan { period: 0.01, ticks: 150, compared: 1, measures: (number % 2 == 1).then_some(number as u64) };
    // The rotors of the last ones are weak, so that what brakes yaw takes thrust.
    let weak = ["study", "published/iris"].map(|name| vehicle(name).configuration);
    for number in 0..115 {
        let configuration = if number < 100 { around_the_formulas(&mut rng) } else { weak[number % 2].clone() };
        fly(&configuration, &plan(number), &mut rng, &mut shown, |_, world, rng| thrown(&configuration, world, rng));
    }
    let Shown { worst, switches, taken, either, .. } = shown;
    for (name, (error, share)) in NAMES.iter().zip(worst) {
        println!("{name:9} worst error {error:.1e}, {share:.2} of what rounding allows");
    }
    for (name, ticks) in BRANCHES.iter().zip(taken) {
        println!("{name:20} {ticks} ticks of 17250");
    }
    println!("the lift switched {switches} times; {either} ticks were too near to a jump to compare");
    assert!(switches > 10 && either < 5, "{switches} switches, {either} at one");
    // The ceiling is the adversary's.
    assert!(taken.iter().all(|ticks| *ticks > 5), "{taken:?}");
}

/// The velocity of a reference that says it moves and stays where it is, m/s: nobody can follow that. What it says
/// shrinks by 14 % in every window, which is progress, not at all, or by 7 %, which is none.
fn said(time: f32) -> f32 {
    match time {
        ..160.0 => (-0.0075 * (time - 100.0)).exp(),
        ..255.0 => 0.64,
        ..320.0 => 0.0,
        ..385.0 => (-0.0036 * (time - 320.0)).exp(),
        _ => 0.0,
    }
}

/// From two kilometres away, where five metres in a window are progress; then after such a reference, which jumps once
/// before the law is slowed and once at the end.
#[test]
fn the_law_is_slowed_and_comes_back_when_the_plain_transcription_says() {
    let mut rng = random::generator(402);
    let mut shown = Shown::default();
    let plan = Plan { period: 0.02, ticks: 24_500, compared: 200, measures: None };
    for _ in 0..3 {
        let configuration = random_configuration(&mut rng);
        fly(&configuration, &plan, &mut rng, &mut shown, |number, world, _| {
            let at = Vector3::x() * if (9_500..24_000).contains(&number) { 6.0 } else { 0.0 };
            world.goal = Reference::resting(at, Heading::FORWARD);
            world.goal.velocity = Vector3::x() * said(number as f32 * plan.period);
            match number {
                0 => world.body = Body::resting(Vector3::y() * 2_000.0, Quaternion::identity()),
                3_000 => world.body = Body::resting(Vector3::y() * 40.0, Quaternion::identity()),
                _ => {}
            }
        });
    }
    println!("slowed {} times, back {} times", shown.slowed, shown.back);
    assert_eq!((shown.slowed, shown.back), (6, 6));
}
