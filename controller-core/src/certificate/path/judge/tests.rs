use super::*;
use crate::certificate::path::FORCE_KEPT_M_PER_S2;
use crate::extended::tests::Random;
use crate::extended::tests::example::Craft;
use crate::math::enclosure::Enclosure;
use crate::reference::ReferenceBounds;
use nalgebra::Vector3;

fn judge<R: Real>(craft: &Craft, force_kept: f32) -> PathJudge<R> {
    let parameters = craft.constants(&crate::extended::defaults::NOTHING_GIVEN);
    PathJudge::new(&craft.configuration(&parameters, ReferenceBounds::REST), &craft.law(&parameters), force_kept)
}

/// A level circle of 3 m at `speed`, m/s.
fn circle(speed: f64) -> PathMotion {
    let turn = speed / 3.0;
    PathMotion {
        velocity: [0.0, speed, 0.0],
        acceleration: [-speed * turn, 0.0, 0.0],
        jerk: [0.0, -speed * turn.powi(2), 0.0],
        snap: [speed * turn.powi(3), 0.0, 0.0],
        heading_rate: 0.0,
    }
}

fn random_motion(random: &mut Random, size: f32) -> PathMotion {
    let mut vector = |size: f32| random.vector(size).map(f64::from).into();
    let (velocity, acceleration) = (vector(2.0 * size), vector(2.0 * size));
    let (jerk, snap) = (vector(4.0 * size), vector(12.0 * size));
    PathMotion { velocity, acceleration, jerk, snap, heading_rate: f64::from(random.signed() * 0.2 * size) }
}

/// A vector of length at most `size`.
fn within(random: &mut Random, size: f64) -> Vector3<f64> {
    let direction = random.vector(1.0).map(f64::from);
    direction.try_normalize(1e-6).unwrap_or_default() * size * f64::from(random.between(0.0, 1.0))
}

#[test]
fn a_faster_circle_takes_more_until_it_takes_all() {
    let judge = judge::<f64>(&Craft::example(), FORCE_KEPT_M_PER_S2);
    let shares: [f64; 40] = core::array::from_fn(|speed| judge.shares(&circle(speed as f64 * 0.5)).worst());
    assert!(shares[0] < 0.7 && shares[39] > 1.0, "{shares:?}");
    assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "{shares:?}");
    // The direction of thrust turns once in a turn of the circle: |p| = omega a / n.
    let own = PathJudge { force: 0.0, feedback: [0.0; 3], ..judge };
    let (a, turn) = (36.0 / 3.0, 6.0 / 3.0);
    let w = Vector3::new(-a, 0.47 * 6.0, 9.81);
    let rate = turn * (w.x * w.x + w.y * w.y).sqrt() / w.norm();
    let found = own.shares(&circle(6.0)).each[2] * own.turn_rate;
    assert!((found / rate - 1.0).abs() < 1e-3, "{found} {rate}");
}

/// Every motion within the spread, beside every force and feedback within what is kept, takes no more than is said.
#[test]
fn nothing_in_the_balls_takes_more_than_the_shares_say() {
    let mut random = Random(31);
    let (mut tight, mut judged) = ([0.0_f64; 6], 0);
    for _ in 0..300 {
        let craft = Craft::random(&mut random);
        let force = random.between(0.0, 2.0);
        let mut judge = judge::<f64>(&craft, force);
        let mut motion = random_motion(&mut random, 2.0);
        if judged % 2 == 0 {
            // Nothing turns u but what moves it: u', u'' and the tilt's fall follow it.
            judge.feedback = [0.0; 3];
            let [x, y, z] = motion.acceleration;
            let [f_1, f_2] = [random.signed(), random.signed()].map(f64::from);
            motion = PathMotion {
                velocity: [-x, -y, 0.0].map(|x| x / judge.drag),
                acceleration: [x, y, z],
                jerk: [-judge.drag * x, -judge.drag * y, f_1 * (z + judge.gravity)],
                snap: [judge.drag * judge.drag * x, judge.drag * judge.drag * y, f_2 * (z + judge.gravity)],
                ..motion
            };
        }
        let size = f64::from(random.between(0.0, 0.2));
        let spread = Spread { velocity: size, acceleration: size, jerk: size, snap: size, heading_rate: size };
        let shares = judge.shares_within(&motion, &spread).each;
        if shares.iter().any(|share| share.is_infinite()) {
            continue;
        }
        judged += 1;
        for _ in 0..200 {
            let taken = taken(&judge, &moved(&mut random, &motion, size), &mut random);
            for ((taken, share), tight) in taken.into_iter().zip(shares).zip(&mut tight) {
                assert!(taken <= share, "{taken:?} {shares:?}");
                *tight = tight.max(taken / share);
            }
        }
    }
    // And not much more than what is taken.
    assert!(judged > 200 && tight.iter().all(|share| *share > 0.85), "{judged} {tight:?}");
}

fn moved(random: &mut Random, motion: &PathMotion, size: f64) -> PathMotion {
    let mut near = |v: [f64; 3]| (Vector3::from(v) + within(random, size)).into();
    let PathMotion { velocity, acceleration, jerk, snap, heading_rate } = *motion;
    PathMotion {
        velocity: near(velocity),
        acceleration: near(acceleration),
        jerk: near(jerk),
        snap: near(snap),
        heading_rate: heading_rate + size * f64::from(random.signed()),
    }
}

/// The rows of a motion beside one force and one feedback, in the order of the shares.
fn taken(judge: &PathJudge, motion: &PathMotion, random: &mut Random) -> [f64; 6] {
    let across = Vector3::new(judge.drag, judge.drag, 0.0);
    let [v, a, j, s] = [motion.velocity, motion.acceleration, motion.jerk, motion.snap].map(Vector3::from);
    let [e, e_1, e_2] = judge.feedback.map(|size| within(random, size));
    let force = within(random, judge.force);
    let u = a + across.component_mul(&v) + Vector3::z() * judge.gravity - force + e;
    let u_1 = j + across.component_mul(&a) + e_1;
    let u_2 = s + across.component_mul(&j) + e_2;
    let n = u.norm();
    let rho = u / n;
    let r = rho.dot(&u_1);
    let p = (u_1 - rho * r) / n;
    let q = (u_2 - rho * rho.dot(&u_2) - p * (2.0 * r)) / n;
    let tilt = (1.0 - rho.z * rho.z).sqrt();
    let turning = (motion.heading_rate.abs() + tilt * p.norm()) / rho.z;
    let spin = (2.0 * turning / judge.spin[1] - 1.0).clamp(0.0, 1.0);
    let torque = judge.inertia[0] * q.norm() + judge.inertia[1] * turning * p.norm() + judge.torque[0];
    let k = judge.softness;
    let swollen = n + (rho.dot(&(u_2 + u_1 * (2.0 * k))) + n * p.norm_squared()) / (k * k);
    // The feedback's part is the sum over its filters, which is less than its derivatives at their worst together.
    let swollen = swollen - rho.dot(&(e + (e_2 + e_1 * (2.0 * k)) / (k * k)));
    [
        judge.a_down / (judge.gravity + a.z),
        ((judge.mass * n + judge.reach * torque + judge.spin[0] * spin) / judge.ceiling[0])
            .max(judge.mass * n / judge.ceiling[1])
            .max(swollen / judge.max),
        p.norm() / judge.turn_rate,
        torque / judge.torque[1],
        (judge.floor + judge.reach * torque) / (0.95 * judge.mass * n),
        (judge.closing * judge.cosine - p.z) / (judge.closing * rho.z),
    ]
}

#[test]
fn a_reference_that_hangs_in_the_air_by_nothing_takes_all() {
    let judge = judge::<f64>(&Craft::example(), FORCE_KEPT_M_PER_S2);
    let falling = PathMotion { acceleration: [0.0, 0.0, -9.0], ..circle(0.0) };
    assert_eq!(judge.shares(&falling).worst(), f64::INFINITY);
    // A_- is 0.63 g.
    let fall = |acceleration: f64| {
        judge.shares(&PathMotion { acceleration: [0.0, 0.0, -acceleration], ..circle(0.0) }).each[0]
    };
    assert!(fall(3.61) < 1.0 && fall(3.64) > 1.0);
    let unknown = PathMotion { jerk: [f64::NAN; 3], ..circle(1.0) };
    assert_eq!(judge.shares(&unknown).worst(), f64::INFINITY);
}

#[test]
fn rounding_decides_nothing() {
    let mut random = Random(77);
    for _ in 0..100 {
        let craft = Craft::random(&mut random);
        let motion = random_motion(&mut random, 1.0);
        let nearest = judge::<f64>(&craft, FORCE_KEPT_M_PER_S2).shares(&motion).each;
        let PathMotion { velocity, acceleration, jerk, snap, heading_rate } = motion;
        let enclosed = PathMotion {
            velocity: velocity.map(Enclosure::from),
            acceleration: acceleration.map(Enclosure::from),
            jerk: jerk.map(Enclosure::from),
            snap: snap.map(Enclosure::from),
            heading_rate: Enclosure::from(heading_rate),
        };
        let enclosed = judge::<Enclosure>(&craft, FORCE_KEPT_M_PER_S2).shares(&enclosed).each;
        for (nearest, enclosed) in nearest.into_iter().zip(enclosed) {
            assert!(enclosed.lower() <= nearest && nearest <= enclosed.upper(), "{nearest} {enclosed:?}");
            assert!(nearest.is_infinite() || enclosed.upper() - enclosed.lower() < 1e-9 * nearest, "{enclosed:?}");
        }
    }
}
