//! The mixer against vertex enumeration in f64, on many geometries and random wrenches.

use controller_core::allocation::{Mixer, QuadX, Rotor, Rotors, Spin, max_torques};
use controller_core::state::Wrench;
use nalgebra::{SMatrix, SVector, Vector2, Vector3, Vector4};

/// Rounding of a single-precision tick, relative to the size of the numbers it works on.
const ROUNDING: f64 = 1e-6;

/// Eight roundings of half an epsilon, magnified by the slope of a face, at most 30.
const FACE_ROUNDING: f64 = 30.0 * 4.0 * f32::EPSILON as f64;

/// A fixed sequence of numbers in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

fn rotor(x: f32, y: f32, spin: Spin, thrust: [f32; 2]) -> Rotor {
    Rotor {
        position: Vector3::new(x, y, 0.01),
        spin,
        thrust_coefficient: 5.57e-6,
        drag_coefficient: 1.36e-7,
        thrust_min: thrust[0],
        thrust_max: thrust[1],
    }
}

fn spin(index: usize) -> Spin {
    if index.is_multiple_of(2) { Spin::Clockwise } else { Spin::CounterClockwise }
}

/// `count` rotors on a circle, spins alternating, the first at `phase` of the spacing.
fn ring(count: usize, phase: f32, thrust: [f32; 2]) -> Vec<Rotor> {
    let place = |i: usize| {
        let (sin, cos) = ((i as f32 + phase) * std::f32::consts::TAU / count as f32).sin_cos();
        rotor(0.25 * cos, 0.25 * sin, spin(i), thrust)
    };
    (0..count).map(place).collect()
}

/// The vehicles every property is tested on.
fn vehicles() -> Vec<(&'static str, Rotors)> {
    let hummingbird =
        QuadX { arm: 0.17, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: 0.0, speed_max: 1500.0 };
    let idling = QuadX { speed_min: 300.0, ..hummingbird };
    let mut weak = ring(6, 0.5, [0.3, 5.0]);
    weak[4].thrust_max = 1.5;
    let coaxial = (0..8).map(|i| {
        let (x, y) = [(0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)][i / 2];
        rotor(x, y, spin(i + i / 2), [0.1, 4.0])
    });
    let lopsided = [
        rotor(0.21, 0.13, Spin::Clockwise, [0.2, 6.0]),
        rotor(-0.17, 0.16, Spin::CounterClockwise, [0.0, 5.0]),
        rotor(-0.14, -0.22, Spin::Clockwise, [0.1, 7.0]),
        rotor(0.11, -0.19, Spin::CounterClockwise, [0.3, 4.0]),
    ];
    let mut five = lopsided.to_vec();
    five.push(rotor(0.02, -0.01, Spin::Clockwise, [0.0, 3.0]));
    let mut seven = ring(7, 0.1, [0.2, 4.0]);
    seven.iter_mut().zip([0.9, 1.2, 1.0, 0.7, 1.1, 1.0, 0.8]).for_each(|(rotor, factor)| rotor.position *= factor);
    let list = |rotors: &[Rotor]| Rotors::new(rotors).unwrap();
    vec![
        ("quad X", Rotors::quad_x(hummingbird).unwrap()),
        ("quad X that idles", Rotors::quad_x(idling).unwrap()),
        ("quad +", list(&ring(4, 0.0, [0.0, 5.0]))),
        ("hexa", list(&ring(6, 0.5, [0.0, 5.0]))),
        ("hexa with a weak rotor", list(&weak)),
        ("octo", list(&ring(8, 0.5, [0.2, 5.0]))),
        ("coaxial X8", list(&coaxial.collect::<Vec<_>>())),
        ("lopsided quad", list(&lopsided)),
        ("five rotors", list(&five)),
        ("seven rotors", list(&seven)),
    ]
}

fn wrench(w: &Vector4<f64>) -> Wrench {
    Wrench { thrust: w.x as f32, torque: Vector3::new(w.y as f32, w.z as f32, w.w as f32) }
}

fn vector(w: &Wrench) -> Vector4<f64> {
    Vector4::new(w.thrust, w.torque.x, w.torque.y, w.torque.z).map(f64::from)
}

fn delivered(rotors: &Rotors, thrusts: impl IntoIterator<Item = f64>) -> Vector4<f64> {
    rotors.effectiveness().iter().zip(thrusts).map(|(column, thrust)| column * thrust).sum()
}

/// The sum of what every rotor contributes at most to each wrench component: the size of the numbers at work.
fn size(rotors: &Rotors) -> Vector4<f64> {
    rotors.iter().zip(rotors.effectiveness()).map(|(r, column)| column.abs() * f64::from(r.thrust_max)).sum()
}

/// A wrench from everywhere around the polytope, now and then with a component at zero.
fn anywhere(rotors: &Rotors, random: &mut Random) -> Vector4<f64> {
    let reach = random.within(0.1, 2.0);
    let mut w = size(rotors).map(|size| reach * random.within(-1.0, 1.0) * size);
    w.x = 0.5 * w.x.abs() * (1.0 + random.next());
    w.map(|x| if random.next() < 0.1 { 0.0 } else { f64::from(x as f32) })
}

fn roll_pitch_error(a: &Vector4<f64>, b: &Vector4<f64>) -> f64 {
    Vector2::new(a.y - b.y, a.z - b.z).norm()
}

/// Thrusts within the rotors' ranges, each at one of its limits with the given probability.
fn within_ranges(rotors: &Rotors, at_limit: f64, random: &mut Random) -> Vec<f64> {
    let mut pick = |r: &Rotor| {
        let part = random.next();
        let part = if random.next() < at_limit { part.round() } else { 0.001 + 0.998 * part };
        f64::from(r.thrust_min) + part * f64::from(r.thrust_max - r.thrust_min)
    };
    rotors.iter().map(&mut pick).collect()
}

/// The error of the mixer's thrusts, relative to [`size`], after checking that they are in range and honestly reported.
fn error(rotors: &Rotors, mixer: &Mixer, asked: &Vector4<f64>) -> Vector4<f64> {
    let given = mixer.allocate(&wrench(asked)).unwrap();
    for (thrust, r) in given.thrusts.iter().zip(rotors.iter()) {
        assert!(*thrust >= r.thrust_min && *thrust <= r.thrust_max);
    }
    let achieved = delivered(rotors, given.thrusts.iter().map(|f| f64::from(*f)));
    assert!((vector(&mixer.wrench(&given.thrusts)) - achieved).component_div(&size(rotors)).amax() < ROUNDING);
    (achieved - asked).component_div(&size(rotors)).abs()
}

/// How much worse than clipping each rotor the mixer is in the roll-pitch plane, relative to [`size`].
fn excess_over_clipping(rotors: &Rotors, mixer: &Mixer, asked: &Vector4<f64>) -> f64 {
    let clip =
        |(row, r): (&Vector4<f64>, &Rotor)| row.dot(asked).clamp(f64::from(r.thrust_min), f64::from(r.thrust_max));
    let clipped = delivered(rotors, rotors.pseudo_inverse().iter().zip(rotors.iter()).map(clip));
    let given = mixer.allocate(&wrench(asked)).unwrap();
    let achieved = delivered(rotors, given.thrusts.iter().map(|f| f64::from(*f)));
    (roll_pitch_error(&achieved, asked) - roll_pitch_error(&clipped, asked)) / size(rotors).yz().norm()
}

#[test]
fn a_wrench_inside_the_polytope_is_delivered_exactly() {
    for (name, rotors) in vehicles() {
        let (mixer, mut random) = (Mixer::new(&rotors), Random(1));
        let (mut inside, mut on_faces, mut beyond_pseudo_inverse) = (Vector4::zeros(), Vector4::zeros(), 0);
        for _ in 0..50_000 {
            let asked = delivered(&rotors, within_ranges(&rotors, 0.0, &mut random));
            inside = inside.sup(&error(&rotors, &mixer, &asked));
            assert!(mixer.allocate(&wrench(&asked)).unwrap().is_exact());
            let fits = |(row, r): (&Vector4<f64>, &Rotor)| {
                let thrust = row.dot(&asked);
                thrust >= f64::from(r.thrust_min) && thrust <= f64::from(r.thrust_max)
            };
            beyond_pseudo_inverse += usize::from(!rotors.pseudo_inverse().iter().zip(rotors.iter()).all(fits));
            let at_limit = random.next();
            let asked = delivered(&rotors, within_ranges(&rotors, at_limit, &mut random));
            on_faces = on_faces.sup(&error(&rotors, &mixer, &asked));
        }
        let (most, on_faces) = (inside.max(), on_faces.data.0[0]);
        println!("{name}: inside {most:.1e}, on faces {on_faces:?}; beyond B+ {beyond_pseudo_inverse} of 50000");
        assert!(most < ROUNDING, "{name}: {inside}");
        // On a face, roll and pitch stay exact; thrust and yaw pay for rounding, magnified by up to 30 (see
        // `attainable`).
        assert!(on_faces[1] < ROUNDING && on_faces[2] < ROUNDING, "{name}: {on_faces:?}");
        assert!(on_faces[0] < FACE_ROUNDING && on_faces[3] < FACE_ROUNDING, "{name}: {on_faces:?}");
        assert_eq!(beyond_pseudo_inverse > 1000, rotors.len() > 4, "{name}: {beyond_pseudo_inverse}");
    }
}

#[test]
fn in_roll_and_pitch_it_is_never_worse_than_clipping_each_rotor() {
    for (name, rotors) in vehicles() {
        let (mixer, mut random) = (Mixer::new(&rotors), Random(2));
        let (mut worst, mut better) = (f64::NEG_INFINITY, 0);
        for _ in 0..100_000 {
            let excess = excess_over_clipping(&rotors, &mixer, &anywhere(&rotors, &mut random));
            worst = worst.max(excess);
            better += usize::from(excess < -1e-3);
        }
        println!("{name}: worst excess {worst:.1e} of the range, clearly better {better} times in 100000");
        assert!(worst < ROUNDING, "{name}: {worst:e}");
        assert!(better > 10_000);
    }
}

#[test]
fn extreme_vehicles_are_served_as_well() {
    let mut random = Random(5);
    let (mut served, mut inside, mut excess) = (0, 0.0_f64, f64::NEG_INFINITY);
    while served < 1000 {
        let mut one = || Rotor {
            drag_coefficient: random.within(2e-8, 4e-7) as f32,
            ..rotor(
                random.within(-0.3, 0.3) as f32,
                random.within(-0.3, 0.3) as f32,
                spin(usize::from(random.next() < 0.5)),
                [random.within(0.0, 1.0) as f32, random.within(1.5, 8.0) as f32],
            )
        };
        let list: Vec<Rotor> = (0..4 + served % 5).map(|_| one()).collect();
        let Ok(rotors) = Rotors::new(&list) else { continue };
        served += 1;
        let mixer = Mixer::new(&rotors);
        for _ in 0..200 {
            let asked = delivered(&rotors, within_ranges(&rotors, 0.0, &mut random));
            inside = inside.max(error(&rotors, &mixer, &asked).max());
            excess = excess.max(excess_over_clipping(&rotors, &mixer, &anywhere(&rotors, &mut random)));
        }
    }
    println!("{served} random vehicles: inside {inside:.1e}, worst excess {excess:.1e}");
    // Some are close to not spanning the wrench: there rounding counts up to 1 / ROW_INDEPENDENCE_SINE_MIN times.
    assert!(inside < 100.0 * f64::from(f32::EPSILON) && excess < ROUNDING, "{inside:e} {excess:e}");
}

/// All ways to choose `count` of `from` items, as bit masks.
fn choices(from: usize, count: usize) -> impl Iterator<Item = u32> {
    (0..1_u32 << from).filter(move |mask| mask.count_ones() as usize == count)
}

/// The least and greatest component `objective` of the wrench when its components `rows` are `fixed`: a linear program,
/// solved by visiting every vertex.
fn extremes<const K: usize>(rotors: &Rotors, rows: [usize; K], fixed: [f64; K], objective: usize) -> (f64, f64) {
    let n = rotors.len();
    let limits: Vec<(f64, f64)> = rotors.iter().map(|r| (f64::from(r.thrust_min), f64::from(r.thrust_max))).collect();
    let mut found = (f64::INFINITY, f64::NEG_INFINITY);
    for basis in choices(n, K) {
        let free: Vec<usize> = (0..n).filter(|i| basis >> i & 1 == 1).collect();
        let held: Vec<usize> = (0..n).filter(|i| basis >> i & 1 == 0).collect();
        let matrix = SMatrix::<f64, K, K>::from_fn(|row, column| rotors.effectiveness()[free[column]][rows[row]]);
        let Some(inverse) = matrix.try_inverse().filter(|inverse| inverse.amax() < 1e6) else { continue };
        for corner in 0..1_u32 << held.len() {
            let mut thrusts = vec![0.0; n];
            for (bit, index) in held.iter().enumerate() {
                thrusts[*index] = if corner >> bit & 1 == 1 { limits[*index].1 } else { limits[*index].0 };
            }
            let sum = delivered(rotors, thrusts.iter().copied());
            let missing = SVector::<f64, K>::from_fn(|row, _| fixed[row] - sum[rows[row]]);
            for (index, thrust) in free.iter().zip((inverse * missing).iter()) {
                thrusts[*index] = *thrust;
            }
            let fits = |(thrust, limit): (&f64, &(f64, f64))| *thrust > limit.0 - 1e-5 && *thrust < limit.1 + 1e-5;
            if thrusts.iter().zip(&limits).all(fits) {
                let value = delivered(rotors, thrusts.iter().copied())[objective];
                found = (found.0.min(value), found.1.max(value));
            }
        }
    }
    found
}

/// The distance in the roll-pitch plane from a point to the polygon, by its vertices' pairwise segments.
fn distance_to_polygon(rotors: &Rotors, point: &Vector2<f64>) -> f64 {
    let corner = |mask: u32| {
        let pick = |(i, r): (usize, &Rotor)| f64::from(if mask >> i & 1 == 1 { r.thrust_max } else { r.thrust_min });
        delivered(rotors, rotors.iter().enumerate().map(pick)).yz()
    };
    let corners: Vec<Vector2<f64>> = (0..1 << rotors.len()).map(corner).collect();
    let mut nearest = f64::INFINITY;
    for (i, a) in corners.iter().enumerate() {
        for b in &corners[..i] {
            let along = b - a;
            let part = ((point - a).dot(&along) / along.norm_squared().max(1e-30)).clamp(0.0, 1.0);
            nearest = nearest.min((a + along * part - point).norm());
        }
    }
    nearest
}

#[test]
fn yaw_is_given_up_first_then_thrust_and_roll_and_pitch_last() {
    for (name, rotors) in vehicles() {
        let (mixer, size, mut random) = (Mixer::new(&rotors), size(&rotors), Random(3));
        let mut limited = [0; 4];
        for _ in 0..300 {
            let asked = anywhere(&rotors, &mut random);
            let given = mixer.allocate(&wrench(&asked)).unwrap();
            let achieved = delivered(&rotors, given.thrusts.iter().map(|f| f64::from(*f)));
            // Roll and pitch: nothing in the polygon is nearer.
            let error = roll_pitch_error(&achieved, &asked);
            if error > 2.0 * ROUNDING * size.yz().norm() {
                assert!(given.roll_pitch_limited);
                let least = distance_to_polygon(&rotors, &asked.yz());
                assert!(error < least + 2.0 * ROUNDING * size.yz().norm(), "{name}: {error} {least}");
            }
            // Thrust: nothing nearer has this roll and pitch. Yaw: nothing nearer has this roll, pitch and thrust.
            // The vertices' own slack of 1e-5 N moves them by that much times the slopes of the polytope's faces.
            let thrusts = extremes(&rotors, [1, 2], [achieved.y, achieved.z], 0);
            let best = asked.x.clamp(thrusts.0, thrusts.1);
            assert!((achieved.x - best).abs() < 1e-3, "{name}: thrust {} instead of {best}", achieved.x);
            let yaws = extremes(&rotors, [1, 2, 0], [achieved.y, achieved.z, achieved.x], 3);
            let best = asked.w.clamp(yaws.0, yaws.1);
            assert!((achieved.w - best).abs() < 1e-4, "{name}: yaw {} instead of {best}", achieved.w);
            let what = [given.is_exact(), given.roll_pitch_limited, given.thrust_limited, given.yaw_limited];
            limited.iter_mut().zip(what).for_each(|(count, flag)| *count += usize::from(flag));
        }
        println!("{name}: exact, roll-pitch, thrust, yaw limited in {limited:?} of 300");
        assert!(limited.iter().all(|count| *count > 0), "{name}: {limited:?}");
    }
}

#[test]
fn no_torque_beyond_the_greatest_can_be_had_alone() {
    for (name, rotors) in vehicles() {
        let greatest = max_torques(&rotors);
        for (axis, others) in [[2, 3], [1, 3], [1, 2]].into_iter().enumerate() {
            let (low, high) = extremes(&rotors, others, [0.0, 0.0], axis + 1);
            let (found, best) = (f64::from(greatest[axis]), high.min(-low));
            assert!(best > 0.0 && (found / best - 1.0).abs() < 1e-4, "{name}, axis {axis}: {found} {best}");
        }
    }
}

#[test]
fn rotors_all_ahead_of_the_centre_of_mass_have_no_greatest_torques() {
    let ahead: Vec<Rotor> = ring(4, 0.5, [0.5, 5.0])
        .into_iter()
        .map(|rotor| Rotor { position: rotor.position + Vector3::new(0.3, 0.0, 0.0), ..rotor })
        .collect();
    let greatest = max_torques(&Rotors::new(&ahead).unwrap());
    assert!(greatest.min() < 0.0, "{greatest}");
}

#[test]
fn a_small_change_of_the_wrench_is_a_small_change_of_the_thrusts() {
    for (name, rotors) in vehicles() {
        let (mixer, size, mut random) = (Mixer::new(&rotors), size(&rotors), Random(4));
        let (mut steepest, step) = (0.0_f64, 1e-4);
        for _ in 0..20_000 {
            let asked = anywhere(&rotors, &mut random);
            let moved = asked + size.map(|size| step * random.within(-1.0, 1.0) * size);
            let (a, b) = (mixer.allocate(&wrench(&asked)).unwrap(), mixer.allocate(&wrench(&moved)).unwrap());
            let change = a.thrusts.iter().zip(&b.thrusts).map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
            steepest = steepest.max(change / (step * size.x));
        }
        println!("{name}: thrusts change at most {steepest:.1} times as much as the wrench");
        // A jump by 0.5 % of the greatest thrust would show as 50. Five rotors have a narrow face with a slope of 28.
        assert!(steepest < 50.0, "{name}: {steepest}");
    }
}

#[test]
fn wrenches_that_are_no_numbers_are_refused_and_huge_ones_served() {
    let (_, rotors) = vehicles().remove(3);
    let mixer = Mixer::new(&rotors);
    for bad in [f32::NAN, f32::INFINITY, 1e16] {
        assert!(mixer.allocate(&Wrench { thrust: bad, torque: Vector3::zeros() }).is_err());
        assert!(mixer.allocate(&Wrench { thrust: 5.0, torque: Vector3::new(0.0, 0.0, bad) }).is_err());
    }
    let given = mixer.allocate(&Wrench { thrust: 1e15, torque: Vector3::new(-1e15, 1e15, 1e15) }).unwrap();
    assert!(given.thrusts.iter().all(|f| (0.0..=5.0).contains(f)));
    let achieved = mixer.wrench(&given.thrusts);
    assert!(achieved.torque.x < -1.0 && achieved.torque.y > 1.0);
}
