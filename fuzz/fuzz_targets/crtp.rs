//! Packets of the Crazyflie's tools. Whatever comes, what is handed on is made of numbers, a question has one answer at
//! most, and a stop of the motors in the air follows from nothing but an emergency stop.

#![no_main]

use arbitrary::Arbitrary;
use controller_core::certificate::certified::Certified;
use controller_core::heading::Heading;
use controller_core::reference::Reference;
use controller_core::state::State;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::crtp::flying::SENDER;
use firmware::crtp::packet::Packet;
use firmware::crtp::pieces::MEMORY_BYTES;
use firmware::crtp::session::Session;
use firmware::shared::{Report, Shared};
use flight::Mode;
use libfuzzer_sys::fuzz_target;
use nalgebra::{Quaternion, Vector3};

#[derive(Debug, Arbitrary)]
enum Event {
    /// A packet.
    Packet { port: u8, channel: u8, data: Vec<u8> },
    /// Bytes as a line has them.
    Bytes(Vec<u8>),
    /// Time passes, ms, and the vehicle is led.
    Wait(u16),
    /// What the vehicle does.
    Mode(u8),
}

const MODES: [Mode; 5] = [Mode::Ready, Mode::Idling, Mode::Flying, Mode::Holding, Mode::Landing];

fuzz_target!(|events: Vec<Event>| {
    let shared: Shared<NoopRawMutex> = Shared::new();
    let verdict = Box::leak(Box::new(Certified::new(firmware::configuration::embedded().unwrap())));
    shared.verdict.put(verdict, 0);
    shared.commander.put(None, 0);
    let mut memory = [0; MEMORY_BYTES];
    let mut session = Box::new(Session::new(shared.for_crtp(), &mut memory));
    let (mut now, mut may_stop) = (1_000_000_u64, false);
    for event in events {
        let packet = match event {
            Event::Packet { port, channel, data } => Some(Packet::new(port, channel).with(&data)),
            Event::Bytes(bytes) => Packet::from_bytes(&bytes),
            Event::Wait(time) => {
                now += u64::from(time) * 1_000;
                session.lead(now);
                None
            }
            Event::Mode(which) => {
                report(&shared, MODES[usize::from(which) % MODES.len()], now);
                None
            }
        };
        if let Some(packet) = packet.filter(|_| session.has_room()) {
            may_stop |= matches!((packet.port, packet.channel, packet.data()), (6 | 9, 1, [3 | 4, ..]));
            session.take(&packet, now);
            let answers = core::iter::from_fn(|| session.next(now));
            let of_it = answers.filter(|answer| (answer.port, answer.channel) == (packet.port, packet.channel));
            assert!(of_it.count() <= 1 || matches!(packet.port, 0 | 5), "{packet:?}");
        }
        while let Some(pose) = shared.poses.take() {
            let value = &pose.value;
            let numbers = value.position().iter().chain(value.attitude().coords.iter()).all(|x| x.is_finite());
            assert!(numbers && (value.attitude().norm() - 1.0).abs() < 1e-3 && pose.time <= now, "{pose:?}");
        }
        while shared.requests.take().is_some() {}
        let _ = shared.setpoint.take();
        assert!(!shared.disarm.take() || may_stop, "stopped by nothing");
        assert!(!shared.is_busy());
    }
});

/// A vehicle in that mode, whose reference rests.
fn report(shared: &Shared<NoopRawMutex>, mode: Mode, now: u64) {
    let (place, still) = (Vector3::new(1.0, 2.0, 3.0), Vector3::zeros());
    let attitude = Quaternion::identity();
    let state = Some(State { position: place, velocity: still, attitude, angular_velocity: still });
    let reference = Some(Reference::resting(place, Heading::FORWARD));
    let report = Report { mode, state, reference, is_airborne: mode.is_guided(), ..Report::NONE };
    shared.report.put(report, now);
    shared.setpoint_owner.set((mode == Mode::Flying).then_some(SENDER));
}
