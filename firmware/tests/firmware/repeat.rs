//! Motor commands repeated: how often, how long, and what a task that hangs leaves of them.

use crate::support::PERIOD_US;
use crate::support::Simulated;
use core::cell::{Cell, RefCell};
use core::future::{Future, pending};
use embassy_futures::join::join;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::hardware::{Clock, Fault, MotorCommand, Motors};
use firmware::repeat::{Repeated, Repeater, run};

/// Pins that note each frame with its time, us, and fail or hang on demand.
struct Pins<'a> {
    clock: &'a Simulated,
    frames: &'a RefCell<Vec<(u64, MotorCommand)>>,
    does: &'a Cell<Does>,
}

#[derive(Clone, Copy, PartialEq)]
enum Does {
    Well,
    Fail,
    Hang,
}

impl Motors for Pins<'_> {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        match self.does.get() {
            Does::Well => {
                self.frames.borrow_mut().push((self.clock.now(), command));
                Ok(())
            }
            Does::Fail => Err(Fault),
            Does::Hang => pending().await,
        }
    }
}

fn command(level: f32) -> MotorCommand {
    MotorCommand::Run([level; 4])
}

/// The frames of a control task that ticks every `period` us, over `duration` us.
fn frames<F: Future>(
    duration: u64,
    does: &Cell<Does>,
    period: u64,
    control: impl FnOnce(&'static Simulated, &'static Repeated<NoopRawMutex>) -> F,
) -> Vec<(u64, MotorCommand)> {
    let frames = RefCell::default();
    let clock: &'static Simulated = Box::leak(Box::default());
    let repeated: &'static Repeated<NoopRawMutex> = Box::leak(Box::new(Repeated::new()));
    let mut pins = Pins { clock, frames: &frames, does };
    let tasks = join(run(repeated, &mut pins, clock, period), control(clock, repeated));
    clock.run(duration, tasks, |_| ());
    frames.into_inner()
}

/// A new command every `period` us, 0.01 more each time, until `end`, us; then nothing.
async fn flies(clock: &Simulated, repeated: &Repeated<NoopRawMutex>, period: u64, end: u64) {
    let mut repeater = Repeater { repeated, clock };
    let mut level = 0.1;
    while clock.now() < end {
        assert_eq!(repeater.write(command(level)).await, Ok(()));
        level += 0.01;
        clock.until(clock.now() / period * period + period).await;
    }
    pending::<()>().await;
}

#[test]
fn a_command_goes_out_at_once_and_again_every_millisecond() {
    let frames = frames(100_000, &Cell::new(Does::Well), PERIOD_US, |clock, repeated| {
        flies(clock, repeated, PERIOD_US, 200_000)
    });
    assert!((95..=112).contains(&frames.len()), "{}", frames.len());
    assert!(frames.windows(2).all(|pair| pair[1].0 - pair[0].0 <= 2_000), "{frames:?}");
    for tick in 1..10 {
        let first = frames.iter().find(|(_, sent)| *sent == command(0.1 + 0.01 * tick as f32));
        let first = first.or_else(|| frames.iter().find(|(time, _)| *time >= tick * 10_000)).unwrap();
        assert!(first.0 - tick * 10_000 <= 1_000, "{first:?}");
    }
}

#[test]
fn a_control_task_that_hangs_silences_the_motors_within_20_ms_or_two_slow_ticks() {
    for (period, silent) in [(1_000, 69_000), (2_000, 68_000), (10_000, 60_000), (20_000, 80_000)] {
        let control = |clock, repeated| flies(clock, repeated, period, 50_000);
        let frames = frames(200_000, &Cell::new(Does::Well), period, control);
        let last = frames.last().unwrap().0;
        assert!((silent - 2_500..silent).contains(&last), "{period} us: {last}");
    }
}

#[test]
fn nothing_is_sent_before_the_first_command() {
    let frames =
        frames(50_000, &Cell::new(Does::Well), PERIOD_US, |clock, _| async move { clock.until(u64::MAX).await });
    assert!(frames.is_empty());
}

#[test]
fn control_receives_the_fault_of_a_frame_that_failed_or_hung() {
    for wrong in [Does::Fail, Does::Hang] {
        let does = Cell::new(wrong);
        let results = RefCell::new(Vec::new());
        let sent = frames(30_000, &does, PERIOD_US, |clock, repeated| {
            let (does, results) = (&does, &results);
            async move {
                let mut repeater = Repeater { repeated, clock };
                let written = repeater.write(command(0.2)).await;
                results.borrow_mut().push(written);
                does.set(Does::Well);
                clock.until(10_000).await;
                let written = repeater.write(command(0.3)).await;
                results.borrow_mut().push(written);
                clock.until(u64::MAX).await;
            }
        });
        assert_eq!(results.into_inner(), [Err(Fault), Ok(())]);
        assert!(sent.iter().any(|(_, sent)| *sent == command(0.3)));
    }
}
