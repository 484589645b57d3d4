//! Detectors: whether the vehicle follows its reference, has landed, or lies on its back.
//!
//! - *Landed*, with an estimate: the reference has gone on down and the vehicle has not, and stands still, for longer
//!   than a vehicle does that turns round in the air: where wind carries it upwards faster than it may go down, say.
//! - *Landed*, by the IMU alone: something has stopped the vehicle with a jerk, and the law now commands less thrust
//!   than carries it. Or, where the ground was soft, for so little that the vehicle must fall faster, and it does not.
//!   Rotors that deliver 8 % more than commanded would look the same: with the law's thrust scale and force they do
//!   not. So would the air's drag of a vehicle that sinks. What rises or sinks on stands on nothing, and nothing is
//!   believed before it should sink so fast that it shows, unless it has touched something; but a hit is more than an
//!   accelerometer can show, and leaves a false speed.
//! - *The IMU is doubtful*, where nothing else is left: it measures another force than commanded, and not the ground's,
//!   friction's among it, or the vehicle does not come upright, or turns on.
//! - *Crashed*: still, and by 30 degrees or more beside where the law wants it, or tilted by 80, or by 60 while no law
//!   flies it. In the air such a vehicle turns or falls; one that the law tilts holds against a wind.
//! - *Tracking lost*: far from the reference; still, well below it: a vehicle that does not get off the ground; or
//!   thrown out of its place, where its frame seems to move just after it was struck: a crash looks like that.
//!
//! Rotors out of balance vibrate a standing vehicle: its motion and force are therefore [low-passed](super::low_pass).
//! A jerk is over too soon for that.

mod look;

use super::chain::Chain;
use super::debounce::Debounce;
use super::exchange::{Battery, Inputs};
use super::low_pass::LowPass;
use super::rules::{BATTERY_DEBOUNCE, Mode, OVERRUN_DEBOUNCE, SATURATION_DEBOUNCE, TRACKING_DEBOUNCE};
use estimation::estimator::EstimatedState;
use look::Look;
pub(super) use look::is_still;

/// How long after a jerk a landing may have met the ground, and for how long after the first jerk a vehicle without a
/// pose takes each for the ground, us: as long as it bounces, and so short that vibration alone does not stop the
/// summing of its speed.
const TOUCHED_DEBOUNCE: u64 = 3_000_000;
const TOUCHING_DEBOUNCE: u64 = 200_000;

/// What poses may add to the vertical speed of a landing that has met the ground, beside the accelerometer, m/s: its
/// jerk is beyond the accelerometer's range, and teaches the estimator to believe whatever comes next.
const TAUGHT: f32 = 1.0;

/// For how long they do, us: true poses take it back with the next.
const LIED_DEBOUNCE: u64 = 50_000;

/// How long it must look like the ground, us.
pub const GROUND_DEBOUNCE: u64 = 500_000;

/// How long a vehicle stands that has landed, us.
const STANDING_DEBOUNCE: u64 = 1_000_000;

/// The upward acceleration that only the ground gives, m/s^2.
const JERK: f32 = 5.0;

/// The upward acceleration of a touchdown that stops a vehicle within a tick or two, m/s^2, and by when after the first
/// jerk, us: rotors out of balance jerk at it for longer before they make so much of a tick.
const TOUCH: f32 = 9.0;
const JERKING: u64 = 30_000;

/// The upward acceleration of a hit, m/s^2.
const HIT: f32 = 10.0;

/// For how long after a crash no frame's move is believed, us.
const STRUCK_DEBOUNCE: u64 = 3_000_000;

/// For how long a vehicle is levelled before it must not turn, us.
const TURNING_DEBOUNCE: u64 = 800_000;

/// How long the IMU may disagree, us.
const DOUBT_DEBOUNCE: u64 = 300_000;

/// The detectors' memory.
#[derive(Debug, PartialEq)]
pub(super) struct Watch {
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
    /// When something first stopped a vehicle that goes down, us, and when it last did.
    jerked: Option<(u64, u64)>,
    /// The same of a jerk that nothing but the ground gives.
    touched: Option<(u64, u64)>,
    /// Whether it has hit something.
    hit: bool,
    lied: Debounce,
    /// What poses had added to the vertical speed before something stopped it, m/s.
    taught: f32,
    /// Whether a low battery has caused a landing: a flight that goes on after it is the pilot's choice.
    low_is_latched: bool,
}

/// The detectors' outputs.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    pub tracking_lost: bool,
    pub saturated: bool,
    pub landed: bool,
    /// Whether something has stopped a vehicle that goes down, and whether just now.
    pub touched: bool,
    pub touches: bool,
    /// Whether poses have given a landing, since it has met the ground, a speed that it cannot have.
    pub lied: bool,
    pub crashed: bool,
    pub battery_low: bool,
    pub battery_critical: bool,
    pub overrun: bool,
    pub imu_doubtful: bool,
}

impl Watch {
    /// Of nothing so far, in ticks of `period` us.
    pub fn new(period: u64) -> Self {
        Self {
            tracking: Debounce::default(),
            saturated: Debounce::default(),
            lying: Debounce::default(),
            standing: Debounce::default(),
            resting: Debounce::default(),
            low: Debounce::default(),
            critical: Debounce::default(),
            late: Debounce::default(),
            doubtful: Debounce::default(),
            turning: Debounce::default(),
            low_pass: LowPass::new(period),
            struck: None,
            jerked: None,
            touched: None,
            hit: false,
            lied: Debounce::default(),
            taught: 0.0,
            low_is_latched: false,
        }
    }

    /// Runs every detector on the last tick.
    pub fn tick(
        &mut self,
        mode: Mode,
        state: Option<&EstimatedState>,
        chain: Option<&Chain>,
        tracking_error_max: f32,
        inputs: &Inputs,
    ) -> Seen {
        let Inputs { now, battery, is_late, .. } = *inputs;
        let flown = chain.and_then(Chain::flown).filter(|_| mode.flies());
        let jumps = state.is_some_and(|state| self.low_pass.jumps_to(state));
        let smoothed = self.low_pass.tick(state);
        let look = Look { mode, state: smoothed.as_ref(), chain, flown };
        let is_blind = mode == Mode::Descending;
        self.note_jerks(&look, state, now);
        let jerked = self.jerked.is_some();
        let begins = |(first, last): (u64, u64)| last == now && now.saturating_sub(first) < TOUCHING_DEBOUNCE;
        let touches = is_blind && self.touched.is_some_and(begins);
        let touched = if is_blind { self.touched.is_some() } else { jerked };
        let is_low = matches!(battery, Battery::Low | Battery::Critical);
        let stands = mode.flies() && chain.is_some_and(Chain::is_standing);
        let left_behind = self.standing.holds_for(look.is_left_behind(), STANDING_DEBOUNCE, now);
        let is_taught = mode == Mode::Landing && self.is_taught(jerked, &look, state);
        let lied = self.lied.holds_for(is_taught, LIED_DEBOUNCE, now);
        let rests = look.is_held_up(jerked, self.touched.is_some(), self.hit);
        let held_up = self.resting.holds_for(rests, GROUND_DEBOUNCE, now);
        let far = look.is_far(tracking_error_max) || look.is_held_down();
        let doubtful =
            self.doubtful.holds_for(look.is_unexpected(self.touched.is_some()) && !rests, DOUBT_DEBOUNCE, now);
        let turning = self.turning.holds_for(look.turns(), TURNING_DEBOUNCE, now);
        let is_thrown = self.is_thrown(&look, state, jumps, now);
        Seen {
            tracking_lost: self.tracking.holds_for(far, TRACKING_DEBOUNCE, now) || is_thrown,
            saturated: self.saturated.holds_for(look.is_inexact(), SATURATION_DEBOUNCE, now),
            landed: left_behind || held_up || stands,
            touched,
            touches,
            lied,
            crashed: self.lying.holds_for(look.lies(), GROUND_DEBOUNCE, now),
            battery_low: self.low.holds_for(is_low, BATTERY_DEBOUNCE, now) && !self.low_is_latched,
            battery_critical: self.critical.holds_for(battery == Battery::Critical, BATTERY_DEBOUNCE, now),
            imu_doubtful: doubtful || turning,
            overrun: self.late.holds_for(is_late, OVERRUN_DEBOUNCE, now),
        }
    }

    /// Remembers what stops a vehicle that goes down: in a landing for as long as it may have met the ground, without a
    /// pose, where that is not revised later, to the end.
    fn note_jerks(&mut self, look: &Look, state: Option<&EstimatedState>, now: u64) {
        let (lands, descends) = (look.mode == Mode::Landing, look.mode == Mode::Descending);
        let counts = |(_, last): &(u64, u64)| descends || lands && now.saturating_sub(*last) < TOUCHED_DEBOUNCE;
        (self.jerked, self.touched) = (self.jerked.filter(counts), self.touched.filter(counts));
        let jerk = if lands || descends { look.jerk(state) } else { 0.0 };
        let since = |before: Option<(u64, u64)>| Some((before.map_or(now, |(first, _)| first), now));
        if jerk > JERK {
            self.jerked = since(self.jerked);
        }
        let fresh = self.jerked.is_some_and(|(first, _)| now.saturating_sub(first) < JERKING);
        if jerk > TOUCH && (fresh || self.touched.is_some()) {
            self.touched = since(self.touched);
        }
        self.hit = descends && (self.hit || jerk > HIT);
    }

    /// Whether poses have given a landing that was `jerked` a speed that it cannot have: one that they have added, and
    /// that neither a standing nor a descending vehicle has.
    fn is_taught(&mut self, jerked: bool, look: &Look, state: Option<&EstimatedState>) -> bool {
        let (Some(state), Some(flown)) = (state, look.flown) else { return false };
        let speed = state.state.velocity.z;
        let taught = speed - state.gained;
        if !jerked {
            self.taught = taught;
        }
        let possible = flown.reference.velocity.z - TAUGHT..=TAUGHT;
        (taught - self.taught).abs() > TAUGHT && !possible.contains(&speed)
    }

    /// Whether the estimate jumps just after the vehicle was struck.
    fn is_thrown(&mut self, look: &Look, state: Option<&EstimatedState>, jumps: bool, now: u64) -> bool {
        if look.is_struck(state) {
            self.struck = Some(now);
        }
        let recently = self.struck.is_some_and(|struck| now.saturating_sub(struck) < STRUCK_DEBOUNCE);
        look.mode.is_guided() && jumps && recently
    }

    /// Whether a vehicle that goes down has met with a jerk that nothing but the ground gives.
    pub fn has_touched(&self) -> bool {
        self.touched.is_some()
    }

    /// Latches that a low battery has been acted on.
    pub fn latch_low(&mut self) {
        self.low_is_latched = true;
    }
}

#[cfg(test)]
mod tests;
