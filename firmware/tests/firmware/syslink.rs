//! The line to a radio chip, with a chip that is played: what it is told at boot, packets in their turn, the pin that
//! stops the line, what is no frame, and silence.

use crate::support::Simulated;
use crate::support::line::Live;
use crate::support::receiver::{Local, report, texts};
use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use core::future::{pending, poll_fn};
use core::task::Poll;
use embassy_futures::block_on;
use embassy_futures::join::join;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embedded_hal_async::digital::Wait;
use embedded_io_async::{ErrorKind, ErrorType, Write};
use firmware::crtp::packet::{Packet, ReceivePackets, SendPackets};
use firmware::crtp::task;
use firmware::hardware::Battery;
use firmware::parameters::table::Name;
use firmware::syslink::battery::ReportedBattery;
use firmware::syslink::boot_order::{CONFIRMATION_TIMEOUT_US, TRIES_MAX};
use firmware::syslink::frame::Frame;
use firmware::syslink::parser::{Dropped, Parser};
use firmware::syslink::receive::Listener;
use firmware::syslink::transmit::{BURST_BYTES, STOP_TIMEOUT_US};
use firmware::syslink::wire::{RECEIVED_CAPACITY, REPORT_TIMEOUT_US};
use firmware::syslink::{Wire, run};
use flight::Mode;

/// A second, us.
const SECOND_US: u64 = 1_000_000;

/// What the chip is told at boot, with sums worked out by hand.
const BOOT: [&[u8]; 6] = [
    &[0xBC, 0xCF, 0x03, 1, 0, 0x04, 0x0B],
    &[0xBC, 0xCF, 0x01, 1, 80, 0x52, 0x55],
    &[0xBC, 0xCF, 0x02, 1, 2, 0x05, 0x0A],
    &[0xBC, 0xCF, 0x05, 5, 0xE7, 0xE7, 0xE7, 0xE7, 0xE7, 0x8D, 0xCA],
    &[0xBC, 0xCF, 0x0B, 0, 0x0B, 0x16],
    &[0xBC, 0xCF, 0x14, 0, 0x14, 0x28],
];

/// A frame of these.
fn frame(kind: u8, data: &[u8]) -> Vec<u8> {
    Frame::new(kind, data).unwrap().to_bytes().to_vec()
}

/// A report of the battery, V.
fn battery(volts: f32) -> Vec<u8> {
    frame(0x13, &[&[0][..], &volts.to_le_bytes(), &[0; 4]].concat())
}

/// Frames in what was written, and how much of it was none.
fn frames(bytes: &[u8]) -> (Vec<(u8, Vec<u8>)>, Dropped) {
    let (mut parser, mut found) = (Parser::new(), vec![]);
    parser.feed(bytes, |frame| found.push((frame.kind, frame.data().to_vec())));
    (found, parser.dropped())
}

/// How the chip that is played does.
#[derive(Clone, Copy, PartialEq)]
enum Does {
    Well,
    /// It has no power.
    Off,
    /// It reports, and confirms nothing.
    ConfirmsNothing,
}

/// The chip: its end of the line, what it was sent, whether its pin stops the line.
struct Chip {
    clock: Simulated,
    shared: Local,
    wire: Wire<NoopRawMutex>,
    says: Live,
    heard: RefCell<Vec<u8>>,
    /// How long the pieces were in which it was sent them.
    pieces: RefCell<Vec<usize>>,
    is_stopped: Cell<bool>,
    /// Rises, by itself, once so many bytes more came.
    stops_after: Cell<Option<usize>>,
    does: Cell<Does>,
    /// How much of what it heard it has understood.
    understood: Cell<usize>,
    is_reporting: Cell<bool>,
}

impl Chip {
    fn new() -> Self {
        Self {
            clock: Simulated::default(),
            shared: Local::new(),
            wire: Wire::new(),
            says: Live::default(),
            heard: RefCell::default(),
            pieces: RefCell::default(),
            is_stopped: Cell::new(false),
            stops_after: Cell::default(),
            does: Cell::new(Does::Well),
            understood: Cell::new(0),
            is_reporting: Cell::new(false),
        }
    }

    /// Runs the line's task, and the one that answers packets, for so long, us; `each` comes before the chip's turn,
    /// once a millisecond.
    fn run(&self, duration: u64, mut each: impl FnMut(u64)) {
        let line =
            run((self.says.clone(), Line(self)), Pin(self), &self.clock, &self.wire, self.shared.for_packet_radio());
        let (receiver, sender) = (self.wire.receiver(), self.wire.sender());
        let answers = task::run(receiver, sender, &self.clock, self.shared.for_crtp(), &mut []);
        self.clock.run(duration, join(line, answers), |now| {
            each(now);
            self.play(now);
        });
    }

    /// What the chip does in a millisecond.
    fn play(&self, now: u64) {
        if self.does.get() == Does::Off {
            self.is_stopped.set(true);
            return;
        }
        let (found, _) = frames(&self.heard.borrow());
        for (kind, data) in found.iter().skip(self.understood.replace(found.len())) {
            match kind {
                0x01 | 0x02 | 0x03 | 0x05 | 0x0B if self.does.get() == Does::Well => self.says.say(&frame(*kind, data)),
                0x14 => self.is_reporting.set(true),
                _ => {}
            }
        }
        if self.is_reporting.get() && now.is_multiple_of(10_000) {
            self.says.say(&battery(7.5));
            self.says.say(&frame(0x04, &[47]));
        }
    }

    /// What it was sent besides what it is told at boot.
    fn other_frames(&self) -> Vec<(u8, Vec<u8>)> {
        let (found, dropped) = frames(&self.heard.borrow());
        assert_eq!(dropped, Dropped::default());
        found.into_iter().filter(|(kind, _)| !matches!(kind, 0x01 | 0x02 | 0x03 | 0x05 | 0x0B | 0x14)).collect()
    }
}

/// The line to the chip.
struct Line<'a>(&'a Chip);

impl ErrorType for Line<'_> {
    type Error = ErrorKind;
}

impl Write for Line<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        let chip = self.0;
        assert!(!chip.is_stopped.get(), "sent while it is stopped");
        chip.heard.borrow_mut().extend(bytes);
        chip.pieces.borrow_mut().push(bytes.len());
        if let Some(left) = chip.stops_after.get() {
            let left = left.saturating_sub(bytes.len());
            chip.stops_after.set((left > 0).then_some(left));
            chip.is_stopped.set(left == 0);
        }
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

/// The chip's pin.
struct Pin<'a>(&'a Chip);

impl embedded_hal::digital::ErrorType for Pin<'_> {
    type Error = Infallible;
}

impl Wait for Pin<'_> {
    async fn wait_for_low(&mut self) -> Result<(), Infallible> {
        poll_fn(|_| if self.0.is_stopped.get() { Poll::Pending } else { Poll::Ready(Ok(())) }).await
    }

    async fn wait_for_high(&mut self) -> Result<(), Infallible> {
        pending().await
    }

    async fn wait_for_rising_edge(&mut self) -> Result<(), Infallible> {
        pending().await
    }

    async fn wait_for_falling_edge(&mut self) -> Result<(), Infallible> {
        pending().await
    }

    async fn wait_for_any_edge(&mut self) -> Result<(), Infallible> {
        pending().await
    }
}

#[test]
fn a_frame_has_its_start_kind_length_data_and_both_sums() {
    // 0x10 + 3 + 1 + 2 + 255 is 0x115; 0x10 + 0x13 + 0x14 + 0x16 + 0x115 is 0x162.
    assert_eq!(frame(0x10, &[1, 2, 255]), [0xBC, 0xCF, 0x10, 3, 1, 2, 255, 0x15, 0x62]);
    assert_eq!(frame(0x00, &[7; 64]).len(), 70);
    assert_eq!(Frame::new(0x00, &[7; 65]), None);
}

#[test]
fn frames_are_found_in_pieces_of_any_size_and_behind_anything_that_is_none() {
    let whole = [frame(0x05, &[1, 2, 3, 4, 5]), frame(0x0B, &[]), frame(0x00, &[0xBC; 31]), battery(7.5)];
    let said: Vec<_> = whole.iter().map(|bytes| (bytes[2], bytes[4..bytes.len() - 2].to_vec())).collect();
    let mut wrong = [whole[0].clone(), whole[0].clone(), whole[0].clone()];
    (wrong[0][9], wrong[1][10], wrong[2][6]) = (wrong[0][9] ^ 1, wrong[1][10] ^ 0x80, wrong[2][6] ^ 0x10);
    let beginnings = (1..whole[2].len()).map(|length| whole[2][..length].to_vec());
    let noise = [vec![], vec![0x55; 9], vec![0xBC], vec![0xBC; 5], vec![0xCF, 0xBC, 0x00], vec![0xBC, 0xCF, 0x00, 65]];
    for before in noise.into_iter().chain(wrong).chain(beginnings) {
        for piece in [1, 2, 7, 400] {
            let (mut parser, mut found) = (Parser::new(), vec![]);
            // What was cut short may claim as many bytes as a packet has; another packet brings them.
            let bytes = [before.clone(), whole.concat(), whole[2].clone()].concat();
            for piece in bytes.chunks(piece) {
                parser.feed(piece, |frame| found.push((frame.kind, frame.data().to_vec())));
            }
            let dropped = parser.dropped();
            assert_eq!(found, [&said[..], &said[2..3]].concat(), "{before:02X?}");
            assert_eq!(dropped.bytes as usize, before.len(), "{before:02X?}");
            assert_eq!(dropped.frames > 0, before.len() > 1 && before.starts_with(&[0xBC, 0xCF]), "{before:02X?}");
        }
    }
}

#[test]
fn at_boot_the_chip_is_told_everything_once_in_order() {
    let chip = Chip::new();
    chip.run(5 * SECOND_US, |_| ());
    assert_eq!(*chip.heard.borrow(), BOOT.concat());
    assert_eq!(texts(&chip.shared), [""; 0]);
}

#[test]
fn parameters_set_the_radio() {
    let chip = Chip::new();
    for (name, value) in [(Name::RadioChannel, 125.0), (Name::RadioDataRate, 0.0), (Name::RadioAddress, 1.0)] {
        chip.shared.parameters.set(name, value).unwrap();
    }
    chip.run(SECOND_US, |_| ());
    let (found, _) = frames(&chip.heard.borrow());
    let settings: Vec<_> = found.into_iter().filter(|(kind, _)| matches!(kind, 0x01 | 0x02 | 0x05)).collect();
    assert_eq!(settings, [(0x01, vec![125]), (0x02, vec![0]), (0x05, vec![1, 0xE7, 0xE7, 0xE7, 0xE7])]);
}

#[test]
fn a_setting_is_repeated_until_it_is_confirmed_and_given_up_in_the_end() {
    let chip = Chip::new();
    chip.does.set(Does::ConfirmsNothing);
    let round = 4 * u64::from(TRIES_MAX) * CONFIRMATION_TIMEOUT_US;
    chip.run(2 * round + 2 * SECOND_US, |_| ());
    let expected =
        [BOOT[..4].iter().flat_map(|step| [*step; TRIES_MAX as usize]).collect(), BOOT[4..].to_vec()].concat();
    // All of it twice: it might have come too late for the first round.
    assert_eq!(*chip.heard.borrow(), expected.concat().repeat(2));
    assert_eq!(texts(&chip.shared), ["Radio chip does not take its settings"]);
    // Another channel is no confirmation.
    let chip = Chip::new();
    chip.does.set(Does::ConfirmsNothing);
    chip.run(SECOND_US, |now| match now {
        50_000 => chip.says.say(&frame(0x03, &[0])),
        60_000.. if now.is_multiple_of(10_000) => chip.says.say(&frame(0x01, &[81])),
        _ => {}
    });
    let (found, _) = frames(&chip.heard.borrow());
    assert_eq!(found.iter().filter(|(kind, _)| *kind == 0x03).count(), 1);
    assert_eq!(found.iter().filter(|(kind, _)| *kind == 0x01).count(), usize::from(TRIES_MAX));
}

/// The link's echo, with this data.
fn echo(data: &[u8]) -> Vec<u8> {
    [&[0xF0][..], data].concat()
}

#[test]
fn a_packet_is_answered_in_the_turn_that_it_brought() {
    let chip = Chip::new();
    chip.run(2 * SECOND_US, |now| {
        if now == SECOND_US {
            chip.says.say(&frame(0x00, &echo(b"who is there")));
        }
    });
    // The bits that mean nothing are set.
    assert_eq!(chip.other_frames(), [(0x00, [&[0xFC][..], b"who is there"].concat())]);
}

#[test]
fn a_packet_for_everybody_brings_no_turn_but_empty_ones_do() {
    for (empty, answers) in [(None, 0), (Some(vec![]), 1), (Some(vec![0xFF]), 1), (Some(vec![0xFF; 40]), 1)] {
        let chip = Chip::new();
        chip.run(2 * SECOND_US, |now| {
            if now == SECOND_US {
                chip.says.say(&frame(0x06, &echo(&[1])));
            } else if now == SECOND_US + 50_000 {
                empty.iter().for_each(|empty| chip.says.say(&frame(0x00, empty)));
            }
        });
        assert_eq!(chip.other_frames().len(), answers, "{empty:?}");
    }
}

#[test]
fn one_packet_is_sent_for_each_that_came_and_no_more() {
    let chip = Chip::new();
    let (answered, asked) = (Cell::new(0), Cell::new(0));
    let line =
        run((chip.says.clone(), Line(&chip)), Pin(&chip), &chip.clock, &chip.wire, chip.shared.for_packet_radio());
    let flood = async {
        let (mut sender, mut receiver) = (chip.wire.sender(), chip.wire.receiver());
        let both = join(
            async {
                loop {
                    sender.send(&Packet::new(2, 1).with(&[9; 30])).await;
                    answered.set(answered.get() + 1);
                }
            },
            async {
                loop {
                    receiver.receive().await;
                }
            },
        );
        let (never, ()) = both.await;
        never
    };
    chip.clock.run(
        3 * SECOND_US,
        join::<_, core::future::Pending<()>>(
            async {
                join(line, flood).await;
            },
            core::future::pending(),
        ),
        |now| {
            if now >= SECOND_US && now.is_multiple_of(100_000) {
                chip.says.say(&frame(0x00, &[0xFF]));
                asked.set(asked.get() + 1);
            }
            chip.play(now);
        },
    );
    assert_eq!(asked.get(), 20);
    assert_eq!(chip.other_frames().len(), 20);
    // One more waits.
    assert_eq!(answered.get(), 21);
}

#[test]
fn nothing_is_sent_while_the_pin_says_stop_and_a_frame_goes_on_where_it_was_stopped() {
    // `Line::write` panics at a byte that comes while it is stopped.
    for after in 1..17 {
        let chip = Chip::new();
        chip.run(SECOND_US, |_| ());
        let before = chip.heard.borrow().len();
        chip.stops_after.set(Some(after));
        chip.says.say(&frame(0x00, &echo(b"0123456789")));
        let stopped = Cell::new(None);
        chip.run(SECOND_US, |now| {
            if chip.is_stopped.get() {
                let since = stopped.get().unwrap_or(now);
                stopped.set(Some(since));
                chip.is_stopped.set(now < since + STOP_TIMEOUT_US / 2);
            }
        });
        assert!(stopped.get().is_some(), "{after}");
        assert!(chip.heard.borrow().len() > before);
        assert_eq!(chip.other_frames(), [(0x00, [&[0xFC][..], b"0123456789"].concat())], "{after}");
        assert!(chip.pieces.borrow().iter().all(|piece| *piece <= BURST_BYTES));
    }
}

#[test]
fn a_chip_that_stops_the_line_for_good_gets_nothing_and_keeps_nobody() {
    let chip = Chip::new();
    chip.is_stopped.set(true);
    chip.run(5 * SECOND_US, |now| {
        if now.is_multiple_of(10_000) {
            chip.says.say(&frame(0x00, &echo(&[1])));
            chip.says.say(&battery(7.0));
        }
    });
    assert!(chip.heard.borrow().is_empty());
    assert_eq!(chip.wire.voltage().unwrap().value, 7.0);
    // Packets were taken all the time.
    chip.is_stopped.set(false);
    chip.run(SECOND_US, |_| ());
    let (found, _) = frames(&chip.heard.borrow());
    assert!(found.iter().any(|(kind, _)| *kind == 0x01));
}

#[test]
fn the_battery_is_what_was_reported_last_for_a_second() {
    let chip = Chip::new();
    let mut cell = ReportedBattery { wire: &chip.wire, clock: &chip.clock };
    assert_eq!(block_on(cell.voltage()), None);
    chip.run(3 * SECOND_US, |_| ());
    assert_eq!(block_on(cell.voltage()), Some(7.5));
    assert_eq!(chip.wire.strength().unwrap().value, -47);
    // What is no voltage is not taken for one.
    for wrong in [battery(f32::NAN), battery(f32::INFINITY), battery(-1.0), frame(0x13, &[0; 4]), frame(0x13, &[])] {
        Listener::new(&chip.wire).feed(&wrong, chip.clock.0.get());
        assert_eq!(block_on(cell.voltage()), Some(7.5));
    }
    chip.clock.0.set(chip.wire.voltage().unwrap().time + REPORT_TIMEOUT_US);
    assert_eq!(block_on(cell.voltage()), Some(7.5));
    chip.clock.0.set(chip.clock.0.get() + 1);
    assert_eq!(block_on(cell.voltage()), None);
}

#[test]
fn a_chip_that_is_lost_is_said_once_and_told_everything_when_it_is_back() {
    let chip = Chip::new();
    chip.run(20 * SECOND_US, |now| match now {
        5_000_000 => chip.does.set(Does::Off),
        // Power is back: it knows nothing any more.
        12_000_000 => {
            chip.does.set(Does::Well);
            chip.is_stopped.set(false);
            chip.is_reporting.set(false);
        }
        _ => {}
    });
    assert_eq!(texts(&chip.shared), ["Radio chip does not answer", "Radio chip answers again"]);
    let (found, _) = frames(&chip.heard.borrow());
    let told: Vec<_> = found[found.len() - BOOT.len()..].iter().map(|(kind, _)| *kind).collect();
    assert_eq!(told, BOOT.map(|step| step[2]));
    assert_eq!(chip.wire.voltage().unwrap().value, 7.5);
}

#[test]
fn without_a_chip_one_line_says_so_and_nothing_else_comes_of_it() {
    let chip = Chip::new();
    chip.does.set(Does::Off);
    chip.is_stopped.set(true);
    chip.run(60 * SECOND_US, |_| ());
    assert_eq!(texts(&chip.shared), ["Radio chip does not answer"]);
    assert!(chip.heard.borrow().is_empty());
    assert_eq!(block_on(ReportedBattery { wire: &chip.wire, clock: &chip.clock }.voltage()), None);
}

#[test]
fn a_flood_of_packets_and_noise_loses_packets_and_neither_battery_nor_order() {
    let chip = Chip::new();
    chip.run(3 * SECOND_US, |now| {
        let noise: Vec<_> = (0..20).map(|place| (now / 1_000 * 31 + place * 7) as u8).collect();
        for _ in 0..RECEIVED_CAPACITY {
            chip.says.say(&frame(0x00, &[0x10; 31]));
            chip.says.say(&[0xBC, 0xCF, 0x00, 255]);
        }
        chip.says.say(&noise);
        chip.says.say(&frame(0x00, &echo(&[1; 9]))[..9]);
    });
    assert_eq!(chip.heard.borrow()[..BOOT.concat().len()], BOOT.concat());
    assert_eq!(chip.wire.voltage().unwrap().value, 7.5);
    assert!(chip.wire.dropped().unwrap().frames >= 3_000 * RECEIVED_CAPACITY as u32);
    assert_eq!(texts(&chip.shared), [""; 0]);
}

#[test]
fn the_button_is_acknowledged_on_the_ground_alone() {
    for (mode, acknowledged) in [(Mode::Ready, true), (Mode::Flying, false)] {
        let chip = Chip::new();
        report(&chip.shared, mode, 0);
        chip.run(2 * SECOND_US, |now| {
            if now == SECOND_US {
                chip.says.say(&frame(0x15, &[]));
            }
        });
        assert_eq!(chip.other_frames(), [(0x16, vec![])][..usize::from(acknowledged)]);
        assert_eq!(texts(&chip.shared), ["Switched off by the button"]);
    }
}
