//! The table as data: what must be true of it, and of any that takes its place.

extern crate std;

use super::*;
use std::collections::HashSet;
use std::vec::Vec;

/// Sets of conditions: each alone, each pair, and a hundred thousand of any size. There are too many to try every one.
fn sets() -> impl Iterator<Item = Conditions> {
    let alone = Condition::ALL.map(|condition| Conditions::NONE.with(condition, true));
    let pairs = Condition::ALL
        .into_iter()
        .flat_map(|first| Condition::ALL.map(|second| Conditions::NONE.with(first, true).with(second, true)));
    let mut bits = 1_u64;
    let any = (0..100_000).map(move |_| {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // One half, a quarter and an eighth of the bits are set, in turn.
        Conditions([bits, bits & bits << 13, bits & bits << 13 & bits << 27][(bits >> 60) as usize % 3] >> 29)
    });
    [Conditions::NONE].into_iter().chain(alone).chain(pairs).chain(any)
}

/// The mode after one tick.
fn next(mode: Mode, conditions: Conditions) -> Mode {
    transition(mode, conditions).map_or(mode, |transition| transition.to)
}

/// Whether the motors of a mode stand still.
fn is_stopped(mode: Mode) -> bool {
    !mode.is_armed() && mode != Mode::MotorTest
}

#[test]
fn conditions_are_distinguished() {
    for (index, condition) in Condition::ALL.into_iter().enumerate() {
        assert_eq!(condition as usize, index);
        let alone = Conditions::NONE.with(condition, true);
        assert!(Condition::ALL.iter().all(|&other| alone.contain(other) == (other == condition)));
        assert_eq!(alone.with(condition, false), alone);
    }
}

#[test]
fn a_disarm_that_is_granted_and_the_kill_switch_stop_the_motors_in_any_mode() {
    for (mode, conditions) in Mode::ALL.into_iter().flat_map(|mode| sets().map(move |set| (mode, set))) {
        for stop in [Condition::Disarmed, Condition::Killed] {
            let after = next(mode, conditions.with(stop, true));
            // What is locked has no motor to stop but that of a test, and a pilot grants no test with either.
            let test = mode == Mode::Locked && conditions.contain(Condition::MotorTestPermitted);
            assert!(is_stopped(after) || test, "{mode:?} {stop:?} -> {after:?}");
        }
    }
}

#[test]
fn the_first_row_of_a_mode_whose_condition_holds_is_taken() {
    for mode in Mode::ALL {
        let rows: Vec<&Row> = TABLE.iter().filter(|row| row.from == mode).collect();
        for conditions in sets() {
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
fn every_mode_is_reached_from_boot_and_motors_begin_to_turn_by_permission_only() {
    let mut reached = Vec::from([Mode::Boot]);
    while let Some(row) = TABLE.iter().find(|row| reached.contains(&row.from) && !reached.contains(&row.to)) {
        reached.push(row.to);
    }
    assert_eq!(reached.len(), Mode::ALL.len());
    for row in TABLE.iter().filter(|row| is_stopped(row.from) && !is_stopped(row.to)) {
        let permissions = [Condition::ArmingPermitted, Condition::MotorTestPermitted];
        assert!(permissions.contains(&row.condition), "{row:?}");
        assert!(matches!(row.to, Mode::Idling | Mode::MotorTest), "{row:?}");
    }
    // Nor does a motor test lead into flight, or stopping in the air, without an inspection.
    assert!(TABLE.iter().all(|row| row.from != Mode::MotorTest || row.to == Mode::Checks));
    assert!(
        TABLE.iter().all(|row| row.from != Mode::Stopped || row.to == row.from || row.condition == Condition::Disarmed)
    );
    // And nothing flies that has not idled.
    let flies = |row: &&Row| row.to.flies() && !row.from.flies();
    assert!(TABLE.iter().filter(flies).all(|row| row.from == Mode::Idling));
}

#[test]
fn no_armed_mode_outlives_its_imu_its_thrusts_or_but_for_going_down_its_estimate() {
    for mode in Mode::ALL.into_iter().filter(|mode| mode.is_armed()) {
        for conditions in sets() {
            assert!(is_stopped(next(mode, conditions.with(Condition::ImuStale, true))), "{mode:?}");
            if mode.flies() {
                assert!(is_stopped(next(mode, conditions.with(Condition::ThrustsRefused, true))), "{mode:?}");
            }
            let after = next(mode, conditions.with(Condition::EstimateLost, true));
            // Nothing is lost and regained at once; the pilot never reports both.
            assert!(mode == Mode::Descending || after == Mode::Descending || is_stopped(after), "{mode:?} {after:?}");
        }
    }
}

#[test]
fn what_flies_has_an_answer_to_every_failure() {
    let failures = [
        Condition::BatteryLow,
        Condition::BatteryCritical,
        Condition::FenceBreached,
        Condition::TrackingLost,
        Condition::Saturated,
        Condition::Overrun,
    ];
    for mode in [Mode::TakingOff, Mode::Flying, Mode::Holding] {
        for failure in failures {
            assert_eq!(next(mode, Conditions::NONE.with(failure, true)), Mode::Landing, "{mode:?} {failure:?}");
        }
        let silent = next(mode, Conditions::NONE.with(Condition::GroundStationSilent, true));
        assert_eq!(silent, Mode::Holding);
    }
    assert_eq!(next(Mode::Holding, Conditions::NONE.with(Condition::GroundStationGone, true)), Mode::Landing);
    assert_eq!(next(Mode::Flying, Conditions::NONE.with(Condition::SetpointsLost, true)), Mode::Holding);
    // Going down ends on the ground or is ended.
    for mode in [Mode::Landing, Mode::Descending] {
        assert_eq!(next(mode, Conditions::NONE.with(Condition::Landed, true)), Mode::Checks);
    }
    assert_eq!(next(Mode::Descending, Conditions::NONE.with(Condition::DescendingOver, true)), Mode::Stopped);
}
