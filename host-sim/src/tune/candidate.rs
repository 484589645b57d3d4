//! One candidate: gains from a point of the search space, and a verdict on them.
//!
//! A point holds the natural logarithms of the nine gains that matter and of the thrust floor as a fraction of its greatest
//! admissible value. delta and alpha stay as the file has them: they are about noise, not about performance.
//!
//! The tests run from cheap to dear and stop at the first that fails: certificate (about a millisecond), spectral
//! radii, margins, recovery from upside down, the file's own flight. A verdict that fails says how far it got and by how
//! much it missed, so that the search has a slope to follow.
//!
//! The gain margin is asked for twice. At the actuator's command it covers a wrong inertia or thrust coefficient, but
//! there the attitude loop's own gain dominates, and the position loop's hardly counts: alone, it would let the search
//! drive k_p and k_v to where the vehicle only just does not oscillate. So all loops must stay stable with k_p and k_v
//! multiplied by the margin as well, which is the gain margin at the position feedback.

use super::requirements::Requirements;
use crate::claims::reached;
use crate::flight::Flight;
use crate::flown::Flown;
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::certificate::inequality::Inequality;
use controller_core::gains::{GainParameters, Gains};
use controller_core::heading::Heading;
use controller_core::reference::hover::Hover;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::body::{BodyState, attitude_from_euler};
use scenario::sampled_loop::Axis;
use scenario::stability::{Lack, Shortfall};
use scenario::timing::Timing;
use std::sync::Arc;

/// Coordinates of the search space.
pub const DIMENSIONS: usize = 10;

/// A point of it.
pub type Point = [f64; DIMENSIONS];

/// Greatest position error in the last quarter of a recovery, m.
const STILL_POSITION: f64 = 0.01;
/// Greatest norm of the modified Rodrigues parameters there.
const STILL_MRP: f64 = 1e-3;

/// What a candidate showed.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// How far from acceptable: the number of the test that failed counted from the end, plus how much it missed by. Zero
    /// for an accepted candidate.
    pub violation: f64,
    /// Which test failed, in words.
    pub failed: Option<String>,
    /// Height lost in the recovery, m.
    pub height_lost: f64,
    /// k_p, 1/s^2.
    pub position_gain: f64,
    /// The inequality with the least margin.
    pub tightest: Option<Inequality>,
}

impl Verdict {
    /// Of a candidate that nobody judged.
    #[must_use]
    pub fn missing() -> Self {
        let (failed, height_lost) = (Some("not judged".to_owned()), f64::INFINITY);
        Self { violation: f64::INFINITY, failed, height_lost, position_gain: 0.0, tightest: None }
    }

    /// Whether every requirement is met.
    #[must_use]
    pub fn accepted(&self) -> bool {
        self.violation == 0.0
    }
}

/// Judges candidates for one scenario.
pub struct Judge {
    scenario: Scenario,
    recovery: Scenario,
    requirements: Requirements,
}

impl Judge {
    /// A judge for the vehicle, rotors, timing and reference of `scenario`.
    #[must_use]
    pub fn new(scenario: &Scenario, requirements: Requirements) -> Self {
        Self { recovery: recovery(scenario, requirements.recovery), scenario: scenario.clone(), requirements }
    }

    /// The file's own gains as a point: where the search starts.
    #[must_use]
    pub fn start(&self) -> Point {
        let configuration = &self.scenario.configuration;
        let g = configuration.gains();
        let floor = configuration.thrust_floor().map_or(0.5, |floor| floor / configuration.greatest_thrust_floor());
        let values = [g.k_p, g.k_v, g.k_f, g.k_s, g.k_theta, g.k_omega, g.m_p, g.m_theta, g.m_omega, floor];
        values.map(|value| f64::from(value).ln())
    }

    /// The scenario with the gains of `point`, if the law is defined for them.
    #[must_use]
    pub fn scenario(&self, point: &Point) -> Option<Scenario> {
        let configuration = &self.scenario.configuration;
        let [k_p, k_v, k_f, k_s, k_theta, k_omega, m_p, m_theta, m_omega, floor] = point.map(|x| x.exp() as f32);
        let GainParameters { delta, alpha, .. } = **configuration.gains();
        let parameters = GainParameters { k_p, k_v, k_f, k_s, k_theta, k_omega, m_p, m_theta, m_omega, delta, alpha };
        let gains = Gains::new(parameters, configuration.vehicle()).ok()?;
        let configuration = configuration.with_gains(gains).ok()?;
        let configuration = if self.requirements.projection {
            let floor = floor.min(1.0 - self.requirements.margin as f32) * configuration.greatest_thrust_floor();
            configuration.with_thrust_floor(floor).ok()?
        } else {
            configuration
        };
        Some(Scenario { configuration, ..self.scenario.clone() })
    }

    /// Puts `point` through the tests.
    #[must_use]
    pub fn judge(&self, point: &Point) -> Verdict {
        let mut verdict = Verdict {
            violation: 0.0,
            failed: None,
            height_lost: f64::INFINITY,
            position_gain: point[0].exp(),
            tightest: None,
        };
        let Err((tests_left, missed, what)) = self.run(point, &mut verdict) else {
            return verdict;
        };
        // Squeezed into (0, 1), so that a later test is always nearer to acceptance than an earlier one.
        verdict.violation = f64::from(tests_left) + missed.max(1e-9) / (1.0 + missed.max(1e-9));
        verdict.failed = Some(what);
        verdict
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
        let loops = loops.with_position_feedback(needed.loops.gain);
        for axis in Axis::ALL {
            let radius = loops.spectral_radius(axis);
            if radius >= 1.0 {
                let what =
                    format!("sampled loop {}: unstable with {} times k_p and k_v", axis.name(), needed.loops.gain);
                return Err((2, radius - 1.0, what));
            }
        }

        let flown = fly(&self.recovery, certified).ok_or((1, 1e3, "recovery diverged".to_owned()))?;
        verdict.height_lost = flown.height_lost;
        let restless =
            (flown.steady_position_error / STILL_POSITION - 1.0).max(flown.steady_mrp_error / STILL_MRP - 1.0);
        let restless = restless.max(flown.clipped as f64);
        if restless > 0.0 {
            return Err((1, restless, "recovery: not still at the end, or a clipped command".to_owned()));
        }

        let flown = fly(&scenario, certified).ok_or((0, 1e3, "the file's flight diverged".to_owned()))?;
        let beyond = (flown.steady_position_error / needed.position_error - 1.0)
            .max(flown.steady_mrp_error / needed.mrp_error - 1.0)
            .max(flown.clipped as f64);
        if beyond > 0.0 {
            let what = "the file's flight: errors beyond those asked for, or a clipped command";
            return Err((0, beyond, what.to_owned()));
        }
        if !reached(&scenario, &flown) {
            return Err((0, 1.0, "the file's flight: its reference is not reached in time".to_owned()));
        }
        Ok(())
    }
}

/// The recovery that height is measured in: the attitude the paper starts from (roll -179 degrees, yaw 100 degrees off the
/// heading asked for), at rest, hovering where it starts, for `duration` s. Table I loses 23.3 m in it.
#[must_use]
pub fn recovery(scenario: &Scenario, duration: f64) -> Scenario {
    let rest = Vector3::zeros();
    let attitude = attitude_from_euler((-179.0_f64).to_radians(), 0.0, 100.0_f64.to_radians());
    let initial = BodyState { position: rest, velocity: rest, attitude, angular_velocity: rest };
    let timing = Timing { ticks: (duration / scenario.timing.period()) as u64, ..scenario.timing };
    let mut recovery = Scenario { name: "recovery".to_owned(), initial, timing, ..scenario.clone() };
    // Height can only be lost where there is no ground.
    recovery.reality.ground = None;
    if let Ok(hover) = Hover::new(Vector3::zeros(), Heading::FORWARD) {
        recovery.trajectory = Arc::new(hover);
    }
    recovery
}

/// Flies what is certified as `scenario` says; none if it cannot be flown to its end.
fn fly(scenario: &Scenario, certified: &Certified) -> Option<Flown> {
    Flown::over(scenario, Flight::certified(scenario, certified).ok()?).ok()
}
