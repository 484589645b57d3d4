//! The page of a comparison: every law's figures, row by row, with a star where ours loses; the scenes' courses over
//! time; the spread of the random flights; and the gains.

use super::rows::{FigureRow, LIMIT_COLUMN, cell};
use super::scene_figures::{PICTURE_PERIOD_US, RandomFlights, SceneFigures};
use super::scenes::Scene;
use crate::output::table::short;
use crate::reports::report::distribution::Distribution;
use crate::reports::report::document;
use crate::reports::report::page::{Block, Page, Section};
use crate::reports::report::plot::{Color, Curve, LinePattern, Plot};
use crate::reports::report::prose::{Cell, Fact, Table};
use crate::reports::report::track::Track;
use crate::rivals::choice::OUR_LAW;
use crate::rivals::gains::Set;
use crate::rivals::kind::RivalKind;
use crate::studies::campaign::outcome::Outcome;
use scenario::Scenario;

/// Ours, then the rivals in their order. Curves whose colours look alike to people who confuse red and green are drawn
/// with different patterns: green, purple and grey; vermilion and orange; blue and sky.
pub const CURVE_LOOKS: [(Color, LinePattern); 8] = [
    (Color::Ink, LinePattern::Solid),
    (Color::Blue, LinePattern::Solid),
    (Color::Vermilion, LinePattern::Dashed),
    (Color::Green, LinePattern::Solid),
    (Color::Orange, LinePattern::Solid),
    (Color::Purple, LinePattern::Dotted),
    (Color::Sky, LinePattern::Dashed),
    (Color::Grey, LinePattern::Dashed),
];
/// How far each law falls is shown, too.
const UPSIDE_DOWN_SCENES: [&str; 2] = ["upside down", "heavy"];

/// A finished comparison.
pub struct Compared<'a> {
    /// The flown scenario, and the text it was read from.
    pub file: &'a Scenario,
    /// Likewise.
    pub text: &'a str,
    /// The rivals' gains.
    pub set: &'a Set,
    /// The laws' names, ours first.
    pub names: &'a [&'static str],
    /// The table.
    pub rows: &'a [FigureRow],
    /// The scenes.
    pub scenes: &'a [Scene],
    /// Each law's figures in each scene; `None` if the flight ended early.
    pub figures: &'a [(&'static str, Vec<Option<SceneFigures>>)],
    /// Each law's figures in the random flights.
    pub thrown: &'a [Option<RandomFlights>],
    /// Random flights of each law.
    pub flights: u64,
    /// Whether our claim holds.
    pub holds: bool,
}

/// The page of a comparison.
#[must_use]
pub fn page(compared: &Compared) -> Page {
    let Compared { file, text, rows, holds, .. } = compared;
    let named =
        compared.scenes.iter().map(|scene| (scene.name, scene.task)).chain([("random", "the random flights below")]);
    let tables = named.map(|(scene, task)| table(compared, scene, task));
    let sections = [
        ("Table", std::iter::once(Block::Text(STARS_NOTE.into())).chain(tables.map(Block::Table)).collect()),
        (
            "Scenes",
            vec![Block::Table(scenes(compared)), Block::Text(CURVES_NOTE.into()), Block::Plots(plots(compared))],
        ),
        ("Random flights", vec![Block::Text(random(compared)), Block::Distributions(distributions(compared))]),
        (
            "Laws",
            vec![
                Block::Table(laws(compared)),
                Block::Text(about_laws(compared)),
                Block::Folded("The rivals' gains".into(), gains(compared)),
            ],
        ),
        (
            "Scenario",
            vec![
                Block::Folded(
                    "Vehicle, our gains and all else, section by section".into(),
                    document::tables(text, "scenario"),
                ),
                Block::Listing("The file as it was read".into(), (*text).to_owned()),
            ],
        ),
    ];
    let sentence = if *holds {
        "Every random flight of ours settles, unclipped, within its bounds"
    } else {
        "Not every random flight of ours settles, unclipped, within its bounds"
    };
    let own = compared.thrown.first().and_then(Option::as_ref).map_or(&[][..], |thrown| &thrown.outcomes);
    let settled = own.iter().filter(|one| one.tracks()).count();
    let (cut, beyond) = own.iter().fold((0, 0), |(cut, beyond), one| (cut + one.clipped, beyond + one.beyond));
    let lost = rows.iter().filter(|row| row.lost()).count();
    Page {
        title: file.name.clone(),
        kind: "comparison".into(),
        verdict: Some((*holds, sentence.into())),
        lead: format!(
            "Our law and {} others on one vehicle, through the same allocation, rotors, sensors and clock, in {} scenes and {} random \
             flights each. The others are references for comparison; nothing is proven of them.",
            compared.set.rivals.len(),
            compared.scenes.len(),
            compared.flights
        ),
        highlights: vec![
            Fact::new("Random flights of ours that settle", format!("{settled} of {}", own.len())),
            Fact::new("Ticks of ours cut, beyond its bounds", format!("{cut}, {beyond}")),
            Fact::new("Rows where another law does better", format!("{lost} of {}", rows.len())),
            Fact::new("Written by", format!("host-sim {}", env!("CARGO_PKG_VERSION"))),
        ],
        tracks: tracks(compared),
        sections: sections.map(|(title, blocks)| Section { title: title.into(), blocks }).into(),
    }
}

const STARS_NOTE: &str = "Less is better in every row. ★ marks the rows where another law does clearly better than ours. “Never” is a flight that does not \
                     come to its reference for good, or that could not be flown to its end. The limit is an estimate of what \
                     rotors and inertia leave possible, whatever the law.";
const CURVES_NOTE: &str =
    "Distances are on a logarithmic scale. Each name in a legend hides its curve or shows it again.";
const LAWS_NOTE: &str = "The rivals' gains were found by the trials and the cost that ours are tuned by; the cost of each \
                    stands above its gains, less is better. Continuous and memoryless differ in their choice of \
                     quaternion alone.";

/// The task of each scene.
fn scenes(compared: &Compared) -> Table {
    let mut table = Table::new("The scenes", &["scene", "task", "duration"]);
    table.rows.extend(compared.scenes.iter().map(|scene| {
        let duration = Cell::number(format!("{} s", short(scene.scenario.timing.duration())));
        vec![Cell::text(scene.name), Cell::text(scene.task), duration]
    }));
    table
}

/// The rows of one scene.
fn table(compared: &Compared, scene: &str, task: &str) -> Table {
    let laws = compared.names.iter().copied();
    let head: Vec<&str> = ["figure", "ours loses"].into_iter().chain(laws).chain([LIMIT_COLUMN]).collect();
    let mut table = Table::new(format!("{}: {task}", titled(scene)), &head);
    table.rows.extend(compared.rows.iter().filter(|row| row.scene == scene).map(|row| {
        let head = [format!("{}, {}", row.figure, row.unit), if row.lost() { "★" } else { "" }.to_owned()];
        let values = row.values.iter().map(|value| cell(*value)).chain([row.limit.map_or_else(String::new, cell)]);
        let values = values.map(Cell::Number);
        head.map(Cell::Text).into_iter().chain(values).collect()
    }));
    table
}

/// One track a scene: each law's distance from the reference, and its height above the start.
fn tracks(compared: &Compared) -> Vec<Track> {
    let single = |points: &[(f64, f64)]| points.iter().map(|(_, value)| *value as f32).collect::<Vec<f32>>();
    let of_scene = |(name, figures): &(&'static str, Vec<Option<SceneFigures>>)| {
        let laws = compared.names.iter().zip(figures).filter_map(|(law, figures)| Some((law, figures.as_ref()?)));
        let columns = laws.flat_map(|(law, figures)| {
            let height = UPSIDE_DOWN_SCENES.contains(name).then(|| (format!("{law}_height"), single(&figures.height)));
            std::iter::once((format!("{law}_error"), single(&figures.error))).chain(height)
        });
        let step = PICTURE_PERIOD_US as f64 * 1e-6;
        Track { name: (*name).to_owned(), start: 0.0, step, columns: columns.collect() }
    };
    compared.figures.iter().map(of_scene).collect()
}

/// The curve of the law at this place, its column named after it. Ours is broad.
pub fn curve(place: usize, law: &str) -> Curve {
    let (color, line) = CURVE_LOOKS[place % CURVE_LOOKS.len()];
    Curve { line, broad: place == 0, ..Curve::new(law, law, color) }
}

/// The courses of all laws in each scene.
fn plots(compared: &Compared) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (track, (scene, figures)) in compared.figures.iter().enumerate() {
        let curves = |quantity: &str| {
            let drawn = |(place, law): (usize, &&'static str)| {
                figures.get(place)?.as_ref()?;
                Some(Curve { track, column: format!("{law}_{quantity}"), ..curve(place, law) })
            };
            compared.names.iter().enumerate().filter_map(drawn).collect()
        };
        let title = titled(scene);
        plots.push(Plot::new(&format!("{title}: error"), "m", curves("error")).logarithmic());
        if UPSIDE_DOWN_SCENES.contains(scene) {
            plots.push(Plot::new(&format!("{title}: height"), "m", curves("height")));
        }
    }
    plots
}

fn random(compared: &Compared) -> String {
    let ranges = &compared.file.campaign.ranges;
    format!(
        "{} flights of {} s from seed {}: the flights that campaign --law NAME flies, the same for every law. A flight that never comes to its \
         reference is counted and not drawn.",
        compared.flights,
        short(ranges.duration),
        compared.file.campaign.seed
    )
}

/// A figure of one flight; infinite if the flight has none.
type Get = fn(&Outcome) -> f64;

fn distributions(compared: &Compared) -> Vec<Distribution> {
    let spread = |title: &str, unit: &str, logarithmic: bool, bound: Option<f64>, get: Get| {
        let group = |(law, thrown): (&&'static str, &Option<RandomFlights>)| {
            let outcomes = thrown.iter().flat_map(|thrown| &thrown.outcomes);
            ((*law).to_owned(), outcomes.map(get).collect())
        };
        let groups: Vec<(String, Vec<f64>)> = compared.names.iter().zip(compared.thrown).map(group).collect();
        let looks = CURVE_LOOKS.iter().copied().cycle().take(groups.len()).collect();
        Distribution { title: title.to_owned(), unit: unit.to_owned(), logarithmic, bound, groups, looks }
    };
    vec![
        spread("On the reference for good after", "s", false, None, |one| one.settled.unwrap_or(f64::INFINITY)),
        spread("Height lost", "m", false, None, |one| one.height_lost),
        spread("Distance from the reference at the end", "m", true, None, |one| one.final_error),
        spread("Greatest share of a bound certified of ours", "", true, Some(1.0), |one| one.shares.greatest()),
    ]
}

/// A description of each law.
fn laws(compared: &Compared) -> Table {
    let mut table = Table::new("Who flew", &["law", "what it is"]);
    let own = match compared.file.configuration.paper() {
        Some(_) => "the paper's law, certified",
        None => "the extended law, certified",
    };
    let rivals = compared.set.rivals.iter().map(|(kind, ..)| (kind.name(), kind.about()));
    let rows = std::iter::once((OUR_LAW, own)).chain(rivals);
    table.rows.extend(rows.map(|(law, about)| vec![Cell::text(law), Cell::text(about)]));
    table
}

fn about_laws(compared: &Compared) -> String {
    compared
        .set
        .left_out()
        .map_or_else(|| LAWS_NOTE.to_owned(), |left_out| format!("{LAWS_NOTE} {}.", titled(&left_out)))
}

/// A table for each rival.
fn gains(compared: &Compared) -> Vec<Table> {
    let of_rival = |(kind, gains, cost): &(RivalKind, Vec<f64>, f64)| {
        let mut table = Table::new(format!("{}: cost {}", kind.name(), short(*cost)), &["gain", "value"]);
        let rows =
            kind.gains().iter().zip(gains).map(|(name, value)| vec![Cell::text(*name), Cell::number(short(*value))]);
        table.rows.extend(rows);
        table
    };
    compared.set.rivals.iter().map(of_rival).collect()
}

/// A scene's name as a heading.
fn titled(scene: &str) -> String {
    let mut letters = scene.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
