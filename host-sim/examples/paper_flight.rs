//! Records the states of the paper's flight for `firmware::replay`: `cargo run -p host-sim --example paper_flight -- record FILE`.

use firmware::replay::{TICKS, record};
use host_sim::flight::Flight;
use scenario::Scenario;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let ["record", file] = arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] else {
        return Err("expected `record FILE`".into());
    };
    // The state that the law saw at every tick.
    let mut flight = Flight::new(&Scenario::paper()?)?;
    let mut bytes = Vec::new();
    for _ in 0..TICKS {
        bytes.extend(record(&flight.tick()?.state.measured()));
    }
    Ok(std::fs::write(file, bytes)?)
}
