use super::*;

fn without_idle(linear: f32) -> Motor {
    Motor { linear, ..Motor::IDEAL }
}

#[test]
fn a_round_trip_keeps_single_precision() {
    for linear in [0.0, 1e-6, 0.1, 0.5, 0.9, 1.0] {
        let curve = ThrustCurve::new(7.5, without_idle(linear)).unwrap();
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
        let curve = ThrustCurve::new(3.0, without_idle(linear)).unwrap();
        assert_eq!(curve.command(0.0, 1.0), 0.0);
        assert!((curve.command(3.0, 1.0) - 1.0).abs() <= f32::EPSILON);
        assert!((curve.thrust(1.0, 1.0) - 3.0).abs() <= 3.0 * f32::EPSILON);
    }
}

#[test]
fn thrusts_out_of_reach_give_the_nearest_command_and_a_nan_stops_the_rotor() {
    let curve = ThrustCurve::new(3.0, without_idle(0.4)).unwrap();
    assert_eq!(curve.command(-1.0, 1.0), 0.0);
    assert_eq!(curve.command(f32::INFINITY, VOLTAGE_RATIO_MAX), 1.0);
    assert_eq!(curve.command(f32::NAN, 1.0), 0.0);
}

#[test]
fn a_sagging_battery_does_not_change_the_thrust() {
    let curve = ThrustCurve::new(4.0, without_idle(0.2)).unwrap();
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
    assert_eq!(ThrustCurve::new(1.0, without_idle(-0.1)).unwrap_err().reason, Reason::Negative);
    let bent = ParameterError { field: "rotors.thrust_curve", reason: Reason::Above(1.0) };
    assert_eq!(ThrustCurve::new(1.0, without_idle(1.1)).unwrap_err(), bent);
    assert_eq!(ThrustCurve::new(1.0, without_idle(f32::NAN)).unwrap_err().reason, Reason::NotFinite);
    assert_eq!(ThrustCurve::new(0.0, without_idle(0.5)).unwrap_err().field, "rotors.thrust_max");
    assert_eq!(Battery::new(0.0).unwrap_err().field, "battery.nominal");
}

#[test]
fn an_idle_that_no_motor_has_is_refused() {
    let refused = |idle| ThrustCurve::new(1.0, Motor { idle, ..Motor::IDEAL }).unwrap_err();
    assert_eq!(refused(0.31), ParameterError { field: "rotors.idle", reason: Reason::Above(IDLE_MAX) });
    assert_eq!(refused(-0.01).reason, Reason::Negative);
    assert_eq!(refused(f32::NAN).reason, Reason::NotFinite);
}

#[test]
fn every_thrust_but_zero_is_answered_by_idle_at_least() {
    for (linear, idle) in [(0.0, 0.055), (0.3, 0.055), (1.0, 0.3), (0.0, 0.0)] {
        let curve = ThrustCurve::new(3.0, Motor { linear, idle }).unwrap();
        for ratio in [VOLTAGE_RATIO_MIN, 1.0, VOLTAGE_RATIO_MAX] {
            for step in 1..=10_000 {
                let command = curve.command(3e-4 * step as f32, ratio);
                assert!((idle..=1.0).contains(&command), "{linear} {idle} {ratio} {step}: {command}");
            }
            assert!(curve.command(f32::MIN_POSITIVE, ratio) >= idle);
            assert_eq!([curve.command(0.0, ratio), curve.command(f32::NAN, ratio)], [0.0; 2]);
        }
    }
}

#[test]
fn the_least_thrust_is_delivered_as_asked_with_every_battery_that_is_made_up_for() {
    for (linear, idle) in [(0.0, 0.055), (0.3, 0.055), (1.0, 0.3), (0.5, 0.0)] {
        let curve = ThrustCurve::new(3.0, Motor { linear, idle }).unwrap();
        let least = curve.thrust_min();
        for step in 0..=100 {
            let ratio = VOLTAGE_RATIO_MIN + (VOLTAGE_RATIO_MAX - VOLTAGE_RATIO_MIN) * 0.01 * step as f32;
            let command = curve.command(least, ratio);
            let delivered = curve.thrust(command, ratio);
            assert!(command >= idle && (delivered - least).abs() <= 1e-6 * least, "{ratio}: {delivered} {least}");
        }
        // No less would do: with the fullest battery it is idle itself.
        assert!((curve.command(least, VOLTAGE_RATIO_MIN) - idle).abs() <= 1e-6 * idle);
    }
}
