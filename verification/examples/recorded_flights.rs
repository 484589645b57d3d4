//! Records the states of the paper's flight and of the embedded scenario's recovery at 100 Hz, 500 Hz and 1 kHz for
//! `firmware::replay`, as `states.f32` and `recovery.f32`, and prints for each rate the numbers of the recovery, of the
//! estimate of it and of the same behind a shield, with two networks, on this machine, a line each:
//! `cargo run -p verification --example recorded_flights -- FOLDER`.

use firmware::replay::estimate::Estimate;
use firmware::replay::recovery::{self, Recovery};
use firmware::replay::shielded::Shielded;
use firmware::replay::{FLIGHT_TICKS, PERIODS_US, STATE_BYTES, record};
use host_sim::flight::Flight;
use host_sim::flight::tasks;
use scenario::Scenario;
use std::error::Error;
use std::path::Path;

/// The scenario that the firmware's build embeds where none is named.
const EMBEDDED: &str = include_str!("../../vehicles/study.toml");

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("expected a FOLDER")?;
    let folder = Path::new(&folder);
    // The states that the law saw at every tick.
    let paper = states(&mut Flight::new(&Scenario::paper()?)?, FLIGHT_TICKS)?;
    std::fs::write(folder.join("states.f32"), paper.concat())?;

    let mut all = Vec::new();
    for period in PERIODS_US {
        let recovered = recovery(period)?;
        let mut replay = Recovery::new(period).ok_or("the embedded scenario is not certified")?;
        let mut estimate = Estimate::new(period).ok_or("the estimator's figures are refused")?;
        let mut shielded = Shielded::new(period).ok_or("the embedded scenario cannot be shielded")?;
        let mut remembers = Shielded::recurrent(period).ok_or("the network that remembers is refused")?;
        for state in &recovered {
            shielded.tick(state)?;
            remembers.tick(state)?;
            replay.tick(state)?;
            estimate.tick(state);
        }
        println!("{}", replay.digest());
        println!("{}", estimate.digest().ok_or("no estimate at the end of the recovery")?);
        println!("{}", shielded.digest().ok_or("behind the shield law and network do not both fly")?);
        println!("{}", remembers.digest().ok_or("law and network that remembers do not both fly")?);
        all.extend(recovered);
    }
    std::fs::write(folder.join("recovery.f32"), all.concat())?;
    Ok(())
}

/// The states of a recovery of the embedded scenario's vehicle, flown in ticks of `period` us, one of which its
/// commands are late.
fn recovery(period: u64) -> Result<Vec<[u8; STATE_BYTES]>, Box<dyn Error>> {
    let text = EMBEDDED.replace("rate = 100.0 ", &format!("rate = {}.0 ", 1_000_000 / period));
    let text = text.replace("delay = 0.010 ", &format!("delay = {} ", period as f64 * 1e-6));
    let embedded = Scenario::parse(&text, "vehicles/study.toml")?;
    let mut flight = Flight::new(&tasks::recovery(&embedded, recovery::RECOVERY_DURATION_US as f64 * 1e-6)?)?;
    states(&mut flight, recovery::RECOVERY_DURATION_US / period)
}

fn states(flight: &mut Flight, ticks: u64) -> Result<Vec<[u8; STATE_BYTES]>, Box<dyn Error>> {
    (0..ticks).map(|_| Ok(record(&flight.tick()?.state.measured()))).collect()
}
