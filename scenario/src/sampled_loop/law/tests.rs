//! The linear law against the law that flies: both are shown the same small motion, and command the same.
//!
//! The motion is a sum of sines that no loop closes, so that nothing settles and every state of the law takes part.

use super::super::compensator::Compensator;
use super::INTEGRATORS_MAX;
use crate::Scenario;
use crate::sampled_loop::Axis;
use controller_core::certificate::certified::Certified;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::reference::Trajectory;
use controller_core::reference::hover::Hover;
use controller_core::state::{State, Wrench};
use nalgebra::{DVector, Quaternion, SVector, Vector3};

const SCENARIO_FILES: [(&str, &str); 3] = [
    ("hummingbird", include_str!("../../../../vehicles/hummingbird.toml")),
    ("study", include_str!("../../../../vehicles/study.toml")),
    ("paper-extended", include_str!("../../../../scenarios/paper-extended.toml")),
];

const FLIGHT_TICKS: usize = 1500;

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

/// Position or angle at tick k and its derivative, about one in size: four oscillations, slow to fast, out of rest and
/// about zero, since the estimates integrate. `pace` identifies each.
fn wave(k: usize, period: f64, pace: f64) -> (f64, f64) {
    // The first tick is at rest: a law that has just been reset has none before it to compare with.
    let Some(since) = k.checked_sub(1) else { return (0.0, 0.0) };
    let t = since as f64 * period;
    [(0.5, 0.4), (2.3, 0.3), (9.0, 0.2), (40.0, 0.02)].iter().fold(
        (0.0, 0.0),
        |(value, rate), (frequency, amplitude)| {
            let frequency = pace * frequency;
            let (sin, cos) = (frequency * t).sin_cos();
            (value + amplitude * cos, rate - amplitude * frequency * sin)
        },
    )
}

/// The motion along an axis at a tick, SI units: position, velocity, angle, rate.
fn motion(axis: Axis, k: usize, period: f64) -> [f64; 4] {
    let [(p, v), (angle, rate)] = [wave(k, period, 1.0), wave(k, period, 0.8)];
    // Along the vertical gravity's rounding is in every difference; across everything is about zero.
    let reach = if axis == Axis::Vertical { 1e-4 } else { 2e-6 };
    [reach * p, reach * v, 3e-5 * angle, 3e-5 * rate]
}

/// The flown law's command in the motion times `sign`: acceleration or angular acceleration.
fn flown(scenario: &Scenario, axis: Axis, sign: f64) -> Vec<f64> {
    let vehicle = scenario.configuration.vehicle();
    let period = scenario.timing.period();
    let (along, about) = directions(axis);
    let inertia = vehicle.inertia.cast::<f64>().dot(&about.abs());
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let mut law = Law::new(&certified, period as f32).unwrap();
    let hover = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
    let tick = |k| {
        let [p, v, angle, rate] = motion(axis, k, period).map(|value| sign * value);
        let (sin, cos) = (0.5 * angle).sin_cos();
        let vector = about * sin;
        let measured = State {
            position: (along * p).cast(),
            velocity: (along * v).cast(),
            attitude: Quaternion::new(cos as f32, vector.x as f32, vector.y as f32, vector.z as f32),
            angular_velocity: (about * rate).cast(),
        };
        let (Wrench { thrust, torque }, _) = law.step(&measured, &hover).unwrap();
        let sent = 1.0 / f64::from(law.thrust_scale());
        if axis == Axis::Vertical {
            f64::from(thrust) * sent / f64::from(vehicle.mass) - f64::from(vehicle.gravity)
        } else {
            torque.cast::<f64>().dot(&about) * sent / inertia
        }
    };
    (0..FLIGHT_TICKS).map(tick).collect()
}

/// The compensator's command in the motion.
fn linear(scenario: &Scenario, axis: Axis) -> Vec<f64> {
    let gravity = f64::from(scenario.configuration.vehicle().gravity);
    let period = scenario.timing.period();
    let Compensator { transition, input, output, direct, .. } = scenario.loops().unwrap().law(axis).compensator();
    let mut x = DVector::zeros(transition.nrows());
    let tick = |k| {
        let [p, v, angle, rate] = motion(axis, k, period);
        let (p, v, rate) = (p / period.powi(2), v / period, rate * period);
        let (y, unit) = match axis {
            Axis::Vertical => ([v, p, 0.0, 0.0], 1.0),
            Axis::Roll | Axis::Pitch | Axis::Yaw => ([rate, angle, 0.0, 0.0], period.powi(-2)),
            Axis::LateralX | Axis::LateralY => ([rate, angle, v / gravity, p / gravity], period.powi(-2)),
        };
        let y = SVector::<f64, INTEGRATORS_MAX>::from(y);
        let command = unit * ((&output * &x)[0] + (direct * y)[0]);
        x = &transition * &x + &input * y;
        command
    };
    (0..FLIGHT_TICKS).map(tick).collect()
}

/// The greatest difference over the greatest command. Half the difference of both senses leaves out what is of second
/// order.
fn difference(scenario: &Scenario, axis: Axis) -> f64 {
    let [ahead, back] = [1.0, -1.0].map(|sign| flown(scenario, axis, sign));
    let flown = ahead.iter().zip(&back).map(|(ahead, back)| 0.5 * (ahead - back));
    let (off, peak) = flown.zip(linear(scenario, axis)).fold((0.0_f64, 0.0_f64), |(off, peak), (flown, linear)| {
        (off.max((flown - linear).abs()), peak.max(linear.abs()))
    });
    off / peak
}

/// The same file with a key of `[estimates]`.
fn estimating(text: &str, line: &str) -> String {
    match text.split_once("[estimates]") {
        Some((head, tail)) => format!("{head}[estimates]\n{line}{tail}"),
        None => text.replace("[control]", &format!("[estimates]\n{line}\n\n[control]")),
    }
}

#[test]
fn the_linear_law_commands_what_the_flown_law_commands() {
    // Parts of a sample late as well as whole ones.
    let study = SCENARIO_FILES[1].1;
    let late = [("study, 3 ms", "0.003"), ("study, 14 ms", "0.014")]
        .map(|(name, delay)| (name, study.replace("delay = 0.010", &format!("delay = {delay}"))));
    let texts = SCENARIO_FILES.iter().copied().chain(late.iter().map(|(name, text)| (*name, text.as_str())));
    for (name, text) in texts {
        // The scale is learnt from products of variations, which are of second order in small motions; this loop is not
        // closed.
        let text = estimating(text, "scale_rate = 0.0");
        let whole = Scenario::parse(&text, name).unwrap();
        // An attitude loop alone has no position, so no force is estimated either.
        let attitude_only = Scenario::parse(&estimating(&text, "force_across = 0.0"), name).unwrap();
        for axis in Axis::ALL {
            let scenario = if matches!(axis, Axis::Roll | Axis::Pitch) { &attitude_only } else { &whole };
            let off = difference(scenario, axis);
            println!("{name:15} {:10} {off:.1e}", axis.name());
            let tolerance = if axis == Axis::Vertical { 5e-4 } else { 1e-5 };
            assert!(off < tolerance, "{name} {}: {off:e}", axis.name());
        }
    }
}
