//! The core's extended law against the independent transcription in `support::extended::oracle`, tick by tick on
//! flights of random vehicles with random constants: thrown about, pushed by wind, with rotors that deliver what they
//! like, through delay and lag.
//!
//! At every tick the oracle starts from what the core remembers and has to come to the same wrench, the same desired
//! motion and the same memory; what the core hides (what was commanded, the last state, for how long it learns nothing,
//! the net's clock) it keeps for itself. The tolerances are derived from the rounding of single precision in
//! `support::extended::rounding`.
//!
//! Every branch of the limiter meets its neighbour continuously, so a tick at an edge is no tie: either side is right
//! to within its rounding. Only the lift jumps, at its switch. Ticks within [`EITHER_SIDE`] of it are compared in what
//! does not depend on it, and counted.

use crate::support::body::Body;
use crate::support::extended::oracle::Law;
use crate::support::extended::oracle::acting::Acting;
use crate::support::extended::oracle::estimates::Averages;
use crate::support::extended::oracle::net::{Net, PATIENCE};
use crate::support::extended::oracle::tick::{Answer, Last, Nudge, Tick};
use crate::support::extended::rounding::{ACCELERATION, NAMES, Scales, distances, tolerances};
use crate::support::extended::{around_the_formulas, law, random_configuration};
use crate::support::oracle::lifting;
use crate::support::oracle::rounding::{ROUNDINGS, vector4};
use crate::support::random::{self, ChaCha8Rng};
use controller_core::configuration::Configuration;
use controller_core::extended::memory::Memory;
use controller_core::extended::position::Filters;
use controller_core::heading::Heading;
use controller_core::law::Law as Flown;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use nalgebra::{Vector2, Vector3, Vector4};
use rand::RngExt;

/// Where q_0 of the attitude error is this near to the switch, either side of it is accepted.
const EITHER_SIDE: f64 = 1e-5;

/// What a tick that jumps may change.
const OF_THE_LIFT: [&str; 6] = ["thrust", "torque", "omega_d'", "c", "x", "chi, W"];

/// What the branches are called.
const BRANCHES: [&str; 10] = [
    "frame's rate",
    "frame's acceleration",
    "the same with W",
    "cone",
    "|u| below U",
    "c_z above -A_-",
    "lambda < 1",
    "floor",
    "ceiling",
    "W cut",
];

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

/// State that the core does not expose.
struct Hidden {
    last: Option<Last>,
    held: u32,
    acting: Acting,
    acted: Vector4<f64>,
    net: Net,
    /// What omega_d' of the last tick is known to, rad/s^2.
    wanted: f64,
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
        lag: memory.heading.map(|lag| {
            let half = lag.half_angle.cast::<f64>();
            [2.0 * half.y.atan2(half.x), lag.rate.into()]
        }),
        lift: memory.lift.map(|lift| lifting::Lift { memory: vector4(&lift.memory), sign: lift.sign.into() }),
        averages: averages(memory),
        net: hidden.net,
        last: hidden.last,
        held: hidden.held > 0,
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
    }
}

/// What the core came to. The lift is compared by itself: here it is the oracle's.
fn of_core(memory: &Memory, wrench: &Wrench, desired: [Vector3<f32>; 2], answer: &Answer) -> Answer {
    let double = |v: &Vector3<f32>| v.cast::<f64>();
    let lag = memory.heading.unwrap();
    let half = lag.half_angle.cast::<f64>();
    Answer {
        thrust: wrench.thrust.into(),
        torque: double(&wrench.torque),
        omega_d: double(&desired[0]),
        omega_d_dot: double(&desired[1]),
        filters: filters(memory),
        averages: averages(memory),
        lag: [2.0 * half.y.atan2(half.x), lag.rate.into()],
        ..*answer
    }
}

/// What flights showed.
#[derive(Default)]
struct Shown {
    /// The greatest error and the greatest share of its tolerance, each over [`NAMES`].
    worst: [(f64, f64); NAMES.len()],
    /// How often the lift switched, and the net caught.
    switches: u32,
    caught: u32,
    /// Ticks in each of [`BRANCHES`], and ticks so near to the lift's switch that neither answer is wrong.
    taken: [u32; BRANCHES.len()],
    either: u32,
}

/// A flight: how it is thrown about.
struct Plan {
    period: f32,
    ticks: u32,
    /// How likely a throw is in a tick.
    thrown: f64,
    /// Ticks that are compared.
    compared: fn(&Net) -> bool,
}

fn fly(configuration: &Configuration, plan: &Plan, rng: &mut ChaCha8Rng, shown: &mut Shown) {
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
        net: Net { acted: 0.0, caught: false },
        wanted: 0.0,
    };
    let mut goal = reference(rng, configuration);
    let mut body = Body::resting(goal.position.cast(), random::attitude(rng).cast());
    let (delivered, off, mut wind) = (rng.random_range(0.7..1.2), random::vector(rng, 0.02), Vector3::zeros());
    for number in 0..plan.ticks {
        if rng.random_bool(plan.thrown) {
            goal = reference(rng, configuration);
            wind = random::vector(rng, 4.0).cast::<f64>();
        }
        if rng.random_bool(plan.thrown) {
            body.attitude = random::attitude(rng).cast();
            body.angular_velocity = random::vector(rng, 10.0).cast();
            body.velocity = random::vector(rng, 8.0).cast();
            body.position = (goal.position + random::vector(rng, 10.0)).cast();
        }
        if rng.random_bool(0.5 * plan.thrown) {
            controller.hold_estimates();
            hidden.held = settling;
        }
        let state = body.state();
        let before = tick(controller.memory(), &hidden, &state, &goal);
        let answer = oracle.evaluate(&before);
        let (wrench, diagnostics) = controller.step(&state, &goal).unwrap();
        let desired = [diagnostics.desired_angular_velocity, diagnostics.desired_angular_acceleration];
        let core = of_core(controller.memory(), &wrench, desired, &answer);
        let mut wanted = 0.0;
        if (plan.compared)(&before.net) {
            let scales = Scales {
                far: f64::from(state.position.norm() + goal.position.norm()),
                fast: f64::from(state.velocity.norm() + goal.velocity.norm()),
                wanted: hidden.wanted,
            };
            let allowed = tolerances(&oracle, &before, &answer, &scales);
            wanted = allowed[ACCELERATION] / ROUNDINGS;
            let scalar = f64::from(controller_core::path_lifting::switching_scalar(extended.parameters.delta));
            let either = (answer.lifted[0].abs() + scalar).abs() < EITHER_SIDE;
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
                if either && OF_THE_LIFT.contains(&name) {
                    continue;
                }
                let what = format!("tick {number}: {name} is off by {error:e}, allowed {allowed:e}");
                assert!(error <= allowed, "{what}\n{core:?}\n{answer:?}\n{before:?}\n{:?}", extended.parameters);
                let (most, share) = &mut shown.worst[part];
                (*most, *share) = (most.max(error), share.max(error / allowed));
            }
            shown.taken.iter_mut().zip(answer.taken).for_each(|(count, taken)| *count += u32::from(taken));
        }
        let net = &controller.memory().net;
        assert_eq!(net.is_caught(), answer.net.caught, "tick {number}: {net:?} and {:?}", answer.net);
        shown.caught += u32::from(answer.net.caught && !before.net.caught);

        let commanded = Vector4::new(wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z);
        hidden.acted = hidden.acting.advance(commanded.cast::<f64>() / core.averages.scale);
        hidden.held = hidden.held.saturating_sub(1);
        (hidden.net, hidden.wanted) = (answer.net, wanted);
        let axis = before.rotation.column(2).into();
        hidden.last = Some(Last { velocity: before.velocity, axis, omega: before.omega, wanted: answer.wanted });
        let acting = Wrench { thrust: wrench.thrust * delivered, torque: wrench.torque * delivered + off };
        body.advance(vehicle, &acting, f64::from(period), 4);
        body.velocity += wind * f64::from(period);
    }
}

#[test]
fn every_tick_of_random_flights_agrees_with_the_plain_transcription() {
    let mut rng = random::generator(401);
    let mut shown = Shown::default();
    let plan = Plan { period: 0.01, ticks: 150, thrown: 0.02, compared: |_| true };
    for _ in 0..40 {
        let configuration = around_the_formulas(&mut rng);
        fly(&configuration, &plan, &mut rng, &mut shown);
    }
    let Shown { worst, switches, taken, either, .. } = shown;
    for (name, (error, share)) in NAMES.iter().zip(worst) {
        println!("{name:9} worst error {error:.1e}, {share:.2} of what rounding allows");
    }
    for (name, ticks) in BRANCHES.iter().zip(taken) {
        println!("{name:20} {ticks} ticks of 6000");
    }
    println!("the lift switched {switches} times; {either} ticks were too near to a jump to compare");
    assert!(switches > 10 && either < 5, "{switches} switches, {either} at one");
    // |u| stays below what cuts it: the ceiling is the adversary's.
    assert!(taken[..8].iter().chain(&taken[9..]).all(|ticks| *ticks > 20), "{taken:?}");
}

/// A vehicle that never arrives, at ticks so long that the net's minute is few of them.
#[test]
fn the_net_catches_a_flight_that_never_arrives_when_the_plain_transcription_says() {
    let mut rng = random::generator(402);
    let mut shown = Shown::default();
    let near = |net: &Net| net.caught || net.acted > PATIENCE - 0.5;
    let plan = Plan { period: 0.035, ticks: 5000, thrown: 0.5, compared: near };
    for _ in 0..3 {
        let configuration = random_configuration(&mut rng);
        fly(&configuration, &plan, &mut rng, &mut shown);
    }
    println!("the net caught {} times", shown.caught);
    assert_eq!(shown.caught, 3);
}
