//! The extremes of each rotor's thrust against sampling and searching the set of commands.

use controller_core::allocation::{Commands, Mixer, QuadX, RotorDemand, Rotors, Shape, TorqueTerm, demands};
use controller_core::state::Wrench;
use nalgebra::{Vector3, Vector4};

/// A fixed sequence of numbers in [-1, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.next(), self.next(), self.next())
    }
}

const INERTIA: [f64; 3] = [3.65e-3, 3.68e-3, 7.03e-3];

/// RotorPy's Hummingbird.
fn hummingbird(speed_min: f32) -> Rotors {
    let quad =
        QuadX { arm: 0.17, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min, speed_max: 1500.0 };
    Rotors::quad_x(quad).unwrap()
}

/// Shapes of every kind, of the size the law's terms have. The inertia's differences are exaggerated.
fn shapes() -> Vec<Shape> {
    vec![
        Shape::Ball { radius: 0.1 },
        Shape::Ball { radius: 0.04 },
        Shape::Ellipsoid { semi_axes: Vector3::from(INERTIA) * 20.0 },
        Shape::Box { half_widths: Vector3::new(0.01, 0.02, 0.03) },
        Shape::Gyroscopic { inertia: Vector3::new(3e-3, 5e-3, 9e-3), rate: 3.0 },
    ]
}

fn terms() -> Vec<TorqueTerm> {
    let names = ["attitude feedback", "rate feedback", "angular acceleration", "drag", "gyroscopic"];
    names.into_iter().zip(shapes()).map(|(name, shape)| TorqueTerm::new(name, shape).unwrap()).collect()
}

/// The torque of a shape at a point of the cube [-1, 1]^3, and the point moved to where the shape knows it.
fn torque(shape: &Shape, point: &Vector3<f64>) -> Vector3<f64> {
    let round = point / point.norm().max(1.0);
    match shape {
        Shape::Ball { radius } => round * *radius,
        Shape::Ellipsoid { semi_axes } => round.component_mul(semi_axes),
        Shape::Box { half_widths } => point.component_mul(half_widths),
        Shape::Gyroscopic { inertia, rate } => {
            let omega = round * *rate;
            omega.cross(&inertia.component_mul(&omega))
        }
    }
}

/// High enough for every command to fit the rotors.
const THRUST: (f64, f64) = (16.0, 24.0);

fn command(thrust: f64, points: &[Vector3<f64>]) -> Vector4<f64> {
    let tau: Vector3<f64> = shapes().iter().zip(points).map(|(shape, point)| torque(shape, point)).sum();
    Vector4::new(0.5 * (THRUST.0 + THRUST.1) + 0.5 * (THRUST.1 - THRUST.0) * thrust, tau.x, tau.y, tau.z)
}

fn all_demands(rotors: &Rotors) -> Vec<RotorDemand> {
    let terms = terms();
    demands(rotors, &Commands::new(THRUST.0, THRUST.1, &terms).unwrap()).iter().copied().collect()
}

#[test]
fn no_command_in_the_set_exceeds_or_saturates_a_rotor() {
    let rotors = hummingbird(0.0);
    let (demands, mixer, mut random) = (all_demands(&rotors), Mixer::new(&rotors), Random(1));
    assert!(demands.iter().all(RotorDemand::fits), "{demands:?}");
    for _ in 0..200_000 {
        let points: Vec<_> = (0..5).map(|_| random.vector().map(|x| x.signum() * x.abs().sqrt())).collect();
        let command = command(random.next(), &points);
        for (row, demand) in rotors.pseudo_inverse().iter().zip(&demands) {
            let thrust = row.dot(&command);
            assert!(thrust <= demand.max && thrust >= demand.min, "{thrust} {demand:?}");
        }
        let single = command.map(|x| x as f32);
        let wrench = Wrench { thrust: single.x, torque: Vector3::new(single.y, single.z, single.w) };
        assert!(mixer.allocate(&wrench).unwrap().is_exact());
    }
}

#[test]
fn a_search_comes_within_a_hundredth_of_every_extreme() {
    let rotors = hummingbird(0.0);
    let mut random = Random(2);
    for (row, demand) in rotors.pseudo_inverse().iter().zip(all_demands(&rotors)) {
        let half = 0.5 * (demand.max - demand.min);
        for (sign, bound) in [(1.0, demand.max), (-1.0, demand.min)] {
            let value = |thrust: f64, points: &[Vector3<f64>]| sign * row.dot(&command(thrust, points));
            let mut best = f64::NEG_INFINITY;
            for _ in 0..10 {
                let (mut thrust, mut points) = (random.next(), [(); 5].map(|()| random.vector()));
                for step in 0..4000 {
                    let scale = 1.0 - f64::from(step) / 4000.0;
                    let other_thrust = (thrust + scale * random.next()).clamp(-1.0, 1.0);
                    let other = points.map(|p| (p + random.vector() * scale).map(|x| x.clamp(-1.0, 1.0)));
                    if value(other_thrust, &other) > value(thrust, &points) {
                        (thrust, points) = (other_thrust, other);
                    }
                }
                best = best.max(value(thrust, &points));
            }
            assert!(best <= sign * bound && best > sign * bound - 0.01 * half, "{best} {bound} {half}");
        }
    }
}

#[test]
fn each_support_function_is_attained_and_never_exceeded() {
    let mut random = Random(3);
    for (term, shape) in terms().iter().zip(shapes()) {
        for _ in 0..50 {
            let direction = random.vector();
            let bound = term.support(&direction);
            let mut best = 0.0_f64;
            for _ in 0..20_000 {
                let point = random.vector();
                // The boundary: a box's corners, a ball's surface.
                for point in [point.map(f64::signum), point.normalize()] {
                    best = best.max(torque(&shape, &point).dot(&direction));
                }
            }
            assert!(best <= bound * (1.0 + 1e-12) && best > 0.99 * bound, "{} {best} {bound}", term.name());
        }
    }
}

#[test]
fn the_gyroscopic_bound_is_the_largest_eigenvalue_and_below_the_box() {
    let mut random = Random(4);
    for _ in 0..20_000 {
        let inertia = random.vector().abs();
        let d = random.vector();
        let rate = 1.5;
        let term = TorqueTerm::new("gyroscopic", Shape::Gyroscopic { inertia, rate }).unwrap();
        let form = Vector3::new(inertia.z - inertia.y, inertia.x - inertia.z, inertia.y - inertia.x).component_mul(&d);
        let matrix = nalgebra::Matrix3::new(0.0, form.z, form.y, form.z, 0.0, form.x, form.y, form.x, 0.0) * 0.5;
        let eigenvalue = matrix.symmetric_eigenvalues().max() * rate * rate;
        let bound = term.support(&d);
        assert!((bound - eigenvalue).abs() < 1e-7 * (1.0 + eigenvalue), "{bound} {eigenvalue}");
        assert!(bound <= 0.5 * form.abs().sum() * rate * rate * (1.0 + 1e-12));
    }
    let sphere = Shape::Gyroscopic { inertia: Vector3::repeat(1.0), rate: 9.0 };
    assert_eq!(TorqueTerm::new("gyroscopic", sphere).unwrap().support(&Vector3::new(1.0, 2.0, 3.0)), 0.0);
}

#[test]
fn a_demand_beyond_either_end_of_a_rotor_does_not_fit() {
    let demand = |rotors: &Rotors, least, greatest, radius| {
        let terms = [TorqueTerm::new("a ball", Shape::Ball { radius }).unwrap()];
        demands(rotors, &Commands::new(least, greatest, &terms).unwrap())[2]
    };
    let rotors = hummingbird(0.0);
    // A newton metre of yaw costs each rotor k_eta / (4 k_m) = 10.24 N, one of roll or pitch 2.08 N.
    let row = 0.25 * ((5.57e-6_f64 / 1.36e-7).powi(2) + 4.0 / 0.17_f64.powi(2)).sqrt();
    let yawing = demand(&rotors, 5.0, 5.0, 0.21);
    assert!(!yawing.fits() && (yawing.min - (1.25 - 0.21 * row)).abs() < 1e-5, "{yawing:?}");
    let heavy = demand(&rotors, 5.0, 60.0, 0.01);
    assert!(!heavy.fits() && (heavy.max - (15.0 + 0.01 * row)).abs() < 1e-4, "{heavy:?}");
    let idle = demand(&hummingbird(300.0), 3.0, 5.0, 0.01);
    assert!((idle.available_min - 0.5013).abs() < 1e-4 && idle.fits());
}

#[test]
fn sets_that_are_none_are_refused() {
    assert!(TorqueTerm::new("a term", Shape::Ball { radius: f64::NAN }).is_err());
    assert_eq!(TorqueTerm::new("a term", Shape::Ball { radius: -1.0 }).unwrap_err().field, "a term");
    assert!(Commands::new(2.0, 1.0, &[]).is_err() && Commands::new(0.0, f64::INFINITY, &[]).is_err());
}

#[test]
fn demands_are_rounded_outwards_by_what_single_precision_may_lose() {
    for demand in demands(&hummingbird(0.0), &Commands::new(4.0, 4.0, &[]).unwrap()) {
        // A quarter of 4 N each, without torque.
        assert!((demand.max - 1.0 - 1e-6).abs() < 1e-9, "{demand:?}");
        assert!((1.0 - demand.min - 1e-6).abs() < 1e-9, "{demand:?}");
    }
}
