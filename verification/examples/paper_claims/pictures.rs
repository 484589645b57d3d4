//! Two pictures: Section VI, and the half turn.

use crate::section_six::SectionSix;
use host_sim::plots::canvas::draw;
use host_sim::plots::panel::{BLUE, Bound, Curve, INK, Line, Panel, Scale, VERMILION};
use plotters::prelude::*;
use std::error::Error;
use verification::half_turn::Course;

fn curve(label: &str, color: RGBColor, line: Line, points: Vec<(f64, f64)>) -> Curve {
    Curve { label: label.to_owned(), color, line, width: if line == Line::Dashed { 2 } else { 3 }, points }
}

/// The paper's design over the other.
fn panel(
    title: &'static str,
    quantity: &'static str,
    scale: Scale,
    [first, second]: [(&str, Vec<(f64, f64)>); 2],
    bounds: Vec<Bound>,
) -> Panel {
    let curves = vec![curve(second.0, VERMILION, Line::Dashed, second.1), curve(first.0, BLUE, Line::Solid, first.1)];
    Panel { title, quantity, scale, curves, bounds }
}

fn drawn(panels: [Panel; 4]) -> Result<String, Box<dyn Error>> {
    Ok(draw((1240, 860), |root| {
        for (area, panel) in root.split_evenly((2, 2)).iter().zip(&panels) {
            panel.draw(area)?;
        }
        Ok(())
    })?)
}

pub fn section_six(ours: &SectionSix, other: &SectionSix) -> Result<String, Box<dyn Error>> {
    let limit = vec![Bound { value: 0.5, label: "limit of each axis: 0.5 N m".to_owned(), color: INK }];
    let both = |get: fn(&SectionSix) -> &Vec<(f64, f64)>| {
        [("filters (the paper)", get(ours).clone()), ("nested saturations", get(other).clone())]
    };
    drawn([
        panel("Section VI, first seconds: thrust", "N", Scale::Linear, both(|s| &s.thrusts), Vec::new()),
        panel("Section VI, first seconds: |torque|", "N m", Scale::Linear, both(|s| &s.torques), limit),
        panel("Section VI: position error", "m", Scale::Log, both(|s| &s.errors), Vec::new()),
        panel("Section VI: yaw error", "degrees", Scale::Log, both(|s| &s.yaws), Vec::new()),
    ])
}

pub fn half_turns(turns: &[Course; 2], held: &[Course; 2]) -> Result<String, Box<dyn Error>> {
    let degrees = |points: &[(f64, f64)]| points.iter().map(|(time, roll)| (*time, roll.to_degrees())).collect();
    let first = |points: &[(f64, f64)]| points.iter().copied().filter(|(time, _)| *time < 1.0).collect::<Vec<_>>();
    let names = ["hybrid (the paper)", "continuous", "memoryless"];
    drawn([
        panel(
            "Unwinding: roll",
            "degrees",
            Scale::Linear,
            [(names[0], degrees(&turns[0].roll)), (names[1], degrees(&turns[1].roll))],
            Vec::new(),
        ),
        panel(
            "Unwinding: torque about x",
            "N m",
            Scale::Linear,
            [(names[0], turns[0].torque.clone()), (names[1], turns[1].torque.clone())],
            Vec::new(),
        ),
        panel(
            "Half a turn, worst noise of 2 degrees: roll",
            "degrees",
            Scale::Linear,
            [(names[0], degrees(&held[0].roll)), (names[2], degrees(&held[1].roll))],
            Vec::new(),
        ),
        panel(
            "The same, first second: torque about x",
            "N m",
            Scale::Linear,
            [(names[0], first(&held[0].torque)), (names[2], first(&held[1].torque))],
            Vec::new(),
        ),
    ])
}
