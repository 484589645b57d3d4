//! The page of one flight: what `fly` writes beside its log.

pub mod columns;
pub mod plots;

use super::document;
use super::page::{Block, Page, Section};
use super::plot::Color;
use super::prose::{Cell, Fact, Table};
use super::recorder::ReportRecorder;
use super::replay::{Body, Replay};
use crate::flight::claims::{self, Claim};
use crate::flight::extremes::FlightExtremes;
use crate::output::table::{percent, short};
use crate::reports::plots::drawing::Inks;
use crate::reports::plots::{FIGURE_1, FIGURE_2, figure, first_seconds, path};
use crate::rivals::choice::LawChoice;
use scenario::Scenario;
use scenario::stability::LoopMargin;
use scenario::verdict::Verdict;

const CERTIFIED_MEANING: &str = " Certified means: for every reference within this one's bounds the commands are proven to \
                         stay within the limits, and small motions are stable with margin.";

/// A flight that is over.
pub struct Flight<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The file it was read from.
    pub text: &'a str,
    /// Which law flew.
    pub law: &'a LawChoice,
    /// Whether it may fly for real, under our law.
    pub verdict: &'a Verdict,
    /// The same in a sentence.
    pub certification: &'a str,
    /// The claims.
    pub claims: &'a [Claim],
    /// The flight's figures.
    pub flown: &'a FlightExtremes,
}

/// A recorder of everything that the page shows of a flight of `scenario`.
#[must_use]
pub fn recorder(scenario: &Scenario) -> ReportRecorder {
    let timing = &scenario.timing;
    ReportRecorder::new(timing.ticks, timing.period(), columns::columns(scenario))
}

/// The page of a flight, and beside it the figures by the names of their files.
#[must_use]
pub fn page(flight: &Flight, recorder: ReportRecorder) -> (Page, [(&'static str, String); 4]) {
    let Flight { scenario, law, verdict, claims, flown, .. } = flight;
    let ticks_per_row = recorder.ticks_per_row();
    let track = recorder.finish(&scenario.name);
    let plots = plots::plots(scenario, verdict.certificate(), &track);
    let figures = [
        ("fig1.svg", figure(&plots, FIGURE_1, &track)),
        ("fig2.svg", figure(&plots, FIGURE_2, &track)),
        ("first-seconds.svg", first_seconds(&plots, &track)),
        ("flight.svg", path::picture(&track).svg(Inks::Light, "The path in space")),
    ];
    let holds = claims::all_hold(claims);
    let sections = [
        ("Replay", vec![Block::Replay(replay(scenario))]),
        ("Claims", vec![Block::Table(claims_table(claims))]),
        ("Plots", vec![Block::Text(about_plots(ticks_per_row)), Block::Plots(plots)]),
        (
            "Certificate",
            vec![
                Block::Text(format!("Configuration {}.{CERTIFIED_MEANING}", flight.certification)),
                Block::Table(inequalities(verdict)),
                Block::Table(loops(verdict)),
            ],
        ),
        (
            "Scenario",
            vec![
                Block::Folded(
                    "Vehicle, gains and all else, section by section".into(),
                    document::tables(flight.text, "scenario"),
                ),
                Block::Listing("The file as it was read".into(), flight.text.into()),
            ],
        ),
    ];
    let page = Page {
        title: scenario.name.clone(),
        kind: "flight".into(),
        verdict: Some((holds, if holds { "Every claim holds" } else { "Not every claim holds" }.into())),
        lead: lead(scenario, law),
        highlights: highlights(scenario, law, verdict, flown),
        tracks: vec![track],
        sections: sections.map(|(title, blocks)| Section { title: title.into(), blocks }).into(),
    };
    (page, figures)
}

fn lead(scenario: &Scenario, law: &LawChoice) -> String {
    let timing = &scenario.timing;
    let law = match law {
        LawChoice::Rival(kind, _) => &format!("another law, {}, of which nothing is proven,", kind.name()),
        LawChoice::Ours if scenario.configuration.paper().is_some() => "the paper's law",
        LawChoice::Ours => "the extended law",
    };
    let beyond = match scenario.reality.sections().as_slice() {
        [] => String::new(),
        sections => format!(" Beyond the model: [{}], of which no certificate knows.", sections.join("], [")),
    };
    format!(
        "{} s of simulated flight under {law} at {} Hz, plant step {} ms.{beyond}",
        short(timing.duration()),
        short(1e6 / timing.period_us as f64),
        short(1e3 * timing.step())
    )
}

fn highlights(scenario: &Scenario, law: &LawChoice, verdict: &Verdict, flown: &FlightExtremes) -> Vec<Fact> {
    let since = |since: Option<f64>| since.map_or_else(|| "never".to_owned(), |since| format!("{} s", short(since)));
    let ours = *law == LawChoice::Ours;
    let margin = verdict.certificate().tightest().map_or("none".to_owned(), |tightest| percent(tightest.margin()));
    let torque = flown.torque.map(short).join(", ");
    vec![
        Fact::new("Certified", if ours && verdict.refusal().is_none() { "yes" } else { "no" }),
        Fact::new("Tightest proven margin", if ours { margin } else { "none".to_owned() }),
        Fact::new("On its reference after", since(flown.position_reached())),
        Fact::new("Steady position error", format!("{} m", short(flown.steady_position_error))),
        Fact::new("Height lost", format!("{} m", short(flown.height_lost))),
        Fact::new("Greatest torques", format!("{torque} N m")),
        Fact::new("Mass", format!("{} kg", short(f64::from(scenario.configuration.vehicle().mass)))),
        Fact::new("Written by", format!("host-sim {}", env!("CARGO_PKG_VERSION"))),
    ]
}

fn about_plots(ticks_per_row: u64) -> String {
    let rows = match ticks_per_row {
        1 => "Every control tick is drawn.".to_owned(),
        ticks => format!(
            "Each point stands for {ticks} ticks: of two points the one is the least, the other the greatest value seen; \
             positions and attitudes are samples. Every tick is in log.csv."
        ),
    };
    format!("{rows} Dashed lines are references; thin lines across are bounds.")
}

fn claims_table(claims: &[Claim]) -> Table {
    let mut table = Table::new("What was claimed and what was flown", &["claim", "required", "flown", "verdict"]);
    table.rows.extend(claims.iter().map(|claim| {
        let [required, flown] = [&claim.required, &claim.flown].map(|text| Cell::number(typeset(text)));
        vec![Cell::text(claim.claim.clone()), required, flown, Cell::Verdict(claim.holds)]
    }));
    table
}

/// As a page may write what a terminal has to spell.
fn typeset(text: &str) -> String {
    text.replace("<=", "≤").replace(">=", "≥").replace("^2", "²")
}

/// The inequalities that decide whether the commands are proven to stay within the limits.
fn inequalities(verdict: &Verdict) -> Table {
    let head = ["inequality", "required", "available", "margin", "verdict"];
    let mut table = Table::new("Commands: a proof", &head);
    table.rows.extend(verdict.certificate().inequalities().map(|inequality| {
        let side = |value: f64| Cell::number(typeset(format!("{} {}", short(value), inequality.unit).trim_end()));
        let margin = Cell::number(percent(inequality.margin()));
        let (required, available) = (side(inequality.required), side(inequality.available));
        vec![Cell::text(inequality.name), required, available, margin, Cell::Verdict(Some(inequality.holds()))]
    }));
    table
}

fn loops(verdict: &Verdict) -> Table {
    let head = ["sampled loop", "spectral radius", "gain down to", "gain up to", "more delay", "verdict"];
    let mut table = Table::new("Small motions about hover: an analysis", &head);
    table.rows.extend(verdict.loops().iter().map(|report| {
        let margins = report.margins.map_or(["", "", ""].map(str::to_owned), |margins| {
            [short(margins.gain_down), short(margins.gain_up), format!("{} ms", short(1e3 * margins.delay))]
        });
        let holds = LoopMargin::FLYABLE_MIN.lacking(report).is_none();
        let mut row = vec![Cell::text(report.axis.name()), Cell::number(format!("{:.4}", report.spectral_radius))];
        row.extend(margins.map(Cell::Number));
        row.push(Cell::Verdict(Some(holds)));
        row
    }));
    table
}

fn replay(scenario: &Scenario) -> Replay {
    let rotors = scenario.configuration.rotors().into_iter().flat_map(|rotors| rotors.iter());
    let vehicle = scenario.configuration.vehicle();
    Replay {
        bodies: vec![Body { track: 0, label: scenario.name.clone(), color: Color::Blue }],
        rotors: rotors.map(|rotor| rotor.position.cast().into()).collect(),
        hover_thrust: f64::from(vehicle.mass * vehicle.gravity),
    }
}

#[cfg(test)]
mod tests;
