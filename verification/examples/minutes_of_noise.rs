//! Flies vehicles for minutes in noise and turbulence, from any attitude and up to 10 m away, and prints how far off
//! they were and how often the extended law's fallback came: `cargo run --release -p verification --example
//! minutes_of_noise -- COUNT SECONDS FILE...`.
//!
//! The noise is that of a cheap IMU and of poses from a camera; a steady wind of up to 4 m/s blows from any side, with
//! turbulence as on a stormy day. Fails if a flight ends more than a metre off, could not go on, or had the fallback.

use controller_core::certificate::certified::Certified;
use host_sim::flight::Flight;
use host_sim::studies::campaign::draw::circumstances;
use host_sim::studies::campaign::quantile;
use host_sim::studies::campaign::step::with_longest_step;
use scenario::Scenario;
use scenario::campaign::Ranges;
use std::error::Error;
use verification::campaign::fly_all;

const SENSORS: &str = "\n[sensors]\ngyro_noise = 0.01\nposition_noise = 0.02\nattitude_noise_deg = 0.2\n\
                       velocity = \"exact\"\nvelocity_noise = 0.15\n";

/// m/s.
const WIND_MAX_M_PER_S: f64 = 4.0;
const WIND_AT_20_FEET_M_PER_S: f64 = 12.0;

/// Until when a vehicle may still be on its way, s.
const ARRIVAL_TIME_S: f64 = 60.0;

/// At its end a flight may be so far off, m.
const LAST_DISTANCE_MAX_M: f64 = 1.0;

/// What a flight showed.
struct Flown {
    /// The greatest distance from the reference once it has arrived, and that at the end, m.
    farthest: f64,
    last: f64,
    /// When the fallback came, s.
    slowed: Vec<f64>,
}

fn flown(scenario: &Scenario, mut flight: Flight) -> Flown {
    let mut flown = Flown { farthest: 0.0, last: f64::INFINITY, slowed: Vec::new() };
    for number in 0..scenario.timing.ticks {
        let time = number as f64 * scenario.timing.period();
        let Ok(tick) = flight.brief_tick() else {
            return Flown { farthest: f64::INFINITY, last: f64::INFINITY, ..flown };
        };
        flown.last = (tick.state.position - tick.reference.position.map(f64::from)).norm();
        if time > ARRIVAL_TIME_S {
            flown.farthest = flown.farthest.max(flown.last);
        }
        if flight.fallback_times() as usize > flown.slowed.len() {
            flown.slowed.push(time);
        }
    }
    flown
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [count, seconds, files @ ..] = arguments.as_slice() else {
        return Err("expected COUNT SECONDS FILE...".into());
    };
    let (count, duration): (u64, f64) = (count.parse()?, seconds.parse()?);
    let mut wrong = 0;
    for file in files {
        let text = std::fs::read_to_string(file).map_err(|error| format!("{file}: {error}"))?;
        let scenario = Scenario::parse(&(text + SENSORS), file).map_err(|error| error.to_string())?;
        let scenario = with_longest_step(&scenario);
        let certified = Certified::new(scenario.configuration.clone())
            .map_err(|refused| format!("{file}: not certified: {refused:?}"))?;
        let ranges = Ranges {
            duration,
            wind: WIND_MAX_M_PER_S,
            turbulence: WIND_AT_20_FEET_M_PER_S,
            ..scenario.campaign.ranges
        };
        let all = fly_all(&certified, count, |number| circumstances(&scenario, &ranges, 0, number), flown)?;
        let row = |value: fn(&Flown) -> f64| {
            let values: Vec<f64> = all.iter().map(value).collect();
            [0.5, 0.99, 1.0].map(|part| quantile(&values, part).unwrap_or(f64::NAN))
        };
        let [median, most, farthest] = row(|flown| flown.farthest);
        let [.., last] = row(|flown| flown.last);
        println!(
            "{}: {count} flights of {duration} s; after {ARRIVAL_TIME_S} s at most {median:.2} m off (median), \
             {most:.2} m (99 %), {farthest:.2} m; at the end at most {last:.2} m",
            scenario.name
        );
        for (number, flown) in all.iter().enumerate() {
            if flown.last > LAST_DISTANCE_MAX_M || !flown.slowed.is_empty() {
                println!(
                    "  flight {number}: ends {:.2} m off; the fallback came at {:.0?} s",
                    flown.last, flown.slowed
                );
                wrong += 1;
            }
        }
    }
    if wrong > 0 {
        return Err(format!("{wrong} flights were given away or had the fallback").into());
    }
    println!("the fallback never came");
    Ok(())
}
