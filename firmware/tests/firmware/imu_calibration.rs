//! Calibration: by itself after boot, and on request; applied, kept, answered in words.

use crate::support::PERIOD_US;
use crate::support::bodies::{Body, Does, GRAVITY_M_PER_S2, RIGHT, Sensor, Wrong};
use crate::support::chip::{Chip, Words};
use crate::support::receiver::{Fed, Local, ordered, report, texts, whichever};
use estimation::imu::Calibration;
use firmware::hardware::Unit;
use firmware::imu;
use firmware::link::acknowledgement::{Acknowledgement, Order};
use firmware::parameters::calibration;
use firmware::parameters::storage::Storage;
use firmware::parameters::table::Name;
use firmware::redundant::Redundant;
use firmware::shared::{Procedure, Reply};
use flight::Mode;
use mavlink::dialects::common::{COMMAND_LONG_DATA, MavCmd, MavResult};
use nalgebra::Vector3;

/// The client: system and component.
const ASKER: Order = ordered(MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION);

/// Two sensors as wrong as data sheets allow.
const FIRST: Wrong = Wrong {
    bias: Vector3::new(0.01, -0.02, 0.005),
    offset: Vector3::new(0.15, -0.1, 0.2),
    factor: Vector3::new(1.01, 0.99, 1.005),
};
const SECOND: Wrong = Wrong {
    bias: Vector3::new(-0.01, 0.0, 0.02),
    offset: Vector3::new(-0.2, 0.1, 0.0),
    factor: Vector3::new(0.99, 1.0, 1.01),
};

/// The six sides, times g.
fn sides() -> [Vector3<f32>; 6] {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    [axes[0], -axes[0], axes[1], -axes[1], axes[2], -axes[2]].map(|axis| axis * GRAVITY_M_PER_S2)
}

/// Results for PREFLIGHT_CALIBRATION so far, taken away.
fn results(shared: &Local) -> Vec<MavResult> {
    let replies = std::iter::from_fn(|| shared.replies.take());
    let result = |reply| match reply {
        Reply::Command(Acknowledgement { order, result }) if whichever(order) == ASKER => result,
        other => panic!("{other:?}"),
    };
    replies.map(result).collect()
}

/// Runs the task on a body's sensors for some seconds, with `each` in between.
fn run(body: &Body, shared: &Local, seconds: u64, each: impl FnMut(u64)) {
    let mut first = Sensor { body, wrong: FIRST, is_second: false };
    body.clock.run(seconds * 1_000_000, imu::run(shared.for_imu(), &body.clock, &mut first, PERIOD_US), each);
}

/// The same with a second sensor that stands by.
fn run_both(body: &Body, shared: &Local, seconds: u64, each: impl FnMut(u64)) {
    let (first, second) =
        (Sensor { body, wrong: FIRST, is_second: false }, Sensor { body, wrong: SECOND, is_second: true });
    body.clock.run(
        seconds * 1_000_000,
        imu::run(shared.for_imu(), &body.clock, &mut Redundant::new(first, second), PERIOD_US),
        each,
    );
}

fn loaded(shared: &Local, unit: Unit) -> Calibration {
    calibration::load((&shared.parameters).into(), unit).unwrap()
}

fn bias(shared: &Local, unit: Unit) -> Vector3<f32> {
    loaded(shared, unit).gyro_bias
}

#[test]
fn the_gyros_bias_is_found_by_itself_after_boot_applied_and_kept() {
    let (body, shared) = (Body::new(), Local::new());
    run(&body, &shared, 2, |now| {
        let Some(sample) = shared.imu.get() else { return };
        let expected = if now < 900_000 { FIRST.bias } else { Vector3::zeros() };
        let settled = !(900_000..=1_200_000).contains(&now);
        assert!(!settled || (sample.value.angular_velocity - expected).norm() < 1e-3, "{now}: {sample:?}");
    });
    assert!((bias(&shared, Unit::First) - FIRST.bias).norm() < 1e-4, "{}", bias(&shared, Unit::First));
    assert!((shared.parameters.get(Name::Imu1GyroY) + 0.02).abs() < 1e-4);
    assert!(texts(&shared).is_empty() && results(&shared).is_empty(), "in silence");
}

#[test]
fn a_vehicle_that_is_moved_at_boot_is_calibrated_once_it_stands_still() {
    let (body, shared) = (Body::new(), Local::new());
    body.shaken.set(0.02);
    run(&body, &shared, 4, |now| {
        if now == 2_500_000 {
            assert_eq!(bias(&shared, Unit::First), Vector3::zeros());
            body.shaken.set(0.0);
        }
    });
    run(&body, &shared, 2, |_| ());
    assert!((bias(&shared, Unit::First) - FIRST.bias).norm() < 1e-4);
    assert!(texts(&shared).is_empty() && results(&shared).is_empty());
}

#[test]
fn arming_ends_a_calibration_that_no_command_started() {
    let (body, shared) = (Body::new(), Local::new());
    run(&body, &shared, 3, |now| {
        if now == 500_000 {
            report(&shared, Mode::Flying, now);
        }
    });
    assert_eq!(bias(&shared, Unit::First), Vector3::zeros());
    assert!(texts(&shared).is_empty());
}

#[test]
fn a_requested_gyro_calibration_is_answered_twice() {
    let (body, shared) = (Body::new(), Local::new());
    run(&body, &shared, 4, |now| {
        if now == 100_000 {
            shared.calibrations.put((Some(Procedure::Gyro), ASKER)).unwrap();
        }
        if now == 200_000 {
            assert_eq!(results(&shared), [MavResult::MAV_RESULT_IN_PROGRESS]);
        }
    });
    assert_eq!(results(&shared), [MavResult::MAV_RESULT_ACCEPTED]);
    assert_eq!(texts(&shared), ["Gyro calibrated"]);
    assert!((bias(&shared, Unit::First) - FIRST.bias).norm() < 1e-4);
}

#[test]
fn what_goes_wrong_is_answered_in_words_and_changes_nothing() {
    type Disturbed = fn(&Body, &Local, u64);
    let cases: [(Procedure, Disturbed, &str); 8] = [
        (Procedure::Gyro, |body, _, _| body.shaken.set(0.02), "Calibration: the vehicle was shaken"),
        (
            Procedure::Gyro,
            |body, _, _| body.rate.set(Vector3::z() * 0.1),
            "Calibration: the gyro reads over 2 deg/s at rest",
        ),
        (Procedure::Gyro, |body, _, _| body.first.set(Does::Faults), "Calibration: took too long"),
        (Procedure::Gyro, |_, shared, now| report(shared, Mode::Flying, now), "Calibration: ended by arming"),
        (Procedure::Gyro, |_, shared, _| shared.hil.raise(), "Calibration: a simulator has the sensors"),
        (
            Procedure::Level,
            |body, _, _| body.up.set(Vector3::new(0.2, 0.0, 1.0) * GRAVITY_M_PER_S2),
            "Not level: tilted by more than 5 degrees",
        ),
        (
            Procedure::OneSide,
            |body, _, _| body.up.set(Vector3::new(0.1, 0.0, 1.0) * GRAVITY_M_PER_S2),
            "Calibration: tilted, or offset over 0.8 m/s^2",
        ),
        (
            Procedure::SixSides,
            |_, shared, _| shared.calibrations.put((None, ASKER)).unwrap(),
            "Calibration: ended by command",
        ),
    ];
    for (procedure, disturb, words) in cases {
        let (body, shared) = (Body::new(), Local::new());
        run(&body, &shared, 9, |now| {
            if now == 1_500_000 {
                shared.calibrations.put((Some(procedure), ASKER)).unwrap();
            }
            if now == 1_501_000 {
                disturb(&body, &shared, now);
            }
        });
        let mut expected = vec![MavResult::MAV_RESULT_IN_PROGRESS, MavResult::MAV_RESULT_FAILED];
        if procedure == Procedure::SixSides {
            expected.push(MavResult::MAV_RESULT_ACCEPTED);
        }
        assert_eq!(results(&shared), expected, "{words}");
        let said = texts(&shared);
        assert!(said.iter().any(|text| text == words), "{said:?}");
        let kept = loaded(&shared, Unit::First);
        assert!((kept.gyro_bias - FIRST.bias).norm() < 1e-4, "as found at boot");
        assert_eq!((kept.offset, kept.scale), (Vector3::zeros(), Vector3::repeat(1.0)));
    }
}

#[test]
fn one_calibration_at_a_time() {
    let (body, shared) = (Body::new(), Local::new());
    run(&body, &shared, 4, |now| {
        if now == 1_500_000 {
            shared.calibrations.put((Some(Procedure::Gyro), ASKER)).unwrap();
            shared.calibrations.put((Some(Procedure::Level), ASKER)).unwrap();
            assert!(shared.calibrations.put((None, ASKER)).is_err());
        }
    });
    use MavResult::{MAV_RESULT_ACCEPTED, MAV_RESULT_IN_PROGRESS, MAV_RESULT_TEMPORARILY_REJECTED};
    assert_eq!(results(&shared), [MAV_RESULT_IN_PROGRESS, MAV_RESULT_TEMPORARILY_REJECTED, MAV_RESULT_ACCEPTED]);
}

#[test]
fn six_sides_and_a_level_calibrate_both_accelerometers() {
    let (body, shared) = (Body::new(), Local::new());
    // Sensors that sit 2 degrees askew in the vehicle.
    let askew = Vector3::new(0.035, 0.0, 0.999_39) * GRAVITY_M_PER_S2;
    run_both(&body, &shared, 60, |now| match now / 1_000 {
        2_500 => shared.calibrations.put((Some(Procedure::SixSides), ASKER)).unwrap(),
        // Each side for 6 s; moved for the first of them.
        time @ 3_000..39_000 => {
            let (index, within) = ((time - 3_000) / 6_000, (time - 3_000) % 6_000);
            body.shaken.set(if within < 1_000 { 0.05 } else { 0.0 });
            body.up.set(sides()[index as usize]);
        }
        40_000 => body.up.set(askew),
        42_000 => shared.calibrations.put((Some(Procedure::Level), ASKER)).unwrap(),
        _ => {}
    });
    let mut expected: Vec<_> = (1..=6).map(|n| format!("Calibration: {n} of 6 sides")).collect();
    expected.extend(["Accelerometer calibrated: now level".into(), "Level calibrated".into()]);
    // The vehicle lay on its z when it was asked, and that counts.
    assert_eq!(texts(&shared), expected);
    use MavResult::{MAV_RESULT_ACCEPTED, MAV_RESULT_IN_PROGRESS};
    let twice = [MAV_RESULT_IN_PROGRESS, MAV_RESULT_ACCEPTED];
    assert_eq!(results(&shared), [twice, twice].concat());
    for (unit, wrong) in [(Unit::First, FIRST), (Unit::Second, SECOND)] {
        let found = loaded(&shared, unit);
        assert!((found.gyro_bias - wrong.bias).norm() < 1e-4, "{unit:?}: {}", found.gyro_bias);
        assert!((found.offset - wrong.offset).norm() < 2e-3, "{unit:?}: {}", found.offset);
        assert!((found.scale.component_mul(&wrong.factor) - Vector3::repeat(1.0)).norm() < 1e-3, "{unit:?}");
        let felt = askew.component_mul(&wrong.factor) + wrong.offset;
        assert!(
            (found.force(&felt) - Vector3::z() * GRAVITY_M_PER_S2).norm() < 5e-3,
            "{unit:?}: {}",
            found.force(&felt)
        );
    }
    // And it is flown: the sample is the corrected one.
    let force = shared.imu.get().unwrap().value.specific_force;
    assert!((force - Vector3::z() * GRAVITY_M_PER_S2).norm() < 6e-3, "{force}");
}

#[test]
fn one_side_finds_the_offsets_of_a_level_vehicle() {
    let (body, shared) = (Body::new(), Local::new());
    run(&body, &shared, 4, |now| {
        if now == 1_500_000 {
            shared.calibrations.put((Some(Procedure::OneSide), ASKER)).unwrap();
        }
    });
    assert_eq!(texts(&shared), ["Accelerometer calibrated: now level"]);
    let force = shared.imu.get().unwrap().value.specific_force;
    assert!((force - Vector3::z() * GRAVITY_M_PER_S2).norm() < 1e-3, "{force}");
}

#[test]
fn a_second_sensor_that_fails_meanwhile_is_reported_and_the_first_calibrated() {
    let (body, shared) = (Body::new(), Local::new());
    run_both(&body, &shared, 6, |now| {
        if now == 2_500_000 {
            shared.calibrations.put((Some(Procedure::OneSide), ASKER)).unwrap();
        }
        if now == 2_900_000 {
            body.second.set(Does::Faults);
        }
    });
    assert_eq!(texts(&shared), ["Calibration: not of the IMU that stands by", "Accelerometer calibrated: now level"]);
    assert_eq!(loaded(&shared, Unit::Second).offset, Vector3::zeros());
    assert!((bias(&shared, Unit::Second) - SECOND.bias).norm() < 1e-4, "found at boot");
}

#[test]
fn what_was_found_survives_a_reboot_and_corrects_the_first_sample() {
    let chip = Chip::erased();
    let (body, shared) = (Body::new(), Local::new());
    let (clock, mut storage) =
        (crate::support::Simulated::default(), Storage::load(Words::<32>(&chip), shared.for_storage()));
    run(&body, &shared, 4, |now| {
        if now == 1_500_000 {
            shared.calibrations.put((Some(Procedure::OneSide), ASKER)).unwrap();
        }
    });
    clock.run(50_000, storage.keep(&clock, shared.for_storage()), |_| ());
    let found = loaded(&shared, Unit::First);

    let (body, shared) = (Body::new(), Local::new());
    Storage::load(Words::<32>(&chip), shared.for_storage());
    assert_eq!(loaded(&shared, Unit::First), found);
    let mut sensor = Sensor { body: &body, wrong: FIRST, is_second: false };
    body.clock.run(3_000, imu::run(shared.for_imu(), &body.clock, &mut sensor, PERIOD_US), |_| ());
    let sample = shared.imu.get().unwrap().value;
    assert!(
        sample.angular_velocity.norm() < 1e-3 && (sample.specific_force.z - GRAVITY_M_PER_S2).abs() < 1e-3,
        "{sample:?}"
    );
}

#[test]
fn stored_rows_and_calibration_are_the_same_thing() {
    let shared = Local::new();
    assert_eq!(loaded(&shared, Unit::First), Calibration::NONE);
    for (name, value) in [(Name::Imu2ScaleX, 1.02), (Name::Imu2OffsetZ, -0.5), (Name::Imu2GyroX, 0.01)] {
        shared.parameters.set(name, value).unwrap();
    }
    for (x, y) in [(0.0, 0.0), (0.05, -0.03), (-0.087, 0.0)] {
        shared.parameters.set(Name::Imu2LevelX, x).unwrap();
        shared.parameters.set(Name::Imu2LevelY, y).unwrap();
        let found = loaded(&shared, Unit::Second);
        // What the level vehicle feels comes out as straight up.
        let up = Vector3::new(x, y, 1.0).normalize() * GRAVITY_M_PER_S2;
        let felt = up.component_div(&Vector3::new(1.02, 1.0, 1.0)) + Vector3::new(0.0, 0.0, -0.5);
        assert!((found.force(&felt) - Vector3::z() * GRAVITY_M_PER_S2).norm() < 1e-4, "{x} {y}");
        calibration::store((&shared.parameters).into(), Unit::Second, &found).unwrap();
        let again = loaded(&shared, Unit::Second);
        assert!((again.level - found.level).norm() < 1e-6);
        assert_eq!((again.offset, again.scale, again.gyro_bias), (found.offset, found.scale, found.gyro_bias));
    }
    // Invalid rows: no level at all beats a wrong one, and that is said.
    shared.parameters.set(Name::Imu2LevelX, 0.09).unwrap();
    shared.parameters.set(Name::Imu2LevelY, 0.09).unwrap();
    let unlevelled = calibration::load((&shared.parameters).into(), Unit::Second).unwrap_err();
    assert_eq!((unlevelled.level, unlevelled.offset.z), (Calibration::NONE.level, -0.5));
    run(&Body::new(), &shared, 1, |_| ());
    assert!(texts(&shared).contains(&"IMU2_LEVEL: above 5 degrees, not used".to_owned()));
}

fn preflight(gyro: f32, accelerometer: f32) -> COMMAND_LONG_DATA {
    let command = MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION;
    COMMAND_LONG_DATA { command, param1: gyro, param5: accelerometer, target_system: 1, ..Default::default() }
}

#[test]
fn the_command_says_what_is_calibrated() {
    let wanted = [
        (preflight(1.0, 0.0), Some(Procedure::Gyro)),
        (preflight(0.0, 1.0), Some(Procedure::SixSides)),
        (preflight(0.0, 2.0), Some(Procedure::Level)),
        (preflight(0.0, 4.0), Some(Procedure::OneSide)),
        (preflight(0.0, 0.0), None),
    ];
    for (command, procedure) in wanted {
        let shared = Local::new();
        Fed::new(&shared).message(&command, 0);
        let asked = shared.calibrations.take().map(|(procedure, order)| (procedure, whichever(order)));
        assert_eq!(asked, Some((procedure, ASKER)));
        assert!(results(&shared).is_empty(), "the task answers");
    }
    let magnetometer = COMMAND_LONG_DATA { param2: 1.0, ..preflight(0.0, 0.0) };
    for other in [preflight(1.0, 1.0), preflight(2.0, 0.0), preflight(0.0, 3.0), preflight(f32::NAN, 0.0), magnetometer]
    {
        let shared = Local::new();
        Fed::new(&shared).message(&other, 0);
        assert_eq!(results(&shared), [MavResult::MAV_RESULT_UNSUPPORTED]);
        assert_eq!(shared.calibrations.take(), None);
    }
}

#[test]
fn it_is_refused_while_armed_and_with_a_simulator_in_words() {
    let armed: fn(&Local) = |shared| report(shared, Mode::Flying, 0);
    let simulated: fn(&Local) = |shared| shared.hil.raise();
    for (refuse, words) in
        [(armed, "Calibration: only while disarmed"), (simulated, "Calibration: a simulator has the sensors")]
    {
        let shared = Local::new();
        refuse(&shared);
        Fed::new(&shared).message(&preflight(1.0, 0.0), 0);
        assert_eq!(results(&shared), [MavResult::MAV_RESULT_DENIED]);
        assert_eq!(texts(&shared), [words]);
        assert_eq!(shared.calibrations.take(), None);
    }
}

#[test]
fn a_right_sensor_needs_no_correction() {
    let (body, shared) = (Body::new(), Local::new());
    let mut sensor = Sensor { body: &body, wrong: RIGHT, is_second: false };
    body.clock.run(2_000_000, imu::run(shared.for_imu(), &body.clock, &mut sensor, PERIOD_US), |_| ());
    assert!(bias(&shared, Unit::First).norm() < 1e-5);
}
