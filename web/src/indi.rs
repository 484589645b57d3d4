//! INDI on a vehicle: with the gains that `host-sim compare --tune` found for it where those are built in, otherwise
//! with the best of a few that are tried here.

use host_sim::flight::Flight;
use host_sim::flight::course::Course;
use host_sim::flight::tasks::{drag, hover};
use host_sim::rivals::choice::LawChoice;
use host_sim::rivals::gains::Set;
use host_sim::rivals::kind::RivalKind;
use host_sim::rivals::rival::Rival;
use host_sim::rivals::start::Speed;
use nalgebra::Vector3;
use scenario::Scenario;
use std::cell::RefCell;

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

thread_local! {
    /// The gains that were tried last, and for which gains' start and vehicle: a slider flies the same vehicle again.
    static TRIED: RefCell<Option<(Vec<f64>, Vec<f64>)>> = const { RefCell::new(None) };
}

/// The law on the vehicle of `vehicle`, and where its gains come from; none if it is undefined.
pub fn on_vehicle(vehicle: &Scenario) -> Option<(Box<dyn Rival>, &'static str)> {
    let kind = RivalKind::Indi;
    if let Some(set) = Set::built_in(vehicle, &[kind])
        && let Some(LawChoice::Rival(_, gains)) = set.law(kind)
    {
        let note = if set.from_other_rates.is_empty() { TUNED_NOTE } else { OTHER_RATE_NOTE };
        return Some((kind.build(vehicle, &gains)?, note));
    }
    let known = TRIED.with_borrow(|tried| tried.clone()).filter(|(model, _)| *model == numbers(vehicle));
    let gains = match known {
        Some((_, gains)) => gains,
        None => tried(vehicle)?,
    };
    TRIED.set(Some((numbers(vehicle), gains.clone())));
    Some((kind.build(vehicle, &gains)?, TRIED_NOTE))
}

/// What gains depend on.
fn numbers(vehicle: &Scenario) -> Vec<f64> {
    let (model, drag) = (vehicle.configuration.vehicle(), drag(vehicle));
    let rotors = vehicle.configuration.rotors().into_iter().flat_map(|rotors| rotors.iter());
    let mut numbers = vec![f64::from(model.mass), vehicle.rotor_lag, vehicle.delay(), vehicle.timing.period()];
    numbers.extend(model.inertia.iter().map(|&inertia| f64::from(inertia)));
    numbers.extend(drag.linear.iter());
    numbers.extend(rotors.flat_map(|rotor| [rotor.position.x, rotor.position.y, rotor.thrust_max]).map(f64::from));
    numbers
}

/// The best of a few gains.
fn tried(vehicle: &Scenario) -> Option<Vec<f64>> {
    let (kind, start) = (RivalKind::Indi, RivalKind::Indi.start(vehicle));
    let step = hover(vehicle, STEP_START_M, TRIED_S).ok()?;
    let cost = |speed: &Speed| cost(&step, kind.build(vehicle, &start.at(*speed)));
    let best = |speeds: Vec<Speed>| {
        speeds.into_iter().map(|speed| (cost(&speed), speed)).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, speed)| speed)
    };
    let speed = best(best(start.attitudes())?.positions())?;
    Some(start.at(speed))
}

/// RMS of the distance over the last half, m, after the time until it arrives, s.
fn cost(step: &Scenario, rival: Option<Box<dyn Rival>>) -> f64 {
    let course = rival.and_then(|rival| Course::fly(step, Flight::of_rival(step, rival), ARRIVED_M).ok());
    course.map_or(f64::INFINITY, |course| course.settled.unwrap_or(TRIED_S) + course.rms)
}
