//! INDI on a vehicle: with the gains that `host-sim compare --tune` found for it where those are built in, otherwise
//! with the best of a few that are tried here.

use host_sim::flight::Flight;
use host_sim::flight::course::Course;
use host_sim::flight::tasks::{hover, in_still_air};
use host_sim::rivals::choice::LawChoice;
use host_sim::rivals::gains::Set;
use host_sim::rivals::kind::RivalKind;
use host_sim::rivals::rival::Rival;
use host_sim::rivals::start::Speed;
use nalgebra::Vector3;
use scenario::Scenario;

/// What is tried here: a step of 1 m, for so long.
const STEP_START_M: Vector3<f64> = Vector3::new(-0.6, 0.6, -0.5);
const TRIED_S: f64 = 5.0;
const ARRIVED_M: f64 = 0.1;

/// Said of gains that were tried here.
const TRIED_NOTE: &str = "INDI's gains are the best of 13 that were tried here on a step of 1 m; a search on a desk \
    (host-sim compare --tune) finds better ones.";
/// Said of gains of another rate.
const OTHER_RATE_NOTE: &str = "INDI's gains were found at another rate.";
/// Said of gains that were found for this vehicle.
const TUNED_NOTE: &str = "INDI's gains were found for this vehicle by host-sim compare --tune.";

/// The law on the vehicle of `scenario`, and where its gains come from; none if it is undefined.
pub fn on_vehicle(scenario: &Scenario) -> Option<(Box<dyn Rival>, &'static str)> {
    let kind = RivalKind::Indi;
    if let Some(set) = Set::built_in(scenario, &[kind])
        && let Some(LawChoice::Rival(_, gains)) = set.law(kind)
    {
        let note = if set.from_other_rates.is_empty() { TUNED_NOTE } else { OTHER_RATE_NOTE };
        return Some((kind.build(scenario, &gains)?, note));
    }
    let start = kind.start(scenario);
    let step = hover(&in_still_air(scenario), STEP_START_M, TRIED_S).ok()?;
    let cost = |speed: &Speed| cost(&step, kind.build(scenario, &start.at(*speed)));
    let best = |speeds: Vec<Speed>| speeds.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let speed = best(best(start.attitudes())?.positions())?;
    Some((kind.build(scenario, &start.at(speed))?, TRIED_NOTE))
}

/// RMS of the distance over the last half, m, after the time until it arrives, s.
fn cost(step: &Scenario, rival: Option<Box<dyn Rival>>) -> f64 {
    let course = rival.and_then(|rival| Course::fly(step, Flight::of_rival(step, rival), ARRIVED_M).ok());
    course.map_or(f64::INFINITY, |course| course.settled.unwrap_or(TRIED_S) + course.rms)
}
