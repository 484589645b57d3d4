//! The two quaternions of an attitude, and the half turn: the continuous law unwinds, noise holds the memoryless one at
//! half a turn, ours does neither and does not depend on the quaternion's sign.

use crate::support::random;
use controller_core::controller::{Controller as PaperController, Memory};
use controller_core::law::Law;
use controller_core::path_lifting::Lift;
use controller_core::position::FilterState;
use controller_core::state::Wrench;
use host_sim::flight::controller::Controller;
use host_sim::flight::law;
use host_sim::rivals::continuous::Continuous;
use host_sim::rivals::memoryless::Memoryless;
use host_sim::rivals::pilot::{RivalPilot, model};
use host_sim::rivals::quaternion_feedback::QuaternionFeedback;
use host_sim::rivals::rival::Rival;
use nalgebra::Quaternion;
use rand::RngExt;
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

/// The output and the memory do not depend on which of q and -q is given, to the last bit: they are one rotation.
#[test]
fn output_and_memory_do_not_depend_on_the_sign_of_the_quaternion() {
    let mut rng = random::generator(50);
    for number in 0..200 {
        let vehicle = random::vehicle(&mut rng);
        let gains = random::gains(&mut rng, &vehicle);
        let mut one = PaperController::uncertified(vehicle, gains, None, 0.01).unwrap();
        let mut other = one.clone();
        let mut reference = random::reference(&mut rng, &vehicle, &gains);
        let mut state = random::state_around(&mut rng, &reference);
        for tick in 0..200 {
            if rng.random_bool(0.05) {
                reference = random::reference(&mut rng, &vehicle, &gains);
            }
            // Mostly small turns, so that the memory matters; now and then anything, exact half turns among it.
            state.attitude = match rng.random_range(0..20) {
                0 => random::attitude(&mut rng),
                1 => Quaternion::from_imag(random::direction(&mut rng)),
                2 => Quaternion::new(0.0, 1.0, 0.0, 0.0),
                _ => {
                    let nudge = Quaternion::from_parts(1.0, random::vector(&mut rng, 0.1));
                    (state.attitude * nudge).normalize()
                }
            };
            let mut mirrored = state;
            mirrored.attitude = -state.attitude;
            let (wrench, diagnostics) = one.step(&state, &reference).unwrap();
            let (same, same_diagnostics) = other.step(&mirrored, &reference).unwrap();
            let bits = |w: &Wrench| [w.thrust, w.torque.x, w.torque.y, w.torque.z].map(f32::to_bits);
            assert_eq!(bits(&wrench), bits(&same), "run {number}, tick {tick}: {state:?}");
            assert_eq!(diagnostics, same_diagnostics, "run {number}, tick {tick}");
            assert_eq!(one.memory(), other.memory(), "run {number}, tick {tick}");
        }
    }
}
