//! Failing rotors of all flights, counted and in words.

use super::super::manifest::Manifest;
use super::super::outcome::Outcome;
use super::super::rows::{FlightRow, batch};
use super::*;
use crate::flight::Flight;
use scenario::Scenario;
use scenario::reality::failure::Failure;
use scenario::verdict::Verdict;

/// What becomes of a flight: the rotor that fails at 10 s and the one that is found and when, m lost, and m away at the
/// end.
type Flown = (Option<usize>, Option<(usize, f64)>, f64, f64);

fn losses(flights: &[Flown]) -> Losses {
    let text = include_str!("../../../../../vehicles/hummingbird.toml").replace("duration = 40.0", "duration = 1.0");
    let scenario = Scenario::parse(&text, "f").unwrap();
    let verdict = Verdict::judge(&scenario).unwrap();
    let outcome = Outcome::judge(&scenario, Flight::new(&scenario).unwrap(), verdict.certificate());
    let row = |(number, (failed, found, height_lost, final_error)): (u64, &Flown)| {
        let failure = failed.map(|rotor| Failure { rotor, time: 10.0, thrust_left: 0.0 });
        let mut rotor = outcome.rotor;
        (rotor.failure, rotor.found) = (failure, *found);
        (rotor.height_lost, rotor.distance) = (*height_lost, 2.0 * final_error);
        FlightRow::new(number, &scenario, Outcome { rotor, final_error: *final_error, ..outcome })
    };
    let rows: Vec<FlightRow> = (100..).zip(flights).map(row).collect();
    Losses::count(&[batch(&rows, &Manifest::new(&scenario, &text, 5, 0, (1, 1))).unwrap()])
}

#[test]
fn each_kind_of_finding_is_counted_and_said() {
    let losses = losses(&[
        (Some(1), Some((1, 10.03)), 0.1, 0.5),
        (Some(1), Some((1, 10.05)), 0.3, 2.9),
        (Some(1), Some((1, 9.0)), 0.2, 3.1),
        (Some(1), Some((2, 10.1)), 9.0, f64::INFINITY),
        (Some(0), None, 0.0, 0.1),
        (None, None, 0.0, 0.1),
        (None, Some((3, 0.5)), 0.0, 0.1),
    ]);
    let counted = (losses.failed, losses.found, losses.missed, losses.held);
    assert_eq!(counted, (5, 2, 1, 3));
    assert_eq!(losses.false_alarms, [(102, 2), (103, 3), (106, 4)]);
    assert_eq!(
        losses.to_string(),
        "a rotor failed in 5 flights, 3 of which end within 3 m of their reference; the law found it in 2, another one or \
         too early in 2, none in 1\n  \
         found after: median 0.05 s, 99 % 0.05 s, greatest 0.05 s\n  \
         height lost: median 0.2 m, 99 % 9 m, greatest 9 m\n  \
         greatest distance: median 5.8 m, 99 % infinite m, greatest infinite m\n\
         false alarms, of rotors that had not failed: 3: flights 102 (rotor 2), 103 (rotor 3), 106 (rotor 4)"
    );
}

#[test]
fn where_no_rotor_fails_the_false_alarms_are_said_alone() {
    let said = losses(&[(None, None, 0.0, 0.1)]).to_string();
    assert_eq!(said, "false alarms, of rotors that had not failed: 0");
}
