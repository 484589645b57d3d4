//! The link on one of two lines: which, when it moves, and that the other's input is ignored.

use crate::support::line::{Live, Outgoing};
use crate::support::receiver::{Local, report, texts};
use crate::support::{Simulated, sent, v2};
use core::cell::{Cell, RefCell};
use embassy_futures::select::select;
use firmware::hardware::Port;
use firmware::link::port::{Line, PORT_POLL_INTERVAL_US, watch};
use firmware::link::receive::receive;
use firmware::link::transmit::transmit;
use flight::Mode;
use mavlink::dialects::common::{HEARTBEAT_DATA, MavType, SETUP_SIGNING_DATA};

/// A second, us.
const SECOND_US: u64 = 1_000_000;

struct Opened(Cell<bool>);

impl Port for Opened {
    fn is_open(&self) -> bool {
        self.0.get()
    }
}

/// A ground station's heartbeat.
fn heartbeat(sequence: u8) -> Vec<u8> {
    v2(sequence, &HEARTBEAT_DATA { mavtype: MavType::MAV_TYPE_GCS, ..Default::default() })
}

/// The lines of a board, and what went over them.
struct Bench {
    clock: Simulated,
    shared: Local,
    port: Opened,
    incoming: [Live; 2],
    written: [RefCell<Vec<u8>>; 2],
}

impl Bench {
    fn new(has_port: bool, duration: u64, each: impl Fn(&Self, u64)) -> Self {
        let bench = Self {
            clock: Simulated::default(),
            shared: Local::new(),
            port: Opened(Cell::new(false)),
            incoming: Default::default(),
            written: Default::default(),
        };
        let Self { clock, shared, port, incoming: [serial_in, port_in], written: [serial_out, port_out] } = &bench;
        let on_port = (&shared.on_port).into();
        let from = Line { serial: serial_in.clone(), port: has_port.then(|| port_in.clone()), on_port };
        let out = |written| Outgoing { written, at_once: 64 };
        let to = Line { serial: out(serial_out), port: has_port.then(|| out(port_out)), on_port };
        let tasks = select(
            select(receive(from, clock, shared.for_receive()), transmit(to, clock, shared.for_transmit())),
            watch(port, clock, shared.for_port()),
        );
        clock.run(duration, tasks, |now| each(&bench, now));
        bench
    }

    /// How many frames of the ground station were understood.
    fn frames(&self) -> u32 {
        self.shared.traffic.get().map_or(0, |traffic| traffic.value.frames)
    }

    /// Heartbeats that went out over (serial line, port).
    fn heartbeats(&self) -> (usize, usize) {
        let [serial, port] = &self.written;
        (sent::<HEARTBEAT_DATA>(serial).len(), sent::<HEARTBEAT_DATA>(port).len())
    }
}

#[test]
fn the_link_is_on_the_serial_line_until_the_port_is_opened_and_again_when_it_is_closed() {
    let bench = Bench::new(true, 30 * SECOND_US, |bench, now| {
        bench.port.0.set((10 * SECOND_US..20 * SECOND_US).contains(&now));
        if now.is_multiple_of(SECOND_US) {
            // Ten, twenty and ten seconds' worth of sequence numbers.
            bench.incoming[0].say(&heartbeat((now / SECOND_US) as u8));
            bench.incoming[1].say(&heartbeat((now / SECOND_US) as u8 + 100));
        }
    });
    let (serial, port) = bench.heartbeats();
    assert!((19..=21).contains(&serial) && (9..=11).contains(&port), "{serial} {port}");
    // What came over the port while it was closed waits in this bench's line, not in a port's; all of it is received in
    // the end.
    assert!((39..=61).contains(&bench.frames()), "{}", bench.frames());
}

#[test]
fn nothing_is_received_from_the_line_that_is_not_the_link() {
    for open in [false, true] {
        let bench = Bench::new(true, 5 * SECOND_US, |bench, now| {
            bench.port.0.set(open);
            if now > SECOND_US && now.is_multiple_of(SECOND_US) {
                bench.incoming[usize::from(!open)].say(&heartbeat((now / SECOND_US) as u8));
            }
        });
        assert_eq!(bench.frames(), 0, "{open}");
        assert!(bench.shared.ground_station.get().is_none());
        assert_eq!(bench.heartbeats().0 <= 1, open);
    }
}

#[test]
fn it_does_not_move_while_a_motor_turns() {
    for mode in Mode::ALL {
        let turns = mode.is_armed() || mode == Mode::MotorTest;
        let bench = Bench::new(false, 2 * SECOND_US, |bench, now| {
            report(&bench.shared, mode, now);
            bench.port.0.set(now > SECOND_US);
        });
        assert_eq!(bench.shared.on_port.is_raised(), !turns, "{mode:?}");
        let bench = Bench::new(false, 2 * SECOND_US, |bench, now| {
            bench.port.0.set(now < SECOND_US);
            report(&bench.shared, if now < PORT_POLL_INTERVAL_US { Mode::Ready } else { mode }, now);
        });
        assert_eq!(bench.shared.on_port.is_raised(), turns, "{mode:?}");
    }
}

#[test]
fn a_board_without_the_port_keeps_the_serial_line() {
    let bench = Bench::new(false, 5 * SECOND_US, |bench, now| {
        bench.port.0.set(true);
        if now.is_multiple_of(SECOND_US) {
            bench.incoming[0].say(&heartbeat((now / SECOND_US) as u8));
        }
    });
    assert_eq!((bench.frames(), bench.heartbeats().1), (5, 0));
}

#[test]
fn every_frame_move_is_reported_once() {
    let (clock, shared, port) = (Simulated::default(), Local::new(), Opened(Cell::new(false)));
    clock.run(4 * SECOND_US, watch(&port, &clock, shared.for_port()), |now| {
        port.0.set((SECOND_US..2 * SECOND_US).contains(&now))
    });
    assert_eq!(texts(&shared), ["Link: on USB, the serial line is ignored", "Link: on the serial line"]);
}

/// A message that sets a key, and the last byte of which could begin a frame.
fn key() -> Vec<u8> {
    let with = |number: u16| {
        let [low, high] = number.to_le_bytes();
        let mut secret_key = [7; 32];
        secret_key[..2].copy_from_slice(&[low, high]);
        v2(1, &SETUP_SIGNING_DATA { secret_key, target_system: 1, ..Default::default() })
    };
    (0..=u16::MAX).map(with).find(|frame| frame.ends_with(&[0xFD])).unwrap()
}

#[test]
fn a_key_from_the_serial_line_is_none_while_the_link_moves_to_the_port() {
    // Who waits on the serial line when the port is opened still reads what comes there next.
    let bench = Bench::new(true, SECOND_US, |bench, now| {
        bench.port.0.set(true);
        if now == PORT_POLL_INTERVAL_US {
            bench.incoming[0].say(&key());
        }
    });
    assert!(bench.shared.on_port.is_raised());
    assert_eq!(bench.shared.signing.unkept(0, false), None);
    // All of it but its last byte before the port is opened, and a frame from there.
    let bench = Bench::new(true, SECOND_US, |bench, now| {
        bench.port.0.set(now > PORT_POLL_INTERVAL_US);
        if now == PORT_POLL_INTERVAL_US {
            bench.incoming[0].say(&key()[..key().len() - 1]);
        }
        if now == PORT_POLL_INTERVAL_US + 20_000 {
            bench.shared.on_port.raise();
            bench.incoming[0].say(&[0]);
            bench.incoming[1].say(&heartbeat(1));
        }
    });
    assert_eq!(bench.frames(), 1);
    assert_eq!(bench.shared.signing.unkept(0, false), None);
    // It would have counted there.
    let bench = Bench::new(true, 2 * SECOND_US, |bench, now| {
        bench.port.0.set(true);
        if now == PORT_POLL_INTERVAL_US {
            bench.incoming[1].say(&key());
        }
    });
    assert!(bench.shared.signing.unkept(0, false).is_some());
}
