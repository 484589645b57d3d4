//! Records the states of the paper's flight for `firmware::replay`, or replays a recording on this machine:
//! `cargo run -p host-sim --example paper_flight -- record FILE`, `… -- replay FILE`.

use firmware::replay::{RECORD, Replay, TICKS, record};
use host_sim::flight::Flight;
use scenario::Scenario;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["record", file] => save(Path::new(file)),
        ["replay", file] => replay(Path::new(file)),
        _ => Err("expected `record FILE` or `replay FILE`".into()),
    }
}

/// Flies the paper's scenario and writes the state that the law saw at every tick.
fn save(file: &Path) -> Result<(), Box<dyn Error>> {
    let mut flight = Flight::new(&Scenario::paper()?)?;
    let mut bytes = Vec::new();
    for _ in 0..TICKS {
        bytes.extend(record(&flight.tick()?.state.measured()));
    }
    Ok(std::fs::write(file, bytes)?)
}

/// Prints the number that a recording makes here.
fn replay(file: &Path) -> Result<(), Box<dyn Error>> {
    let bytes = std::fs::read(file)?;
    let (records, rest) = bytes.as_chunks::<RECORD>();
    if records.len() as u64 != TICKS || !rest.is_empty() {
        return Err("the recording has another length than the flight".into());
    }
    let mut replay = Replay::new().ok_or("Table I is not certified")?;
    for record in records {
        replay.tick(record)?;
    }
    println!("{}", replay.digest());
    Ok(())
}
