//! Following a stream of positions, velocities and accelerations as it is sent, where it keeps the bounds.
//!
//! The averages make any command fit, and smooth away what fits already. So once they have brought the reference close to a
//! stream that is itself inside the bounds, the head is steered onto it directly:
//!
//! ```text
//! Averaged -- close to a feasible stream --> Direct -- stream ceases, changes kind or is lost --> Levelling --> Averaged
//! ```
//!
//! - *Averaged*: the head is the averaged command ([`super::averages`]).
//! - *Direct*: the head's snap is the stream's plus feedback of what it is off by, as far as [`super::envelope`] lets it.
//! - *Levelling*: the envelope's way out, until jerk is zero and the last average has seen nothing else. What is left is a steady
//!   acceleration inside the bounds; the averages start from there ([`super::steady`]), as if it had always been commanded.
//!
//! In every stage the head stays inside the bounds, and no change of stage moves it. So the bounds hold across them.
//!
//! Feedback: with e the stream less the head, and J the quarter turn by which a stream at rate w turns, e'''' = -(4 m e''' + 6 m^2 e'' +
//! 4 m^3 e' + m^4 e) with m = l - w J (m = l along the vertical): (d/dt - w J + l)^4 e = 0. An error that turns with the stream,
//! as that of averages does, shrinks without changing direction, and asks for no acceleration but its own. The stiffness l begins at
//! what the error allows, and grows.

use super::envelope::{Envelope, WayOut};
use super::stream::{Point, quarter};
use crate::math;
use nalgebra::Vector3;

/// The share of each bound that a stream may use.
const FEASIBLE: f32 = 0.9995;

/// The share of the room left that feedback may ask for, the least room, and the share of the acceleration at which a stream is lost.
const FEEDBACK: f32 = 0.25;
const LEAST_ROOM: f32 = 0.01;

/// The stiffness, over the rate of a turning stream, at which an error that turns with it asks for no more than it leaves.
const TURNING: f32 = 0.8;
const LOST: f32 = 0.5;

/// The stiffness, over the averages' span: at the beginning at most, in the end, and its growth, l' = growth l^2.
const SLACK: f32 = 2.5;
const STIFF: f32 = 9.0;
const GROWTH: f32 = 0.12;

/// Spans that a stream must agree for, and that a lost one is left alone for, the first time and at most.
const AGREEING: f32 = 0.25;
const BARRED: f32 = 1.0;
const BARRED_LONGEST: f32 = 32.0;

/// What the head is driven by.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Averaged {
        /// Ticks for which a stream has agreed.
        agreed: u32,
    },
    Direct {
        stiffness: f32,
        out: WayOut,
    },
    Levelling {
        out: WayOut,
        /// Ticks without jerk, once there is next to no acceleration.
        still: u32,
    },
}

/// What drives the head in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Drive {
    /// The averages.
    Averages,
    /// The averages, from now on: started from the steady acceleration at hand.
    Restarted,
    /// This snap, m/s^2 per tick squared.
    Snap(Vector3<f32>),
}

/// The head at hand, in m/s^2 and ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moving {
    pub acceleration: Vector3<f32>,
    pub difference: Vector3<f32>,
}

/// The three stages.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Direct {
    envelope: Envelope,
    period: f32,
    /// The averages' span, s.
    span: f32,
    /// The last average, ticks.
    last: u32,
    /// The greatest horizontal acceleration, m/s^2.
    acceleration: f32,
    stage: Stage,
    /// Ticks for which no stream is followed, and how many there will be the next time.
    barred: u32,
    next: u32,
}

impl Direct {
    /// Not designed yet.
    pub const NONE: Self = Self {
        envelope: Envelope::NONE,
        period: 0.0,
        span: 0.0,
        last: 0,
        acceleration: 0.0,
        stage: Stage::Averaged { agreed: 0 },
        barred: 0,
        next: 0,
    };

    /// Prepares for an envelope whose greatest horizontal acceleration is given, and averages that span `span` seconds, the last of
    /// them `last` ticks.
    pub fn design(&mut self, envelope: Envelope, acceleration: f32, span: f32, last: u32, period: f32) {
        *self = Self { envelope, acceleration, span, last, period, ..Self::NONE };
        self.start();
    }

    /// Starts anew, averaged.
    pub fn start(&mut self) {
        self.stage = Stage::Averaged { agreed: 0 };
        self.barred = 0;
        self.next = self.ticks(BARRED);
    }

    fn ticks(&self, spans: f32) -> u32 {
        (spans * self.span / self.period) as u32
    }

    /// Whether the averages drive the head.
    pub fn is_averaged(&self) -> bool {
        matches!(self.stage, Stage::Averaged { .. })
    }

    /// Advances by a tick: with the head, and with what a fresh stream is ahead of it by.
    pub fn tick(&mut self, head: &Moving, sought: Option<&Sought>) -> Drive {
        self.barred = self.barred.saturating_sub(1);
        match self.stage {
            Stage::Averaged { agreed } => self.averaged(head, sought, agreed),
            Stage::Direct { stiffness, out } => match sought.filter(|sought| self.follows(sought)) {
                Some(sought) => self.follow(head, sought, stiffness, &out),
                None => self.level(head, out, 0),
            },
            Stage::Levelling { out, still } => self.level(head, out, still),
        }
    }

    fn averaged(&mut self, head: &Moving, sought: Option<&Sought>, agreed: u32) -> Drive {
        self.stage = Stage::Averaged { agreed: 0 };
        let Some(sought) = sought.filter(|sought| self.barred == 0 && self.follows(sought)) else {
            return Drive::Averages;
        };
        let Moving { acceleration: a, difference: d } = head;
        let stiffness = self.affordable(sought, self.room(sought)).min(SLACK / self.span);
        let near = self.is_near(sought, stiffness);
        let Some(out) = self.envelope.way_out(a, d).filter(|_| near) else {
            return Drive::Averages;
        };
        if agreed < self.ticks(AGREEING) {
            self.stage = Stage::Averaged { agreed: agreed + 1 };
            return Drive::Averages;
        }
        self.follow(head, sought, stiffness, &out)
    }

    fn follow(&mut self, head: &Moving, sought: &Sought, stiffness: f32, out: &WayOut) -> Drive {
        let wanted = self.wanted(sought, stiffness);
        let (snap, out) = self.envelope.step(&head.acceleration, &head.difference, &wanted, out);
        let grown = stiffness + GROWTH * stiffness * stiffness * self.period;
        let stiffness = grown.min(self.affordable(sought, self.room(sought)));
        self.stage = Stage::Direct { stiffness, out };
        Drive::Snap(snap)
    }

    fn level(&mut self, head: &Moving, out: WayOut, still: u32) -> Drive {
        if self.is_direct() {
            self.barred = self.next;
            self.next = (2 * self.next).min(self.ticks(BARRED_LONGEST));
        }
        let Moving { acceleration: a, difference: d } = head;
        let still = if *d == Vector3::zeros() && (still > 0 || self.envelope.is_level(a)) { still + 1 } else { 0 };
        if still > self.last {
            self.stage = Stage::Averaged { agreed: 0 };
            return Drive::Restarted;
        }
        let (snap, out) = if still > 0 { (*d, out) } else { self.envelope.step(a, d, &self.envelope.levelling(a, d), &out) };
        self.stage = Stage::Levelling { out, still };
        Drive::Snap(snap)
    }

    fn is_direct(&self) -> bool {
        matches!(self.stage, Stage::Direct { .. })
    }

    /// Whether a stream moves, keeps the bounds and is near.
    fn follows(&self, sought: &Sought) -> bool {
        let Point { velocity, acceleration, jerk, snap, .. } = &sought.point;
        let (t, far) = (self.period, LOST * self.acceleration * self.span * self.span / (SLACK * SLACK));
        let moves = *velocity != Vector3::zeros() && *acceleration != Vector3::zeros();
        let jerk = jerk * (t / FEASIBLE);
        moves
            && self.envelope.holds(&(acceleration / FEASIBLE))
            && self.envelope.allows_difference(&jerk)
            && self.envelope.allows(&(snap * (t * t / FEASIBLE)))
            && sought.error.position.norm_squared() <= far * far
    }

    /// How much acceleration is left for feedback, m/s^2: a share of what a stream leaves that is off by an error which turns with it.
    fn room(&self, sought: &Sought) -> f32 {
        let Point { acceleration, jerk, snap, rate, .. } = &sought.point;
        let turned = |y: Vector3<f32>| quarter(&y) * *rate;
        let twice = turned(turned(sought.error.position));
        let t = self.period;
        let used = self.envelope.used(&(acceleration - twice), &((jerk - turned(twice)) * t), &((snap - turned(turned(twice))) * (t * t)));
        FEEDBACK * self.acceleration * math::between(1.0 - used, LEAST_ROOM, 1.0)
    }

    /// The stiffness whose answer to the error is within the room.
    fn affordable(&self, sought: &Sought, room: f32) -> f32 {
        let off = math::sqrt(sought.error.position.norm_squared());
        let stiff = (STIFF / self.span).min(STIFFEST / self.period);
        let turning = TURNING * sought.point.rate.abs();
        if off * stiff * stiff <= room { stiff } else { math::sqrt(room / off).max(turning).min(stiff) }
    }

    /// Whether the error turns with the stream, nearly: whether what else it does is answered within the room.
    fn is_near(&self, sought: &Sought, stiffness: f32) -> bool {
        let Point { position, velocity, acceleration, .. } = &sought.error;
        let turned = |y: &Vector3<f32>| quarter(y) * sought.point.rate;
        let drift = velocity - turned(position);
        let bend = acceleration - turned(velocity) - turned(&drift);
        let room = self.room(sought);
        2.0 * stiffness * math::sqrt(drift.norm_squared()) <= room && math::sqrt(bend.norm_squared()) <= room
    }

    /// The stream's snap and the feedback, m/s^2 per tick squared.
    fn wanted(&self, sought: &Sought, stiffness: f32) -> Vector3<f32> {
        let Point { position, velocity, acceleration, jerk, .. } = &sought.error;
        let rate = sought.point.rate;
        // m y.
        let m = |y: Vector3<f32>| y * stiffness - quarter(&y) * rate;
        let feedback = m(m(m(m(*position) + velocity * 4.0) + acceleration * 6.0) + jerk * 4.0);
        (sought.point.snap + feedback) * (self.period * self.period)
    }
}

/// The stiffest feedback, per tick.
const STIFFEST: f32 = 0.2;

/// A stream, and what it is ahead of the head by; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sought {
    pub point: Point,
    pub error: Point,
}
