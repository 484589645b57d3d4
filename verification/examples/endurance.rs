//! Flies missions for hours, on one pilot: `cargo run --release -p verification --example endurance -- FILE HOURS`.
//!
//! The vehicle's clock starts half the hours before its milliseconds overflow 32 bits; its microseconds do so every 72
//! minutes. Fails if a mission does not go as it should, a delay has changed, or the last hour is not as good as the
//! first.

use controller_core::certificate::certified::Certified;
use estimation::estimator::Estimator;
use flight::{Memory, Pilot};
use scenario::Scenario;
use std::error::Error;
use std::path::Path;
use std::time::Instant;
use verification::hours::{Hours, ParameterEffect, Plan, TIMED_REASONS, fly};

/// Where a clock's milliseconds overflow 32 bits, us.
const MILLISECONDS_OVERFLOW_US: u64 = (1 << 32) * 1_000;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, hours] = arguments.as_slice() else {
        return Err("expected FILE HOURS".into());
    };
    let (scenario, hours) = (Scenario::load(Path::new(file))?, hours.parse::<u64>()?);
    let certified = Certified::new(scenario.configuration.clone())
        .map_err(|refused| format!("{file}: not certified: {refused:?}"))?;
    println!("hour  hover RMS  estimate's error, mm  delays, s: {TIMED_REASONS:?}");
    let (begun, mut number) = (Instant::now(), 0);
    let start = MILLISECONDS_OVERFLOW_US.checked_sub(hours * 1_800_000_000).ok_or("more hours than a clock has")?;
    let flown = fly(&scenario, &certified, &Plan { hours, missions: 6, start, seed: 1 }, |hour| {
        number += 1;
        let delays = hour.delays.map(|ticks| format!("{:.3}", 0.01 * ticks)).join(" ");
        println!("{number:4}  {:9.3}  {:20.3}  {delays}", 1e3 * hour.hover, 1e3 * hour.estimate);
    })?;
    let Hours { extremes, missions, moves, refusals, .. } = &flown;
    println!(
        "{missions} missions, the frame moved {moves} times, {refusals} requests to be asked again; shortest and longest delays, ticks: {extremes:?}"
    );
    for (what, unit, obeyed) in [("take-off", "m", &flown.heights), ("landing", "m/s", &flown.speeds)] {
        for ParameterEffect { chosen, found: (least, most), .. } in obeyed {
            println!("{what}: {chosen} {unit} chosen on the ground, {least:.3} to {most:.3} {unit} found");
        }
    }
    let sizes = [size_of::<Pilot>(), size_of::<Estimator>(), size_of::<Memory>()];
    println!("pilot, estimator, governor and mixer: {sizes:?} bytes, as at the start; nothing is allocated");
    println!("took {:.0} s", begun.elapsed().as_secs_f64());
    flown.check()?;
    Ok(())
}
