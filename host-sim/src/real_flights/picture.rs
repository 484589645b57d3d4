//! A picture of a flight that was flown, beside the same under our law.

use super::flown::PERIOD_S;
use crate::reports::plots::four;
use crate::reports::report::plot::{Color, Curve, Plot};
use crate::reports::report::track::Track;
use nalgebra::Vector3;

/// Each panel's width and height, pixels.
const PANEL_PIXELS: (f64, f64) = (620.0, 330.0);

/// An SVG: setpoint, flown and ours along each axis, and both distances from the setpoint.
pub fn drawn(track: &[[Vector3<f64>; 3]]) -> String {
    let column = |name: &str, of: &dyn Fn(&[Vector3<f64>; 3]) -> f64| {
        (name.to_owned(), track.iter().map(|places| of(places) as f32).collect())
    };
    let mut columns = Vec::new();
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        for (which, of) in ["setpoint", "flown", "ours"].into_iter().enumerate() {
            columns.push(column(&format!("{name} {of}"), &|places| places[which][axis]));
        }
    }
    for (which, of) in [(1, "flown"), (2, "ours")] {
        columns.push(column(&format!("off {of}"), &|places| (places[which] - places[0]).norm()));
    }
    let tracks = [Track { name: String::new(), start: 0.0, step: PERIOD_S, columns }];
    let curve = |name: &str, of: &str, color: Color| Curve::new(format!("{name} {of}"), of, color);
    let axis = |name: &str| {
        let curves = vec![
            curve(name, "setpoint", Color::Ink).dashed(),
            curve(name, "flown", Color::Vermilion),
            curve(name, "ours", Color::Blue),
        ];
        Plot::new(&format!("Position {name}"), "m", curves)
    };
    let off = Plot::new(
        "Distance from the setpoint",
        "m",
        vec![curve("off", "flown", Color::Vermilion), curve("off", "ours", Color::Blue)],
    );
    let plots = [axis("x"), axis("y"), axis("z"), off];
    let about = "Setpoints of a real flight, where it flew, and where our law would have flown";
    four(plots.iter().map(|plot| (plot, &tracks[..])), PANEL_PIXELS, about)
}
