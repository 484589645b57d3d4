//! The steps of docs/sharp-bound.md, checked one by one at random situations.

use crate::support::adversary_search;
use crate::support::adversary_search::configurations::around_table_1;
use crate::support::adversary_search::{COORDINATE_COUNT, Domain, Situation};
use crate::support::random;
use crate::support::random::ChaCha8Rng;
use controller_core::certificate::Certificate;
use controller_core::certificate::form::{ARITHMETIC_ALLOWANCE, Form};
use controller_core::certificate::reachable::{Reachable, half_l1_norm};
use controller_core::certificate::sharp::{ANGLE_CELLS, HEADING_CELLS, SPLIT_CELLS, TILT_CELLS};
use controller_core::gains::{GainParameters, Gains};
use controller_core::mrp;
use controller_core::position::{FilterState, FilterTransition};
use controller_core::reference::ReferenceBounds;
use nalgebra::{Matrix3, Vector3};
use rand::RngExt;

fn situation(rng: &mut ChaCha8Rng) -> Situation {
    let configuration = around_table_1(rng, 3.0);
    let code = [(); COORDINATE_COUNT].map(|()| rng.random_range(-1.0..=1.0));
    Situation::decode(&configuration, Domain::Decoupled, &code)
}

/// What the derivation speaks of, from its definitions: u, u', u'' in double precision and the axes of R_d.
struct Geometry {
    n: f64,
    /// x, y, rho: R_d's columns.
    axes: [Vector3<f64>; 3],
    /// The parts of u' and u'' orthogonal to rho, and that of u' along it.
    p: Vector3<f64>,
    r: f64,
    w: Vector3<f64>,
    tan_gamma: f64,
    /// Horizontal and orthogonal to rho.
    level: Vector3<f64>,
}

impl Geometry {
    fn new(situation: &Situation) -> Self {
        let [u, first, second] = situation.command_and_derivatives().map(|v| v.cast::<f64>());
        let n = u.norm();
        let rho = u / n;
        let r_d: Matrix3<f64> = mrp::rotation(&situation.desired().attitude).cast();
        let axes = [r_d.column(0).into(), r_d.column(1).into(), rho];
        let (p, w) = (first - rho * rho.dot(&first), second - rho * rho.dot(&second));
        let slope = Vector3::new(rho.x, rho.y, 0.0);
        let level = Vector3::z().cross(&rho) / slope.norm().max(1e-12);
        Self { n, axes, p, r: rho.dot(&first), w, tan_gamma: slope.norm() / rho.z, level }
    }

    /// The lengths of a tangential vector and of its horizontal part, and their mean.
    fn mixed(&self, v: &Vector3<f64>) -> f64 {
        0.5 * (v.norm() + self.level.dot(v).abs())
    }
}

#[test]
fn the_exact_expression_is_the_laws_own() {
    let mut rng = random::generator(40);
    for _ in 0..20_000 {
        let situation = situation(&mut rng);
        let desired = situation.desired();
        let Geometry { n, axes: [x, y, _], p, r, w, tan_gamma, .. } = Geometry::new(&situation);
        let (psi_1, psi_2) =
            (f64::from(situation.reference.heading.rate()), f64::from(situation.reference.heading.acceleration()));

        // sin theta = -e3 . x, cos theta sin phi = e3 . y, cos theta cos phi = e3 . rho = cos gamma.
        let cos_gamma = 1.0 / 1.0_f64.hypot(tan_gamma);
        let (s_theta, s_phi_c_theta) = (-x.z, y.z);
        let c_theta = (1.0 - s_theta * s_theta).sqrt();
        let (s_phi, c_phi) = (s_phi_c_theta / c_theta, cos_gamma / c_theta);
        let tan_phi = s_phi / c_phi;

        let tilt_rate = p / n;
        let tilt_acceleration = w / n - tilt_rate * (2.0 * r / n);
        let (w_1, w_2) = (-y.dot(&tilt_rate), x.dot(&tilt_rate));
        let w_3 = psi_1 * c_theta * c_theta / cos_gamma - tan_phi * w_2;
        let quadratic = 2.0 * psi_1 * psi_1 * s_theta * c_theta * s_phi - 2.0 * psi_1 * s_theta * w_2
            + 2.0 * psi_1 * c_theta * s_phi * w_1
            - w_1 * w_2 * (1.0 + s_phi * s_phi);
        let acceleration = Vector3::new(
            -y.dot(&tilt_acceleration) + w_3 * w_2,
            x.dot(&tilt_acceleration) - w_3 * w_1,
            psi_2 * c_theta / c_phi - tan_phi * x.dot(&tilt_acceleration) + quadratic / (c_phi * c_phi),
        );
        let velocity = Vector3::new(w_1, w_2, w_3);
        // The law's single precision, and cancellation among terms as large as w / n.
        let tolerance = |scale: f64| 2e-5 * (1.0 + scale) * (1.0 + tan_gamma * tan_gamma);
        let velocity_error = (velocity - desired.angular_velocity.cast::<f64>()).norm();
        assert!(velocity_error < tolerance(velocity.norm()), "{velocity} {desired:?}");
        let scale = w.norm() / n + velocity.norm_squared() + psi_1 * psi_1;
        let error = (acceleration - desired.angular_acceleration.cast::<f64>()).norm();
        assert!(error < tolerance(scale), "{acceleration} {desired:?}");
    }
}

#[test]
fn every_part_of_the_angular_acceleration_is_within_its_bound() {
    let mut rng = random::generator(41);
    for _ in 0..20_000 {
        let situation = situation(&mut rng);
        let desired = situation.desired();
        let geometry = Geometry::new(&situation);
        let Geometry { n, axes: [x, y, _], p, r, w, tan_gamma: tan, .. } = &geometry;
        let heading = situation.reference.heading;
        let (psi_1, psi_2) = (f64::from(heading.rate()).abs(), f64::from(heading.acceleration()).abs());
        let secant = 1.0_f64.hypot(*tan);
        let sin = tan / secant;
        let (p_n, r_n) = (p.norm() / n, r.abs() / n);

        let velocity = desired.angular_velocity.cast::<f64>();
        let yaw = psi_1 * secant + tan * geometry.mixed(p) / n;
        let room = 1.0 + 1e-4;
        assert!(velocity.z.abs() <= yaw * room + 1e-5);

        let acceleration = desired.angular_acceleration.cast::<f64>();
        // tan phi = (cos theta sin phi) / (cos theta cos phi).
        let tan_phi = y.z * secant;
        assert!(tan_phi.abs() <= tan * room + 1e-6);
        let linear = Vector3::new(-y.dot(w), x.dot(w), -tan_phi * x.dot(w)) / *n;
        assert!(linear.z.abs() <= tan * geometry.mixed(w) / n * room + 1e-5);
        let quadratic = acceleration - linear;
        let noise = 1e-4 * (1.0 + linear.norm());
        assert!(quadratic.xy().norm() <= p_n * (2.0 * r_n).hypot(yaw) * room + noise);
        let yawing = psi_2 * secant
            + 2.0 * tan * r_n * geometry.mixed(p) / n
            + (psi_1 * tan).powi(2)
            + 2.0 * psi_1 * p_n * sin * secant * secant
            + 0.5 * p_n * p_n * (1.0 + 2.0 * tan * tan);
        assert!(quadratic.z.abs() <= yawing * room + noise, "{} {yawing}", quadratic.z);
    }
}

/// Per axis with M_p = 1: the greatest |u_f'| and |u_f''| that piecewise constant feedback of `switches` reaches.
fn flown(rng: &mut ChaCha8Rng, k_f: f64, k_s: f64, switches: usize) -> (f64, f64) {
    let (mut u_f, mut u_s, mut greatest) = (0.0_f64, 0.0_f64, (0.0_f64, 0.0_f64));
    for number in 0..switches {
        let ubar = if number % 2 == 0 { 1.0 } else { -1.0 };
        let hold = (1.0 / k_f + 1.0 / k_s) * 8.0 * rng.random_range(0.0..1.0_f64).powi(2);
        let steps = 400;
        let (e_f, e_s) = ((-k_f * hold / 400.0).exp(), (-k_s * hold / 400.0).exp());
        let across = k_f * (e_f - e_s) / (k_s - k_f);
        for _ in 0..steps {
            // u_f'' is greatest in the instant after a switch, so it is read with either input.
            let difference = u_f - u_s;
            for input in [-1.0, 1.0] {
                greatest.1 = greatest.1.max((k_f * (k_f * difference - k_s * (u_s - input))).abs());
            }
            greatest.0 = greatest.0.max((k_f * difference).abs());
            (u_f, u_s) = (ubar + e_f * (u_f - ubar) + across * (u_s - ubar), ubar + e_s * (u_s - ubar));
        }
    }
    greatest
}

#[test]
fn the_filters_reach_what_step_1_says_and_no_more() {
    let mut rng = random::generator(42);
    for _ in 0..200 {
        let k_f = f64::from(random::log_uniform(&mut rng, 0.3, 30.0));
        let k_s = f64::from(random::log_uniform(&mut rng, 0.3, 30.0)) * 1.01;
        let half_l1 = half_l1_norm(k_f, k_s);
        let first = 2.0 * k_f * half_l1;
        let second = 2.0 * k_f * (k_s + k_f * half_l1 * half_l1);
        let (found_first, found_second) = flown(&mut rng, k_f, k_s, 100);
        assert!(found_first <= first * (1.0 + 1e-9) && found_second <= second * (1.0 + 1e-9), "{k_f} {k_s}");
        assert!(found_first >= 0.98 * first && found_second >= 0.98 * second, "{k_f} {k_s}: {found_first} of {first}");
    }
}

#[test]
fn the_adversarys_reachable_set_is_the_one_the_filters_reach() {
    // The support of the set in random directions, by its arc and by flying the extremal feedback.
    let mut rng = random::generator(43);
    for _ in 0..200 {
        let k_f = f64::from(random::log_uniform(&mut rng, 0.3, 30.0));
        let k_s = f64::from(random::log_uniform(&mut rng, 0.3, 30.0)) * 1.01;
        let angle: f64 = rng.random_range(0.0..std::f64::consts::TAU);
        let (a, b) = (angle.cos(), angle.sin());
        let by_arc = (0..=40_000)
            .map(|i| {
                let (u_f, u_s) = adversary_search::reachable_point(k_f, k_s, 1.0, f64::from(i) / 40_000.0, 1.0);
                (a * u_f + b * u_s).abs()
            })
            .fold(0.0, f64::max);
        // The support function is the L1 norm of the impulse response of a u_f + b u_s: integrate it.
        let end = 40.0 / k_f.min(k_s);
        let steps = 400_000;
        let h = end / f64::from(steps);
        let integral: f64 = (0..steps)
            .map(|i| {
                let t = (f64::from(i) + 0.5) * h;
                let (e_f, e_s) = ((-k_f * t).exp(), (-k_s * t).exp());
                (a * k_f * k_s * (e_f - e_s) / (k_s - k_f) + b * k_s * e_s).abs() * h
            })
            .sum();
        assert!((by_arc - integral).abs() < 2e-3 * integral, "{k_f} {k_s} {angle}: {by_arc} {integral}");
    }
}

/// How many of the derivation's gains are in use.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Gain {
    ExactExpression,
    MagnitudeGrowsWithTilt,
    OneBudgetForTheRate,
    OneBudgetForTheHeading,
    CouplingByTheSineOfChi,
    ShapeOfTheSnap,
    PartsApart,
}

/// The derivation's bound on |omega_d'| with the gains up to `used`, at one (tilt, direction of w, split of u', psi').
fn bound_at(reach: &Reachable, bounds: &ReferenceBounds, used: Gain, at: [f64; 4]) -> f64 {
    let [tilt, direction, split, turning] = at;
    let tan = tilt * reach.horizontal / reach.vertical_min;
    let secant = tan.hypot(1.0);
    let (sin, cos) = (tan / secant, 1.0 / secant);
    let n = reach.vertical_min * if used >= Gain::MagnitudeGrowsWithTilt { secant } else { 1.0 };

    let (along, across) = (reach.horizontal_snap * direction.cos(), reach.horizontal_snap * direction.sin());
    let (w, w_perp) = if used >= Gain::ShapeOfTheSnap {
        ((cos * along + sin * reach.vertical_snap).hypot(across), across)
    } else {
        (reach.horizontal_snap.hypot(reach.vertical_snap), reach.horizontal_snap)
    };
    let (p, r) = if used >= Gain::OneBudgetForTheRate {
        (reach.jerk * split.cos() / n, reach.jerk * split.sin() / n)
    } else {
        (reach.jerk / n, reach.jerk / n)
    };
    let (fastest, second) = (f64::from(bounds.heading_rate), f64::from(bounds.heading_second_derivative));
    let (psi_1, psi_2) = if used >= Gain::OneBudgetForTheHeading {
        let psi_1 = turning * fastest.min(second.sqrt());
        (psi_1, (second * second - psi_1.powi(4)).max(0.0).sqrt())
    } else {
        (fastest, second)
    };
    let by_sine = used >= Gain::CouplingByTheSineOfChi;
    let w_mixed = if by_sine { 0.5 * (w + w_perp) } else { w } / n;
    let p_mixed = if by_sine { 0.5 * (p + p.min(reach.horizontal_jerk / n)) } else { p };

    let linear = (w / n, tan * w_mixed);
    let quadratic = (
        p * (2.0 * r).hypot(psi_1 * secant + tan * p_mixed),
        psi_2 * secant
            + 2.0 * tan * r * p_mixed
            + (psi_1 * tan).powi(2)
            + 2.0 * psi_1 * p * sin * secant * secant
            + 0.5 * p * p * (1.0 + 2.0 * tan * tan),
    );
    if used >= Gain::PartsApart {
        (linear.0 + quadratic.0).hypot(linear.1 + quadratic.1)
    } else {
        linear.0.hypot(linear.1) + quadratic.0.hypot(quadratic.1)
    }
}

/// docs/sharp-bound.md.
fn document() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/sharp-bound.md")).unwrap()
}

/// The cell of the document's table row that begins with `row`.
fn cell(document: &str, row: &str, column: usize) -> String {
    let line = document.lines().find(|line| line.starts_with(&format!("| {row}")));
    let line = line.unwrap_or_else(|| panic!("docs/sharp-bound.md has no row {row}"));
    // A bar between backslash and bar is a norm's.
    let cells: Vec<_> = line.split(" | ").map(|cell| cell.trim_matches(['|', ' ', '*']).to_owned()).collect();
    cells[column].clone()
}

#[test]
fn the_derivation_states_the_codes_own_bounds_and_cells() {
    let document = document();
    let certificate = Certificate::new(&adversary_search::configurations::paper()).unwrap();
    let rates = |form: &Form| [form.rates.angular_velocity, form.rates.angular_acceleration];
    let rows = ["$\\lvert\\omega_d", "$\\lvert\\dot\\omega_d", "roll torque", "pitch torque", "yaw torque"];
    for (column, form) in [(1, &certificate.paper().unwrap().printed), (3, &certificate.paper().unwrap().sharp)] {
        let values = rates(form).into_iter().chain(form.torque.iter().copied());
        for (row, value) in rows.iter().zip(values) {
            let stated = cell(&document, row, column);
            let digits = stated.split_once('.').map_or(0, |(_, fraction)| fraction.len());
            assert_eq!(stated, format!("{value:.digits$}"), "{row}, column {column}");
        }
    }
    let cells = format!("${TILT_CELLS}\\times{ANGLE_CELLS}\\times{SPLIT_CELLS}\\times{HEADING_CELLS}$ cells");
    assert!(document.contains(&cells), "docs/sharp-bound.md does not speak of {cells}");
}

#[test]
fn every_step_of_the_derivation_gains() {
    const GRID_STEPS: u32 = 24;
    let configuration = adversary_search::configurations::paper();
    let (gains, bounds) = (configuration.gains().unwrap(), configuration.bounds());
    let gravity = f64::from(configuration.vehicle().gravity);
    let [k_f, k_s, m_p] = [gains.k_f, gains.k_s, gains.m_p].map(f64::from);
    let reach = Reachable::new(k_f, k_s, m_p, gravity, bounds);
    let certificate = Certificate::new(&configuration).unwrap();
    let printed = certificate.paper().unwrap().printed.rates.angular_acceleration;
    let sharp = certificate.paper().unwrap().sharp.rates.angular_acceleration;

    let document = document();
    let stated = |row: &str, value: f64| assert_eq!(cell(&document, row, 1), format!("{value:.2}"), "{row}");
    stated("Lemma 1 as printed", printed);
    let mut before = printed;
    println!("Lemma 1 as printed: {printed:.2}");
    for (used, name) in [
        (Gain::ExactExpression, "the exact expression"),
        (Gain::MagnitudeGrowsWithTilt, "$n$ grows with the tilt"),
        (Gain::OneBudgetForTheRate, "$p$ and $r$ share"),
        (Gain::OneBudgetForTheHeading, "$\\dot\\psi$ and $\\ddot\\psi$ share"),
        (Gain::CouplingByTheSineOfChi, "$[v]="),
        (Gain::ShapeOfTheSnap, "the shape of $\\ddot u$"),
        (Gain::PartsApart, "tilting and yawing parts kept apart"),
    ] {
        let share = |i: u32| f64::from(i) / f64::from(GRID_STEPS);
        let quarter = |i: u32| share(i) * std::f64::consts::FRAC_PI_2;
        let mut greatest = 0.0_f64;
        for (i, j) in (0..=GRID_STEPS).flat_map(|i| (0..=GRID_STEPS).map(move |j| (i, j))) {
            for (k, l) in (0..=GRID_STEPS).flat_map(|k| (0..=GRID_STEPS).map(move |l| (k, l))) {
                let at = [share(i), quarter(j), quarter(k), share(l)];
                greatest = greatest.max(bound_at(&reach, bounds, used, at));
            }
        }
        println!("{name}: {greatest:.2}");
        stated(name, greatest);
        assert!(greatest < before, "{name} gains nothing: {greatest} after {before}");
        before = greatest;
    }
    println!("over cells, every quantity at its worst end: {sharp:.2}");
    stated("the same over cells", sharp);
    // What the cells cost: they bound the supremum that the grid samples, from the other side.
    assert!(sharp >= before && sharp <= 1.02 * before, "{sharp} over cells, {before} on the grid");
}

#[test]
fn rounding_takes_the_laws_own_filters_hardly_beyond_step_1() {
    // Rounding adds up over the settling time, so it counts most at fast ticks and slow filters.
    let mut rng = random::generator(44);
    let mut furthest = 0.0_f64;
    for _ in 0..300 {
        let period = random::log_uniform(&mut rng, 2.5e-4, 2e-2);
        let [k_f, k_s] = [(); 2].map(|()| random::log_uniform(&mut rng, 0.2, 40.0));
        let parameters = GainParameters { k_f, k_s, ..GainParameters::TABLE_1 };
        let gains = Gains::new(parameters, &random::paper_vehicle()).unwrap();
        let transition = FilterTransition::new(gains.k_f, gains.k_s, period).unwrap();
        let (k_f, k_s, level) = (f64::from(k_f), f64::from(k_s), f64::from(gains.m_p));
        let half_l1 = half_l1_norm(k_f, k_s);
        let bounds = (2.0 * half_l1 * level, 2.0 * k_f * level * (k_s + k_f * half_l1 * half_l1));

        let settling = (20.0 / (k_f.min(k_s) * f64::from(period))) as usize;
        let mut filter = FilterState::ZERO;
        for ubar in [gains.m_p, -gains.m_p, gains.m_p] {
            for _ in 0..settling {
                filter = transition.advance(&filter, &Vector3::repeat(ubar));
                let (u_f, u_s) = (f64::from(filter.filtered.x), f64::from(filter.intermediate.x));
                let second = |input: f64| (k_f * (k_f * (u_f - u_s) - k_s * (u_s - input))).abs();
                let greatest = second(level).max(second(-level));
                furthest = furthest.max((u_f - u_s).abs() / bounds.0 - 1.0).max(greatest / bounds.1 - 1.0);
            }
        }
    }
    println!("beyond step 1, relative: {furthest:.1e}");
    assert!(furthest < 0.2 * ARITHMETIC_ALLOWANCE, "{furthest:e}");
}
