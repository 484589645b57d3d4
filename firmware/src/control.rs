//! The control task: 100 times a second, the pilot's decision to the motors, on time.
//!
//! ```text
//! due -> inputs from Shared -> Pilot::tick -> motor command -> written -> report
//!                                                          '-> watchdog fed, if all of it was in time
//! ```
//!
//! The task decides nothing about flight: [`controller_core::flight`] does. It keeps time: ticks are due a period apart,
//! counted from the first one. A tick that has not written its command when the next is due has been missed; the ticks it
//! overran are left out, not caught up with. The watchdog is fed by ticks alone that wrote what they decided in time, the
//! stop command included: a vehicle whose motors do not hear it, or that has no time left, is reset.

use crate::deadline::within;
use crate::hardware::{Clock, Fault, MotorCommand, Motors, Watchdog};
use crate::outputs::Outputs;
use crate::shared::{Asked, Event, Report, Shared, Timing};
use controller_core::error::InputError;
use controller_core::estimator::Increment;
use controller_core::flight::rules::{IMU_AGE_MAX, POSE_AGE_MAX};
use controller_core::flight::{Inputs, Outcome, PERIOD, Pilot, Refusal};
use controller_core::state::State;
use core::mem;
use embassy_sync::blocking_mutex::raw::RawMutex;

/// How long the motors' frame may take to write, us.
const WRITING_MAX: u64 = 2_000;

/// The control task's own state.
pub struct Control<'a, M: RawMutex> {
    shared: &'a Shared<M>,
    pilot: &'a mut Pilot<'static>,
    outputs: Outputs,
    timing: Timing,
    /// Whether sensors and motors are a simulator's, as the last tick found it.
    simulated: bool,
    /// When the last IMU increment ended, us.
    integrated: Option<u64>,
    /// What the last tick had to complain about: said when it changes, not a hundred times a second.
    complaint: Complaint,
}

/// What a tick may have to complain about.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Complaint {
    setpoint: Option<Refusal>,
    law: Option<InputError>,
    writing: Option<Fault>,
}

impl<'a, M: RawMutex> Control<'a, M> {
    /// A task that flies as `pilot` says, with motors that turn as `outputs` says.
    pub fn new(shared: &'a Shared<M>, pilot: &'a mut Pilot<'static>, outputs: Outputs) -> Self {
        Self {
            shared,
            pilot,
            outputs,
            timing: Timing::default(),
            simulated: false,
            integrated: None,
            complaint: Complaint::default(),
        }
    }

    /// Runs for ever.
    pub async fn run(&mut self, clock: &impl Clock, motors: &mut impl Motors, watchdog: &mut impl Watchdog) -> ! {
        let mut due = clock.now() + PERIOD;
        loop {
            clock.until(due).await;
            let start = clock.now();
            let command = self.tick(start);
            let written = within(clock, WRITING_MAX, motors.write(command)).await.unwrap_or(Err(Fault));
            let end = clock.now();
            if self.timing.record(due, start, end) && written.is_ok() {
                watchdog.feed();
            }
            self.complain_about_writing(written);
            due = next_due(due, end);
        }
    }

    /// One tick, from what the other tasks have put down to what the motors are told.
    #[inline(never)] // the bound on the stack is counted from here: budgets.toml
    pub fn tick(&mut self, now: u64) -> MotorCommand {
        while let Some(increment) = self.shared.increments.take() {
            self.integrate(&increment);
        }
        let asked = self.shared.requests.take();
        let inputs = self.inputs(now, asked);
        let outcome = self.pilot.tick(&inputs);
        self.tell(&outcome, asked);
        self.report(&inputs, &outcome);
        self.outputs.command(&outcome.output)
    }

    /// Counts an increment that does not begin where the one before it ended: nobody knows what the vehicle did in between.
    fn integrate(&mut self, increment: &Increment) {
        let follows = self.integrated.is_none_or(|end| end == increment.start);
        self.timing.gaps = self.timing.gaps.saturating_add(u32::from(!follows));
        self.integrated = Some(increment.end);
    }

    fn inputs(&mut self, now: u64, asked: Option<Asked>) -> Inputs {
        // The simulator takes over at a stop: an arm command from before it was asked for must not turn the motors once more.
        let handed_over = self.shared.hil.is_raised() && !mem::replace(&mut self.simulated, true);
        Inputs {
            now,
            imu: self.shared.imu.get(),
            pose: self.shared.pose.get(),
            ground_station: self.shared.ground_station.get().map(|heard| heard.time),
            request: asked.map(|asked| asked.request),
            disarm: self.shared.disarm.take() || handed_over,
            setpoint: self.shared.setpoint.take().map(|setpoint| setpoint.value),
        }
    }

    /// Answers, transitions and refusals.
    fn tell(&mut self, outcome: &Outcome, asked: Option<Asked>) {
        if let (Some(Asked { command, .. }), Some(result)) = (asked, outcome.answer) {
            self.shared.answer(command, result);
        }
        if let Some(transition) = outcome.transition {
            self.shared.announce(Event::Mode(transition.reason));
        }
        if let Some(setpoint) = outcome.setpoint {
            let refusal = setpoint.err();
            if refusal != self.complaint.setpoint {
                self.complaint.setpoint = refusal;
                refusal.inspect(|refusal| self.shared.announce(Event::Refused(*refusal)));
            }
        }
        let refused = outcome.flown.as_ref().and_then(|flown| flown.as_ref().err().copied());
        if refused != self.complaint.law {
            self.complaint.law = refused;
            refused.inspect(|error| self.shared.announce(Event::Input(*error)));
        }
    }

    fn report(&self, inputs: &Inputs, outcome: &Outcome) {
        let flown = outcome.flown.as_ref().and_then(|flown| flown.as_ref().ok());
        let report = Report {
            mode: outcome.mode,
            state: flown.map(|flown| flown.state).or_else(|| measured(inputs)),
            wrench: flown.map(|flown| flown.wrench),
            timing: self.timing,
        };
        self.shared.report.put(report, inputs.now);
    }

    fn complain_about_writing(&mut self, written: Result<(), Fault>) {
        let fault = written.err();
        if fault != self.complaint.writing {
            self.complaint.writing = fault;
            self.shared.announce(if fault.is_some() { Event::MotorsLost } else { Event::MotorsRegained });
        }
    }
}

/// The state as measured, where both measurements are fresh enough to fly: for telemetry before the law flies.
fn measured(inputs: &Inputs) -> Option<State> {
    let imu = inputs.imu.filter(|imu| imu.age(inputs.now) <= IMU_AGE_MAX)?.value;
    let pose = inputs.pose.filter(|pose| pose.age(inputs.now) <= POSE_AGE_MAX)?.value;
    let angular_velocity = imu.angular_velocity;
    let (position, velocity, attitude) = (pose.position(), pose.velocity(), pose.attitude());
    Some(State { position, velocity, attitude, angular_velocity })
}

/// When the tick after the one that was due at `due` and ended at `end` is due: a period later, or as many as it overran.
fn next_due(due: u64, end: u64) -> u64 {
    let overrun = end.saturating_sub(due);
    due + overrun - overrun % PERIOD + PERIOD
}

impl Timing {
    /// Takes a tick's times into account, us; whether it ended before the next one was due.
    fn record(&mut self, due: u64, start: u64, end: u64) -> bool {
        let shortened = |time: u64| u32::try_from(time).unwrap_or(u32::MAX);
        let in_time = end < due + PERIOD;
        self.worst_jitter = self.worst_jitter.max(shortened(start.abs_diff(due)));
        self.worst_duration = self.worst_duration.max(shortened(end.saturating_sub(start)));
        self.missed = self.missed.saturating_add(u32::from(!in_time));
        in_time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tick_in_time_is_followed_a_period_later() {
        let mut timing = Timing::default();
        assert!(timing.record(20_000, 20_030, 20_400));
        assert_eq!(timing, Timing { worst_duration: 370, worst_jitter: 30, missed: 0, gaps: 0 });
        assert_eq!(next_due(20_000, 20_400), 30_000);
    }

    #[test]
    fn an_overrun_is_missed_and_not_caught_up_with() {
        let mut timing = Timing::default();
        assert!(!timing.record(20_000, 20_000, 30_000));
        assert_eq!(timing.missed, 1);
        assert_eq!(next_due(20_000, 30_000), 40_000);
        assert_eq!(next_due(20_000, 45_000), 50_000);
    }
}
