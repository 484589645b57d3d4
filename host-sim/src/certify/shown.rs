//! `certify --show`: every constant that is used, as sections of a scenario file.

use controller_core::configuration::{LawParameters, PaperLaw};
use scenario::number::Number;
use scenario::vehicle::named;
use scenario::{Scenario, bounds, extended};

/// The sections with every constant that `scenario` flies with.
#[must_use]
pub fn constants(scenario: &Scenario) -> String {
    let configuration = &scenario.configuration;
    let (law, constants) = match configuration.law() {
        LawParameters::Extended(law) => ("extended", extended::written(&law.parameters)),
        LawParameters::Paper(PaperLaw { gains, thrust_floor }) => {
            let lines: String =
                named(gains).iter().map(|(key, value)| format!("{key} = {}\n", Number(*value))).collect();
            let floor = thrust_floor
                .map_or(String::new(), |floor| format!("# with [control] thrust_floor = {}\n", Number(floor)));
            ("paper", format!("{floor}[gains]\n{lines}"))
        }
    };
    format!(
        "# {}: all that `[control] law = \"{law}\"` flies with, in place of these sections\n{constants}\n{}",
        scenario.name,
        bounds::written(configuration.bounds())
    )
}
