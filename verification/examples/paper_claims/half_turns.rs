//! What the hybrid law is for: attitude errors about half a turn.

use crate::claims::Claims;
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
use std::error::Error;
use verification::half_turn::{Course, GAINS_LIKE_TABLE_1, Trial};

/// Unwinding and chattering.
pub fn claim(claims: &mut Claims, paper: &Scenario) -> Result<([Course; 2], [Course; 2]), Box<dyn Error>> {
    let feedback = || QuaternionFeedback::new(model(paper), GAINS_LIKE_TABLE_1);
    let rival = |rival: Box<dyn Rival>| Controller::Rival(Box::new(RivalPilot::new(paper, rival)));
    let memoryless = || rival(Box::new(Memoryless(feedback())));
    let ours = || law(paper).map(Controller::Ours);
    let mut wound = law(paper)?;
    if let Law::Paper(controller) = &mut wound {
        let lift = Some(Lift { memory: Quaternion::new(-1.0, 0.0, 0.0, 0.0), sign: 1.0 });
        controller.restore(Memory { filter: FilterState::ZERO, lift });
    }
    let flown = |trial: Trial, controller| trial.fly(paper, controller).ok_or("a half turn was not flown to its end");
    let trial = Trial::unwinding();
    let turns =
        [flown(trial, Controller::Ours(wound))?, flown(trial, rival(Box::new(Continuous::after_a_turn(feedback()))))?];
    let [ours_turned, turned] = turns.each_ref().map(|course| course.turned.to_degrees());
    claims.less("continuous laws unwind", "30 degrees off after a whole turn: turned, degrees", ours_turned, &[turned]);

    for degrees in [0.5_f64, 1.0, 2.0, 3.0] {
        let trial = Trial::held(degrees.to_radians());
        let [ours, other] = [flown(trial, ours()?)?, flown(trial, memoryless())?];
        let claim = "noise holds memoryless laws at half a turn";
        let figure = format!("worst noise of {degrees} degrees: there until, s (of 5)");
        claims.less(claim, &figure, ours.left_after, &[other.left_after]);
    }
    let quick = Scenario::parse(&scenario::PAPER.replace("rate = 100.0", "rate = 1000.0"), "the paper's at 1 kHz")?;
    let trial = Trial::held(0.5_f64.to_radians());
    let other = Memoryless(QuaternionFeedback::new(model(&quick), GAINS_LIKE_TABLE_1));
    let other = Controller::Rival(Box::new(RivalPilot::new(&quick, Box::new(other))));
    let [ours_quick, other] = [Controller::Ours(law(&quick)?), other].map(|controller| trial.fly(&quick, controller));
    let lost = "a half turn was not flown to its end";
    claims.less(
        "arbitrarily small noise does, if only sampled fast enough",
        "the same at 1 kHz, 0.5 degrees",
        ours_quick.ok_or(lost)?.left_after,
        &[other.ok_or(lost)?.left_after],
    );
    let trial = Trial::held(2_f64.to_radians());
    let held = [flown(trial, ours()?)?, flown(trial, memoryless())?];
    claims.less(
        "memoryless laws chatter there",
        "the same at 100 Hz, 2 degrees: torque reversals",
        held[0].reversals as f64,
        &[held[1].reversals as f64],
    );
    let mut mean = [0.0, 0.0];
    for seed in 0..100 {
        let trial = Trial::noisy(1_f64.to_radians(), seed);
        mean[0] += flown(trial, ours()?)?.left_after / 100.0;
        mean[1] += flown(trial, memoryless())?.left_after / 100.0;
    }
    claims.less("(the same, random noise)", "1 degree rms, 100 draws: there until, mean, s", mean[0], &[mean[1]]);
    Ok((turns, held))
}
