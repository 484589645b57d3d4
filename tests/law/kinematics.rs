//! Kinematic facts the law stands on: modified Rodrigues parameters describe the rotation they came from and move as
//! they should, and omega_d and omega_d' are what differentiating R_d along a flight gives.

use crate::support::body::Body;
use crate::support::oracle::lifting;
use crate::support::oracle::rounding::{ULP, vector4};
use crate::support::random;
use controller_core::controller::Controller;
use controller_core::heading::Heading;
use controller_core::mrp;
use controller_core::reference::Reference;
use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};
use rand::RngExt;

/// The greatest distance between entries.
fn apart(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    (a - b).amax()
}

/// Rotation entries are sums of at most six products below two, each with a rounding or two: 16 roundings at most. The
/// parameters of a unit quaternion in single precision carry two more, which R turns into eight.
const ENTRY_TOLERANCE: f64 = 24.0 * ULP;

#[test]
fn parameters_and_their_shadow_describe_the_rotation_they_came_from() {
    let mut rng = random::generator(60);
    for _ in 0..100_000 {
        let q = random::attitude(&mut rng);
        let expected = lifting::rotation(&vector4(&q));
        assert!(apart(&mrp::rotation(&q).cast(), &expected) < ENTRY_TOLERANCE, "R(q) at {q}");
        // Towards q_0 = -1 the denominator of phi loses what q_0 was rounded by: eps / (1 + q_0), relative.
        let theta = mrp::from_quaternion(&q);
        let room = ENTRY_TOLERANCE + 8.0 * ULP / f64::from(1.0 + q.w);
        assert!(apart(&mrp::to_rotation(&theta).cast(), &expected) < room, "R(phi(q)) at {q}");
        if theta.norm() > 1e-3 {
            let shadow = mrp::shadow(&theta);
            assert!(apart(&mrp::to_rotation(&shadow).cast(), &expected) < room, "R(Upsilon(phi(q))) at {q}");
            let other = lifting::mrp(&-vector4(&q));
            let relative = (shadow.cast::<f64>() - other).norm() / other.norm();
            assert!(relative < room + 8.0 * ULP / f64::from(1.0 - q.w), "Upsilon(phi(q)) is phi(-q) at {q}");
        }
    }
}

#[test]
fn the_shadow_of_the_shadow_is_the_parameter_and_unit_length_is_the_border() {
    let mut rng = random::generator(61);
    for _ in 0..100_000 {
        let theta = random::direction(&mut rng) * random::log_uniform(&mut rng, 1e-6, 1e6);
        let shadow = mrp::shadow(&theta);
        assert!((mrp::shadow(&shadow) - theta).norm() <= 8.0 * ULP as f32 * theta.norm());
        assert!((f64::from(shadow.norm()) * f64::from(theta.norm()) - 1.0).abs() <= 8.0 * ULP);
        assert!(shadow.dot(&theta) < 0.0);
    }
}

#[test]
fn parameters_move_as_their_kinematics_say() {
    let mut rng = random::generator(62);
    for _ in 0..20_000 {
        let q = vector4(&random::attitude(&mut rng)).normalize();
        // The lift with |theta| <= 1 and the shadow beyond it, up to |theta| = 20.
        if q[0] < -0.995 {
            continue;
        }
        let omega: Vector3<f64> = random::vector(&mut rng, 20.0).cast();
        // theta along R' = R [omega]x, by turning the rotation matrix and lifting it again on the same branch.
        let turned = |e: f64| {
            let turn = Rotation3::new(omega * e).into_inner();
            lifting::mrp(&lifting::nearest(&q, &(lifting::rotation(&q) * turn)))
        };
        // Second-order differences: truncation (omega e)^2 (1 + theta^2)^2 ~ 1e-7, relative to the derivative.
        let e = 1e-5;
        let numeric = (turned(e) - turned(-e)) / (2.0 * e);
        let theta = lifting::mrp(&q);
        let analytic = mrp::kinematics(&theta.cast()).cast::<f64>() * omega;
        let scale = (1.0 + theta.norm_squared()) * omega.norm();
        let error = (numeric - analytic).norm();
        assert!(error < 1e-6 * scale, "theta {theta}, omega {omega}: {error:e}");
    }
}

/// A swinging reference with a turning heading, exact in f64 and rounded once.
fn swinging_reference(t: f64) -> Reference {
    let (frequency, swing) = (0.8_f64, 1.5_f64);
    // d^n/dt^n cos(f t + phi) = f^n cos(f t + phi + n pi/2)
    let derivative = |n: i32| {
        let wave = |phase: f64| {
            let angle = frequency * t + phase + f64::from(n) * std::f64::consts::FRAC_PI_2;
            (frequency.powi(n) * angle.cos()) as f32
        };
        Vector3::new(wave(0.0), wave(-1.5), wave(0.7))
    };
    let psi = swing * (frequency * t).sin();
    let rate = swing * frequency * (frequency * t).cos();
    let acceleration = -swing * frequency * frequency * (frequency * t).sin();
    let nu = Vector2::new(psi.cos() as f32, psi.sin() as f32);
    Reference {
        position: derivative(0),
        velocity: derivative(1),
        acceleration: derivative(2),
        jerk: derivative(3),
        snap: derivative(4),
        heading: Heading::new(nu, rate as f32, acceleration as f32).unwrap(),
    }
}

/// What the core says about its attitude reference at one tick.
struct Sample {
    attitude: Matrix3<f64>,
    omega: Vector3<f64>,
    omega_dot: Vector3<f64>,
}

/// f'(0) from samples at ±1, ±2, ±3 spacings, to sixth order.
fn slope<T>(at: impl Fn(i32) -> T, spacing: f64) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let difference = |k: i32| at(k) - at(-k);
    (difference(1) * 45.0 + difference(2) * -9.0 + difference(3)) * (1.0 / (60.0 * spacing))
}

/// Flies recoveries at 10 kHz and differentiates what the core says along them, over samples 2 ms apart.
///
/// - R_d and u_f are rounded in single precision, in samples 2 ms apart and in steps 0.1 ms apart: 2^-24 / 2 ms times
///   the stencil's weights is 2e-4 rad/s for omega_d, some more in the worst of 400,000; omega_d, known to 1e-6 rad/s,
///   gives 1e-3 rad/s^2.
/// - omega_d' jumps at every tick, because the feedback is held between them, and the difference quotient sees the
///   middle: half of k_f k_s |ubar'| 0.1 ms / u_z. Here |ubar'| <= sqrt(3) (k_p 8 m/s + k_v 7 m/s^2) = 200 m/s^3 and
///   u_z >= 7 m/s^2, so 0.06 rad/s^2.
///
/// A wrong or missing term would be of the size of omega_d and omega_d' themselves.
#[test]
fn desired_rates_are_the_derivatives_of_the_desired_attitude_along_a_flight() {
    const TICK_S: f64 = 1e-4;
    const SPACING_TICKS: usize = 20;
    let vehicle = random::paper_vehicle();
    let mut rng = random::generator(63);
    let (mut worst_rate, mut worst_acceleration) = (0.0_f64, 0.0_f64);
    let (mut fastest, mut hardest) = (0.0_f64, 0.0_f64);
    for _ in 0..10 {
        let start = random::vector(&mut rng, 6.0).cast();
        let mut body = Body::resting(start, random::attitude(&mut rng).cast().normalize());
        let mut controller =
            Controller::uncertified(vehicle, random::paper_gains(&vehicle), None, TICK_S as f32).unwrap();
        let offset = rng.random_range(0.0..10.0);
        let samples: Vec<Sample> = (0..40_000)
            .map(|tick| {
                let reference = swinging_reference(offset + TICK_S * f64::from(tick));
                let (wrench, diagnostics) = controller.step(&body.state(), &reference).unwrap();
                body.advance(&vehicle, &wrench, TICK_S, 1);
                Sample {
                    attitude: lifting::rotation(&vector4(&diagnostics.desired_attitude)),
                    omega: diagnostics.desired_angular_velocity.cast(),
                    omega_dot: diagnostics.desired_angular_acceleration.cast(),
                }
            })
            .collect();
        for centre in 3 * SPACING_TICKS..samples.len() - 3 * SPACING_TICKS {
            let at = |k: i32| &samples[centre.strict_add_signed(k as isize * SPACING_TICKS as isize)];
            let spacing = TICK_S * SPACING_TICKS as f64;
            let spin = at(0).attitude.transpose() * slope(|k| at(k).attitude, spacing);
            let rate = 0.5
                * Vector3::new(spin[(2, 1)] - spin[(1, 2)], spin[(0, 2)] - spin[(2, 0)], spin[(1, 0)] - spin[(0, 1)]);
            let acceleration = slope(|k| at(k).omega, spacing);
            worst_rate = worst_rate.max((rate - at(0).omega).norm());
            worst_acceleration = worst_acceleration.max((acceleration - at(0).omega_dot).norm());
            fastest = fastest.max(at(0).omega.norm());
            hardest = hardest.max(at(0).omega_dot.norm());
        }
    }
    println!(
        "omega_d to {fastest:.2} rad/s, worst {worst_rate:.1e}; omega_d' to {hardest:.2} rad/s^2, worst {worst_acceleration:.1e}"
    );
    assert!(fastest > 0.5 && hardest > 5.0, "the flights are too gentle for this test");
    assert!(worst_rate < 5e-4, "omega_d is {worst_rate:e} rad/s off");
    assert!(worst_acceleration < 0.06, "omega_d' is {worst_acceleration:e} rad/s^2 off");
}
