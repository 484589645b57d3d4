//! The `certify` command: every inequality of the certificate, as printed in the paper and sharp, side by side.
//!
//! Only the sharp form and the rotors decide. The margins of the sampled loop are reported below them: a certificate is
//! about limits, not about how well a vehicle flies, but whoever reads it wants to know both.

mod blame;

use crate::table::{aligned, percent, short};
use controller_core::certificate::inequality::Inequality;
use controller_core::certificate::{Certificate, Form};
use controller_core::error::ParameterError;
use scenario::Scenario;

/// The paper's published bounds, Section VI, for the one scenario they are about.
const PUBLISHED: &str = "published (Section VI): thrust in [3.51, 6.19] N, torques 0.29, 0.33, 0.48 N m";

/// The report on `scenario`, and whether it is certified.
///
/// # Errors
/// If a number of the scenario is beyond what the certificate or the loops can work with.
pub fn certify(scenario: &Scenario) -> Result<(String, bool), ParameterError> {
    let certificate = Certificate::new(&scenario.configuration)?;
    let mut text = verdict(scenario, &certificate);
    text += "\n";
    text += &inequalities(&certificate);
    text += "\n";
    text += &bounds("as printed", &certificate.printed);
    text += &bounds("sharp", &certificate.sharp);
    if scenario.is_papers() {
        text += PUBLISHED;
        text += "\n";
    }
    if !certificate.rotors.is_empty() {
        text += "\n";
        text += &rotors(&certificate);
        text += &blame::sentence(&scenario.configuration, &certificate)?;
    }
    text += "\n";
    text += &loops(scenario)?;
    Ok((text, certificate.holds()))
}

fn verdict(scenario: &Scenario, certificate: &Certificate) -> String {
    let failing = |form: &Form| {
        let names: Vec<&str> = form.inequalities.iter().filter(|i| !i.holds()).map(|i| i.name).collect();
        if names.is_empty() { "every inequality holds".to_owned() } else { format!("fails in {}", names.join(", ")) }
    };
    let decision = if certificate.holds() { "CERTIFIED" } else { "NOT certified" };
    let tightest = certificate.tightest().map_or(String::new(), |tightest| {
        format!("tightest: {}, margin {}\n", tightest.name, percent(tightest.margin()))
    });
    let projection = scenario
        .configuration
        .thrust_floor()
        .map_or(String::new(), |floor| format!("thrust projection on, floor {} N\n", short(f64::from(floor))));
    format!(
        "{}: {decision}\nas printed: {}\nsharp: {}\n{tightest}{projection}",
        scenario.name,
        failing(&certificate.printed),
        failing(&certificate.sharp)
    )
}

fn inequalities(certificate: &Certificate) -> String {
    let head = ["inequality", "available", "", "as printed", "margin", "", "sharp", "margin", ""];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for (printed, sharp) in certificate.printed.inequalities.iter().zip(&certificate.sharp.inequalities) {
        let mut row = vec![sharp.name.to_owned(), short(sharp.available), sharp.unit.to_owned()];
        row.extend(required(printed));
        row.extend(required(sharp));
        rows.push(row);
    }
    aligned(&rows)
}

fn required(inequality: &Inequality) -> [String; 3] {
    let verdict = if inequality.holds() { "holds" } else { "FAILS" };
    [short(inequality.required), percent(inequality.margin()), verdict.to_owned()]
}

fn bounds(name: &str, form: &Form) -> String {
    format!(
        "{name}: |omega_d| <= {} rad/s, |omega_d'| <= {} rad/s^2; thrust in [{}, {}] N, torques {}, {}, {} N m\n",
        short(form.rates.angular_velocity),
        short(form.rates.angular_acceleration),
        short(form.thrust.least),
        short(form.thrust.greatest),
        short(form.torque.x),
        short(form.torque.y),
        short(form.torque.z)
    )
}

fn rotors(certificate: &Certificate) -> String {
    let head = ["rotor, excursion from hover", "available", "", "required", "margin", ""];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for inequality in certificate.rotors.iter().flat_map(|report| [&report.least, &report.greatest]) {
        let mut row = vec![inequality.name.to_owned(), short(inequality.available), inequality.unit.to_owned()];
        row.extend(required(inequality));
        rows.push(row);
    }
    aligned(&rows)
}

fn loops(scenario: &Scenario) -> Result<String, ParameterError> {
    let configuration = &scenario.configuration;
    let head = ["sampled loop, small motions", "spectral radius", "gain margin", "delay margin", ""];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for report in scenario.loops()?.reports() {
        let (gain, delay) = report.margins.map_or(("none".to_owned(), "none".to_owned()), |margins| {
            (short(margins.gain_up), format!("{} ms", short(1e3 * margins.delay)))
        });
        let verdict = if report.spectral_radius < 1.0 { "stable" } else { "UNSTABLE" };
        let radius = format!("{:.4}", report.spectral_radius);
        rows.push(vec![report.axis.name().to_owned(), radius, gain, delay, verdict.to_owned()]);
    }
    let timing = format!(
        "at {} Hz, rotor lag {} ms, delay {} ms, for vehicle {} kg\n",
        short(1e6 / scenario.timing.period_us as f64),
        short(1e3 * scenario.rotor_lag),
        short(1e3 * scenario.delay()),
        short(f64::from(configuration.vehicle().mass))
    );
    Ok(aligned(&rows) + &timing)
}

#[cfg(test)]
mod tests;
