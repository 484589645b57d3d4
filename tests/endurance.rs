//! Hours of flight, and any time of the clock: `cargo run --release -p host-sim --example endurance -- vehicles/study.toml 24` flies a day.

use controller_core::certificate::certified::Certified;
use host_sim::campaign::hours::{Hours, Plan, fly};
use rayon::prelude::*;
use scenario::Scenario;
use std::path::Path;

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
    // A mission of ten minutes each, in whose middle: nothing happens; microseconds, milliseconds and ticks overflow 32 bits, with and
    // without a sign; microseconds are more than double precision holds, and half of what 64 bits do.
    let overflows = [1 << 31, 1 << 32, (1 << 31) * 1_000, (1 << 32) * 1_000, (1 << 32) * 10_000, 1 << 53, 1 << 63];
    let starts: Vec<u64> = overflows.into_iter().map(|overflow| overflow - 300_000_000).collect();
    let plan = |start| Plan { hours: 1, missions: 1, start, seed: 3 };
    let first = flown(plan(10_000_000));
    for (start, other) in starts.par_iter().map(|start| (start, flown(plan(*start)))).collect::<Vec<_>>() {
        // What is printed of a number tells it from any other; one that is none, of a battery that was not low, equals itself.
        assert_eq!(format!("{first:?}"), format!("{other:?}"), "{start}");
    }
}
