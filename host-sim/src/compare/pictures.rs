//! The pictures of a comparison: curves of all laws over each other, ours on top.
//!
//! Colours are Okabe and Ito's, with a grey; ours is black and thick. Patterns are those of the page's [`LOOKS`].

use super::page::LOOKS;
use super::shown::{Shown, Thrown};
use crate::plots::canvas::{PlotError, draw};
use crate::plots::panel::{BLUE, Curve, GREEN, Panel, Scale, VERMILION};
use crate::rivals::kind::Kind;
use plotters::prelude::*;

/// Width and height of a picture, pixels.
const SIZE: (u32, u32) = (1400, 900);
const BLACK_INK: RGBColor = RGBColor(0, 0, 0);
const ORANGE: RGBColor = RGBColor(230, 159, 0);
const SKY: RGBColor = RGBColor(86, 180, 233);
const PURPLE: RGBColor = RGBColor(204, 121, 167);
const GREY: RGBColor = RGBColor(120, 120, 120);
/// Ours, then the rivals in their order.
const INKS: [RGBColor; LOOKS.len()] = [BLACK_INK, BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, GREY];

/// One of the quantities shown, over time.
type Get = fn(&Shown) -> &Vec<(f64, f64)>;

/// One curve of each law.
fn curves(names: &[&str], points: impl Fn(usize) -> Option<Vec<(f64, f64)>>) -> Vec<Curve> {
    let curve = |law: usize| {
        let (color, (_, line)) = (INKS[law % INKS.len()], LOOKS[law % LOOKS.len()]);
        let label = names.get(law).map_or_else(String::new, |name| (*name).to_owned());
        Some(Curve { label, color, line, width: if law == 0 { 4 } else { 2 }, points: points(law)? })
    };
    // Ours last: on top. One of the two laws that differ about half a turn only is enough.
    (0..names.len()).rev().filter(|law| names.get(*law) != Some(&Kind::Continuous.name())).filter_map(curve).collect()
}

/// Curves of `get` in the scene called `name`, cut at `end` s and at `most` in the panel's unit.
fn panel(
    title: &'static str,
    quantity: &'static str,
    scale: Scale,
    names: &[&str],
    (shown, get): (&[Option<Shown>], Get),
    (end, least, most): (f64, f64, f64),
) -> Panel {
    let points = |law: usize| {
        let all = get(shown.get(law)?.as_ref()?);
        let seen = all.iter().take_while(|(time, _)| *time <= end);
        Some(seen.map(|(time, value)| (*time, value.clamp(least, most))).collect())
    };
    Panel { title, quantity, scale, curves: curves(names, points), bounds: Vec::new() }
}

/// Recovery, gust, storm and far step.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses.
pub fn scenes(names: &[&str], all: &[(&'static str, Vec<Option<Shown>>)]) -> Result<String, PlotError> {
    let of = |name: &str| all.iter().find(|(scene, _)| *scene == name).map_or(&[][..], |(_, shown)| shown);
    let height: Get = |shown| &shown.height;
    let error: Get = |shown| &shown.error;
    let free = (-f64::MAX, f64::MAX);
    four([
        panel(
            "From upside down: height",
            "m",
            Scale::Linear,
            names,
            (of("upside down"), height),
            (12.0, -25.0, free.1),
        ),
        panel("5 m/s of wind: error", "m", Scale::Linear, names, (of("gust"), error), (8.0, free.0, 1.5)),
        panel("10 m away: error", "m", Scale::Log, names, (of("far step"), error), (20.0, 1e-4, 100.0)),
        panel("12 m/s of wind: error", "m", Scale::Log, names, (of("storm"), error), (20.0, 1e-3, 1000.0)),
    ])
}

/// The random flights: how many have settled by when; and the file's own flight, noise and weak rotors.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses.
pub fn random(
    names: &[&str],
    thrown: &[Option<Thrown>],
    all: &[(&'static str, Vec<Option<Shown>>)],
) -> Result<String, PlotError> {
    let of = |name: &str| all.iter().find(|(scene, _)| *scene == name).map_or(&[][..], |(_, shown)| shown);
    let settled = |law: usize| {
        let thrown = thrown.get(law)?.as_ref()?;
        let share = |time: f64| 100.0 * thrown.share(|one| one.settled.is_some_and(|settled| settled <= time));
        Some((0..=600).map(|step| f64::from(step) * 0.05).map(|time| (time, share(time))).collect())
    };
    let error: Get = |shown| &shown.error;
    four([
        Panel {
            title: "Random starts: settled by then",
            quantity: "% of flights",
            scale: Scale::Linear,
            curves: curves(names, settled),
            bounds: Vec::new(),
        },
        panel("The file's own flight: error", "m", Scale::Log, names, (of("own"), error), (20.0, 1e-4, 100.0)),
        panel("Noise: error", "m", Scale::Log, names, (of("noise"), error), (10.0, 1e-4, 10.0)),
        panel("Rotors at 60 %: error", "m", Scale::Log, names, (of("weak rotors"), error), (20.0, 1e-4, 1000.0)),
    ])
}

fn four(panels: [Panel; 4]) -> Result<String, PlotError> {
    draw(SIZE, |root| {
        for (area, panel) in root.split_evenly((2, 2)).iter().zip(&panels) {
            panel.draw(area)?;
        }
        Ok(())
    })
}
