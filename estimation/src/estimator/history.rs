//! The recent history of the IMU: increments in a ring, whole or in part, for poses that come late.
//!
//! An increment spans [start, end], us of the vehicle's clock; each begins where the last one ended. Inside one, body
//! rate and specific force count as constant. A part f of it, taken from anywhere inside, is then
//!
//! ```text
//! phi_f = f phi        d_f = f d - f (1 - f) / 2 phi x d
//! ```
//!
//! each d in the body frame at the start of its own part (to first order in phi; the error is |phi|^2 |d| / 12 of an
//! increment, 3e-4 m/s at 10 rad/s and 10 ms under 2 g). The parts of an increment put together are the increment.

use heapless::Deque;
use nalgebra::Vector3;

/// How far beyond the last increment a state is extrapolated, and the longest increment, us.
pub const EXTRAPOLATION_MAX_US: u64 = 22_000;

/// How long the slow force is averaged over, s.
const SLOW_FORCE_TIME_CONSTANT_S: f32 = 0.05;

/// Increments that are kept: 320 ms of them at 5 ms.
pub const INCREMENTS_MAX: usize = 64;

/// Which of the IMU's sensors were at full scale: the truth is beyond, by an unknown amount.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clipped {
    /// The gyro.
    pub gyro: bool,
    /// The accelerometer: a shock, such as a hard touchdown.
    pub accelerometer: bool,
}

impl Clipped {
    /// Neither.
    pub const NEITHER: Self = Self { gyro: false, accelerometer: false };

    /// Those of either.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self { gyro: self.gyro | other.gyro, accelerometer: self.accelerometer | other.accelerometer }
    }
}

/// How the vehicle turned and accelerated over a short time, by its IMU.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Increment {
    /// When it begins, us.
    pub start: u64,
    /// When it ends, us; after its start.
    pub end: u64,
    /// phi, the rotation vector from the body frame at the start to that at the end, rad.
    pub delta_angle: Vector3<f32>,
    /// d, the integral of the specific force, m/s, body frame at the start.
    pub delta_velocity: Vector3<f32>,
    /// What was at full scale meanwhile.
    pub clipped: Clipped,
}

impl Increment {
    /// h, s.
    pub fn seconds(&self) -> f32 {
        self.end.saturating_sub(self.start) as f32 * 1e-6
    }

    /// Whether it can be used: finite, and no longer than a gap that is bridged.
    pub(crate) fn is_usable(&self, longest: u64) -> bool {
        let finite = is_measurable(&self.delta_angle) && is_measurable(&self.delta_velocity);
        finite && self.start < self.end && self.end - self.start <= longest
    }

    /// How the body turns in the time `ahead` after this, us, rad: as it has in the increment that is `under_way`, if
    /// that goes on from here and is no later, and then at the mean rate of the newest so much time as this one lasts.
    pub(super) fn turn_ahead(&self, under_way: Option<&Self>, ahead: u64) -> Vector3<f32> {
        let goes_on = |next: &&Self| next.start == self.end && next.is_usable(ahead);
        let measured = under_way.filter(goes_on);
        let (turned, seconds) = measured.map_or((Vector3::zeros(), 0.0), |next| (next.delta_angle, next.seconds()));
        let older = (1.0 - seconds / self.seconds()).max(0.0);
        let rate = (turned + self.delta_angle * older) / (seconds + self.seconds() * older);
        let rest = rate * (ahead as f32 * 1e-6 - seconds);
        turned + rest + turned.cross(&rest) * 0.5
    }

    /// A vector of the body at the start, as it is at the end: to first order in the turn.
    pub(super) fn turned_back(&self, vector: &Vector3<f32>) -> Vector3<f32> {
        vector - self.delta_angle.cross(vector)
    }

    /// d in the frame at the end, m/s.
    pub(super) fn push_at_end(&self) -> Vector3<f32> {
        self.turned_back(&self.delta_velocity)
    }

    /// The part of it between two times, us, if it has one.
    fn part(&self, from: u64, to: u64) -> Option<Self> {
        let (start, end) = (from.max(self.start), to.min(self.end));
        if start >= end {
            return None;
        }
        if (start, end) == (self.start, self.end) {
            return Some(*self);
        }
        let part = (end - start) as f32 / (self.end - self.start) as f32;
        let delta_angle = self.delta_angle * part;
        let bent = self.delta_angle.cross(&self.delta_velocity) * (0.5 * part * (1.0 - part));
        let delta_velocity = self.delta_velocity * part - bent;
        Some(Self { start, end, delta_angle, delta_velocity, ..*self })
    }
}

/// Whether a vector can have been measured: finite, and small enough to be squared.
pub(super) fn is_measurable(vector: &Vector3<f32>) -> bool {
    vector.iter().all(|component| component.abs() < 1e4)
}

/// f_slow of `present` after an increment, by what it was before, m/s^2.
pub(super) fn slow_force(before: Option<&Vector3<f32>>, increment: &Increment) -> Vector3<f32> {
    let (push, seconds) = (increment.push_at_end(), increment.seconds());
    let Some(before) = before else { return push / seconds };
    let before = increment.turned_back(before);
    before + (push - before * seconds) / SLOW_FORCE_TIME_CONSTANT_S
}

/// The ring.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct History {
    increments: Deque<Increment, INCREMENTS_MAX>,
    /// f_slow, m/s^2, body; of no meaning while there is no increment.
    slow_force: Vector3<f32>,
}

impl History {
    pub const EMPTY: Self = Self { increments: Deque::new(), slow_force: Vector3::new(0.0, 0.0, 0.0) };

    /// When the oldest increment begins and the newest ends, us.
    pub fn span(&self) -> Option<(u64, u64)> {
        Some((self.increments.front()?.start, self.increments.back()?.end))
    }

    /// The newest increment.
    pub fn newest(&self) -> Option<&Increment> {
        self.increments.back()
    }

    /// The one before it.
    pub fn before_newest(&self) -> Option<&Increment> {
        self.increments.iter().nth_back(1)
    }

    /// The increment that the next one to be [pushed](Self::push) will drive out.
    pub fn leaving(&self) -> Option<&Increment> {
        if self.increments.is_full() { self.increments.front() } else { None }
    }

    /// The specific force averaged over a twentieth of a second, m/s^2, in the body frame at the end of the newest
    /// increment.
    pub fn slow_force(&self) -> &Vector3<f32> {
        &self.slow_force
    }

    /// Adds an increment that begins where the last one ended.
    pub fn push(&mut self, increment: &Increment) {
        let before = self.newest().map(|_| &self.slow_force);
        self.slow_force = slow_force(before, increment);
        if self.increments.is_full() {
            self.increments.pop_front();
        }
        // There is room for it now.
        let _ = self.increments.push_back(*increment);
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.increments.clear();
    }

    /// What happened between two times, us, oldest first.
    pub fn between(&self, from: u64, to: u64) -> impl Iterator<Item = Increment> + '_ {
        self.increments.iter().filter_map(move |increment| increment.part(from, to))
    }
}

#[cfg(test)]
mod tests;
