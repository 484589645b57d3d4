//! The pictures of a comparison: curves of all laws over each other, ours on top.
//!
//! Colours and patterns are those of the page's [`super::page::CURVE_LOOKS`]; ours is black and broad.

use super::page::curve;
use super::scene_figures::{RandomFlights, SceneFigures};
use crate::reports::plots::four;
use crate::reports::report::plot::Plot;
use crate::reports::report::track::Track;
use crate::rivals::kind::RivalKind;

/// Width and height.
const PLOT_SIZE_PIXELS: (f64, f64) = (700.0, 450.0);

/// One of the quantities shown, over time.
type Get = fn(&SceneFigures) -> &Vec<(f64, f64)>;
/// The scenes by name, with each law's figures.
type Scenes<'a> = &'a [(&'static str, Vec<Option<SceneFigures>>)];

/// One curve of each law that has `points`.
fn panel(title: &str, unit: &str, names: &[&str], points: impl Fn(usize) -> Option<Vec<(f64, f64)>>) -> (Plot, Track) {
    // Ours last: on top. One of the two laws that differ about half a turn only is enough.
    let laws = names.iter().enumerate().rev().filter(|(_, law)| **law != RivalKind::Continuous.name());
    let drawn = laws.filter_map(|(place, law)| Some((curve(place, law), ((*law).to_owned(), points(place)?))));
    let (curves, columns) = drawn.unzip();
    (Plot::new(title, unit, curves), Track::of_points(columns))
}

/// Curves of `get` in the scene called `name`, cut at `end` s and to what lies between `least` and `most`.
fn scene(
    title: &str,
    names: &[&str],
    (all, name, get): (Scenes, &str, Get),
    (end, least, most): (f64, f64, f64),
) -> (Plot, Track) {
    let figures = all.iter().find(|(scene, _)| *scene == name).map_or(&[][..], |(_, figures)| figures);
    panel(title, "m", names, |law| {
        let seen = get(figures.get(law)?.as_ref()?).iter().take_while(|(time, _)| *time <= end);
        Some(seen.map(|(time, value)| (*time, value.clamp(least, most))).collect())
    })
}

/// The same over decades.
fn decades(title: &str, names: &[&str], (all, name): (Scenes, &str), cut: (f64, f64, f64)) -> (Plot, Track) {
    let (plot, track) = scene(title, names, (all, name, |figures| &figures.error), cut);
    (plot.logarithmic(), track)
}

/// Recovery, gust, storm and far step.
#[must_use]
pub fn scenes(names: &[&str], all: Scenes) -> String {
    drawn(
        &[
            scene(
                "From upside down: height",
                names,
                (all, "upside down", |figures| &figures.height),
                (12.0, -25.0, f64::MAX),
            ),
            scene("5 m/s of wind: error", names, (all, "gust", |figures| &figures.error), (8.0, 0.0, 1.5)),
            decades("10 m away: error", names, (all, "far step"), (20.0, 1e-4, 100.0)),
            decades("12 m/s of wind: error", names, (all, "storm"), (20.0, 1e-3, 1000.0)),
        ],
        "Scenes",
    )
}

/// The random flights: how many have settled by when; and the file's own flight, noise and weak rotors.
#[must_use]
pub fn random(names: &[&str], thrown: &[Option<RandomFlights>], all: Scenes) -> String {
    let settled = |law: usize| {
        let thrown = thrown.get(law)?.as_ref()?;
        let share = |time: f64| 100.0 * thrown.share(|one| one.settled.is_some_and(|settled| settled <= time));
        Some((0..=600).map(|step| f64::from(step) * 0.05).map(|time| (time, share(time))).collect())
    };
    drawn(
        &[
            panel("Random starts, % of flights: settled by then", "%", names, settled),
            decades("The file's own flight: error", names, (all, "own"), (20.0, 1e-4, 100.0)),
            decades("Noise: error", names, (all, "noise"), (10.0, 1e-4, 10.0)),
            decades("Rotors at 60 %: error", names, (all, "weak rotors"), (20.0, 1e-4, 1000.0)),
        ],
        "Random flights, and more scenes",
    )
}

fn drawn(panels: &[(Plot, Track); 4], about: &str) -> String {
    four(panels.iter().map(|(plot, track)| (plot, std::slice::from_ref(track))), PLOT_SIZE_PIXELS, about)
}
