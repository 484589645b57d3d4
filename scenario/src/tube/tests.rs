//! The proof beside flights of the law on the model, in the gusts that take its loops farthest.

use super::*;
use crate::body::BodyState;
use crate::model::Model;
use crate::sampled_loop::LoopTiming;
use controller_core::certificate::certified::Certified;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::reference::Reference;
use nalgebra::{Quaternion, Vector3};

const AXES: [Axis; 3] = [Axis::LateralX, Axis::LateralY, Axis::Vertical];

/// A part of the usual tolerances, in few cells: quick.
const FEW: Tolerances = Tolerances { lag: 0.04, inertia: 0.02 };

fn vehicle(name: &str) -> Scenario {
    let text = std::fs::read_to_string(format!("../vehicles/{name}.toml")).unwrap();
    Scenario::parse(&text, name).unwrap()
}

fn quick(scenario: &Scenario) -> Loops<'_> {
    let [lag, gain] = FEW.ranges().map(|range| Cells::new(range, 4));
    Loops::in_cells(scenario, &FEW, [&lag, &gain], &|_| true).unwrap()
}

/// How far the vehicle comes from its hover while `gust`, a force for each tick, pushes it along `axis`, m, with so
/// many times its rotors' lag and moments of inertia.
fn flown(scenario: &Scenario, axis: Axis, gust: &[f64], [lag, inertia]: [f64; 2]) -> f64 {
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let timing = scenario.loop_timing();
    let mut law = Law::new(&certified, timing.period as f32).unwrap();
    let timing = LoopTiming { rotor_lag: lag * timing.rotor_lag, ..timing };
    let body = BodyState {
        position: Vector3::zeros(),
        velocity: Vector3::zeros(),
        attitude: Quaternion::identity(),
        angular_velocity: Vector3::zeros(),
    };
    let mut model = Model::new(scenario.configuration.vehicle(), &timing, body);
    model.inertia *= inertia;
    let along = [Vector3::x(), Vector3::y(), Vector3::z()][place(axis)];
    let reference = Reference::resting(Vector3::zeros(), Heading::FORWARD);
    let mut farthest = 0.0_f64;
    for force in gust {
        let command = law.command(&model.body.measured(), &reference).unwrap();
        model.push = along * *force;
        model.advance(&command.wrench.scaled(1.0 / law.thrust_scale()));
        farthest = farthest.max(model.body.position.norm());
    }
    assert_eq!((law.fallback_times(), law.lost()), (0, None));
    farthest
}

/// No flight leaves the tube, whatever the lag and the inertia, and the worst comes near it.
fn compare(scenario: &Scenario, loops: &Loops<'_>, tolerances: &Tolerances, gust: f64, ratio: f64) {
    let tube = loops.tube(gust).unwrap();
    let factors = |share: f64| [1.0 - share, 1.0, 1.0 + share];
    for axis in AXES {
        let force: Vec<f64> = tube.worst_gust(axis).iter().map(|sign| gust * sign).collect();
        let worst = factors(tolerances.lag)
            .into_iter()
            .flat_map(|lag| factors(tolerances.inertia).map(|inertia| flown(scenario, axis, &force, [lag, inertia])))
            .fold(0.0, f64::max);
        let radius = tube.radius(axis);
        println!(
            "{} {gust:.3} m/s^2 {:10} {radius:.5} m, flown {worst:.5}: {:.2}",
            scenario.name,
            axis.name(),
            radius / worst
        );
        assert!(worst <= radius && radius <= ratio * worst, "{}: {axis:?} {radius}, flown {worst}", scenario.name);
    }
}

#[test]
fn no_worst_gust_takes_a_vehicle_out_of_its_tube() {
    for (name, gust, ratio) in
        [("published/racer-pybullet", 0.1, 1.2), ("published/x500", 0.1, 1.4), ("study", 0.1, 1.8)]
    {
        let scenario = vehicle(name);
        compare(&scenario, &quick(&scenario), &FEW, gust, ratio);
    }
}

/// With the usual tolerances, and in the greatest gust that has a radius: of the vehicle that has no lag, and if
/// `TUBES=all`, as `.ci/nightly` has it, of six.
#[test]
fn no_vehicle_leaves_its_tube_within_the_usual_tolerances() {
    let names =
        ["hummingbird", "study", "published/x500", "published/pelican", "published/racer-pybullet", "published/iris"];
    let everything = std::env::var("TUBES").is_ok_and(|tubes| tubes == "all");
    for name in names.into_iter().filter(|name| everything || name.ends_with("racer-pybullet")) {
        let scenario = vehicle(name);
        let loops = Loops::new(&scenario, &Tolerances::USUAL, &|_| true).unwrap();
        compare(&scenario, &loops, &Tolerances::USUAL, 0.1, 2.0);
        compare(&scenario, &loops, &Tolerances::USUAL, loops.greatest_gust(2.0), 2.5);
    }
}

/// The premise that the thrust scale is right and stands still is one: a gust within the set that goes on for a quarter
/// of an hour teaches the law a scale of 1.15, and the worst gust then takes it farther than the radius.
#[test]
fn a_long_gust_teaches_a_false_thrust_scale_and_with_it_the_tube_is_left() {
    let scenario = vehicle("hummingbird");
    let tube = quick(&scenario).tube(0.1).unwrap();
    let axis = Axis::Vertical;
    let teaching = (0..90_000).map(|tick| if tick / 8 % 2 == 0 { 1.0 } else { -1.0 });
    let calm = core::iter::repeat_n(0.0, 600);
    let gust: Vec<f64> =
        teaching.chain(calm).chain(tube.worst_gust(axis).iter().copied()).map(|share| 0.1 * share).collect();
    let far = flown(&scenario, axis, &gust, [0.7, 1.0]) / tube.radius(axis);
    println!("{far:.3} times the radius");
    assert!(far > 1.1 && far < 1.2, "{far}");
}

#[test]
fn a_stronger_gust_takes_it_farther_until_there_is_no_radius() {
    let scenario = vehicle("published/racer-pybullet");
    let loops = quick(&scenario);
    let radii = [0.05, 0.1, 0.2, 0.4].map(|gust| loops.tube(gust).unwrap().greatest());
    assert!(radii.windows(2).all(|pair| pair[1] > 1.9 * pair[0]), "{radii:?}");
    let greatest = loops.greatest_gust(2.0);
    assert!(loops.tube(greatest).is_ok() && greatest > 0.4);
    let refused = loops.tube(1.02 * greatest + 0.01).unwrap_err();
    assert!(matches!(refused, NoTube::Reached { .. } | NoTube::Grows { .. }), "{refused}");
}

/// A proof that ignores a part of its tolerances proves nothing.
#[test]
fn cells_that_leave_something_out_are_refused() {
    let scenario = vehicle("published/x500");
    let [lag_range, gain_range] = FEW.ranges();
    let [all, gain] = [Cells::new(lag_range, 4), Cells::new(gain_range, 4)];
    let refused = |lag: &Cells, gain: &Cells| {
        matches!(Loops::in_cells(&scenario, &FEW, [lag, gain], &|_| true), Err(NoTube::LeftOut))
    };
    for left_out in 0..4 {
        let mut fewer = all.clone();
        fewer.middles.remove(left_out);
        assert!(!fewer.cover(lag_range) && refused(&fewer, &gain), "{left_out}");
    }
    let narrower = Cells { share: 0.9 * all.share, ..all.clone() };
    assert!(refused(&narrower, &gain));
    // The file's lag alone.
    assert!(refused(&Cells { middles: vec![1.0], share: 0.0 }, &gain));
    // A lighter body answers by the inverse of its inertia, which is more than one and the tolerance.
    let linear = [1.0 - FEW.inertia, 1.0 + FEW.inertia];
    assert!(!Cells::new(linear, 4).cover(gain_range) && refused(&all, &Cells::new(linear, 4)));
    assert!(all.cover(lag_range) && !all.cover([0.96, 1.041]) && !all.cover([0.959, 1.04]));
}

#[test]
fn the_papers_law_has_none() {
    let scenario = Scenario::parse(include_str!("../../../vehicles/hummingbird-paper-law.toml"), "paper's").unwrap();
    let refused = Loops::new(&scenario, &FEW, &|_| true).err().unwrap();
    assert_eq!(refused, NoTube::OtherLaw);
}
