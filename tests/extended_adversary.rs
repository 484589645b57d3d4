//! The extended law's certificate against an adversary that searches everything reachable.
//!
//! Nothing it finds may exceed its bound; and it has to find a good part of every bound, or the bound would be dear and the
//! adversary no test of it. `cargo test -p host-sim extended_adversary -- --nocapture` prints found / bound of every row.

use crate::support::extended::situation::{ATTITUDE, COORDINATES, Code, World};
use crate::support::extended::{around_the_example, bounds, paper_vehicle, vehicle};
use crate::support::random::{self, ChaCha8Rng};
use controller_core::certificate::configuration::Configuration;
use rand::RngExt;

/// What has to be found of every bound.
const SHARE: f64 = 0.8;

/// The single-precision error of one evaluation, relative to a bound.
const EVALUATION_ERROR: f64 = 1e-5;

/// Climbs from random starts, and the finest step of one.
const RESTARTS: usize = 60;
const FINEST_STEP: f64 = 1e-3;

/// Random moves of the whole code per sweep, for ridges that no single coordinate climbs.
const OBLIQUE_MOVES: usize = 12;

/// What the adversary drives up.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Objective {
    Rate,
    Acceleration,
    Torque(usize),
    Thrust,
    Rotor(usize),
    Floor,
}

impl Objective {
    fn value(self, world: &World, code: &Code) -> f64 {
        let situation = world.decode(code);
        let [velocity, acceleration] = &situation.desired;
        match self {
            Self::Rate => f64::from(velocity.xy().norm()),
            Self::Acceleration => f64::from(acceleration.xy().norm()),
            Self::Torque(axis) => f64::from(world.torque(&situation)[axis].abs()),
            Self::Thrust => f64::from(world.thrust(&situation)),
            Self::Rotor(rotor) => world.rotor(&situation, rotor),
            Self::Floor => world.floor_share(&situation),
        }
    }

    fn coordinates(self) -> usize {
        if matches!(self, Self::Rate | Self::Acceleration) { ATTITUDE } else { COORDINATES }
    }
}

fn climb(value: impl Fn(&Code) -> f64, used: usize, start: Code, rng: &mut ChaCha8Rng) -> f64 {
    let mut best = (value(&start), start);
    let mut step = 1.0;
    while step > FINEST_STEP {
        let before = best.0;
        for coordinate in 0..used {
            for change in [step, -step] {
                let mut code = best.1;
                code[coordinate] = (code[coordinate] + change).clamp(-1.0, 1.0);
                let found = value(&code);
                if found > best.0 {
                    best = (found, code);
                    break;
                }
            }
        }
        for _ in 0..OBLIQUE_MOVES {
            let code = best.1.map(|c| (c + step * rng.random_range(-1.0..1.0_f64)).clamp(-1.0, 1.0));
            let found = value(&code);
            if found > best.0 {
                best = (found, code);
            }
        }
        if best.0 <= before * (1.0 + 1e-4) {
            step *= 0.5;
        }
    }
    best.0
}

/// What was found of one bound.
struct Found {
    objective: Objective,
    found: f64,
    bound: f64,
}

/// Attacks every bound with `restarts` climbs each; fails where one is exceeded.
fn attack(configuration: &Configuration, restarts: usize, rng: &mut ChaCha8Rng) -> Vec<Found> {
    let (world, promised) = (World::new(configuration), bounds(configuration));
    let [rate, acceleration] = promised.rates;
    let mut rows = vec![(Objective::Rate, rate), (Objective::Acceleration, acceleration)];
    rows.extend((0..3).map(|axis| (Objective::Torque(axis), promised.torque[axis])));
    rows.push((Objective::Thrust, promised.thrust.greatest));
    rows.extend(promised.rotors.iter().enumerate().map(|(rotor, range)| (Objective::Rotor(rotor), range.greatest)));
    rows.push((Objective::Floor, promised.floor[0] / promised.floor[1]));
    let attacked = rows.into_iter().map(|(objective, bound)| {
        let value = |code: &Code| objective.value(&world, code);
        let mut found = 0.0_f64;
        for _ in 0..restarts {
            let start = [(); COORDINATES].map(|()| (1.6 * rng.random_range(-1.0..1.0_f64)).clamp(-1.0, 1.0));
            found = found.max(climb(value, objective.coordinates(), start, rng));
        }
        let most = bound * (1.0 + EVALUATION_ERROR);
        assert!(found <= most, "{objective:?}: found {found} beyond {bound} with {configuration:?}");
        Found { objective, found, bound }
    });
    attacked.collect()
}

/// Attacks, prints found / bound, and fails where too little is found.
fn nearly_reach(name: &str, configuration: &Configuration, seed: u64) {
    let mut weak = Vec::new();
    for Found { objective, found, bound } in attack(configuration, RESTARTS, &mut random::generator(seed)) {
        let share = found / bound;
        println!("{name:12} {objective:12?} found {found:9.4} of {bound:9.4}: {share:.3}");
        if share < SHARE {
            weak.push((objective, share));
        }
    }
    assert!(weak.is_empty(), "{name}: too little found of {weak:?}");
}

#[test]
fn on_the_hummingbird_every_bound_stands_and_is_nearly_reached() {
    nearly_reach("hummingbird", &vehicle("hummingbird").configuration, 201);
}

#[test]
fn on_the_study_every_bound_stands_and_is_nearly_reached() {
    nearly_reach("study", &vehicle("study").configuration, 202);
}

#[test]
fn on_the_papers_vehicle_every_bound_stands_and_is_nearly_reached() {
    nearly_reach("paper", &paper_vehicle(), 203);
}

#[test]
fn the_bounds_stand_with_random_configurations() {
    let mut rng = random::generator(204);
    let mut closest = Vec::<(Objective, f64)>::new();
    for _ in 0..60 {
        for (place, row) in attack(&around_the_example(&mut rng), 2, &mut rng).iter().enumerate() {
            let share = row.found / row.bound;
            match closest.get_mut(place) {
                Some((_, most)) => *most = most.max(share),
                None => closest.push((row.objective, share)),
            }
        }
    }
    println!("closest to the bounds: {closest:.3?}");
}
