//! The plant step of a campaign's flights: no shorter than accuracy needs.
//!
//! A scenario's step is chosen for a single flight, whose log is read tick by tick. A campaign asks each of its flights
//! for a verdict and for metres and seconds; it takes the longest step of at most [`STEP_MAX_S`] that still fits. The
//! error of the method of fourth order is then 5^4 times that of 1 ms; of the paper's flight it is 0.33 um. Rotors that
//! lag, filters and wind are advanced exactly at any step. `cargo run --release -p verification --example halved_steps`
//! shows that no verdict changes with half of it.

use scenario::Scenario;
use scenario::body::ROTATION_PER_STEP_MAX_RAD;

/// The longest step.
pub const STEP_MAX_S: f64 = 5e-3;
/// A quotient this near a whole number is one.
const WHOLE_TOLERANCE: f64 = 1e-6;

/// `scenario` with the longest plant step that fits: the control period, the delay of commands and, with an estimator,
/// the IMU's millisecond are whole numbers of it. A file's own step stays where it is longer.
#[must_use]
pub fn with_longest_step(scenario: &Scenario) -> Scenario {
    let own = scenario.timing.steps_per_tick;
    let fitting = (1..own).find_map(|steps| {
        let changed = divided(scenario, steps)?;
        let (ranges, step) = (&scenario.campaign.ranges, changed.timing.step());
        let turns = step * ranges.rate.max(ranges.yaw_rate).max(scenario.initial.angular_velocity.norm());
        (step <= STEP_MAX_S * (1.0 + WHOLE_TOLERANCE) && turns <= ROTATION_PER_STEP_MAX_RAD).then_some(changed)
    });
    fitting.unwrap_or_else(|| scenario.clone())
}

/// `scenario` with a plant step of so many seconds.
///
/// # Errors
/// Says what does not fit.
pub fn with_step(scenario: &Scenario, step: f64) -> Result<Scenario, String> {
    let period = scenario.timing.period();
    let steps = period / step;
    let whole = steps.round();
    if !((1.0..=1e5).contains(&whole) && (steps - whole).abs() < WHOLE_TOLERANCE * whole) {
        return Err(format!("must be the control period, {period} s, over a whole number up to 1e5, found {step} s"));
    }
    divided(scenario, whole as u32).ok_or_else(|| {
        format!("must leave the delay of commands and the IMU's millisecond whole steps, found {step} s")
    })
}

/// `scenario` with so many plant steps in a control period; none if its delay or its IMU does not fit.
fn divided(scenario: &Scenario, steps: u32) -> Option<Scenario> {
    let mut changed = scenario.clone();
    changed.timing.steps_per_tick = steps;
    let step = changed.timing.step();
    let whole = |time: f64| {
        let ratio = time / step;
        ((ratio - ratio.round()).abs() < WHOLE_TOLERANCE).then_some(ratio.round() as u64)
    };
    changed.delay_steps = whole(scenario.delay())?;
    if scenario.reality.estimator.is_some() {
        whole(1e-3).filter(|steps| *steps > 0)?;
    }
    Some(changed)
}

#[cfg(test)]
mod tests;
