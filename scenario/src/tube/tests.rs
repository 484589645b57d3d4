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
    let [lag, gain] = [Cells::new(FEW.lag, 4), Cells::new(FEW.inertia, 4)];
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

/// With the usual tolerances, and in the greatest gust that has a radius: minutes.
#[test]
#[ignore = "minutes; .ci/nightly runs it"]
fn no_vehicle_leaves_its_tube_within_the_usual_tolerances() {
    let names =
        ["hummingbird", "study", "published/x500", "published/pelican", "published/racer-pybullet", "published/iris"];
    for name in names {
        let scenario = vehicle(name);
        let loops = Loops::new(&scenario, &Tolerances::USUAL, &|_| true).unwrap();
        compare(&scenario, &loops, &Tolerances::USUAL, 0.1, 2.0);
        compare(&scenario, &loops, &Tolerances::USUAL, loops.greatest_gust(2.0), 2.5);
    }
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

/// A proof that ignores a part of what it is for is none.
#[test]
fn cells_that_leave_something_out_are_refused() {
    let scenario = vehicle("published/x500");
    let all = Cells::new(FEW.lag, 4);
    let gain = Cells::new(FEW.inertia, 4);
    let refused = |lag: &Cells, gain: &Cells| {
        matches!(Loops::in_cells(&scenario, &FEW, [lag, gain], &|_| true), Err(NoTube::LeftOut))
    };
    for left_out in 0..4 {
        let mut fewer = all.clone();
        fewer.middles.remove(left_out);
        assert!(!fewer.cover(FEW.lag) && refused(&fewer, &gain), "{left_out}");
    }
    let narrower = Cells { share: 0.9 * all.share, ..all.clone() };
    assert!(refused(&narrower, &gain));
    // The file's lag alone.
    assert!(refused(&Cells { middles: vec![1.0], share: 0.0 }, &gain));
    assert!(refused(&all, &Cells::new(0.5 * FEW.inertia, 4)));
    assert!(all.cover(FEW.lag) && Cells::new(0.3, 48).cover(0.3) && !Cells::new(0.3, 48).cover(0.31));
}

#[test]
fn the_papers_law_has_none() {
    let scenario = Scenario::parse(include_str!("../../../vehicles/hummingbird-paper-law.toml"), "paper's").unwrap();
    let refused = Loops::new(&scenario, &FEW, &|_| true).err().unwrap();
    assert_eq!(refused, NoTube::OtherLaw);
}
