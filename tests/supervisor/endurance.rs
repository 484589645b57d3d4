//! Hours of flight, and any time of the clock:
//! `cargo run --release -p verification --example endurance -- vehicles/study.toml 24` flies a day.

use controller_core::certificate::certified::Certified;
use flight::Reason;
use rayon::prelude::*;
use scenario::Scenario;
use std::path::Path;
use verification::hours::{Hours, Plan, fly};

fn flown(plan: Plan) -> Hours {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles");
    let scenario = Scenario::load(&folder.join("study.toml")).unwrap();
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    fly(&scenario, &certified, &plan, |_| ()).unwrap_or_else(|ended| panic!("{plan:?}: {ended}"))
}

#[test]
fn two_hours_of_missions_with_faults_are_alike() {
    // The microseconds overflow 32 bits on the way, twice.
    let flown = flown(Plan { hours: 2, missions: 6, start: (1 << 32) - 600_000_000, seed: 7 });
    println!("{flown:?}");
    flown.check().unwrap();
    assert!(flown.hours.iter().all(|hour| hour.hover < 3e-3 && hour.estimate < 1e-3), "{flown:?}");
}

#[test]
fn what_time_it_is_makes_no_difference_to_the_last_bit() {
    // A mission of ten minutes, again and again: a fifth of a second before one of its transitions something overflows.
    let plan = |start| Plan { hours: 1, missions: 1, start, seed: 3 };
    let first = flown(plan(10_000_000));
    let before = |overflow: u64, tick: u64| overflow - (tick - 20) * 10_000;
    // Microseconds, 32 bits, before each of them.
    let mut starts: Vec<u64> = first.taken.iter().map(|(tick, _)| before(1 << 32, *tick)).collect();
    // The same with a sign; milliseconds and ticks; more than double precision holds, and half of what 64 bits do.
    let (lost, _) = *first.taken.iter().find(|(_, reason)| *reason == Reason::PoseLost).unwrap();
    let others: [u64; 6] = [1 << 31, (1 << 31) * 1_000, (1 << 32) * 1_000, (1 << 32) * 10_000, 1 << 53, 1 << 63];
    starts.extend(others.map(|overflow| before(overflow, lost)));
    for (start, other) in starts.par_iter().map(|start| (start, flown(plan(*start)))).collect::<Vec<_>>() {
        // Printed numbers identify their bits.
        assert_eq!(format!("{first:?}"), format!("{other:?}"), "{start}");
    }
    assert_eq!(first.taken.len(), 11);
}
