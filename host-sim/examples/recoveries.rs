//! Flies a campaign of recoveries and prints what it showed:
//! `cargo run --release -p host-sim --example recoveries -- FILE COUNT`.

use controller_core::certificate::certified::Certified;
use host_sim::campaign::outcome::Outcome;
use host_sim::campaign::quantile;
use host_sim::campaign::recoveries::recoveries;
use scenario::Scenario;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, count] = arguments.as_slice() else {
        return Err("expected FILE COUNT".into());
    };
    let scenario = Scenario::load(Path::new(file))?;
    let certified = Certified::new(scenario.configuration.clone())
        .map_err(|refused| format!("{file}: not certified: {refused:?}"))?;
    let flown = recoveries(&scenario, &certified, count.parse()?)?;
    let row = |what: &str, unit: &str, value: fn(&Outcome) -> f64| {
        let values: Vec<f64> = flown.iter().map(value).collect();
        let [median, most, worst] = [0.5, 0.99, 1.0].map(|part| quantile(&values, part).unwrap_or(f64::NAN));
        let number = values.iter().position(|value| *value == worst).unwrap_or(0);
        println!(
            "{what:28} median {median:8.2} {unit}   99 % {most:8.2} {unit}   greatest {worst:8.2} {unit} (flight {number})"
        );
    };
    println!("{}: {} flights", scenario.name, flown.len());
    row("height lost", "m", |outcome| outcome.height_lost);
    row("rise above start and target", "m", |outcome| outcome.rise);
    row("settled within 0.2 m after", "s", |outcome| outcome.settled.unwrap_or(f64::INFINITY));
    let count = |what: fn(&Outcome) -> bool| flown.iter().filter(|outcome| what(outcome)).count();
    println!("not settled at the end: {}", count(|outcome| outcome.settled.is_none()));
    println!("with a rotor asked for more than it has: {}", count(|outcome| outcome.clipped > 0));
    println!("with a command beyond its certified bound: {}", count(|outcome| outcome.beyond > 0));
    Ok(())
}
