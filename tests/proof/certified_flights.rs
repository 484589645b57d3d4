//! Certified configurations flown: not one sample of thrust, torque or rotor command beyond its bound. And the other
//! way round: configurations that the adversary beats do go beyond their limits, so this check can fail.

use crate::support::adversary_search::Domain;
use crate::support::adversary_search::configurations::{around_table_1, limited};
use crate::support::adversary_search::search::{Objective, Worst, worst};
use crate::support::body::Body;
use crate::support::random;
use crate::support::random::ChaCha8Rng;
use controller_core::allocation::{MinimumNorm, Mixer, QuadX, Rotors, Thrusts};
use controller_core::certificate::Certificate;
use controller_core::certificate::certified::Certified;
use controller_core::certificate::form::Form;
use controller_core::certificate::paper::PaperCertificate;
use controller_core::configuration::Configuration;
use controller_core::controller::Controller;
use controller_core::heading::Heading;
use controller_core::reference::{Reference, ReferenceBounds};
use controller_core::state::Wrench;
use nalgebra::{Vector2, Vector3};
use rand::RngExt;
use std::f64::consts::TAU;

/// How far the limits of a certified configuration are above its needs: next to nothing.
const LIMIT_MARGIN_SHARE: f64 = 1e-3;
const FLIGHT_S: f64 = 3.0;

/// A circle with a heave, flown with a turning or swinging heading, as hard as the bounds allow.
pub struct Motion {
    /// Radius of the circle and amplitude of the heave, m.
    amplitude: [f64; 2],
    /// Of circle and heave, rad/s.
    frequency: f64,
    /// psi = offset + rate t + swing sin(swing_frequency t).
    heading: [f64; 4],
}

impl Motion {
    pub fn within(bounds: &ReferenceBounds, rng: &mut ChaCha8Rng) -> Self {
        let w = f64::from(random::log_uniform(rng, 0.2, 4.0));
        let [horizontal, vertical, jerk, snap] =
            [bounds.horizontal_acceleration, bounds.vertical_acceleration, bounds.jerk, bounds.snap].map(f64::from);
        let acceleration = horizontal.hypot(vertical);
        let scale = if acceleration > 0.0 {
            (jerk / (w * acceleration)).min(snap / (w * w * acceleration)).min(1.0) * 0.9999
        } else {
            0.0
        };
        let [rate, second] = [bounds.heading_rate, bounds.heading_second_derivative].map(|b| f64::from(b) * 0.9999);
        let offset = rng.random_range(0.0..TAU);
        let heading = if rng.random_bool(0.5) {
            [offset, rate.min(second.sqrt()), 0.0, 1.0]
        } else {
            // |nu''|^2 = psi''^2 + psi'^4 <= (s f^2)^2 + (s f)^4.
            let f = f64::from(random::log_uniform(rng, 0.2, 4.0));
            let swing = (rate / f).min(second / f.powi(2).hypot(f * second.sqrt()));
            [offset, 0.0, swing, f]
        };
        Self { amplitude: [horizontal, vertical].map(|a| scale * a / (w * w)), frequency: w, heading }
    }

    pub fn at(&self, t: f64) -> Reference {
        let w = self.frequency;
        let derivative = |order: i32| {
            let phase = w * t + f64::from(order) * TAU / 4.0;
            let [radius, heave] = self.amplitude.map(|a| a * w.powi(order));
            Vector3::new(radius * phase.cos(), radius * phase.sin(), heave * phase.cos()).cast()
        };
        let [offset, rate, swing, f] = self.heading;
        let (sin, cos) = (offset + rate * t + swing * (f * t).sin()).sin_cos();
        let direction = Vector2::new(cos as f32, sin as f32);
        let (first, second) = (rate + swing * f * (f * t).cos(), -swing * f * f * (f * t).sin());
        Reference {
            position: derivative(0),
            velocity: derivative(1),
            acceleration: derivative(2),
            jerk: derivative(3),
            snap: derivative(4),
            heading: Heading::new(direction, first as f32, second as f32).unwrap(),
        }
    }
}

/// A random configuration whose limits are what the certificate asks for, and next to nothing more.
fn certified(rng: &mut ChaCha8Rng, spread: f32) -> Certified {
    loop {
        let limited = tightly_limited(rng, spread);
        if let Some(rotors) = fitting_rotors(&limited, rng) {
            return Certified::new(limited.with_rotors(rotors).unwrap()).unwrap();
        }
    }
}

fn tightly_limited(rng: &mut ChaCha8Rng, spread: f32) -> Configuration {
    let loose = around_table_1(rng, spread);
    let Form { torque, inequalities, .. } = Certificate::new(&loose).unwrap().paper().unwrap().sharp;
    let thrust_max =
        inequalities.iter().filter(|i| i.name.contains("thrust for") || i.name.contains("greatest thrust"));
    let thrust_max = thrust_max.map(|inequality| inequality.required).fold(0.0, f64::max);
    let (vehicle, gains, bounds) = (*loose.vehicle(), *loose.gains().unwrap(), *loose.bounds());
    let tight = limited(
        vehicle,
        gains,
        bounds,
        thrust_max * (1.0 + LIMIT_MARGIN_SHARE),
        &(torque * (1.0 + LIMIT_MARGIN_SHARE)),
    );
    if rng.random_bool(0.5) {
        let least = vehicle.mass * (vehicle.gravity - gains.m_p - bounds.vertical_acceleration);
        tight.with_thrust_floor(least * rng.random_range(0.05..0.99)).unwrap()
    } else {
        tight
    }
}

/// Four rotors whose ranges are what the certificate asks of them, and next to nothing more; none where the torque is
/// too great for the weight.
fn fitting_rotors(configuration: &Configuration, rng: &mut ChaCha8Rng) -> Option<Rotors> {
    // Where torque takes a rotor below zero, longer levers and more drag make the torque cheaper.
    let mut arm = random::log_uniform(rng, 0.05, 0.5);
    let mut drag = random::log_uniform(rng, 0.02, 0.2);
    let coefficient = 1e-5_f32;
    let quad = |arm: f32, drag: f32, [least, greatest]: [f64; 2]| {
        let [speed_min, speed_max] = [least, greatest].map(|thrust| (thrust / f64::from(coefficient)).sqrt() as f32);
        let drag_coefficient = drag * coefficient;
        Rotors::quad_x(QuadX { arm, thrust_coefficient: coefficient, drag_coefficient, speed_min, speed_max }).unwrap()
    };
    while arm < 10.0 {
        let unlimited = configuration.clone().with_rotors(quad(arm, drag, [0.0, 1e5])).unwrap();
        let demands = Certificate::new(&unlimited).unwrap().paper().unwrap().rotors.clone();
        let least = demands.iter().map(|report| report.demand.min).fold(f64::INFINITY, f64::min);
        let greatest = demands.iter().map(|report| report.demand.max).fold(0.0, f64::max);
        if least > 0.0 {
            return Some(quad(arm, drag, [least * (1.0 - LIMIT_MARGIN_SHARE), greatest * (1.0 + LIMIT_MARGIN_SHARE)]));
        }
        (arm, drag) = (2.5 * arm, 2.5 * drag);
    }
    None
}

/// Flies and hands every wrench to `watch`.
fn fly(
    configuration: &Configuration,
    mut controller: Controller,
    mut body: Body,
    reference: impl Fn(f64) -> Reference,
    period: f64,
    mut watch: impl FnMut(&Wrench),
) {
    let steps = (period / 1e-3).ceil() as usize;
    for tick in 0..(FLIGHT_S / period) as u32 {
        let (wrench, _) = controller.step(&body.state(), &reference(period * f64::from(tick))).unwrap();
        watch(&wrench);
        body.advance(configuration.vehicle(), &wrench, period, steps);
    }
}

/// Anywhere within a few or a few hundred metres, at any attitude, tumbling.
fn anywhere(rng: &mut ChaCha8Rng) -> Body {
    let (far, fast) = (random::log_uniform(rng, 0.1, 300.0), random::log_uniform(rng, 0.1, 30.0));
    Body {
        velocity: random::vector(rng, fast).cast(),
        angular_velocity: random::vector(rng, 20.0).cast(),
        ..Body::resting(random::vector(rng, far).cast(), random::attitude(rng).cast())
    }
}

/// The adversary's worst state for one torque axis, and a controller and a body in it.
fn in_the_worst_state(configuration: &Configuration, found: &Worst, period: f64) -> (Controller, Body) {
    let (memory, state) = found.situation.start(configuration);
    let (vehicle, gains, floor) =
        (*configuration.vehicle(), *configuration.gains().unwrap(), configuration.thrust_floor());
    let mut controller = Controller::uncertified(vehicle, gains, floor, period as f32).unwrap();
    controller.restore(memory);
    let body = Body {
        velocity: state.velocity.cast(),
        angular_velocity: state.angular_velocity.cast(),
        ..Body::resting(state.position.cast(), state.attitude.cast())
    };
    (controller, body)
}

/// The greatest share of its bounds that a flight uses; more than one is beyond.
#[derive(Debug, Clone, Copy, Default)]
struct Usage {
    thrust: f64,
    torque: Vector3<f64>,
    rotor: f64,
}

impl Usage {
    fn watch(&mut self, wrench: &Wrench, certified: &Certified) {
        let PaperCertificate { sharp, rotors, .. } = certified.certificate().paper().unwrap();
        let thrust = f64::from(wrench.thrust);
        self.thrust = self.thrust.max(thrust / sharp.thrust.max).max(sharp.thrust.min / thrust);
        self.torque = self.torque.sup(&wrench.torque.cast::<f64>().abs().component_div(&sharp.torque));

        // What flies never clips, and so is what the mixer does with all its priorities.
        let rotors_flown = certified.configuration().rotors().unwrap();
        let allocation = MinimumNorm::new(rotors_flown).allocate(wrench).unwrap();
        assert!(!allocation.clipped, "{allocation:?}");
        let mixed = Mixer::new(rotors_flown).allocate(wrench).unwrap();
        assert!(mixed.is_exact(), "{mixed:?}");
        let bits = |thrusts: &Thrusts| thrusts.iter().map(|thrust| thrust.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&allocation.thrusts), bits(&mixed.thrusts));
        for (thrust, report) in allocation.thrusts.iter().zip(rotors) {
            let thrust = f64::from(*thrust);
            self.rotor = self.rotor.max(thrust / report.demand.max).max(report.demand.min / thrust);
        }
    }

    fn sup(&self, other: &Self) -> Self {
        let (thrust, rotor) = (self.thrust.max(other.thrust), self.rotor.max(other.rotor));
        Self { thrust, torque: self.torque.sup(&other.torque), rotor }
    }

    fn greatest(&self) -> f64 {
        self.thrust.max(self.torque.max()).max(self.rotor)
    }
}

#[test]
fn two_hundred_certified_configurations_never_leave_their_bounds() {
    let mut rng = random::generator(50);
    let mut closest = Usage::default();
    for number in 0..200 {
        let certified = certified(&mut rng, if number % 2 == 0 { 2.0 } else { 6.0 });
        let configuration = certified.configuration();
        let period = f64::from(random::log_uniform(&mut rng, 1e-3, 2e-2));
        let motion = Motion::within(configuration.bounds(), &mut rng);
        assert!((0..100).all(|i| configuration.bounds().contain(&motion.at(0.07 * f64::from(i)), 1e-5)));

        let mut usage = Usage::default();
        for _ in 0..2 {
            let controller = Controller::new(&certified, period as f32).unwrap();
            fly(
                configuration,
                controller,
                anywhere(&mut rng),
                |t| motion.at(t),
                period,
                |wrench| {
                    usage.watch(wrench, &certified);
                },
            );
        }
        // Reachable states that random starts hardly ever come by: the adversary's, filters and path memory included.
        let found = worst(configuration, Domain::Reachable, Objective::Torque(number % 3), 2, &mut rng);
        let (controller, body) = in_the_worst_state(configuration, &found, period);
        let reference = found.situation.reference;
        fly(configuration, controller, body, |_| reference, period, |wrench| usage.watch(wrench, &certified));

        assert!(usage.greatest() <= 1.0, "configuration {number}: {usage:?} of {:?}", certified.certificate());
        closest = closest.sup(&usage);
    }
    println!("closest to the bounds: {closest:?}");
}

#[test]
fn configurations_that_the_adversary_beats_do_leave_their_limits() {
    let mut rng = random::generator(51);
    let mut left = 0;
    for number in 0..200 {
        let axis = number % 3;
        let loose = around_table_1(&mut rng, 4.0);
        let found = worst(&loose, Domain::Reachable, Objective::Torque(axis), 3, &mut rng);
        let mut torque_max =
            Certificate::new(&loose).unwrap().paper().unwrap().sharp.torque * (1.0 + LIMIT_MARGIN_SHARE);
        torque_max[axis] = found.value * f64::from(rng.random_range(0.8..0.99_f32));
        let (vehicle, gains, bounds) = (*loose.vehicle(), *loose.gains().unwrap(), *loose.bounds());
        let configuration = limited(vehicle, gains, bounds, f64::from(loose.limits().thrust_max), &torque_max);
        assert!(Certified::new(configuration.clone()).is_err(), "certified, though the adversary has a counterexample");

        let period = 0.01;
        let (controller, body) = in_the_worst_state(&configuration, &found, period);
        let reference = found.situation.reference;
        let mut beyond = false;
        fly(
            &configuration,
            controller,
            body,
            |_| reference,
            period,
            |wrench| {
                beyond |= f64::from(wrench.torque[axis].abs()) > torque_max[axis];
            },
        );
        left += usize::from(beyond);
    }
    println!("{left} of 200 left their limits");
    assert!(left >= 100, "only {left} of 200");
}
