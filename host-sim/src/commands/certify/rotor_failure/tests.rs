//! The simulated vehicle comes to the relaxed hover, and what becomes of each vehicle is said with its reason.

use super::*;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");
const PELICAN: &str = include_str!("../../../../../vehicles/published/pelican.toml");

fn certified(text: &str) -> (Scenario, Certified) {
    let scenario = Scenario::parse(text, "f").unwrap();
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    (scenario, certified)
}

fn said(text: &str) -> String {
    let (scenario, certified) = certified(text);
    lines(&scenario, Some(&certified)).unwrap()
}

#[test]
fn the_simulated_vehicle_comes_to_the_relaxed_hover() {
    // The Hummingbird's file has drag of its rotors, the other one has none.
    for text in [HUMMINGBIRD, PELICAN] {
        let (scenario, certified) = certified(text);
        for rotor in [0, 1] {
            let (flown, mut flight) = flown(&scenario, &certified, rotor).unwrap();
            let law = WithoutARotor::new(&scenario.configuration, rotor, scenario.timing.period() as f32).unwrap();
            let (vehicle, rotors) = (scenario.configuration.vehicle(), scenario.configuration.rotors().unwrap());
            let drag = scenario.reality.drag.unwrap_or_default();
            let hover = |axis: &Vector3<f64>| RelaxedHover::new(vehicle, rotors, &drag, rotor, axis).unwrap();

            let there = hover(&upwards(&flown.turning, &law));
            let turning = flown.turning.norm() * flown.turning.z.signum();
            assert!((there.rate / turning - 1.0).abs() < 0.03, "{there:?}, flown {turning}");
            let thrusts = flight.tick().unwrap().rotors;
            for (thrust, found) in thrusts.iter().zip(there.thrusts) {
                assert!((thrust - found).abs() < 0.05 * found.max(1.0), "{there:?}, flown {thrusts:?}");
            }
            // Before any flight, about the law's own axis.
            assert!((hover(&law.axis()).rate / turning - 1.0).abs() < 0.1, "{turning}");
        }
    }
}

#[test]
fn a_vehicle_that_survives_says_how() {
    let text = said(HUMMINGBIRD);
    assert!(text.starts_with("a rotor gone (flights of the model, from hover): survived\n"), "{text}");
    let row = text.lines().nth(2).unwrap();
    assert!(row.starts_with("each  ") && row.contains("any height") && row.ends_with(" rad/s"), "{text}");
    assert!(text.contains("\nturning, small motions (an analysis): spectral radius 0.") && text.contains(", stable; "));
    let six = said(include_str!("../../../../../vehicles/published/firefly.toml"));
    assert!(six.contains("): survived\n") && six.lines().last().unwrap().ends_with("keeps its heading"), "{six}");
}

#[test]
fn a_vehicle_that_does_not_says_what_it_needs() {
    let weak = said(include_str!("../../../../../vehicles/published/x500.toml"));
    assert!(weak.starts_with("a rotor gone (flights of the model, from hover): NOT survived\n"), "{weak}");
    assert!(weak.contains("each: too little thrust: two rotors hold 0.8") && weak.contains("lost after "), "{weak}");
    let sphere = said(include_str!("../../../../../vehicles/published/racer-pybullet.toml"));
    assert!(sphere.contains("each: nothing stops it from turning faster; give [drag]: "), "{sphere}");
    assert!(sphere.contains("; land within 1"), "{sphere}");
    let quick = said(include_str!("../../../../../vehicles/published/cf2x-pybullet.toml"));
    assert!(quick.contains("each: it turns up to 54 rad/s, too fast for control.rate") && quick.contains("UNSTABLE"));
    let (paper, certificate) = certified(scenario::PAPER);
    assert_eq!(lines(&paper, Some(&certificate)).unwrap(), "a rotor gone: no rotors in the file\n");
    let study = said(scenario::STUDY);
    assert!(study.starts_with("a rotor gone (flights of the model, from hover): survived"), "{study}");
    let papers = said(include_str!("../../../../../vehicles/study-paper-law.toml"));
    assert!(papers.starts_with("a rotor gone: NOT survived: the paper's law"), "{papers}");
}
