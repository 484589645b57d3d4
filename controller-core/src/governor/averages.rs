//! The first two moving averages, and the command x_0 that goes into them.
//!
//! With lengths N_1, N_2 in ticks the second difference of N_1 N_2 times the averaged acceleration is the command alpha
//! at four delays with signs: a comb. It is what [`super::smoother`] sums up again, in integers, so nothing rounds.

use super::limits::HISTORY_TICKS;
use super::windows::Windows;
use nalgebra::Vector3;

/// The commands that the averages remember, and what they add up to. Length units and ticks.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Averages {
    history: [Vector3<i32>; HISTORY_TICKS],
    newest: usize,
    /// N_1, N_2 and their sum.
    delays: [usize; 3],
    commanded: Vector3<i64>,
    speed: Vector3<i64>,
}

impl Averages {
    /// Not designed yet, at rest at the origin.
    pub const NONE: Self = Self {
        history: [Vector3::new(0, 0, 0); HISTORY_TICKS],
        newest: 0,
        delays: [0; 3],
        commanded: Vector3::new(0, 0, 0),
        speed: Vector3::new(0, 0, 0),
    };

    /// Prepares for `windows`.
    pub fn design(&mut self, windows: &Windows) {
        let [first, second, _] = windows.lengths;
        self.delays = [first, second, first + second];
    }

    /// Goes on as if `acceleration` had always been commanded, from where and how fast the command is now.
    pub fn start(&mut self, commanded: Vector3<i64>, speed: Vector3<i64>, acceleration: Vector3<i32>) {
        self.history.fill(acceleration);
        self.commanded = commanded;
        self.speed = speed;
    }

    /// Takes one tick of commanded acceleration; the second difference of N_1 N_2 times its averages.
    pub fn push(&mut self, acceleration: &Vector3<i32>) -> Vector3<i32> {
        self.newest = (self.newest + 1) % HISTORY_TICKS;
        if let Some(slot) = self.history.get_mut(self.newest) {
            *slot = *acceleration;
        }
        let speed = &mut self.speed;
        *speed += acceleration.map(i64::from);
        self.commanded += *speed;
        let [first, second, both] = self.delays.map(|delay| self.past(delay));
        acceleration - first - second + both
    }

    /// The command `delay` ticks ago.
    fn past(&self, delay: usize) -> Vector3<i32> {
        self.history.get((self.newest + HISTORY_TICKS - delay) % HISTORY_TICKS).copied().unwrap_or_default()
    }

    /// The commanded position x_0.
    pub fn commanded(&self) -> &Vector3<i64> {
        &self.commanded
    }

    /// The commanded velocity u.
    pub fn speed(&self) -> &Vector3<i64> {
        &self.speed
    }
}
