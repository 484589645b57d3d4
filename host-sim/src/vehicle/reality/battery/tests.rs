//! Sag against Ohm's law, power against the command, and the charge against the time.

use super::*;

fn battery() -> Battery {
    Battery {
        full_voltage: 12.6,
        empty_voltage: 10.5,
        resistance: 0.05,
        capacity: 7200.0,
        charge: 1.0,
        efficiency: 0.6,
        nominal_voltage: 12.6,
    }
}

#[test]
fn the_voltage_sags_by_resistance_times_current_and_the_power_is_delivered() {
    for power in [0.0, 1.0, 30.0, 120.0, 300.0] {
        let mut state = BatteryState::new(&battery());
        state.draw(power, 1e-3);
        let (voltage, current) = (state.voltage(), state.current());
        assert!((12.6 - voltage - 0.05 * current).abs() < 1e-12);
        assert!((voltage * current - power / 0.6).abs() < 1e-9, "{power}: {voltage} {current}");
        // The efficient one of the two solutions.
        assert!(voltage >= 6.3 && (power > 0.0) == (current > 0.0));
        assert!((state.ratio() - voltage / 12.6).abs() < 1e-15);
    }
}

#[test]
fn what_it_cannot_deliver_it_gives_all_it_can() {
    let mut state = BatteryState::new(&battery());
    // At most E^2 / 4R = 793.8 W electrical, 476 W at the shafts.
    state.draw(600.0, 1e-3);
    assert!((state.voltage() - 6.3).abs() < 1e-12 && (state.current() - 126.0).abs() < 1e-9);
}

#[test]
fn it_runs_down_by_what_is_drawn_and_ends() {
    let ideal = Battery { resistance: 0.0, empty_voltage: 12.6, ..battery() };
    let mut state = BatteryState::new(&ideal);
    // 12.6 V, 0.6: 75.6 W at the shafts are 10 A, 7200 A s last 720 s.
    let mut seconds = 0;
    while state.voltage() > 0.0 && seconds < 10_000 {
        state.draw(75.6, 1.0);
        seconds += 1;
    }
    assert_eq!(seconds, 721);
    assert_eq!(state.current(), 0.0);
    let half = BatteryState::new(&Battery { charge: 0.5, ..battery() });
    assert!((half.voltage() - 11.55).abs() < 1e-12);
}
