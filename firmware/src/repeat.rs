//! The motors' last command, sent again and again while it is young.
//!
//! Many speed controllers refuse or stutter on less than 250 frames a second, and control decides as seldom as 50 times
//! a second. In between, its last command is repeated every [`FRAME_INTERVAL_US`]; a new one goes out at once. A
//! command of [`command_age_max`] is repeated no more: without frames a speed controller stops its motor, so a control
//! task that hangs silences the motors, whatever it commanded last. One that hangs without giving way keeps this task
//! from running at all, which is silence too.

use crate::deadline::within;
use crate::hardware::{Clock, Fault, MotorCommand, Motors};
use crate::shared::Latest;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;

/// Time between frames: 1 kHz at most, and not much less.
pub const FRAME_INTERVAL_US: u64 = 1_000;

/// The age at which a command is repeated no more, us, where control ticks every `period` us: a tick that is missed is
/// bridged, two are not; and never less than 20 ms, half of the time after which controllers give up by themselves.
pub const fn command_age_max(period: u64) -> u64 {
    if period > 10_000 { 2 * period } else { 20_000 }
}

/// How long a frame may take to write.
const WRITE_TIMEOUT_US: u64 = 500;

/// What passes between control and the task that repeats.
pub struct Repeated<M: RawMutex> {
    command: Latest<M, MotorCommand>,
    /// There is a new command.
    new_command: Signal<M, ()>,
    /// What became of the last frame, and the time of the command in it, us.
    written: Signal<M, (u64, Result<(), Fault>)>,
}

impl<M: RawMutex> Repeated<M> {
    /// No command yet.
    pub const fn new() -> Self {
        Self { command: Latest::new(), new_command: Signal::new(), written: Signal::new() }
    }
}

/// The motors as control sees them: a command is written when its first frame is.
pub struct Repeater<'a, M: RawMutex, C> {
    /// Where commands are put.
    pub repeated: &'a Repeated<M>,
    /// The board's time.
    pub clock: C,
}

impl<M: RawMutex, C: Clock> Motors for Repeater<'_, M, C> {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        let now = self.clock.now();
        self.repeated.command.put(command, now);
        self.repeated.new_command.signal(());
        loop {
            // The frame that was on its way was another command's.
            let (time, written) = self.repeated.written.wait().await;
            if time >= now {
                return written;
            }
        }
    }
}

/// Writes the commands of a control that ticks every `period` us to the motors and repeats them, for ever.
pub async fn run<M: RawMutex>(repeated: &Repeated<M>, motors: &mut impl Motors, clock: &impl Clock, period: u64) -> ! {
    loop {
        // Whichever comes first: a new command, or the time to repeat the last.
        let _ = within(clock, FRAME_INTERVAL_US, repeated.new_command.wait()).await;
        let young = repeated.command.get().filter(|command| command.age(clock.now()) < command_age_max(period));
        let Some(command) = young else { continue };
        let written = within(clock, WRITE_TIMEOUT_US, motors.write(command.value)).await.unwrap_or(Err(Fault));
        repeated.written.signal((command.time, written));
    }
}
