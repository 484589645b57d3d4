//! What a log cannot tell, and what to fly to learn it.
//!
//! Three ways to be refused. A vehicle that was not *moved* is moved by its own noise alone, and noise that feeds back
//! passes for knowledge: so body rates and speeds must have been there to begin with. A quantity whose interval is too
//! wide is not known. And numbers that no one vehicle has are of none: bench and flight that contradict each other,
//! rotors that are nothing like the file's or answer before they are asked.

use super::flight_log::FlightLog;
use super::quantities::{COVERAGE, Quantities, Quantity};
use crate::table::short;

/// The shortest flight, s.
const SHORTEST: f64 = 20.0;
/// Body rates that a manoeuvre has and hovering has not, root mean square, rad/s: twice what noise alone turns a
/// hovering vehicle by.
const TURNING: f64 = 0.025;
/// Speeds asked for that show drag, across and along the vertical, root mean square about their mean, m/s.
const MOVING: [f64; 3] = [0.25, 0.25, 0.08];

/// The thrust scales that are believed: beyond them the rotors are others, or the log's thrust is not the commanded
/// one.
const SCALES: [f64; 2] = [0.3, 3.0];

/// What is missing of a flight, a line each; empty for a flight that can tell.
#[must_use]
pub fn unmoved(log: &FlightLog) -> Vec<String> {
    let seconds = log.moments.len() as f64 * log.period;
    if seconds < SHORTEST {
        return vec![format!(
            "the flight: {} s without a gap, at least {SHORTEST} are needed: fly longer, and let no pose or record be lost",
            short(seconds)
        )];
    }
    let spread = |of: &dyn Fn(usize) -> f64| {
        let count = log.moments.len() as f64;
        let mean = (0..log.moments.len()).map(of).sum::<f64>() / count;
        ((0..log.moments.len()).map(|at| (of(at) - mean).powi(2)).sum::<f64>() / count).sqrt()
    };
    let mut missing = Vec::new();
    let turns = [
        ("inertia x, centre of mass y", "to the left and to the right"),
        ("inertia y, centre of mass x", "forwards and backwards"),
        ("inertia z", "with turns of the heading"),
    ];
    for (axis, (what, fly)) in turns.into_iter().enumerate() {
        let found = spread(&|at| log.moments[at].angular_velocity[axis]);
        if found < TURNING {
            missing.push(format!(
                "{what}: body rates of {} rad/s (root mean square), at least {TURNING} are needed: fly quick steps {fly}",
                short(found)
            ));
        }
    }
    for (axis, (name, least)) in ["x", "y", "z"].into_iter().zip(MOVING).enumerate() {
        let along = |at: usize| {
            let moment = &log.moments[at];
            moment.attitude.inverse_transform_vector(&moment.reference_velocity)[axis]
        };
        let found = spread(&along);
        if found < least {
            let fly =
                if axis == 2 { "climb and sink by a metre or more" } else { "fly there and back by a metre or more" };
            missing.push(format!(
                "drag {name}: speeds of {} m/s along the body's {name} (root mean square), at least {least} are needed: {fly}",
                short(found)
            ));
        }
    }
    missing
}

/// What is not known well enough to be written, or is no vehicle's, a line each.
#[must_use]
pub fn unknown(told: &Quantities) -> Vec<String> {
    if let Some(contradiction) = &told.contradiction {
        return vec![contradiction.clone()];
    }
    let [least, greatest] = SCALES;
    let scale = told.thrust_scale.value;
    if !(least..=greatest).contains(&scale) {
        return vec![format!(
            "thrust scale: {} of what the file's rotors give, from {least} to {greatest} is believed: see that the log's thrust is what the rotors were asked for, N, and \
             that mass and rotors are this vehicle's",
            short(scale)
        )];
    }
    if told.lag.interval[1] <= 0.0 {
        return vec![
            "lag: rotors would answer before they are asked: see that commands and body rates in the log are of the same ticks, or fly longer"
                .to_owned(),
        ];
    }
    let relative = |quantity: &Quantity| COVERAGE * quantity.uncertainty / quantity.value.abs();
    let absolute = |quantity: &Quantity| COVERAGE * quantity.uncertainty;
    let calm = "fly in calmer air, or longer";
    let quick = "fly quicker and more varied steps about this axis, or longer";
    // As much as the law's own estimate of the thrust makes up for.
    let mut rows = vec![("thrust scale over mass", relative(&told.scale_over_mass), 0.2, "of it", calm)];
    for (name, inertia) in ["inertia x", "inertia y", "inertia z"].into_iter().zip(&told.inertia_over_scale) {
        rows.push((name, relative(inertia), 0.2, "of it", quick));
    }
    rows.push(("lag and delay together", absolute(&told.whole_delay), 0.005, "s", quick));
    for (name, centre) in ["centre of mass x", "centre of mass y"].into_iter().zip(&told.centre_of_mass) {
        rows.push((name, absolute(centre), 0.003, "m", calm));
    }
    let wide = rows.into_iter().filter(|(_, found, most, ..)| found.is_nan() || found > most);
    wide.map(|(name, found, most, unit, fly)| {
        format!("{name}: known to +- {} {unit}, at most {most} is allowed: {fly}", short(found))
    })
    .collect()
}
