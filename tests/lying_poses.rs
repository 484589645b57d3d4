//! Poses that lie: a random source of poses in any phase of a flight, flown in closed loop by the core's whole pilot;
//! and each flight held to what an operator may count on.

mod flight;
mod lie;

use controller_core::certificate::certified::Certified;
use flight::{Begins, Case, Flown, fly};
use lie::{Lie, drawn};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;
use scenario::Scenario;

fn study() -> (Scenario, Certified) {
    let scenario = Scenario::parse(scenario::STUDY, "study").unwrap();
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    (scenario, certified)
}

fn fly_all(cases: Vec<Case>) -> Vec<Flown> {
    let (scenario, certified) = study();
    cases.into_par_iter().map(|case| fly(&scenario, &certified, &case)).collect()
}

/// What must not be.
fn complaint(flown: &Flown) -> Option<String> {
    if !flown.flew {
        return None;
    }
    let Some(down_after) = flown.down_after else { return Some("never down".to_owned()) };
    let off_after = flown.off_after.unwrap_or(0.0);
    if down_after > 30.0 {
        return Some(format!("down after {down_after:.1} s"));
    }
    if off_after > 3.0 {
        return Some(format!("motors off {off_after:.1} s after touchdown"));
    }
    if flown.rose > 0.5 {
        return Some(format!("rose {:.2} m", flown.rose));
    }
    if flown.out > 3.0 {
        return Some(format!("{:.1} m out of its box", flown.out));
    }
    None
}

#[test]
fn explore() {
    let mut random = ChaCha8Rng::seed_from_u64(30);
    let count = std::env::var("LIES").ok().and_then(|count| count.parse().ok()).unwrap_or(300);
    let mut cases: Vec<Case> = Vec::new();
    for seed in 0..count {
        let begins = Begins::ALL[random.random_range(0..Begins::ALL.len())];
        let lies = drawn(&mut random);
        let ends_after = random.random_bool(0.3).then(|| random.random_range(0.5..10.0));
        cases.push(Case { begins, lies, ends_after, land_after: random.random_range(1.0..15.0), seed });
    }
    for degrees in [45.0_f32, 60.0, 75.0] {
        for begins in [Begins::AtBoot, Begins::Holding] {
            cases.push(Case {
                begins,
                lies: vec![Lie::HeadingOff(degrees.to_radians())],
                ends_after: None,
                land_after: 15.0,
                seed: 1,
            });
        }
    }
    for rate in [1.0_f32, 2.0, 5.0] {
        for begins in [Begins::Holding, Begins::Moving] {
            cases.push(Case {
                begins,
                lies: vec![Lie::HeadingDrifts(rate.to_radians())],
                ends_after: None,
                land_after: 30.0,
                seed: 1,
            });
        }
    }
    for every in [1.1, 1.5, 2.0] {
        cases.push(Case {
            begins: Begins::Landing,
            lies: vec![Lie::Comes { for_seconds: 0.03, every }],
            ends_after: None,
            land_after: 1.0,
            seed: 1,
        });
        cases.push(Case {
            begins: Begins::Holding,
            lies: vec![Lie::Comes { for_seconds: 0.03, every }],
            ends_after: None,
            land_after: 10.0,
            seed: 1,
        });
    }
    for seed in 0..10 {
        cases.push(Case {
            begins: Begins::Holding,
            lies: vec![Lie::Comes { for_seconds: 0.0, every: 1e9 }],
            ends_after: None,
            land_after: 30.0,
            seed,
        });
        cases.push(Case {
            begins: Begins::Landing,
            lies: vec![Lie::Noisy(0.05, 0.001)],
            ends_after: None,
            land_after: 30.0,
            seed,
        });
    }
    cases.push(Case {
        begins: Begins::AtBoot,
        lies: vec![Lie::Claims(1e-4, 1e-4)],
        ends_after: None,
        land_after: 20.0,
        seed: 1,
    });
    let only: Option<u64> = std::env::var("ONLY").ok().and_then(|only| only.parse().ok());
    if let Some(only) = only {
        cases = vec![cases[only as usize].clone()];
    }
    let start = std::time::Instant::now();
    let flown = fly_all(cases);
    println!("{} flights in {:.1} s", flown.len(), start.elapsed().as_secs_f64());
    let mut off: Vec<f64> = flown.iter().filter(|f| f.flew).filter_map(|f| f.off_after).collect();
    off.sort_by(f64::total_cmp);
    println!("flew {}, median off {:?}, max {:?}", off.len(), off.get(off.len() / 2), off.last());
    println!("hard touchdowns {}", flown.iter().filter(|f| f.touchdown > 2.0).count());
    let mut wrong = 0;
    for (number, flown) in flown.iter().enumerate() {
        let complaint = complaint(flown);
        wrong += usize::from(complaint.is_some());
        if complaint.is_some() || only == Some(number as u64) || flown.touchdown > 2.0 || flown.stopped_at > 0.3 {
            let Case { begins, lies, ends_after, land_after, .. } = &flown.case;
            println!(
                "{number} {}: {begins:?} {lies:?} ends {ends_after:.1?} land {land_after:.1}; out {:.2} down {:?} off {:?} rose {:.2} hit {:.2} stopped at {:.2}",
                complaint.unwrap_or_default(),
                flown.out,
                flown.down_after,
                flown.off_after,
                flown.rose,
                flown.touchdown,
                flown.stopped_at
            );
            let mut path: Vec<String> = flown.path.iter().map(|(t, r)| format!("{t:.1} {r:?}")).collect();
            if path.len() > 12 {
                let l = path.len();
                path.splice(8..l - 4, [format!("...{l}...")]);
            }
            println!("      {}", path.join(", "));
        }
    }
    println!("{wrong} wrong");
}
