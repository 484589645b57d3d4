//! The search for a rival's gains: by the trials and the cost that ours are found by ([`crate::tune::trials`]), and the same search.
//!
//! Less is asked of rivals than of ours: no certificate, no margins of sampled loops, no flight without a clipped command, no vanishing offset in a gust. What stays is that every trial
//! on every model is flown to its end, and that the recovery from upside down ends in time on the file's own model. A law that meets
//! only the first of these is taken all the same, and its cost says so: what does not end counts as long as its trial.

use super::gains::Set;
use super::kind::Kind;
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use crate::tune::candidate::{Judging, Verdict};
use crate::tune::effort::Effort;
use crate::tune::evolution::Evolution;
use crate::tune::frontier::Frontier;
use crate::tune::space::Point;
use crate::tune::trials::{MODELS, Shown, show};
use scenario::Scenario;

/// How long a recovery may take, s: as in `host-sim tune`.
const RECOVERY: f64 = 20.0;

/// Judges gains of one rival on one vehicle.
pub struct RivalJudge<'a> {
    scenario: &'a Scenario,
    kind: Kind,
    start: Vec<f64>,
}

impl<'a> RivalJudge<'a> {
    /// Of `kind` on the vehicle of `scenario`; the search begins at `start`.
    #[must_use]
    pub fn new(scenario: &'a Scenario, kind: Kind, start: &[f64]) -> Self {
        Self { scenario, kind, start: start.to_vec() }
    }

    /// The gains of `point`.
    #[must_use]
    pub fn gains(point: &Point) -> Vec<f64> {
        point.iter().map(|logarithm| logarithm.exp()).collect()
    }

    fn run(&self, point: &Point, verdict: &mut Verdict) -> Result<(), (u8, f64, String)> {
        let gains = Self::gains(point);
        let mut costs = Vec::new();
        for (flown, model) in MODELS.iter().enumerate() {
            let start = |real: &Scenario| self.kind.flight(self.scenario, real, &gains);
            let lost = ((MODELS.len() - flown) as u8, 1.0, format!("a trial was not flown to its end: {model:?}"));
            costs.push(show(self.scenario, start, model, RECOVERY).ok_or(lost)?);
        }
        verdict.shown = costs[0];
        verdict.cost = costs.iter().map(Shown::cost).sum::<f64>() / costs.len() as f64;
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

/// Searches gains of every rival for the vehicle of `scenario`. The continuous law takes the memoryless one's, so that the two differ in
/// nothing but their choice of quaternion.
///
/// # Errors
/// Names the rival of which no gains fly all trials to their end, or the signal that came.
pub fn tune(scenario: &Scenario, effort: Effort, interrupt: &Interrupt) -> Result<Set, String> {
    let search = |kind: Kind| {
        let judge = RivalJudge::new(scenario, kind, kind.start());
        let mut frontier = Frontier::default();
        let mut progress = Progress::new(kind.name(), u64::from(effort.generations));
        let mut evolution = Evolution::new(&judge, &effort, &mut frontier, interrupt);
        for generation in 0..effort.generations {
            if let Some(signal) = interrupt.signal() {
                return Err(format!("interrupted by signal {signal}; nothing is written"));
            }
            evolution.generation(&judge, &mut frontier, interrupt);
            progress.show(u64::from(generation));
        }
        let (point, verdict) =
            evolution.best().ok_or_else(|| format!("{}: no gains fly every trial to its end", kind.name()))?;
        Ok((kind, RivalJudge::gains(&point), verdict.cost))
    };
    let mut rivals = Vec::new();
    for kind in Kind::ALL.into_iter().filter(|kind| *kind != Kind::Continuous) {
        rivals.push(search(kind)?);
    }
    if let Some((_, gains, _)) = rivals.iter().find(|(kind, ..)| *kind == Kind::Memoryless).cloned() {
        let judge = RivalJudge::new(scenario, Kind::Continuous, &gains);
        let cost = judge.judge(&judge.start()).cost;
        rivals.insert(rivals.len() - 1, (Kind::Continuous, gains, cost));
    }
    Ok(Set { rivals })
}
