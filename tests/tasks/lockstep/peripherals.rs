//! Peripherals that fail: motor outputs that fault or hang, an IMU that falls silent.

use super::flight::Flight;
use super::simulated_hardware::Health;
use firmware::hardware::MotorCommand;
use flight::Mode;
use mavlink::dialects::common::MavResult;

const TICK_US: u64 = 10_000;

/// How old a sample may be, us.
const IMU_AGE_MAX: u64 = 22_000;

#[test]
fn motors_that_do_not_take_their_frames_starve_the_watchdog_and_are_reported_once() {
    for health in [Health::Faults, Health::Hangs] {
        for mut flight in [grounded_flight(), Flight::in_the_air()] {
            let fed = flight.hardware.fed();
            assert!(flight.now() - fed < TICK_US);
            flight.hardware.outputs(health);
            let since = flight.now();
            flight.pass(0.3);
            assert_eq!(flight.hardware.fed(), fed, "fed by ticks that wrote nothing");
            assert_eq!(count(&flight, "motors: a frame did not go out"), 1);
            assert!(flight.station.received("motors: a frame").unwrap() - since < 3 * TICK_US);
            // Ticks go on meanwhile: motors that come back get the command that holds then.
            assert_eq!(flight.report().timing.missed, 0);
            flight.hardware.outputs(Health::Works);
            flight.pass(0.1);
            assert!(flight.now() - flight.hardware.fed() <= TICK_US);
            assert_eq!(count(&flight, "motors: frames go out again"), 1);
        }
    }
}

fn grounded_flight() -> Flight {
    let mut flight = Flight::boot();
    flight.pass(1.5);
    flight
}

fn count(flight: &Flight, text: &str) -> usize {
    flight.station.texts().iter().filter(|(_, received)| received == text).count()
}

#[test]
fn a_disarm_command_reaches_motors_that_come_back() {
    let mut flight = Flight::in_the_air();
    flight.hardware.outputs(Health::Hangs);
    flight.pass(0.05);
    flight.station.disarm_by_force();
    flight.pass(0.05);
    assert!(matches!(flight.hardware.command(), MotorCommand::Run(_)), "they cannot have received it");
    flight.hardware.outputs(Health::Works);
    flight.pass(0.011);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop);
}

#[test]
fn an_imu_that_falls_silent_in_flight_stops_the_motors_in_its_time() {
    for health in [Health::Faults, Health::Hangs] {
        let mut flight = Flight::in_the_air();
        flight.pass(0.0053);
        flight.hardware.sensor(health);
        let last = flight.now();
        while flight.hardware.command() != MotorCommand::Stop {
            assert!(flight.now() - last <= IMU_AGE_MAX + TICK_US, "still turning after {} us", flight.now() - last);
            flight.pass(0.001);
        }
        assert!(flight.now() - last > IMU_AGE_MAX - 1_000, "stopped by a sample {} us old", flight.now() - last);
        flight.pass(0.5);
        assert!(flight.station.received("Stopped: no IMU for 20 ms").is_some());
        assert_eq!(count(&flight, "IMU does not answer"), 1);
        // Somebody has to look first; then there is still no IMU.
        for words in ["Refused: stopped in flight; disarm first", "Refused: no IMU sample for 20 ms"] {
            let (result, texts) = flight.ask_to_arm();
            assert_eq!((result, texts), (Some(MavResult::MAV_RESULT_DENIED), vec![words.to_owned()]));
            flight.station.arm(false);
            flight.pass(0.1);
        }
        // Back again, it stays stopped until it is armed.
        flight.hardware.sensor(Health::Works);
        flight.pass(0.5);
        assert_eq!(count(&flight, "IMU answers again"), 1);
        assert_eq!((flight.report().timing.gaps, flight.shared.lost_increments.get()), (1, 0));
        assert_eq!((flight.report().mode, flight.hardware.command()), (Mode::Checks, MotorCommand::Stop));
        // The estimate begins anew, and must have been good for a second.
        flight.pass(2.0);
        assert_eq!(flight.ask_to_arm().0, Some(MavResult::MAV_RESULT_ACCEPTED));
    }
}
