//! Margins of the extended law, predicted by the sampled loops and flown: the command of one axis is made stronger,
//! weaker or later in the simulation of the whole vehicle, rotors and six degrees of freedom, until the hover
//! oscillates. All estimates are at work. `cargo test -p host-sim margins_are_where -- --nocapture` prints the table of
//! `docs/sampled-loop.md`.
//!
//! There is no air in them: the model has none. A second test flies in the files' air. An attitude loop's own margins
//! are flown without position and velocity, as on a gimbal.

use crate::support::extended::{with_constants, without_estimates};
use controller_core::heading::Heading;
use controller_core::reference::Trajectory;
use controller_core::reference::hover::Hover;
use host_sim::flight;
use host_sim::vehicle::SimulatedVehicle;
use host_sim::vehicle::actuators::ActuatorDemand;
use nalgebra::{Quaternion, Vector3};
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::reality::Reality;
use scenario::sampled_loop::{Axis, Margins};
use std::thread;

const SCENARIO_FILES: [(&str, &str); 3] = [
    ("Hummingbird", include_str!("../../../vehicles/hummingbird.toml")),
    ("study", include_str!("../../../vehicles/study.toml")),
    ("paper's vehicle", include_str!("../../../scenarios/paper-extended.toml")),
];

/// How far a flown margin may be from the predicted one.
const MARGIN_TOLERANCE: f64 = 0.01;

/// The file's scenario; with no force across estimated for an attitude loop, which is by itself.
fn parse(text: &str, axis: Axis) -> Scenario {
    let mut scenario = Scenario::parse(text, "margins").unwrap();
    if matches!(axis, Axis::Roll | Axis::Pitch) {
        scenario.configuration = with_constants(&scenario.configuration, |p| p.force_across = 0.0);
    }
    scenario
}

/// No air, nothing but the model.
fn still(_: Reality) -> Reality {
    Reality::default()
}

/// One loop in flight.
struct Bench {
    scenario: Scenario,
    axis: Axis,
}

impl Bench {
    /// A hover at the origin, a little off along `axis`; `finer` times the file's plant steps.
    fn new(text: &str, axis: Axis, finer: u32, reality: impl FnOnce(Reality) -> Reality) -> Self {
        let mut scenario = parse(text, axis);
        scenario.reality = reality(scenario.reality);
        scenario.timing.steps_per_tick *= finer;
        scenario.delay_steps *= u64::from(finer);
        // So small that neither level nor approach is felt when it has grown tenfold.
        let (position, about) = match axis {
            Axis::Roll => (Vector3::zeros(), Vector3::x() * 3e-4),
            Axis::Pitch => (Vector3::zeros(), Vector3::y() * 3e-4),
            Axis::Yaw => (Vector3::zeros(), Vector3::z() * 1e-3),
            Axis::LateralX => (Vector3::x() * 3e-5, Vector3::zeros()),
            Axis::LateralY => (Vector3::y() * 3e-5, Vector3::zeros()),
            Axis::Vertical => (Vector3::z() * 3e-5, Vector3::zeros()),
        };
        let attitude = Quaternion::from_parts(1.0, about * 0.5).normalize();
        let (velocity, angular_velocity) = (Vector3::zeros(), Vector3::zeros());
        scenario.initial = BodyState { position, velocity, attitude, angular_velocity };
        Self { scenario, axis }
    }

    /// Whether the motion grows with the command `gain` times as strong and `later` plant steps later than the law
    /// knows.
    fn grows(&self, gain: f64, later: u64) -> bool {
        /// Of the start, and of a stretch after it; and how many of those are flown at most.
        const START_TICKS: usize = 100;
        const STRETCH_TICKS: usize = 1500;
        const STRETCHES_MAX: usize = 10;
        let mut scenario = self.scenario.clone();
        scenario.delay_steps += later;
        let vehicle = scenario.configuration.vehicle();
        let weight = vehicle.mass * vehicle.gravity;
        let hover = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
        let mut law = flight::law(&scenario).unwrap();
        let mut body = SimulatedVehicle::new(&scenario, &scenario.configuration);
        let mut peak = |ticks: usize| {
            (0..ticks).fold(0.0_f32, |peak, _| {
                let mut state = *body.state();
                if matches!(self.axis, Axis::Roll | Axis::Pitch | Axis::Yaw) {
                    (state.position, state.velocity) = (Vector3::zeros(), Vector3::zeros());
                }
                let (wrench, _) = law.step(&state.measured(), &hover).unwrap();
                let mut commanded = wrench.scaled(1.0 / law.thrust_scale());
                let component = match self.axis {
                    Axis::Roll | Axis::LateralY => &mut commanded.torque.x,
                    Axis::Pitch | Axis::LateralX => &mut commanded.torque.y,
                    Axis::Yaw => &mut commanded.torque.z,
                    Axis::Vertical => &mut commanded.thrust,
                };
                let rest = if self.axis == Axis::Vertical { weight } else { 0.0 };
                let motion = *component - rest;
                *component = rest + gain as f32 * motion;
                // A rotor saturates when the motion has grown a thousand times.
                let (clipped, _) =
                    body.hold(&ActuatorDemand::Wrench(commanded), scenario.timing.steps_per_tick).unwrap();
                if clipped { f32::INFINITY } else { peak.max(motion.abs()) }
            })
        };
        let start = peak(START_TICKS);
        if start.is_infinite() {
            return true;
        }
        let mut last = start;
        for stretch in 0..STRETCHES_MAX {
            let next = peak(STRETCH_TICKS);
            if next > 10.0 * start || next < 0.1 * start {
                return next > start;
            }
            if stretch + 1 == STRETCHES_MAX {
                // What neither grows nor dies is an oscillation that the levels hold.
                return next > 0.997 * last;
            }
            last = next;
        }
        false
    }
}

/// Where `grows` changes between 1 - w and 1 + w times what is predicted, w being a few tolerances.
fn flown(predicted: f64, grows_beyond: bool, grows: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (1.0 - 4.0 * MARGIN_TOLERANCE, 1.0 + 4.0 * MARGIN_TOLERANCE);
    assert!(grows(low * predicted) != grows_beyond, "{predicted}: lost already at {low} of it");
    assert!(grows(high * predicted) == grows_beyond, "{predicted}: still there at {high} of it");
    for _ in 0..4 {
        let middle = 0.5 * (low + high);
        if grows(middle * predicted) == grows_beyond { high = middle } else { low = middle }
    }
    0.5 * (low + high) * predicted
}

/// Gain up, gain down and delay (s) of one axis, flown.
fn flown_margins(text: &str, axis: Axis, predicted: &Margins) -> [f64; 3] {
    let gains = Bench::new(text, axis, 2, still);
    let up = flown(predicted.gain_up, true, |gain| gains.grows(gain, 0));
    let down = flown(predicted.gain_down, false, |gain| gains.grows(gain, 0));
    let delays = Bench::new(text, axis, 10, still);
    let step = delays.scenario.timing.step();
    let delay = flown(predicted.delay, true, |delay| delays.grows(1.0, (delay / step).round() as u64));
    [up, down, delay]
}

fn predicted(scenario: &Scenario, axis: Axis) -> Margins {
    scenario.loops().unwrap().report(axis).margins.unwrap()
}

#[test]
fn margins_are_where_the_flight_begins_to_oscillate() {
    let flights: Vec<_> = SCENARIO_FILES
        .map(|(name, text)| {
            thread::spawn(move || {
                Axis::ALL.map(|axis| {
                    let mut scenario = parse(text, axis);
                    let found = predicted(&scenario, axis);
                    let flown = flown_margins(text, axis, &found);
                    scenario.configuration = without_estimates(&scenario.configuration);
                    (name, axis, predicted(&scenario, axis), found, flown)
                })
            })
        })
        .into_iter()
        .flat_map(|thread| thread.join().unwrap())
        .collect();
    println!("In each cell: were nothing estimated; predicted; flown.");
    println!("| vehicle | loop | gain up | gain down | delay, ms |");
    for (name, axis, resting, found, [up, down, delay]) in &flights {
        let ms = |delay: f64| 1e3 * delay;
        println!(
            "| {name} | {} | {:.2}; {:.2}; {up:.2} | {:.3}; {:.3}; {down:.3} | {:.1}; {:.1}; {:.1} |",
            axis.name(),
            resting.gain_up,
            found.gain_up,
            resting.gain_down,
            found.gain_down,
            ms(resting.delay),
            ms(found.delay),
            ms(*delay),
        );
    }
    for (name, axis, _, found, flown) in &flights {
        for (predicted, flown) in [found.gain_up, found.gain_down, found.delay].into_iter().zip(flown) {
            assert!(
                (flown / predicted - 1.0).abs() < MARGIN_TOLERANCE,
                "{name} {axis:?}: {flown} flown, {predicted} predicted"
            );
        }
    }
}

#[test]
fn in_air_every_margin_is_wider() {
    for (name, text) in &SCENARIO_FILES[..2] {
        for axis in Axis::ALL {
            let Margins { gain_up, gain_down, delay, .. } = predicted(&parse(text, axis), axis);
            let bench = Bench::new(text, axis, 2, |reality| reality);
            assert!(bench.scenario.reality.drag.is_some());
            let later = (delay / bench.scenario.timing.step()).ceil() as u64;
            for (gain, later) in [(gain_up, 0), (gain_down, 0), (1.0, later)] {
                assert!(!bench.grows(gain, later), "{name} {axis:?}: {gain}, {later} steps");
            }
        }
    }
}
