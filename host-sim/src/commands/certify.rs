//! The `certify` command: every inequality of the certificate. For the paper's law as printed in the paper and sharp,
//! side by side. The sharp form and the rotors decide about the paper law's commands, all inequalities about the
//! extended law's. The sampled loops below them decide about small motions, a model's flights about large ones, and
//! under the extended law the judge of paths about the file's own reference. A scenario is certified if all of them
//! hold ([`scenario::verdict`]). The certificate itself is about limits, not about how well a vehicle flies. What
//! becomes of it without a rotor (`rotor_failure`) decides nothing. What may be flown comes last ([`may_fly`]).

pub mod advice;
mod blame;
pub mod constants;
pub mod may_fly;
mod pilot;
pub mod rigorous;
mod rotor_failure;

use crate::output::table::{aligned, percent, short};
use controller_core::certificate::Certificate;
use controller_core::certificate::extended::{ExtendedBounds, ExtendedCertificate};
use controller_core::certificate::form::Form;
use controller_core::certificate::inequality::Inequality;
use controller_core::certificate::paper::PaperCertificate;
use controller_core::configuration::LawParameters;
use controller_core::error::ParameterError;
use scenario::Scenario;
use scenario::large_motions::Farthest;
use scenario::remarks::remarks;
use scenario::stability::{LoopMargin, Shortfall};
use scenario::verdict::Verdict;

/// The paper's published bounds, Section VI, for the one scenario they are about.
const PUBLISHED_BOUNDS: &str = "published (Section VI): thrust in [3.51, 6.19] N, torques 0.29, 0.33, 0.48 N m";

/// The report on `scenario`, and whether it is certified.
///
/// # Errors
/// If a number of the scenario is beyond what the certificate or the loops can work with.
pub fn certify(scenario: &Scenario) -> Result<(String, bool), ParameterError> {
    let verdict = Verdict::judge(scenario)?;
    Ok((report(scenario, &verdict)?, verdict.refusal().is_none()))
}

/// The report on `scenario`, whose verdict this is.
///
/// # Errors
/// As [`certify`]'s.
pub fn report(scenario: &Scenario, verdict: &Verdict) -> Result<String, ParameterError> {
    let certificate = verdict.certificate();
    let mut text = head(scenario, verdict);
    text += "\n";
    match certificate {
        Certificate::Paper(certificate) => text += &papers(scenario, certificate)?,
        Certificate::Extended(certificate) => text += &extended(certificate),
    }
    text += "\n";
    text += &loops(scenario, verdict)?;
    text += &scenario.least_command.map_or(String::new(), |least| format!("rotors: {least}\n"));
    if let LawParameters::Extended(law) = scenario.configuration.law() {
        let limits: String = limits(verdict).iter().map(|line| format!("{line}\n")).collect();
        text += &format!("\n{}\n{limits}", pilot::terms(&scenario.configuration, law));
    }
    let gone = rotor_failure::lines(scenario, verdict.certified())?;
    if !gone.is_empty() {
        text += &format!("\n{gone}");
    }
    Ok(text)
}

/// The verdict and its reasons alone.
pub fn summary(scenario: &Scenario) -> Result<String, ParameterError> {
    Ok(head(scenario, &Verdict::judge(scenario)?))
}

/// Under the extended law, a line each: the failing inequalities, loop and flight; without any, the tightest
/// inequality.
pub fn limits(verdict: &Verdict) -> Vec<String> {
    let certificate = verdict.certificate();
    let failing: Vec<&Inequality> = certificate.inequalities().filter(|inequality| !inequality.holds()).collect();
    let what = |inequality: &Inequality| advice::for_inequality(inequality.name).to_owned();
    let (begins, mut all): (_, Vec<String>) = match certificate.tightest() {
        Some(tightest) if verdict.refusal().is_none() => ("What limits it", vec![what(&tightest)]),
        _ => ("What it fails in", failing.into_iter().map(what).collect()),
    };
    all.extend(verdict.lacking().map(|lack| advice::for_loop(&lack)));
    all.extend(verdict.not_arrived().map(|_| advice::FOR_FLIGHT.to_owned()));
    let reference = verdict.along().filter(|along| !along.holds());
    all.extend(reference.map(|along| advice::for_path(along.taken.row).to_owned()));
    all.iter().map(|what| format!("{begins}: {what}")).collect()
}

/// The paper's law: both forms side by side, then the rotors.
fn papers(scenario: &Scenario, certificate: &PaperCertificate) -> Result<String, ParameterError> {
    let mut text = inequalities(certificate);
    text += "\n";
    text += &bounds("as printed", &certificate.printed);
    text += &bounds("sharp", &certificate.sharp);
    if scenario.is_papers() {
        text += PUBLISHED_BOUNDS;
        text += "\n";
    }
    if !certificate.rotors.is_empty() {
        text += "\n";
        text += &rotors(certificate);
        text += &blame::sentence(&scenario.configuration, certificate)?;
    }
    Ok(text)
}

/// The extended law: its inequalities, rotors among them, and its greatest commands.
fn extended(certificate: &ExtendedCertificate) -> String {
    let head = ["inequality", "available", "", "required", "margin", ""];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for inequality in &certificate.inequalities {
        let mut row = vec![inequality.name.to_owned(), short(inequality.available), inequality.unit.to_owned()];
        row.extend(required(inequality));
        rows.push(row);
    }
    let ExtendedBounds { thrust, torque, .. } = &certificate.bounds;
    aligned(&rows)
        + &format!(
            "thrust in [{}, {}] N, torques {}, {}, {} N m\n",
            short(thrust.min),
            short(thrust.max),
            short(torque.x),
            short(torque.y),
            short(torque.z)
        )
}

/// The verdict, its reasons, and the figures that a reader looks for first.
pub fn head(scenario: &Scenario, verdict: &Verdict) -> String {
    let failing = |inequalities: &[Inequality]| {
        let names: Vec<&str> = inequalities.iter().filter(|i| !i.holds()).map(|i| i.name).collect();
        if names.is_empty() { "every inequality holds".to_owned() } else { format!("fails in {}", names.join(", ")) }
    };
    let certificate = verdict.certificate();
    let decision = verdict.refusal().map_or("CERTIFIED".to_owned(), |refusal| format!("NOT certified: {refusal}"));
    let commands =
        if certificate.holds() { "within every limit, whatever the vehicle does" } else { "NOT within every limit" };
    let LoopMargin { gain, delay } = LoopMargin::FLYABLE_MIN;
    let stable = match verdict.lacking().map(|lack| lack.what) {
        None => {
            format!("stable about hover, with {gain} times the gain, 1 / {gain} of it or {} ms more delay", 1e3 * delay)
        }
        Some(Shortfall::Unstable { .. }) => "NOT stable about hover".to_owned(),
        Some(_) => "stable about hover, but with too LITTLE margin".to_owned(),
    };
    let flights = match verdict.flights() {
        Some(Ok(Farthest { start, distance })) => format!(
            "large motions (flights of a model without air): every one arrives; on its way at most {} m off, \
             from {start}\n",
            short(distance)
        ),
        Some(Err(_)) => "large motions (flights of a model): one does NOT arrive\n".to_owned(),
        None => String::new(),
    };
    let tightest = certificate.tightest().map_or(String::new(), |tightest| {
        format!("tightest: {}, margin {}\n", tightest.name, percent(tightest.margin()))
    });
    let remarks = remarks(scenario, certificate.holds());
    let remarks: String = remarks.iter().map(|remark| format!("{remark}\n")).collect();
    let projection = scenario
        .configuration
        .thrust_floor()
        .map_or(String::new(), |floor| format!("thrust projection on, floor {} N\n", short(f64::from(floor))));
    let forms = match certificate {
        Certificate::Paper(PaperCertificate { printed, sharp, .. }) => {
            format!("as printed: {}\nsharp: {}", failing(&printed.inequalities), failing(&sharp.inequalities))
        }
        Certificate::Extended(certificate) => format!("extended law: {}", failing(&certificate.inequalities)),
    };
    let along = verdict.along().map_or(String::new(), |along| format!("{along}\n"));
    let on_path = match verdict.on_path() {
        Some(Ok(on_path)) => format!("along the reference (a flight of a model): {on_path}\n"),
        Some(Err(_)) => "along the reference (a flight of a model): it does NOT stay near\n".to_owned(),
        None => String::new(),
    };
    format!(
        "{}: {decision}\ncommands (a proof): {commands}\nsmall motions (an analysis): {stable}\n{flights}{forms}\n\
         {tightest}{along}{on_path}{projection}{remarks}",
        scenario.name,
    )
}

fn inequalities(certificate: &PaperCertificate) -> String {
    let head = ["inequality", "available", "printed", "margin", "", "sharp", "margin", ""];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for (printed, sharp) in certificate.printed.inequalities.iter().zip(&certificate.sharp.inequalities) {
        let mut row = vec![sharp.name.to_owned(), format!("{} {}", short(sharp.available), sharp.unit)];
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
        short(form.thrust.min),
        short(form.thrust.max),
        short(form.torque.x),
        short(form.torque.y),
        short(form.torque.z)
    )
}

fn rotors(certificate: &PaperCertificate) -> String {
    let head = ["rotor, excursion from hover", "available", "", "required", "margin", ""];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for inequality in certificate.rotors.iter().flat_map(|report| [&report.min, &report.max]) {
        let mut row = vec![inequality.name.to_owned(), short(inequality.available), inequality.unit.to_owned()];
        row.extend(required(inequality));
        rows.push(row);
    }
    aligned(&rows)
}

fn loops(scenario: &Scenario, verdict: &Verdict) -> Result<String, ParameterError> {
    let configuration = &scenario.configuration;
    let head = ["sampled loop, small motions", "spectral radius", "gain down to", "gain up to", "more delay", ""];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for report in verdict.loops() {
        let margins = report.margins.map_or(["", "", ""].map(str::to_owned), |margins| {
            [short(margins.gain_down), short(margins.gain_up), format!("{} ms", short(1e3 * margins.delay))]
        });
        let verdict = match LoopMargin::FLYABLE_MIN.lacking(report).map(|lack| lack.what) {
            None => "stable",
            Some(Shortfall::Unstable { .. }) => "UNSTABLE",
            Some(_) => "TOO LITTLE MARGIN",
        };
        let radius = format!("{:.4}", report.spectral_radius);
        let [down, up, delay] = margins;
        rows.push(vec![report.axis.name().to_owned(), radius, down, up, delay, verdict.to_owned()]);
    }
    let timing = format!(
        "at {} Hz, rotor lag {} ms, delay {} ms, for vehicle {} kg\n",
        short(1e6 / scenario.timing.period_us as f64),
        short(1e3 * scenario.rotor_lag),
        short(1e3 * scenario.delay()),
        short(f64::from(configuration.vehicle().mass))
    );
    let lag = if scenario.rotor_lag > 0.0 && verdict.lacking().is_none() { lag(scenario)? } else { String::new() };
    Ok(aligned(&rows) + &timing + &lag)
}

/// The rotor lags that small motions bear, as the law believes in the file's.
fn lag(scenario: &Scenario) -> Result<String, ParameterError> {
    let [least, greatest] = scenario.loops()?.lag_factors();
    let from = if least > 0.0 { format!("{} times that lag", short(least)) } else { "none at all".to_owned() };
    let to = if greatest.is_finite() { format!("{} times", short(greatest)) } else { "ten times and more".to_owned() };
    Ok(format!("rotors whose lag is not what the file says: stable from {from} to {to}\n"))
}

#[cfg(test)]
mod tests;
