//! Flights on which the second design's net lost vehicles that the law had held, and a cone that never ended: minutes
//! of noise in wind, and two flights of a campaign with slow rotors and weak yaw.
//! `cargo test -p host-sim progress -- --nocapture` prints how far each was off.

use host_sim::flight::Flight;
use host_sim::studies::campaign::draw::circumstances;
use scenario::Scenario;
use std::path::Path;

/// The greatest distance from the reference from `since`, s, on, m, and how often the law was slowed.
fn flown(scenario: &Scenario, since: f64) -> (f64, u32) {
    let mut flight = Flight::new(scenario).unwrap();
    let (mut off, period) = (0.0_f64, scenario.timing.period());
    for number in 0..scenario.timing.ticks {
        let tick = flight.tick().unwrap();
        if number as f64 * period >= since {
            off = off.max((tick.state.position - tick.reference.position.map(f64::from)).norm());
        }
    }
    (off, flight.fallback_times())
}

fn read(name: &str) -> Scenario {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/proof/law_inputs");
    Scenario::load(&folder.join(name)).unwrap()
}

#[test]
fn minutes_of_noise_in_a_turbulent_wind_keep_a_vehicle_near_and_its_law_its_own() {
    for name in ["hb-noise-wind.toml", "study-noise-wind.toml"] {
        let (off, slowed) = flown(&read(name), 0.0);
        println!("{name}: at most {off:.2} m off, slowed {slowed} times");
        assert!(off < 0.6 && slowed == 0, "{name}: {off} m, {slowed}");
    }
}

#[test]
fn slow_rotors_and_weak_yaw_leave_no_cone() {
    let scenario = read("coning.toml");
    for number in [818, 855] {
        let (off, slowed) = flown(&circumstances(&scenario, &scenario.campaign.ranges, 0, number), 20.0);
        println!("flight {number}: at most {off:.3} m off after 20 s, slowed {slowed} times");
        assert!(off < 0.2, "{number}: {off} m");
    }
}
