//! A flight's claims, its figures, and the verdict on each.
//!
//! Every flight claims Theorem 1's thrust interval, the file's limits, the box of the filters, and the sharp bounds of
//! its certificate on thrust, torques and rotors, which hold whether or not they fit the limits:
//!
//! ```text
//! m (g - M_p - K_a3) <= T <= m (sqrt(3) M_p + sqrt(K_a12^2 + (K_a3 + g)^2)),   |e_i u_f|, |e_i u_s| <= M_p
//! ```
//!
//! With rotors it claims that none was commanded below what its motor idles at (`least_command`).
//!
//! It claims besides that every inequality of its certificate holds; that its sampled loops are stable with
//! [`LoopMargin::FLYABLE_MIN`]; under the extended law, that a model of it arrives from [far away, fast and upside
//! down](scenario::large_motions); that it reached its reference, position and attitude, within the first 90 % of its
//! duration and stayed near it ([`crate::flight::extremes`] says how near); and that once there it never strayed
//! further than the file's `reference.tolerance`. The paper's own scenario claims the figures of Section VI as well;
//! for any other the errors of its last quarter are reported without a verdict.

use crate::flight::extremes::{FlightExtremes, MRP_TOLERANCE, POSITION_TOLERANCE_M};
use crate::flight::least_command::LeastCommand;
use crate::output::table::{aligned, percent, short};
use controller_core::certificate::Certificate;
use controller_core::certificate::form::Interval;
use scenario::Scenario;
use scenario::large_motions::{Farthest, NotArrived};
use scenario::stability::LoopMargin;
use scenario::verdict::Verdict;
use std::fmt::Write;

/// Section VI: thrust.
pub const PUBLISHED_THRUST_N: (f64, f64) = (3.51, 6.19);
/// Section VI: |torque| about each axis.
pub const PUBLISHED_TORQUE_N_M: [f64; 3] = [0.29, 0.33, 0.48];
/// Section VI: steady-state position error.
pub const PUBLISHED_POSITION_ERROR_M: f64 = 1e-3;
/// By when a flight must have reached its reference, as a fraction of its duration.
pub const REACHED_BY_SHARE: f64 = 0.9;
/// Section VI: steady-state norm of the modified Rodrigues parameters.
pub const PUBLISHED_MRP_ERROR: f64 = 1e-4;
/// One line of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Claim {
    /// Its name.
    pub claim: String,
    /// The requirement; empty without one.
    pub required: String,
    /// The figure of the flight.
    pub flown: String,
    /// Whether it holds; none without a requirement.
    pub holds: Option<bool>,
}

/// The claims about a flight of `scenario`, with its `verdict` and the figures `flown`.
pub fn claims(scenario: &Scenario, verdict: &Verdict, flown: &FlightExtremes) -> Vec<Claim> {
    let published = scenario.is_papers();
    let duration = scenario.timing.duration();
    let steady = format!("steady state, last {} s", short(duration / 4.0));
    let mut claims = vec![
        commands(verdict),
        loops(verdict),
        near(format!("within {POSITION_TOLERANCE_M} m of the reference for good"), flown.position_reached(), duration),
        near(format!("within {MRP_TOLERANCE} of its attitude for good"), flown.attitude_reached(), duration),
        tracking(scenario, flown),
        at_most(
            format!("position error, {steady}"),
            flown.steady_position_error,
            published.then_some(PUBLISHED_POSITION_ERROR_M),
            " m",
        ),
        at_most(format!("MRP error, {steady}"), flown.steady_mrp_error, published.then_some(PUBLISHED_MRP_ERROR), ""),
    ];
    if let Some(flights) = verdict.flights() {
        claims.insert(2, large_motions(&flights));
    }
    if published {
        claims.push(within("thrust, published bound".to_owned(), flown.thrust, PUBLISHED_THRUST_N));
        claims.extend(torques("published bound", &flown.torque, &PUBLISHED_TORQUE_N_M));
    }
    claims.extend(bounds(verdict.certificate(), flown));
    claims.extend(least_command(&flown.least_command));
    let limits = scenario.configuration.limits();
    let thrust_max = Some(f64::from(limits.thrust_max));
    claims.push(at_most("thrust, vehicle's limit".to_owned(), flown.thrust.1, thrust_max, " N"));
    claims.extend(torques("vehicle's limit", &flown.torque, limits.torque_max.map(f64::from).as_ref()));
    if let Some(gains) = scenario.configuration.gains() {
        let claim = "|u_f|, |u_s| per axis, M_p".to_owned();
        claims.push(at_most(claim, flown.filter, Some(f64::from(gains.m_p)), " m/s^2"));
    }
    claims.extend([
        at_most("ticks with a clipped command".to_owned(), flown.clipped as f64, Some(0.0), ""),
        at_most("changes of m*".to_owned(), flown.lift_changes as f64, None, ""),
        at_most("height lost".to_owned(), flown.height_lost, None, " m"),
    ]);
    claims
}

/// The claims about a flight of `scenario` under another law: that it reached its position. Our law's bounds stand
/// beside its figures, without a verdict.
pub fn of_rival(scenario: &Scenario, verdict: &Verdict, flown: &FlightExtremes) -> Vec<Claim> {
    let duration = scenario.timing.duration();
    let own =
        near(format!("within {POSITION_TOLERANCE_M} m of the reference for good"), flown.position_reached(), duration);
    let reported = claims(scenario, verdict, flown).into_iter().skip(3).map(|claim| Claim { holds: None, ..claim });
    std::iter::once(own).chain(reported).collect()
}

/// Whether every inequality of the certificate holds.
fn commands(verdict: &Verdict) -> Claim {
    let failing = verdict.certificate().inequalities().find(|inequality| !inequality.holds());
    Claim {
        claim: "commands, certificate".to_owned(),
        required: "every inequality".to_owned(),
        flown: failing.map_or_else(|| "certified".to_owned(), |inequality| format!("fails in {inequality}")),
        holds: Some(failing.is_none()),
    }
}

/// How far the flight strayed from its reference on the way. One that was never there fails by arriving too late.
fn tracking(scenario: &Scenario, flown: &FlightExtremes) -> Claim {
    let tolerance = scenario.tolerance;
    Claim {
        claim: "farthest from the reference, once there".to_owned(),
        required: format!("<= {} m", short(tolerance)),
        flown: flown.strayed.map_or_else(
            || "never there".to_owned(),
            |(greatest, time)| format!("{} m, at {} s", short(greatest), short(time)),
        ),
        holds: flown.strayed.map(|(greatest, _)| greatest <= tolerance),
    }
}

/// Whether the sampled loops are stable, with margins.
fn loops(verdict: &Verdict) -> Claim {
    let LoopMargin { gain, delay } = LoopMargin::FLYABLE_MIN;
    let margins = verdict.loops().iter().filter_map(|report| report.margins);
    let least = margins.fold((f64::INFINITY, f64::INFINITY), |(gain, delay), margins| {
        (margins.gain_up.min(gain), margins.delay.min(delay))
    });
    let spare = |gain: f64, delay: f64| format!("{}, {} ms", short(gain), short(1e3 * delay));
    let lacking = verdict.lacking();
    Claim {
        claim: "sampled loops, gain and delay margins".to_owned(),
        required: format!(">= {}", spare(gain, delay)),
        flown: lacking.map_or_else(|| spare(least.0, least.1), |lack| lack.to_string()),
        holds: Some(lacking.is_none()),
    }
}

/// Whether a model of the vehicle arrives from far away, fast and upside down.
fn large_motions(flights: &Result<Farthest, NotArrived>) -> Claim {
    Claim {
        claim: "large motions, model flights".to_owned(),
        required: "all arrive".to_owned(),
        flown: flights.map_or_else(
            |not_arrived| not_arrived.to_string(),
            |Farthest { distance, .. }| format!("at most {} m off", short(distance)),
        ),
        holds: Some(flights.is_ok()),
    }
}

/// Whether a flight reached its reference, position and attitude, in time and for good.
pub fn reached(scenario: &Scenario, flown: &FlightExtremes) -> bool {
    let latest = REACHED_BY_SHARE * scenario.timing.duration();
    [flown.position_reached(), flown.attitude_reached()].iter().all(|since| since.is_some_and(|since| since <= latest))
}

fn near(claim: String, since: Option<f64>, duration: f64) -> Claim {
    let latest = REACHED_BY_SHARE * duration;
    Claim {
        claim,
        required: format!("<= {} s", short(latest)),
        flown: since.map_or_else(|| "never".to_owned(), |since| format!("{} s", short(since))),
        holds: Some(since.is_some_and(|since| since <= latest)),
    }
}

/// The certificate's bounds. They hold for every configuration, whether or not they fit the limits.
fn bounds(certificate: &Certificate, flown: &FlightExtremes) -> Vec<Claim> {
    let interval = |Interval { min: least, max: greatest }: Interval| (least, greatest);
    let printed = certificate.paper().map(|paper| paper.printed.thrust);
    let printed = printed.map(|thrust| within("thrust, Theorem 1".to_owned(), flown.thrust, interval(thrust)));
    let mut claims: Vec<Claim> = printed.into_iter().collect();
    claims.push(within("thrust, sharp bound".to_owned(), flown.thrust, interval(certificate.thrust())));
    claims.extend(torques("sharp bound", &flown.torque, certificate.torque().as_ref()));
    for (rotor, flown) in flown.rotors.iter().enumerate() {
        let bound = certificate.rotor(rotor);
        let claim = |bound| within(format!("rotor {}, sharp bound", rotor + 1), *flown, interval(bound));
        claims.extend(bound.map(claim));
    }
    claims
}

/// Whether no rotor was commanded below what motors idle at, if there are rotors.
fn least_command(flown: &LeastCommand) -> Option<Claim> {
    let (least, idle) = (flown.least()?, flown.idle());
    Some(Claim {
        claim: "least rotor command, what motors idle at".to_owned(),
        required: format!(">= {}", percent(idle)),
        flown: percent(least),
        holds: Some(least >= idle),
    })
}

fn torques(what: &str, flown: &[f64; 3], limits: &[f64; 3]) -> Vec<Claim> {
    let axes = ["x", "y", "z"].into_iter().zip(flown.iter().zip(limits));
    let claim = |(axis, (value, limit)): (&str, (&f64, &f64))| {
        at_most(format!("|torque {axis}|, {what}"), *value, Some(*limit), " N m")
    };
    axes.map(claim).collect()
}

fn at_most(claim: String, value: f64, limit: Option<f64>, unit: &str) -> Claim {
    Claim {
        claim,
        required: limit.map_or(String::new(), |limit| format!("<= {}{unit}", short(limit))),
        flown: format!("{}{unit}", short(value)),
        holds: limit.map(|limit| value <= limit),
    }
}

fn within(claim: String, flown: (f64, f64), required: (f64, f64)) -> Claim {
    let interval = |(least, greatest): (f64, f64)| format!("[{}, {}] N", short(least), short(greatest));
    let holds = flown.0 >= required.0 && flown.1 <= required.1;
    Claim { claim, required: interval(required), flown: interval(flown), holds: Some(holds) }
}

/// Whether every claim that has a verdict holds.
pub fn all_hold(claims: &[Claim]) -> bool {
    claims.iter().all(|claim| claim.holds != Some(false))
}

/// The verdict on a flight in one line: which claims fail, by their names.
pub fn verdict_line(claims: &[Claim]) -> String {
    let failing: Vec<&str> =
        claims.iter().filter(|claim| claim.holds == Some(false)).map(|claim| claim.claim.as_str()).collect();
    if failing.is_empty() {
        "every claim holds".to_owned()
    } else {
        format!("NOT every claim holds ({})", failing.join("; "))
    }
}

/// The claims as an aligned table for a terminal.
pub fn table(claims: &[Claim]) -> String {
    let head = ["claim", "required", "flown", "verdict"].map(str::to_owned).to_vec();
    let row = |c: &Claim| vec![c.claim.clone(), c.required.clone(), c.flown.clone(), verdict(c).to_owned()];
    aligned(&std::iter::once(head).chain(claims.iter().map(row)).collect::<Vec<_>>())
}

/// The claims as a Markdown table.
pub fn markdown(claims: &[Claim]) -> String {
    let head = "| claim | required | flown | verdict |\n|---|---|---|---|\n".to_owned();
    claims.iter().fold(head, |mut text, claim| {
        // A bar inside a cell would end it.
        let name = claim.claim.replace('|', "\\|");
        let _ = writeln!(text, "| {name} | {} | {} | {} |", claim.required, claim.flown, verdict(claim));
        text
    })
}

fn verdict(claim: &Claim) -> &'static str {
    match claim.holds {
        Some(true) => "holds",
        Some(false) => "FAILS",
        None => "reported",
    }
}

#[cfg(test)]
mod tests;
