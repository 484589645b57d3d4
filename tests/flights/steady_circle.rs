//! A constant force and a wrong thrust scale, both within their levels: the circle is flown as if nothing were the
//! matter. `cargo test -p host-sim steady_circle -- --nocapture` prints how far it was off.

use crate::support::extended::{law, vehicle, with_constants};
use host_sim::flight::Flight;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::reality::disturbance::Disturbance;
use scenario::reality::truth::Truth;
use scenario::timing::Timing;

/// How long it is flown, and from when on it has to be there.
const FLIGHT_S: f64 = 60.0;
const THERE_S: f64 = 40.0;

/// Greatest distance from the reference from then on, m: in no force or a vertical one, 0.13 mm of which are the
/// circle's own; and in one across, where thrust has to vary all the way round, and what is held for a tick and lags by
/// 5 ms is late: 0.15 mm for each 5 ms, whatever the scale.
const DISTANCE_MAX_M: [f64; 2] = [2e-4, 4e-4];

/// The Hummingbird's circle in air that does nothing, with a force per mass and rotors that deliver `thrust_scale` of
/// what is commanded.
fn circle(acceleration: Vector3<f64>, thrust_scale: f64) -> Scenario {
    let mut scenario = vehicle("hummingbird");
    let timing = scenario.timing;
    scenario.timing = Timing { ticks: (FLIGHT_S / timing.period()) as u64, ..timing };
    scenario.reality.drag = None;
    scenario.configuration = with_constants(&scenario.configuration, |p| p.drag_across = 0.0);
    scenario.reality.disturbance = Some(Disturbance { acceleration, torque: Vector3::zeros(), start: 0.0 });
    let truth = Truth::model(scenario.configuration.vehicle());
    scenario.reality.truth = Some(Truth { thrust_scale, ..truth });
    scenario
}

/// How far a flight was off once it had to be there, m, and the thrust scale at its end.
fn flown(scenario: &Scenario) -> (f64, f32) {
    let mut flight = Flight::new(scenario).unwrap();
    let (mut off, mut scale) = (0.0_f64, 0.0);
    for number in 0..scenario.timing.ticks {
        let tick = flight.tick().unwrap();
        if number as f64 * scenario.timing.period() >= THERE_S {
            off = off.max((tick.state.position - tick.reference.position.cast::<f64>()).norm());
        }
        scale = tick.estimates.unwrap().scale;
    }
    (off, scale)
}

#[test]
fn a_constant_force_and_a_wrong_thrust_scale_together_leave_no_offset_on_a_circle() {
    let p = law(&vehicle("hummingbird").configuration).parameters;
    let mut missed = Vec::new();
    let [vertical, across] = DISTANCE_MAX_M;
    for (name, force, most) in [
        ("nowhere", Vector3::zeros(), vertical),
        ("up", Vector3::z() * 0.9, vertical),
        ("down", Vector3::z() * -0.9, vertical),
        ("across", Vector3::x() * 0.9, across),
    ] {
        for scale in [0.93, 1.0, 1.07] {
            assert!((f64::from(p.scale_least)..f64::from(p.scale_greatest)).contains(&scale));
            let (off, learnt) = flown(&circle(force, scale));
            println!("0.9 m/s^2 {name:7}, thrust scale {scale}: {:.4} mm off, learnt {learnt:.4}", 1e3 * off);
            assert!((f64::from(learnt) - scale).abs() < 1e-3, "{name}, {scale}: learnt {learnt}");
            missed.extend((off > most).then_some((name, scale, off)));
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}
