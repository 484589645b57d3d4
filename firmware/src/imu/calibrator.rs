//! Calibration of the inertial sensors: the requested procedure, its progress and its result.
//!
//! | requested by PREFLIGHT_CALIBRATION | does |
//! |---|---|
//! | parameter 1 = 1 | the gyro's bias, from a second of standing still; also without a request, once after boot |
//! | parameter 5 = 1 | the accelerometer's offsets and scales, from a second on each of its six sides, in any order |
//! | parameter 5 = 2 | how level the sensor sits, from a second of the vehicle standing level |
//! | parameter 5 = 4 | the accelerometer's offsets alone, taken from a second of the vehicle standing level |
//! | all zero | ends what is under way |
//!
//! [`standstill`](estimation::imu::standstill) decides whether it stood still. The sensor that stands by is calibrated
//! along with the other, from its own samples. What comes out is applied at once, and kept in the parameters. Six sides
//! and the single one forget the level that was found with other offsets: level afterwards.
//!
//! Only a disarmed vehicle is calibrated; arming ends it, and so does a simulator that takes over the sensors. A
//! calibration without a request is done in silence, again and again until it stood still for once.

use super::solution::{GRAVITY_M_PER_S2, solve};
use crate::hardware::{Fault, RawImu, Unit};
use crate::link::acknowledgement::Order;
use crate::parameters::calibration;
use crate::shared::{Event, ImuView, Procedure, Reply, Severity};
use core::fmt::Display;
use embassy_sync::blocking_mutex::raw::RawMutex;
use estimation::imu::Calibration;
use estimation::imu::six_point::{SixPoint, SixPointError};
use estimation::imu::standstill::{Moved, Standstill, StandstillMeans};
use mavlink::dialects::common::MavResult;

/// How long a sensor may need for a second's samples.
const STANDSTILL_TIMEOUT_US: u64 = 5_000_000;

/// How long the next side may take.
const SIDE_TIMEOUT_US: u64 = 60_000_000;

/// What is found out about one sensor.
#[derive(Default)]
struct Findings {
    standstill: Standstill,
    rest: Option<Result<StandstillMeans, Moved>>,
    sides: SixPoint,
}

impl Findings {
    fn take(&mut self, sample: &RawImu) {
        let Some(force) = &sample.specific_force else { return };
        if let Some(rest) = self.standstill.take(&sample.angular_velocity, force) {
            self.rest = Some(rest);
        }
    }

    /// Begins another standstill.
    fn next(&mut self) {
        (self.standstill, self.rest) = Default::default();
    }
}

/// A calibration under way.
struct Job {
    procedure: Procedure,
    /// The command that requested it, if one did.
    order: Option<Order>,
    /// When it has taken too long, us.
    until: u64,
    /// Of the first and of the second sensor.
    findings: [Findings; 2],
    sides: u8,
    /// How the sensor that stands by does; `None` without one, or before its first sample.
    standby: Option<Result<(), Fault>>,
    /// The last report on a position that is not a side.
    reported: Option<SixPointError>,
}

impl Job {
    fn new(procedure: Procedure, order: Option<Order>, now: u64) -> Self {
        let within = if procedure == Procedure::SixSides { SIDE_TIMEOUT_US } else { STANDSTILL_TIMEOUT_US };
        let findings = Default::default();
        Self { procedure, order, until: now.saturating_add(within), findings, sides: 0, standby: None, reported: None }
    }
}

/// The calibrations of both sensors, and the procedure under way.
pub struct Calibrator<'a, M: RawMutex> {
    shared: ImuView<'a, M>,
    /// Of the first and of the second sensor.
    calibrations: [Calibration; 2],
    job: Option<Job>,
}

/// The sensor's place in a pair.
fn place(unit: Unit) -> usize {
    match unit {
        Unit::First => 0,
        Unit::Second => 1,
    }
}

impl<'a, M: RawMutex> Calibrator<'a, M> {
    /// Begins with what was kept, and with the gyro's bias of today.
    pub fn new(shared: ImuView<'a, M>, now: u64) -> Self {
        let calibrations = [(Unit::First, 1), (Unit::Second, 2)].map(|(unit, number)| {
            calibration::load(shared.parameters(), unit).unwrap_or_else(|unlevelled| {
                let words = format_args!("IMU{number}_LEVEL: above 5 degrees, not used");
                shared.announce(Event::new(Severity::Warning, words));
                unlevelled
            })
        });
        Self { shared, calibrations, job: Some(Job::new(Procedure::Gyro, None, now)) }
    }

    /// What corrects a sensor's samples.
    pub fn calibration(&self, unit: Unit) -> &Calibration {
        let [first, second] = &self.calibrations;
        match unit {
            Unit::First => first,
            Unit::Second => second,
        }
    }

    /// Whether samples of the sensor that stands by are wanted. One that has failed is not read again: it takes its
    /// time.
    pub fn needs_standby(&self) -> bool {
        self.job.as_ref().is_some_and(|job| job.standby != Some(Err(Fault)))
    }

    /// Starts what was requested, and ends what may not go on.
    pub fn poll(&mut self, now: u64) {
        while let Some((asked, order)) = self.shared.calibrations().take() {
            let result = match asked {
                None => {
                    self.fail("Calibration: ended by command");
                    MavResult::MAV_RESULT_ACCEPTED
                }
                Some(_) if self.job.as_ref().is_some_and(|job| job.order.is_some()) => {
                    MavResult::MAV_RESULT_TEMPORARILY_REJECTED
                }
                Some(procedure) => {
                    self.job = Some(Job::new(procedure, Some(order), now));
                    MavResult::MAV_RESULT_IN_PROGRESS
                }
            };
            self.answer(order, result);
        }
        let Some(job) = &self.job else { return };
        if self.shared.is_armed() {
            self.fail("Calibration: ended by arming");
        } else if self.shared.hil().is_raised() {
            self.fail("Calibration: a simulator has the sensors");
        } else if job.order.is_some() && now >= job.until {
            self.fail("Calibration: took too long");
        }
    }

    /// Takes a sample of the sensor that `unit` is, and one of the sensor that stands by, if there is one; whether
    /// calibrations have changed.
    pub fn take(&mut self, unit: Unit, sample: &RawImu, standby: Option<Result<RawImu, Fault>>) -> bool {
        let Some(job) = &mut self.job else { return false };
        if let Some(standby) = &standby {
            job.standby = Some(standby.as_ref().map(|_| ()).map_err(|fault| *fault));
        }
        let [first, second] = &mut job.findings;
        let (active, other) = match unit {
            Unit::First => (first, second),
            Unit::Second => (second, first),
        };
        active.take(sample);
        if let Some(Ok(standby)) = &standby {
            other.take(standby);
        }
        let Some(rest) = active.rest else { return false };
        let others = other.rest.and_then(Result::ok);
        active.next();
        other.next();
        let rests = match unit {
            Unit::First => [rest.as_ref().ok(), others.as_ref()],
            Unit::Second => [others.as_ref(), rest.as_ref().ok()],
        };
        match rest {
            Ok(_) => self.conclude(unit, &rests, sample.time),
            Err(moved) => {
                if job.order.is_some() && job.procedure != Procedure::SixSides {
                    self.fail(moved);
                }
                false
            }
        }
    }

    /// Solves the requested calibration from standstills; that of `unit` is among them.
    fn conclude(&mut self, unit: Unit, rests: &[Option<&StandstillMeans>; 2], time: u64) -> bool {
        let Some(job) = &mut self.job else { return false };
        let procedure = job.procedure;
        if procedure == Procedure::SixSides && !Self::add_sides(self.shared, job, unit, rests, time) {
            return false;
        }
        let mut found = [None; 2];
        for (index, (found, rest)) in found.iter_mut().zip(rests).enumerate() {
            let (Some(rest), Some(before)) = (rest, self.calibrations.get(index)) else { continue };
            let sides = job.findings.get(index).map(|findings| findings.sides);
            match solve(procedure, before, rest, sides) {
                Ok(calibration) => *found = Some(calibration),
                Err(problem) if index == place(unit) => {
                    self.fail(problem);
                    return false;
                }
                // The sensor in use is calibrated all the same.
                Err(_) => {}
            }
        }
        for (index, unit) in [Unit::First, Unit::Second].into_iter().enumerate() {
            let (Some(Some(found)), Some(kept)) = (found.get(index), self.calibrations.get_mut(index)) else {
                continue;
            };
            *kept = *found;
            if let Err(refused) = calibration::store(self.shared.parameters(), unit, found) {
                self.shared.announce(Event::new(Severity::Warning, refused));
            }
        }
        if procedure == Procedure::Gyro {
            self.shared.gyro_calibrated().raise();
        }
        if let Some(job) = self.job.take()
            && let Some(order) = job.order
        {
            if job.standby.is_some() && found.contains(&None) {
                self.shared.announce(Event::new(Severity::Warning, "Calibration: not of the IMU that stands by"));
            }
            let words = match procedure {
                Procedure::Gyro => "Gyro calibrated",
                Procedure::SixSides | Procedure::OneSide => "Accelerometer calibrated: now level",
                Procedure::Level => "Level calibrated",
            };
            self.shared.announce(Event::new(Severity::Information, words));
            self.answer(order, MavResult::MAV_RESULT_ACCEPTED);
        }
        true
    }

    /// Adds a side, and reports progress; whether all six are there.
    fn add_sides(
        shared: ImuView<'_, M>,
        job: &mut Job,
        unit: Unit,
        rests: &[Option<&StandstillMeans>; 2],
        time: u64,
    ) -> bool {
        for (index, (findings, rest)) in job.findings.iter_mut().zip(rests).enumerate() {
            let Some(rest) = rest else { continue };
            let added = findings.sides.add(rest, GRAVITY_M_PER_S2);
            if index != place(unit) {
                continue;
            }
            match added {
                Ok(()) => {
                    (job.sides, job.reported) = (job.sides + 1, None);
                    job.until = time.saturating_add(SIDE_TIMEOUT_US);
                    let words = format_args!("Calibration: {} of 6 sides", job.sides);
                    shared.announce(Event::new(Severity::Information, words));
                }
                // It still lies there.
                Err(SixPointError::FaceTwice) => {}
                Err(error) => {
                    if job.reported.replace(error) != Some(error) {
                        shared.announce(Event::new(Severity::Warning, error));
                    }
                }
            }
            if added.is_err() {
                return false;
            }
        }
        job.sides == 6
    }

    /// Ends what is under way, and answers the command that requested it with the reason.
    fn fail(&mut self, words: impl Display) {
        if let Some(order) = self.job.take().and_then(|job| job.order) {
            self.shared.announce(Event::new(Severity::Warning, words));
            self.answer(order, MavResult::MAV_RESULT_FAILED);
        }
    }

    fn answer(&self, order: Order, result: MavResult) {
        self.shared.reply(Reply::Command(order.answered(result)));
    }
}
