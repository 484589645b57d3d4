//! One candidate: a point of the search space, and a verdict on it.
//!
//! The tests run from cheap to dear and stop at the first that fails: certificate (about a millisecond), spectral
//! radii, margins, the trials of [`super::trials`], the file's own flight, the flights of large motions. A verdict that
//! fails says how far it got and by how much it missed, so that the search has a slope to follow.
//!
//! The gain margin is required twice. At the actuator's command it covers a wrong inertia or thrust coefficient, but
//! there the attitude loop's own gain dominates, and the position loop's hardly counts: alone, it would let the search
//! drive k_p and k_v to where the vehicle only just does not oscillate. So all loops must stay stable with k_p and k_v
//! multiplied by the margin as well, which is the gain margin at the position feedback.

use super::requirements::Requirements;
use super::space::{Point, Space};
use super::trials::{COST_MODELS, MODEL_FIGURES, TrialFigures, fly_trials};
use crate::flight::Flight;
use crate::flight::claims::reached;
use crate::flight::extremes::FlightExtremes;
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::certificate::inequality::Inequality;
use scenario::Scenario;
use scenario::large_motions;
use scenario::sampled_loop::Axis;
use scenario::stability::{Lack, Shortfall};

/// The share of its time in which a recovery must end.
const RECOVERED_BY_SHARE: f64 = 0.75;
/// After a gust, under a law that estimates.
const OFFSET_MAX_M: f64 = 0.01;

/// The verdict on a candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// How far from acceptable: the number of the test that failed counted from the end, plus how much it missed by.
    /// Zero for an accepted candidate.
    pub violation: f64,
    /// Which test failed, in words.
    pub failed: Option<String>,
    /// The trials' figures on the file's own model.
    pub figures: TrialFigures,
    /// The mean of [`TrialFigures::values`] over all models.
    pub mean: [f64; MODEL_FIGURES.len()],
    /// The mean of [`TrialFigures::cost`] over all models.
    pub cost: f64,
    /// The inequality with the least margin.
    pub tightest: Option<Inequality>,
}

impl Verdict {
    /// Of a candidate that passed every test; or of one that failed: the number of tests left, by how much it missed,
    /// and which test failed.
    #[must_use]
    pub fn after(self, tests: Result<(), (u8, f64, String)>) -> Self {
        let Err((tests_left, missed, what)) = tests else {
            return self;
        };
        // Squeezed into (0, 1), so that a later test is always nearer to acceptance than an earlier one.
        let violation = f64::from(tests_left) + missed.max(1e-9) / (1.0 + missed.max(1e-9));
        Self { violation, failed: Some(what), ..self }
    }

    /// Of a candidate that was not judged.
    #[must_use]
    pub fn missing() -> Self {
        let failed = Some("not judged".to_owned());
        Self {
            violation: f64::INFINITY,
            failed,
            figures: NO_TRIALS,
            mean: NO_TRIALS.values(),
            cost: f64::INFINITY,
            tightest: None,
        }
    }

    /// Takes the models' figures, the file's own first.
    pub fn take(&mut self, figures: &[TrialFigures]) {
        let mean = |of: &dyn Fn(&TrialFigures) -> f64| figures.iter().map(of).sum::<f64>() / figures.len() as f64;
        self.figures = figures[0];
        self.mean = std::array::from_fn(|place| mean(&|figures| figures.values()[place]));
        self.cost = mean(&TrialFigures::cost);
    }

    /// Whether every requirement is met.
    #[must_use]
    pub fn accepted(&self) -> bool {
        self.violation == 0.0
    }
}

/// A judge of points of a search space.
pub trait Judging: Sync {
    /// Where the search starts.
    fn start(&self) -> Point;

    /// Puts `point` through its tests.
    fn judge(&self, point: &Point) -> Verdict;
}

/// The figures without any trial.
const NO_TRIALS: TrialFigures = TrialFigures {
    height_lost: f64::INFINITY,
    recovered: f64::INFINITY,
    turned: f64::INFINITY,
    gust: f64::INFINITY,
    offset: f64::INFINITY,
    step: f64::INFINITY,
    activity: f64::INFINITY,
    noise: f64::INFINITY,
    beyond: None,
    clipped: 0,
};

/// Judges candidates for one scenario.
pub struct Judge {
    scenario: Scenario,
    space: Space,
    requirements: Requirements,
}

impl Judge {
    /// A judge for the vehicle, rotors, timing and reference of `scenario`.
    #[must_use]
    pub fn new(scenario: &Scenario, requirements: Requirements) -> Self {
        let floor = requirements.projection.then_some(1.0 - requirements.margin as f32);
        let space = Space::new(scenario, floor);
        Self { scenario: scenario.clone(), space, requirements }
    }

    /// The scenario with the gains of `point`, if the law is defined for them.
    #[must_use]
    pub fn scenario(&self, point: &Point) -> Option<Scenario> {
        Some(Scenario { configuration: self.space.configuration(point)?, ..self.scenario.clone() })
    }

    fn run(&self, point: &Point, verdict: &mut Verdict) -> Result<(), (u8, f64, String)> {
        let needed = &self.requirements;
        let undefined = (5, 1.0, "the law is undefined for these gains".to_owned());
        let scenario = self.scenario(point).ok_or(undefined.clone())?;

        let judged = Certified::new(scenario.configuration.clone());
        let certificate = match &judged {
            Ok(certified) => certified.certificate(),
            Err(Refused::Fails(certificate)) => certificate,
            Err(Refused::Undefined(_)) => return Err(undefined),
        };
        verdict.tightest = certificate.tightest();
        let missing: f64 =
            certificate.inequalities().map(|inequality| (needed.margin - inequality.margin()).max(0.0)).sum();
        let (Ok(certified), true) = (&judged, missing == 0.0) else {
            let name = verdict.tightest.map_or("", |inequality| inequality.name);
            return Err((4, missing, format!("certificate: {name}")));
        };

        let loops = scenario.loops().map_err(|_| undefined)?;
        for axis in Axis::ALL {
            let spectral_radius = loops.spectral_radius(axis);
            if spectral_radius >= 1.0 {
                let lack = Lack { axis, missed: spectral_radius - 1.0, what: Shortfall::Unstable { spectral_radius } };
                return Err((3, lack.missed, lack.to_string()));
            }
        }
        if let Some(lack) = needed.loops.first_lacking(&loops.reports()) {
            return Err((2, lack.missed, lack.to_string()));
        }
        let loops = loops.with_position_feedback([needed.loops.gain; 2]);
        for axis in Axis::ALL {
            let radius = loops.spectral_radius(axis);
            if radius >= 1.0 {
                let what =
                    format!("sampled loop {}: unstable with {} times k_p and k_v", axis.name(), needed.loops.gain);
                return Err((2, radius - 1.0, what));
            }
        }

        self.try_out(&scenario, certified, verdict)?;

        let flown = fly(&scenario, certified).ok_or((0, 1e3, "the file's flight diverged".to_owned()))?;
        let beyond = (flown.steady_position_error / needed.position_error - 1.0)
            .max(flown.steady_mrp_error / needed.mrp_error - 1.0)
            .max(flown.clipped as f64);
        if beyond > 0.0 {
            let what = "the file's flight: errors beyond the required ones, or a clipped command";
            return Err((0, beyond, what.to_owned()));
        }
        if !reached(&scenario, &flown) {
            return Err((0, 1.0, "the file's flight: its reference is not reached in time".to_owned()));
        }
        if scenario.configuration.paper().is_none() {
            let flights = large_motions::flown(certified, &scenario.loop_timing());
            let flights = flights.map_err(|error| (0, 1.0, error.to_string()))?;
            flights.map_err(|not_arrived| (0, 1.0, not_arrived.to_string()))?;
        }
        Ok(())
    }

    /// The trials, on each model; on the file's own nothing may be clipped, and the recovery must end.
    fn try_out(
        &self,
        scenario: &Scenario,
        certified: &Certified,
        verdict: &mut Verdict,
    ) -> Result<(), (u8, f64, String)> {
        let recovery = self.requirements.recovery;
        let mut figures = Vec::new();
        for model in &COST_MODELS {
            let lost = (1, 1e3, format!("a trial was not flown to its end: {model}"));
            let start = |real: &Scenario| Flight::certified(real, certified).ok();
            figures.push(fly_trials(scenario, start, model, recovery).ok_or(lost)?);
        }
        verdict.take(&figures);
        let restless =
            (verdict.figures.recovered / (RECOVERED_BY_SHARE * recovery) - 1.0).max(verdict.figures.clipped as f64);
        if restless > 0.0 {
            return Err((1, restless, "recovery: not near in time, or a clipped command".to_owned()));
        }
        let estimates = scenario.configuration.paper().is_none();
        if estimates && verdict.figures.offset > OFFSET_MAX_M {
            return Err((1, verdict.figures.offset / OFFSET_MAX_M - 1.0, "gust: an offset is left".to_owned()));
        }
        Ok(())
    }
}

impl Judging for Judge {
    /// The file's own constants.
    fn start(&self) -> Point {
        self.space.start()
    }

    fn judge(&self, point: &Point) -> Verdict {
        let mut verdict = Verdict { violation: 0.0, failed: None, ..Verdict::missing() };
        let tests = self.run(point, &mut verdict);
        verdict.after(tests)
    }
}

/// Flies the certified law as `scenario` says; `None` if the flight ends early.
fn fly(scenario: &Scenario, certified: &Certified) -> Option<FlightExtremes> {
    FlightExtremes::gather(scenario, Flight::certified(scenario, certified).ok()?).ok()
}
