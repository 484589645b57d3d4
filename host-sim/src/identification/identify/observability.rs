//! Quantities that are not observable in a log, and what to fly to observe them.
//!
//! A log is refused for three reasons. Without *excitation* only noise moves the vehicle, and feedback of noise
//! biases the fit, so body rates and speeds must reach a least value. A quantity whose interval is too wide is not
//! known. Numbers that contradict each other belong to no vehicle: bench against flight, a thrust scale far from the
//! file's, or rotors that answer before their command.

use super::flight_log::FlightLog;
use super::quantities::{Quantities, Quantity};
use crate::output::table::short;

/// Three of the parts that uncertainties are known from, as a board's recorder holds.
const FLIGHT_MIN_S: f64 = 15.0;
/// Root mean square: twice the rates that noise alone causes in hover.
const BODY_RATE_MIN_RAD_PER_S: f64 = 0.025;
/// Reference speeds along body x, y, z, root mean square about their mean: drag shows from there on.
const SPEED_MIN_M_PER_S: [f64; 3] = [0.25, 0.25, 0.08];

/// Plausible thrust scales: beyond them the rotors are others, or the log's thrust is not the commanded one.
const THRUST_SCALE_RANGE: [f64; 2] = [0.3, 3.0];

/// The missing excitation of a flight, a line each; empty if every quantity is excited.
pub fn unexcited(log: &FlightLog) -> Vec<String> {
    let seconds = log.seconds();
    if seconds < FLIGHT_MIN_S {
        return vec![format!(
            "the flight: {} s without a gap, at least {FLIGHT_MIN_S} are needed: fly longer, and lose no pose or record",
            short(seconds)
        )];
    }
    let deviation = |of: &dyn Fn(usize) -> f64| {
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
        let found = deviation(&|at| log.moments[at].angular_velocity[axis]);
        if found < BODY_RATE_MIN_RAD_PER_S {
            missing.push(format!(
                "{what}: body rates of {} rad/s (root mean square), at least {BODY_RATE_MIN_RAD_PER_S} are needed: fly quick \
                 steps {fly}",
                short(found)
            ));
        }
    }
    for (axis, (name, least)) in ["x", "y", "z"].into_iter().zip(SPEED_MIN_M_PER_S).enumerate() {
        let along = |at: usize| {
            let moment = &log.moments[at];
            moment.attitude.inverse_transform_vector(&moment.reference_velocity)[axis]
        };
        let found = deviation(&along);
        if found < least {
            let fly =
                if axis == 2 { "climb and sink by a metre or more" } else { "fly there and back by a metre or more" };
            missing.push(format!(
                "drag {name}: speeds of {} m/s along the body's {name} (root mean square), at least {least} are \
                 needed: {fly}",
                short(found)
            ));
        }
    }
    missing
}

/// The requirement on a quantity: its name, itself, how wide its interval may be, of itself or as it stands, and what
/// to fly for a narrower one.
type Asked<'q> = (&'static str, &'q Quantity, f64, &'static str, &'static str);

fn asked(identified: &Quantities) -> [Asked<'_>; 7] {
    let steady = "fly in calmer air, or longer";
    let quick = "fly quicker and more varied steps about this axis, or longer";
    let [x, y, z] = &identified.inertia_over_scale;
    let [forward, left] = &identified.centre_of_mass;
    // The law's own thrust estimate compensates 20 %.
    [
        ("thrust scale over mass", &identified.scale_over_mass, 0.2, "of it", steady),
        ("inertia x", x, 0.2, "of it", quick),
        ("inertia y", y, 0.2, "of it", quick),
        ("inertia z", z, 0.2, "of it", quick),
        ("lag and delay together", &identified.whole_delay, 0.005, "s", quick),
        ("centre of mass x", forward, 0.003, "m", steady),
        ("centre of mass y", left, 0.003, "m", steady),
    ]
}

/// How far to either side the interval of a quantity reaches, as its limit counts.
fn reach(identified: &Quantities, (_, quantity, _, unit, _): &Asked<'_>) -> f64 {
    let wide = identified.coverage * quantity.uncertainty;
    if *unit == "of it" { wide / quantity.value.abs() } else { wide }
}

/// The quantities that are known of a flight that does not tell all of them, each with its interval; none if what it
/// tells is contradictory or implausible.
pub fn known(identified: &Quantities) -> Vec<String> {
    let plausible = (THRUST_SCALE_RANGE[0]..=THRUST_SCALE_RANGE[1]).contains(&identified.thrust_scale.value);
    if identified.contradiction.is_some() || !plausible || identified.lag.interval[1] <= 0.0 {
        return vec![];
    }
    let rows = asked(identified);
    let narrow = rows.iter().filter(|row| reach(identified, row) <= row.2);
    let written = narrow.map(|(name, quantity, ..)| {
        let [least, greatest] = quantity.interval.map(short);
        let over = if name.starts_with("inertia") { " over thrust scale" } else { "" };
        format!("{name}{over} {} ({least} to {greatest})", short(quantity.value))
    });
    written.collect()
}

/// The quantities that are too uncertain or implausible to be written, a line each.
pub fn unobservable(identified: &Quantities) -> Vec<String> {
    if let Some(contradiction) = &identified.contradiction {
        return vec![contradiction.clone()];
    }
    let [least, greatest] = THRUST_SCALE_RANGE;
    let scale = identified.thrust_scale.value;
    if !(least..=greatest).contains(&scale) {
        return vec![format!(
            "thrust scale: must be from {least} to {greatest}, found {}: see that the log's thrust is the commanded \
             one, N, and that mass and rotors are this vehicle's",
            short(scale)
        )];
    }
    if identified.lag.interval[1] <= 0.0 {
        return vec![
            "lag: rotors would answer before their command: see that commands and body rates in the log are of the \
             same ticks, or fly longer"
                .to_owned(),
        ];
    }
    let rows = asked(identified);
    let wide = rows.iter().filter(|row| reach(identified, row).is_nan() || reach(identified, row) > row.2);
    wide.map(|row| {
        let (name, _, most, unit, fly) = row;
        format!("{name}: known to +- {} {unit}, at most {most} is allowed: {fly}", short(reach(identified, row)))
    })
    .collect()
}
