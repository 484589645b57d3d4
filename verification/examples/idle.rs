//! What the least rotor command costs:
//! `cargo run --release -p verification --example idle -- COUNT FILES`.
//!
//! Each vehicle flies with rotors that may be commanded as low as its `speed` says (`idle = 0`), with its file's idle,
//! and with that on motors whose thrust is by 0.3 linear in the command: from upside down at rest, and COUNT random
//! flights as `host-sim campaign` draws them. Prints a row of a table for each, and why a vehicle is not certified. Fails
//! if a flight does not recover, or a rotor is commanded below what its motor idles at.

use controller_core::certificate::certified::{Certified, Refused};
use host_sim::flight::Flight;
use host_sim::flight::course::Course;
use host_sim::flight::tasks::recovery;
use host_sim::studies::campaign::draw::circumstances;
use host_sim::studies::campaign::outcome::Outcome;
use host_sim::studies::campaign::quantile;
use host_sim::studies::campaign::step::with_longest_step;
use scenario::Scenario;
use std::error::Error;
use std::fs;
use verification::campaign::fly_all;

/// The flight from upside down, s, and how near it arrives, m.
const RECOVERY_DURATION_S: f64 = 15.0;
const ARRIVAL_DISTANCE_M: f64 = 0.1;

/// Keys of `[rotors]` that are added to the file.
const VARIANTS: [&str; 3] = ["idle = 0", "", "thrust_curve = 0.3"];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((count, files)) = arguments.split_first() else {
        return Err("expected COUNT FILES".into());
    };
    println!(
        "| vehicle | with | least command: allowed, flown | from upside down: height lost, m; within 0.1 m, s | {count} \
         flights: height lost, median, 99 %, greatest, m | slowest, s | tightest margin |\n|---|---|---|---|---|---|---|"
    );
    for file in files {
        let text = fs::read_to_string(file)?;
        for variant in VARIANTS {
            let heading = text.lines().find(|line| line.starts_with("[rotors]")).ok_or("[rotors]: missing")?;
            let text = text.replacen(heading, &format!("[rotors]\n{variant}"), 1);
            println!("{}", row(&Scenario::parse(&text, file)?, variant, count.parse()?)?);
        }
    }
    Ok(())
}

/// What `scenario` does, as a row.
fn row(scenario: &Scenario, variant: &str, count: u64) -> Result<String, Box<dyn Error>> {
    let allowed = 100.0 * scenario.least_command.map_or(0.0, |least| least.command);
    let said = if variant.is_empty() { "its file's idle" } else { variant };
    let certified = match Certified::new(scenario.configuration.clone()) {
        Ok(certified) => certified,
        Err(Refused::Undefined(error)) => return Err(error.into()),
        Err(Refused::Fails(certificate)) => {
            let failing = certificate.inequalities().find(|inequality| !inequality.holds());
            let why = failing.map_or(String::new(), |inequality| format!("not certified: {inequality}"));
            return Ok(format!("| `{}` | {said} | {allowed:.2} % | {why} | | | |", scenario.name));
        }
    };
    let upside_down = recovery(scenario, RECOVERY_DURATION_S)?;
    let flight = Flight::certified(&upside_down, &certified)?;
    let Course { height_lost, settled, .. } = Course::fly(&upside_down, flight, ARRIVAL_DISTANCE_M)?;

    let longest = with_longest_step(scenario);
    let thrown = |number| circumstances(&longest, &longest.campaign.ranges, 0, number);
    let flown = fly_all(&certified, count, thrown, |scenario, flight| {
        Outcome::judge(scenario, flight, certified.certificate())
    })?;
    let lost = flown.iter().filter(|outcome| !outcome.holds()).count();
    let least = flown.iter().filter_map(|outcome| outcome.least_command.least()).fold(f64::INFINITY, f64::min);
    let motor = scenario.motor();
    if lost > 0 || least < f64::from(motor.idle) {
        return Err(format!("{} {variant}: {lost} do not hold; least command {least}", scenario.name).into());
    }
    let heights: Vec<f64> = flown.iter().map(|outcome| outcome.height_lost).collect();
    let [median, most, worst] = [0.5, 0.99, 1.0].map(|part| quantile(&heights, part).unwrap_or(f64::NAN));
    let slowest = flown.iter().map(|outcome| outcome.settled.unwrap_or(f64::INFINITY)).fold(0.0, f64::max);
    let margin = certified.certificate().tightest().map_or(f64::NAN, |tightest| tightest.margin());
    Ok(format!(
        "| `{}` | {said} | {allowed:.2} %, {:.2} % | {height_lost:.3}; {:.2} | {median:.3}, {most:.3}, {worst:.3} | {slowest:.2} | \
         {:.1} % |",
        scenario.name,
        100.0 * least,
        settled.unwrap_or(f64::INFINITY),
        100.0 * margin
    ))
}
