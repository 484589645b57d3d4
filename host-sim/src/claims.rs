//! What a flight claims, what it showed, and whether the two agree.
//!
//! Every flight claims Theorem 1's thrust interval, the file's limits, the box of the filters, and the sharp bounds of its
//! certificate on thrust, torques and rotors, which hold whether or not they fit the limits:
//!
//! ```text
//! m (g - M_p - K_a3) <= T <= m (sqrt(3) M_p + sqrt(K_a12^2 + (K_a3 + g)^2)),   |e_i u_f|, |e_i u_s| <= M_p
//! ```
//!
//! The paper's own scenario claims the figures of Section VI besides. For any other, tracking is reported without a
//! verdict. "Steady state" is the last quarter of the flight: of the paper's 40 s, the last 10.

use crate::flight::Tick;
use crate::scenario::Scenario;
use crate::table::{aligned, short};
use controller_core::certificate::{Certificate, Form};
use std::fmt::Write;

/// Section VI: thrust, N.
pub const PUBLISHED_THRUST: (f64, f64) = (3.51, 6.19);
/// Section VI: |torque| about each axis, N m.
pub const PUBLISHED_TORQUE: [f64; 3] = [0.29, 0.33, 0.48];
/// Section VI: steady-state position error, m.
pub const PUBLISHED_POSITION_ERROR: f64 = 1e-3;
/// Section VI: steady-state norm of the modified Rodrigues parameters.
pub const PUBLISHED_MRP_ERROR: f64 = 1e-4;
/// Extremes of no value at all.
const NOTHING_YET: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// The extremes of a flight, gathered tick by tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Flown {
    steady_from_us: u64,
    last_sign: Option<f32>,
    start_height: Option<f64>,
    /// Ticks seen.
    pub ticks: u64,
    /// Least and greatest commanded thrust, N.
    pub thrust: (f64, f64),
    /// Greatest commanded |torque| about each body axis, N m.
    pub torque: [f64; 3],
    /// Least and greatest thrust commanded of each rotor, N; empty without rotors.
    pub rotors: Vec<(f64, f64)>,
    /// Greatest component of u_f and u_s, m/s^2.
    pub filter: f64,
    /// Ticks at which the plant clipped a command.
    pub clipped: u64,
    /// Changes of m*.
    pub lift_changes: u64,
    /// Greatest position error in steady state, m.
    pub steady_position_error: f64,
    /// Greatest norm of the modified Rodrigues parameters in steady state.
    pub steady_mrp_error: f64,
    /// Start minus lowest height, m.
    pub height_lost: f64,
}

/// One line of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Claim {
    /// What it is about.
    pub claim: String,
    /// What must be; empty where nothing must.
    pub required: String,
    /// What was.
    pub flown: String,
    /// Whether it holds; none where nothing is required.
    pub holds: Option<bool>,
}

impl Flown {
    /// Nothing seen yet of a flight of `scenario`.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let timing = &scenario.timing;
        Self {
            steady_from_us: (timing.ticks - timing.ticks / 4) * timing.period_us,
            last_sign: None,
            start_height: None,
            ticks: 0,
            thrust: NOTHING_YET,
            torque: [0.0; 3],
            rotors: Vec::new(),
            filter: 0.0,
            clipped: 0,
            lift_changes: 0,
            steady_position_error: 0.0,
            steady_mrp_error: 0.0,
            height_lost: 0.0,
        }
    }

    /// Takes one tick into account.
    pub fn observe(&mut self, tick: &Tick) {
        let (wrench, diagnostics) = (&tick.wrench, &tick.diagnostics);
        let thrust = f64::from(wrench.thrust);
        self.ticks += 1;
        self.thrust = (self.thrust.0.min(thrust), self.thrust.1.max(thrust));
        for (greatest, torque) in self.torque.iter_mut().zip(wrench.torque.iter()) {
            *greatest = greatest.max(f64::from(torque.abs()));
        }
        self.filter = self.filter.max(f64::from(diagnostics.filtered.amax().max(diagnostics.intermediate.amax())));
        // While the first command is on its way there is none.
        self.rotors.resize(self.rotors.len().max(tick.rotor_thrusts.len()), NOTHING_YET);
        for (extremes, thrust) in self.rotors.iter_mut().zip(&tick.rotor_thrusts) {
            let thrust = f64::from(*thrust);
            *extremes = (extremes.0.min(thrust), extremes.1.max(thrust));
        }
        self.clipped += u64::from(tick.clipping.any());
        self.lift_changes += u64::from(self.last_sign.is_some_and(|sign| sign != diagnostics.lift_sign));
        self.last_sign = Some(diagnostics.lift_sign);
        let height = tick.state.position.z;
        self.height_lost = self.height_lost.max(*self.start_height.get_or_insert(height) - height);
        if tick.time_us >= self.steady_from_us {
            let position_error = (tick.state.position - tick.reference.position.map(f64::from)).norm();
            self.steady_position_error = self.steady_position_error.max(position_error);
            self.steady_mrp_error = self.steady_mrp_error.max(f64::from(diagnostics.mrp.norm()));
        }
    }
}

/// The claims about a flight of `scenario` that showed `flown`.
#[must_use]
pub fn claims(scenario: &Scenario, flown: &Flown) -> Vec<Claim> {
    let published = scenario.is_papers();
    let steady = format!("steady state (last {} s)", short(scenario.timing.duration() / 4.0));
    let mut claims = vec![
        at_most(
            format!("position error, {steady}"),
            flown.steady_position_error,
            published.then_some(PUBLISHED_POSITION_ERROR),
            " m",
        ),
        at_most(format!("MRP error, {steady}"), flown.steady_mrp_error, published.then_some(PUBLISHED_MRP_ERROR), ""),
    ];
    if published {
        claims.push(within("thrust, published bound".to_owned(), flown.thrust, PUBLISHED_THRUST));
        claims.extend(torques("published bound", &flown.torque, &PUBLISHED_TORQUE));
    }
    if let Ok(certificate) = Certificate::new(&scenario.configuration) {
        claims.extend(bounds(&certificate, flown));
    }
    let limits = scenario.configuration.limits();
    let thrust_max = Some(f64::from(limits.thrust_max));
    claims.push(at_most("thrust, vehicle's limit".to_owned(), flown.thrust.1, thrust_max, " N"));
    claims.extend(torques("vehicle's limit", &flown.torque, limits.torque_max.map(f64::from).as_ref()));
    let m_p = f64::from(scenario.configuration.gains().m_p);
    claims.extend([
        at_most("|u_f|, |u_s| per axis, M_p".to_owned(), flown.filter, Some(m_p), " m/s^2"),
        at_most("ticks with a clipped command".to_owned(), flown.clipped as f64, Some(0.0), ""),
        at_most("changes of m*".to_owned(), flown.lift_changes as f64, None, ""),
        at_most("height lost".to_owned(), flown.height_lost, None, " m"),
    ]);
    claims
}

/// What the certificate bounds. Its bounds hold for every configuration, whether or not they fit the limits.
fn bounds(certificate: &Certificate, flown: &Flown) -> Vec<Claim> {
    let interval = |form: &Form| (form.thrust.least, form.thrust.greatest);
    let (printed, sharp) = (&certificate.printed, &certificate.sharp);
    let mut claims = vec![
        within("thrust, Theorem 1".to_owned(), flown.thrust, interval(printed)),
        within("thrust, sharp bound".to_owned(), flown.thrust, interval(sharp)),
    ];
    claims.extend(torques("sharp bound", &flown.torque, sharp.torque.as_ref()));
    for (number, (report, flown)) in (1..).zip(certificate.rotors.iter().zip(&flown.rotors)) {
        let demand = &report.demand;
        claims.push(within(format!("rotor {number}, sharp bound"), *flown, (demand.least, demand.greatest)));
    }
    claims
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
#[must_use]
pub fn all_hold(claims: &[Claim]) -> bool {
    claims.iter().all(|claim| claim.holds != Some(false))
}

/// The claims as an aligned table for a terminal.
#[must_use]
pub fn table(claims: &[Claim]) -> String {
    let head = ["claim", "required", "flown", "verdict"].map(str::to_owned).to_vec();
    let row = |c: &Claim| vec![c.claim.clone(), c.required.clone(), c.flown.clone(), verdict(c).to_owned()];
    aligned(&std::iter::once(head).chain(claims.iter().map(row)).collect::<Vec<_>>())
}

/// The claims as a Markdown table.
#[must_use]
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
mod tests {
    use super::*;
    use crate::flight::Flight;

    fn flown(scenario: &Scenario, ticks: u64) -> Flown {
        let mut flight = Flight::new(scenario).unwrap();
        let mut flown = Flown::new(scenario);
        for _ in 0..ticks {
            flown.observe(&flight.tick().unwrap());
        }
        flown
    }

    #[test]
    fn theorem_1_gives_the_papers_published_interval() {
        let thrust = Certificate::new(&Scenario::paper().unwrap().configuration).unwrap().printed.thrust;
        assert!((thrust.least - 3.51).abs() < 0.005 && (thrust.greatest - 6.19).abs() < 0.005, "{thrust:?}");
    }

    #[test]
    fn only_the_papers_scenario_carries_the_published_figures() {
        let paper = Scenario::paper().unwrap();
        let renamed = Scenario { name: "mine".into(), ..paper.clone() };
        let mut other = paper.clone();
        other.initial.position.x += 1.0;
        let count = |scenario: &Scenario| {
            let claims = claims(scenario, &flown(scenario, 10));
            claims.iter().filter(|claim| claim.claim.contains("published")).count()
        };
        assert_eq!((count(&paper), count(&renamed), count(&other)), (4, 4, 0));
    }

    #[test]
    fn each_claim_can_fail() {
        let paper = Scenario::paper().unwrap();
        let good = flown(&paper, paper.timing.ticks);
        assert!(all_hold(&claims(&paper, &good)), "{}", table(&claims(&paper, &good)));
        let broken = [
            Flown { steady_position_error: 1.1e-3, ..good.clone() },
            Flown { steady_mrp_error: 1.1e-4, ..good.clone() },
            Flown { thrust: (3.5, 6.0), ..good.clone() },
            Flown { thrust: (3.6, 6.2), ..good.clone() },
            Flown { torque: [0.3, 0.1, 0.1], ..good.clone() },
            Flown { torque: [0.1, 0.34, 0.1], ..good.clone() },
            Flown { torque: [0.1, 0.1, 0.49], ..good.clone() },
            Flown { filter: 2.000_001, ..good.clone() },
            Flown { clipped: 1, ..good.clone() },
        ];
        for flown in broken {
            assert!(!all_hold(&claims(&paper, &flown)), "{flown:?}");
        }
    }

    #[test]
    fn what_a_weak_vehicle_cannot_deliver_is_counted_and_fails() {
        let text = crate::scenario::PAPER.replace("thrust_max = 7.0", "thrust_max = 4.9");
        let weak = Scenario::parse(&text, "weak").unwrap();
        let seen = flown(&weak, weak.timing.ticks);
        assert!(seen.clipped > 100, "{seen:?}");
        let failed: Vec<String> =
            claims(&weak, &seen).into_iter().filter(|c| c.holds == Some(false)).map(|c| c.claim).collect();
        assert_eq!(failed, ["thrust, vehicle's limit", "ticks with a clipped command"]);
    }

    #[test]
    fn steady_state_is_the_last_quarter() {
        let paper = Scenario::paper().unwrap();
        let (before, after) = (flown(&paper, 3000), flown(&paper, 3001));
        assert_eq!((before.steady_position_error, before.steady_mrp_error), (0.0, 0.0));
        assert!(after.steady_position_error > 0.0);
        // It fell from 10 m, upside down, by what Table I's gains cannot prevent.
        assert!((22.0..25.0).contains(&before.height_lost), "{}", before.height_lost);
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [(0.206, "0.206"), (6.187_53, "6.188"), (2.0, "2"), (1.234e-5, "1.23e-5"), (0.0, "0")] {
            assert_eq!(short(value), text);
        }
    }
}
