//! The linear law against the law that flies: both are shown the same small motion, and command the same.
//!
//! The motion is a sum of sines that no loop closes, so that nothing settles and every state of the law takes part.

use super::super::LoopModel;
use super::super::compensator::Compensator;
use super::INTEGRATORS;
use crate::Scenario;
use crate::sampled_loop::Axis;
use controller_core::certificate::certified::Certified;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::reference::Trajectory;
use controller_core::reference::hover::Hover;
use controller_core::state::{State, Wrench};
use nalgebra::{DVector, Quaternion, SVector, Vector3};

const FILES: [(&str, &str); 3] = [
    ("hummingbird", include_str!("../../../../vehicles/hummingbird.toml")),
    ("study", include_str!("../../../../vehicles/study.toml")),
    ("paper-extended", include_str!("../../../../scenarios/paper-extended.toml")),
];

const TICKS: usize = 1500;

/// Where an axis points in the world, which body axis it turns about, and in which sense.
fn directions(axis: Axis) -> (Vector3<f64>, Vector3<f64>) {
    match axis {
        Axis::LateralX => (Vector3::x(), Vector3::y()),
        Axis::LateralY => (Vector3::y(), -Vector3::x()),
        Axis::Vertical => (Vector3::z(), Vector3::zeros()),
        Axis::Roll => (Vector3::zeros(), Vector3::x()),
        Axis::Pitch => (Vector3::zeros(), Vector3::y()),
        Axis::Yaw => (Vector3::zeros(), Vector3::z()),
    }
}

/// Position or angle at tick k and its derivative, of amplitude about one: four sines, slow to fast, with phases of their own.
fn wave(k: usize, period: f64, phase: f64) -> (f64, f64) {
    let t = k as f64 * period;
    [(0.5, 0.4), (2.3, 0.3), (9.0, 0.2), (40.0, 0.02)].iter().fold((0.0, 0.0), |(value, rate), (frequency, amplitude)| {
        let (sin, cos) = (frequency * t + phase * frequency).sin_cos();
        (value + amplitude * sin, rate + amplitude * frequency * cos)
    })
}

/// What the flown law and the compensator command, in the compensator's units.
fn commands(scenario: &Scenario, axis: Axis) -> (Vec<f64>, Vec<f64>) {
    let vehicle = scenario.configuration.vehicle();
    let [mass, gravity] = [vehicle.mass, vehicle.gravity].map(f64::from);
    let period = scenario.timing.period();
    let (along, about) = directions(axis);
    let inertia = vehicle.inertia.cast::<f64>().dot(&about.abs());
    let model: LoopModel = scenario.loops().unwrap();
    let Compensator { transition, input, output, direct } = model.law(axis).compensator();
    let mut x = DVector::zeros(transition.nrows());
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let mut law = Law::new(&certified, period as f32).unwrap();
    let hover = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);

    let (mut flown, mut linear) = (Vec::new(), Vec::new());
    for k in 0..TICKS {
        // From rest: a law that has just been reset has no last tick to compare with.
        let fade = if k == 0 { 0.0 } else { 1.0 };
        let [(p, v), (angle, rate)] = [wave(k, period, 0.3), wave(k, period, 1.7)];
        // Along the vertical gravity's rounding is in every difference; across everything is about zero.
        let reach = fade * if axis == Axis::Vertical { 4e-4 } else { 2e-5 };
        let [p, v, angle, rate] = [reach * p, reach * v, fade * 3e-5 * angle, fade * 3e-5 * rate];
        let (sin, cos) = (0.5 * angle).sin_cos();
        let vector = about * sin;
        let told = State {
            position: (along * p).cast(),
            velocity: (along * v).cast(),
            attitude: Quaternion::new(cos as f32, vector.x as f32, vector.y as f32, vector.z as f32),
            angular_velocity: (about * rate).cast(),
        };
        let (Wrench { thrust, torque }, _) = law.step(&told, &hover).unwrap();
        let scale = f64::from(law.thrust_scale());
        flown.push(if axis == Axis::Vertical {
            f64::from(thrust) / scale / mass - gravity
        } else {
            torque.cast::<f64>().dot(&about) / scale / inertia
        });

        let (rate, angle) = (rate * period, angle);
        let y: [f64; INTEGRATORS] = match axis {
            Axis::Vertical => [v / period, p / period.powi(2), 0.0, 0.0],
            Axis::Roll | Axis::Pitch | Axis::Yaw => [rate, angle, 0.0, 0.0],
            Axis::LateralX | Axis::LateralY => [rate, angle, v / (gravity * period), p / (gravity * period.powi(2))],
        };
        let y = SVector::<f64, INTEGRATORS>::from(y);
        let unit = if axis == Axis::Vertical { 1.0 } else { period.powi(-2) };
        linear.push(unit * (output.dot(&x.transpose()) + (direct * y)[0]));
        x = &transition * x + &input * y;
    }
    (flown, linear)
}

/// The greatest difference over the greatest command.
fn difference(scenario: &Scenario, axis: Axis) -> f64 {
    let (flown, linear) = commands(scenario, axis);
    let peak = linear.iter().fold(0.0_f64, |peak, value| peak.max(value.abs()));
    let off = flown.iter().zip(&linear).fold(0.0_f64, |off, (flown, linear)| off.max((flown - linear).abs()));
    off / peak
}

#[test]
fn the_linear_law_commands_what_the_flown_law_commands() {
    for (name, text) in FILES {
        let whole = Scenario::parse(text, name).unwrap();
        // An attitude loop alone has no position, so no force is estimated either.
        let (head, tail) = text.split_once("force_across").unwrap();
        let (_, tail) = tail.split_once('\n').unwrap();
        let attitude_only = Scenario::parse(&format!("{head}force_across = 0.0\n{tail}"), name).unwrap();
        for axis in Axis::ALL {
            let scenario = if matches!(axis, Axis::Roll | Axis::Pitch) { &attitude_only } else { &whole };
            let off = difference(scenario, axis);
            println!("{name:15} {:10} {off:.1e}", axis.name());
            let tolerance = if axis == Axis::Vertical { 2e-3 } else { 1e-5 };
            assert!(off < tolerance, "{name} {}: {off:e}", axis.name());
        }
    }
}
