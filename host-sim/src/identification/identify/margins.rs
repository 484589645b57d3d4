//! The margins of certificate and sampled loops within the uncertainty of a vehicle's numbers.
//!
//! Every margin three times: with the file's numbers, with those identified, and in the worst corner of the intervals,
//! linearised: from the identified margin, what it loses from one end or the other of each interval alone, all of it
//! together. Corners are far out: not every number is at its worst end at once.

use super::output::{Values, rewritten};
use super::quantities::{Quantities, Quantity};
use crate::output::table::{aligned, percent, short};
use scenario::Scenario;
use scenario::stability::LoopMargin;
use scenario::verdict::Verdict;

/// One margin of a scenario, and the least that it may be.
#[derive(Debug, Clone, PartialEq)]
struct Margin {
    name: String,
    kind: Kind,
    value: f64,
}

/// The kind of a margin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// An inequality's margin, as a share of the bound.
    Inequality,
    /// By which factor the gain of a loop may be wrong.
    Gain,
    /// How much later, s, a loop may act.
    Delay,
}

impl Kind {
    fn least(self) -> f64 {
        match self {
            Self::Inequality => 0.0,
            Self::Gain => LoopMargin::FLYABLE_MIN.gain,
            Self::Delay => LoopMargin::FLYABLE_MIN.delay,
        }
    }

    fn written(self, value: f64) -> String {
        match self {
            Self::Inequality => percent(value),
            Self::Gain => short(value),
            Self::Delay => format!("{} ms", short(1e3 * value)),
        }
    }
}

/// The table, and whether all margins are left in the worst corner.
///
/// # Errors
/// If the identified vehicle cannot fly, or `original` is no scenario.
pub fn report(original: &str, name: &str, quantities: &Quantities) -> Result<(String, bool), String> {
    let model = Scenario::parse(original, name).map_err(|error| error.to_string())?;
    let step = model.timing.step();
    let of = |values: &Values| -> Result<Vec<Margin>, String> {
        let text = rewritten(original, "identified", values, step)?;
        margins(&Scenario::parse(&text, "identified").map_err(|error| error.to_string())?)
    };
    let (file, values) = (margins(&model)?, Values::estimates(quantities));
    let identified = of(&values)?;
    let mut worst: Vec<f64> = identified.iter().map(|margin| margin.value).collect();
    for (quantity, set) in ends(quantities) {
        let moved = quantity.interval.map(|end| {
            let mut values = values;
            set(&mut values, end);
            of(&values)
        });
        for (index, worst) in worst.iter_mut().enumerate() {
            let here = identified[index].value;
            // A vehicle that cannot exist, or not fly, has no margin at all.
            let lost = moved
                .iter()
                .map(|moved| moved.as_ref().map_or(f64::INFINITY, |moved| here - moved[index].value.min(here)));
            *worst -= lost.fold(0.0, f64::max);
        }
    }
    let mut rows = vec![["margin", "file", "identified", "worst corner", ""].map(str::to_owned).to_vec()];
    let mut all = true;
    for ((file, here), worst) in file.iter().zip(&identified).zip(&worst) {
        let kind = here.kind;
        let holds = |value: f64| value >= kind.least();
        let verdict = match (holds(here.value), holds(*worst)) {
            (true, true) => "holds",
            (true, false) => "MAY FAIL: the uncertainty eats it",
            (false, _) => "FAILS",
        };
        all &= holds(*worst);
        let written = [file.value, here.value, *worst].map(|value| kind.written(value));
        rows.push([&[here.name.clone()][..], &written, &[verdict.to_owned()]].concat());
    }
    Ok((aligned(&rows), all))
}

/// All margins of a scenario, always in the same order.
fn margins(scenario: &Scenario) -> Result<Vec<Margin>, String> {
    let verdict = Verdict::judge(scenario).map_err(|error| error.to_string())?;
    let inequalities = verdict.certificate().inequalities().map(|inequality| Margin {
        name: inequality.name.to_owned(),
        kind: Kind::Inequality,
        value: inequality.margin(),
    });
    let mut all: Vec<Margin> = inequalities.collect();
    for report in verdict.loops() {
        // An unstable loop bears neither another gain nor any delay.
        let (gain, delay) =
            report.margins.map_or((0.0, -1.0), |m| (m.gain_up.min(1.0 / m.gain_down.max(1e-9)), m.delay));
        let name = report.axis.name();
        all.push(Margin { name: format!("loop {name}, gain"), kind: Kind::Gain, value: gain.min(100.0) });
        all.push(Margin { name: format!("loop {name}, more delay"), kind: Kind::Delay, value: delay.min(1.0) });
    }
    Ok(all)
}

/// Sets one number of a vehicle.
type Set = fn(&mut Values, f64);

/// The quantities that the certificate and the loops depend on.
fn ends(quantities: &Quantities) -> [(Quantity, Set); 9] {
    [
        (quantities.mass, |values, end| values.mass = end),
        (quantities.thrust_scale, |values, end| values.thrust_scale = end),
        (quantities.inertia[0], |values, end| values.inertia[0] = end),
        (quantities.inertia[1], |values, end| values.inertia[1] = end),
        (quantities.inertia[2], |values, end| values.inertia[2] = end),
        // The whole is known better than its parts: a longer lag is a shorter delay.
        (quantities.whole_delay, |values, end| values.delay = (end - values.lag).max(0.0)),
        (quantities.lag, |values, end| {
            let whole = values.lag + values.delay;
            (values.lag, values.delay) = (end, (whole - end).max(0.0));
        }),
        (quantities.centre_of_mass[0], |values, end| values.centre_of_mass[0] = end),
        (quantities.centre_of_mass[1], |values, end| values.centre_of_mass[1] = end),
    ]
}
