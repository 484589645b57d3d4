//! The columns beside the loop as it is integrated in small steps.

use super::columns::STRETCH_COUNT;
use super::*;
use crate::Scenario;
use crate::sampled_loop::{Axis, LoopModel};
use controller_core::configuration::LawParameters;

const STEPS_PER_TICK: usize = 20_000;

fn model(name: &str) -> LoopModel {
    let text = std::fs::read_to_string(format!("../vehicles/{name}.toml")).unwrap();
    Scenario::parse(&text, name).unwrap().loops().unwrap()
}

/// A tick of the chain behind an actuator that follows `told` plus an error, with a force on the velocity, both
/// functions of the time that has passed. y_1 .. y_M and a.
fn integrated(
    mut y: Vec<f64>,
    lag: f64,
    told: f64,
    error: impl Fn(f64) -> f64,
    force: impl Fn(f64) -> f64,
) -> Vec<f64> {
    let last = y.len() - 1;
    let step = 1.0 / STEPS_PER_TICK as f64;
    for place in 0..STEPS_PER_TICK {
        let time = (place as f64 + 0.5) * step;
        let follows = told + error(time);
        let before = y.clone();
        // The midpoint rule.
        let slope = |y: &[f64]| -> Vec<f64> {
            let mut slope = vec![0.0; last + 1];
            slope[0] = y[last];
            slope[1..last].copy_from_slice(&y[..last - 1]);
            slope[last - 2] += force(time);
            slope[last] = (follows - y[last]) / lag;
            slope
        };
        let middle: Vec<f64> = before.iter().zip(slope(&before)).map(|(y, rate)| y + 0.5 * step * rate).collect();
        y = before.iter().zip(slope(&middle)).map(|(y, rate)| y + step * rate).collect();
    }
    y
}

/// The stretches' columns, each times its part of an input that differs from stretch to stretch.
fn moved(stretches: &[Stretch], input: impl Fn(usize) -> f64) -> DVector<f64> {
    let size = stretches[0].column.len();
    stretches
        .iter()
        .enumerate()
        .fold(DVector::zeros(size), |sum, (place, stretch)| sum + &stretch.column * input(place))
}

#[test]
fn a_force_and_an_error_of_the_actuator_move_the_chain_as_integrated() {
    let lag_factor = 1.3;
    for (axis, integrators) in [(Axis::LateralX, 4), (Axis::Vertical, 2)] {
        let loops = model("hummingbird");
        let system = loops.disturbed(axis, lag_factor, 1.0);
        let lag = lag_factor * 0.5;
        // Of the stretches in time that is left, the last comes first.
        let inputs = [3.0, -1.0, 0.5, 2.0, -2.0, 0.0, 1.0, -0.25];
        let at =
            |time: f64| inputs[STRETCH_COUNT - 1 - ((time * STRETCH_COUNT as f64) as usize).min(STRETCH_COUNT - 1)];
        let still = vec![0.0; integrators + 1];
        let pushed = integrated(still.clone(), lag, 0.0, |_| 0.0, at);
        let followed = integrated(still, lag, 0.0, at, |_| 0.0);
        for (input, integrated) in [(Input::Force, pushed), (Input::Actuator, followed)] {
            let column = moved(&system.inputs[input as usize], |place| inputs[place]);
            for (place, value) in integrated.iter().enumerate() {
                assert!((column[place] - value).abs() < 1e-4, "{axis:?} {input:?} {place}: {} {value}", column[place]);
            }
        }
    }
}

/// What differs from a stretch's mean moves the state by no more than its swing.
#[test]
fn an_input_that_changes_within_a_stretch_stays_within_the_swing() {
    let system = model("hummingbird").disturbed(Axis::LateralX, 1.0, 1.0);
    let signs = |time: f64| if ((time * 2.0 * STRETCH_COUNT as f64) as usize).is_multiple_of(2) { 1.0 } else { -1.0 };
    let moved = integrated(vec![0.0; 5], 0.5, 0.0, signs, |_| 0.0);
    for (place, value) in moved.iter().enumerate() {
        let swing =
            |stretch: &Stretch| stretch.swing.iter().find(|(at, _)| *at == place).map_or(0.0, |(_, most)| *most);
        let most: f64 = system.inputs[Input::Actuator as usize].iter().map(swing).sum();
        assert!(value.abs() <= most + 1e-6, "{place}: {value} of {most}");
        // Each half of a stretch counts once: the bound is no more than some times what is met.
        assert!(value.abs() > 0.05 * most, "{place}: {value} of {most}");
    }
}

/// What an unseen force does to the velocity is not taken for a force, and a bend not for a torque bias.
#[test]
fn the_estimates_know_what_is_fed_to_them() {
    let scenario = Scenario::parse(include_str!("../../../../vehicles/study.toml"), "study").unwrap();
    let LawParameters::Extended(law) = scenario.configuration.law() else { panic!("{:?}", scenario.name) };
    let drag = f64::from(law.parameters.drag_across) * scenario.timing.period();
    for axis in [Axis::LateralX, Axis::LateralY, Axis::Vertical] {
        let system = scenario.loops().unwrap().disturbed(axis, 1.0, 1.0);
        let shown = |signal: Signal, input: Input| -> f64 {
            let row = &system.signals[signal as usize];
            system.inputs[input as usize].iter().map(|stretch| row.tr_dot(&stretch.column)).sum()
        };
        let seen = shown(Signal::Force, Input::Force);
        assert!(seen > 0.05, "{axis:?} {seen}");
        // Across, half of the drag that the law knows.
        let unseen = shown(Signal::Force, Input::Unseen);
        assert!(unseen.abs() <= 0.51 * drag * seen + 1e-12, "{axis:?} {unseen}");
        if axis != Axis::Vertical {
            assert!(shown(Signal::Bias, Input::Actuator) > 1e-3);
            assert!(shown(Signal::Bias, Input::Bend).abs() < 1e-12);
        }
    }
}

/// Without lag and delay a bend that is fed forward leaves no error of the tilt.
#[test]
fn an_actuator_without_a_lag_follows_a_bend() {
    let system = model("published/racer-pybullet").disturbed(Axis::LateralX, 1.0, 1.0);
    let row = |signal: Signal| &system.signals[signal as usize];
    let bend = &system.inputs[Input::Bend as usize][0].column;
    for signal in [Signal::Error, Signal::ErrorRate, Signal::Position, Signal::Velocity] {
        assert!(row(signal).tr_dot(bend).abs() < 1e-12, "{signal:?}");
    }
    // Fed forward alone it turns the vehicle.
    let fed = &system.inputs[Input::Stray as usize][0].column;
    assert!((row(Signal::ErrorRate).tr_dot(fed) - 1.0).abs() < 1e-12);
}
