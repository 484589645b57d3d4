//! `certify --show`: every constant that is used, as sections of a scenario file.

use controller_core::configuration::{LawParameters, PaperLaw};
use scenario::Scenario;
use scenario::constants::written;
use scenario::number::Number;

/// The sections with every constant that `scenario` flies with.
pub fn constants(scenario: &Scenario) -> String {
    let configuration = &scenario.configuration;
    let (law, constants) = match configuration.law() {
        LawParameters::Extended(law) => ("extended", written(law.parameters.entries())),
        LawParameters::Paper(PaperLaw { gains, thrust_floor }) => {
            let floor = thrust_floor
                .map_or(String::new(), |floor| format!("# with [control] thrust_floor = {}\n", Number(floor)));
            ("paper", floor + &written(gains.entries()))
        }
    };
    let motors = scenario.least_command.map_or(String::new(), |least| {
        let [idle, linear] = [Number(least.motor.idle), Number(least.motor.linear)];
        format!("# with [rotors] idle = {idle}, thrust_curve = {linear}: {least}\n")
    });
    format!(
        "# {}: all that `[control] law = \"{law}\"` flies with, in place of these sections\n{motors}{constants}\n{}",
        scenario.name,
        written(configuration.bounds().entries())
    )
}
