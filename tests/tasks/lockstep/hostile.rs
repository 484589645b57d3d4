//! Random and damaged bytes: the vehicle flies on, or does what the flight rules say, and never panics.

use super::flight::Flight;
use super::station::Station;
use firmware::hardware::MotorCommand;
use flight::Mode;
use flight::rules::COASTING_MAX_US;
use mavlink::dialects::common::*;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, Message};
use rand::rngs::ChaCha8Rng;
use rand::{Rng, RngExt, SeedableRng};

/// The vehicle's pose as a message.
fn pose(flight: &Flight) -> MavMessage {
    Station::odometry(&flight.hardware.pose())
}

#[test]
fn noise_between_the_frames_does_not_keep_it_from_flying() {
    let mut flight = Flight::in_the_air();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..3_000 {
        let mut noise = vec![0; random.random_range(0..40)];
        random.fill_bytes(&mut noise);
        flight.station.send_bytes(&noise);
        flight.pass(0.01);
    }
    assert_eq!(flight.report().mode, Mode::Flying);
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{}", flight.hardware.pose().position);
}

#[test]
fn frames_with_flipped_bits_are_not_flown() {
    let mut flight = Flight::in_the_air();
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..2_000 {
        // A pose ten metres off, with one bit wrong: if it counted, the vehicle would leave.
        let mut wrong = flight.hardware.pose();
        wrong.position.x += 10.0;
        let mut bytes = flight.station.frame(&Station::odometry(&wrong));
        let bit = random.random_range(0..bytes.len() * 8);
        bytes[bit / 8] ^= 1 << (bit % 8);
        flight.station.send_bytes(&bytes);
        flight.pass(0.01);
    }
    assert_eq!(flight.report().mode, Mode::Flying);
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.1, "{}", flight.hardware.pose().position);
}

#[test]
fn truncated_and_duplicated_frames_change_nothing() {
    let mut flight = Flight::in_the_air();
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for tick in 0..2_000 {
        let bytes = flight.station.frame(&pose(&flight));
        flight.station.send_bytes(&bytes);
        flight.station.send_bytes(&bytes);
        // Ten a second: a frame within the rest of such a frame is lost, heartbeats too.
        if tick % 10 == 0 {
            flight.station.send_bytes(&bytes[..random.random_range(0..bytes.len())]);
        }
        flight.pass(0.01);
    }
    assert_eq!(flight.report().mode, Mode::Flying);
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{}", flight.hardware.pose().position);
}

#[test]
fn a_frame_that_arrives_in_two_halves_long_apart_is_no_fresh_pose() {
    let mut flight = Flight::in_the_air();
    flight.poses(false);
    let last = flight.now();
    // The whole of a pose but its last byte, then that byte every 90 ms: the same old pose, at best.
    let bytes = flight.station.frame(&pose(&flight));
    let (most, end) = bytes.split_at(bytes.len() - 1);
    flight.station.send_bytes(most);
    for _ in 0..70 {
        flight.pass(0.09);
        flight.station.send_bytes(end);
    }
    let lost = flight.station.received("Pose lost").unwrap();
    assert!(lost - last <= 2 * COASTING_MAX_US + 20_000, "{}", lost - last);
    assert!(flight.station.received("Landed: disarmed").is_some(), "{:?}", flight.station.texts());
    assert!(!flight.report().mode.is_armed());
}

/// Every message that the vehicle listens to, with valid contents.
#[expect(deprecated, reason = "clients still send PING")]
fn messages(flight: &Flight) -> Vec<MavMessage> {
    let MavMessage::ODOMETRY(odometry) = pose(flight) else { unreachable!() };
    let here = flight.hardware.pose().position;
    vec![
        MavMessage::ATT_POS_MOCAP(ATT_POS_MOCAP_DATA {
            q: odometry.q,
            x: odometry.x,
            y: odometry.y,
            z: odometry.z,
            ..ATT_POS_MOCAP_DATA::DEFAULT
        }),
        MavMessage::ODOMETRY(odometry),
        MavMessage::SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA {
            coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
            x: here.y,
            y: here.x,
            z: -here.z,
            ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
        }),
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_DO_MOTOR_TEST,
            param1: 1.0,
            param3: 5.0,
            param4: 1.0,
            target_system: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        }),
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
            param1: 1.0,
            target_system: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        }),
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_NAV_TAKEOFF,
            param7: 5.0,
            target_system: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        }),
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_DO_SET_MODE,
            param1: 1.0,
            param2: 6.0,
            target_system: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        }),
        MavMessage::PARAM_SET(PARAM_SET_DATA {
            param_value: 5.0,
            param_id: "GOV_SPEED_XY".into(),
            target_system: 1,
            ..PARAM_SET_DATA::DEFAULT
        }),
        MavMessage::HEARTBEAT(HEARTBEAT_DATA { mavtype: MavType::MAV_TYPE_GCS, ..HEARTBEAT_DATA::DEFAULT }),
        MavMessage::PING(PING_DATA::DEFAULT),
    ]
}

/// `message` with four bytes of its payload replaced, its checksum right.
fn with(message: &MavMessage, offset: usize, value: f32) -> Option<MavMessage> {
    let mut payload = [0; 255];
    let length = message.ser(mavlink::MavlinkVersion::V2, &mut payload);
    payload.get_mut(..length.max(offset + 4))?.get_mut(offset..offset + 4)?.copy_from_slice(&value.to_le_bytes());
    MavMessage::parse(mavlink::MavlinkVersion::V2, message.message_id(), &payload[..length.max(offset + 4)]).ok()
}

#[test]
fn no_number_in_any_field_of_any_message_makes_it_panic_or_leave() {
    let mut flight = Flight::in_the_air();
    let numbers = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -f32::MAX, f32::MIN_POSITIVE, -0.0];
    let mut sent = 0;
    for (kind, template) in messages(&flight).into_iter().enumerate() {
        for offset in 0..=244 {
            for number in numbers {
                // Setpoints and poses that are numbers are obeyed, as they should be: here only those that are none.
                if number.is_finite() && kind < 3 {
                    continue;
                }
                let Some(message) = with(&template, offset, number) else { continue };
                let mut raw = MAVLinkV2MessageRaw::new();
                raw.serialize_message(MavHeader { system_id: 254, component_id: 1, sequence: sent as u8 }, &message);
                flight.station.send_bytes(raw.raw_bytes());
                sent += 1;
            }
        }
        flight.pass(0.2);
        assert!(flight.shared.report.get().unwrap().value.state.is_some());
        let MotorCommand::Run(commands) = flight.hardware.command() else { panic!("stopped by message {kind}") };
        assert!(commands.iter().all(|command| (0.0..=1.0).contains(command)));
    }
    assert!(sent > 1_000, "{sent}");
    // Among them were disarm commands, of a station that did not arm it.
    assert!(flight.station.received("Refused: another station commands").is_some());
    flight.station.go_to([0.0, 0.0, 1.0]);
    flight.station.fly_setpoints();
    flight.pass(12.0);
    assert_eq!(flight.report().mode, Mode::Flying);
    assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{}", flight.hardware.pose().position);
    assert_eq!(flight.report().timing.missed, 0);
}

#[test]
fn whatever_comes_in_no_stale_pose_is_flown() {
    // Poses drop out at random, noise in between: whenever the vehicle flies, a whole pose came within the limit.
    let mut flight = Flight::in_the_air();
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut last = flight.now();
    let (mut levelled, mut flights) = (0, 0);
    for _ in 0..20_000 {
        let on = random.random_bool(0.01);
        flight.poses(false);
        if on {
            flight.station.send(&pose(&flight));
            last = flight.now();
        }
        if random.random_bool(0.2) {
            let mut noise = [0; 7];
            random.fill_bytes(&mut noise);
            flight.station.send_bytes(&noise);
        }
        flight.pass(0.01);
        let report = flight.report();
        levelled += u32::from(report.mode == Mode::Descending);
        if report.mode.is_guided() {
            assert!(
                flight.now() - last <= COASTING_MAX_US + 10_000,
                "{:?} on a pose of {} us",
                report.mode,
                flight.now() - last
            );
        }
        if !report.mode.is_armed() {
            // It has come down: set upright, it flies again once its poses have been believed for a while.
            flights += 1;
            flight.hardware.set_down(0.0, 0.0, 0.0);
            flight.poses(true);
            flight.station.arm(false);
            flight.pass(3.0);
            flight.go_up();
            last = flight.now();
        }
    }
    assert!(levelled > 100 && flights > 3, "{levelled} {flights}: the test lost its point");
}

#[test]
fn a_disarm_command_wins_within_a_tick_over_a_flood_of_requests() {
    let mut flight = Flight::in_the_air();
    for _ in 0..50 {
        flight.station.arm(true);
    }
    flight.station.disarm_by_force();
    flight.pass(0.01);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop);
    flight.pass(1.0);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop);
}
