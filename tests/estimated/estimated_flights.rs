//! The certified Hummingbird, drag and rotor lag on, flown on the estimate: an IMU like a BMI088, poses of 1 mm and 0.3
//! degrees, 100 a second, late. `cargo test -p host-sim estimated_flights -- --nocapture` prints the table that stands
//! in `docs/measured.md`.

use crate::support::extended::vehicle;
use host_sim::flight::tasks::{hover, recovery};
use host_sim::flight::{Cause, Flight};
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::reality::estimator::{Estimator, Outage};
use scenario::timing::Timing;

const NOISY_SENSORS: Estimator = Estimator {
    imu_noise: 1.0,
    pose_every: 10,
    pose_delay: 20,
    position_noise: 1e-3,
    attitude_noise: 0.3 * std::f64::consts::PI / 180.0,
    dropout: 0.0,
    outage: None,
    seed: 1,
};

fn hummingbird() -> Scenario {
    vehicle("hummingbird")
}

/// What a flight showed, m.
struct Shown {
    /// Of the last two thirds.
    rms: f64,
    /// Greatest distance from the reference in the last two thirds.
    greatest: f64,
    height_lost: f64,
    /// RMS of the estimate's error, of the last two thirds.
    estimate: f64,
}

fn fly(mut scenario: Scenario, estimator: Option<Estimator>) -> Shown {
    scenario.reality.estimator = estimator;
    let mut flight = Flight::new(&scenario).unwrap();
    let (mut squares, mut misses, mut count) = (0.0, 0.0, 0.0_f64);
    let mut shown = Shown { rms: 0.0, greatest: 0.0, height_lost: 0.0, estimate: 0.0 };
    for number in 0..scenario.timing.ticks {
        let tick = flight.tick().unwrap();
        let position = tick.state.position;
        shown.height_lost = shown.height_lost.max(scenario.initial.position.z - position.z);
        if number < scenario.timing.ticks / 3 {
            continue;
        }
        let error = (position - tick.reference.position.map(f64::from)).norm();
        let measured = tick.measured.map_or(position, |measured| measured.position.map(f64::from));
        squares += error * error;
        misses += (measured - position).norm_squared();
        count += 1.0;
        shown.greatest = shown.greatest.max(error);
    }
    (shown.rms, shown.estimate) = ((squares / count).sqrt(), (misses / count).sqrt());
    shown
}

fn circle() -> Scenario {
    let circle = hummingbird();
    Scenario { timing: Timing { ticks: 2_000, ..circle.timing }, ..circle }
}

#[test]
fn late_poses_cost_millimetres_and_make_nothing_oscillate() {
    let hovering = || hover(&hummingbird(), Vector3::zeros(), 20.0).unwrap();
    let turned = || recovery(&hummingbird(), 15.0).unwrap();
    let known = fly(turned(), None).height_lost;
    println!(
        "poses late by: hover RMS, greatest; circle RMS; estimate RMS, mm; height lost in recovery, m ({known:.2} on the truth)"
    );
    for delay in [20, 50, 100, 150] {
        let sensors = Some(Estimator { pose_delay: delay, ..NOISY_SENSORS });
        let (still, round, recovered) = (fly(hovering(), sensors), fly(circle(), sensors), fly(turned(), sensors));
        println!(
            "{delay:3} ms: {:.1}, {:.1}; {:.1}; {:.1}; {:.2}",
            1e3 * still.rms,
            1e3 * still.greatest,
            1e3 * round.rms,
            1e3 * round.estimate,
            recovered.height_lost
        );
        assert!(still.rms < 5e-3 && still.greatest < 15e-3, "{delay} ms: {}, {}", still.rms, still.greatest);
        assert!(round.rms < 20e-3, "{delay} ms: {}", round.rms);
        assert!((recovered.height_lost / known - 1.0).abs() < 0.2, "{delay} ms: {}", recovered.height_lost);
        assert!(recovered.rms < 0.4, "{delay} ms: it stays away by {}", recovered.rms);
    }
}

/// The Hummingbird with control at so many hertz.
fn hummingbird_at(rate: u32) -> Scenario {
    let text = include_str!("../../vehicles/hummingbird.toml").replace("rate = 100.0 ", &format!("rate = {rate}.0 "));
    Scenario::parse(&text, "vehicles/hummingbird.toml").unwrap()
}

#[test]
fn at_any_rate_the_estimate_is_as_near_and_the_vehicle_too() {
    println!("Hz: hover RMS, greatest; estimate RMS, mm; height lost in recovery, m");
    for rate in [50, 100, 250, 500, 1_000] {
        let vehicle = hummingbird_at(rate);
        let still = fly(hover(&vehicle, Vector3::zeros(), 12.0).unwrap(), Some(NOISY_SENSORS));
        let recovered = fly(recovery(&vehicle, 10.0).unwrap(), Some(NOISY_SENSORS));
        let [rms, greatest, estimate] = [still.rms, still.greatest, still.estimate].map(|metres| 1e3 * metres);
        println!("{rate:4}: {rms:.1}, {greatest:.1}; {estimate:.1}; {:.2}", recovered.height_lost);
        assert!(still.rms < 5e-3 && still.estimate < 3e-3, "{rate} Hz: {rms}, {estimate} mm");
        assert!(recovered.height_lost < 1.2, "{rate} Hz: {} m", recovered.height_lost);
    }
}

#[test]
fn half_a_second_without_poses_is_flown_through() {
    let outage = Some(Outage { start: 8.0, duration: 0.5 });
    for (name, scenario) in [("hover", hover(&hummingbird(), Vector3::zeros(), 12.0).unwrap()), ("circle", circle())] {
        let shown = fly(scenario, Some(Estimator { outage, ..NOISY_SENSORS }));
        println!("{name}: greatest error {:.1} mm", 1e3 * shown.greatest);
        assert!(shown.greatest < 0.1, "{name}: {}", shown.greatest);
    }
}

#[test]
fn poses_that_come_seldom_or_not_always_are_enough() {
    for (pose_every, dropout) in [(5, 0.0), (100, 0.0), (10, 0.5)] {
        let scenario = hover(&hummingbird(), Vector3::zeros(), 12.0).unwrap();
        let shown = fly(scenario, Some(Estimator { pose_every, dropout, ..NOISY_SENSORS }));
        println!("{} Hz, {dropout} lost: hover RMS {:.1} mm", 1000 / pose_every, 1e3 * shown.rms);
        assert!(shown.rms < 10e-3, "{pose_every} ms, {dropout}: {}", shown.rms);
    }
}

#[test]
fn a_flight_begins_on_a_proven_estimate_or_not_at_all() {
    let mut scenario = hover(&hummingbird(), Vector3::zeros(), 1.0).unwrap();
    scenario.reality.estimator = Some(Estimator { dropout: 0.99, ..NOISY_SENSORS });
    let error = Flight::new(&scenario).unwrap().tick().unwrap_err();
    assert!(matches!(error.cause, Cause::Estimate(_)), "{error}");
    assert_eq!(error.to_string(), "at 0 s: no state to fly on. Estimator: not started, no consistent poses");
}
