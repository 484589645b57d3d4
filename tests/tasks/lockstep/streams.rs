//! A stream of moving setpoints from a ground station, all the way to the vehicle.

use super::flight::Flight;
use ::flight::Mode;

/// Where an eight of 2 m by 1 m in 7.4 s is at a time, s, 1 m high, with its velocity and acceleration.
fn eight(time: f64) -> [[f32; 3]; 3] {
    let rate = 0.85;
    let ((sin, cos), (sin2, cos2)) = ((rate * time).sin_cos(), (2.0 * rate * time).sin_cos());
    let level = |x: f64, y: f64, z: f64| [x as f32, y as f32, z as f32];
    [
        level(sin, 0.5 * sin2, 1.0),
        level(rate * cos, rate * cos2, 0.0),
        level(-rate * rate * sin, -2.0 * rate * rate * sin2, 0.0),
    ]
}

#[test]
fn an_eight_streamed_at_50_hz_is_flown_to_centimetres_and_that_is_said() {
    let mut flight = Flight::in_the_air();
    let begin = flight.now();
    let mut worst = 0.0_f32;
    for number in 0..3_500 {
        let [position, velocity, acceleration] = eight(f64::from(number) * 0.02);
        flight.station.stream(position, velocity, acceleration);
        flight.pass(0.02);
        if number > 2_500 {
            let [there, ..] = eight(f64::from(number + 1) * 0.02);
            worst = worst.max(flight.distance(there));
        }
    }
    println!("{:.1} cm from the eight, in the last 20 s", 100.0 * worst);
    assert!(worst < 0.05, "{worst} m");
    assert_eq!(flight.report().mode, Mode::Flying);
    let said = |words: &str| flight.station.received(words).map(|time| (time - begin) / 1_000_000);
    let smoothed = said("Setpoints smoothed: not caught up with yet");
    assert!(smoothed.is_some_and(|seconds| seconds < 4), "{:?}", flight.station.texts());
    let flown = said("Setpoints flown as sent");
    assert!(flown.is_some_and(|seconds| seconds < 45), "{:?}", flight.station.texts());
    println!("said so after {flown:?} s");
    assert_eq!(said("Setpoints too fast"), None);
}

#[test]
fn an_eight_too_fast_for_the_bounds_is_smoothed_and_the_factor_said() {
    let mut flight = Flight::in_the_air();
    for number in 0..1_000 {
        let [position, [vx, vy, vz], acceleration] = eight(f64::from(number) * 0.02 * 1.5);
        flight.station.stream(position, [1.5 * vx, 1.5 * vy, 1.5 * vz], acceleration.map(|a| 2.25 * a));
        flight.pass(0.02);
    }
    // By snap, which turns sharpest: 4.2 m/s^4 times 1.5 to the fourth, of 6.089: 1.37 times slower.
    let said = |words: &str| flight.station.received(words).is_some();
    let fits =
        ["1.4", "1.5"].iter().any(|slower| said(&format!("Setpoints too fast: smoothed, {slower}x slower fits")));
    assert!(fits, "{:?}", flight.station.texts());
    assert!(!said("Setpoints flown as sent"));
}
