//! A radio's frames in, bytes as its receiver sends them: what switches and sticks do, and what silence and corrupted
//! frames do.

use crate::support::Simulated;
use crate::support::desk::Desk;
use crate::support::line::Live;
use crate::support::receiver::{Fed, Local, command, texts};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::state::State;
use core::f32::consts::FRAC_PI_2;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::radio::debounced::SWITCH_DEBOUNCE_US;
use firmware::radio::{RADIO_TIMEOUT_US, Radio, receive};
use firmware::shared::Report;
use flight::{Mode, Request};
use mavlink::dialects::common::{
    COMMAND_LONG_DATA, MavCmd, MavFrame, PositionTargetTypemask, SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use nalgebra::{UnitQuaternion, Vector3};
use std::ops::Range;

/// Channel values at the ends and in the middle.
const CHANNEL_LOW: u16 = 172;
const CHANNEL_MIDDLE: u16 = 992;
const CHANNEL_HIGH: u16 = 1811;

/// Sticks at rest; armed, flown by and killed by switches.
fn channels(arm: u16, flies: u16, kill: u16) -> [u16; 16] {
    let mut channels = [CHANNEL_MIDDLE; 16];
    channels[4..7].copy_from_slice(&[arm, flies, kill]);
    channels
}

const AT_REST: [u16; 16] = {
    let mut channels = [CHANNEL_MIDDLE; 16];
    (channels[4], channels[5], channels[6]) = (CHANNEL_LOW, CHANNEL_LOW, CHANNEL_LOW);
    channels
};

/// The frame that a receiver makes of a payload, with DVB-S2's checksum.
fn packet(kind: u8, payload: &[u8]) -> Vec<u8> {
    let mut frame = vec![0xC8, payload.len() as u8 + 2, kind];
    frame.extend(payload);
    let checksum = frame[2..].iter().fold(0_u8, |checksum, byte| {
        (0..8).fold(checksum ^ byte, |crc, _| if crc & 0x80 == 0 { crc << 1 } else { crc << 1 ^ 0xD5 })
    });
    frame.push(checksum);
    frame
}

/// Channels: eleven bits each, least significant first.
fn frame(channels: &[u16; 16]) -> Vec<u8> {
    let mut bits = 0_u128;
    let mut payload = vec![];
    let mut held = 0;
    for channel in channels {
        bits |= u128::from(*channel) << held;
        held += 11;
        while held >= 8 {
            payload.push(bits as u8);
            bits >>= 8;
            held -= 8;
        }
    }
    packet(0x16, &payload)
}

/// Link statistics with this uplink quality, %.
fn statistics(quality: u8) -> Vec<u8> {
    packet(0x14, &[60, 60, quality, 5, 0, 3, 2, 70, 100, 5])
}

/// The time between frames of the tests, us, and how many of them move a switch.
const FRAME_PERIOD: u64 = 20_000;
const FRAMES_TO_COUNT: u64 = SWITCH_DEBOUNCE_US / FRAME_PERIOD + 1;

/// Frames that say the same for as long as moves a switch, from a time on, us; when the next one comes.
fn held(radio: &mut Radio<'_, NoopRawMutex>, channels: &[u16; 16], from: u64) -> u64 {
    (0..FRAMES_TO_COUNT).for_each(|step| radio.take(channels, from + step * FRAME_PERIOD));
    from + FRAMES_TO_COUNT * FRAME_PERIOD
}

fn requests(shared: &Local) -> Vec<Request> {
    std::iter::from_fn(|| shared.requests.take()).map(|asked| asked.request).collect()
}

/// A vehicle in this mode, pointing to the left of world x.
fn report(shared: &Local, mode: Mode, is_airborne: bool) {
    let attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2).into_inner();
    let zero = Vector3::zeros();
    let state = State { position: zero, velocity: zero, attitude, angular_velocity: zero };
    shared.report.put(Report { mode, is_airborne, state: Some(state), ..Report::NONE }, 0);
}

#[test]
fn bytes_in_pieces_with_noise_between_them_become_switches() {
    for (broken, killed) in [(0, Some(true)), (1, None)] {
        let (clock, shared, line) = (Simulated::default(), Local::new(), Live::default());
        let mut bytes = frame(&channels(CHANNEL_LOW, CHANNEL_LOW, CHANNEL_HIGH));
        // One with a wrong checksum does not count.
        *bytes.last_mut().unwrap() ^= broken;
        clock.run(200_000, receive(line.clone(), &clock, shared.for_radio()), |now| {
            let piece = (now / 1_000 % 20) as usize * 7;
            line.say(bytes.get(piece..bytes.len().min(piece + 7)).unwrap_or(&[]));
            if now % FRAME_PERIOD == 10_000 {
                line.say(&[0x00, 0x16]);
            }
        });
        assert_eq!(shared.killed.get().map(|killed| killed.value), killed);
        assert_eq!(shared.ground_station.get().is_some(), killed.is_some());
    }
}

#[test]
fn switches_act_when_they_are_moved_and_not_where_they_are_found() {
    let shared = Local::new();
    let mut radio = Radio::new(shared.for_radio());
    // Turned on with the arm switch up.
    let mut now = held(&mut radio, &channels(CHANNEL_HIGH, CHANNEL_LOW, CHANNEL_LOW), 0);
    assert!(requests(&shared).is_empty());
    for (arm, flies, request) in [
        (CHANNEL_LOW, CHANNEL_LOW, Request::Disarm),
        (CHANNEL_HIGH, CHANNEL_LOW, Request::Arm),
        (CHANNEL_HIGH, CHANNEL_MIDDLE, Request::Hold),
    ] {
        now = held(&mut radio, &channels(arm, flies, CHANNEL_LOW), now);
        assert_eq!(requests(&shared), [request]);
    }
    // Silent for a while, it is as if it were turned on again.
    radio.check_silence(now + RADIO_TIMEOUT_US);
    held(&mut radio, &channels(CHANNEL_LOW, CHANNEL_LOW, CHANNEL_LOW), 1_000_000);
    assert!(requests(&shared).is_empty());
    assert_eq!(texts(&shared), ["Radio received", "Radio lost", "Radio received"]);
}

#[test]
fn the_kill_switch_keeps_its_last_received_position() {
    let shared = Local::new();
    let mut radio = Radio::new(shared.for_radio());
    held(&mut radio, &channels(CHANNEL_LOW, CHANNEL_LOW, CHANNEL_HIGH), 0);
    radio.check_silence(10_000_000);
    assert!(shared.killed.get().unwrap().value);
    held(&mut radio, &AT_REST, 20_000_000);
    assert!(!shared.killed.get().unwrap().value);
}

/// How long after a switch was moved the motors' stop is requested, us, at most, by frames of so many hertz.
fn slowest_kill(rate: u64) -> u64 {
    let shared = Local::new();
    let mut radio = Radio::new(shared.for_radio());
    // Whole microseconds, so a little quicker: one frame more at 150 Hz.
    let frames = |count: u64| count * (1_000_000 / rate);
    (0..rate).for_each(|count| radio.take(&AT_REST, frames(count)));
    // Moved right after the last of these.
    let moved = frames(rate - 1);
    let stopped = (rate..2 * rate).map(frames).find(|&now| {
        radio.take(&channels(CHANNEL_LOW, CHANNEL_LOW, CHANNEL_HIGH), now);
        shared.killed.get().is_some_and(|killed| killed.value)
    });
    stopped.unwrap() - moved
}

#[test]
fn the_kill_switch_takes_80_ms_at_most_as_the_page_says() {
    let page = include_str!("../../../docs/firmware.md");
    for rate in [50, 150, 500] {
        let row = format!("| {rate} Hz | {} ms |", slowest_kill(rate).div_ceil(1_000));
        assert!(page.contains(&row), "{row}");
    }
}

/// Channels as noise makes them: any.
fn corrupted(seed: &mut u64) -> [u16; 16] {
    [(); 16].map(|()| {
        // A linear congruential generator's upper bits.
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        [CHANNEL_LOW, CHANNEL_MIDDLE, CHANNEL_HIGH, (*seed >> 40) as u16 % 2048][(*seed >> 60) as usize % 4]
    })
}

#[test]
fn corrupted_frames_whose_checksum_passes_move_no_switch_wherever_they_come() {
    let mut seed = 44;
    let modes = [Mode::Ready, Mode::Idling, Mode::TakingOff, Mode::Flying, Mode::Holding];
    for (rate, burst) in [(50, 1), (50, 2), (150, 4), (500, 20)] {
        for (place, mode) in (0..12).flat_map(|place| modes.map(|mode| (place, mode))) {
            for flies in [CHANNEL_LOW, CHANNEL_MIDDLE, CHANNEL_HIGH] {
                let shared = Local::new();
                report(&shared, mode, mode.flies());
                let mut radio = Radio::new(shared.for_radio());
                for count in 0..rate {
                    let is_corrupted = (place..place + burst).contains(&(count % 60));
                    let channels =
                        if is_corrupted { corrupted(&mut seed) } else { channels(CHANNEL_LOW, flies, CHANNEL_LOW) };
                    radio.feed(&frame(&channels), count * 1_000_000 / rate);
                }
                let killed = shared.killed.get().is_some_and(|killed| killed.value);
                assert_eq!((requests(&shared), killed), (vec![], false), "{rate} Hz, {place}, {mode:?}, {flies}");
                assert_eq!(texts(&shared), ["Radio received"]);
            }
        }
    }
}

#[test]
fn a_receiver_that_has_lost_its_transmitter_and_repeats_its_frames_is_silent() {
    let shared = Local::new();
    report(&shared, Mode::Flying, true);
    let mut radio = Radio::new(shared.for_radio());
    let mut run = |seconds: Range<u64>, quality: u8| {
        for now in (seconds.start * 1_000_000..seconds.end * 1_000_000).step_by(FRAME_PERIOD as usize) {
            radio.feed(&frame(&channels(CHANNEL_HIGH, CHANNEL_HIGH, CHANNEL_LOW)), now);
            if now.is_multiple_of(200_000) {
                radio.feed(&statistics(quality), now);
            }
            radio.check_silence(now);
        }
        (requests(&shared), texts(&shared), shared.ground_station.get().unwrap().time)
    };
    let said = |words: &str| vec![words.to_owned()];
    let (asked, words, _) = run(0..3, 100);
    assert_eq!((asked, words), (vec![], said("Radio received")));
    let (asked, words, received) = run(3..6, 0);
    assert_eq!((asked, words), (vec![Request::Hold], said("Radio lost")));
    assert!((3_000_000..3_500_000).contains(&received), "{received}");
    // One corrupted frame of statistics says nothing.
    radio.feed(&statistics(100), 6_000_000);
    let (asked, words, received) = {
        for now in (6_000_000..7_000_000).step_by(FRAME_PERIOD as usize) {
            radio.feed(&frame(&channels(CHANNEL_HIGH, CHANNEL_HIGH, CHANNEL_LOW)), now);
        }
        (requests(&shared), texts(&shared), shared.ground_station.get().unwrap().time)
    };
    assert_eq!((asked, words, received < 3_500_000), (vec![], vec![], true));
}

/// What sticks (right, forward, up, yaw; -1 to 1) put down as a setpoint in a mode, and their request.
fn steered(mode: Mode, is_airborne: bool, sticks: [f32; 4]) -> (Option<Setpoint>, Vec<Request>) {
    let shared = Local::new();
    report(&shared, mode, is_airborne);
    let mut radio = Radio::new(shared.for_radio());
    let mut channels = channels(CHANNEL_HIGH, CHANNEL_HIGH, CHANNEL_LOW);
    for (channel, stick) in channels.iter_mut().zip(sticks) {
        *channel = (f32::from(CHANNEL_MIDDLE) + stick * 819.0).round() as u16;
    }
    held(&mut radio, &channels, 5);
    let mut requests = requests(&shared);
    requests.dedup();
    (shared.setpoint.get().map(|setpoint| setpoint.value), requests)
}

#[test]
fn sticks_command_velocities_relative_to_the_heading() {
    let (setpoint, requests) = steered(Mode::Flying, true, [0.0, 1.0, 0.0, 0.0]);
    let Some(Setpoint { motion: Motion::Velocity(velocity), turn: HeadingSetpoint::Rate(rate) }) = setpoint else {
        panic!()
    };
    // Ahead is world y.
    assert!((velocity - Vector3::new(0.0, 3.0, 0.0)).norm() < 0.01 && rate == 0.0, "{velocity}");
    assert!(requests.is_empty());
    let (setpoint, _) = steered(Mode::Flying, true, [1.0, 0.0, -0.5, 1.0]);
    let Some(Setpoint { motion: Motion::Velocity(velocity), turn: HeadingSetpoint::Rate(rate) }) = setpoint else {
        panic!()
    };
    // To the right of it is world x; to the right is clockwise from above.
    assert!((velocity.x - 3.0).abs() < 0.01 && velocity.y.abs() < 0.01 && velocity.z < -0.4, "{velocity}");
    assert!((rate + 1.0).abs() < 0.01, "{rate}");
    // A trembling hand stays in the dead zone.
    let (setpoint, _) = steered(Mode::Flying, true, [0.05, -0.05, 0.05, 0.05]);
    let zero = Setpoint { motion: Motion::Velocity(Vector3::zeros()), turn: HeadingSetpoint::Rate(0.0) };
    assert_eq!(setpoint, Some(zero));
}

#[test]
fn on_the_ground_only_a_stick_that_is_pushed_up_begins_a_flight() {
    for mode in [Mode::Checks, Mode::Ready, Mode::Stopped, Mode::Locked] {
        assert_eq!(steered(mode, false, [0.0, 0.0, 1.0, 0.0]), (None, vec![]), "{mode:?}");
    }
    assert_eq!(steered(Mode::Idling, false, [0.0; 4]), (None, vec![]));
    let (setpoint, requests) = steered(Mode::Idling, false, [0.0, 0.0, 0.6, 0.0]);
    assert!(setpoint.is_some());
    assert_eq!(requests, [Request::FlySetpoints]);
}

#[test]
fn in_the_air_sticks_take_over_when_they_are_moved_and_land_when_all_the_way_down() {
    assert!(steered(Mode::Holding, true, [0.0; 4]).1.is_empty());
    assert_eq!(steered(Mode::Holding, true, [0.0, 0.4, 0.0, 0.0]).1, [Request::FlySetpoints]);
    assert_eq!(steered(Mode::Flying, true, [0.0, 0.0, -1.0, 0.0]).1, [Request::Land]);
    // What lands is left to land.
    assert!(steered(Mode::Landing, true, [0.0, 0.4, 0.0, 0.0]).1.is_empty());
}

/// A setpoint from the link, and the request to fly such.
fn target() -> SET_POSITION_TARGET_LOCAL_NED_DATA {
    SET_POSITION_TARGET_LOCAL_NED_DATA {
        type_mask: PositionTargetTypemask::from_bits_retain(0b1101_1111_1000),
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
        ..Default::default()
    }
}

fn offboard() -> COMMAND_LONG_DATA {
    command(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 6.0, 0.0, 0.0, 0.0])
}

#[test]
fn while_the_sticks_fly_no_other_source_does() {
    let shared = Local::new();
    held(&mut Radio::new(shared.for_radio()), &channels(CHANNEL_HIGH, CHANNEL_HIGH, CHANNEL_LOW), 0);
    let target = target();
    let mut fed = Fed::new(&shared);
    fed.message(&target, 100_000);
    assert!(shared.setpoint.get().is_none());
    assert!(texts(&shared).contains(&"Setpoint refused: the sticks fly".to_owned()));
    // Not even when it is silent, unless a client requests it.
    fed.message(&target, 2_000_000);
    assert!(shared.setpoint.get().is_none());
    fed.message(&offboard(), 2_500_000);
    assert_eq!(requests(&shared), [Request::FlySetpoints]);
    // There must be one for that to be granted.
    assert!(shared.setpoint.take().is_some_and(|setpoint| setpoint.time == 2_000_000));
    fed.message(&target, 2_600_000);
    assert!(shared.setpoint.get().is_some());
}

#[test]
fn flying_sticks_keep_control_when_a_client_asks_for_it() {
    let shared = Local::new();
    let mut radio = Radio::new(shared.for_radio());
    let mut fed = Fed::new(&shared);
    held(&mut radio, &channels(CHANNEL_HIGH, CHANNEL_HIGH, CHANNEL_LOW), 0);
    fed.message(&target(), 100_000);
    fed.message(&offboard(), RADIO_TIMEOUT_US);
    fed.message(&target(), RADIO_TIMEOUT_US + 100_000);
    assert!(shared.setpoint.get().is_none());
    // Received again, its switch selects who flies.
    radio.check_silence(9_000_000);
    held(&mut radio, &AT_REST, 9_900_000);
    fed.message(&target(), 10_000_000);
    assert!(shared.setpoint.get().is_some());
}

/// The requests after a radio with its switch `flies` has fallen silent in a mode.
fn requests_in_silence(mode: Mode, flies: u16) -> Vec<Request> {
    let shared = Local::new();
    let mut radio = Radio::new(shared.for_radio());
    let heard = held(&mut radio, &channels(CHANNEL_HIGH, flies, CHANNEL_LOW), 0) - FRAME_PERIOD;
    report(&shared, mode, true);
    radio.check_silence(heard + RADIO_TIMEOUT_US);
    assert!(requests(&shared).is_empty());
    (1..5).for_each(|wait| radio.check_silence(heard + RADIO_TIMEOUT_US + wait * 100_000));
    requests(&shared)
}

#[test]
fn sticks_that_flew_and_fall_silent_request_a_hold_once() {
    for mode in Mode::ALL {
        let flown = matches!(mode, Mode::Flying | Mode::TakingOff);
        assert_eq!(requests_in_silence(mode, CHANNEL_HIGH), [Request::Hold][..usize::from(flown)], "{mode:?}");
        assert_eq!(requests_in_silence(mode, CHANNEL_LOW), [], "{mode:?}");
    }
    // Whatever the link requests meanwhile.
    let shared = Local::new();
    let mut radio = Radio::new(shared.for_radio());
    let heard = held(&mut radio, &channels(CHANNEL_HIGH, CHANNEL_HIGH, CHANNEL_LOW), 0) - FRAME_PERIOD;
    report(&shared, Mode::Flying, true);
    let land = command(MavCmd::MAV_CMD_NAV_LAND, [0.0; 5]);
    let mut fed = Fed::new(&shared);
    (0..20).for_each(|_| fed.message(&land, 0));
    radio.check_silence(heard + RADIO_TIMEOUT_US + 1);
    assert_eq!(requests(&shared), [Request::Land, Request::Hold]);
}

#[test]
fn a_companion_does_not_take_over_from_a_radio_that_falls_silent() {
    let shared = Local::new();
    let mut desk = Desk::new(&shared);
    let (mut radio, mut fed) = (Radio::new(shared.for_radio()), Fed::new(&shared));
    let companion = SET_POSITION_TARGET_LOCAL_NED_DATA { x: 40.0, z: -20.0, ..target() };
    let mut fly = |desk: &mut Desk<'_>, ticks: Range<u64>, is_received: bool| {
        for tick in ticks {
            let now = desk.now;
            shared.ground_station.put((), now);
            fed.message(&companion, now);
            if is_received {
                let mut channels =
                    channels(if tick < 220 { CHANNEL_LOW } else { CHANNEL_HIGH }, CHANNEL_HIGH, CHANNEL_LOW);
                channels[2] = if (230..240).contains(&tick) { 1400 } else { CHANNEL_MIDDLE };
                radio.take(&channels, now);
            }
            radio.check_silence(now);
            desk.tick();
        }
        shared.report.get().unwrap().value
    };
    let report = fly(&mut desk, 0..400, true);
    assert_eq!(report.mode, Mode::Flying, "{:?}", texts(&shared));
    // It holds; and what holds on a desk lands.
    let report = fly(&mut desk, 400..460, false);
    assert!(!report.mode.is_armed(), "{:?}", texts(&shared));
    let report = fly(&mut desk, 460..800, false);
    assert!(!report.mode.is_armed() && shared.setpoint.take().is_none(), "{:?}", texts(&shared));
    // It may if a client requests it.
    fed.message(&companion, desk.now);
    fed.message(&offboard(), desk.now);
    assert!(shared.setpoint.take().is_some());
}
