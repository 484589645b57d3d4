//! The control task: at the rate of the file that is built in, the pilot's decision to the motors, on time.
//!
//! ```text
//! due -> inputs from its view -> Pilot::tick -> motor command -> written -> report
//!                                                            '-> watchdog fed, if all of it was in time
//! ```
//!
//! The task decides nothing about flight: [`flight`] does. It keeps time: ticks are due a period apart, counted from
//! the first one. A tick that has not written its command when the next is due has been missed; the ticks it overran
//! are left out, not caught up with. The watchdog is fed by ticks alone that wrote what they decided in time, the stop
//! command included: a vehicle whose motors do not receive it, or that has no time left, is reset.

use crate::configuration::Pilot;
use crate::deadline::within;
use crate::esc::controller::SPEED_AGE_MAX_US;
use crate::frames;
use crate::hardware::{Clock, Fault, MotorCommand, Motors, Watchdog};
use crate::link::origin::Origin;
use crate::outputs::{Outputs, voltage_ratio};
use crate::parameters::table::Name;
use crate::recorder::{RECORD_SPACING_MIN_US, SPACING_BESIDE_GYRO_US};
use crate::shared::{
    ControlView, Event, INCREMENTS_CAPACITY, MissionReport, POSES_CAPACITY, Queue, QueuedRequest, Report, Take, Timing,
};
use controller_core::error::InputError;
use core::mem;
use embassy_sync::blocking_mutex::raw::RawMutex;
use estimation::estimator::{Accepted, Fault as EstimatorFault, Increment, Rejected};
use flight::{Battery, Inputs, MissionItem, MissionStep, Outcome, Reason, Refusal, Stamped, Stored, Transition};
use heapless::Vec;

/// How long the motors' frame may take to write at most: half of a period, where that is less.
const MOTORS_WRITE_TIMEOUT_US: u64 = 2_000;

/// The greatest age of a voltage that counts.
const VOLTAGE_AGE_MAX_US: u64 = 1_000_000;

/// How long a fault of the IMU is held after its last sample.
const IMU_FAULT_HOLD_US: u64 = 1_000_000;

/// The least interval between reports of refused poses, and of estimator faults.
const TEXT_INTERVAL_US: u64 = 1_000_000;

/// The control task's own state.
pub struct Control<'a, M: RawMutex> {
    shared: ControlView<'a, M>,
    pilot: &'a mut Pilot,
    outputs: Outputs,
    timing: Timing,
    mission: MissionReport,
    /// Whether the last tick ended too late.
    is_late: bool,
    /// Whether sensors and motors are a simulator's, as the last tick found it.
    simulated: bool,
    /// When the last IMU increment ended, us.
    integrated: Option<u64>,
    /// The last tick's faults: reported when they change, not in each tick.
    reported: ReportedFaults,
}

/// The faults of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct ReportedFaults {
    setpoint: Option<Refusal>,
    law: Option<InputError>,
    battery: bool,
    writing: Option<Fault>,
    estimator: Option<EstimatorFault>,
    /// Before these times, us, no refused pose and no fault of the estimator is reported again.
    quiet: (u64, u64),
}

impl<'a, M: RawMutex> Control<'a, M> {
    /// A task that flies by `pilot`, with `outputs` for the motors.
    pub fn new(shared: ControlView<'a, M>, pilot: &'a mut Pilot, outputs: Outputs) -> Self {
        let spacing = if shared.gyro_log().is_attached() { SPACING_BESIDE_GYRO_US } else { RECORD_SPACING_MIN_US };
        shared.recorder().ticks_last(pilot.period(), spacing);
        Self {
            shared,
            outputs,
            timing: Timing { period: pilot.period(), ..Timing::default() },
            pilot,
            mission: MissionReport::default(),
            is_late: false,
            simulated: false,
            integrated: None,
            reported: ReportedFaults::default(),
        }
    }

    /// Runs for ever.
    pub async fn run(&mut self, clock: &impl Clock, motors: &mut impl Motors, watchdog: &mut impl Watchdog) -> ! {
        let period = self.pilot.period();
        let writing_max = MOTORS_WRITE_TIMEOUT_US.min(period / 2);
        let mut due = clock.now() + period;
        loop {
            clock.until(due).await;
            let start = clock.now();
            let command = self.tick(start);
            let written = within(clock, writing_max, motors.write(command)).await.unwrap_or(Err(Fault));
            let end = clock.now();
            let in_time = self.timing.record(due, start, end);
            self.is_late |= !in_time;
            if in_time && written.is_ok() {
                watchdog.feed();
            }
            self.report_writing(written);
            due = next_due(due, end, period);
        }
    }

    /// One tick, from what the other tasks have put down to the motors' command.
    #[inline(never)] // the bound on the stack is counted from here: budgets.toml
    pub fn tick(&mut self, now: u64) -> MotorCommand {
        self.shared.set_text_time(now);
        let increments: Vec<Increment, INCREMENTS_CAPACITY> = waiting(self.shared.increments());
        let poses: Vec<_, POSES_CAPACITY> = waiting(self.shared.poses());
        increments.iter().for_each(|increment| self.integrate(increment));
        let asked = self.shared.requests().take();
        self.pilot.use_settings(&self.shared.parameters().flight_settings());
        let speeds = self.shared.rotor_speeds().get();
        let rotor_speeds = speeds.as_ref().map(|speeds| Stamped { value: &speeds.value[..], time: speeds.time });
        let inputs = Inputs { increments: &increments, poses: &poses, rotor_speeds, ..self.inputs(now, asked) };
        let outcome = self.pilot.tick(&inputs);
        let has_armed = outcome.transition.is_some_and(|transition| transition.reason == Reason::Armed);
        if has_armed {
            let order = asked.and_then(|asked| asked.order);
            self.shared.commander().put(order.map(|order| order.sender), now);
        }
        self.follow_the_mission(&outcome);
        if !outcome.setpoints_requested {
            self.shared.setpoint_owner().set(None);
        }
        self.announce_outcome(&outcome, asked);
        if has_armed && self.shared.pose_delay_unknown().is_raised() {
            self.shared.announce(Event::PoseDelayUnknown);
        }
        self.report_the_battery(inputs.battery == Battery::Missing && outcome.mode.is_armed());
        self.report_the_estimate(&outcome, now);
        let (parameters, voltage) = (self.shared.parameters(), self.shared.voltage().get());
        let ratio = voltage_ratio(parameters.get(Name::BatteryNominal), voltage, now);
        let command = self.outputs.command(&outcome.output, ratio);
        let report = Report { motors: command.levels(), ..self.report(&inputs, &outcome) };
        self.shared.report().put(report, now);
        let voltage = self.shared.voltage().recent(VOLTAGE_AGE_MAX_US, now);
        let turned = self.shared.rotor_speeds().recent(SPEED_AGE_MAX_US, now).unwrap_or_default();
        self.shared.recorder().record(report.mode.is_armed(), || report.tick(now, command, turned, voltage));
        command
    }

    /// Counts an increment that does not begin where the one before it ended: the motion in
    /// between is unknown.
    fn integrate(&mut self, increment: &Increment) {
        let follows = self.integrated.is_none_or(|end| end == increment.start);
        self.timing.gaps = self.timing.gaps.saturating_add(u32::from(!follows));
        self.integrated = Some(increment.end);
    }

    /// What is not measured.
    fn inputs(&mut self, now: u64, asked: Option<QueuedRequest>) -> Inputs<'static> {
        // The simulator takes over at a stop: an arm command from before must not turn the motors once more.
        let handed_over = self.shared.hil().is_raised() && !mem::replace(&mut self.simulated, true);
        let setpoint = self.shared.setpoint().take();
        Inputs {
            now,
            under_way: self.shared.under_way().get().map(|newest| newest.value),
            body_rate: self.shared.imu().get().map(|newest| newest.map(|sample| sample.angular_velocity)),
            specific_force: self.shared.imu().get().map(|newest| newest.map(|sample| sample.specific_force)),
            imu_fault: self.shared.imu_fault().recent(IMU_FAULT_HOLD_US, now),
            ground_station: self.shared.ground_station().get().map(|last| last.time),
            request: asked.map(|asked| asked.request),
            disarm: self.shared.disarm().take() || handed_over,
            killed: self.shared.killed().get().is_some_and(|killed| killed.value),
            is_busy: self.shared.is_busy(),
            lost: self.lost(),
            is_clock_doubtful: self.shared.clock_doubtful().is_raised(),
            motors_fail: self.reported.writing.is_some(),
            battery: self.battery(now),
            is_late: mem::take(&mut self.is_late),
            setpoint: setpoint.map(|setpoint| setpoint.value),
            setpoint_late: setpoint.map_or(0.0, |setpoint| setpoint.age(now) as f32 * 1e-6),
            mission_item: self.mission_item(asked.as_ref()),
            ..Inputs::default()
        }
    }

    /// What was stored and cannot be read any more.
    fn lost(&self) -> Option<Stored> {
        let parameter = self.shared.parameters().lost().map(Stored::Parameter);
        if self.shared.signing().is_lost() { Some(Stored::SigningKey) } else { parameter }
    }

    /// The mission's item that the pilot needs.
    fn mission_item(&self, asked: Option<&QueuedRequest>) -> Option<MissionItem> {
        let number = self.pilot.mission_item(asked.map(|asked| &asked.request))?;
        let item = self.shared.mission().item(number.into())?;
        let home = self.shared.report().get().and_then(|report| report.value.home).unwrap_or_default();
        let origin = self.shared.origin().get().map_or_else(Origin::default, |origin| origin.value);
        Some(item.placed(&origin, &frames::world(&home)))
    }

    /// Notes how far the mission is, and announces how it ends.
    fn follow_the_mission(&mut self, outcome: &Outcome) {
        (self.mission.next, self.mission.is_flown) = outcome.mission;
        let Some(step) = outcome.mission_step else { return };
        if let MissionStep::Reached(item) | MissionStep::Lands(item) = step {
            self.mission.done = (item, self.mission.done.1.wrapping_add(1));
        }
        if !matches!(step, MissionStep::Reached(_)) {
            self.shared.announce(Event::Mission(step));
        }
    }

    /// What the battery has left, by its voltage. Without a recent reading it is unknown, which matters where a voltage
    /// to act on is set.
    fn battery(&self, now: u64) -> Battery {
        let parameters = self.shared.parameters();
        let (low, critical) = (parameters.get(Name::BatteryLow), parameters.get(Name::BatteryCritical));
        match self.shared.voltage().recent(VOLTAGE_AGE_MAX_US, now) {
            None if low > 0.0 || critical > 0.0 => Battery::Missing,
            None => Battery::Unknown,
            Some(voltage) if voltage < critical => Battery::Critical,
            Some(voltage) if voltage < low => Battery::Low,
            Some(_) => Battery::Good,
        }
    }

    /// Answers, transitions and refusals.
    fn announce_outcome(&mut self, outcome: &Outcome, asked: Option<QueuedRequest>) {
        if let (Some(asked), Some(result)) = (asked, outcome.answer) {
            self.shared.answer(&asked, result);
        }
        // The heartbeat reports readiness, which may change many times on the bench.
        if let Some(Transition { reason, .. }) = outcome.transition
            && !matches!(reason, Reason::Started | Reason::Ready | Reason::NotReady)
        {
            self.shared.announce(Event::Mode(reason));
        }
        if let Some(setpoint) = outcome.setpoint {
            let refusal = setpoint.err();
            if refusal != self.reported.setpoint {
                self.reported.setpoint = refusal;
                refusal.inspect(|refusal| self.shared.announce(Event::Refused(*refusal)));
            }
        }
        let refused = outcome.flown.as_ref().and_then(|flown| flown.as_ref().err().copied());
        if refused != self.reported.law {
            self.reported.law = refused;
            refused.inspect(|error| self.shared.announce(Event::Input(*error)));
        }
        if let Some(share) = outcome.doubtful_thrust {
            self.shared.announce(Event::Thrust(share));
        }
        if let Some(fault) = outcome.rotor_fault {
            self.shared.announce(Event::RotorFault(fault));
        }
        if let Some(lost) = outcome.lost {
            self.shared.announce(Event::RotorLost(lost));
        }
        if let Some(streamed) = outcome.streamed {
            self.shared.announce(Event::Streamed(streamed));
        }
        if let Some(handed) = outcome.handover {
            self.shared.announce(Event::Handover(handed));
        }
    }

    /// Reports that an armed vehicle's battery is no longer measured: landing for want of a reading would not help.
    fn report_the_battery(&mut self, is_missing: bool) {
        if is_missing && !self.reported.battery {
            self.shared.announce(Event::BatteryMissing);
        }
        self.reported.battery = is_missing;
    }

    /// Reports refused poses, the estimate's jumps and its faults, at a limited rate.
    fn report_the_estimate(&mut self, outcome: &Outcome, now: u64) {
        let (pose, fault) = &mut self.reported.quiet;
        match outcome.pose {
            // Before there is an IMU to compare it with, nothing is wrong with a pose.
            Some(Err(Rejected::NoImu | Rejected::TooOld)) if outcome.estimated.is_none() => {}
            Some(Err(rejected)) if now >= *pose => {
                *pose = now.saturating_add(TEXT_INTERVAL_US);
                self.shared.announce(Event::Pose(Err(rejected)));
            }
            Some(Ok(taken @ (Accepted::Rebased | Accepted::Refound))) => self.shared.announce(Event::Pose(Ok(taken))),
            _ => {}
        }
        // Before it begins it has no fault.
        let worst = outcome.health.faults.worst().filter(|&worst| worst != EstimatorFault::NotStarted);
        if worst != self.reported.estimator && now >= *fault {
            self.reported.estimator = worst;
            if let Some(worst) = worst {
                *fault = now.saturating_add(TEXT_INTERVAL_US);
                self.shared.announce(Event::Estimator(worst));
            }
        }
    }

    fn report(&self, inputs: &Inputs, outcome: &Outcome) -> Report {
        let flown = outcome.flown.as_ref().and_then(|flown| flown.as_ref().ok());
        Report {
            mode: outcome.mode,
            ready: outcome.ready == Some(Ok(())),
            refusal: outcome.ready.and_then(Result::err),
            is_airborne: outcome.is_airborne,
            may_fall: outcome.may_fall,
            state: outcome.estimated.map(|estimated| estimated.state),
            lean: outcome.lean,
            levelling: outcome.levelling.as_ref().and_then(|shares| shares.as_slice().try_into().ok()),
            health: outcome.health,
            imu_fault: inputs.imu_fault,
            motors_fail: inputs.motors_fail,
            home: outcome.home,
            reference: flown.map(|flown| flown.reference),
            wrench: flown.map(|flown| flown.wrench),
            thrust_scale: flown.map(|flown| flown.thrust_scale),
            mission: self.mission,
            flies_policy: outcome.flies_policy,
            timing: self.timing,
            ..Report::NONE
        }
    }

    fn report_writing(&mut self, written: Result<(), Fault>) {
        let fault = written.err();
        if fault != self.reported.writing {
            self.reported.writing = fault;
            self.shared.announce(if fault.is_some() { Event::MotorsLost } else { Event::MotorsRegained });
        }
    }
}

/// Everything that waits in a queue.
fn waiting<M: RawMutex, T, const ROOM: usize>(queue: Take<'_, Queue<M, T, ROOM>>) -> Vec<T, ROOM> {
    // No more than there is room for: what comes meanwhile waits for the next tick.
    core::iter::from_fn(|| queue.take()).take(ROOM).collect()
}

/// When the tick after the one that was due at `due` and ended at `end` is due: a period later, or as many as it
/// overran.
fn next_due(due: u64, end: u64, period: u64) -> u64 {
    let overrun = end.saturating_sub(due);
    due + overrun - overrun.checked_rem(period).unwrap_or(0) + period
}

impl Timing {
    /// Takes a tick's times into account, us; whether it ended before the next one was due.
    fn record(&mut self, due: u64, start: u64, end: u64) -> bool {
        let shortened = |time: u64| u32::try_from(time).unwrap_or(u32::MAX);
        let in_time = end < due + self.period;
        self.worst_jitter = self.worst_jitter.max(shortened(start.abs_diff(due)));
        self.worst_duration = self.worst_duration.max(shortened(end.saturating_sub(start)));
        self.missed = self.missed.saturating_add(u32::from(!in_time));
        in_time
    }
}

#[cfg(test)]
mod tests;
