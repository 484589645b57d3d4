//! What must follow, as data: of each failure, by when the vehicle must do how much about it, and how much it may do at
//! most.
//!
//! **The order of severity**, from the least that may be done to the most: carry on; hold; land; go down by the IMU
//! alone; stop the motors. Of two failures the more severe answer must be given, each by its own time, and no answer
//! may be given that is more severe than the more severe of the two allows.
//!
//! These are read off `docs/firmware.md` and the limits in it. The rules' table is not read.

use super::failure::Failure;
use super::phase::Phase;
use flight::Mode;

/// How much a vehicle does about a failure, the least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    CarryOn,
    Hold,
    Land,
    Descend,
    Off,
}

impl Severity {
    /// What a mode amounts to.
    pub fn from_mode(mode: Mode) -> Self {
        match mode {
            Mode::MotorTest | Mode::Idling | Mode::TakingOff | Mode::Flying => Self::CarryOn,
            Mode::Holding => Self::Hold,
            Mode::Landing => Self::Land,
            Mode::Descending => Self::Descend,
            Mode::Boot | Mode::Checks | Mode::Ready | Mode::Stopped | Mode::Locked => Self::Off,
        }
    }
}

use Severity::{CarryOn, Descend, Hold, Land, Off};

/// What must follow from a failure.
#[derive(Debug, Clone, Copy)]
pub struct Answer {
    /// In flight on the estimate: at least so much, so long after it has failed, s.
    pub in_flight: &'static [(Severity, f64)],
    /// In flight on the estimate: at most so much. Motors that stop on the ground after a landing are no more than that
    /// landing.
    pub most: Severity,
    /// Idling: motors off so long after it has failed, s.
    pub idling: Option<f64>,
    /// Going down by the IMU alone: motors off so long after it has failed, s.
    pub descending: Option<f64>,
    /// Whether going down by the IMU alone may be ended in the air.
    pub descent_may_end: bool,
    /// Whether what is left permits a gentle touchdown.
    pub is_gentle: bool,
    /// Whether the vehicle must not arm as long as it lasts.
    pub forbids_arming: bool,
}

/// No reaction follows.
const NO_ANSWER: Answer = Answer {
    in_flight: &[],
    most: CarryOn,
    idling: None,
    descending: None,
    descent_may_end: false,
    is_gentle: true,
    forbids_arming: false,
};

/// No poses, or poses that lie: a second on the IMU, and half a tick for the last to arrive late; then down.
const NO_POSES: Answer =
    Answer { in_flight: &[(Descend, 1.1)], most: Descend, idling: Some(1.1), forbids_arming: true, ..NO_ANSWER };

/// Something outside pushes: the vehicle may go where it likes, and without a pose the push is not observable apart
/// from a lie.
const PUSHED_ANSWER: Answer = Answer { most: Land, descent_may_end: true, is_gentle: false, ..NO_ANSWER };

/// Nothing can be flown any more, at once.
const AT_ONCE: Answer = Answer {
    in_flight: &[(Off, 0.05)],
    most: Off,
    idling: Some(0.05),
    descending: Some(0.05),
    descent_may_end: true,
    is_gentle: false,
    forbids_arming: true,
};

/// The vehicle may be lost: it must be off in the end, and nothing is too much.
const LOST_ANSWER: Answer =
    Answer { in_flight: &[], most: Off, idling: None, descent_may_end: true, is_gentle: false, ..NO_ANSWER };

/// How long a landing within the fence takes at most, s: 12 s, and twice what 4 m take at 0.5 m/s.
const CARRIED_FOR: f64 = 28.0;

/// What must follow from a failure.
pub fn answer(failure: Failure, phase: Phase) -> Answer {
    match failure {
        Failure::PoseLost => NO_POSES,
        // On the ground a frame that stays where it has jumped to is followed.
        Failure::PoseJumps | Failure::PoseTurns => Answer { forbids_arming: false, ..NO_POSES },
        // The poses come back, and the vehicle holds.
        Failure::PoseOutage => Answer { in_flight: &[(Hold, 1.1)], most: Descend, idling: Some(1.1), ..NO_ANSWER },
        // It takes a while until a drift is more than noise.
        Failure::PoseDrifts => Answer { in_flight: &[(Descend, 2.0)], idling: Some(2.0), ..NO_POSES },
        // On the ground they may be of a simulated vehicle that stands still. Stopping a take-off then stops the
        // motors of a vehicle that is believed to stand, and may be some centimetres up.
        Failure::PoseFreezes if phase == Phase::Spooling => {
            Answer { in_flight: &[(Descend, 3.6)], idling: None, forbids_arming: false, is_gentle: false, ..NO_POSES }
        }
        Failure::PoseFreezes => {
            Answer { in_flight: &[(Descend, 1.3)], idling: None, forbids_arming: false, ..NO_POSES }
        }
        Failure::FrameMoves => NO_ANSWER,
        // What the IMU feels of it without a pose, with the air's drag, may be too much for an IMU that is right.
        Failure::Thermal => Answer { descent_may_end: true, is_gentle: false, ..NO_ANSWER },
        Failure::PoseVague => Answer { in_flight: &[], idling: None, forbids_arming: false, ..NO_POSES },
        Failure::SetpointsLost if phase == Phase::Moving => {
            Answer { in_flight: &[(Hold, 1.05)], most: Hold, ..NO_ANSWER }
        }
        Failure::SetpointsLost => NO_ANSWER,
        Failure::StationLost => Answer {
            in_flight: &[(Hold, 2.55), (Land, 5.05)],
            most: Land,
            idling: Some(2.55),
            forbids_arming: true,
            ..NO_ANSWER
        },
        Failure::BatteryLow | Failure::BatteryCritical | Failure::BatteryWavers => {
            Answer { in_flight: &[(Land, 3.05)], most: Land, idling: Some(3.05), forbids_arming: true, ..NO_ANSWER }
        }
        // Nothing pushes it away before it has left the ground.
        Failure::Gust | Failure::Updraft | Failure::Wind if phase == Phase::Spooling => PUSHED_ANSWER,
        Failure::Gust => Answer { in_flight: &[(Land, 4.0)], ..PUSHED_ANSWER },
        Failure::Updraft => Answer { in_flight: &[(Land, 5.0)], ..PUSHED_ANSWER },
        Failure::Wind => Answer { in_flight: &[(Land, 12.0)], ..PUSHED_ANSWER },
        Failure::RotorWeak => LOST_ANSWER,
        // Before it has lifted off, nothing tells of it.
        Failure::RotorLost if phase == Phase::Spooling => Answer { in_flight: &[(Off, 20.0)], ..LOST_ANSWER },
        Failure::RotorLost => Answer { in_flight: &[(Land, 0.4), (Off, 20.0)], descending: Some(40.0), ..LOST_ANSWER },
        Failure::ImuLost | Failure::ImuFreezes => AT_ONCE,
        Failure::GyroLies | Failure::AccelerometerLies => Answer { forbids_arming: true, ..LOST_ANSWER },
        Failure::Overrun => Answer { in_flight: &[(Land, 0.15)], most: Land, idling: Some(0.15), ..NO_ANSWER },
        Failure::Tipped | Failure::Leaned if phase == Phase::Spooling => {
            Answer { in_flight: &[(Off, 2.5)], ..LOST_ANSWER }
        }
        // From high enough, or on its legs, it flies on.
        Failure::Tipped => Answer { idling: Some(1.7), ..LOST_ANSWER },
        Failure::Leaned => LOST_ANSWER,
        Failure::HeldDown => Answer { in_flight: &[(Land, 12.0)], most: Land, ..NO_ANSWER },
        Failure::Killed => {
            Answer { in_flight: &[(Off, 0.011)], idling: Some(0.011), descending: Some(0.011), ..AT_ONCE }
        }
    }
}

/// The least and the most that a phase does by itself.
pub fn of_phase(phase: Phase) -> (Severity, Severity) {
    match phase {
        Phase::Boot | Phase::Locked | Phase::Checks | Phase::Ready | Phase::Stopped => (Off, Off),
        // They come to their end.
        Phase::MotorTest | Phase::Idling => (CarryOn, Off),
        Phase::Spooling | Phase::Climbing => (CarryOn, Hold),
        Phase::AtPoint | Phase::Moving => (CarryOn, CarryOn),
        Phase::Holding => (Hold, Hold),
        Phase::Landing => (Land, Land),
        Phase::Descending => (Descend, Descend),
    }
}

/// At least so much, `since` s after each failure, in a flight whose failures began in `phase`.
pub fn least(phase: Phase, failed: &[(Failure, f64)]) -> Severity {
    let by_one = |(failure, since): &(Failure, f64)| {
        let answer = answer(*failure, phase);
        let late = |limit: Option<f64>| if limit.is_some_and(|limit| *since > limit) { Off } else { CarryOn };
        match phase {
            Phase::Idling => late(answer.idling),
            Phase::Descending => late(answer.descending),
            Phase::MotorTest if *failure == Failure::Killed => late(Some(0.011)),
            Phase::MotorTest => CarryOn,
            _ => answer.in_flight.iter().filter(|(_, limit)| since > limit).map(|one| one.0).max().unwrap_or(CarryOn),
        }
    };
    let least = of_phase(phase).0;
    // What may be lost need not get where it is pushed, nor what is lower by the move of its frame; what a sender says
    // of itself is believed; frozen poses that begin anew, or drift, are found anew; and hands that come later find it
    // in the air.
    let has = |wanted: &[Failure]| failed.iter().any(|(failure, _)| wanted.contains(failure));
    let may_be_lost = failed.iter().any(|(failure, _)| answer(*failure, phase).most == Off);
    let counts = |failure: Failure| match failure {
        Failure::Gust | Failure::Updraft | Failure::Wind => !may_be_lost && !has(&[Failure::FrameMoves]),
        Failure::PoseFreezes if has(&[Failure::PoseOutage, Failure::PoseDrifts]) => false,
        Failure::PoseFreezes if may_be_lost && phase == Phase::Spooling => false,
        Failure::PoseDrifts if has(&[Failure::PoseFreezes]) => false,
        Failure::PoseJumps | Failure::PoseTurns | Failure::PoseDrifts | Failure::PoseFreezes => {
            !has(&[Failure::PoseVague, Failure::FrameMoves])
        }
        Failure::Tipped | Failure::Leaned if phase == Phase::Spooling => failed.len() == 1,
        Failure::Tipped | Failure::Leaned => !has(&[Failure::Tipped]) || !has(&[Failure::Leaned]),
        Failure::RotorLost => failed.len() == 1,
        _ => true,
    };
    failed.iter().filter(|(failure, _)| counts(*failure)).map(by_one).max().unwrap_or(CarryOn).max(least)
}

/// At most so much.
pub fn most(phase: Phase, failed: &[(Failure, f64)]) -> Severity {
    let answers = || failed.iter().map(|(failure, _)| answer(*failure, phase));
    let (_, most) = of_phase(phase);
    let most = answers().map(|answer| answer.most).max().unwrap_or(CarryOn).max(most);
    // A landing that is carried away lasts longer than the fence's height explains, and goes down by the IMU.
    let carried = |(failure, since): &(Failure, f64)| {
        matches!(failure, Failure::Gust | Failure::Updraft | Failure::Wind) && *since > CARRIED_FOR
    };
    let most = if failed.iter().any(carried) { most.max(Descend) } else { most };
    if most >= Descend && answers().any(|answer| answer.descent_may_end) { Off } else { most }
}
