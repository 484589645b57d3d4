//! Attitude laws near the half turn: the continuous one unwinds, noise holds the memoryless one there, ours does
//! neither.

use controller_core::controller::Memory;
use controller_core::law::Law;
use controller_core::path_lifting::Lift;
use controller_core::position::FilterState;
use host_sim::flight::controller::Controller;
use host_sim::flight::law;
use host_sim::rivals::continuous::Continuous;
use host_sim::rivals::memoryless::Memoryless;
use host_sim::rivals::pilot::{RivalPilot, model};
use host_sim::rivals::quaternion_feedback::QuaternionFeedback;
use host_sim::rivals::rival::Rival;
use nalgebra::Quaternion;
use scenario::Scenario;
use verification::half_turn::{GAINS_LIKE_TABLE_1, Trial};

fn rival(scenario: &Scenario, build: impl FnOnce(QuaternionFeedback) -> Box<dyn Rival>) -> Controller {
    let feedback = QuaternionFeedback::new(model(scenario), GAINS_LIKE_TABLE_1);
    Controller::Rival(Box::new(RivalPilot::new(scenario, build(feedback))))
}

#[test]
fn the_continuous_law_turns_the_long_way_and_ours_does_not() {
    let paper = Scenario::paper().unwrap();
    let trial = Trial::unwinding();
    let long = trial.fly(&paper, rival(&paper, |law| Box::new(Continuous::after_a_turn(law)))).unwrap();
    let short = trial.fly(&paper, rival(&paper, |law| Box::new(Continuous::new(law)))).unwrap();
    // Ours in the worst memory: that of the other side of the sphere.
    let mut wound = law(&paper).unwrap();
    if let Law::Paper(controller) = &mut wound {
        let memory = Quaternion::new(-1.0, 0.0, 0.0, 0.0);
        controller.restore(Memory { filter: FilterState::ZERO, lift: Some(Lift { memory, sign: 1.0 }) });
    }
    let ours = trial.fly(&paper, Controller::Ours(wound)).unwrap();
    println!("{:.1} {:.1} {:.1}", long.turned.to_degrees(), short.turned.to_degrees(), ours.turned.to_degrees());
    assert!(long.turned.to_degrees() > 320.0);
    assert!(short.turned.to_degrees() < 90.0 && ours.turned.to_degrees() < 90.0);
}

#[test]
fn noise_holds_the_memoryless_law_at_half_a_turn_and_ours_leaves() {
    let paper = Scenario::paper().unwrap();
    let trial = Trial::held(2_f64.to_radians());
    let held = trial.fly(&paper, rival(&paper, |law| Box::new(Memoryless(law)))).unwrap();
    let ours = trial.fly(&paper, Controller::Ours(law(&paper).unwrap())).unwrap();
    println!("{} {} {} {}", held.left_after, held.reversals, ours.left_after, ours.reversals);
    assert!(held.left_after >= 5.0 && held.reversals > 50, "{} {}", held.left_after, held.reversals);
    assert!(ours.left_after < 0.5 && ours.reversals < 5, "{} {}", ours.left_after, ours.reversals);
}
