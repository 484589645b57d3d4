//! The state that is flown: the estimator's, its health, and since when it is healthy.
//!
//! Once a tick the estimator is given what the IMU did and the poses that came. On the ground it follows poses that
//! have jumped and agree among themselves; in flight it refuses them.

use super::exchange::Inputs;
use super::rules::COASTING_MAX_US;
use controller_core::state::State;
use estimation::estimator::{
    Accepted, COASTING_AFTER_US, EXTRAPOLATION_MAX_US, EstimatedState, Estimator, Fault, Health, Rejected,
};
use estimation::measurement::is_fresh;
use nalgebra::{Quaternion, Vector3};

/// How long the estimate must have been healthy, and every pose believed, before a vehicle arms.
pub const SETTLED_AFTER_US: u64 = 1_000_000;

/// What a tick flies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Estimate {
    /// The state at the tick's instant; none without an IMU, or where the estimator has lost it.
    pub state: Option<EstimatedState>,
    /// v' since the last tick, by accelerometer, m/s^2, world.
    pub felt: Option<Vector3<f32>>,
    pub health: Health,
    /// The verdict on this tick's poses: the last refusal, or else what the last was taken for.
    pub pose: Option<Result<Accepted, Rejected>>,
    /// Where the state has jumped since the last tick: the one it would be, had it not.
    pub jumped_from: Option<State>,
    /// Whether all has been well for [`SETTLED_AFTER_US`].
    pub settled: bool,
}

impl Estimate {
    /// Whether poses are no longer believed, or the estimate has become too uncertain to be flown.
    pub fn is_lost(&self) -> bool {
        !self.is_certain_within(COASTING_MAX_US)
    }

    /// Whether poses are believed, and the estimate may be flown again.
    pub fn is_found(&self) -> bool {
        self.is_certain_within(COASTING_AFTER_US)
    }

    fn is_certain_within(&self, age_max: u64) -> bool {
        let Health { faults, pose_age, .. } = self.health;
        !faults.contain(Fault::Uncertain) && pose_age.is_some_and(|age| age <= age_max)
    }
}

/// The estimator, and what the last tick left of it.
#[derive(Debug, PartialEq)]
pub(super) struct Estimation<'m> {
    estimator: &'m mut Estimator,
    /// Poses that were believed, and not.
    counts: (u32, u32),
    jumps: u32,
    /// The state at the last tick, and when that was, us.
    last: Option<(State, u64)>,
    /// Since when all has been well, us.
    since: Option<u64>,
}

impl<'m> Estimation<'m> {
    pub fn new(estimator: &'m mut Estimator) -> Self {
        Self { estimator, counts: (0, 0), jumps: 0, last: None, since: None }
    }

    /// The vertical speed, m/s, in the short term by the accelerometer rather than by poses that may lie.
    pub fn climb(&self) -> f32 {
        self.estimator.climb()
    }

    /// Poses lie: biases estimated since lift-off count only as far as a sensor may have changed.
    pub fn distrust(&mut self) {
        self.estimator.distrust();
    }

    /// The vehicle may stand still, or not: in the air poses that do are refused.
    pub fn may_stand(&mut self, may_stand: bool) {
        self.estimator.may_stand(may_stand);
    }

    /// Takes what the IMU did and the poses that came since the last tick, `armed` or not, in the air or not. Poses of
    /// a source that is `given_up` are refused.
    pub fn tick(&mut self, inputs: &Inputs, armed: bool, airborne: bool, given_up: bool) -> Estimate {
        let Inputs { increments, poses, now, .. } = *inputs;
        self.estimator.is_airborne(airborne);
        // An increment that ends in the future is invalid.
        for increment in increments.iter().filter(|increment| is_fresh(increment.end, u64::MAX, now)) {
            self.estimator.imu(increment);
        }
        let mut refused = None;
        for pose in poses {
            let verdict = if given_up { Err(Rejected::GivenUp) } else { self.estimator.pose(pose, now) };
            if let Err(rejected) = verdict {
                refused = Some(Err(rejected));
            }
        }
        if !armed {
            // That it has is counted with the other jumps.
            let _ = self.estimator.adopt();
        }
        let rate = inputs.body_rate.filter(|rate| is_fresh(rate.time, EXTRAPOLATION_MAX_US, now));
        let (health, state) = (
            self.estimator.health(now),
            rate.and_then(|rate| self.estimator.state(now, &rate.value, inputs.under_way.as_ref())),
        );
        let felt = self.estimator.mean_acceleration(now, inputs.under_way.as_ref());
        let jumped = health.jumps != self.jumps;
        let steady = health.is_good() && state.is_some() && !jumped && health.counts.1 == self.counts.1;
        self.since = if steady { self.since.or(Some(now)) } else { None };
        let pose = refused.or(health.last.filter(|_| health.counts != self.counts));
        (self.jumps, self.counts) = (health.jumps, health.counts);
        let current = state.map(|estimated| (estimated.state, now));
        let last = core::mem::replace(&mut self.last, current);
        Estimate {
            state,
            felt,
            health,
            pose,
            jumped_from: last.filter(|_| jumped).map(|(state, then)| carried_on(&state, now.saturating_sub(then))),
            settled: self.since.is_some_and(|since| now.saturating_sub(since) >= SETTLED_AFTER_US),
        }
    }
}

/// `state` after a tick's `time`, us, of going on and turning as it does; its attitude near unit length only.
fn carried_on(state: &State, time: u64) -> State {
    let seconds = time as f32 * 1e-6;
    let turned = state.attitude * Quaternion::from_imag(state.angular_velocity * (0.5 * seconds));
    State { position: state.position + state.velocity * seconds, attitude: state.attitude + turned, ..*state }
}
