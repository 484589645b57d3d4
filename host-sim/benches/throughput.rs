//! Simulated seconds per second: `cargo bench -p host-sim --bench throughput`.
//!
//! The paper's scenario (law at 100 Hz) with every check on and nothing logged: alone, through the same tick in brief
//! that campaigns fly, with the plant step of its file (RK4 at 1 ms) and with that of a campaign (5 ms), whose
//! positions are held against steps of half a millisecond; as a batch on one core, flights from different starts side
//! by side; and a batch on each of two cores at once. The machine's best repetition counts: the others measure its
//! neighbours.

use host_sim::batch::Batch;
use host_sim::campaign::draw::circumstances;
use host_sim::campaign::step;
use host_sim::flight::Flight;
use pulp::Arch;
use scenario::Scenario;
use scenario::campaign::{Asked, NoiseRanges};
use std::error::Error;
use std::hint::black_box;
use std::sync::Barrier;
use std::thread;
use std::time::Instant;

/// Flights of each kind.
const REPETITIONS: usize = 1500;
/// Flights side by side.
const BESIDE: u64 = 64;
/// Ticks between two looks at the clock.
const STRETCH: u64 = 400;
/// What the project asks for, simulated seconds per second: as a file flies, as a campaign flies, side by side.
const REQUIRED: f64 = 10_000.0;
const REQUIRED_OF_CAMPAIGNS: f64 = 50_000.0;
const REQUIRED_OF_BATCHES: f64 = 100_000.0;
/// Alone at a file's step: fewer than these are the sources' doing, not that of a busy machine.
const LEAST: f64 = 4_000.0;
/// Two cores over one.
const REQUIRED_RATIO: f64 = 1.9;
/// How far a campaign's step may move the paper's flight, m.
const NEAR: f64 = 1e-6;

fn main() -> Result<(), Box<dyn Error>> {
    let scenario = Scenario::paper()?;
    let campaigns = step::longest(&scenario);
    let moved = distance(&campaigns, &step::of(&scenario, 5e-4)?)?;

    // What is asked for and not reached is said, and no reason to stop a build: a machine may have others to serve.
    let as_files = alone(&scenario)?;
    as_files.report("alone, a file's plant step of 1 ms", REQUIRED);
    alone(&campaigns)?.report("alone, a campaign's of 5 ms", REQUIRED_OF_CAMPAIGNS);
    let one = side_by_side(&campaigns, 1)?;
    one.report("side by side, a campaign's", REQUIRED_OF_BATCHES);
    let two = side_by_side(&campaigns, 2)?;
    two.report("side by side on each of two cores", REQUIRED_RATIO * one.best);
    println!("two cores over one: {:.2}", two.best / one.best);
    println!("a campaign's plant step moves the flight by {moved:.2e} m: {}", word(moved < NEAR));
    if as_files.best >= LEAST && moved < NEAR { Ok(()) } else { Err("too slow, or too far".into()) }
}

/// Simulated seconds per second.
struct Rates {
    best: f64,
    median: f64,
}

impl Rates {
    fn of(mut rates: Vec<f64>) -> Self {
        rates.sort_by(f64::total_cmp);
        Self { best: rates.last().copied().unwrap_or(0.0), median: rates.get(rates.len() / 2).copied().unwrap_or(0.0) }
    }

    /// Says whether the best is as much as `required`.
    fn report(&self, what: &str, required: f64) {
        let Self { best, median } = self;
        let verdict = word(*best >= required);
        println!("{what}: {best:.0} simulated s/s (median {median:.0}); required {required:.0}: {verdict}");
    }
}

/// One flight after the other.
fn alone(scenario: &Scenario) -> Result<Rates, Box<dyn Error>> {
    let mut rates = Vec::with_capacity(REPETITIONS);
    // Certified once, as before a take-off.
    let start = Flight::new(scenario)?;
    for _ in 0..REPETITIONS {
        let started = Instant::now();
        let mut flight = start.clone();
        for _ in 0..scenario.timing.ticks {
            black_box(flight.brief_tick()?);
        }
        rates.push(scenario.timing.duration() / started.elapsed().as_secs_f64());
    }
    Ok(Rates::of(rates))
}

/// Flights from different starts, side by side, on each of so many cores at once.
fn side_by_side(scenario: &Scenario, cores: usize) -> Result<Rates, Box<dyn Error>> {
    let mut ranges = scenario.campaign.ranges;
    (ranges.reference, ranges.noise) = (Asked::File, NoiseRanges::default());
    let starts = (0..BESIDE).map(|number| Flight::new(&circumstances(scenario, &ranges, 0, number)));
    let starts = starts.collect::<Result<Vec<_>, _>>()?;
    let batch = Batch::new(Arch::new(), starts).map_err(|_| "the paper's flights cannot fly side by side")?;
    let (gate, stretches) = (Barrier::new(cores), scenario.timing.ticks / STRETCH);
    let fly = || {
        let mut rates = Vec::new();
        for _ in 0..REPETITIONS / 50 {
            let mut batch = batch.clone();
            for _ in 0..stretches {
                gate.wait();
                let started = Instant::now();
                for _ in 0..STRETCH {
                    batch.tick(|_, brief| {
                        black_box(brief).ok();
                    });
                }
                gate.wait();
                let simulated = (STRETCH * BESIDE) as f64 * scenario.timing.period() * cores as f64;
                rates.push(simulated / started.elapsed().as_secs_f64());
            }
        }
        rates
    };
    thread::scope(|scope| {
        let others: Vec<_> = (1..cores).map(|_| scope.spawn(fly)).collect();
        let own = fly();
        // They have waited for each other: their times are the same.
        others.into_iter().try_for_each(|other| other.join().map(drop)).map_err(|_| "a thread that panicked")?;
        Ok(Rates::of(own))
    })
}

/// The greatest distance between the two flights at a tick, m.
fn distance(one: &Scenario, other: &Scenario) -> Result<f64, Box<dyn Error>> {
    let (mut one, mut other) = (Flight::new(one)?, Flight::new(other)?);
    let mut greatest = 0.0_f64;
    for _ in 0..Scenario::paper()?.timing.ticks {
        greatest = greatest.max((one.brief_tick()?.state.position - other.brief_tick()?.state.position).norm());
    }
    Ok(greatest)
}

fn word(holds: bool) -> &'static str {
    if holds { "holds" } else { "FAILS" }
}
