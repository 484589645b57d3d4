//! A simulator's line: what goes out on it, and what becomes of the exchange when the line fails.

use crate::support::PERIOD_US;
use crate::support::line::{Delivery, Incoming, Line, Outgoing};
use crate::support::receiver::Local;
use crate::support::simulator::{COMMANDED_US, Hil, Pins, commanded, now, sensor};
use crate::support::{Simulated, v2};
use core::cell::{Cell, RefCell};
use core::future::pending;
use embedded_io_async::{ErrorKind, ErrorType, Read, Write};
use firmware::hardware::{MotorCommand, Motors};
use firmware::hil::{self, SelectedMotors};
use firmware::link::frame::Parser;
use firmware::shared::Flag;
use mavlink::dialects::common::{HIL_ACTUATOR_CONTROLS_DATA, MavModeFlag};

/// Every command in what was written.
fn sent(written: &RefCell<Vec<u8>>) -> Vec<HIL_ACTUATOR_CONTROLS_DATA> {
    let mut parser = Parser::new();
    let mut found = Vec::new();
    for &byte in written.borrow().iter() {
        found.extend(parser.push(byte, 0).and_then(|frame| frame.decode()));
    }
    found
}

/// Gives the simulator a command every period while its line is `line`.
fn transmitted(line: impl Write, commands: &[MotorCommand]) {
    let (clock, shared, hil, wanted) = (Simulated::default(), Local::new(), Hil::new(), Flag::new());
    wanted.raise();
    let mut commands = commands.iter();
    let end = PERIOD_US * (commands.len() as u64);
    clock.run(end, hil::transmit(&hil, line, &clock, shared.for_simulator(), PERIOD_US), |time| {
        if time % PERIOD_US == 0 {
            let board = Simulated::default();
            board.0.set(time);
            let mut motors = SelectedMotors {
                pins: &mut Pins::default(),
                hil: &hil,
                requested: (&wanted).into(),
                clock: board,
                period: PERIOD_US,
            };
            now(motors.write(*commands.next().unwrap())).unwrap();
        }
    });
}

#[test]
fn each_command_goes_out_once_with_its_time() {
    let written = RefCell::default();
    let one = MotorCommand::One { motor: 2, level: 0.125 };
    let commands = [MotorCommand::Stop, MotorCommand::Run([0.1, 0.2, 0.3, 0.4]), one];
    transmitted(Outgoing { written: &written, at_once: 7 }, &commands);
    let sent = sent(&written);
    let times: Vec<_> = sent.iter().map(|controls| controls.time_usec).collect();
    assert_eq!(times, [0, PERIOD_US, 2 * PERIOD_US]);
    let levels: Vec<_> = sent.iter().map(|controls| controls.controls[..5].to_vec()).collect();
    assert_eq!(levels, [[0.0; 5], [0.1, 0.2, 0.3, 0.4, 0.0], [0.0, 0.0, 0.125, 0.0, 0.0]]);
    let armed = |controls: &HIL_ACTUATOR_CONTROLS_DATA| controls.mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
    assert_eq!(sent.iter().map(armed).collect::<Vec<_>>(), [false, true, true]);
}

/// What goes wrong on a line at first.
#[derive(Clone, Copy, Debug)]
enum Trouble {
    TakesNothing,
    Closed,
    Broken,
}

/// A line that is in trouble a few times and then takes everything.
struct Recovering<'a> {
    trouble: Trouble,
    times: u32,
    then: Outgoing<'a>,
}

impl ErrorType for Recovering<'_> {
    type Error = ErrorKind;
}

impl Write for Recovering<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        if self.times == 0 {
            return self.then.write(bytes).await;
        }
        self.times -= 1;
        match self.trouble {
            Trouble::TakesNothing => pending().await,
            Trouble::Closed => Ok(0),
            Trouble::Broken => Err(ErrorKind::Other),
        }
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

#[test]
fn a_line_in_trouble_loses_that_command_and_no_later_one() {
    for trouble in [Trouble::TakesNothing, Trouble::Closed, Trouble::Broken] {
        let written = RefCell::default();
        let then = Outgoing { written: &written, at_once: 1_000 };
        transmitted(Recovering { trouble, times: 2, then }, &[MotorCommand::Stop; 4]);
        let times: Vec<_> = sent(&written).iter().map(|controls| controls.time_usec).collect();
        assert_eq!(times, [2 * PERIOD_US, 3 * PERIOD_US], "{trouble:?}");
    }
}

/// A line that never delivers, and counts how often it is asked.
struct Mute<'a>(&'a Cell<u32>, Trouble);

impl ErrorType for Mute<'_> {
    type Error = ErrorKind;
}

impl Read for Mute<'_> {
    async fn read(&mut self, _: &mut [u8]) -> Result<usize, ErrorKind> {
        self.0.set(self.0.get() + 1);
        assert!(self.0.get() < 2_000, "it takes all the time there is");
        match self.1 {
            Trouble::TakesNothing => pending().await,
            Trouble::Closed => Ok(0),
            Trouble::Broken => Err(ErrorKind::Other),
        }
    }
}

#[test]
fn a_line_that_delivers_nothing_is_asked_again_but_not_all_the_time() {
    for (trouble, attempts) in
        [(Trouble::TakesNothing, 8..=11), (Trouble::Closed, 300..=1_000), (Trouble::Broken, 300..=1_000)]
    {
        let (clock, shared, asked) = (Simulated::default(), Local::new(), Cell::new(0));
        clock.run(
            1_000_000,
            hil::receive(&commanded(), Mute(&asked, trouble), &clock, shared.for_simulator(), PERIOD_US),
            |_| (),
        );
        assert!(attempts.contains(&asked.get()), "{trouble:?}: {}", asked.get());
    }
}

#[test]
fn an_answer_in_pieces_between_faults_is_taken() {
    let (clock, shared, hil, line) = (Simulated::default(), Local::new(), commanded(), Line::default());
    clock.0.set(COMMANDED_US);
    for piece in v2(1, &sensor(COMMANDED_US + PERIOD_US)).chunks(9) {
        line.borrow_mut().extend([Delivery::Bytes(piece.to_vec()), Delivery::Fault, Delivery::End]);
    }
    clock.run(50_000, hil::receive(&hil, Incoming(&line), &clock, shared.for_simulator(), PERIOD_US), |_| ());
    assert_eq!(shared.imu.get().unwrap().time, COMMANDED_US + PERIOD_US);
}
