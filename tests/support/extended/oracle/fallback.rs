//! Section 13: when the law is slowed, and what it is then.

use super::{Law, double};

/// A window, the first stay; near the target; progress, as a share and in m.
const WINDOW_US: u64 = 20_000_000;
const STAY_US: u64 = 20_000_000;
const NEAR_M: f64 = 0.5;
const PROGRESS_MIN: [f64; 2] = [0.1, 5.0];

/// |p~| grows by more than this beside so much of what |v~| makes of it, m, only where reference or state jump.
const JUMP_DISTANCE: f64 = 0.5;
const JUMP_SPEEDS: f64 = 2.0;

/// M_s, m/s^2, the slowed law's speed, m/s, and its share of Omega, sqrt(alpha_0) and alpha_0.
const SLOW_LEVEL: f64 = 1.0;
const SLOW_SPEED: f64 = 2.0;
const TURN_SHARE: f64 = 0.2;

/// What the slowed law takes a reference to fall with, and |u| to be at least, m/s^2.
const REFERENCE_FALL: f64 = 1.0;
const COMMAND_LEAST: f64 = 0.5;

/// Which law flies, and what its windows have seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fallback {
    pub slow: bool,
    pub times: u32,
    elapsed: u64,
    /// |p~| in the last tick, m.
    now: f64,
    near: bool,
    /// The greatest |p~| and |v~| of this window.
    greatest: [f64; 2],
    /// Those below which a window makes progress; none: any does.
    records: [Option<f64>; 2],
}

impl Fallback {
    pub const FRESH: Self = Self {
        slow: false,
        times: 0,
        elapsed: 0,
        now: f64::INFINITY,
        near: false,
        greatest: [0.0; 2],
        records: [None; 2],
    };

    /// The next window, or stay.
    fn next(self, slow: bool, records: [Option<f64>; 2]) -> Self {
        Self { slow, times: self.times + u32::from(slow), now: self.now, records, ..Self::FRESH }
    }

    /// After a tick of `period` s with errors of `distance` m and `speed` m/s.
    pub fn after(self, distance: f64, speed: f64, period: f64) -> Self {
        let near = distance.hypot(speed) < NEAR_M;
        let mut next = Self { now: distance, elapsed: self.elapsed + (period * 1e6).round() as u64, ..self };
        if self.slow {
            let stay = STAY_US << (self.times - 1);
            return if near && next.elapsed >= stay { next.next(false, [None; 2]) } else { next };
        }
        if distance - self.now > JUMP_DISTANCE + JUMP_SPEEDS * speed * period {
            next = next.next(false, [None; 2]);
        }
        next.near |= near;
        next.greatest = [next.greatest[0].max(distance), next.greatest[1].max(speed)];
        if next.elapsed < WINDOW_US {
            return next;
        }
        let [farthest, fastest] = next.greatest;
        let is_broken = |record: Option<f64>, value: f64| {
            record
                .is_none_or(|record| record > NEAR_M && record - value > PROGRESS_MIN[1].min(PROGRESS_MIN[0] * record))
        };
        let [distance, speed] = next.records;
        if next.near {
            next.next(false, [None; 2])
        } else if is_broken(speed, fastest) {
            next.next(false, [Some(farthest), Some(fastest)])
        } else if is_broken(distance, farthest) {
            next.next(false, [Some(farthest), speed])
        } else {
            next.next(true, [None; 2])
        }
    }
}

/// The position law's constants in force: across, and along the vertical.
pub struct Gains {
    pub k_p: [f64; 2],
    pub k_v: [f64; 2],
    /// k_f, k_s and k_d.
    pub filters: [f64; 3],
    /// v_c across, up and down.
    pub speeds: [f64; 3],
    /// The greatest level.
    pub most: f64,
}

impl Law {
    /// sigma.
    pub fn slowing(&self) -> f64 {
        let p = &self.p;
        let [k_f, k_s, rate, reserve] = [p.k_f, p.k_s, p.turn_rate, p.turn_reserve].map(double);
        let n = (self.gravity - double(p.force_up) - SLOW_LEVEL - REFERENCE_FALL).max(COMMAND_LEAST);
        let by_rate = TURN_SHARE * rate.min(reserve.sqrt()) * n / (2.0 * k_f * SLOW_LEVEL);
        by_rate.min((TURN_SHARE * reserve * n / (2.0 * k_f * (k_s + k_f) * SLOW_LEVEL)).sqrt()).min(1.0)
    }

    pub fn gains(&self, slow: bool) -> Gains {
        let p = &self.p;
        let (by, most, fastest) =
            if slow { (self.slowing(), SLOW_LEVEL, SLOW_SPEED) } else { (1.0, f64::INFINITY, f64::INFINITY) };
        Gains {
            k_p: [p.k_p_across, p.k_p_vertical].map(|k| double(k) * by * by),
            k_v: [p.k_v_across, p.k_v_vertical].map(|k| double(k) * by),
            filters: [p.k_f, p.k_s, p.k_d].map(|k| double(k) * by),
            speeds: [p.v_across, p.v_up, p.v_down].map(|v| double(v).min(fastest)),
            most,
        }
    }
}
