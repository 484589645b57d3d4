//! Random and adversarial setpoint streams against the reference governor: 25,000, or as many as `GOVERNOR_STREAMS`
//! says; the nightly run flies 100,000.
//!
//! Each stream has its own bounds, limits, tick rate and start: at rest, or at any velocity, as a flight that regains
//! its pose starts. Setpoints then come at 50 Hz or as the adversary likes, for a few seconds, and end in a constant
//! one. About one in five is a path sent with position, velocity and acceleration, inside the bounds or not, over a
//! good link or a bad one, for up to 40 s. Checked at every tick, in double precision and without allowance:
//!
//! - every bound of Omega_r;
//! - that position to snap and psi to psi'' are one motion: each derivative integrates to the one below. Between ticks
//!   the reference is a spline with linear snap, so Euler and Maclaurin's corrected trapezoids are exact and the
//!   tolerance is the rounding of the numbers compared;
//! - that snap and psi'' move no faster than their ramps allow.
//!
//! And in the end: at rest, exactly on the setpoint; if it started from rest, without having passed it or turned back.

mod adversary;
mod case;
mod path;
mod witness;

use adversary::{Adversary, Trouble};
use case::{Case, Random};
use controller_core::governor::{Governor, HeadingSetpoint, Memory, Motion, Setpoint};
use controller_core::prelude::{Vector2, Vector3};
use core::f32::consts::PI;
use witness::{Approach, Tally, Witness};

const STREAM_COUNT: u64 = 25_000;
/// No arrival from rest takes longer; the slowest bounds drawn need most of it.
const ARRIVAL_TIMEOUT_S: f32 = 150.0;

fn fly(seed: u64, tally: &mut Tally) {
    let mut random = Random::new(seed);
    let case = Case::draw(&mut random);
    let mut start = case.resting(&mut random);
    let adversary = Adversary::draw(&mut random, &case, &start.position);
    let moves = !matches!(adversary, Adversary::Constant) && random.below(3) > 0;
    if moves {
        let size = random.sized(0.1, 10.0);
        start.velocity = random.vector(size);
        tally.moving += 1;
    }
    let mut memory = Memory::EMPTY;
    let governor = Governor::new(&case.bounds, &case.limits, case.period, &mut memory).unwrap();
    governor.start(&start.position, &start.velocity, &start.heading).unwrap();
    let mut witness = Witness { case: &case, last: governor.tick() };
    witness.start(&start, tally);
    let busy = match adversary {
        Adversary::Constant => 0.0,
        Adversary::Following { .. } => random.between(5.0, 40.0),
        _ => random.between(1.0, 5.0),
    };
    let busy = (busy / case.period) as u32;
    for tick in 0..busy {
        let now = witness.last;
        adversary.send(tick, &mut random, governor, &now, case.period);
        witness.see(governor.tick(), tally);
        if let Adversary::Following { path, trouble: Trouble::None, .. } = adversary {
            let [position, ..] = path.at(f64::from(tick + 1) * f64::from(case.period));
            let miss = (witness.last.position - position).norm();
            tally.sent += 1;
            tally.followed += u64::from(f64::from(miss) < 0.01 * path.size());
        }
    }
    let size = random.sized(1e-3, 20.0);
    let target = witness.last.position + random.vector(size);
    let angle = random.between(-PI, PI);
    let ending = random.below(8);
    if ending == 0 {
        governor.stop();
    } else if ending == 1 && busy > 0 {
        // Silence: what was sent last runs out or is arrived at, unless it is a million metres away.
        let motion = Motion::Velocity(random.vector(2.0));
        governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Rate(0.5) }).unwrap();
    } else {
        let turn = HeadingSetpoint::Angle { angle, rate: 0.0 };
        governor.accept(&Setpoint { motion: Motion::Position(target), turn }).unwrap();
    }
    let mut approach = (busy == 0 && !moves && ending > 1).then(|| Approach {
        from: start.position.map(f64::from),
        to: target.map(f64::from),
        along: 0.0,
        aside: {
            let (horizontal, vertical) = (case.bounds.horizontal_acceleration, case.bounds.vertical_acceleration);
            3.0_f64.sqrt() / 65_536.0 * f64::from((horizontal / vertical).max(vertical / horizontal))
        },
    });
    let patience = ARRIVAL_TIMEOUT_S + 2.0 * case.returning(&start.velocity);
    let mut time = 0.0;
    while !governor.at_rest() {
        let reference = governor.tick();
        witness.see(reference, tally);
        if let Some(approach) = &mut approach {
            approach.see(&reference.position);
        }
        time += case.period;
        assert!(time < patience, "no arrival: {reference:?} for {target}");
    }
    tally.longest = tally.longest.max(time);
    if ending > 1 {
        let there = governor.tick();
        // A length unit is a 65,536th part or less of the acceleration bound times period squared: 4e-8 m at the
        // coarsest.
        let miss = (there.position - target).abs();
        assert!(miss.iter().zip(&target).all(|(miss, to)| *miss <= 4e-8 + f32::EPSILON * to.abs()), "off by {miss}");
        let (sin, cos) = angle.sin_cos();
        assert!((there.heading.direction() - Vector2::new(cos, sin)).norm() < 1e-6);
        assert_eq!((there.velocity, there.heading.rate()), (Vector3::zeros(), 0.0));
    }
}

#[test]
fn streams_never_leave_the_bounds_and_all_arrive() {
    let streams = std::env::var("GOVERNOR_STREAMS").map_or(STREAM_COUNT, |number| number.parse().expect("a number"));
    let threads = std::thread::available_parallelism().map_or(2, usize::from).min(8) as u64;
    let tally = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|thread| {
                scope.spawn(move || {
                    let mut tally = Tally::default();
                    for seed in (thread..streams).step_by(threads as usize) {
                        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| fly(seed, &mut tally)));
                        assert!(outcome.is_ok(), "stream {seed} failed");
                    }
                    tally
                })
            })
            .collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).fold(Tally::default(), |all, one| all.merged(&one))
    });
    let Tally { ticks, moving, sent, followed, .. } = tally;
    println!("{ticks} ticks; {moving} starts in motion");
    println!("{followed} of {sent} ticks within a hundredth of a path sent as it is");
    println!("nearest to the bounds (shares): {:.4?}; longest arrival {:.1} s", tally.nearest, tally.longest);
    // Streams that are never followed directly prove nothing of it.
    assert!(followed > sent / 8, "{followed} of {sent}");
    // Adversaries that stay far inside prove nothing.
    assert!(tally.nearest.iter().all(|nearest| *nearest > 0.99), "{:?}", tally.nearest);
}
