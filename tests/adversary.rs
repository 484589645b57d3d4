//! The sharp bound of the certificate against an adversary that searches everything reachable.

mod adversary_search;
mod random;

use adversary_search::Domain;
use adversary_search::configurations::{around_table_1, paper};
use adversary_search::search::{Objective, worst};
use controller_core::certificate::configuration::Configuration;
use controller_core::certificate::{ARITHMETIC_ALLOWANCE, Certificate, Form};

/// Everything the adversary attacks.
const OBJECTIVES: [Objective; 8] = [
    Objective::AngularVelocity,
    Objective::AngularAcceleration,
    Objective::Feedforward(0),
    Objective::Feedforward(1),
    Objective::Feedforward(2),
    Objective::Torque(0),
    Objective::Torque(1),
    Objective::Torque(2),
];

/// What a form of the certificate promises about `objective`.
fn promised(form: &Form, objective: Objective) -> f64 {
    match objective {
        Objective::AngularVelocity => form.rates.angular_velocity,
        Objective::AngularAcceleration => form.rates.angular_acceleration,
        Objective::Feedforward(axis) => form.rates.feedforward_torque[axis],
        Objective::Torque(axis) => form.torque[axis],
    }
}

/// Attacks every objective; returns what was found.
fn attack(configuration: &Configuration, domain: Domain, restarts: usize, seed: u64) -> [f64; OBJECTIVES.len()] {
    let certificate = Certificate::new(configuration);
    let mut rng = random::generator(seed);
    OBJECTIVES.map(|objective| {
        let found = worst(configuration, domain, objective, restarts, &mut rng).value;
        let (sharp, printed) = (promised(&certificate.sharp, objective), promised(&certificate.printed, objective));
        println!("{objective:?}: found {found:.4}, sharp {sharp:.4}, printed {printed:.4}");
        assert!(sharp <= printed * (1.0 + 1e-12), "{objective:?}: sharp {sharp} above printed {printed}");
        assert!(
            found <= sharp * (1.0 + ARITHMETIC_ALLOWANCE),
            "{objective:?}: found {found} above the bound {sharp} with {:?} {:?}",
            configuration.gains(),
            configuration.bounds()
        );
        found
    })
}

#[test]
fn with_table_1_the_adversary_is_strong_and_the_bound_stands() {
    for n in [10] { for seed in 1..5 { attack(&paper(), Domain::Reachable, n, seed);attack(&paper(), Domain::Decoupled, n, seed); println!(); } }
    let found = attack(&paper(), Domain::Decoupled, 200, 1);
    let [velocity, acceleration, .., roll, pitch, yaw] = found;
    assert!(velocity >= 2.06 && acceleration >= 36.1, "{found:?}");
    assert!(roll >= 0.233 && pitch >= 0.257 && yaw >= 0.335, "{found:?}");
}

#[test]
fn the_bound_stands_with_300_random_configurations() {
    let mut rng = random::generator(2);
    for number in 0..300 {
        let spread = if number % 2 == 0 { 2.0 } else { 8.0 };
        attack(&around_table_1(&mut rng, spread), Domain::Reachable, 4, 1000 + number);
    }
}
