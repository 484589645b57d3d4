//! What becomes of a vehicle when one of its rotors is gone: flights of the model, and what they lack where it is lost.
//!
//! The model, with the file's `[drag]` and nothing else of what is really there, hovers; a rotor goes; the reference
//! stays. After [`WATCHED_S`] the vehicle is near its place, or lost. One that then turns faster and faster is
//! flown on until it is lost, to say by when it must have landed. Beside the flights stand the relaxed hover that the
//! vehicle comes to, and the sampled loop about it ([`scenario::rotor_loss`]). None of this decides whether it may fly.

use crate::flight::Flight;
use crate::flight::tasks::hover;
use crate::output::table::{aligned, short};
use controller_core::certificate::certified::Certified;
use controller_core::configuration::LawParameters;
use controller_core::error::ParameterError;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::reality::Reality;
use scenario::reality::failure::Failure;
use scenario::rotor_loss::relaxed_hover::{NoHover, RelaxedHover};
use scenario::rotor_loss::{PLACE_HELD_DISTANCE_M, SOFT_LANDING_SPEED_M_PER_S, WithoutARotor, turning_loop};
use scenario::sampled_loop::LoopTiming;

/// When the rotor goes, and for how long the vehicle is watched then; and how long if it turns ever faster.
const FAILURE_S: f64 = 1.0;
const WATCHED_S: f64 = 10.0;
const WATCHED_MAX_S: f64 = 30.0;

/// A vehicle that moves faster after that is lost, as one is that is farther from its place than
/// [`PLACE_HELD_DISTANCE_M`].
const SPEED_MAX_M_PER_S: f64 = 1.0;

/// Up to here a vehicle keeps its heading.
const HEADING_KEPT_RATE_RAD_PER_S: f64 = 0.5;

/// A flight, from the failure on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FlightWithoutRotor {
    /// m.
    height_lost: f64,
    /// Across, m.
    farthest: f64,
    /// From higher than this above the ground, m, it never comes down faster than a soft landing.
    lands_from: f64,
    /// Body rates after [`WATCHED_S`], rad/s.
    turning: Vector3<f64>,
    /// When the vehicle is lost, s.
    lost: Option<f64>,
}

/// What is known of the loss of one rotor.
struct Loss {
    flown: FlightWithoutRotor,
    hover: Result<RelaxedHover, NoHover>,
    /// The spectral radius about that.
    radius: Option<f64>,
}

impl Loss {
    fn fly_and_analyse(
        scenario: &Scenario,
        certified: &Certified,
        law: &WithoutARotor,
        rotor: usize,
    ) -> Result<Self, ParameterError> {
        let configuration = &scenario.configuration;
        let (mut flown, mut flight) = flown(scenario, certified, rotor)?;
        // About the axis that it came to: the position's feedback leans the law's by some degrees.
        let axis = if flown.lost.is_none() { upwards(&flown.turning, law) } else { law.axis() };
        let drag = scenario.reality.drag.unwrap_or_default();
        let hover = configuration.rotors().map_or(Err(NoHover::Unbalanced), |rotors| {
            RelaxedHover::new(configuration.vehicle(), rotors, &drag, rotor, &axis)
        });
        let period = scenario.timing.period();
        let timing = LoopTiming { period, rotor_lag: scenario.rotor_lag, delay_samples: scenario.delay() / period };
        let radius = hover.as_ref().ok();
        let radius = radius.map(|hover| turning_loop::radius(law, hover.rate, configuration.vehicle(), &timing));
        let settles = radius.is_some_and(|radius| radius < 1.0) || hover == Err(NoHover::Unbalanced);
        if flown.lost.is_none() && !settles {
            flown.lost = lost_after(&mut flight, period);
        }
        Ok(Self { flown, hover, radius })
    }

    /// Whether it is there after [`WATCHED_S`].
    fn is_survived(&self) -> bool {
        self.flown.lost.is_none_or(|lost| lost >= WATCHED_S)
    }

    /// A row of the table, without the rotor's name.
    fn cells(&self) -> [String; 4] {
        let FlightWithoutRotor { height_lost, farthest, lands_from, turning, lost } = &self.flown;
        if let Some(lost) = lost.filter(|_| !self.is_survived()) {
            return [&*format!("lost after {} s", rounded(lost)), "", "", ""].map(str::to_owned);
        }
        let from = if *lands_from > 0.0 { format!("{} m", rounded(*lands_from)) } else { "any height".to_owned() };
        let rate = turning.norm();
        let turns = if rate < HEADING_KEPT_RATE_RAD_PER_S {
            "keeps its heading".to_owned()
        } else {
            format!("{} rad/s", rounded(rate))
        };
        [format!("{} m", rounded(*height_lost)), format!("{} m", rounded(*farthest)), from, turns]
    }

    /// What it lacks, if it lacks anything.
    fn lacks(&self, has_drag: bool) -> Option<String> {
        let lost = self.flown.lost?;
        let drag = if has_drag { "" } else { "; give [drag]: the air may slow it" };
        let land = if lost < WATCHED_S { String::new() } else { format!("; land within {} s", lost.floor()) };
        Some(match (&self.hover, self.radius) {
            (Err(NoHover::TooLittleThrust(share)), _) => {
                format!("too little thrust: two rotors hold {share:.2} of the weight")
            }
            (Err(NoHover::Unbounded), _) => format!("nothing stops it from turning faster{drag}{land}"),
            (Ok(hover), Some(radius)) if radius >= 1.0 => {
                let rate = rounded(hover.rate.abs());
                format!("it turns up to {rate} rad/s, too fast for control.rate, lag and delay{drag}{land}")
            }
            _ => "it does not come back to its place".to_owned(),
        })
    }
}

/// Two significant digits tell what a model knows, and rotors that are alike from others.
fn rounded(value: f64) -> String {
    short(format!("{value:.1e}").parse().unwrap_or(value))
}

/// The lines of a report.
///
/// # Errors
/// If the law refuses the scenario's period.
pub fn lines(scenario: &Scenario, certified: Option<&Certified>) -> Result<String, ParameterError> {
    let configuration = &scenario.configuration;
    let Some(rotors) = configuration.rotors() else {
        return Ok("a rotor gone: no rotors in the file\n".to_owned());
    };
    if let LawParameters::Paper(_) = configuration.law() {
        return Ok(
            "a rotor gone: NOT survived: the paper's law does not look for it, the extended law does\n".to_owned()
        );
    }
    let Some(certified) = certified else { return Ok(String::new()) };
    let mut losses = Vec::new();
    for rotor in 0..rotors.len() {
        if let Some(law) = WithoutARotor::new(configuration, rotor, scenario.timing.period() as f32) {
            losses.push(Loss::fly_and_analyse(scenario, certified, &law, rotor)?);
        }
    }
    let has_drag = scenario.reality.drag.is_some();
    let word = match losses.iter().filter(|loss| !loss.is_survived()).count() {
        0 if losses.iter().any(|loss| loss.flown.lost.is_some()) => "survived if it lands in time",
        0 => "survived",
        lost if lost == losses.len() => "NOT survived",
        _ => "survived of some rotors, NOT of all",
    };
    let lacks = each(losses.iter().map(|loss| loss.lacks(has_drag).into_iter().collect()).collect());
    let lacks = lacks.into_iter().filter_map(|(rotor, lacks)| Some(format!("{rotor}: {}\n", lacks.first()?)));
    let hovers = losses.first().map_or(String::new(), relaxed);
    Ok(format!(
        "a rotor gone (flights of the model, from hover): {word}\n{}{}{hovers}",
        table(&losses),
        lacks.collect::<String>()
    ))
}

fn table(losses: &[Loss]) -> String {
    let head = ["rotor gone", "height lost", "farthest", "lands softly from", "after 10 s"];
    let rows = each(losses.iter().map(|loss| loss.cells().to_vec()).collect());
    let rows = rows.into_iter().map(|(rotor, cells)| [vec![rotor], cells].concat());
    aligned(&std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect::<Vec<_>>())
}

/// What is said of each rotor, with its name; once if it is the same of all.
fn each(said: Vec<Vec<String>>) -> Vec<(String, Vec<String>)> {
    if let [first, rest @ ..] = &said[..]
        && rest.iter().all(|other| other == first)
    {
        return vec![("each".to_owned(), first.clone())];
    }
    (1..).zip(said).map(|(rotor, said)| (format!("rotor {rotor}"), said)).collect()
}

/// The relaxed hover without the first rotor, and the loop about it.
fn relaxed(loss: &Loss) -> String {
    let (Ok(hover), Some(radius)) = (&loss.hover, loss.radius) else { return String::new() };
    let thrusts = hover.thrusts.map(short).join(", ");
    let stable = if radius < 1.0 { "stable" } else { "UNSTABLE" };
    format!(
        "relaxed hover without rotor 1: {} rad/s about an axis {} degrees from z, thrusts {thrusts} N\n\
         turning, small motions (an analysis): spectral radius {radius:.4}, {stable}; it says nothing of how the \
         turning begins, as a rotor at an end of its range pushes one way only\n",
        short(hover.rate.abs()),
        short(hover.axis.z.clamp(-1.0, 1.0).acos().to_degrees())
    )
}

/// Flies the loss of a rotor.
fn flown(
    scenario: &Scenario,
    certified: &Certified,
    rotor: usize,
) -> Result<(FlightWithoutRotor, Flight), ParameterError> {
    let mut model = hover(scenario, Vector3::zeros(), 0.0)?;
    let failure = Failure { rotor, time: FAILURE_S, thrust_left: 0.0 };
    model.reality = Reality { drag: scenario.reality.drag, failure: Some(failure), ..Reality::default() };
    let mut flight = Flight::certified(&model, certified)?;
    let period = scenario.timing.period();
    let mut flown =
        FlightWithoutRotor { height_lost: 0.0, farthest: 0.0, lands_from: 0.0, turning: Vector3::zeros(), lost: None };
    let (mut last, mut left) = (model.initial, None);
    for number in 0..((FAILURE_S + WATCHED_S) / period) as u64 {
        let time = number as f64 * period - FAILURE_S;
        let Ok(tick) = flight.brief_tick() else {
            flown.lost = Some(left.unwrap_or(time));
            return Ok((flown, flight));
        };
        last = tick.state;
        let fallen = -last.position.z;
        if fallen > flown.height_lost {
            flown.height_lost = fallen;
            if -last.velocity.z > SOFT_LANDING_SPEED_M_PER_S {
                flown.lands_from = fallen;
            }
        }
        flown.farthest = flown.farthest.max(last.position.xy().norm());
        left = left.or((last.position.norm() > PLACE_HELD_DISTANCE_M).then_some(time));
    }
    flown.turning = last.angular_velocity;
    let is_there = last.position.norm() < PLACE_HELD_DISTANCE_M && last.velocity.norm() < SPEED_MAX_M_PER_S;
    flown.lost = if is_there { None } else { left.or(Some(WATCHED_S - period)) };
    Ok((flown, flight))
}

/// How long after the failure a flight that was watched is lost, s, if it is within [`WATCHED_MAX_S`].
fn lost_after(flight: &mut Flight, period: f64) -> Option<f64> {
    let ticks = ((WATCHED_MAX_S - WATCHED_S) / period) as u64;
    let is_lost = |flight: &mut Flight| {
        flight.brief_tick().map_or(true, |tick| tick.state.position.norm() > PLACE_HELD_DISTANCE_M)
    };
    (0..ticks).find(|_| is_lost(flight)).map(|tick| WATCHED_S + tick as f64 * period)
}

/// The axis that a body turns about, the end that is up; the law's if it hardly turns.
fn upwards(turning: &Vector3<f64>, law: &WithoutARotor) -> Vector3<f64> {
    turning.try_normalize(HEADING_KEPT_RATE_RAD_PER_S).map_or_else(|| law.axis(), |axis| axis * axis.z.signum())
}

#[cfg(test)]
mod tests;
