//! The table as data: what it says, and what must be true of any table that takes its place.

extern crate std;

use super::*;
use std::collections::HashSet;
use std::format;
use std::string::String;
use std::vec::Vec;

/// Every set of conditions.
fn every_set() -> impl Iterator<Item = Conditions> {
    (0..1_u16 << Condition::ALL.len()).map(Conditions)
}

/// The mode after one tick.
fn next(mode: Mode, conditions: Conditions) -> Mode {
    transition(mode, conditions).map_or(mode, |transition| transition.to)
}

#[test]
fn the_table_reads_as_written_down() {
    let rows: String = TABLE
        .iter()
        .map(|row| format!("{:?} --{:?}--> {:?}: {}\n", row.from, row.condition, row.to, row.reason))
        .collect();
    assert_eq!(
        rows,
        "\
Disarmed --DisarmCommanded--> Disarmed: Disarmed by command
Disarmed --ArmingPermitted--> Flying: Armed
Disarmed --MotorTestPermitted--> MotorTest: Motor test begins
MotorTest --DisarmCommanded--> Disarmed: Disarmed by command
MotorTest --Requested--> Disarmed: Motor test stopped by another request
MotorTest --MotorTestOver--> Disarmed: Motor test over
Flying --DisarmCommanded--> Disarmed: Disarmed by command
Flying --ImuStale--> Disarmed: Stopped: no IMU for 20 ms, or its data broke off
Flying --ThrustsRefused--> Disarmed: Stopped: the law refused its input for 50 ms
Flying --EstimateLost--> Levelling: Pose lost: levelling for at most 1 s
Flying --GroundStationSilent--> Holding: Ground station lost: holding position
Holding --DisarmCommanded--> Disarmed: Disarmed by command
Holding --ImuStale--> Disarmed: Stopped: no IMU for 20 ms, or its data broke off
Holding --ThrustsRefused--> Disarmed: Stopped: the law refused its input for 50 ms
Holding --EstimateLost--> Levelling: Pose lost: levelling for at most 1 s
Holding --GroundStationHeard--> Flying: Ground station regained
Levelling --DisarmCommanded--> Disarmed: Disarmed by command
Levelling --ImuStale--> Disarmed: Stopped: no IMU for 20 ms, or its data broke off
Levelling --ThrustsRefused--> Disarmed: Stopped: the law refused its input for 50 ms
Levelling --PoseRegained--> Flying: Pose regained: braking to hold position
Levelling --LevellingOver--> Disarmed: Stopped: no believable pose in 1 s of levelling
"
    );
}

#[test]
fn a_disarm_command_wins_over_any_other_condition_in_any_mode() {
    for mode in Mode::ALL {
        for conditions in every_set() {
            assert_eq!(next(mode, conditions.with(Condition::DisarmCommanded, true)), Mode::Disarmed);
        }
    }
}

#[test]
fn the_first_row_of_a_mode_whose_condition_holds_is_taken_under_every_set_of_conditions() {
    for mode in Mode::ALL {
        let rows: Vec<&Row> = TABLE.iter().filter(|row| row.from == mode).collect();
        for conditions in every_set() {
            let taken = rows.iter().find(|row| conditions.contain(row.condition));
            assert_eq!(next(mode, conditions), taken.map_or(mode, |row| row.to));
            if let Some(transition) = transition(mode, conditions) {
                assert_eq!((transition.from, Some(transition.reason)), (mode, taken.map(|row| row.reason)));
                assert_ne!(transition.from, transition.to);
            }
        }
    }
}

#[test]
fn no_row_hides_another_and_every_condition_and_reason_is_used() {
    let keys: HashSet<(u8, u8)> = TABLE.iter().map(|row| (row.from as u8, row.condition as u8)).collect();
    assert_eq!(keys.len(), TABLE.len());
    for condition in Condition::ALL {
        assert!(TABLE.iter().any(|row| row.condition == condition), "{condition:?}");
    }
    for reason in Reason::ALL {
        assert!(TABLE.iter().any(|row| row.reason == reason && row.from != row.to), "{reason:?}");
    }
}

#[test]
fn every_mode_is_reached_from_disarmed_and_the_only_ways_out_of_disarmed_are_permissions() {
    let mut reached = Vec::from([Mode::Disarmed]);
    while let Some(row) = TABLE.iter().find(|row| reached.contains(&row.from) && !reached.contains(&row.to)) {
        reached.push(row.to);
    }
    assert_eq!(reached.len(), Mode::ALL.len());
    let permissions = [Condition::ArmingPermitted, Condition::MotorTestPermitted];
    for conditions in every_set().filter(|set| !permissions.iter().any(|permission| set.contain(*permission))) {
        assert_eq!(next(Mode::Disarmed, conditions), Mode::Disarmed);
    }
    // Nor does a motor test lead into flight.
    assert!(TABLE.iter().all(|row| row.from != Mode::MotorTest || row.to == Mode::Disarmed));
}

#[test]
fn no_armed_mode_outlives_its_gyro_its_thrusts_or_but_for_levelling_its_estimate() {
    for mode in Mode::ALL.into_iter().filter(|mode| mode.is_armed()) {
        for conditions in every_set() {
            for lost in [Condition::ImuStale, Condition::ThrustsRefused] {
                assert_eq!(next(mode, conditions.with(lost, true)), Mode::Disarmed);
            }
            let after = next(mode, conditions.with(Condition::EstimateLost, true));
            // Nothing is lost and regained at once; the pilot never says so.
            if mode != Mode::Levelling {
                assert!(matches!(after, Mode::Levelling | Mode::Disarmed));
            } else if conditions.contain(Condition::LevellingOver) && !conditions.contain(Condition::PoseRegained) {
                assert_eq!(after, Mode::Disarmed);
            }
        }
    }
}
