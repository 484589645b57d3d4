//! What the paper claims of its design against others, beside what a simulation shows:
//! `cargo run --release -p verification --example paper_claims -- [DIR]`. A table of claims, each confirmed or refuted
//! by a figure; two pictures in DIR (default flights/paper-claims).
//!
//! All on the paper's vehicle with Table I. The nested-saturation design ([`host_sim::rivals::nested`]) has the same
//! attitude law with the same gains and the same level, 2 m/s^2; and either the same small motions (k_p, k_v), or those
//! of 64 pairs that are quickest in Section VI: where there are two figures of it, they are of these two.

mod claims;
mod half_turns;
mod pictures;
mod section_six;

use claims::Claims;
use host_sim::flight::Flight;
use host_sim::flight::course::Course;
use host_sim::studies::campaign::draw::circumstances;
use scenario::Scenario;
use scenario::campaign::{NoiseRanges, Ranges, Task};
use section_six::{MATCHED_GAINS, SectionSix, nested};
use std::error::Error;
use std::path::PathBuf;

/// Random starts of the paper's law.
const START_COUNT: u64 = 200;

fn main() -> Result<(), Box<dyn Error>> {
    let directory = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("flights/paper-claims"), PathBuf::from);
    let paper = Scenario::paper()?;
    let quickest = section_six::searched(&paper)?;
    let flights = [Flight::new(&paper)?, nested(&paper, MATCHED_GAINS)?, nested(&paper, quickest)?];
    let [filtered, matched, quick] = flights.map(|flight| SectionSix::simulate(&paper, flight));
    let (filtered, matched, quick) = (filtered?, matched?, quick?);
    let mut claims = Claims::default();
    section_six::claim(&mut claims, &filtered, [&matched, &quick]);
    section_six::heading(&mut claims, quickest)?;
    section_six::rates(&mut claims, &paper);
    section_six::noise(&mut claims, &paper)?;
    let (turns, held) = half_turns::claim(&mut claims, &paper)?;
    global(&mut claims, &paper)?;
    println!("quickest of nested saturations in Section VI: k_v {}, k_p {:.3}\n", quickest[0], quickest[1]);
    println!("{}", claims.table());

    std::fs::create_dir_all(&directory)?;
    std::fs::write(directory.join("section-six.svg"), pictures::section_six(&filtered, &quick))?;
    std::fs::write(directory.join("half-turn.svg"), pictures::half_turns(&turns, &held))?;
    println!("pictures in {}", directory.display());
    Ok(())
}

/// Random attitudes, rates and offsets: of 200 starts, how many settle, sampled as in the paper and ten times as fast.
fn global(claims: &mut Claims, paper: &Scenario) -> Result<(), Box<dyn Error>> {
    let quick = Scenario::parse(&scenario::PAPER.replace("rate = 100.0", "rate = 1000.0"), "the paper's at 1 kHz")?;
    for (paper, rate) in [(paper, "100 Hz"), (&quick, "1 kHz")] {
        let noise = NoiseRanges::default();
        let own = paper.campaign.ranges;
        let ranges = Ranges { reference: Task::File, duration: 120.0, wind: 0.0, noise, ..own };
        let (mut settled, mut slowest) = (0, 0.0_f64);
        for number in 0..START_COUNT {
            let thrown = circumstances(paper, &ranges, 0, number);
            let course = Course::fly(&thrown, Flight::new(&thrown)?, 0.2)?;
            settled += u64::from(course.settled.is_some());
            slowest = course.settled.map_or(slowest, |settled| slowest.max(settled));
        }
        let ours = format!("{settled} of {START_COUNT} in 120 s, the slowest after {slowest:.1} s");
        let figure = format!("random starts at {rate}, within 0.2 m for good");
        claims.add("tracks from any state", &figure, ours, String::new(), &[settled == START_COUNT]);
    }
    Ok(())
}
