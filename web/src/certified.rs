//! The verdict on a vehicle's file, in rows and sentences.

use crate::vehicle_file::VehicleFile;
use controller_core::allocation::Spin;
use controller_core::certificate::Certificate;
use controller_core::certificate::inequality::Inequality;
use host_sim::commands::certify::{self, advice, constants, may_fly};
use scenario::Scenario;
use scenario::sampled_loop::LoopReport;
use scenario::stability::{LoopMargin, Shortfall};
use scenario::verdict::Verdict;
use serde::Serialize;

/// The verdict.
#[derive(Debug, Serialize)]
pub struct Certified {
    /// The vehicle's name.
    pub name: String,
    /// Whether it may fly.
    pub certified: bool,
    /// That in a sentence.
    pub decision: String,
    /// `extended` or `paper`.
    pub law: &'static str,
    /// What is proven, analysed and flown.
    pub sentences: Vec<String>,
    /// The inequalities of the certificate.
    pub rows: Vec<Row>,
    /// The loops of small motions.
    pub loops: Vec<Loop>,
    /// What limits it or what it fails in, and what to change.
    pub advice: Vec<String>,
    /// What may be flown.
    pub may_fly: Vec<String>,
    /// All that `host-sim certify` prints.
    pub report: String,
    /// Every constant, as TOML.
    pub constants: String,
    /// kg.
    pub mass: f64,
    /// Its rotors.
    pub rotors: Vec<Rotor>,
    /// Hz.
    pub rate: f64,
}

/// An inequality.
#[derive(Debug, Serialize)]
pub struct Row {
    /// As `host-sim certify` prints it.
    pub name: String,
    /// In plain words; may be empty.
    pub meaning: &'static str,
    /// In `unit`.
    pub available: f64,
    /// In `unit`.
    pub required: f64,
    /// Of both.
    pub unit: &'static str,
    /// The share of `available` that is left.
    pub margin: f64,
    /// Whether it holds.
    pub holds: bool,
}

/// A loop of small motions about hover.
#[derive(Debug, Serialize)]
pub struct Loop {
    /// Its name.
    pub axis: &'static str,
    /// Below 1: it is stable.
    pub radius: f64,
    /// The least factor on its gain at which it is stable.
    pub gain_down: Option<f64>,
    /// The greatest.
    pub gain_up: Option<f64>,
    /// The further delay that it bears, s.
    pub delay: Option<f64>,
    /// In words.
    pub verdict: &'static str,
    /// Whether it has margin enough.
    pub holds: bool,
}

/// A rotor.
#[derive(Debug, Serialize)]
pub struct Rotor {
    /// m, body.
    pub position: [f32; 3],
    /// Seen from above.
    pub clockwise: bool,
}

/// Certifies a vehicle's file.
///
/// # Errors
/// One line: the file, the field, and what is wrong.
pub fn certify(VehicleFile { file, text }: &VehicleFile) -> Result<Certified, String> {
    let scenario = Scenario::parse(text, file).map_err(|error| error.to_string())?;
    let said = |error: controller_core::error::ParameterError| format!("{file}: {error}");
    let verdict = Verdict::judge(&scenario).map_err(said)?;
    let head = certify::head(&scenario, &verdict);
    let mut sentences = head.lines().map(str::to_owned);
    let decision = sentences.next().unwrap_or_default();
    let (law, inequalities): (_, Vec<&Inequality>) = match verdict.certificate() {
        Certificate::Paper(certificate) => ("paper", certificate.sharp.inequalities.iter().collect()),
        certificate @ Certificate::Extended(_) => ("extended", certificate.inequalities().collect()),
    };
    Ok(Certified {
        certified: verdict.refusal().is_none(),
        // Without the name, which stands above it.
        decision: decision.strip_prefix(&format!("{}: ", scenario.name)).unwrap_or(&decision).to_owned(),
        law,
        sentences: sentences.collect(),
        rows: inequalities.into_iter().map(row).collect(),
        loops: verdict.loops().iter().map(of_loop).collect(),
        advice: certify::limits(&verdict),
        may_fly: may_fly::lines(&scenario).lines().map(str::to_owned).collect(),
        report: certify::report(&scenario, &verdict).map_err(said)?,
        constants: constants::constants(&scenario),
        mass: scenario.configuration.vehicle().mass.into(),
        rotors: rotors(&scenario),
        rate: 1e6 / scenario.timing.period_us as f64,
        name: scenario.name,
    })
}

fn row(inequality: &Inequality) -> Row {
    Row {
        name: inequality.name.to_owned(),
        meaning: advice::for_inequality(inequality.name),
        available: inequality.available,
        required: inequality.required,
        unit: inequality.unit,
        margin: inequality.margin(),
        holds: inequality.holds(),
    }
}

fn of_loop(report: &LoopReport) -> Loop {
    let lack = LoopMargin::FLYABLE_MIN.lacking(report).map(|lack| lack.what);
    Loop {
        axis: report.axis.name(),
        radius: report.spectral_radius,
        gain_down: report.margins.map(|margins| margins.gain_down),
        gain_up: report.margins.map(|margins| margins.gain_up),
        delay: report.margins.map(|margins| margins.delay),
        verdict: match lack {
            None => "stable",
            Some(Shortfall::Unstable { .. }) => "UNSTABLE",
            Some(_) => "TOO LITTLE MARGIN",
        },
        holds: lack.is_none(),
    }
}

fn rotors(scenario: &Scenario) -> Vec<Rotor> {
    let rotors = scenario.configuration.rotors().into_iter().flat_map(|rotors| rotors.iter());
    rotors
        .map(|rotor| Rotor { position: rotor.position.into(), clockwise: matches!(rotor.spin, Spin::Clockwise) })
        .collect()
}
