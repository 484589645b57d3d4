//! Motors whose controllers answer how fast they turn.

use super::*;
use firmware::parameters::table::Name;

/// With `MOT_DSHOT` set, 5 s after boot.
fn answering(faults: &[&str]) -> Flown {
    static SESSIONS: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
    let session = SESSIONS.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let file = std::env::temp_dir().join(format!("sitl-answering-{}-{session}", std::process::id()));
    let mut set = Flown::boot(STUDY, &[], Some(file.clone()));
    set.pass(1.0);
    set.sitl.shared.parameters.set(Name::MotorProtocol, 1.0).unwrap();
    set.pass(1.0);
    let mut flown = Flown::boot(STUDY, faults, Some(file.clone()));
    flown.pass(5.0);
    std::fs::remove_file(&file).unwrap();
    flown
}

/// When a text was first sent, s.
fn time_of(flown: &Flown, text: &str) -> Option<f64> {
    let texts = flown.sitl.texts.borrow();
    texts.iter().find(|(_, said)| said.contains(text)).map(|(time, _)| *time as f64 * 1e-6)
}

fn speeds(flown: &Flown) -> [Option<f32>; 4] {
    flown.sitl.shared.rotor_speeds.get().unwrap().value
}

#[test]
fn rotor_speeds_are_the_motors_within_a_percent_and_blame_nobody() {
    let mut flown = answering(&[]);
    assert_eq!(speeds(&flown), [Some(0.0); 4]);
    flown.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0);
    flown.command(MavCmd::MAV_CMD_NAV_TAKEOFF, 0.0);
    flown.pass(12.0);
    assert_eq!(flown.mode(), Mode::Holding, "{:?}", flown.sitl.texts);
    for (speed, thrust) in speeds(&flown).into_iter().zip(flown.sitl.hardware.thrusts()) {
        let (speed, real) = (f64::from(speed.unwrap()), (thrust / 5.57e-6).sqrt());
        assert!((speed / real - 1.0).abs() < 0.01, "{speed} {real}");
    }
    flown.command(MavCmd::MAV_CMD_NAV_LAND, 0.0);
    flown.pass(12.0);
    assert!(matches!(flown.mode(), Mode::Checks | Mode::Ready), "{:?}", flown.sitl.texts);
    assert!(!flown.said("Rotor"), "{:?}", flown.sitl.texts);
}

#[test]
fn without_the_parameter_nothing_is_published() {
    let mut flown = Flown::boot(STUDY, &[], None);
    flown.pass(3.0);
    assert!(flown.sitl.shared.rotor_speeds.get().is_none());
}

#[test]
fn an_idling_motor_that_stands_still_keeps_the_vehicle_on_the_ground_by_name() {
    let mut flown = answering(&["rotor2@0"]);
    flown.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0);
    flown.pass(2.0);
    assert!(flown.said("Rotor 2: not turning"), "{:?}", flown.sitl.texts);
    flown.command(MavCmd::MAV_CMD_NAV_TAKEOFF, 0.0);
    assert_eq!(flown.mode(), Mode::Idling, "{:?}", flown.sitl.texts);
    assert!(flown.said("Refused: rotor 2 not turning"), "{:?}", flown.sitl.texts);
}

#[test]
fn a_motor_that_stops_in_flight_is_found_by_its_speed_and_flown_without() {
    let lost = "Rotor 1 lost: 0 %";
    let up = |mut flown: Flown| {
        flown.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0);
        flown.command(MavCmd::MAV_CMD_NAV_TAKEOFF, 0.0);
        flown.pass(15.8);
        flown
    };
    let flown = up(answering(&["rotor1@20"]));
    let found = time_of(&flown, lost).unwrap_or_else(|| panic!("{:?}", flown.sitl.texts)) - 20.0;
    let mut without = Flown::boot(STUDY, &["rotor1@20"], None);
    without.pass(5.0);
    let without = up(without);
    let by_motion = time_of(&without, "Rotor 1 lost").unwrap_or_else(|| panic!("{:?}", without.sitl.texts)) - 20.0;
    println!("found by its speed after {found:.2} s, by the motion after {by_motion:.2} s");
    assert!(found <= 0.05 && found <= by_motion, "{found} {by_motion}");
}

#[test]
fn a_rotor_that_keeps_some_of_its_thrust_is_found_by_the_motion_as_without_answers() {
    // 0.3 of the thrust is 0.55 of the speed: no rotor counts as lost by its speed for that.
    let mut flown = answering(&["rotor1=0.3@20"]);
    flown.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0);
    flown.command(MavCmd::MAV_CMD_NAV_TAKEOFF, 0.0);
    flown.pass(15.8);
    let found = time_of(&flown, "Rotor 1 lost").unwrap_or_else(|| panic!("{:?}", flown.sitl.texts)) - 20.0;
    println!("found by the motion after {found:.2} s");
    assert!(found <= 0.2, "{found}");
}
