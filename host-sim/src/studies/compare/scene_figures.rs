//! The figures of one law in one scene, and in the random flights.

use super::scenes::Scene;
use crate::flight::course::Activity;
use crate::flight::law_on_vehicle::LawOnVehicle;
use crate::flight::{Flight, FlightError};
use crate::output::interrupt::Interrupt;
use crate::studies::campaign::outcome::Outcome;
use crate::studies::campaign::quantile;
use crate::studies::campaign::random_flight;
use controller_core::certificate::Certificate;
use rayon::prelude::*;
use scenario::Scenario;

/// As in the trials of a search.
const ARRIVAL_DISTANCE_M: f64 = 0.1;
/// Between two points of a picture; the same for laws of every rate.
pub const PICTURE_PERIOD_US: u64 = 20_000;

/// One law in one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFigures {
    /// Start minus lowest height, m.
    pub height_lost: f64,
    /// The time from which it stays near, s; `None` if it was away at the end.
    pub settled: Option<f64>,
    /// Greatest distance from the reference, and that at the end, m.
    pub excursion: f64,
    /// m.
    pub end_error: f64,
    /// Distance from the reference over the last half, RMS, m.
    pub rms: f64,
    /// Change of a rotor's command within 10 ms over the last half, RMS, N.
    pub activity: f64,
    /// Share of ticks at which a command was cut.
    pub clipped: f64,
    /// (s, m): distance from the reference, and height above the start.
    pub error: Vec<(f64, f64)>,
    /// Likewise.
    pub height: Vec<(f64, f64)>,
}

/// Flies `scene`; none if it cannot be flown to its end.
#[must_use]
pub fn fly_scene(law: &LawOnVehicle, scene: &Scene) -> Option<SceneFigures> {
    fly_scene_within(law, scene, ARRIVAL_DISTANCE_M)
}

/// Likewise; it has arrived within `near`, m.
#[must_use]
pub fn fly_scene_within(law: &LawOnVehicle, scene: &Scene, near: f64) -> Option<SceneFigures> {
    gather(&scene.scenario, law.flight(&scene.scenario).ok()?, near).ok()
}

fn gather(scenario: &Scenario, mut flight: Flight, near: f64) -> Result<SceneFigures, FlightError> {
    let ticks = scenario.timing.ticks;
    let mut figures = SceneFigures {
        height_lost: 0.0,
        settled: Some(0.0),
        excursion: 0.0,
        end_error: 0.0,
        rms: 0.0,
        activity: 0.0,
        clipped: 0.0,
        error: Vec::new(),
        height: Vec::new(),
    };
    let (mut squares, mut activity) = (0.0, Activity::new(scenario.timing.period_us));
    for number in 0..ticks {
        let tick = flight.tick()?;
        let (position, time) = (&tick.state.position, tick.time_us as f64 * 1e-6);
        let rise = position.z - scenario.initial.position.z;
        let error = (position - tick.reference.position.map(f64::from)).norm();
        figures.height_lost = figures.height_lost.max(-rise);
        figures.excursion = figures.excursion.max(error);
        figures.end_error = error;
        figures.clipped += f64::from(u8::from(tick.clipped)) / ticks as f64;
        if error > near {
            figures.settled = Some(time + scenario.timing.period());
        }
        while figures.error.len() as u64 * PICTURE_PERIOD_US <= tick.time_us {
            figures.error.push((time, error));
            figures.height.push((time, rise));
        }
        if 2 * number >= ticks {
            squares += error * error;
            activity.observe(&tick.rotor_thrusts);
        }
    }
    figures.settled = figures.settled.filter(|_| figures.end_error <= near);
    figures.rms = (squares / (ticks - ticks / 2) as f64).sqrt();
    figures.activity = activity.rms();
    Ok(figures)
}

/// One law in all random flights.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomFlights {
    /// The figures of each flight, by its number.
    pub outcomes: Vec<Outcome>,
}

/// Flies the flights 0 to `count` - 1 of the campaign of `scenario`, with its plant step: the flights of
/// `campaign --law`. `None` after an interrupt.
#[must_use]
pub fn fly_random_flights(
    law: &LawOnVehicle,
    scenario: &Scenario,
    certificate: &Certificate,
    count: u64,
    interrupt: &Interrupt,
) -> Option<RandomFlights> {
    let fly = |number| {
        let row = random_flight::fly(law, scenario, certificate, scenario.campaign.seed, number).ok()?;
        interrupt.signal().is_none().then_some(row.outcome)
    };
    Some(RandomFlights { outcomes: (0..count).into_par_iter().map(fly).collect::<Option<_>>()? })
}

impl RandomFlights {
    /// Share of the flights for which `holds` is true.
    #[must_use]
    pub fn share(&self, holds: impl Fn(&Outcome) -> bool) -> f64 {
        let count = self.outcomes.iter().filter(|outcome| holds(outcome)).count();
        count as f64 / self.outcomes.len().max(1) as f64
    }

    /// The height lost that this share of the flights does not exceed, m.
    #[must_use]
    pub fn height(&self, part: f64) -> f64 {
        let heights: Vec<f64> = self.outcomes.iter().map(|outcome| outcome.height_lost).collect();
        quantile(&heights, part).unwrap_or(f64::INFINITY)
    }

    /// The time until within 0.2 m for good that this share of the flights does not exceed, s; infinite for never.
    #[must_use]
    pub fn settled(&self, part: f64) -> f64 {
        let times: Vec<f64> = self.outcomes.iter().map(|outcome| outcome.settled.unwrap_or(f64::INFINITY)).collect();
        quantile(&times, part).unwrap_or(f64::INFINITY)
    }

    /// Share of all ticks for which `count` counts.
    #[must_use]
    pub fn ticks(&self, count: impl Fn(&Outcome) -> u64) -> f64 {
        let (counted, all) =
            self.outcomes.iter().fold((0, 0), |(counted, all), one| (counted + count(one), all + one.ticks));
        counted as f64 / all.max(1) as f64
    }
}
