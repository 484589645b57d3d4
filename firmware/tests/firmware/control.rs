//! The control task's time: when ticks begin, and which of them feed the watchdog.

use crate::support::PERIOD_US;
use crate::support::Simulated;
use crate::support::receiver::Local;
use core::cell::{Cell, RefCell};
use firmware::boot;
use firmware::control::Control;
use firmware::hardware::{Clock, Fault, MotorCommand, Motors, Watchdog};

/// Motors before which the processor is busy with something else, for so long, once.
struct Busy<'a> {
    clock: &'a Simulated,
    /// In which tick, from 1, and for how long, us.
    delay: (usize, u64),
    written: &'a RefCell<Vec<u64>>,
}

impl Motors for Busy<'_> {
    async fn write(&mut self, _: MotorCommand) -> Result<(), Fault> {
        self.written.borrow_mut().push(self.clock.now());
        if self.written.borrow().len() == self.delay.0 {
            self.clock.0.set(self.clock.0.get() + self.delay.1);
        }
        Ok(())
    }
}

/// Remembers when it was fed.
struct Fed<'a>(&'a Simulated, &'a RefCell<Vec<u64>>);

impl Watchdog for Fed<'_> {
    fn feed(&mut self) {
        self.1.borrow_mut().push(self.0.now());
    }
}

/// When motors were written and the watchdog fed in 80 ms, the third tick being delayed by `delay`; and ticks missed.
fn ticks(delay: u64) -> (Vec<u64>, Vec<u64>, u32) {
    let (clock, shared) = (Simulated::default(), Local::new());
    let place = Box::leak(Box::new(boot::Place::new()));
    let (pilot, outputs) = boot::start(place, shared.for_boot()).unwrap();
    let (written, fed) = (RefCell::default(), RefCell::default());
    let mut motors = Busy { clock: &clock, delay: (3, delay), written: &written };
    let mut watchdog = Fed(&clock, &fed);
    let missed = Cell::new(0);
    let mut control = Control::new(shared.for_control(), pilot, outputs);
    clock.run(80_000, control.run(&clock, &mut motors, &mut watchdog), |_| {
        missed.set(shared.report.get().map_or(0, |report| report.value.timing.missed));
    });
    (written.into_inner(), fed.into_inner(), missed.get())
}

#[test]
fn a_tick_that_is_slow_but_in_time_is_a_tick_like_any_other() {
    let (written, fed, missed) = ticks(PERIOD_US - 1_000);
    assert_eq!(written, [10_000, 20_000, 30_000, 40_000, 50_000, 60_000, 70_000]);
    assert_eq!(fed, [10_000, 20_000, 39_000, 40_000, 50_000, 60_000, 70_000]);
    assert_eq!(missed, 0);
}

#[test]
fn a_tick_that_ends_when_the_next_is_due_does_not_feed_the_watchdog_and_is_not_caught_up_with() {
    for (delay, next) in [(PERIOD_US, 50_000), (PERIOD_US + 3_000, 50_000), (2 * PERIOD_US + 1_000, 60_000)] {
        let (written, fed, missed) = ticks(delay);
        let after: Vec<_> = (next..80_000).step_by(PERIOD_US as usize).collect();
        assert_eq!(written, [&[10_000, 20_000, 30_000][..], &after].concat(), "{delay}");
        assert_eq!(fed, [&[10_000, 20_000][..], &after].concat(), "{delay}");
        assert_eq!(missed, 1, "{delay}");
    }
}
