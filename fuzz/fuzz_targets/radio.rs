//! Bytes of a radio's receiver, and frames of channels whose checksums are right. Whatever comes, the kill switch moves
//! only where several frames in a row have it, nothing is armed by the first frames, and what the sticks ask for is
//! made of numbers.

#![no_main]

use arbitrary::Arbitrary;
use controller_core::governor::Motion;
use controller_core::state::State;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::radio::debounced::{FRAMES_MIN, SWITCH_DEBOUNCE_US};
use firmware::radio::{RADIO_TIMEOUT_US, Radio};
use firmware::shared::{Report, Shared};
use flight::{Mode, Request};
use libfuzzer_sys::fuzz_target;
use nalgebra::{Quaternion, Vector3};
use uf_crsf::packets::{PacketAddress, RcChannelsPacked, write_packet_to_buffer};

/// Above it a switch is high.
const SWITCH_HIGH_MIN: u16 = 1402;

#[derive(Debug, Arbitrary)]
enum Event {
    /// Bytes as they are.
    Bytes(Vec<u8>),
    /// A frame of channels.
    Channels([u16; 16]),
    /// The vehicle says how it is.
    Report { mode: u8, is_airborne: bool, attitude: [f32; 4] },
    /// Time passes, us.
    Wait(u32),
}

fuzz_target!(|events: Vec<Event>| {
    let shared: Shared<NoopRawMutex> = Shared::new();
    let mut radio = Radio::new(shared.for_radio());
    let mut now = 1_000_000_u64;
    // Whether bytes that are no frame may have been the beginning of one.
    let mut whole = true;
    let mut last_frame = None;
    // How the last frames had the kill switch: since when, and in how many of them.
    let mut killing = (false, 1_000_000, 0_u32);
    let mut last_killed = None;
    for event in events {
        match event {
            Event::Bytes(bytes) => {
                radio.feed(&bytes, now);
                whole = false;
            }
            Event::Channels(channels) => {
                let channels = channels.map(|channel| channel & 0x7FF);
                let mut frame = [0; 64];
                let length =
                    write_packet_to_buffer(&mut frame, PacketAddress::FlightController, &RcChannelsPacked(channels))
                        .unwrap();
                let heard = last_frame.replace(now).is_some_and(|last| now - last <= RADIO_TIMEOUT_US);
                radio.feed(&frame[..length], now);
                let kills = channels[6] >= SWITCH_HIGH_MIN;
                killing = if killing.0 == kills { (kills, killing.1, killing.2 + 1) } else { (kills, now, 1) };
                let moved =
                    shared.killed.get().filter(|killed| killed.time == now && last_killed != Some(killed.value));
                let settled = killing.2 >= FRAMES_MIN.into() && now - killing.1 >= SWITCH_DEBOUNCE_US;
                assert!(!whole || moved.is_none_or(|moved| settled && moved.value == kills), "{channels:?}: {moved:?}");
                last_killed = shared.killed.get().map(|killed| killed.value);
                while let Some(asked) = shared.requests.take() {
                    assert!(!whole || heard || asked.request != Request::Arm, "armed by the first frame: {channels:?}");
                }
            }
            Event::Report { mode, is_airborne, attitude: [w, i, j, k] } => {
                let attitude = Quaternion::new(w, i, j, k);
                let is_rotation = (attitude.norm() - 1.0).abs() < 1e-3;
                let zero = Vector3::zeros();
                let state = State { position: zero, velocity: zero, attitude, angular_velocity: zero };
                let report = Report {
                    mode: Mode::ALL[usize::from(mode) % Mode::ALL.len()],
                    is_airborne,
                    state: is_rotation.then_some(state),
                    ..Report::NONE
                };
                shared.report.put(report, now);
            }
            Event::Wait(time) => now += u64::from(time),
        }
        radio.check_silence(now);
        if let Some(setpoint) = shared.setpoint.get() {
            let Motion::Velocity(velocity) = setpoint.value.motion else { panic!("{setpoint:?}") };
            assert!(velocity.iter().all(|x| x.abs() <= 4.3), "{setpoint:?}");
        }
        let _ = shared.disarm.take();
    }
});
