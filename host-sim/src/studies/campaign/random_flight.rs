//! One flight of a campaign under any law: `campaign` and `compare` fly all random flights by it.

use super::draw::circumstances;
use super::outcome::Outcome;
use super::rows::FlightRow;
use crate::flight::law_on_vehicle::LawOnVehicle;
use controller_core::certificate::Certificate;
use controller_core::error::ParameterError;
use scenario::Scenario;

/// Flight `number` of the campaign of `scenario`, with the plant step that it has, from `seed`. The circumstances are
/// the same for every law; what `certificate` proves of our commands, those of any law are held against.
///
/// # Errors
/// As [`LawOnVehicle::flight`]'s.
pub fn fly(
    law: &LawOnVehicle,
    scenario: &Scenario,
    certificate: &Certificate,
    seed: u64,
    number: u64,
) -> Result<FlightRow, ParameterError> {
    let thrown = circumstances(scenario, &scenario.campaign.ranges, seed, number);
    let outcome = Outcome::judge(&thrown, law.flight(&thrown)?, certificate);
    Ok(FlightRow::new(number, &thrown, outcome))
}
