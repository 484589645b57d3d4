//! One flight of a campaign under any law: `campaign` and `compare` fly all random flights by it.

use super::draw::circumstances;
use super::outcome::Outcome;
use super::rows::Row;
use crate::flight::flier::Flier;
use controller_core::certificate::Certificate;
use controller_core::error::ParameterError;
use scenario::Scenario;

/// Flight `number` of the campaign of `scenario`, with the plant step that it has, from `seed`. The circumstances are
/// the same for every law; what `certificate` proves of our commands, those of any law are held against.
///
/// # Errors
/// As [`Flier::flight`]'s.
pub fn throw(
    flier: &Flier,
    scenario: &Scenario,
    certificate: &Certificate,
    seed: u64,
    number: u64,
) -> Result<Row, ParameterError> {
    let thrown = circumstances(scenario, &scenario.campaign.ranges, seed, number);
    let outcome = Outcome::of(&thrown, flier.flight(&thrown)?, certificate);
    Ok(Row::new(number, &thrown, outcome))
}
