//! Following a stream of positions, velocities and accelerations as it is sent, where it keeps the bounds.
//!
//! The averages make any command fit, and smooth away what fits already. So where a stream is itself inside the bounds
//! and the head can get onto it without haste, the head is steered directly:
//!
//! ```text
//! Averaged -- a feasible stream, near --> Direct -- it ceases, changes kind or is lost --> Levelling --> Averaged
//! ```
//!
//! - *Averaged*: the head is the averaged command ([`super::averages`]).
//! - *Direct*: the head's snap is the stream's, with feedback of the head's error, as far as [`super::envelope`] lets
//!   it.
//! - *Levelling*: the envelope's way out, until there is no acceleration and the last average has seen nothing else.
//!   From there the averages start ([`super::steady`]), as if this steady motion had always been commanded.
//!
//! In every stage the head keeps the bounds, and no change of stage moves it. So the bounds hold across them.
//!
//! Feedback: with e the stream less the head, l the stiffness and J the quarter turn by which a stream at rate w turns,
//!
//! e'''' = -(4 m e''' + 6 m^2 e'' + 4 m^3 e' + m^4 e),  m = l - w J  (m = l along the vertical),
//!
//! which is (d/dt - w J + l)^4 e = 0: an error that turns with the stream, as that of averages does, or of a head at
//! rest in the middle of a circle, shrinks without changing direction, and needs next to no acceleration of its own. l
//! begins at what the error allows, and grows as it shrinks.

use super::envelope::{Envelope, Moving, WayOut};
use super::stream::{Point, quarter};
use crate::math;
use nalgebra::Vector3;

/// The share of each bound that a stream may use, and of a jerk from which there is a way out.
const FEASIBLE: f32 = 0.9995;
const RETREATING: f32 = 0.98;

/// The share of the bounds, less the stream's part, that feedback may command, and the least that is counted on.
const FEEDBACK: f32 = 0.25;
const LEAST_LEFT: f32 = 0.01;

/// The stiffness times the averages' span: at the beginning at most, and in the end; per tick at most; and its growth,
/// l' = growth l^2.
const SLACK: f32 = 2.5;
const STIFF: f32 = 9.0;
const SLACKEST: f32 = 0.4;
const STIFFEST: f32 = 0.2;
const GROWTH: f32 = 0.12;

/// The stiffness, over the rate of a turning stream, at which an error that turns with it needs no more than it leaves.
const TURNING: f32 = 0.8;

/// Turning is followed up to so many radians in the last average's delay, and in a tick: beyond, feedback comes too
/// late.
const DELAYED: f32 = 0.15;
const SAMPLED: f32 = 0.05;

/// A stream is lost this much farther off than at the beginning, and so far in spans squared of the greatest
/// acceleration.
const FARTHER: f32 = 1.5;
const FAR: f32 = 0.01;

/// Spans that a stream must be near for, and that a lost one is left alone for, the first time and at most.
const AGREEING: f32 = 0.4;
const BARRED: f32 = 1.0;
const BARRED_LONGEST: f32 = 32.0;

/// What the head is driven by.
/// Tagged, so that averaged at the beginning is all zeros: [`super::Memory::EMPTY`] counts on it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(u32)]
enum Stage {
    /// With the ticks for which a stream has been near.
    Averaged { near: u32 },
    /// With the way out in hand, and how far off the stream is lost, m.
    Direct { stiffness: f32, out: WayOut, far: f32 },
    /// The way out, with the ticks since it has ended.
    Levelling { out: WayOut, still: u32 },
}

/// What drives the head in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Drive {
    /// The averages.
    Averages,
    /// The averages, from now on: started from the steady motion at hand.
    Restarted,
    /// This snap, m/s^2 per tick squared.
    Snap(Vector3<f32>),
}

/// A stream, and what it is ahead of the head by; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sought {
    pub point: Point,
    pub error: Point,
}

/// The stages, and what they go by.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Direct {
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
        flatness: 0.0,
        fastest: 0.0,
        stage: Stage::Averaged { near: 0 },
        barred: 0,
        next: 0,
    };

    /// Prepares for an envelope of these greatest accelerations, m/s^2, and averages that span so many ticks, the last
    /// of them `last`.
    pub fn design(&mut self, envelope: Envelope, [horizontal, vertical]: [f32; 2], span: u32, last: u32, period: f32) {
        // The last average delays by half of it.
        let fastest = (2.0 * DELAYED / last as f32).min(SAMPLED) / period;
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
        self.stage = Stage::Averaged { near: 0 };
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
        let sought = sought.filter(|sought| self.is_feasible(&sought.point));
        match (self.stage, sought) {
            (Stage::Averaged { near }, Some(sought)) if self.barred == 0 => self.averaged(head, sought, near),
            (Stage::Averaged { .. }, _) => {
                self.stage = Stage::Averaged { near: 0 };
                Drive::Averages
            }
            (Stage::Direct { stiffness, out, far }, Some(sought)) if self.off(sought) <= far => {
                self.follow(head, sought, stiffness, &out, far)
            }
            (Stage::Direct { out, .. }, _) => {
                self.barred = self.next;
                self.next = (2 * self.next).min(self.ticks(BARRED_LONGEST));
                self.level(head, &out, 0)
            }
            (Stage::Levelling { out, still }, _) => self.level(head, &out, still),
        }
    }

    fn averaged(&mut self, head: &Moving, sought: &Sought, agreed: u32) -> Drive {
        let room = self.room(sought);
        let slack = SLACK / self.span;
        let stiffness = self.affordable(sought, room).min(slack);
        let near = stiffness >= SLACKEST * slack && self.is_near(sought, slack, room);
        let out = self.envelope.way_out(head).filter(|_| near);
        match out {
            Some(out) if agreed >= self.ticks(AGREEING) => {
                let far = FARTHER * self.off(sought) + FAR * self.acceleration * self.span * self.span;
                self.follow(head, sought, stiffness, &out, far)
            }
            _ => {
                self.stage = Stage::Averaged { near: if out.is_some() { agreed + 1 } else { 0 } };
                Drive::Averages
            }
        }
    }

    fn follow(&mut self, head: &Moving, sought: &Sought, stiffness: f32, out: &WayOut, far: f32) -> Drive {
        let (snap, out) = self.envelope.step(head, &self.wanted(sought, stiffness), out);
        let grown = stiffness + GROWTH * stiffness * stiffness * self.period;
        let stiffness = grown.min(self.affordable(sought, self.room(sought)));
        self.stage = Stage::Direct { stiffness, out, far };
        Drive::Snap(snap)
    }

    fn level(&mut self, head: &Moving, out: &WayOut, still: u32) -> Drive {
        if still > self.last {
            self.stage = Stage::Averaged { near: 0 };
            return Drive::Restarted;
        }
        let (snap, out) = self.envelope.follow(head, out);
        let moves = [head.acceleration, head.difference, snap].iter().any(|vector| *vector != Vector3::zeros());
        self.stage = Stage::Levelling { out, still: if moves { 0 } else { still + 1 } };
        Drive::Snap(snap)
    }

    /// Whether a stream moves, not round too fast, keeps the bounds, and leaves a way out.
    fn is_feasible(&self, point: &Point) -> bool {
        let Point { velocity, acceleration, jerk, snap, rate, .. } = point;
        let moves = *velocity != Vector3::zeros() && *acceleration != Vector3::zeros();
        let on = Moving {
            velocity: *velocity,
            acceleration: acceleration / FEASIBLE,
            difference: jerk * (self.period / RETREATING),
        };
        moves
            && rate.abs() <= self.fastest
            && self.envelope.used([acceleration, jerk, snap]) <= FEASIBLE
            && self.envelope.way_out(&on).is_some()
    }

    /// A length with which lengths along the vertical count as much as the accelerations that undo them.
    fn flat(&self, y: &Vector3<f32>) -> f32 {
        let vertical = y.z * self.flatness;
        math::sqrt(y.x * y.x + y.y * y.y + vertical * vertical)
    }

    /// How the error moves beside turning with the stream.
    fn drift(sought: &Sought) -> Vector3<f32> {
        sought.error.velocity - quarter(&sought.error.position) * sought.point.rate
    }

    /// How far off a stream is, with how far it goes off in a span, m.
    fn off(&self, sought: &Sought) -> f32 {
        self.flat(&sought.error.position) + self.span * self.flat(&Self::drift(sought))
    }

    /// The acceleration that feedback may command, m/s^2: a share of the rest beside a head whose error turns with the
    /// stream.
    fn room(&self, sought: &Sought) -> f32 {
        let Point { acceleration, jerk, snap, rate, .. } = &sought.point;
        let turned = |y: &Vector3<f32>| quarter(y) * *rate;
        let bent = turned(&turned(&sought.error.position));
        let twisted = turned(&bent);
        let used = self.envelope.used([&(acceleration - bent), &(jerk - twisted), &(snap - turned(&twisted))]);
        FEEDBACK * self.acceleration * math::between(1.0 - used, LEAST_LEFT, 1.0)
    }

    /// The stiffness whose answer to the error is within the room.
    fn affordable(&self, sought: &Sought, room: f32) -> f32 {
        let Point { position, .. } = &sought.error;
        let stiff = (STIFF / self.span).min(STIFFEST / self.period);
        let within = |off: f32, stiff: f32| if off * stiff * stiff <= room { stiff } else { math::sqrt(room / off) };
        let turning = (TURNING * sought.point.rate.abs()).min(stiff);
        let horizontal = within(math::sqrt(position.xy().norm_squared()), stiff).max(turning);
        within((position.z * self.flatness).abs(), horizontal)
    }

    /// Whether what the error does beside turning with the stream is answered within the room.
    fn is_near(&self, sought: &Sought, stiffness: f32, room: f32) -> bool {
        let Point { velocity, acceleration, .. } = &sought.error;
        let drift = Self::drift(sought);
        let bend = acceleration - (quarter(velocity) + quarter(&drift)) * sought.point.rate;
        2.0 * stiffness * self.flat(&drift) <= room && self.flat(&bend) <= room
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
