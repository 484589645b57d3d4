//! The last thing a board does: stop the motors, report why, restart.
//!
//! Panics, faults and unhandled interrupts end here, in the order of [`StopSequence`]:
//!
//! 1. interrupts go off, and stop frames go out: by polling the motors' timers alone, whose registers say themselves
//!    whether they were ever set up. Nothing that may be broken is used: no heap, no executor, no DMA, no interrupt, no
//!    log.
//! 2. the panic's message, or the fault's place and registers, go to memory that the restart leaves as it is
//!    ([`crate::last_words`]), and to the log.
//! 3. stop frames go on for long enough (27 ms) for a probe to fetch the log, which a restart empties.
//! 4. the chip restarts.
//!
//! `panic-probe` logs before anything else can run. So the panic handler is here.
//!
//! Times: a frame takes 0.057 ms and the silence before it 0.08 ms, both by timers that count the chip's clocks, so
//! that neither depends on caches: 1.4 ms for the first ten frames and 27 ms for the rest, well within the watchdog's
//! 50 ms (its own clock is exact to a tenth on the H743, and makes 34 to 94 ms of them on the F405). Where something
//! goes wrong before the clocks are set, all of it takes longer, and there is no watchdog yet.
//!
//! What the controllers see: the frame that was going out is cut and discarded by its checksum; stop frames follow, and
//! then silence until the firmware runs again and sends stop frames. The stop frame is 16 zero bits, checksum included,
//! and both ways twelve zeros and four ones: sixteen periods at their widths. Controllers that are spoken to both ways
//! answer these frames, too: after each the pins are inputs, and the silence lasts twice as long.
//!
//! A stack that overflowed is no hindrance: a fault begins it anew ([`crate::boards::guard`]).
//!
//! What this does not reach: a core that cannot run any code (a clock that failed, a fault in a fault). There the
//! watchdog restarts the chip within 50 ms, once the control task has fed it for the first time, and the controllers
//! stop for want of frames within their own time-out. The watchdog is fed once before these steps, so that the restart
//! is theirs and names them as its cause; if one of them hangs, it is the watchdog's.

use super::chip::{FRAME_PAUSE_CYCLES, WATCHDOG};
use super::ears::{drive, release};
use super::motors::{protocol, rest};
use super::restart::restart;
use crate::boards::chosen::{MOTOR_PINS, MOTOR_TIMERS};
use crate::boards::fault::Fault;
use crate::boards::kept;
use crate::dshot::{FRAME_BITS, Protocol, zero_width};
use crate::hardware::MOTOR_COUNT;
use crate::last_words::LastWords;
use crate::stop_sequence::{STOP_FRAMES_AFTER, STOP_FRAMES_BEFORE, StopSequence};
use core::panic::PanicInfo;
use cortex_m::peripheral::SYST;
use cortex_m_rt::exception;
use embassy_stm32::pac::iwdg::vals::Key;
use embassy_stm32::pac::timer::TimGp16;

/// Polls after which a period counts as not ending: the timer was never set up. One takes a few cycles of the
/// peripheral bus.
const PERIOD_POLLS_MAX: usize = 10_000;

/// Stop frames in a row where controllers answer each.
const STOP_FRAMES_BOTH_WAYS_MAX: usize = 100;

/// All of it, us, is over before the most impatient of the watchdogs restarts the chip.
const _: () = assert!((STOP_FRAMES_BEFORE + STOP_FRAMES_AFTER) * 140 < 34_000);
const _: () = assert!((STOP_FRAMES_BEFORE + STOP_FRAMES_BOTH_WAYS_MAX + 1) * 220 < 34_000);

static STOP_SEQUENCE: StopSequence = StopSequence::new();

#[panic_handler]
fn panicked(info: &PanicInfo<'_>) -> ! {
    end(|| LastWords::panic(info))
}

/// The core could not go on.
pub fn faulted(fault: &Fault) -> ! {
    end(|| LastWords::new(fault))
}

#[exception]
unsafe fn DefaultHandler(interrupt: i16) -> ! {
    end(|| LastWords::new(format_args!("unexpected interrupt {interrupt}")))
}

fn end(words: impl FnOnce() -> LastWords) -> ! {
    cortex_m::interrupt::disable();
    WATCHDOG.kr().write(|w| w.set_key(Key::RESET));
    STOP_SEQUENCE.act(stop, || {
        let words = words();
        kept::keep(&words);
        defmt::error!("{=str}", words.as_str());
    });
    restart()
}

/// Sends so many stop frames to every motor and leaves the lines low; takes as long where their timers do not run.
fn stop(frames: usize) {
    // Before the timers are set up, pins are left alone.
    let both_ways = MOTOR_TIMERS.map(protocol).contains(&Protocol::BothWays);
    let frames = if both_ways { frames.min(STOP_FRAMES_BOTH_WAYS_MAX) } else { frames };
    for _ in 0..frames {
        rest_lines(both_ways);
        stop_frame();
        if both_ways {
            release(&MOTOR_PINS);
        }
    }
    rest_lines(both_ways);
}

/// Rests the lines, and is silent; for as long as an answer takes, where there may be one.
fn rest_lines(both_ways: bool) {
    MOTOR_TIMERS.into_iter().for_each(rest);
    silence();
    if both_ways {
        silence();
        drive(&MOTOR_PINS);
    }
}

/// Silence before each frame. Waits by SysTick, which nothing else uses: a loop takes as long as caches and pipelines
/// let it.
fn silence() {
    /// It runs by the core's clock, without an interrupt.
    const RUN_BITS: u32 = 0b101;
    const HAS_ENDED_BIT: u32 = 1 << 16;
    // SAFETY: nothing else runs any more, and nothing else uses it.
    let timer = unsafe { &*SYST::PTR };
    // SAFETY: as above; no interrupt is enabled.
    unsafe {
        timer.rvr.write(FRAME_PAUSE_CYCLES - 1);
        timer.cvr.write(0);
        timer.csr.write(RUN_BITS);
    }
    // A look takes more than a cycle.
    let _ = (0..FRAME_PAUSE_CYCLES).find(|_| timer.csr.read() & HAS_ENDED_BIT != 0);
}

/// One stop frame by polling, on all timers at once; none on one that does not run.
fn stop_frame() {
    for timer in MOTOR_TIMERS {
        widths(timer, width(timer, 0));
        // Widths take effect at an update: the first update begins bit one, the seventeenth ends bit sixteen.
        timer.sr().write(|w| w.0 = 0);
        timer.cr1().modify(|w| w.set_cen(true));
    }
    let mut run = MOTOR_TIMERS.map(|_| true);
    let mut periods_end = || {
        for (timer, runs) in MOTOR_TIMERS.into_iter().zip(&mut run) {
            *runs = *runs && period_ends(timer);
        }
    };
    for bit in 0..FRAME_BITS {
        periods_end();
        MOTOR_TIMERS.into_iter().for_each(|timer| widths(timer, width(timer, bit + 1)));
    }
    periods_end();
}

/// The width of a bit of the stop frame, counted from 0; behind the last there is silence.
fn width(timer: TimGp16, bit: usize) -> u16 {
    let zero = zero_width(timer.arr().read().arr().saturating_add(1));
    match FRAME_BITS.checked_sub(bit + 1) {
        None => 0,
        Some(place) if protocol(timer).stop_bits() >> place & 1 == 1 => 2 * zero,
        Some(_) => zero,
    }
}

fn widths(timer: TimGp16, width: u16) {
    for channel in 0..MOTOR_COUNT {
        timer.ccr(channel).write(|w| w.set_ccr(width));
    }
}

/// Waits for it, and whether it did.
fn period_ends(timer: TimGp16) -> bool {
    let ended = (0..PERIOD_POLLS_MAX).any(|_| timer.sr().read().uif());
    timer.sr().write(|w| w.0 = 0);
    ended
}
