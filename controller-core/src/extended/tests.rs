//! The extended law's parts, one by one. Its step as a whole is in `controller/tests.rs`; flights, flows and the independent
//! transcription are in `tests/`.

extern crate std;
use super::actuators::ActuatorParameters;
use super::attitude::AttitudeLaw;
use super::controller::Controller;
use super::example;
use super::force::{ForceEstimate, ForceGenerator, ForceObserver};
use super::heading::{self, HeadingLag, advanced, turning};
use super::parameters::{AttitudeParameters, EstimateParameters, Extended, ExtendedParameters, HeadingParameters};
use super::saturation::Saturation;
use super::thrust_floor::ThrustFloor;
use super::thrust_scale::ThrustScale;
use super::torque_bias::TorqueBias;
use crate::attitude_reference::AngularMotion;
use crate::certificate::configuration::ExtendedLaw;
use crate::error::{ParameterError, Reason};
use nalgebra::{Quaternion, Vector2, Vector3};

/// Xorshift, for tests that repeat to the bit.
pub(super) struct Random(pub u64);

impl Random {
    pub fn signed(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / 8_388_608.0 - 1.0
    }

    pub fn vector(&mut self, size: f32) -> Vector3<f32> {
        Vector3::new(self.signed(), self.signed(), self.signed()) * size
    }

    pub fn attitude(&mut self) -> Quaternion<f32> {
        let q = Quaternion::new(self.signed(), self.signed(), self.signed(), self.signed());
        q / q.norm()
    }
}

#[test]
fn a_saturation_is_monotone_shorter_than_its_level_and_never_steeper_than_its_gain() {
    let mut random = Random(1);
    for _ in 0..100_000 {
        let (a, b) = (random.vector(9.0).xy(), random.vector(9.0).xy());
        let saturation = Saturation::new(1.5, 2.0);
        let (s, t) = (a * saturation.factor(a.norm_squared()), b * saturation.factor(b.norm_squared()));
        assert!(
            (s - t).dot(&(a - b)) >= 0.0 && s.norm() < 2.0 && (s - t).norm() <= 1.5 * (a - b).norm() * (1.0 + 1e-5)
        );
    }
}

#[test]
fn the_force_estimate_keeps_its_bounds_whatever_it_observes_and_arrives_at_what_stays() {
    let parameters = EstimateParameters { force_bandwidth_across: 12.0, ..example::PARAMETERS.estimates };
    let generator = ForceGenerator::new(&parameters, 0.01).unwrap();
    let observer = ForceObserver::new(&parameters, 9.81, 0.01);
    let mut random = Random(2);
    let (mut estimate, mut nearest) = (ForceEstimate::NONE, [0.0_f32; 3]);
    let levels = [parameters.force_across, parameters.force_vertical];
    let bandwidths = [parameters.force_bandwidth_across, parameters.force_bandwidth_vertical];
    let snaps = [parameters.force_snap_across, parameters.force_snap_vertical];
    for tick in 0..400_000 {
        // Reversals with every rhythm, jumps, noise.
        let size = 10.0_f32.powf(random.signed() * 1.5 + 0.5);
        let beat = 1 + (tick / 5_000) % 60;
        let side = if tick / beat % 2 == 0 { 1.0 } else { -1.0 };
        let force = if tick / 20_000 % 2 == 0 { Vector3::repeat(side * 50.0) } else { random.vector(size) };
        estimate = observer.averaged(&estimate, &force);
        let acceleration = generator.acceleration(&estimate);
        estimate = generator.advanced(&estimate, &acceleration);
        for (axis, kind) in [(0, 0), (1, 0), (2, 1)] {
            let shares = [
                estimate.value[axis].abs() / levels[kind],
                estimate.rate[axis].abs() * bandwidths[kind] / snaps[kind],
                acceleration[axis].abs() / snaps[kind],
            ];
            assert!(shares.iter().all(|share| *share <= 1.0 + 1e-5), "{shares:?} on axis {axis} at {tick}");
            nearest.iter_mut().zip(shares).for_each(|(nearest, share)| *nearest = nearest.max(share));
        }
    }
    assert!(nearest.iter().all(|share| *share > 0.99), "{nearest:?}");
    let steady = Vector3::new(1.0, -0.7, 0.3);
    for _ in 0..1_000 {
        estimate = observer.averaged(&estimate, &steady);
        estimate = generator.advanced(&estimate, &generator.acceleration(&estimate));
    }
    assert!((estimate.value - steady).norm() < 1e-5 && estimate.rate.norm() < 1e-5, "{estimate:?}");
}

#[test]
fn a_vehicle_that_does_as_commanded_shows_no_force() {
    let observer = ForceObserver::new(&example::PARAMETERS.estimates, 9.81, 0.01);
    let axis = Vector3::new(0.6, 0.0, 0.8);
    let drag = example::PARAMETERS.estimates.drag_across;
    let (start, thrust) = (Vector3::new(2.0, -1.0, 0.5), 15.0);
    let acceleration = axis * thrust - Vector3::new(0.0, 0.0, 9.81) - Vector3::new(drag * start.x, drag * start.y, 0.0);
    let end = start + acceleration * 0.01;
    let force = observer.observed([&start, &end], &(axis * thrust));
    assert!(force.norm() < 0.03, "{force}");
}

#[test]
fn the_heading_catches_up_and_never_turns_faster_than_it_may() {
    let parameters = example::PARAMETERS.heading;
    for start in [0.1_f32, 1.0, 2.0, 3.0, -3.1] {
        let (sin, cos) = (0.5 * start).sin_cos();
        let mut lag = HeadingLag { half_angle: Vector2::new(cos, sin), rate: 0.0 };
        for tick in 0..1_000 {
            let psi = 0.01 * tick as f32;
            let motion = AngularMotion {
                velocity: Vector3::new(0.3, -0.2, 0.8 * psi.sin()),
                acceleration: Vector3::new(1.0, 2.0, 0.8 * psi.cos()),
            };
            let desired = turning(&lag, &motion, &parameters, 0.01);
            assert!(desired.acceleration.z.abs() <= parameters.acceleration * (1.0 + 1e-5));
            assert!(desired.velocity.z.abs() <= parameters.rate * (1.0 + 1e-5));
            assert!((desired.velocity.xy().norm() - motion.velocity.xy().norm()).abs() < 1e-6);
            lag = advanced(&lag, &desired, 0.01);
        }
        assert!(lag.half_angle.y.abs() < 2e-3, "from {start}: {lag:?}");
    }
}

/// V less its kinetic part, in double precision, at a unit quaternion.
fn potential_energy(p: &AttitudeParameters, q: &Quaternion<f64>) -> f64 {
    let [w, eta, k_t, m_t, eta_t] = [p.w, p.eta, p.k_t, p.m_t, p.eta_t].map(f64::from);
    let h = ((q.w + eta).powi(2) + q.k * q.k).sqrt();
    let r_squared = q.i * q.i + q.j * q.j;
    // dU/d(r^2) = G, by Simpson's rule.
    let g = |s: f64| m_t * k_t / ((m_t * m_t + k_t * k_t * s) * (1.0 - s + eta_t * eta_t)).sqrt();
    let steps = 400;
    let width = r_squared / f64::from(steps);
    let sum: f64 = (0..steps)
        .map(|i| {
            let left = width * f64::from(i);
            (g(left) + 4.0 * g(left + 0.5 * width) + g(left + width)) * width / 6.0
        })
        .sum();
    w * (1.0 + eta - h) + sum
}

#[test]
fn the_torque_is_the_slope_of_its_potential() {
    let p = example::PARAMETERS.attitude;
    let law = AttitudeLaw::new(&p, &example::vehicle().inertia);
    let (mut random, still) = (Random(3), Vector3::zeros());
    for _ in 0..2_000 {
        let q = random.attitude();
        let q = if q.w < 0.0 { -q } else { q };
        let torque = law.torque(&q, &still, &still, &still).potential;
        let double = Quaternion::new(f64::from(q.w), f64::from(q.i), f64::from(q.j), f64::from(q.k));
        let step = 1e-5;
        for axis in 0..3 {
            let mut turn = Vector3::zeros();
            turn[axis] = 1.0;
            let energy = |angle: f64| {
                let turned = double * Quaternion::from_parts((0.5 * angle).cos(), turn * (0.5 * angle).sin());
                potential_energy(&p, &turned)
            };
            let slope = (energy(step) - energy(-step)) / (2.0 * step);
            assert!((f64::from(torque[axis]) - slope).abs() < 2e-6, "{q:?} axis {axis}: {torque} and {slope}");
        }
    }
}

#[test]
fn tilt_and_yaw_keep_to_levels_of_their_own() {
    let p = AttitudeParameters { ease: 0.5, ..example::PARAMETERS.attitude };
    let law = AttitudeLaw::new(&p, &example::vehicle().inertia);
    let (mut random, still, mut nearest) = (Random(4), Vector3::zeros(), 0.0_f32);
    for _ in 0..100_000 {
        let q = random.attitude();
        let q = if q.w < -0.0198 { -q } else { q };
        let parts = law.torque(&q, &random.vector(40.0), &still, &still);
        let r = (q.i * q.i + q.j * q.j).sqrt();
        let g = p.m_t * p.k_t / ((p.m_t.powi(2) + (p.k_t * r).powi(2)) * (1.0 - r * r + p.eta_t.powi(2))).sqrt();
        let tilt = 0.5 * p.w * r + g * r * (1.0 - r * r).max(0.0).sqrt();
        assert!(parts.potential.xy().norm() <= tilt * (1.0 + 1e-4) + 1e-6);
        assert!(parts.potential.z.abs() <= 0.5 * p.w * p.eta * (1.0 + 1e-5));
        assert!(parts.damping.xy().norm() <= p.m_omega_t && parts.damping.z.abs() <= p.m_omega_z);
        nearest = nearest.max(parts.potential.z.abs() / (0.5 * p.w * p.eta));
    }
    assert!(nearest > 0.95, "{nearest}");
}

#[test]
fn across_the_switch_the_potential_falls() {
    let p = example::PARAMETERS.attitude;
    let [w, eta, delta] = [p.w, p.eta, p.delta].map(f64::from);
    let square = (1.0 + delta).powi(2);
    let qbar = (square - 1.0) / (square + 1.0);
    let least = 2.0 * w * eta * qbar / (1.0 + 2.0 * eta * qbar + eta * eta).sqrt();
    let mut random = Random(5);
    for _ in 0..1_000 {
        let v = random.vector(1.0).map(f64::from).normalize() * (1.0 - qbar * qbar).sqrt();
        let before = Quaternion::from_parts(-qbar, v);
        let fall = potential_energy(&p, &before) - potential_energy(&p, &-before);
        assert!(fall >= least * (1.0 - 1e-6), "{fall} {least}");
    }
}

#[test]
fn a_bias_is_believed_up_to_its_level() {
    let parameters = example::PARAMETERS.estimates;
    let bias = TorqueBias::new(&parameters, &example::vehicle().inertia, 0.01);
    let mut average = Vector3::zeros();
    let torque = Vector3::new(0.5 * parameters.torque_tilt, -9.0, 2.0 * parameters.torque_yaw);
    for _ in 0..2_000 {
        average = bias.averaged(&average, &torque);
    }
    let expected = Vector3::new(torque.x, -parameters.torque_tilt, parameters.torque_yaw);
    assert!((bias.estimate(&average) - expected).norm() < 1e-6);
}

#[test]
fn the_scale_is_learnt_from_the_vertical_and_stays_within_its_limits() {
    let scale = ThrustScale::new(&example::PARAMETERS.estimates, 0.01);
    for truth in [0.8_f32, 1.0, 1.2, 3.0] {
        let mut learnt = 1.0;
        for _ in 0..5_000 {
            learnt = scale.learnt(learnt, 10.0, 9.0, truth * 9.0);
        }
        let EstimateParameters { scale_least, scale_greatest, .. } = example::PARAMETERS.estimates;
        let allowed = truth.clamp(scale_least, scale_greatest);
        assert!((learnt - allowed).abs() < 1e-4, "{truth}: {learnt}");
    }
    // Of little thrust it learns slowly.
    let step = scale.learnt(1.0, 2.0, 2.0, 3.0) - 1.0;
    assert!((step - 0.3 * 0.01 * 2.0 / (4.0 + 4.0)).abs() < 1e-6, "{step}");
    // Of whatever it is told no faster than 0.2 a second.
    for lift in [1e4, -1e4] {
        assert!((scale.learnt(1.0, 10.0, 9.0, lift) - 1.0).abs() - 0.002 < 1e-6, "{lift} m/s^2");
    }
    // Lying on its side it learns nothing.
    assert_eq!(scale.learnt(1.1, 10.0, 0.0, 5.0), 1.1);
}

#[test]
fn at_the_floor_one_rotor_is_at_its_least_thrust_and_none_below() {
    let rotors = example::rotors();
    let floor = ThrustFloor::new(Some(&rotors), 0.0);
    let mut random = Random(6);
    for _ in 0..10_000 {
        let torque = random.vector(0.5);
        let thrust = f64::from(floor.least(&torque, 1.3));
        let of_rotor = |row: &nalgebra::Vector4<f64>| {
            row.x * thrust + row.y * f64::from(torque.x) + row.z * f64::from(torque.y) + row.w * f64::from(torque.z)
        };
        let above = rotors
            .iter()
            .zip(rotors.pseudo_inverse())
            .map(|(rotor, row)| of_rotor(row) - 1.3 * f64::from(rotor.thrust_min));
        let least = above.fold(f64::INFINITY, f64::min);
        assert!(least.abs() < 2e-6, "{torque}: {least}");
    }
}

#[test]
fn the_bound_on_the_floor_changes_no_thrust() {
    let floor = ThrustFloor::new(Some(&example::rotors()), 0.05);
    let (mut random, mut raised) = (Random(8), 0);
    for _ in 0..100_000 {
        let (torque, scale) = (random.vector(0.5), 1.0 + 0.3 * random.signed());
        let least = floor.least(&torque, scale);
        // Just below the floor, at it, just above it, and anywhere up to where the bound may be.
        for thrust in [least.next_down(), least, least.next_up(), least * (1.0 + 2.0 * random.signed().abs())] {
            let found = floor.raised(thrust, &torque, scale);
            assert_eq!(found, thrust.max(least), "{thrust} at {torque}, scale {scale}");
            raised += u32::from(found > thrust);
        }
    }
    assert_eq!(raised, 100_000);
    assert!(floor.raised(f32::NAN, &Vector3::zeros(), 1.0).is_nan());
}

#[test]
fn ticks_too_long_for_the_generator_of_the_heading_are_refused_by_name() {
    let refused = |c_1: f32, c_2: f32| {
        let heading = HeadingParameters { c_1, c_2, ..example::PARAMETERS.heading };
        heading::check(&heading, 0.01).map_err(|error| error.field)
    };
    assert_eq!(refused(9.0, 6.0), Ok(()));
    assert_eq!(refused(30.0, 0.15), Err("gains.c_1"));
    assert_eq!(refused(900.0, 6.0), Err("gains.c_1"));
    assert_eq!(refused(9.0, 250.0), Err("gains.c_2"));
    // All that are let through die out: the greatest root of their polynomial is inside the unit circle.
    for c_2 in [0.1_f32, 1.0, 10.0, 100.0] {
        for share in [0.001, 0.1, 1.0] {
            let c_1 = share * 0.5 * c_2 / 0.01;
            assert_eq!(refused(c_1, c_2), Ok(()));
            let (half, product) = (f64::from(1.0 - 0.005 * c_2), f64::from(1.0 - 0.01 * c_2 + 1e-4 * c_1));
            let square = half * half - product;
            let greatest = if square > 0.0 { half.abs() + square.sqrt() } else { product.sqrt() };
            assert!(greatest < 1.0, "{c_1} {c_2}: {greatest}");
        }
    }
    let heading = HeadingParameters { c_1: 30.0, c_2: 0.15, ..example::PARAMETERS.heading };
    let parameters = Extended::new(ExtendedParameters { heading, ..example::PARAMETERS }, &example::vehicle()).unwrap();
    let law = ExtendedLaw { parameters, actuators: ActuatorParameters { lag: 0.0, delay: 0.0 } };
    assert_eq!(Controller::build(&example::vehicle(), &law, None, 0.01).unwrap_err().field, "gains.c_1");
}

#[test]
fn a_lag_longer_than_anything_is_held_for_as_long_as_can_be_counted() {
    assert_eq!(ActuatorParameters { lag: 1e9, delay: 0.0 }.settling(0.1), u32::MAX);
}

#[test]
fn constants_out_of_their_range_are_refused_by_name() {
    let vehicle = example::vehicle();
    let refused = |change: &dyn Fn(&mut ExtendedParameters)| -> ParameterError {
        let mut parameters = example::PARAMETERS;
        change(&mut parameters);
        Extended::new(parameters, &vehicle).unwrap_err()
    };
    assert_eq!(refused(&|p| p.position.k_f_across = 0.1).field, "gains.k_f_across");
    assert_eq!(refused(&|p| p.position.k_s_vertical = 100.1).field, "gains.k_s_vertical");
    assert_eq!(refused(&|p| p.position.v_up = -1.0).reason, Reason::NotPositive);
    assert_eq!(refused(&|p| p.position.m_down = 9.5).field, "gains.m_down");
    assert_eq!(refused(&|p| p.attitude.m_t = 1e-30).field, "gains.m_t");
    assert_eq!(refused(&|p| p.attitude.eta_t = 1e-30).field, "gains.eta_t");
    assert_eq!(refused(&|p| p.attitude.delta = 1.5).field, "gains.delta");
    assert_eq!(refused(&|p| p.attitude.alpha = 1.0).field, "gains.alpha");
    // What has two ends says which of them it is beyond.
    let beyond = |field, reason| ParameterError { field, reason };
    assert_eq!(refused(&|p| p.attitude.ease = 1.0), beyond("gains.ease", Reason::NotBelow(1.0)));
    assert_eq!(refused(&|p| p.attitude.ease = -0.1), beyond("gains.ease", Reason::Negative));
    let (least, greatest) = ("estimates.scale_least", "estimates.scale_greatest");
    assert_eq!(refused(&|p| p.estimates.scale_least = 1.1), beyond(least, Reason::Above(1.0)));
    assert_eq!(refused(&|p| p.estimates.scale_least = 0.05), beyond(least, Reason::NotAbove(0.1)));
    assert_eq!(refused(&|p| p.estimates.scale_greatest = 0.99), beyond(greatest, Reason::Below(1.0)));
    assert_eq!(refused(&|p| p.estimates.scale_greatest = 10.0), beyond(greatest, Reason::NotBelow(10.0)));
    assert_eq!(refused(&|p| p.estimates.force_across = f32::NAN).field, "estimates.force_across");
    assert_eq!(refused(&|p| p.floor_margin = 0.0).field, "gains.floor_margin");
    // Below it the rounding of a rotor's thrust would show.
    assert_eq!(refused(&|p| p.floor_margin = 2e-7).field, "gains.floor_margin");
}
