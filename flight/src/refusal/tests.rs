use super::*;
use crate::hummingbird;
use crate::reason::{Reason, TEXT_MAX};
use estimation::estimator::{Accepted, Rejected};
extern crate std;
use std::format;
use std::string::ToString;
use std::vec::Vec;

/// A name longer than any.
const LONG: &str = "a_name.that_is_longer_than_the_fifty_characters_of_a_status_text";

#[test]
fn every_text_fits_a_statustext_and_is_unlike_the_others() {
    let grounded = [Grounded::Inequality(LONG), Grounded::Parameter(LONG), Grounded::NoRotors];
    let mission = [
        MissionRefusal::NoItem,
        MissionRefusal::Number,
        MissionRefusal::OutsideFence,
        MissionRefusal::BelowHome,
        MissionRefusal::TakeOffHeight,
    ];
    let refusals = [
        Refusal::AlreadyArmed,
        Refusal::MotorTestRunning,
        Refusal::DisarmCommanded,
        Refusal::ImuStale,
        Refusal::PosesUnsettled,
        Refusal::Moving,
        Refusal::Gravity,
        Refusal::Tilted,
        Refusal::GroundStationSilent,
        Refusal::Reference(LONG),
        Refusal::NoSuchRotor,
        Refusal::MotorTestLevel,
        Refusal::MotorTestDuration,
        Refusal::Stopped,
        Refusal::Killed,
        Refusal::Busy,
        Refusal::Lost(Stored::SigningKey),
        Refusal::Lost(Stored::Parameter(LONG)),
        Refusal::ClockDoubtful,
        Refusal::MotorsFail,
        Refusal::BatteryLow,
        Refusal::BatteryMissing,
        Refusal::InTheAir,
        Refusal::NotIdling,
        Refusal::TakingOff,
        Refusal::Flies,
        Refusal::NotInTheAir,
        Refusal::Landing,
        Refusal::WithoutPose,
        Refusal::MustLand,
        Refusal::NoSetpoints,
        Refusal::TakeOffHeight,
        Refusal::OutsideFence,
        Refusal::Setpoint(LONG),
    ];
    let reasons = Reason::ALL.iter().map(ToString::to_string);
    let poses = Rejected::ALL.map(Rejected::text).into_iter().chain(Accepted::ALL.map(Accepted::text));
    let refusals = refusals
        .into_iter()
        .chain(mission.map(Refusal::Mission))
        .chain(grounded.map(Refusal::Grounded))
        .chain(Fault::ALL.map(Refusal::Estimator))
        .chain(ImuFault::ALL.map(Refusal::Imu));
    let mut texts: Vec<_> = reasons.chain(refusals.map(|refusal| refusal.to_string())).collect();
    texts.extend(poses.map(ToString::to_string));
    for text in &texts {
        assert!(text.len() <= TEXT_MAX && text.len() > 4, "{text}");
    }
    let count = texts.len();
    texts.sort();
    texts.dedup();
    assert_eq!(texts.len(), count);
}

#[test]
fn every_inequality_of_the_certificate_has_a_text_of_its_own() {
    let certified = hummingbird::certified();
    let certificate = certified.certificate();
    let mut texts: Vec<_> =
        certificate.inequalities().map(|i| format!("{:.44}", Grounded::Inequality(i.name).to_string())).collect();
    texts.sort();
    texts.dedup();
    assert_eq!(texts.len(), certificate.inequalities().count());
}
