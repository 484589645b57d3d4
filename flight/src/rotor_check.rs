//! Whether each rotor turns as it is commanded to, by its measured speed.
//!
//! A rotor that is to give f turns with c = sqrt(f / k_eta); where the file knows no speeds, k_eta is nominal, and so
//! the rotors are compared with each other:
//!
//! | here | equation |
//! |---|---|
//! | c of late | c_low = min(c, c_low + (c - c_low) h / `LAG_MAX_S`), c_high likewise with max: bounds of what lags behind c |
//! | r, real over nominal speed | median over the rotors that answer of 2 w / (c_low + c_high) |
//! | not turning | w < `STILL_SHARE` r c_low, or less than `STILL_MAX_RAD_PER_S` |
//! | too slow | w < `SLOW_SHARE` r c_low |
//! | too fast | w > `FAST_SHARE` r c_high |
//! | settles at | w + lag w' |
//! | lost | settles below `LOST_SHARE` r c_low, for `LOST_DEBOUNCE_US` |
//! | silent | its controller does not answer while another's does |
//!
//! A battery that sags and air that flows through the rotors move all of them, and so r. A thrust curve that is not the
//! motors' makes them differ while their commands do: what is less than half of a speed is therefore said alone. A
//! rotor that is lost by its speed is told to the law, which flies without it once the motion shows a part of the loss.
//! That is before the motion alone would tell, because a speed tells where it will settle.
//!
//! On the ground, idling, each c is the same; a rotor that does not turn keeps the vehicle there.

use crate::debounce::Debounce;
use controller_core::allocation::geometry::ROTORS_MAX;
use controller_core::allocation::remaining::LostRotor;
use controller_core::allocation::{Rotors, collected};
use controller_core::configuration::{Configuration, LawParameters};
use controller_core::math;
use core::cmp::Ordering;
use core::fmt;
use heapless::Vec;

/// The age from which speeds do not count.
pub const SPEEDS_STALE_AFTER_US: u64 = 50_000;

/// A rotor's lag is no longer than this.
const LAG_MAX_S: f32 = 0.15;

const STILL_SHARE: f32 = 0.1;
const STILL_MAX_RAD_PER_S: f32 = 20.0;
const SLOW_SHARE: f32 = 0.75;
const FAST_SHARE: f32 = 1.4;
const LOST_SHARE: f32 = 0.5;

/// The share of its speed below which nothing is left of a rotor's thrust.
const NOTHING_LEFT_SHARE: f32 = 0.35;

/// Idling, motors of one kind may differ by so much.
const IDLE_SHARES: (f32, f32) = (0.5, 2.0);

const LOST_DEBOUNCE_US: u64 = 20_000;
const NOT_TURNING_DEBOUNCE_US: u64 = 50_000;
const DEVIATION_DEBOUNCE_US: u64 = 500_000;

/// How long motors take to start.
const STARTING_MAX_US: u64 = 1_000_000;

/// The time between two reports of a rotor.
pub const ROTOR_REPORT_INTERVAL_US: u64 = 10_000_000;

/// How many rotors have to answer so that one is compared with the others.
const COMPARABLE_MIN: usize = 3;

/// What is wrong with a rotor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RotorDeviation {
    /// It stands still, or almost.
    NotTurning,
    /// It turns more slowly than its command has it.
    TooSlow,
    /// It turns faster.
    TooFast,
    /// Its controller does not answer any more, or never did; others do.
    Silent,
}

/// A rotor that does not turn as it is commanded to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RotorFault {
    /// Its index in the rotors' order.
    pub rotor: usize,
    /// What is wrong.
    pub deviation: RotorDeviation,
}

impl RotorDeviation {
    /// In words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::NotTurning => "not turning",
            Self::TooSlow => "too slow",
            Self::TooFast => "too fast",
            Self::Silent => "controller silent",
        }
    }
}

impl fmt::Display for RotorFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Rotor {}: {}", self.rotor + 1, self.deviation.text())
    }
}

/// What the rotors are commanded to do.
#[derive(Debug, Clone, Copy)]
pub(super) enum Turning<'a> {
    /// Nothing, or one alone.
    No,
    /// All of them idle.
    Idling,
    /// Each of them gives a thrust, N.
    Flying(&'a [f32]),
}

/// What is found in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct RotorFindings {
    /// To be reported.
    pub report: Option<RotorFault>,
    /// A rotor that is lost.
    pub lost: Option<LostRotor>,
}

/// A rotor.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Checked {
    /// 1 / k_eta.
    square_per_thrust: f32,
    /// c_low and c_high, rad/s.
    low: f32,
    high: f32,
    /// The last speed, rad/s.
    speed: Option<f32>,
    /// Whether it settles too low.
    lost: Debounce,
    /// What is wrong with it, since when, and when that is next reported, us.
    deviation: Option<(RotorDeviation, u64, u64)>,
}

/// The check of all rotors.
#[derive(Debug, PartialEq)]
pub(super) struct RotorCheck {
    rotors: Vec<Checked, ROTORS_MAX>,
    /// The time between ticks, s.
    period: f32,
    lag: f32,
    /// Since when the rotors idle, us.
    idling_since: Option<u64>,
}

impl RotorCheck {
    /// Of these rotors, with a lag in s, in ticks `period` seconds apart. Without rotors nothing is found.
    pub fn new(rotors: Option<&Rotors>, lag: f32, period: f32) -> Self {
        let checked = |thrust_coefficient: f32| Checked {
            square_per_thrust: 1.0 / thrust_coefficient,
            low: 0.0,
            high: 0.0,
            speed: None,
            lost: Debounce::default(),
            deviation: None,
        };
        let rotors = rotors.into_iter().flat_map(|rotors| rotors.iter()).map(|rotor| checked(rotor.thrust_coefficient));
        Self { rotors: rotors.collect(), period, lag, idling_since: None }
    }

    /// Of a configuration's rotors, in ticks of `period` us.
    pub fn of(configuration: Option<&Configuration>, period: u64) -> Self {
        let lag = configuration.and_then(|configuration| match configuration.law() {
            LawParameters::Extended(law) => Some(law.actuators.lag),
            LawParameters::Paper(_) => None,
        });
        Self::new(configuration.and_then(Configuration::rotors), lag.unwrap_or(0.0), period as f32 * 1e-6)
    }

    /// The rotor that keeps an idling vehicle on the ground.
    pub fn grounding(&self, now: u64) -> Option<RotorFault> {
        self.idling_since?;
        let mut rotors = self.rotors.iter().enumerate();
        rotors.find_map(|(rotor, checked)| {
            let (deviation, since, _) = checked.deviation?;
            let counts = deviation != RotorDeviation::Silent && now.saturating_sub(since) >= NOT_TURNING_DEBOUNCE_US;
            counts.then_some(RotorFault { rotor, deviation })
        })
    }

    /// A tick with the rotors' `speeds`, rad/s, in their order; none of a rotor whose controller did not answer.
    pub fn tick(&mut self, turning: Turning, speeds: Option<&[Option<f32>]>, now: u64) -> RotorFindings {
        self.idling_since = matches!(turning, Turning::Idling).then(|| self.idling_since.unwrap_or(now));
        self.follow(turning);
        let Some(speeds) = speeds.filter(|_| !matches!(turning, Turning::No)) else {
            self.forget();
            return RotorFindings::default();
        };
        let starting = self.idling_since.is_some_and(|since| now.saturating_sub(since) < STARTING_MAX_US);
        let ratio = self.ratio(speeds).filter(|_| !starting);
        let answers = speeds.iter().any(Option::is_some);
        let is_idle = self.idling_since.is_some();
        let mut findings = RotorFindings::default();
        for (rotor, checked) in self.rotors.iter_mut().enumerate() {
            let speed = speeds.get(rotor).copied().flatten();
            let settles = checked.settles(speed, self.lag / self.period);
            let deviation = match (speed, ratio) {
                (None, _) if answers && !starting => Some(RotorDeviation::Silent),
                (Some(speed), Some(ratio)) => checked.judged(speed, ratio, is_idle),
                _ => None,
            };
            if checked.is_to_be_reported(deviation, now) {
                findings.report = findings.report.or(deviation.map(|deviation| RotorFault { rotor, deviation }));
            }
            let share = match (settles, ratio) {
                (Some(settles), Some(ratio)) if !is_idle && ratio * checked.low > 2.0 * STILL_MAX_RAD_PER_S => {
                    settles / (ratio * checked.low)
                }
                _ => 1.0,
            };
            if checked.is_lost(share, now) {
                let left = if share < NOTHING_LEFT_SHARE { 0.0 } else { share * share };
                findings.lost = findings.lost.or(Some(LostRotor { rotor, left }));
            }
        }
        findings
    }

    /// Takes the commands in.
    fn follow(&mut self, turning: Turning) {
        let part = math::min(self.period / LAG_MAX_S, 1.0);
        for (rotor, checked) in self.rotors.iter_mut().enumerate() {
            let command = match turning {
                Turning::No => 0.0,
                Turning::Idling => 1.0,
                Turning::Flying(thrusts) => {
                    let thrust = thrusts.get(rotor).copied().unwrap_or(0.0);
                    math::sqrt(math::max(thrust, 0.0) * checked.square_per_thrust)
                }
            };
            if matches!(turning, Turning::Idling) {
                (checked.low, checked.high) = (command, command);
            }
            checked.low = math::min(command, checked.low + (command - checked.low) * part);
            checked.high = math::max(command, checked.high + (command - checked.high) * part);
        }
    }

    /// r; none where too few rotors answer.
    fn ratio(&self, speeds: &[Option<f32>]) -> Option<f32> {
        let of = |(checked, speed): (&Checked, &Option<f32>)| {
            let command = 0.5 * (checked.low + checked.high);
            speed.filter(|_| command > 0.0).map(|speed| speed / command)
        };
        let ratios: Vec<f32, ROTORS_MAX> = collected(self.rotors.iter().zip(speeds).filter_map(of));
        let (upper, lower) = (ratios.len() / 2, ratios.len().saturating_sub(1) / 2);
        // The ratio of this rank. The standard library's sorting can panic.
        let ranked = |rank: usize| {
            let count = |ratio: &f32, counts: fn(Ordering) -> bool| {
                ratios.iter().filter(|other| counts(other.total_cmp(ratio))).count()
            };
            let is_ranked =
                |ratio: &f32| (count(ratio, Ordering::is_lt)..count(ratio, Ordering::is_le)).contains(&rank);
            ratios.iter().copied().find(is_ranked)
        };
        let middle = ranked(lower).zip(ranked(upper)).map(|(lower, upper)| 0.5 * (lower + upper));
        middle.filter(|_| ratios.len() >= COMPARABLE_MIN)
    }

    fn forget(&mut self) {
        for checked in &mut self.rotors {
            (checked.speed, checked.lost, checked.deviation) = (None, Debounce::default(), None);
        }
    }
}

impl Checked {
    /// What is wrong with its speed, where the rotors turn `ratio` times as fast as nominally.
    fn judged(&self, speed: f32, ratio: f32, is_idle: bool) -> Option<RotorDeviation> {
        let (low, high) = (ratio * self.low, ratio * self.high);
        let (slow, fast) = if is_idle { IDLE_SHARES } else { (SLOW_SHARE, FAST_SHARE) };
        let expects = is_idle || low > 2.0 * STILL_MAX_RAD_PER_S;
        if expects && (speed < STILL_SHARE * low || speed < STILL_MAX_RAD_PER_S) {
            Some(RotorDeviation::NotTurning)
        } else if expects && speed < slow * low {
            Some(RotorDeviation::TooSlow)
        } else if speed > fast * high + STILL_MAX_RAD_PER_S {
            Some(RotorDeviation::TooFast)
        } else {
            None
        }
    }

    /// Where its speed will settle, rad/s, with a lag of so many ticks.
    fn settles(&mut self, speed: Option<f32>, lag_ticks: f32) -> Option<f32> {
        let before = core::mem::replace(&mut self.speed, speed);
        speed.zip(before).map(|(speed, before)| math::max(speed + lag_ticks * (speed - before), 0.0))
    }

    /// Whether what is wrong is to be reported in this tick.
    fn is_to_be_reported(&mut self, deviation: Option<RotorDeviation>, now: u64) -> bool {
        let Some(deviation) = deviation else {
            self.deviation = None;
            return false;
        };
        let debounce = match deviation {
            RotorDeviation::NotTurning => NOT_TURNING_DEBOUNCE_US,
            _ => DEVIATION_DEBOUNCE_US,
        };
        let known = self.deviation.filter(|(known, ..)| *known == deviation);
        let (_, since, due) = known.unwrap_or((deviation, now, now.saturating_add(debounce)));
        let is_due = now >= due;
        let due = if is_due { now.saturating_add(ROTOR_REPORT_INTERVAL_US) } else { due };
        self.deviation = Some((deviation, since, due));
        is_due
    }

    /// Whether it is lost, settling at this `share` of its speed.
    fn is_lost(&mut self, share: f32, now: u64) -> bool {
        // A NaN compares false.
        self.lost.holds_for(share < LOST_SHARE, LOST_DEBOUNCE_US, now)
    }
}

#[cfg(test)]
mod tests;
