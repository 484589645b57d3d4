//! What the extended law commands against what the certificate says it can, driven by an adversary that may do anything
//! but ask for a motion outside the bounds: it throws the vehicle about, spins it, pushes and turns it harder than any
//! level, lets the rotors deliver what it likes.
//!
//! No rotor may be commanded beyond its limits, not by one unit in the last place; no torque may be beyond its
//! bound. And the adversary has to come near the ends, or it would be no test of them: in the middle of every flight it
//! looks for the state that asks for the most. `cargo test -p host-sim extended_adversary -- --nocapture` prints
//! found / bound of every row.

use crate::certified_flights::Motion;
use crate::support::body::Body;
use crate::support::extended::{bounds, law, paper_vehicle, random_configuration, vehicle};
use crate::support::random::{self, ChaCha8Rng};
use controller_core::allocation::{MinimumNorm, Mixer};
use controller_core::certificate::certified::Certified;
use controller_core::certificate::extended::ExtendedBounds;
use controller_core::configuration::Configuration;
use controller_core::extended::controller::Controller;
use controller_core::extended::parameters::Extended;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use nalgebra::{Quaternion, Vector3};
use rand::RngExt;

/// Control period, s.
const PERIOD: f32 = 0.01;

/// Ticks of a flight, and how many of its states are searched for worse ones.
const TICKS: u32 = 300;
const SEARCHED: f64 = 0.02;

/// Flights on a vehicle.
const FLIGHTS: usize = 400;

/// The single-precision error of one evaluation, relative to a bound.
const EVALUATION_ERROR: f64 = 1e-5;

/// Steps of a search.
const FINEST_STEP: f64 = 1e-2;

/// What the adversary drives up.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Objective {
    Torque(usize),
    Greatest(usize),
    Least(usize),
}

/// What was found, shares of bounds; one is the bound.
#[derive(Debug, Clone, Default)]
struct Shown {
    /// |omega_d12|, |omega_d'12|, the thrust, the torques; the rotors' greatest and least thrust, 1 at the end of the
    /// range, 0 in its middle.
    motion: [f64; 3],
    torque: [f64; 3],
    rotors: [f64; 2],
    /// The least and the greatest thrust scale.
    scale: [f64; 2],
    /// How far c went across, and the thrust direction from the vertical, in shares of A_h and gamma.
    envelope: [f64; 2],
}

impl Shown {
    fn new() -> Self {
        Self { scale: [f64::INFINITY, 0.0], ..Self::default() }
    }

    fn join(&mut self, other: &Self) {
        for (mine, theirs) in [
            (&mut self.motion[..], &other.motion[..]),
            (&mut self.torque[..], &other.torque[..]),
            (&mut self.rotors[..], &other.rotors[..]),
            (&mut self.envelope[..], &other.envelope[..]),
        ] {
            mine.iter_mut().zip(theirs).for_each(|(mine, theirs)| *mine = mine.max(*theirs));
        }
        self.scale = [self.scale[0].min(other.scale[0]), self.scale[1].max(other.scale[1])];
    }
}

/// A certified configuration with what judges its commands.
struct World {
    certified: Certified,
    bounds: ExtendedBounds,
    parameters: Extended,
    allocation: Option<(MinimumNorm, Mixer)>,
}

impl World {
    fn new(configuration: Configuration) -> Option<Self> {
        let certified = Certified::new(configuration.clone()).ok()?;
        let allocation = configuration.rotors().map(|rotors| (MinimumNorm::new(rotors), Mixer::new(rotors)));
        Some(Self { bounds: bounds(&configuration), parameters: law(&configuration).parameters, certified, allocation })
    }

    fn configuration(&self) -> &Configuration {
        self.certified.configuration()
    }

    /// The rotors' commanded thrusts.
    fn thrusts(&self, wrench: &Wrench, scale: f32) -> Vec<f32> {
        let Some((flown, mixer)) = &self.allocation else { return Vec::new() };
        let commanded = wrench.scaled(1.0 / scale);
        let (ours, mixed) = (flown.allocate(&commanded).unwrap(), mixer.allocate(&commanded).unwrap());
        assert!(!ours.clipped && mixed.is_exact(), "a rotor is commanded beyond its limits: {wrench:?}, scale {scale}");
        for (thrust, rotor) in ours.thrusts.iter().zip(self.configuration().rotors().unwrap().iter()) {
            assert!(*thrust >= rotor.thrust_min && *thrust <= rotor.thrust_max);
        }
        ours.thrusts.to_vec()
    }

    /// Where a rotor's thrust is in its range: 1 at the upper end, -1 at the lower.
    fn places(&self, wrench: &Wrench, scale: f32) -> Vec<f64> {
        let thrusts = self.thrusts(wrench, scale);
        let ends = self.bounds.rotors.iter();
        thrusts
            .iter()
            .zip(ends)
            .map(|(f, end)| 2.0 * (f64::from(*f) - end.least) / (end.greatest - end.least) - 1.0)
            .collect()
    }

    /// One tick, judged.
    fn step(&self, controller: &mut Controller, state: &State, reference: &Reference, shown: &mut Shown) -> Wrench {
        let (wrench, diagnostics) = controller.step(state, reference).unwrap();
        let scale = controller.thrust_scale();
        let places = self.places(&wrench, scale);
        let of = |v: &Vector3<f32>| f64::from(v.xy().norm());
        let u = &diagnostics.acceleration_command;
        let tick = Shown {
            motion: [
                of(&diagnostics.desired_angular_velocity) / self.bounds.rates[0],
                of(&diagnostics.desired_angular_acceleration) / self.bounds.rates[1],
                f64::from(wrench.thrust) / self.bounds.thrust.greatest,
            ],
            torque: wrench.torque.cast::<f64>().abs().component_div(&self.bounds.torque).into(),
            rotors: [places.iter().copied().fold(0.0, f64::max), -places.iter().copied().fold(0.0, f64::min)],
            scale: [f64::from(scale); 2],
            envelope: [
                of(&diagnostics.filtered) / f64::from(self.parameters.a_across),
                of(u).atan2(u.z.into()) / f64::from(self.parameters.tilt_max),
            ],
        };
        let most = 1.0 + EVALUATION_ERROR;
        assert!(tick.torque.iter().chain(&tick.motion).all(|share| *share <= most), "{tick:?}: {wrench:?}");
        assert!(f64::from(wrench.thrust) >= self.bounds.thrust.least);
        // No proof says how far beyond its envelope c may go; it may not run away.
        assert!(tick.envelope[0] < 4.0 && tick.envelope[1] < 1.3, "{tick:?}");
        shown.join(&tick);
        wrench
    }

    fn value(&self, objective: Objective, wrench: &Wrench, scale: f32) -> f64 {
        match objective {
            Objective::Torque(axis) => f64::from(wrench.torque[axis].abs()) / self.bounds.torque[axis],
            Objective::Greatest(rotor) => self.places(wrench, scale)[rotor],
            Objective::Least(rotor) => -self.places(wrench, scale)[rotor],
        }
    }

    fn objective(&self, rng: &mut ChaCha8Rng) -> Objective {
        let rotors = self.bounds.rotors.len();
        match rng.random_range(0..if rotors > 0 { 5 } else { 3 }) {
            3 => Objective::Greatest(rng.random_range(0..rotors)),
            4 => Objective::Least(rng.random_range(0..rotors)),
            axis => Objective::Torque(axis),
        }
    }

    /// Looks for the state that asks for the most of something next, from what the law remembers now.
    fn search(
        &self,
        controller: &Controller,
        start: &State,
        reference: &Reference,
        rng: &mut ChaCha8Rng,
        shown: &mut Shown,
    ) {
        let objective = self.objective(rng);
        let mut value = |code: &[f64; 13]| {
            let mut controller = controller.clone();
            let wrench = self.step(&mut controller, &decoded(start, code), reference, shown);
            self.value(objective, &wrench, controller.thrust_scale())
        };
        let start = [(); 13].map(|()| rng.random_range(-1.0..1.0_f64));
        let (mut best, mut step) = ((value(&start), start), 0.5);
        while step > FINEST_STEP {
            let before = best.0;
            for place in 0..start.len() {
                for change in [step, -step] {
                    let mut code = best.1;
                    code[place] = (code[place] + change).clamp(-1.0, 1.0);
                    let found = value(&code);
                    if found > best.0 {
                        best = (found, code);
                        break;
                    }
                }
            }
            if best.0 <= before + 1e-4 {
                step *= 0.5;
            }
        }
    }

    fn fly(&self, rng: &mut ChaCha8Rng) -> Shown {
        let mut shown = Shown::new();
        let mut controller = Controller::new(&self.certified, PERIOD).unwrap();
        let motion = Motion::within(self.configuration().bounds(), rng);
        let start = motion.at(0.0);
        let mut body = Body::resting(start.position.cast(), random::attitude(rng).cast());
        let p = &self.parameters;
        let delivered = rng.random_range(0.7 * p.scale_least..1.3 * p.scale_greatest);
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for tick in 0..TICKS {
            let reference = motion.at(f64::from(PERIOD) * f64::from(tick));
            if rng.random_bool(0.03) {
                body.attitude = random::attitude(rng).cast();
                let fast = random::log_uniform(rng, 0.1, 60.0);
                body.angular_velocity = random::vector(rng, fast).cast();
                let (far, fast) = (random::log_uniform(rng, 0.01, 100.0), random::log_uniform(rng, 0.01, 20.0));
                body.position = (reference.position + random::vector(rng, far)).cast();
                body.velocity = (reference.velocity + random::vector(rng, fast)).cast();
            }
            if rng.random_bool(0.03) {
                force = random::vector(rng, 2.0 * p.force_across).cast::<f64>();
                torque = random::vector(rng, 3.0 * p.torque_tilt);
            }
            let state = body.state();
            if rng.random_bool(SEARCHED) {
                self.search(&controller, &state, &reference, rng, &mut shown);
            }
            let wrench = self.step(&mut controller, &state, &reference, &mut shown);
            let acting = Wrench { thrust: wrench.thrust * delivered, torque: wrench.torque * delivered + torque };
            body.advance(self.configuration().vehicle(), &acting, f64::from(PERIOD), 4);
            body.velocity += force * f64::from(PERIOD);
        }
        shown
    }
}

/// A state anywhere about `start`; the last coordinate says how far about.
fn decoded(start: &State, code: &[f64; 13]) -> State {
    let triple = |from: usize| Vector3::new(code[from], code[from + 1], code[from + 2]);
    let mrp = triple(0);
    let square = mrp.norm_squared();
    let about = Quaternion::from_parts(1.0 - square, mrp * 2.0) / (1.0 + square);
    let size = 30.0_f64.powf(code[12]);
    State {
        position: start.position + (triple(3) * size).cast(),
        velocity: start.velocity + (triple(6) * size).cast(),
        attitude: start.attitude * about.cast(),
        angular_velocity: start.angular_velocity + (triple(9) * size).cast(),
    }
}

/// Attacks one configuration with `flights`.
fn attack(world: &World, flights: usize, rng: &mut ChaCha8Rng) -> Shown {
    let mut shown = Shown::new();
    for _ in 0..flights {
        shown.join(&world.fly(rng));
    }
    shown
}

fn nearly_reached(name: &str, configuration: Configuration, seed: u64, share: f64) {
    let world = World::new(configuration).unwrap();
    let shown = attack(&world, FLIGHTS, &mut random::generator(seed));
    println!("{name}: found / bound {shown:.3?}");
    let rotors = if world.allocation.is_some() { &shown.rotors[..] } else { &[] };
    let weak: Vec<_> = shown.torque.iter().chain(rotors).filter(|found| **found < share).collect();
    assert!(weak.is_empty(), "{name}: too little found: {shown:?}");
}

#[test]
fn on_the_hummingbird_every_bound_stands_and_is_nearly_reached() {
    nearly_reached("hummingbird", vehicle("hummingbird").configuration, 201, 0.8);
}

#[test]
fn on_the_study_every_bound_stands_and_is_nearly_reached() {
    nearly_reached("study", vehicle("study").configuration, 202, 0.7);
}

#[test]
fn on_the_papers_vehicle_every_bound_stands_and_is_nearly_reached() {
    // Yaw: 0.77. Nothing is learnt from states that jump, so the search moves the torque estimate by torques alone.
    nearly_reached("paper", paper_vehicle().configuration, 203, 0.75);
}

#[test]
fn the_bounds_stand_with_random_configurations() {
    let mut rng = random::generator(204);
    let (mut shown, mut worlds, mut refused) = (Shown::new(), 0, 0);
    while worlds < 60 {
        match World::new(random_configuration(&mut rng)) {
            Some(world) => {
                worlds += 1;
                shown.join(&attack(&world, 10, &mut rng));
            }
            None => refused += 1,
        }
    }
    println!("60 certified, {refused} not; closest to the bounds: {shown:.3?}");
}
