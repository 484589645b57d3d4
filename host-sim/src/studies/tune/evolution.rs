//! Differential evolution with feasibility first.
//!
//! For each member x of the population a trial is made from three others, x_a + F (x_b - x_c), coordinates taken over
//! with probability `CROSSOVER_PROBABILITY` (DE/rand/1/bin; half of the time x_a is the best member, which is faster
//! and still explores). A trial replaces its parent if it is better: an acceptable one beats one that is not, of two
//! that are not the one nearer to acceptance wins, of two that are the one of less cost.

use super::candidate::{Judging, Verdict};
use super::effort::Effort;
use super::space::Point;
use crate::output::interrupt::Interrupt;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;

/// A coordinate comes from the mutant with it.
const CROSSOVER_PROBABILITY: f64 = 0.8;
/// Spread of the first population around the file's gains, in natural logarithms.
const START_SPREAD: f64 = 0.6;

/// Whether `a` is better than `b`.
fn better(a: &Verdict, b: &Verdict) -> bool {
    (a.violation, a.cost) < (b.violation, b.cost)
}

/// The population.
pub struct Evolution {
    members: Vec<(Point, Verdict)>,
    start: Verdict,
    random: ChaCha8Rng,
    judged: u64,
}

impl Evolution {
    /// The first population, scattered around where the search starts, which is judged first and belongs to it.
    pub fn new(judge: &impl Judging, effort: &Effort, interrupt: &Interrupt) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(effort.seed);
        let start = judge.start();
        let own = judge.judge(&start);
        let scattered = (1..effort.population.max(4))
            .map(|_| start.iter().map(|x| x + START_SPREAD * (random.random::<f64>() - 0.5)).collect());
        let (others, judged) = judge_all(judge, scattered.collect(), interrupt);
        let members = [(start, own.clone())].into_iter().chain(others).collect();
        Self { members, start: own, random, judged: 1 + judged }
    }

    pub fn start(&self) -> &Verdict {
        &self.start
    }

    pub fn generation(&mut self, judge: &impl Judging, interrupt: &Interrupt) {
        let best = self.leader();
        let trials: Vec<Point> = (0..self.members.len()).map(|parent| self.trial(parent, best)).collect();
        let (trials, judged) = judge_all(judge, trials, interrupt);
        self.judged += judged;
        for ((point, verdict), member) in trials.into_iter().zip(&mut self.members) {
            if better(&verdict, &member.1) {
                *member = (point, verdict);
            }
        }
    }

    /// The best accepted member, if there is one.
    pub fn best(&self) -> Option<(Point, Verdict)> {
        let best = self.members[self.leader()].clone();
        best.1.accepted().then_some(best)
    }

    /// The verdict nearest to acceptance.
    pub fn closest(&self) -> Verdict {
        self.members[self.leader()].1.clone()
    }

    /// Candidates judged so far.
    pub fn judged(&self) -> u64 {
        self.judged
    }

    fn leader(&self) -> usize {
        let indices = 1..self.members.len();
        indices.fold(0, |best, i| if better(&self.members[i].1, &self.members[best].1) { i } else { best })
    }

    fn trial(&mut self, parent: usize, best: usize) -> Point {
        let count = self.members.len();
        let [a, b, c] = [(); 3].map(|()| self.random.random_range(0..count));
        let base = if self.random.random::<bool>() { best } else { a };
        let scale = self.random.random_range(0.4..0.9);
        let mut trial = self.members[parent].0.clone();
        let forced = self.random.random_range(0..trial.len());
        for (index, coordinate) in trial.iter_mut().enumerate() {
            if index == forced || self.random.random::<f64>() < CROSSOVER_PROBABILITY {
                let difference = self.members[b].0[index] - self.members[c].0[index];
                *coordinate = self.members[base].0[index] + scale * difference;
            }
        }
        trial
    }
}

/// Judges all points, or those before an interrupt; and their number.
fn judge_all(judge: &impl Judging, points: Vec<Point>, interrupt: &Interrupt) -> (Vec<(Point, Verdict)>, u64) {
    let judged = |point: Point| {
        let verdict = interrupt.signal().is_none().then(|| judge.judge(&point));
        (point, verdict)
    };
    let verdicts: Vec<_> = points.into_par_iter().map(judged).collect();
    let judged = verdicts.iter().filter(|(_, verdict)| verdict.is_some()).count() as u64;
    let complete = |(point, verdict): (Point, Option<Verdict>)| (point, verdict.unwrap_or_else(Verdict::missing));
    (verdicts.into_iter().map(complete).collect(), judged)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(violation: f64, cost: f64) -> Verdict {
        Verdict { violation, cost, ..Verdict::missing() }
    }

    #[test]
    fn an_acceptable_candidate_beats_a_cheaper_one_that_is_not() {
        let (poor, rejected) = (verdict(0.0, 50.0), verdict(0.5, 1.0));
        assert!(better(&poor, &rejected) && !better(&rejected, &poor));
        assert!(better(&verdict(0.4, f64::INFINITY), &rejected), "the nearer to acceptance wins");
        assert!(better(&verdict(0.0, 3.0), &poor), "of two accepted the cheaper");
    }

    /// Judges by the distance from a start that cannot be bettered, or from elsewhere.
    struct Bowl {
        bottom: f64,
    }

    impl Judging for Bowl {
        fn start(&self) -> Point {
            vec![0.0; 3]
        }

        fn judge(&self, point: &Point) -> Verdict {
            verdict(0.0, point.iter().map(|x| (x - self.bottom).powi(2)).sum())
        }
    }

    fn searched(judge: &Bowl) -> Evolution {
        let mut evolution =
            Evolution::new(judge, &Effort { generations: 30, population: 12, seed: 1 }, &Interrupt::default());
        (0..30).for_each(|_| evolution.generation(judge, &Interrupt::default()));
        evolution
    }

    #[test]
    fn a_start_that_nothing_betters_is_what_is_found() {
        let evolution = searched(&Bowl { bottom: 0.0 });
        assert_eq!(evolution.best(), Some((vec![0.0; 3], evolution.start().clone())));
        assert_eq!(evolution.judged(), 12 * 31);
    }

    #[test]
    fn a_bottom_outside_the_first_population_is_found() {
        let evolution = searched(&Bowl { bottom: 1.0 });
        let (_, best) = evolution.best().unwrap();
        assert!(evolution.start().cost == 3.0 && best.cost < 0.01, "{best:?}");
    }
}
