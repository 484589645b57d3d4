//! Flies campaigns of recoveries at rates from 10 Hz to 1 kHz, each where the verdict lets the vehicle fly, and prints
//! what they showed: `cargo run --release -p verification --example every_rate -- COUNT FILE...`.
//!
//! They hover at the end, for at 10 Hz the study is up to 0.2 m beside a circle of one metre in a wind. Fails if a
//! flight does not come to its place, attitude and heading for good within 54 s: at no rate may anything cycle.

use host_sim::studies::campaign::draw::circumstances;
use host_sim::studies::campaign::outcome::Outcome;
use host_sim::studies::campaign::quantile;
use host_sim::studies::campaign::step::with_longest_step;
use scenario::Scenario;
use scenario::campaign::{Ranges, Task};
use scenario::verdict::Verdict;
use std::error::Error;
use verification::campaign::fly_all;

/// Hz.
const CONTROL_RATES_HZ: [f64; 12] = [10.0, 12.5, 20.0, 25.0, 40.0, 50.0, 100.0, 125.0, 200.0, 250.0, 500.0, 1000.0];

/// `text` at `rate`, Hz.
fn at(rate: f64, text: &str) -> Result<Scenario, Box<dyn Error>> {
    let mut document: toml_edit::DocumentMut = text.parse()?;
    document["control"]["law"] = toml_edit::value("extended");
    document["control"]["rate"] = toml_edit::value(rate);
    Scenario::parse(&document.to_string(), "at this rate").map_err(|error| error.to_string().into())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [count, files @ ..] = arguments.as_slice() else {
        return Err("expected COUNT FILE...".into());
    };
    let (count, mut wrong): (u64, usize) = (count.parse()?, 0);
    for file in files {
        let text = std::fs::read_to_string(file).map_err(|error| format!("{file}: {error}"))?;
        for rate in CONTROL_RATES_HZ {
            let scenario = match at(rate, &text) {
                Ok(scenario) => with_longest_step(&scenario),
                Err(refusal) => {
                    println!("{file} at {rate} Hz: refused: {refusal}");
                    continue;
                }
            };
            let verdict = Verdict::judge(&scenario)?;
            if let Some(refusal) = verdict.refusal() {
                println!("{} at {rate} Hz: not certified: {refusal}", scenario.name);
                continue;
            }
            let certified = verdict.certified().ok_or("not certified")?;
            let ranges = Ranges { reference: Task::Hover, ..scenario.campaign.ranges };
            let thrown = |number| circumstances(&scenario, &ranges, 0, number);
            let flown = fly_all(certified, count, thrown, |scenario, flight| {
                Outcome::judge(scenario, flight, certified.certificate())
            })?;
            let settled: Vec<f64> = flown.iter().map(|flown| flown.settled.unwrap_or(f64::INFINITY)).collect();
            let [median, slowest] = [0.5, 1.0].map(|part| quantile(&settled, part).unwrap_or(f64::NAN));
            let lost = |outcome: &Outcome| !outcome.tracks() || outcome.fallback > 0 || outcome.beyond > 0;
            let bad: Vec<usize> = (0..flown.len()).filter(|number| lost(&flown[*number])).collect();
            println!(
                "{} at {rate} Hz: {} of {count} recover; within 0.2 m after {median:.2} s (median), {slowest:.2} s \
                 at most",
                scenario.name,
                flown.len() - bad.len()
            );
            for number in bad.iter().take(10) {
                let Outcome { settled, attitude, heading, final_error, fallback, .. } = &flown[*number];
                println!(
                    "  flight {number}: position {settled:?}, attitude {attitude:?}, heading {heading:?} s; ends \
                     {final_error:.3} m off; the fallback came {fallback} times"
                );
            }
            wrong += bad.len();
        }
    }
    if wrong > 0 { Err(format!("{wrong} flights did not recover").into()) } else { Ok(()) }
}
