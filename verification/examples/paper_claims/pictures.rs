//! Two pictures: Section VI, and the half turn.

use crate::section_six::SectionSix;
use host_sim::reports::plots::four;
use host_sim::reports::report::plot::{Bound, Color, Curve, Plot};
use host_sim::reports::report::track::Track;
use verification::half_turn::Course;

/// Width and height of a plot, pixels.
const PLOT_SIZE_PIXELS: (f64, f64) = (620.0, 430.0);

type Points = Vec<(f64, f64)>;

/// The paper's design over the other.
fn panel(title: &str, unit: &str, [first, second]: [(&str, Points); 2]) -> (Plot, Track) {
    let curves =
        vec![Curve::new(second.0, second.0, Color::Vermilion).dashed(), Curve::new(first.0, first.0, Color::Blue)];
    (
        Plot::new(title, unit, curves),
        Track::of_points([first, second].map(|(name, points)| (name.to_owned(), points)).into()),
    )
}

fn decades((plot, track): (Plot, Track)) -> (Plot, Track) {
    (plot.logarithmic(), track)
}

fn drawn(panels: &[(Plot, Track); 4], about: &str) -> String {
    four(panels.iter().map(|(plot, track)| (plot, std::slice::from_ref(track))), PLOT_SIZE_PIXELS, about)
}

pub fn section_six(ours: &SectionSix, other: &SectionSix) -> String {
    let limit = vec![Bound { value: 0.5, label: "limit of each axis".to_owned(), color: Color::Ink, always: true }];
    let both = |get: fn(&SectionSix) -> &Points| {
        [("filters (the paper)", get(ours).clone()), ("nested saturations", get(other).clone())]
    };
    let (torque, torques) = panel("Section VI, first seconds: |torque|", "N m", both(|s| &s.torques));
    drawn(
        &[
            panel("Section VI, first seconds: thrust", "N", both(|s| &s.thrusts)),
            (torque.within(limit), torques),
            decades(panel("Section VI: position error", "m", both(|s| &s.errors))),
            decades(panel("Section VI: yaw error", "°", both(|s| &s.yaws))),
        ],
        "Section VI",
    )
}

pub fn half_turns(turns: &[Course; 2], held: &[Course; 2]) -> String {
    let degrees = |points: &[(f64, f64)]| points.iter().map(|(time, roll)| (*time, roll.to_degrees())).collect();
    let first = |points: &[(f64, f64)]| points.iter().copied().filter(|(time, _)| *time < 1.0).collect();
    let names = ["hybrid (the paper)", "continuous", "memoryless"];
    drawn(
        &[
            panel("Unwinding: roll", "°", [(names[0], degrees(&turns[0].roll)), (names[1], degrees(&turns[1].roll))]),
            panel(
                "Unwinding: torque about x",
                "N m",
                [(names[0], turns[0].torque.clone()), (names[1], turns[1].torque.clone())],
            ),
            panel(
                "Half a turn, worst noise of 2 degrees: roll",
                "°",
                [(names[0], degrees(&held[0].roll)), (names[2], degrees(&held[1].roll))],
            ),
            panel(
                "The same, first second: torque about x",
                "N m",
                [(names[0], first(&held[0].torque)), (names[2], first(&held[1].torque))],
            ),
        ],
        "Unwinding and half a turn",
    )
}
