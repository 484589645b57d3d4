//! Flies a campaign of recoveries and prints what it showed:
//! `cargo run --release -p verification --example recoveries -- FILE COUNT`.
//!
//! A certified vehicle, its state known, is thrown into the air. Each flight starts anywhere within 10 m of where it is
//! to be, at any attitude (uniform), with up to 5 m/s, 15 rad/s across and 6 rad/s about its thrust axis, in wind of up
//! to 5 m/s from any side (2.5 m/s^2 on a Hummingbird). It is to hover or, every other one, to fly its file's own
//! reference. Fails if a flight does not recover.

use controller_core::certificate::certified::Certified;
use host_sim::studies::campaign::draw::circumstances;
use host_sim::studies::campaign::outcome::Outcome;
use host_sim::studies::campaign::quantile;
use host_sim::studies::campaign::step::with_longest_step;
use scenario::Scenario;
use scenario::campaign::{FailureRanges, ModelRanges, NoiseRanges, Ranges, Task};
use std::error::Error;
use std::path::Path;
use verification::campaign::fly_all;

/// The ranges of the draws.
const RANGES: Ranges = Ranges {
    duration: 60.0,
    reference: Task::InTurn,
    attitude: true,
    offset: 10.0,
    velocity: 5.0,
    rate: 15.0,
    yaw_rate: 6.0,
    wind: 5.0,
    gust: 0.0,
    turbulence: 0.0,
    noise: NoiseRanges { gyro: 0.0, position: 0.0, attitude: 0.0, delay: 0.0 },
    model: ModelRanges { mass: 0.0, inertia: 0.0, centre_of_mass: 0.0, thrust_scale: 0.0, rotor_scales: 0.0 },
    failure: FailureRanges::DEFAULT,
};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, count] = arguments.as_slice() else {
        return Err("expected FILE COUNT".into());
    };
    let scenario = with_longest_step(&Scenario::load(Path::new(file))?);
    let certified = Certified::new(scenario.configuration.clone())
        .map_err(|refused| format!("{file}: not certified: {refused:?}"))?;
    let thrown = |number| circumstances(&scenario, &RANGES, 0, number);
    let flown = fly_all(&certified, count.parse()?, thrown, |scenario, flight| {
        Outcome::judge(scenario, flight, certified.certificate())
    })?;
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
    row("within 0.2 m for good after", "s", |outcome| outcome.settled.unwrap_or(f64::INFINITY));
    row("attitude settled after", "s", |outcome| outcome.attitude.unwrap_or(f64::INFINITY));
    row("heading settled after", "s", |outcome| outcome.heading.unwrap_or(f64::INFINITY));
    let count = |what: fn(&Outcome) -> bool| flown.iter().filter(|outcome| what(outcome)).count();
    let lost = count(|outcome| !outcome.tracks());
    println!("not settled within the first 90 %: {lost}");
    let least = flown.iter().filter_map(|outcome| outcome.least_command.least()).fold(f64::INFINITY, f64::min);
    println!(
        "least rotor command: {:.2} % of a full one; motors idle at {:.2} %",
        100.0 * least,
        100.0 * scenario.motor().idle
    );
    println!("with the fallback: {}", count(|outcome| outcome.fallback > 0));
    println!("with a rotor commanded more than it has: {}", count(|outcome| outcome.clipped > 0));
    println!("with a command beyond its certified bound: {}", count(|outcome| outcome.beyond > 0));
    if lost > 0 { Err(format!("{lost} flights did not recover").into()) } else { Ok(()) }
}
