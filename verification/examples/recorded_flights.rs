//! Records the states of the paper's flight and of the embedded scenario's recovery for `firmware::replay`, as
//! `states.f32` and `recovery.f32`, and prints the numbers of the recovery, of the estimate of it and of the same behind a
//! shield on this machine, a line each: `cargo run -p verification --example recorded_flights -- FOLDER`.

use firmware::replay::estimate::Estimate;
use firmware::replay::recovery::{self, Recovery};
use firmware::replay::shielded::Shielded;
use firmware::replay::{TICKS, record};
use host_sim::flight::Flight;
use host_sim::tune::trials;
use scenario::Scenario;
use std::error::Error;
use std::path::Path;

/// The scenario that the firmware's build embeds where none is named.
const EMBEDDED: &str = include_str!("../../vehicles/study.toml");

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("expected a FOLDER")?;
    let folder = Path::new(&folder);
    // The states that the law saw at every tick.
    let paper = states(&mut Flight::new(&Scenario::paper()?)?, TICKS)?;
    std::fs::write(folder.join("states.f32"), paper.concat())?;

    let embedded = Scenario::parse(EMBEDDED, "vehicles/study.toml")?;
    let recovered = trials::recovery(&embedded, 20.0)?;
    let recovered = states(&mut Flight::new(&recovered)?, recovery::TICKS)?;
    std::fs::write(folder.join("recovery.f32"), recovered.concat())?;
    let mut replay = Recovery::new().ok_or("the embedded scenario is not certified")?;
    let mut estimate = Estimate::new().ok_or("the estimator's figures are refused")?;
    let mut shielded = Shielded::new().ok_or("the embedded scenario cannot be shielded")?;
    for state in &recovered {
        shielded.tick(state)?;
        replay.tick(state)?;
        estimate.tick(state);
    }
    println!("{}", replay.digest());
    println!("{}", estimate.digest().ok_or("no estimate at the end of the recovery")?);
    println!("{}", shielded.digest().ok_or("behind the shield law and network do not both fly")?);
    Ok(())
}

fn states(flight: &mut Flight, ticks: u64) -> Result<Vec<[u8; firmware::replay::RECORD]>, Box<dyn Error>> {
    (0..ticks).map(|_| Ok(record(&flight.tick()?.state.measured()))).collect()
}
