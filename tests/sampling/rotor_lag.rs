//! The linearised sampled loop against the whole simulation, rotors and six degrees of freedom: what the one predicts,
//! the other shows. `cargo test -p host-sim rotor_lag -- --nocapture` prints the table.
//!
//! The paper's vehicle and Table I at 100 Hz, hovering, with rotors so strong that none saturates: only their lag and
//! the delay matter. Rotors lag in *speed*; their thrust, its square, has the same lag for small motions.

use host_sim::flight::Flight;
use scenario::sampled_loop::Axis;
use scenario::{PAPER, Scenario};

/// The start's turn about each body axis, degrees: 1.7e-4 rad. The law is linear up to about 4 M_theta / k_theta = 8e-3
/// rad.
const START_DEG: f64 = 0.01;
/// Beyond the rest of the start in a decaying motion, and within the linear range.
const GROWN_RAD: f64 = 2e-3;
/// Below this only the rounding of single precision is left of the motion.
const STILL_RAD: f64 = 1e-6;

/// Table I hovering at the origin, with rotors of the given lag, ms, and the given delay, s.
fn hovering(lag_ms: f64, delay: f64) -> Scenario {
    let (head, _) = PAPER.split_once("[initial]").unwrap();
    let text = format!(
        "{head}
[rotors]
position = [[0.5, 0.5, 0.0], [-0.5, 0.5, 0.0], [-0.5, -0.5, 0.0], [0.5, -0.5, 0.0]]
spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]
thrust_coefficient = 1e-5
drag_coefficient = 5e-6
speed = [0.0, 2000.0]
lag = {:e}

[sampling]
delay = {delay}

[initial]
euler_deg = [{START_DEG}, {START_DEG}, {START_DEG}]

[reference]
kind = \"hover\"
position = [0.0, 0.0, 0.0]
",
        1e-3 * lag_ms
    );
    Scenario::parse(&text, "hovering").unwrap()
}

/// The greatest spectral radius of the six loops, and whose it is.
fn predicted(scenario: &Scenario) -> (f64, Axis) {
    let model = scenario.loops().unwrap();
    let radii = Axis::ALL.map(|axis| (model.spectral_radius(axis), axis));
    radii.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

/// The greatest angle, rad, between the body and its desired attitude in each stretch of two seconds.
fn peaks(scenario: &Scenario, stretches: usize) -> Vec<f64> {
    let mut flight = Flight::new(scenario).unwrap();
    let stretch = |_| {
        (0..200).fold(0.0_f64, |peak, _| {
            let tick = flight.tick().unwrap();
            assert!(!tick.clipped, "a rotor saturated: stronger ones are needed for this test");
            peak.max(4.0 * f64::from(tick.diagnostics.mrp.norm()).atan())
        })
    };
    (0..stretches).map(stretch).collect()
}

/// Whether the motion grows: still growing after 20 s, or grown until the saturations hold it.
fn grows(scenario: &Scenario) -> bool {
    let peaks = peaks(scenario, 10);
    let (early, late) = (peaks[4], peaks[9]);
    late > GROWN_RAD || (late > early && late > STILL_RAD)
}

#[test]
fn five_milliseconds_of_lag_settle() {
    let scenario = hovering(5.0, 0.0);
    assert!(predicted(&scenario).0 < 1.0);
    let peaks = peaks(&scenario, 10);
    assert!(peaks[9] < STILL_RAD, "{peaks:?}");
}

#[test]
fn ten_milliseconds_and_more_end_in_a_limit_cycle() {
    let mut amplitudes = Vec::new();
    for lag in [10.0, 20.0, 30.0] {
        let scenario = hovering(lag, 0.0);
        assert!(predicted(&scenario).0 > 1.0);
        let peaks = peaks(&scenario, 20);
        assert!(peaks[19] > GROWN_RAD, "{lag} ms: {peaks:?}");
        // Sustained: neither growing nor dying.
        assert!((peaks[19] / peaks[18] - 1.0).abs() < 0.05, "{lag} ms: {peaks:?}");
        amplitudes.push(peaks[19]);
    }
    assert!(amplitudes.is_sorted(), "{amplitudes:?}");
}

#[test]
fn one_sample_of_delay_cannot_hold_still() {
    let scenario = hovering(0.0, 0.01);
    assert!(predicted(&scenario).0 > 1.0);
    assert!(grows(&scenario));
    assert!(!grows(&hovering(0.0, 0.0)));
}

#[test]
fn the_lag_at_which_the_simulation_turns_is_the_lag_at_which_the_spectral_radius_passes_one() {
    let boundary = |unstable: &dyn Fn(f64) -> bool, halvings: u32| {
        let (mut stable, mut grown) = (5.0, 12.0);
        assert!(!unstable(stable) && unstable(grown));
        for _ in 0..halvings {
            let middle = 0.5 * (stable + grown);
            if unstable(middle) { grown = middle } else { stable = middle }
        }
        0.5 * (stable + grown)
    };
    let linear = boundary(&|lag| predicted(&hovering(lag, 0.0)).0 > 1.0, 40);
    let flown = boundary(&|lag| grows(&hovering(lag, 0.0)), 14);
    println!("crossing: predicted at {linear:.3} ms of lag, flown at {flown:.3} ms");
    assert!((linear - 8.5).abs() < 0.2, "{linear}");
    // The plant applies each step's mid thrust: exact to (step / lag)^2 / 24 = 0.06 %. Half an oscillation more or less
    // in a stretch moves the peaks' ratio over 10 s by a few per cent, hence the growth per tick by less than 1e-4.
    assert!((flown / linear - 1.0).abs() < 0.01, "{flown} ms flown, {linear} ms predicted");
}

#[test]
fn the_table_of_lags() {
    println!(
        "lag [ms]  delay [ms]  spectral radius  worst loop  flown after 20 s, from {START_DEG} deg about each axis"
    );
    for (lag, delay) in
        [(0.0, 0.0), (5.0, 0.0), (8.0, 0.0), (9.0, 0.0), (10.0, 0.0), (20.0, 0.0), (30.0, 0.0), (0.0, 0.01)]
    {
        let scenario = hovering(lag, delay);
        let (radius, axis) = predicted(&scenario);
        let late = peaks(&scenario, 10)[9];
        let seen = if late < STILL_RAD { "still" } else { "moving" };
        println!(
            "{lag:8}  {:10}  {radius:15.4}  {:10}  {seen}, {:.2e} deg",
            1e3 * delay,
            axis.name(),
            late.to_degrees()
        );
        assert_eq!(grows(&scenario), radius > 1.0, "lag {lag} ms, delay {delay} s");
    }
}
