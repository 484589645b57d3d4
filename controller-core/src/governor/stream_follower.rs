//! Following a stream of positions, velocities and accelerations as it is sent, where it keeps the bounds.
//!
//! The averages make any command fit, and smooth away what fits already. So where a stream is itself inside the bounds
//! and the head can get onto it without haste, the head is steered directly:
//!
//! ```text
//! Averaged -- a feasible stream, near ----------------------> Direct --.
//!     ^  '--- a feasible stream, never near --> Blending ------^       '--> it ceases, changes kind or is lost
//!     '------------------------ Levelling <------'---------------------------'
//! ```
//!
//! - *Averaged*: the head is the averaged command ([`super::averages`]).
//! - *Blending*: as direct, but onto a point that goes over smoothly from what the averages make of the stream to the
//!   stream itself ([`super::blend`]).
//! - *Direct*: the head's snap is the stream's, with feedback of the head's error, as far as [`super::envelope`] lets
//!   it.
//! - *Levelling*: the envelope's retreat, until there is no acceleration and the last average has seen nothing else.
//!   From there the averages start ([`super::steady`]), as if this steady motion had always been commanded.
//!
//! In every stage the head keeps the bounds, and no change of stage moves it. So the bounds hold across them.
//!
//! How the head is steered onto a point is in `feedback`.

use super::blend::{Blend, Watched};
use super::demand::{FollowingReport, StreamDemand};
use super::envelope::{Envelope, HeadMotion, Retreat};
use super::stream::{Point, StreamTarget};
use crate::math;
use nalgebra::Vector3;

/// The share of each bound that a stream may use, and of a jerk from which there is a retreat.
const FEASIBLE_SHARE: f32 = 0.9995;
const RETREATING_SHARE: f32 = 0.98;

/// Up to this many times the bounds on jerk and snap a stream that is followed counts as within them: both are guesses.
const DERIVATIVE_TOLERANCE_SHARE: f32 = 1.5;

/// The stiffness at the beginning times the averages' span, and the share of it that counts as near.
const JOINING_STIFFNESS_SPANS_MAX: f32 = 2.5;
const JOINING_STIFFNESS_SHARE_MIN: f32 = 0.4;

/// Rotation is followed up to these angles, in the last average's delay and in a tick: beyond, feedback comes too late.
const TURN_WITHIN_DELAY_MAX_RAD: f32 = 0.15;
const TURN_WITHIN_TICK_MAX_RAD: f32 = 0.05;

/// A stream is lost at so many times its distance at the beginning and this share of the acceleration times a span
/// squared; one that the head is blended onto, at the last share alone.
const LOST_DISTANCE_FACTOR: f32 = 1.5;
const LOST_DISTANCE_SHARE: f32 = 0.01;
const BLEND_LOST_DISTANCE_SHARE: f32 = 0.04;

/// What rests: m, m/s and m/s^2.
const REST_TOLERANCES: [f32; 3] = [1e-3, 1e-3, 0.1];

/// Time for the averages to come as near to a stream as they will, and then for watching it before the head is blended
/// onto it.
const SETTLING_SPANS: f32 = 1.5;
const WATCHING_SPANS: f32 = 1.5;

/// How long a stream must be near, and how long the next one waits after one is lost: the first time and at most.
const NEAR_SPANS_MIN: f32 = 0.4;
const RETRY_SPANS: f32 = 1.0;
const RETRY_SPANS_MAX: f32 = 32.0;

/// What the head follows. Tagged, so that averaged is all zeros: [`super::Memory::EMPTY`] counts on it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(u32)]
enum Stage {
    /// With the ticks for which a stream has been near, and how it has moved.
    Averaged { near: u32, watched: Watched },
    /// As direct, with what is followed.
    Blending { stiffness: f32, retreat: Retreat, blend: Blend },
    /// With the retreat at hand, and the distance at which the stream is lost, m.
    Direct { stiffness: f32, retreat: Retreat, lost_at: f32 },
    /// The retreat, with the ticks since it has ended.
    Levelling { retreat: Retreat, still: u32 },
}

impl Stage {
    /// No stream so far.
    const AVERAGED: Self = Self::Averaged { near: 0, watched: Watched::NONE };
}

/// What drives the head in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum HeadDrive {
    /// The averages.
    Averages,
    /// The averages, from now on: started from the steady motion at hand.
    Restarted,
    /// This snap, m/s^2 per tick squared.
    Snap(Vector3<f32>),
}

/// The stages, and what they go by.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StreamFollower {
    envelope: Envelope,
    period: f32,
    /// The averages' span, s.
    span: f32,
    /// The last average, ticks.
    last: u32,
    /// The horizontal bound, m/s^2, and how many times the vertical one that is.
    acceleration: f32,
    vertical_weight: f32,
    /// rad/s.
    turn_rate_max: f32,
    stage: Stage,
    demand: StreamDemand,
    /// Ticks until a stream is followed again, and how many there will be after the next loss.
    retry_in: u32,
    retry_delay: u32,
}

impl StreamFollower {
    /// Not designed yet.
    pub const NONE: Self = Self {
        envelope: Envelope::NONE,
        period: 0.0,
        span: 0.0,
        last: 0,
        acceleration: 0.0,
        vertical_weight: 0.0,
        turn_rate_max: 0.0,
        stage: Stage::AVERAGED,
        demand: StreamDemand::NONE,
        retry_in: 0,
        retry_delay: 0,
    };

    /// Prepares for an envelope of these greatest accelerations, m/s^2, and averages that span so many ticks, the last
    /// of them `last`.
    pub fn design(&mut self, envelope: Envelope, [horizontal, vertical]: [f32; 2], span: u32, last: u32, period: f32) {
        // The last average delays by half of it.
        let turn_rate_max = (2.0 * TURN_WITHIN_DELAY_MAX_RAD / last as f32).min(TURN_WITHIN_TICK_MAX_RAD) / period;
        *self = Self {
            envelope,
            period,
            span: span as f32 * period,
            last,
            acceleration: horizontal,
            vertical_weight: horizontal / vertical,
            turn_rate_max,
            ..Self::NONE
        };
        self.start();
    }

    /// Starts anew, averaged.
    pub fn start(&mut self) {
        self.stage = Stage::AVERAGED;
        self.demand = StreamDemand::NONE;
        self.retry_in = 0;
        self.retry_delay = self.ticks(RETRY_SPANS);
    }

    fn ticks(&self, spans: f32) -> u32 {
        (spans * self.span / self.period) as u32
    }

    /// Whether the averages drive the head.
    pub fn is_averaged(&self) -> bool {
        matches!(self.stage, Stage::Averaged { .. })
    }

    /// Whether the averages' snap counts.
    pub fn is_averaging(&self) -> bool {
        matches!(self.stage, Stage::Averaged { .. } | Stage::Blending { .. })
    }

    /// How a stream is followed, if there is one that moves.
    pub fn following(&self) -> Option<FollowingReport> {
        self.demand.following()
    }

    /// Advances by a tick: with the head, with what a fresh stream is ahead of it by, and with the `snap` that the
    /// averages have for it, in units of `unit` m/s^2 per tick squared.
    pub fn tick(
        &mut self,
        head: &HeadMotion,
        stream: Option<&StreamTarget>,
        averaged: &Vector3<i32>,
        unit: f32,
    ) -> HeadDrive {
        self.retry_in = self.retry_in.saturating_sub(1);
        if stream.is_none() {
            self.demand = StreamDemand::NONE;
        }
        if let (Stage::Averaged { near, .. }, true) = (self.stage, stream.is_some_and(|stream| rests(head, stream))) {
            self.rest(near);
            return HeadDrive::Averages;
        }
        let stream = stream.filter(|stream| self.judge(stream));
        // Where most ticks end: without a copy of the stage.
        if stream.is_none() && self.is_averaged() {
            self.stage = Stage::AVERAGED;
            return HeadDrive::Averages;
        }
        match (self.stage, stream) {
            (Stage::Averaged { near, watched }, Some(stream)) if self.retry_in == 0 => {
                let snap = averaged.map(|units| units as f32 * unit);
                self.averaged(head, stream, &snap, near, &watched)
            }
            (Stage::Averaged { .. }, _) => {
                self.stage = Stage::AVERAGED;
                HeadDrive::Averages
            }
            (Stage::Blending { stiffness, retreat, blend }, Some(stream)) => {
                let snap = averaged.map(|units| units as f32 * unit);
                let target = blend.target(head, stream, &snap, self.period);
                if self.distance(&target) <= self.lost_distance() {
                    self.blend(head, &target, &snap, stiffness, &retreat, &blend)
                } else {
                    self.give_up(head, &retreat)
                }
            }
            (Stage::Direct { stiffness, retreat, lost_at }, Some(stream)) if self.distance(stream) <= lost_at => {
                self.follow(head, stream, stiffness, &retreat, lost_at)
            }
            (Stage::Blending { retreat, .. } | Stage::Direct { retreat, .. }, _) => self.give_up(head, &retreat),
            (Stage::Levelling { retreat, still }, _) => self.level(head, &retreat, still),
        }
    }

    /// At rest at a point that rests: near it, whatever was lost before.
    fn rest(&mut self, near: u32) {
        self.stage = Stage::Averaged { near: near.saturating_add(1), watched: Watched::NONE };
        self.demand = StreamDemand::NONE;
        self.retry_delay = self.ticks(RETRY_SPANS);
    }

    fn averaged(
        &mut self,
        head: &HeadMotion,
        stream: &StreamTarget,
        snap: &Vector3<f32>,
        agreed: u32,
        watched: &Watched,
    ) -> HeadDrive {
        let capacity = self.feedback_capacity(stream);
        let slack = JOINING_STIFFNESS_SPANS_MAX / self.span;
        let stiffness = self.stiffness_within(stream, capacity).min(slack);
        let near = stiffness >= JOINING_STIFFNESS_SHARE_MIN * slack && self.is_near(stream, slack, capacity);
        let retreat = self.envelope.retreat(head).filter(|_| near);
        match retreat {
            Some(retreat) if agreed >= self.ticks(NEAR_SPANS_MIN) => {
                // From rest nothing is to be caught up with.
                let [_, slow, _] = REST_TOLERANCES;
                let (stiffness, lost_at) = if head.velocity.norm_squared() < 4.0 * slow * slow {
                    (self.stiffness_within(stream, capacity), self.lost_distance())
                } else {
                    (
                        stiffness,
                        LOST_DISTANCE_FACTOR * self.distance(stream)
                            + LOST_DISTANCE_SHARE * self.acceleration * self.span * self.span,
                    )
                };
                self.follow(head, stream, stiffness, &retreat, lost_at)
            }
            _ => {
                let near = if retreat.is_some() { agreed + 1 } else { 0 };
                self.watch(head, stream, snap, near, watched)
            }
        }
    }

    /// Goes on with the averages, or begins to blend where a stream has been watched for long enough.
    fn watch(
        &mut self,
        head: &HeadMotion,
        stream: &StreamTarget,
        snap: &Vector3<f32>,
        near: u32,
        watched: &Watched,
    ) -> HeadDrive {
        let StreamTarget { point: Point { velocity, acceleration, jerk, snap: bend, .. }, error } = stream;
        let used = math::max(
            self.envelope.used([acceleration, jerk, bend]),
            math::sqrt(self.envelope.share_of_speed(velocity)),
        );
        let flat = [self.weighted_length(&error.position), self.weighted_length(&error.velocity)];
        let is_settled = watched.ticks >= self.ticks(SETTLING_SPANS);
        let watched = if is_settled { watched.with(error, flat, used) } else { watched.later() };
        if near > 0 || watched.ticks < self.ticks(SETTLING_SPANS + WATCHING_SPANS) {
            self.stage = Stage::Averaged { near, watched };
            return HeadDrive::Averages;
        }
        match (watched.blend(&self.envelope, self.span), self.envelope.retreat(head)) {
            (Some(blend), Some(retreat)) => {
                let target = blend.target(head, stream, snap, self.period);
                self.blend(head, &target, snap, JOINING_STIFFNESS_SPANS_MAX / self.span, &retreat, &blend)
            }
            _ => {
                self.stage = Stage::AVERAGED;
                HeadDrive::Averages
            }
        }
    }

    /// Follows the `target` of a blend.
    fn blend(
        &mut self,
        head: &HeadMotion,
        target: &StreamTarget,
        averaged: &Vector3<f32>,
        stiffness: f32,
        retreat: &Retreat,
        blend: &Blend,
    ) -> HeadDrive {
        let (snap, retreat) = self.envelope.step(head, &self.commanded_snap(target, stiffness), retreat);
        let stiffness = self.next_stiffness(target, stiffness);
        let blend = blend.after(&(averaged - snap), self.period);
        self.stage = if blend.is_over() {
            Stage::Direct { stiffness, retreat, lost_at: self.lost_distance() }
        } else {
            Stage::Blending { stiffness, retreat, blend }
        };
        HeadDrive::Snap(snap)
    }

    fn follow(
        &mut self,
        head: &HeadMotion,
        stream: &StreamTarget,
        stiffness: f32,
        retreat: &Retreat,
        lost_at: f32,
    ) -> HeadDrive {
        let (snap, retreat) = self.envelope.step(head, &self.commanded_snap(stream, stiffness), retreat);
        self.stage = Stage::Direct { stiffness: self.next_stiffness(stream, stiffness), retreat, lost_at };
        HeadDrive::Snap(snap)
    }

    /// Gives up a stream that is lost, and leaves the next alone for longer each time.
    fn give_up(&mut self, head: &HeadMotion, retreat: &Retreat) -> HeadDrive {
        self.retry_in = self.retry_delay;
        self.retry_delay = (2 * self.retry_delay).min(self.ticks(RETRY_SPANS_MAX));
        self.level(head, retreat, 0)
    }

    fn level(&mut self, head: &HeadMotion, retreat: &Retreat, still: u32) -> HeadDrive {
        if still > self.last {
            self.stage = Stage::AVERAGED;
            return HeadDrive::Restarted;
        }
        let (snap, retreat) = self.envelope.follow(head, retreat);
        let moves = [head.acceleration, head.difference, snap].iter().any(|vector| *vector != Vector3::zeros());
        self.stage = Stage::Levelling { retreat, still: if moves { 0 } else { still + 1 } };
        HeadDrive::Snap(snap)
    }

    /// How far off a stream that was blended onto is lost, m.
    fn lost_distance(&self) -> f32 {
        BLEND_LOST_DISTANCE_SHARE * self.acceleration * self.span * self.span
    }

    /// Records the stream's demand; whether it moves, turns slowly enough, keeps the bounds, and leaves a retreat.
    fn judge(&mut self, StreamTarget { point, error }: &StreamTarget) -> bool {
        let Point { velocity, acceleration, jerk, snap, rate, .. } = point;
        let (moves, bends) = (*velocity != Vector3::zeros(), *acceleration != Vector3::zeros());
        if !moves && !bends {
            self.demand = StreamDemand::NONE;
            return false;
        }
        let shares = self.envelope.shares([acceleration, jerk, snap]);
        let turning = rate / self.turn_rate_max;
        let speed = math::max(self.envelope.share_of_speed(velocity), turning * turning);
        let off = math::sqrt(error.position.norm_squared());
        self.demand = self.demand.with(speed, shares, off, self.period);
        if !moves || !bends || rate.abs() > self.turn_rate_max {
            return false;
        }
        let [of_acceleration, of_jerk, of_snap] = shares;
        if matches!(self.stage, Stage::Blending { .. } | Stage::Direct { .. }) {
            // Jerk and snap are guesses from sample to sample, and the envelope has the last word on the head's.
            return of_acceleration <= 1.0
                && of_jerk.max(of_snap) <= DERIVATIVE_TOLERANCE_SHARE * DERIVATIVE_TOLERANCE_SHARE;
        }
        let on = HeadMotion {
            velocity: *velocity,
            acceleration: acceleration / FEASIBLE_SHARE,
            difference: jerk * (self.period / RETREATING_SHARE),
        };
        shares.iter().all(|share| *share <= FEASIBLE_SHARE * FEASIBLE_SHARE) && self.envelope.retreat(&on).is_some()
    }
}

/// Whether the head and the point both rest, at one place.
fn rests(head: &HeadMotion, StreamTarget { point, error }: &StreamTarget) -> bool {
    let [near, slow, steady] = REST_TOLERANCES;
    let within = |vector: &Vector3<f32>, max: f32| vector.norm_squared() < max * max;
    within(&error.position, near)
        && within(&head.velocity, slow)
        && within(&point.velocity, slow)
        && within(&head.acceleration, steady)
        && within(&point.acceleration, steady)
}

mod feedback;
