//! The verdict on a pose: fused at the horizon, or before it; a frame that moved; a candidate; or refused.
//!
//! ```text
//!                     no filter ──────────────────────────────────────────> candidate ─ proven ─> started
//! pose ─ in time ─┬─> before the horizon: take back, fuse, fuse again          ^
//!                 └─> later: advance ─┬─ sender's frame moved ─> rebased       │ refused by a gate
//!                                     └─ gates ─┬─ within ─> fused             │
//!                                               └──────────────────────────────┘─ proven, near ─> refound
//! ```

use super::candidate::Candidate;
use super::filter::Filter;
use super::measurement::PoseMeasurement as Pose;
use super::verdict::{Accepted, Rejected};
use super::{EXTRAPOLATION_MAX_US, Estimator, Increment, REBASE_INTERVAL_MIN_US, TILT_COSINE_MIN, rotated};
use crate::measurement::Stamped;

impl Estimator {
    /// Takes a pose if the IMU has got that far, or keeps it.
    pub(super) fn take_in_time(&mut self, pose: &Stamped<Pose>) -> Result<Accepted, Rejected> {
        let (start, end) = self.history.span().ok_or(Rejected::NoImu)?;
        if pose.time < start {
            Err(Rejected::TooOld)
        } else if pose.time <= end {
            self.take(pose)
        } else if pose.time - end > EXTRAPOLATION_MAX_US {
            Err(Rejected::NoImu)
        } else {
            self.waiting.push(*pose).map_or(Err(Rejected::NoImu), |()| Ok(Accepted::Waiting))
        }
    }

    /// Takes the poses that have waited for the IMU to get to `end`, us.
    pub(super) fn take_waiting(&mut self, end: u64) {
        for pose in core::mem::take(&mut self.waiting).iter() {
            if pose.time <= end {
                let verdict = self.take(pose);
                self.statistics.record(verdict, pose.time);
            } else {
                // It was there before: it fits.
                let _ = self.waiting.push(*pose);
            }
        }
    }

    fn take(&mut self, pose: &Stamped<Pose>) -> Result<Accepted, Rejected> {
        let Some(filter) = self.filter else {
            return self.seek(pose, None);
        };
        let verdict = if pose.time < filter.time { self.fuse_late(pose) } else { self.fuse_next(&filter, pose) };
        match verdict {
            Err(Rejected::NotFinite) => self.restart(),
            Ok(_) => self.carry_on(),
            Err(_) => {}
        }
        if let Some(filter) = &self.filter {
            self.statistics.record_certainty(filter);
        }
        verdict
    }

    /// A pose later than the horizon.
    fn fuse_next(&mut self, before: &Filter, pose: &Stamped<Pose>) -> Result<Accepted, Rejected> {
        let mut filter = *before;
        filter.advance(pose.time, &self.history, &self.settings);
        self.filter = Some(filter);
        if self.is_moved_frame(pose) {
            return self.rebase(filter, pose);
        }
        match self.fuse(&mut filter, pose) {
            Ok(()) => {
                self.checkpoints.push(before, pose);
                self.filter = Some(filter);
                self.candidate = None;
                Ok(Accepted::Fused)
            }
            Err(Rejected::NotFinite) => Err(Rejected::NotFinite),
            Err(why) => self.seek(pose, Some(why)),
        }
    }

    /// A pose that belongs before the horizon: the poses after its time are taken back, and fused again after it.
    fn fuse_late(&mut self, pose: &Stamped<Pose>) -> Result<Accepted, Rejected> {
        let (mut filter, later) = self.checkpoints.rewind(pose.time).ok_or(Rejected::TooOld)?;
        let mut verdict = Err(Rejected::TooOld);
        for (number, next) in core::iter::once(pose).chain(later.iter().rev()).enumerate() {
            let before = filter;
            filter.advance(next.time, &self.history, &self.settings);
            let fused = self.fuse(&mut filter, next);
            if fused.is_ok() {
                self.checkpoints.push(&before, next);
            }
            if number == 0 || fused == Err(Rejected::NotFinite) {
                verdict = fused.map(|()| Accepted::Fused);
            }
        }
        self.filter = Some(filter);
        // Where the poses after it no longer count, the state has changed all the same.
        self.carry_on();
        verdict
    }

    /// Weighs a pose, and takes it into account if it is within its gates.
    fn fuse(&mut self, filter: &mut Filter, pose: &Stamped<Pose>) -> Result<(), Rejected> {
        let tested = filter.weigh(&pose.value, &self.settings)?;
        self.statistics.record_nis(tested.nis());
        tested.gate()?;
        filter.fuse(&pose.value, &tested)
    }

    /// Whether the sender reports a move of its frame, and can be believed.
    fn is_moved_frame(&mut self, pose: &Stamped<Pose>) -> bool {
        let (resets, since) = *self.frame.get_or_insert((pose.value.resets, 0));
        resets != pose.value.resets && pose.time.saturating_sub(since) >= REBASE_INTERVAL_MIN_US
    }

    fn rebase(&mut self, mut filter: Filter, pose: &Stamped<Pose>) -> Result<Accepted, Rejected> {
        let moved = pose.value.attitude * filter.nominal.attitude.conjugate();
        if 1.0 - 2.0 * (moved.i * moved.i + moved.j * moved.j) < TILT_COSINE_MIN {
            return Err(Rejected::Gravity);
        }
        filter.rebase(&pose.value, &self.settings);
        self.follow(&filter);
        self.frame = Some((pose.value.resets, pose.time));
        self.statistics.jumps += 1;
        Ok(Accepted::Rebased)
    }

    /// Tries a pose on the candidate: without a filter, or where the filter does not believe the pose for the reason
    /// given.
    fn seek(&mut self, pose: &Stamped<Pose>, why: Option<Rejected>) -> Result<Accepted, Rejected> {
        let unproven = why.map_or(Ok(Accepted::Aligning), Err);
        self.check_up(&pose.value)?;
        let biases = self.filter.as_ref().map_or(self.biases, Filter::biases);
        let fresh = Candidate::new(pose.time, &pose.value, &biases, &self.settings);
        let candidate = self.candidate.get_or_insert_with(|| fresh.clone());
        if pose.time < candidate.filter.time {
            return Err(Rejected::TooOld);
        }
        if pose.time > candidate.filter.time {
            let taken = candidate.take(pose.time, &pose.value, &self.history, &self.settings);
            if let Err(error) = candidate.check_gravity(&self.settings).and(taken) {
                if candidate.is_lost(&self.settings) {
                    *candidate = fresh;
                }
                return Err(why.unwrap_or(error));
            }
        }
        if !candidate.is_proven() {
            return unproven;
        }
        let found = candidate.filter;
        if let Some(filter) = &self.filter {
            candidate.compare(filter, pose.time.saturating_sub(self.statistics.fused_at))?;
        }
        let taken = if self.filter.is_some() { Accepted::Refound } else { Accepted::Started };
        self.statistics.jumps += u32::from(taken == Accepted::Refound);
        self.frame = Some((pose.value.resets, self.frame.map_or(0, |(_, since)| since)));
        self.follow(&found);
        Ok(taken)
    }

    /// Makes `filter` the one, whose past does not matter.
    pub(super) fn follow(&mut self, filter: &Filter) {
        self.filter = Some(*filter);
        self.candidate = None;
        self.checkpoints.clear();
        self.statistics.forget_nis();
        self.carry_on();
    }

    /// Carries the nominal state from the horizon to the end of the history.
    pub(super) fn carry_on(&mut self) {
        self.latest = self.filter.as_ref().map(|filter| {
            let (mut nominal, gravity) = (filter.nominal, self.settings.parameters().gravity);
            for increment in self.history.between(filter.time, u64::MAX) {
                nominal.advance(&increment, gravity);
            }
            nominal
        });
    }

    /// Whether up is where the accelerometer says, by one increment: of a vehicle at rest.
    fn check_up(&self, pose: &Pose) -> Result<(), Rejected> {
        let Some(newest) = self.history.newest().filter(|newest| !self.moves(newest)) else { return Ok(()) };
        let force = rotated(&pose.attitude, &newest.delta_velocity);
        let cosine = force.z / controller_core::math::sqrt(force.norm_squared());
        if cosine < TILT_COSINE_MIN { Err(Rejected::Gravity) } else { Ok(()) }
    }

    /// Whether an increment is of a vehicle that moves, beyond any noise at rest.
    pub(super) fn moves(&self, increment: &Increment) -> bool {
        /// rad/s: a plausible bias, unknown before the first pose, and six times a BMI088's noise over 5 ms.
        const MOVING_RATE_RAD_PER_S: f32 = 0.045;
        /// m/s^2: the same.
        const MOVING_FORCE_M_PER_S2: f32 = 0.5;
        self.exceeds_rest_by(increment, MOVING_RATE_RAD_PER_S, MOVING_FORCE_M_PER_S2)
    }

    /// Whether an increment differs from that of perfect rest. In the air a real sensor has its noise; a simulated one
    /// without noise may repeat itself as its poses do.
    pub(super) fn differs_from_rest(&self, increment: &Increment) -> bool {
        /// rad/s: less than a BMI088's noise over 5 ms.
        const STIRRING_RATE_RAD_PER_S: f32 = 0.002;
        /// m/s^2: the same.
        const STIRRING_FORCE_M_PER_S2: f32 = 0.05;
        self.exceeds_rest_by(increment, STIRRING_RATE_RAD_PER_S, STIRRING_FORCE_M_PER_S2)
    }

    /// Whether an increment is not of rest, by more than a body rate, rad/s, or a specific force, m/s^2.
    fn exceeds_rest_by(&self, increment: &Increment, most_rate: f32, most_force: f32) -> bool {
        let biases = self.filter.as_ref().map_or(self.biases, Filter::biases);
        let per_second = 1.0 / increment.seconds();
        let rate = increment.delta_angle * per_second - biases.gyro;
        let force = increment.delta_velocity * per_second - biases.accelerometer;
        let weight = controller_core::math::sqrt(force.norm_squared()) - self.settings.parameters().gravity;
        rate.norm_squared() > most_rate * most_rate || weight.abs() > most_force
    }
}
