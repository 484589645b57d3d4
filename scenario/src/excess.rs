//! A reference that is too fast for its vehicle under the paper's law: where it asks for most, and how much more slowly
//! it certifies. The extended law's is judged [along itself](crate::along).

use crate::file::Scenario;
use crate::path::Place;
use crate::trajectory::stretch::{stretch, stretched};
use controller_core::certificate::Certificate;
use controller_core::reference::{Reference, ReferenceBounds};
use std::fmt;

/// The greatest stretch that is looked for, and how finely.
const STRETCH_MAX: f64 = 50.0;
const HALVINGS_MAX: u32 = 12;
/// Instants looked at.
const INSTANTS_CHECKED: u64 = 20_000;

/// How a reference exceeds what its vehicle can be certified for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excess {
    /// So many times as slowly it certifies.
    pub stretch: f64,
    /// Where it asks for most.
    pub at: Place,
    /// Of what.
    pub of: &'static str,
}

impl Excess {
    /// Of a scenario of the paper's law that is not certified, if that is for its reference: none where the reference
    /// at rest would not help.
    #[must_use]
    pub fn find(scenario: &Scenario) -> Option<Self> {
        scenario.configuration.paper()?;
        let own = scenario.trajectory.bounds();
        if certifies(scenario, &own) {
            return None;
        }
        let allowed = allowed(scenario, &own)?;
        let end = scenario.timing.ticks * scenario.timing.period_us;
        let (at, of) = (0..=INSTANTS_CHECKED)
            .map(|i| end / INSTANTS_CHECKED * i)
            .map(|time| (time, most(&scenario.trajectory.at(time), &allowed)))
            .max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0))
            .map(|(time, (_, of))| (time, of))?;
        let position = scenario.trajectory.at(at).position.map(f64::from);
        // To be read and typed in, so not less than what was found.
        let stretch = (stretch(&own, &allowed) * 100.0).ceil() / 100.0;
        Some(Self { stretch, at: Place { position, time: at as f64 * 1e-6 }, of })
    }
}

/// Bounds that certify: those of the reference flown as slowly as it takes.
fn allowed(scenario: &Scenario, own: &ReferenceBounds) -> Option<ReferenceBounds> {
    let (mut fails, mut holds) = (1.0_f64, STRETCH_MAX);
    for _ in 0..HALVINGS_MAX {
        let middle = (fails * holds).sqrt();
        if certifies(scenario, &stretched(own, middle)) { holds = middle } else { fails = middle }
    }
    Some(stretched(own, holds)).filter(|bounds| certifies(scenario, bounds))
}

/// Whether the scenario's vehicle and gains are certified for references within `bounds`.
fn certifies(scenario: &Scenario, bounds: &ReferenceBounds) -> bool {
    let configuration = scenario.configuration.with_bounds(*bounds);
    configuration
        .and_then(|configuration| Certificate::new(&configuration))
        .is_ok_and(|certificate| certificate.holds())
}

/// By how much an instant alone would have to be stretched, and for what.
fn most(reference: &Reference, allowed: &ReferenceBounds) -> (f64, &'static str) {
    const BOUND_NAMES: [&str; ReferenceBounds::COUNT] = [
        "horizontal speed",
        "horizontal acceleration",
        "vertical acceleration",
        "jerk",
        "snap",
        "heading rate",
        "heading acceleration",
    ];
    let Reference { velocity, acceleration, jerk, snap, heading, .. } = reference;
    let values = [
        velocity.xy().norm(),
        acceleration.xy().norm(),
        acceleration.z.abs(),
        jerk.norm(),
        snap.norm(),
        heading.rate().abs(),
        heading.second_derivative().norm(),
    ];
    let each = BOUND_NAMES.into_iter().enumerate().map(|(number, name)| {
        let mut alone = [0.0; ReferenceBounds::COUNT];
        alone[number] = values[number];
        (stretch(&ReferenceBounds::from_values(alone), allowed), name)
    });
    each.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, ""))
}

impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { stretch, at, of } = self;
        write!(f, "too fast for this vehicle, most of all in {of} at {at}; {stretch:.2} times as slowly it certifies")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eight(seconds: f64) -> Scenario {
        let rows: String = (0..=100)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / 100.0;
                format!("{},{},{},2\n", seconds * f64::from(i) / 100.0, 2.0 * angle.sin(), (2.0 * angle).sin())
            })
            .collect();
        let hummingbird = include_str!("../../vehicles/hummingbird-paper-law.toml");
        let (head, _) = hummingbird.split_once("\n[reference]").unwrap();
        let text = format!("{head}\n[reference]\nkind = \"trajectory\"\ndata = '''\nt,x,y,z\n{rows}'''\n");
        Scenario::parse(&text, "eight").unwrap()
    }

    #[test]
    fn a_reference_stretched_by_what_is_said_certifies_and_by_less_it_does_not() {
        assert_eq!(Excess::find(&eight(20.0)), None);
        let excess = Excess::find(&eight(2.0)).expect("too fast");
        assert!(excess.stretch > 1.1 && excess.at.time > 0.0, "{excess}");
        // The path is fitted to the rows anew, and begins a little differently.
        assert_eq!(Excess::find(&eight(2.0 * 1.1 * excess.stretch)), None, "{excess}");
        assert!(Excess::find(&eight(2.0 * 0.8 * excess.stretch)).is_some(), "{excess}");
    }
}
