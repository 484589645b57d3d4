use super::*;

#[test]
fn a_round_trip_keeps_single_precision() {
    for linear in [0.0, 1e-6, 0.1, 0.5, 0.9, 1.0] {
        let curve = ThrustCurve::new(7.5, linear).unwrap();
        for i in 0..=100_000 {
            // Down to a millionth of full thrust.
            let thrust = 7.5 * (i as f32 / 100_000.0) * (i as f32 / 100_000.0);
            let back = curve.thrust(curve.command(thrust, 1.0), 1.0);
            assert!((back - thrust).abs() <= 8.0 * f32::EPSILON * thrust, "{linear} {thrust} {back}");
        }
    }
}

#[test]
fn nothing_is_no_command_and_full_thrust_is_a_full_one() {
    for linear in [0.0, 0.3, 1.0] {
        let curve = ThrustCurve::new(3.0, linear).unwrap();
        assert_eq!(curve.command(0.0, 1.0), 0.0);
        assert!((curve.command(3.0, 1.0) - 1.0).abs() <= f32::EPSILON);
        assert!((curve.thrust(1.0, 1.0) - 3.0).abs() <= 3.0 * f32::EPSILON);
    }
}

#[test]
fn thrusts_out_of_reach_give_the_nearest_command_and_a_nan_stops_the_rotor() {
    let curve = ThrustCurve::new(3.0, 0.4).unwrap();
    assert_eq!(curve.command(-1.0, 1.0), 0.0);
    assert_eq!(curve.command(f32::INFINITY, VOLTAGE_RATIO_MAX), 1.0);
    assert_eq!(curve.command(f32::NAN, 1.0), 0.0);
}

#[test]
fn a_sagging_battery_does_not_change_the_thrust() {
    let curve = ThrustCurve::new(4.0, 0.2).unwrap();
    let battery = Battery::new(16.0).unwrap();
    for voltage in [13.0, 14.8, 16.0, 16.8] {
        let ratio = battery.ratio(voltage, 0);
        let command = curve.command(2.0, ratio);
        // The motor's own view: a nominal battery with the command it effectively sees.
        let seen = curve.thrust(command * voltage / 16.0, 1.0);
        assert!((seen - 2.0).abs() < 2e-6, "{voltage} {seen}");
    }
}

#[test]
fn compensation_stays_within_its_range() {
    let battery = Battery::new(16.0).unwrap();
    assert_eq!(battery.ratio(9.0, 0), VOLTAGE_RATIO_MAX);
    assert_eq!(battery.ratio(31.0, 0), VOLTAGE_RATIO_MIN);
}

#[test]
fn without_a_believable_reading_there_is_no_compensation() {
    let battery = Battery::new(16.0).unwrap();
    for voltage in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -12.0, 7.9, 33.0] {
        assert_eq!(battery.ratio(voltage, 0), 1.0);
    }
    assert_eq!(battery.ratio(12.8, VOLTAGE_STALE_AFTER_US), 1.0);
    assert_eq!(battery.ratio(12.8, VOLTAGE_STALE_AFTER_US - 1), 1.25);
}

#[test]
fn curves_that_bend_the_wrong_way_are_refused() {
    assert_eq!(ThrustCurve::new(1.0, -0.1).unwrap_err().reason, Reason::Negative);
    let bent = ParameterError { field: "rotors.curve", reason: Reason::Above(1.0) };
    assert_eq!(ThrustCurve::new(1.0, 1.1).unwrap_err(), bent);
    assert_eq!(ThrustCurve::new(1.0, f32::NAN).unwrap_err().reason, Reason::NotFinite);
    assert_eq!(ThrustCurve::new(0.0, 0.5).unwrap_err().field, "rotors.thrust_max");
    assert_eq!(Battery::new(0.0).unwrap_err().field, "battery.nominal");
}
