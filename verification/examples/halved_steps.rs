//! Whether a campaign's verdicts depend on its plant step: flies each flight with the step that campaigns take and with
//! half of it. `cargo run --release -p verification --example halved_steps -- FILE COUNT`. The exit status is 1 if a
//! verdict changes.

use controller_core::certificate::certified::Certified;
use host_sim::studies::campaign::draw::circumstances;
use host_sim::studies::campaign::outcome::Outcome;
use host_sim::studies::campaign::quantile;
use host_sim::studies::campaign::step::{with_longest_step, with_step};
use scenario::Scenario;
use std::error::Error;
use std::path::Path;
use verification::campaign::fly_all;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, count] = arguments.as_slice() else {
        return Err("expected FILE COUNT".into());
    };
    let scenario = with_longest_step(&Scenario::load(Path::new(file))?);
    let finer = with_step(&scenario, 0.5 * scenario.timing.step())?;
    let certified = Certified::new(scenario.configuration.clone())
        .map_err(|refused| format!("{file}: not certified: {refused:?}"))?;
    let fly = |scenario: &Scenario| {
        let thrown = |number| circumstances(scenario, &scenario.campaign.ranges, scenario.campaign.seed, number);
        fly_all(&certified, count.parse::<u64>()?, thrown, |scenario, flight| {
            Outcome::judge(scenario, flight, certified.certificate())
        })
        .map_err(Box::<dyn Error>::from)
    };
    let pairs: Vec<(Outcome, Outcome)> = fly(&scenario)?.into_iter().zip(fly(&finer)?).collect();
    println!(
        "{}: {} flights, plant steps {} and {} ms",
        scenario.name,
        pairs.len(),
        1e3 * scenario.timing.step(),
        1e3 * finer.timing.step()
    );
    let row = |what: &str, unit: &str, value: fn(&Outcome) -> f64| {
        let differences: Vec<f64> = pairs.iter().map(|(one, other)| (value(one) - value(other)).abs()).collect();
        let [median, most, worst] = [0.5, 0.99, 1.0].map(|part| quantile(&differences, part).unwrap_or(f64::NAN));
        let number = differences.iter().position(|difference| *difference == worst).unwrap_or(0);
        println!(
            "{what:20} differs by: median {median:.1e} {unit}, 99 % {most:.1e} {unit}, greatest {worst:.1e} {unit} (flight {number})"
        );
    };
    row("height lost", "m", |outcome| outcome.height_lost);
    row("settled", "s", |outcome| outcome.settled.unwrap_or(f64::INFINITY));
    row("error at the end", "m", |outcome| outcome.final_error);
    let changed: Vec<usize> =
        (0..pairs.len()).filter(|flight| pairs[*flight].0.verdict(true) != pairs[*flight].1.verdict(true)).collect();
    println!("verdicts that change: {}", changed.len());
    if changed.is_empty() { Ok(()) } else { Err(format!("flights {changed:?}").into()) }
}
