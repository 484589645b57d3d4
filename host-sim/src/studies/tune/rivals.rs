//! The search for a rival's gains: by the trials and the cost that ours are found by ([`super::trials`]), and the same
//! search.
//!
//! Rivals have fewer requirements than ours: no certificate, no margins of sampled loops, no flight without a clipped
//! command, no vanishing offset in a gust. What stays is that every trial on every model is flown to its end, and that
//! the recovery from upside down ends in time on the file's own model. A law that meets only the first of these is
//! taken all the same, and its cost says so: what does not end counts as long as its trial.

use crate::flight::Flight;
use crate::output::interrupt::Interrupt;
use crate::output::progress::Progress;
use crate::rivals::gains::Set;
use crate::rivals::kind::RivalKind;
use crate::rivals::start::Speed;
use crate::studies::tune::candidate::{Judging, Verdict};
use crate::studies::tune::effort::Effort;
use crate::studies::tune::evolution::Evolution;
use crate::studies::tune::space::Point;
use crate::studies::tune::trials::{COST_MODELS, fly_trials};
use rayon::prelude::*;
use scenario::Scenario;
use std::time::{Duration, Instant};

/// The rivals that have a search of their own.
const SEARCHED_RIVALS: [RivalKind; 6] = [
    RivalKind::Lee,
    RivalKind::Cascade,
    RivalKind::Mellinger,
    RivalKind::Indi,
    RivalKind::Nested,
    RivalKind::Memoryless,
];

/// As in `host-sim tune`.
const RECOVERY_MAX_S: f64 = 20.0;

/// Judges gains of one rival on one vehicle.
pub struct RivalJudge<'a> {
    scenario: &'a Scenario,
    kind: RivalKind,
    start: Vec<f64>,
}

impl<'a> RivalJudge<'a> {
    /// Of `kind` on the vehicle of `scenario`; the search begins at `start`.
    #[must_use]
    pub fn new(scenario: &'a Scenario, kind: RivalKind, start: &[f64]) -> Self {
        Self { scenario, kind, start: start.to_vec() }
    }

    /// Likewise; the search begins at START, made as fast as flies best on this vehicle: [`crate::rivals::start`].
    #[must_use]
    pub fn at_best_start(scenario: &'a Scenario, kind: RivalKind, interrupt: &Interrupt) -> Self {
        let start = kind.start(scenario);
        let judged = |speed: Speed| {
            let judge = Self::new(scenario, kind, &start.at(speed));
            let verdict = interrupt.signal().map_or_else(|| judge.judge(&judge.start()), |_| Verdict::missing());
            (speed, [verdict.violation, verdict.cost])
        };
        let best = |speeds: Vec<Speed>| {
            let all: Vec<_> = speeds.into_par_iter().map(judged).collect();
            let better = |a: (Speed, [f64; 2]), b: (Speed, [f64; 2])| if b.1 < a.1 { b } else { a };
            all.into_iter().reduce(better).map_or(Speed::UNSCALED, |(speed, _)| speed)
        };
        let speed = best(best(start.attitudes()).positions());
        Self { scenario, kind, start: start.at(speed) }
    }

    /// The gains of `point`.
    #[must_use]
    pub fn gains(point: &Point) -> Vec<f64> {
        point.iter().map(|logarithm| logarithm.exp()).collect()
    }

    fn run(&self, point: &Point, verdict: &mut Verdict) -> Result<(), (u8, f64, String)> {
        let gains = Self::gains(point);
        let mut figures = Vec::new();
        for (flown, model) in COST_MODELS.iter().enumerate() {
            let start = |real: &Scenario| Some(Flight::of_rival(real, self.kind.build(self.scenario, &gains)?));
            let lost = ((COST_MODELS.len() - flown) as u8, 1.0, format!("a trial was not flown to its end: {model}"));
            figures.push(fly_trials(self.scenario, start, model, RECOVERY_MAX_S).ok_or(lost)?);
        }
        verdict.take(&figures);
        Ok(())
    }
}

impl Judging for RivalJudge<'_> {
    fn start(&self) -> Point {
        self.start.iter().map(|gain| gain.ln()).collect()
    }

    fn judge(&self, point: &Point) -> Verdict {
        let mut verdict = Verdict { violation: 0.0, failed: None, ..Verdict::missing() };
        let tests = self.run(point, &mut verdict);
        verdict.after(tests)
    }
}

/// Searches gains of `kinds` for the vehicle of `scenario`, with the same `effort` for each. The continuous law
/// takes the memoryless one's, so that the two differ in nothing but their choice of quaternion. If no gains of a
/// rival fly all trials to their end, the set leaves the rival out and names it.
///
/// # Errors
/// Names the signal that came.
pub fn tune(scenario: &Scenario, kinds: &[RivalKind], effort: Effort, interrupt: &Interrupt) -> Result<Set, String> {
    let searched = searched(kinds);
    let mut progress = Progress::new("searching gains", searched.len() as u64 * rounds(&effort));
    let mut done = 0;
    let mut next = |kind: RivalKind| {
        progress.about(kind.name());
        progress.show(done);
        done += 1;
        interrupt.signal().map_or(Ok(()), |signal| Err(format!("interrupted by signal {signal}; nothing is written")))
    };
    let mut search = |kind: RivalKind| {
        next(kind)?;
        let judge = RivalJudge::at_best_start(scenario, kind, interrupt);
        next(kind)?;
        let mut evolution = Evolution::new(&judge, &effort, interrupt);
        for _ in 0..effort.generations {
            next(kind)?;
            evolution.generation(&judge, interrupt);
        }
        Ok::<_, String>(evolution.best().map(|(point, verdict)| (RivalJudge::gains(&point), verdict.cost)))
    };
    let mut set = Set::default();
    let mut keep = |kind: RivalKind, found: Option<(Vec<f64>, f64)>| match found {
        _ if !kinds.contains(&kind) => {}
        Some((gains, cost)) => set.rivals.push((kind, gains, cost)),
        None => set.lost.push(kind),
    };
    for kind in searched {
        let found = search(kind)?;
        if kind == RivalKind::Memoryless {
            let of_continuous = |(gains, _): &(Vec<f64>, f64)| {
                let judge = RivalJudge::new(scenario, RivalKind::Continuous, gains);
                let verdict = judge.judge(&judge.start());
                verdict.accepted().then(|| (gains.clone(), verdict.cost))
            };
            keep(RivalKind::Continuous, found.as_ref().and_then(of_continuous));
        }
        keep(kind, found);
    }
    // An interrupt in the last generation leaves it half judged.
    next(RivalKind::Memoryless)?;
    Ok(set)
}

/// About how long [`tune`] takes here, from how long one candidate of the first rival does.
#[must_use]
pub fn expected(scenario: &Scenario, kinds: &[RivalKind], effort: &Effort) -> Duration {
    let (began, threads) = (Instant::now(), rayon::current_num_threads());
    let searched = searched(kinds);
    let Some(&kind) = searched.first() else { return Duration::ZERO };
    let start = kind.start(scenario);
    let judge = RivalJudge::new(scenario, kind, &start.at(Speed::UNSCALED));
    judge.judge(&judge.start());
    let one = began.elapsed();
    let starts = start.attitudes().len() + Speed::UNSCALED.positions().len();
    let of_each = starts + (1 + effort.generations as usize) * effort.population;
    one.mul_f64((searched.len() * of_each) as f64 / threads as f64)
}

/// Those of `kinds` that have a search of their own, and the one whose gains the continuous law takes.
fn searched(kinds: &[RivalKind]) -> Vec<RivalKind> {
    let wanted = |kind: &RivalKind| {
        kinds.contains(kind) || *kind == RivalKind::Memoryless && kinds.contains(&RivalKind::Continuous)
    };
    SEARCHED_RIVALS.into_iter().filter(wanted).collect()
}

/// The steps of each rival's search: starts, the first population, and the generations.
fn rounds(effort: &Effort) -> u64 {
    2 + u64::from(effort.generations)
}
