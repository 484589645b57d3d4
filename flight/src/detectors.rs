//! Detectors: whether the vehicle follows its reference, has landed, or lies on its back.
//!
//! An *impact* is an upward acceleration that the rotors do not explain, of a vehicle that goes down. A *touchdown* is
//! one so strong that only the ground gives it, a *hit* one beyond the accelerometer's range.
//!
//! - *Landed*, with an estimate: the reference has gone on down and the vehicle has not, and stands still, for longer
//!   than a vehicle that reverses in the air does, in a rising wind for example.
//! - *Landed*, by the IMU alone: an impact has stopped the vehicle, and the law now commands less thrust than carries
//!   it. Or, where the ground was soft, so little thrust that the vehicle must fall faster, and it does not. Rotors
//!   that deliver 8 % more than commanded would look the same: with the law's thrust scale and force they do not.
//!   So would the air's drag of a vehicle that sinks. A vehicle that rises or sinks on has not landed, and landing is
//!   detected only once its descent is fast enough to show, or after a touchdown; but a hit leaves a false speed.
//! - *The IMU is doubtful*, without poses: it measures another force than commanded that is not the ground's, friction
//!   included, or the vehicle does not come upright, or turns on.
//! - *Crashed*: still, and by 30 degrees or more from the attitude that the law commands, or tilted by 80, or by 60
//!   while no law flies it. In the air such a vehicle turns or falls; one that the law tilts holds against a wind.
//! - *Tracking lost*: far from the reference; still, well below it: a vehicle that does not get off the ground; or
//!   struck, with a jump of the estimate just afterwards: a crash looks like that.
//!
//! Rotors out of balance vibrate a standing vehicle: its motion and force are therefore [low-passed](super::low_pass).
//! An impact is too short for that.

mod snapshot;

use super::chain::Chain;
use super::debounce::Debounce;
use super::exchange::{Battery, Inputs};
use super::low_pass::LowPass;
use super::rules::{BATTERY_DEBOUNCE_US, Mode, OVERRUN_DEBOUNCE_US, SATURATION_DEBOUNCE_US, TRACKING_DEBOUNCE_US};
use estimation::estimator::EstimatedState;
use snapshot::Snapshot;
pub(super) use snapshot::is_still;

/// How long after its last impact a landing may stand on the ground: as long as it bounces.
const IMPACT_MEMORY_US: u64 = 3_000_000;

/// How long after the first touchdown each further one stops a vehicle without a pose: so short that vibration alone
/// does not keep its speed at zero.
const TOUCHDOWN_DURATION_MAX_US: u64 = 200_000;

/// How much poses may change the vertical speed of a landing after an impact, beside the accelerometer: an impact is
/// beyond the accelerometer's range, and makes the estimator believe the poses that follow.
const POSE_SPEED_GAIN_MAX_M_PER_S: f32 = 1.0;

/// True poses correct the speed with the next.
const LIED_DEBOUNCE_US: u64 = 50_000;

/// How long a vehicle must seem to stand or lie on the ground.
pub const GROUND_DEBOUNCE_US: u64 = 500_000;

const STANDING_DEBOUNCE_US: u64 = 1_000_000;

/// The upward acceleration that only the ground gives.
const IMPACT_ACCELERATION_MIN_M_PER_S2: f32 = 5.0;

/// The upward acceleration of a touchdown that stops a vehicle within a tick or two, and by when after the first impact
/// it must come: rotors out of balance give impacts for longer before one is so strong.
const TOUCHDOWN_ACCELERATION_MIN_M_PER_S2: f32 = 9.0;
const TOUCHDOWN_AFTER_IMPACT_MAX_US: u64 = 30_000;

const HIT_ACCELERATION_MIN_M_PER_S2: f32 = 10.0;

/// How long after a blow in guided flight a jump of the estimate counts as a crash.
const STRUCK_MEMORY_US: u64 = 3_000_000;

/// How long a vehicle is levelled before it must no longer turn.
const TURNING_DEBOUNCE_US: u64 = 800_000;

const DOUBT_DEBOUNCE_US: u64 = 300_000;

/// The detectors' memory.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Detectors {
    tracking: Debounce,
    saturated: Debounce,
    lying: Debounce,
    standing: Debounce,
    resting: Debounce,
    low: Debounce,
    critical: Debounce,
    late: Debounce,
    doubtful: Debounce,
    turning: Debounce,
    low_pass: LowPass,
    /// When the vehicle was last struck in guided flight, us.
    struck: Option<u64>,
    /// The times of the first and the last impact, and of the first and the last touchdown, us.
    impact: Option<(u64, u64)>,
    touchdown: Option<(u64, u64)>,
    hit: bool,
    lied: Debounce,
    /// The part of the vertical speed that poses had added before the impact, m/s.
    pose_speed: f32,
    /// Whether a low battery has caused a landing: a flight that goes on after it is the pilot's choice.
    low_is_latched: bool,
}

/// The detectors' outputs.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Detected {
    pub tracking_lost: bool,
    pub saturated: bool,
    pub landed: bool,
    /// Whether the ground has stopped the vehicle, and whether it does so in this tick.
    pub touched: bool,
    pub touches: bool,
    /// Whether poses have given a landing, since its impact, a speed that it cannot have.
    pub lied: bool,
    pub crashed: bool,
    pub battery_low: bool,
    pub battery_critical: bool,
    pub overrun: bool,
    pub imu_doubtful: bool,
}

impl Detectors {
    /// At the start of a flight, in ticks of `period` us.
    pub fn new(period: u64) -> Self {
        Self { low_pass: LowPass::new(period), ..Self::default() }
    }

    /// Runs every detector on the last tick's flight.
    pub fn tick(
        &mut self,
        mode: Mode,
        state: Option<&EstimatedState>,
        chain: Option<&Chain>,
        tracking_error_max: f32,
        inputs: &Inputs,
    ) -> Detected {
        let Inputs { now, battery, is_late, .. } = *inputs;
        let flown = chain.and_then(Chain::flown).filter(|_| mode.flies());
        let jumps = state.is_some_and(|state| self.low_pass.jumps_to(state));
        let smoothed = self.low_pass.tick(state);
        let snapshot = Snapshot { mode, state: smoothed.as_ref(), chain, flown };
        let is_blind = mode == Mode::Descending;
        self.note_impacts(&snapshot, state, now);
        let impact = self.impact.is_some();
        let begins = |(first, last): (u64, u64)| last == now && now.saturating_sub(first) < TOUCHDOWN_DURATION_MAX_US;
        let touches = is_blind && self.touchdown.is_some_and(begins);
        let touched = if is_blind { self.touchdown.is_some() } else { impact };
        let is_low = matches!(battery, Battery::Low | Battery::Critical);
        let stands = mode.flies() && chain.is_some_and(Chain::is_standing);
        let left_behind = self.standing.holds_for(snapshot.is_left_behind(), STANDING_DEBOUNCE_US, now);
        let is_misled = mode == Mode::Landing && self.is_misled(impact, &snapshot, state);
        let lied = self.lied.holds_for(is_misled, LIED_DEBOUNCE_US, now);
        let rests = snapshot.is_held_up(impact, self.touchdown.is_some(), self.hit);
        let held_up = self.resting.holds_for(rests, GROUND_DEBOUNCE_US, now);
        let far = snapshot.is_far(tracking_error_max) || snapshot.is_held_down();
        let doubtful =
            self.doubtful.holds_for(snapshot.is_unexpected(self.touchdown.is_some()) && !rests, DOUBT_DEBOUNCE_US, now);
        let turning = self.turning.holds_for(snapshot.turns(), TURNING_DEBOUNCE_US, now);
        let is_thrown = self.is_thrown(&snapshot, state, jumps, now);
        Detected {
            tracking_lost: self.tracking.holds_for(far, TRACKING_DEBOUNCE_US, now) || is_thrown,
            saturated: self.saturated.holds_for(snapshot.is_inexact(), SATURATION_DEBOUNCE_US, now),
            landed: left_behind || held_up || stands,
            touched,
            touches,
            lied,
            crashed: self.lying.holds_for(snapshot.lies(), GROUND_DEBOUNCE_US, now),
            battery_low: self.low.holds_for(is_low, BATTERY_DEBOUNCE_US, now) && !self.low_is_latched,
            battery_critical: self.critical.holds_for(battery == Battery::Critical, BATTERY_DEBOUNCE_US, now),
            imu_doubtful: doubtful || turning,
            overrun: self.late.holds_for(is_late, OVERRUN_DEBOUNCE_US, now),
        }
    }

    /// Remembers impacts: in a landing for [`IMPACT_MEMORY_US`], without a pose to the end.
    fn note_impacts(&mut self, snapshot: &Snapshot, state: Option<&EstimatedState>, now: u64) {
        let (lands, descends) = (snapshot.mode == Mode::Landing, snapshot.mode == Mode::Descending);
        let counts = |(_, last): &(u64, u64)| descends || lands && now.saturating_sub(*last) < IMPACT_MEMORY_US;
        (self.impact, self.touchdown) = (self.impact.filter(counts), self.touchdown.filter(counts));
        let impact = if lands || descends { snapshot.impact_acceleration(state) } else { 0.0 };
        let since = |before: Option<(u64, u64)>| Some((before.map_or(now, |(first, _)| first), now));
        if impact > IMPACT_ACCELERATION_MIN_M_PER_S2 {
            self.impact = since(self.impact);
        }
        let fresh = self.impact.is_some_and(|(first, _)| now.saturating_sub(first) < TOUCHDOWN_AFTER_IMPACT_MAX_US);
        if impact > TOUCHDOWN_ACCELERATION_MIN_M_PER_S2 && (fresh || self.touchdown.is_some()) {
            self.touchdown = since(self.touchdown);
        }
        self.hit = descends && (self.hit || impact > HIT_ACCELERATION_MIN_M_PER_S2);
    }

    /// Whether poses have given a landing after its `impact` a speed that it cannot have: one that they have added, and
    /// that neither a standing nor a descending vehicle has.
    fn is_misled(&mut self, impact: bool, snapshot: &Snapshot, state: Option<&EstimatedState>) -> bool {
        let (Some(state), Some(flown)) = (state, snapshot.flown) else { return false };
        let speed = state.state.velocity.z;
        let pose_speed = speed - state.gained;
        if !impact {
            self.pose_speed = pose_speed;
        }
        let possible = flown.reference.velocity.z - POSE_SPEED_GAIN_MAX_M_PER_S..=POSE_SPEED_GAIN_MAX_M_PER_S;
        (pose_speed - self.pose_speed).abs() > POSE_SPEED_GAIN_MAX_M_PER_S && !possible.contains(&speed)
    }

    /// Whether the estimate jumps just after the vehicle was struck.
    fn is_thrown(&mut self, snapshot: &Snapshot, state: Option<&EstimatedState>, jumps: bool, now: u64) -> bool {
        if snapshot.is_struck(state) {
            self.struck = Some(now);
        }
        let recently = self.struck.is_some_and(|struck| now.saturating_sub(struck) < STRUCK_MEMORY_US);
        snapshot.mode.is_guided() && jumps && recently
    }

    /// Whether there was a touchdown.
    pub fn has_touched(&self) -> bool {
        self.touchdown.is_some()
    }

    /// Latches that a low battery has been acted on.
    pub fn latch_low(&mut self) {
        self.low_is_latched = true;
    }
}

#[cfg(test)]
mod tests;
