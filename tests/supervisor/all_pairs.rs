//! Every two failures of the fault campaign, in either order, in every phase, at every distance: 27,301 flights, 98
//! hours of them. It takes seven minutes of two cores, so it is a program of its own that `cargo test` alone does not
//! run:
//!
//! `cargo test --release -p host-sim --test all_pairs -- --nocapture`

mod fault_campaign;

use fault_campaign::{fly_pairs, pairs};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

#[test]
fn all_pairs_of_failures_end_as_the_more_severe_of_them_must() {
    fly_pairs(pairs(&mut ChaCha8Rng::seed_from_u64(2)).into_iter().map(|(case, _)| case).collect());
}
