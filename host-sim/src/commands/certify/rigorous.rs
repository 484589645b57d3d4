//! `certify --rigorous`: the certificate once more, every operation rounded outwards, beside the figures that decide.
//!
//! The formulas are the same code ([`controller_core::math::real`]). So what is checked is the rounding of double
//! precision, not the formulas; a margin is what it says to within the shown differences. So is the reference judged
//! along itself once more. The sampled loops are an analysis, not a proof, and stay as they are.

use crate::output::table::{aligned, short};
use controller_core::certificate::Certificate;
use controller_core::certificate::inequality::Inequality;
use controller_core::certificate::path::along::MaxShare;
use controller_core::configuration::Configuration;
use controller_core::error::ParameterError;
use controller_core::math::enclosure::Enclosure;
use controller_core::math::real::Real;
use scenario::Scenario;
use scenario::along::end_us;
use scenario::judge::judge;

/// The reference of `scenario` judged along itself, in a sentence, and whether it takes less than what is left,
/// whatever rounding did; none under the paper's law.
#[must_use]
pub fn along(scenario: &Scenario) -> Option<(String, bool)> {
    let judge = judge::<Enclosure>(&scenario.configuration, scenario.force_kept)?;
    let share = MaxShare::along(&judge, &*scenario.trajectory, end_us(scenario)).share;
    let verdict = if share < 1.0 { "holds" } else { "FAILS" };
    Some((
        format!("reference, rounded outwards: takes {:.1} % of what is left, {verdict}\n", 100.0 * share),
        share < 1.0,
    ))
}

/// A certificate in double precision, and in enclosures.
pub struct Rigorous {
    rows: Vec<(Inequality, Inequality<Enclosure>)>,
}

impl Rigorous {
    /// Of a configuration.
    ///
    /// # Errors
    /// If a bound is beyond double precision.
    pub fn new(configuration: &Configuration) -> Result<Self, ParameterError> {
        let nearest = Certificate::new(configuration)?;
        let enclosed = Certificate::enclose(configuration)?;
        Ok(Self { rows: nearest.inequalities().copied().zip(enclosed.inequalities().copied()).collect() })
    }

    /// The inequalities of which rounding may have decided, by name: those that hold in one of the two only.
    pub fn undecided(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.rows.iter().filter(|(nearest, enclosed)| nearest.holds() != enclosed.holds()).map(|(row, _)| row.name)
    }

    /// Whether every inequality holds, whatever rounding did.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.rows.iter().all(|(_, enclosed)| enclosed.holds())
    }

    /// The greatest share of its available side by which rounding outwards changes a figure.
    #[must_use]
    pub fn greatest_difference(&self) -> f64 {
        self.rows.iter().flat_map(|(nearest, enclosed)| differences(nearest, enclosed)).fold(0.0, f64::max)
    }

    /// Both figures of each inequality beside each other, and in a sentence what follows.
    #[must_use]
    pub fn report(&self) -> String {
        let head = ["inequality, rounded outwards", "available", "less by", "", "required", "more by", ""];
        let mut table = vec![head.map(str::to_owned).to_vec()];
        for (nearest, enclosed) in &self.rows {
            let [required, available] = differences(nearest, enclosed).map(|share| format!("{share:.0e}"));
            let verdict = if enclosed.holds() { "holds" } else { "FAILS" };
            table.push(vec![
                nearest.name.to_owned(),
                short(nearest.available),
                available,
                nearest.unit.to_owned(),
                short(nearest.required),
                required,
                verdict.to_owned(),
            ]);
        }
        let undecided: Vec<&str> = self.undecided().collect();
        let follows = if !undecided.is_empty() {
            format!("rigorous: rounding decides {}", undecided.join(", "))
        } else if self.holds() {
            "rigorous: every inequality holds in exact arithmetic".to_owned()
        } else {
            "rigorous: the same inequalities are not shown to hold".to_owned()
        };
        format!(
            "{}\n{follows}; rounding outwards takes {:.0e} of an available side at most\n",
            aligned(&table),
            self.greatest_difference()
        )
    }
}

/// How much worse an inequality's sides can be than to nearest, as shares of the available one: required, available.
fn differences(nearest: &Inequality, enclosed: &Inequality<Enclosure>) -> [f64; 2] {
    let share =
        |worse: f64, better: f64| if worse == better { 0.0 } else { (worse - better) / nearest.available.abs() };
    [share(enclosed.required.upper(), nearest.required), share(nearest.available, enclosed.available.lower())]
}

#[cfg(test)]
mod tests;
