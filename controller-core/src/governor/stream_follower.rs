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
//! - *Levelling*: the envelope's way out, until there is no acceleration and the last average has seen nothing else.
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

/// The share of each bound that a stream may use, and of a jerk from which there is a way out.
const FEASIBLE_SHARE: f32 = 0.9995;
const RETREATING_SHARE: f32 = 0.98;

/// The share of the bounds on jerk and snap up to which a stream that is followed is believed to keep them.
const DERIVATIVE_TOLERANCE_SHARE: f32 = 1.5;

/// The stiffness times the averages' span at the beginning, at most; and the share of it for which a stream is near
/// enough.
const JOINING_STIFFNESS_SPANS_MAX: f32 = 2.5;
const JOINING_STIFFNESS_SHARE_MIN: f32 = 0.4;

/// Turning is followed up to so many radians in the last average's delay, and in a tick: beyond, feedback comes too
/// late.
const TURN_WITHIN_DELAY_MAX_RAD: f32 = 0.15;
const TURN_WITHIN_TICK_MAX_RAD: f32 = 0.05;

/// A stream is lost this much farther off than at the beginning, and so far in spans squared of the greatest
/// acceleration; one that the head is blended onto so far.
const LOST_DISTANCE_FACTOR: f32 = 1.5;
const LOST_DISTANCE_SHARE: f32 = 0.01;
const BLEND_LOST_DISTANCE_SHARE: f32 = 0.04;

/// What rests: within so many m, m/s and m/s^2.
const REST_TOLERANCES: [f32; 3] = [1e-3, 1e-3, 0.1];

/// Spans that the averages are given to come as near to a stream as they will, and for which it is then watched before
/// the head is blended onto it.
const SETTLING_SPANS: f32 = 1.5;
const WATCHING_SPANS: f32 = 1.5;

/// Spans that a stream must be near for, and that a lost one is left alone for, the first time and at most.
const NEAR_SPANS_MIN: f32 = 0.4;
const RETRY_SPANS: f32 = 1.0;
const RETRY_SPANS_MAX: f32 = 32.0;

/// What the head is driven by.
/// Tagged, so that averaged at the beginning is all zeros: [`super::Memory::EMPTY`] counts on it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(u32)]
enum Stage {
    /// With the ticks for which a stream has been near, and how it has moved.
    Averaged { near: u32, watched: Watched },
    /// As direct, with what is followed.
    Blending { stiffness: f32, out: Retreat, blend: Blend },
    /// With the way out in hand, and how far off the stream is lost, m.
    Direct { stiffness: f32, out: Retreat, far: f32 },
    /// The way out, with the ticks since it has ended.
    Levelling { out: Retreat, still: u32 },
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
    /// The greatest horizontal acceleration, m/s^2, and how many times the greatest vertical one that is.
    acceleration: f32,
    flatness: f32,
    /// The greatest rate of turning, rad/s.
    fastest: f32,
    stage: Stage,
    demand: StreamDemand,
    /// Ticks for which no stream is followed, and how many there will be the next time.
    barred: u32,
    next: u32,
}

impl StreamFollower {
    /// Not designed yet.
    pub const NONE: Self = Self {
        envelope: Envelope::NONE,
        period: 0.0,
        span: 0.0,
        last: 0,
        acceleration: 0.0,
        flatness: 0.0,
        fastest: 0.0,
        stage: Stage::AVERAGED,
        demand: StreamDemand::NONE,
        barred: 0,
        next: 0,
    };

    /// Prepares for an envelope of these greatest accelerations, m/s^2, and averages that span so many ticks, the last
    /// of them `last`.
    pub fn design(&mut self, envelope: Envelope, [horizontal, vertical]: [f32; 2], span: u32, last: u32, period: f32) {
        // The last average delays by half of it.
        let fastest = (2.0 * TURN_WITHIN_DELAY_MAX_RAD / last as f32).min(TURN_WITHIN_TICK_MAX_RAD) / period;
        *self = Self {
            envelope,
            period,
            span: span as f32 * period,
            last,
            acceleration: horizontal,
            flatness: horizontal / vertical,
            fastest,
            ..Self::NONE
        };
        self.start();
    }

    /// Starts anew, averaged.
    pub fn start(&mut self) {
        self.stage = Stage::AVERAGED;
        self.demand = StreamDemand::NONE;
        self.barred = 0;
        self.next = self.ticks(RETRY_SPANS);
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
        sought: Option<&StreamTarget>,
        averaged: &Vector3<i32>,
        unit: f32,
    ) -> HeadDrive {
        self.barred = self.barred.saturating_sub(1);
        if sought.is_none() {
            self.demand = StreamDemand::NONE;
        }
        if let (Stage::Averaged { near, .. }, true) = (self.stage, sought.is_some_and(|sought| rests(head, sought))) {
            self.rest(near);
            return HeadDrive::Averages;
        }
        let sought = sought.filter(|sought| self.judge(sought));
        if sought.is_none() && self.is_averaged() {
            self.stage = Stage::AVERAGED;
            return HeadDrive::Averages;
        }
        match (self.stage, sought) {
            (Stage::Averaged { near, watched }, Some(sought)) if self.barred == 0 => {
                let snap = averaged.map(|units| units as f32 * unit);
                self.averaged(head, sought, &snap, near, &watched)
            }
            (Stage::Averaged { .. }, _) => {
                self.stage = Stage::AVERAGED;
                HeadDrive::Averages
            }
            (Stage::Blending { stiffness, out, blend }, Some(sought)) => {
                let snap = averaged.map(|units| units as f32 * unit);
                let target = blend.target(head, sought, &snap, self.period);
                if self.distance(&target) <= self.lost_distance() {
                    self.blend(head, &target, &snap, stiffness, &out, &blend)
                } else {
                    self.give_up(head, &out)
                }
            }
            (Stage::Direct { stiffness, out, far }, Some(sought)) if self.distance(sought) <= far => {
                self.follow(head, sought, stiffness, &out, far)
            }
            (Stage::Blending { out, .. } | Stage::Direct { out, .. }, _) => self.give_up(head, &out),
            (Stage::Levelling { out, still }, _) => self.level(head, &out, still),
        }
    }

    /// At rest at a point that rests: near it, whatever was lost before.
    fn rest(&mut self, near: u32) {
        self.stage = Stage::Averaged { near: near.saturating_add(1), watched: Watched::NONE };
        self.demand = StreamDemand::NONE;
        self.next = self.ticks(RETRY_SPANS);
    }

    fn averaged(
        &mut self,
        head: &HeadMotion,
        sought: &StreamTarget,
        snap: &Vector3<f32>,
        agreed: u32,
        watched: &Watched,
    ) -> HeadDrive {
        let room = self.feedback_capacity(sought);
        let slack = JOINING_STIFFNESS_SPANS_MAX / self.span;
        let stiffness = self.stiffness_within(sought, room).min(slack);
        let near = stiffness >= JOINING_STIFFNESS_SHARE_MIN * slack && self.is_near(sought, slack, room);
        let out = self.envelope.retreat(head).filter(|_| near);
        match out {
            Some(out) if agreed >= self.ticks(NEAR_SPANS_MIN) => {
                // From rest nothing is to be caught up with.
                let [_, slow, _] = REST_TOLERANCES;
                let (stiffness, far) = if head.velocity.norm_squared() < 4.0 * slow * slow {
                    (self.stiffness_within(sought, room), self.lost_distance())
                } else {
                    (
                        stiffness,
                        LOST_DISTANCE_FACTOR * self.distance(sought)
                            + LOST_DISTANCE_SHARE * self.acceleration * self.span * self.span,
                    )
                };
                self.follow(head, sought, stiffness, &out, far)
            }
            _ => {
                let near = if out.is_some() { agreed + 1 } else { 0 };
                self.watch(head, sought, snap, near, watched)
            }
        }
    }

    /// Goes on with the averages, or begins to blend where a stream has been watched for long enough.
    fn watch(
        &mut self,
        head: &HeadMotion,
        sought: &StreamTarget,
        snap: &Vector3<f32>,
        near: u32,
        watched: &Watched,
    ) -> HeadDrive {
        let StreamTarget { point: Point { velocity, acceleration, jerk, snap: bend, .. }, error } = sought;
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
            (Some(blend), Some(out)) => {
                let target = blend.target(head, sought, snap, self.period);
                self.blend(head, &target, snap, JOINING_STIFFNESS_SPANS_MAX / self.span, &out, &blend)
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
        out: &Retreat,
        blend: &Blend,
    ) -> HeadDrive {
        let (snap, out) = self.envelope.step(head, &self.commanded_snap(target, stiffness), out);
        let stiffness = self.next_stiffness(target, stiffness);
        let blend = blend.after(&(averaged - snap), self.period);
        self.stage = if blend.is_over() {
            Stage::Direct { stiffness, out, far: self.lost_distance() }
        } else {
            Stage::Blending { stiffness, out, blend }
        };
        HeadDrive::Snap(snap)
    }

    fn follow(
        &mut self,
        head: &HeadMotion,
        sought: &StreamTarget,
        stiffness: f32,
        out: &Retreat,
        far: f32,
    ) -> HeadDrive {
        let (snap, out) = self.envelope.step(head, &self.commanded_snap(sought, stiffness), out);
        self.stage = Stage::Direct { stiffness: self.next_stiffness(sought, stiffness), out, far };
        HeadDrive::Snap(snap)
    }

    /// Gives up a stream that is lost, and leaves the next alone for longer each time.
    fn give_up(&mut self, head: &HeadMotion, out: &Retreat) -> HeadDrive {
        self.barred = self.next;
        self.next = (2 * self.next).min(self.ticks(RETRY_SPANS_MAX));
        self.level(head, out, 0)
    }

    fn level(&mut self, head: &HeadMotion, out: &Retreat, still: u32) -> HeadDrive {
        if still > self.last {
            self.stage = Stage::AVERAGED;
            return HeadDrive::Restarted;
        }
        let (snap, out) = self.envelope.follow(head, out);
        let moves = [head.acceleration, head.difference, snap].iter().any(|vector| *vector != Vector3::zeros());
        self.stage = Stage::Levelling { out, still: if moves { 0 } else { still + 1 } };
        HeadDrive::Snap(snap)
    }

    /// How far off a stream that was blended onto is lost, m.
    fn lost_distance(&self) -> f32 {
        BLEND_LOST_DISTANCE_SHARE * self.acceleration * self.span * self.span
    }

    /// Takes down what a stream asks; whether it moves, not round too fast, keeps the bounds, and leaves a way out.
    fn judge(&mut self, StreamTarget { point, error }: &StreamTarget) -> bool {
        let Point { velocity, acceleration, jerk, snap, rate, .. } = point;
        let (moves, bends) = (*velocity != Vector3::zeros(), *acceleration != Vector3::zeros());
        if !moves && !bends {
            self.demand = StreamDemand::NONE;
            return false;
        }
        let shares = self.envelope.shares([acceleration, jerk, snap]);
        let turning = rate / self.fastest;
        let speed = math::max(self.envelope.share_of_speed(velocity), turning * turning);
        let off = math::sqrt(error.position.norm_squared());
        self.demand = self.demand.with(speed, shares, off, self.period);
        if !moves || !bends || rate.abs() > self.fastest {
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
    let within = |vector: &Vector3<f32>, most: f32| vector.norm_squared() < most * most;
    within(&error.position, near)
        && within(&head.velocity, slow)
        && within(&point.velocity, slow)
        && within(&head.acceleration, steady)
        && within(&point.acceleration, steady)
}

mod feedback;
