//! Which failures are found, and how soon; and what is not taken for a failure.

use super::*;
use crate::extended::tests::Random;
use crate::extended::tests::example::{rotors as quad, vehicle};

const PERIOD: f32 = 0.01;
const WEIGHT: f32 = 4.905;

/// A level vehicle whose rotors are commanded some thrusts, N, and deliver others, beside a force, N, along its z and a
/// torque, N m; and its detector.
struct Watched {
    detector: Detector,
    suspicion: Suspicion,
    rate: Vector3<f32>,
}

impl Watched {
    fn new(lag: f32) -> Self {
        let detector = Detector::new(&vehicle(), Some(&quad()), lag, PERIOD);
        Self { detector, suspicion: Suspicion::NONE, rate: Vector3::zeros() }
    }

    fn sum(thrusts: [f32; 4]) -> Vector4<f32> {
        quad().effectiveness().iter().zip(thrusts).map(|(column, f)| column.map(|x| x as f32) * f).sum()
    }

    fn pass(
        &mut self,
        commanded: [f32; 4],
        delivered: [f32; 4],
        force: f32,
        torque: Vector3<f32>,
    ) -> Option<LostRotor> {
        let wrench = Self::sum(delivered) + Vector4::new(force, torque.x, torque.y, torque.z);
        let inertia = vehicle().inertia;
        let gyroscopic = self.rate.cross(&inertia.component_mul(&self.rate));
        let change = (Vector3::new(wrench.y, wrench.z, wrench.w) - gyroscopic).component_div(&inertia) * PERIOD;
        let start = self.rate;
        let end = start + change;
        let interval = Interval {
            acceleration: Vector3::z() * (wrench.x / 0.5 - 9.81),
            angular_velocities: [&start, &end],
            axis: Vector3::z(),
            acted: Self::sum(commanded),
        };
        let found = self.detector.observe(&mut self.suspicion, &interval);
        // Rates stay small, as of a vehicle that is held.
        self.rate = end * 0.5;
        found
    }

    /// Commands near hover.
    fn hovering(random: &mut Random) -> [f32; 4] {
        [(); 4].map(|()| 0.25 * WEIGHT * random.between(0.9, 1.1))
    }

    fn settled(random: &mut Random, lag: f32) -> Self {
        let mut watched = Self::new(lag);
        for _ in 0..300 {
            let thrusts = Self::hovering(random);
            assert_eq!(watched.pass(thrusts, thrusts, 0.0, Vector3::zeros()), None);
        }
        watched
    }
}

#[test]
fn a_dead_rotor_is_found_within_a_tenth_of_a_second_and_it_is_that_one() {
    let mut random = Random(1);
    for number in 0..200 {
        let (rotor, lag) = (number % 4, 0.01 * random.between(0.0, 3.0));
        let mut watched = Watched::settled(&mut random, lag);
        let found = (1..=10).find_map(|tick| {
            let commanded = Watched::hovering(&mut random);
            let mut delivered = commanded;
            delivered[rotor] = 0.0;
            Some((watched.pass(commanded, delivered, 0.0, Vector3::zeros())?, tick))
        });
        let (lost, ticks) = found.unwrap();
        assert_eq!((lost.rotor, lost.left), (rotor, 0.0), "after {ticks}");
        assert!(ticks <= 7, "{ticks}");
    }
}

#[test]
fn what_is_left_of_a_rotor_is_told_within_a_tenth_and_less_of_a_loss_takes_longer() {
    let mut random = Random(2);
    let mut before = 0;
    for left in [0.2, 0.35, 0.5, 0.6] {
        let mut watched = Watched::settled(&mut random, 0.005);
        let found = (1..=400).find_map(|tick| {
            let commanded = Watched::hovering(&mut random);
            let mut delivered = commanded;
            delivered[2] *= left;
            Some((watched.pass(commanded, delivered, 0.0, Vector3::zeros())?, tick))
        });
        let (lost, ticks) = found.unwrap();
        assert!(lost.rotor == 2 && (lost.left - left).abs() < 0.1, "{lost:?} of {left}");
        assert!(ticks >= before, "{left}: {ticks} after {before}");
        before = ticks;
    }
    assert!(before > 10);
}

#[test]
fn a_wrong_mass_a_wrong_centre_of_mass_and_a_sagging_battery_are_no_failure() {
    let mut random = Random(3);
    for _ in 0..200 {
        let mut watched = Watched::new(0.005);
        let force = random.between(-1.0, 1.0);
        let offset = random.vector(0.01);
        let torque = Vector3::new(offset.y, -offset.x, 0.0) * WEIGHT;
        for tick in 0..600 {
            let commanded = Watched::hovering(&mut random);
            let sag = 1.0 - 0.2 * tick as f32 / 600.0;
            assert_eq!(watched.pass(commanded, commanded.map(|f| f * sag), force, torque), None);
        }
    }
}

#[test]
fn gusts_hits_and_the_ground_are_no_failure() {
    let mut random = Random(4);
    for _ in 0..2_000 {
        let mut watched = Watched::settled(&mut random, 0.005);
        // A gust pushes and hardly turns, a hit turns for a moment, the ground pushes upwards at a leg.
        let at = random.vector(0.2);
        let (force, ticks) = match random.below(3) {
            0 => (random.between(-3.0, 3.0), 60),
            1 => (random.between(-40.0, 40.0), 2),
            _ => (random.between(1.0, 20.0), 30),
        };
        let arm = if ticks == 60 { at * 0.05 } else { at };
        for _ in 0..ticks {
            let commanded = Watched::hovering(&mut random);
            let torque = Vector3::new(arm.y, -arm.x, 0.0) * force;
            assert_eq!(watched.pass(commanded, commanded, force, torque), None, "{force} N at {at}");
        }
    }
}

#[test]
fn a_lag_an_inertia_and_a_scale_that_are_wrong_are_no_failure_however_violent_the_commands() {
    let mut random = Random(5);
    for _ in 0..100 {
        let mut watched = Watched::new(0.005);
        let (scale, keeps) = (random.between(0.85, 1.15), random.between(0.0, 0.5));
        let (mut commanded, mut delivered) = ([0.25 * WEIGHT; 4], [0.25 * WEIGHT; 4]);
        for tick in 0..600 {
            if tick % 10 == 0 {
                commanded = [(); 4].map(|()| random.between(0.0, 6.0));
            }
            for (delivered, commanded) in delivered.iter_mut().zip(&commanded) {
                *delivered = keeps * *delivered + (1.0 - keeps) * commanded * scale;
            }
            assert_eq!(watched.pass(commanded, delivered, 0.0, Vector3::zeros()), None, "{scale}, {keeps}, {tick}");
        }
    }
}

#[test]
fn without_rotors_and_beyond_all_numbers_nothing_is_found() {
    let detector = Detector::new(&vehicle(), None, 0.0, PERIOD);
    let mut suspicion = Suspicion::NONE;
    let still = Vector3::zeros();
    for size in [1.0, 1e20, f32::MAX, f32::NAN] {
        let interval = Interval {
            acceleration: Vector3::repeat(size),
            angular_velocities: [&still, &still],
            axis: Vector3::z(),
            acted: Vector4::repeat(-size),
        };
        for _ in 0..100 {
            assert_eq!(detector.observe(&mut suspicion, &interval), None);
        }
        assert!(suspicion.residual.iter().all(|r| r.is_finite()));
    }
}

#[test]
fn what_a_speed_says_counts_where_the_motion_shows_a_part_of_it() {
    let mut random = Random(7);
    let said = |rotor| LostRotor { rotor, left: 0.0 };
    for rotor in 0..4 {
        let mut watched = Watched::settled(&mut random, 0.02);
        let mut agrees = |share: f32, which: usize| {
            let commanded = Watched::hovering(&mut random);
            let mut delivered = commanded;
            delivered[rotor] *= share;
            watched.pass(commanded, delivered, 0.0, Vector3::zeros());
            let interval = Interval {
                acceleration: Vector3::zeros(),
                angular_velocities: [&Vector3::zeros(), &Vector3::zeros()],
                axis: Vector3::z(),
                acted: Watched::sum(commanded),
            };
            watched.detector.agrees(&watched.suspicion, &interval, &said(which))
        };
        for which in 0..4 {
            assert!(!agrees(1.0, which));
        }
        // Too little is missing, and then enough, of one of them alone.
        assert!(!agrees(0.85, rotor));
        for which in [rotor, rotor ^ 1, (rotor + 2) % 4, rotor] {
            assert_eq!(agrees(0.4, which), which == rotor, "{rotor}, {which}");
        }
    }
}
